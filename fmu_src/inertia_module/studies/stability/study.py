"""Runs the cases of the map, one after the other, and writes down all that was measured."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from ...module import Module
from ...results import write_text
from .axes import AXES, cases
from .case import Case
from .trial import Plant, try_case
from .verdict import Verdict, judge


class UnknownAxis(ValueError):
    """An axis that is not on the map: the message names those that are."""


def chosen_cases(only: str | None = None, quick: bool = False) -> list[Case]:
    """Cases of all axes, or of one.

    Args:
        only: name of an axis. quick: leave out those that take long.

    Raises:
        UnknownAxis: there is none of this name.
    """
    if only is not None and only not in AXES:
        raise UnknownAxis(f"axis {only} is refused: allowed is {', '.join(AXES)}")
    return [case for axis in ([only] if only else AXES) for case in cases(axis, quick)]


def run_study(
    chosen: Sequence[Case],
    report: Callable[[float], None] = lambda done: None,
    plant: Callable[[], Plant] = Module,
) -> list[Verdict]:
    """Verdicts on these cases, in their order.

    Args:
        report: called with the share that is done. plant: makes a module not started yet.
    """
    verdicts = []
    for number, case in enumerate(chosen, 1):
        verdicts.append(judge(try_case(case, plant)))
        report(number / len(chosen))
    return verdicts


def write_cases(path: Path, verdicts: Iterable[Verdict]) -> Path:
    """Write a row for each case with every figure and its bound, as CSV, whole or not at all."""
    verdicts = list(verdicts)
    names = list(dict.fromkeys(name for verdict in verdicts for name in verdict.figures))
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    bounds = [f"{name}{part}" for name in names for part in ("", ", bound")]
    writer.writerow(["axis", "value", "layout", "rung", "verdict", "reason", *bounds])
    for verdict in verdicts:
        case = verdict.case
        row = [case.axis, case.extreme.value, case.layout, case.rung.name, verdict.word, verdict.reason]
        for name in names:
            figure = verdict.figures.get(name)
            row += [repr(figure.value), repr(figure.bound)] if figure else ["", ""]
        writer.writerow(row)
    return write_text(path, stream.getvalue())
