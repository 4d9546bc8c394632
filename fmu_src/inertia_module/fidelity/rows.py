"""Measurements of a run as a row; rows as CSV, for machines and in lines of text."""

from __future__ import annotations

import csv
import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..harness import results
from ..harness.simulate import Progress
from .levels import Level

PEER = "peer"
# what a run may end with: refusals, missing libraries, integrators that give up
FAILURES = (ValueError, RuntimeError, ArithmeticError, MemoryError)


@dataclass(frozen=True)
class Row:
    """Measurements of one run.

    Attributes:
        fidelity: its name, or "peer". method: of integration. setting: such as "tolerance 1e-06".
        communication_step: s. errors: by name, NaN where nothing is known.
        wall_time: s per simulated second, of the integration alone. evaluations: of the right-hand side.
        switches: counted, NaN where they are not. failure: why there is nothing measured, else "".
        loop_time: s per simulated second of the module with what is around it, NaN where there is nothing.
    """

    fidelity: str
    method: str
    setting: str
    communication_step: float
    errors: Mapping[str, float] = field(default_factory=dict)
    wall_time: float = math.nan
    evaluations: float = math.nan
    switches: float = math.nan
    failure: str = ""
    loop_time: float = math.nan

    @property
    def level(self) -> str:
        """Fidelity and method, such as "rigid, event"."""
        return ", ".join(filter(None, (self.fidelity, self.method)))

    @property
    def label(self) -> str:
        """Fidelity, method and setting."""
        return ", ".join(filter(None, (self.level, self.setting)))

    def worst(self, wanted: Sequence[str]) -> float:
        """Largest error of the wanted ones; infinite where one is not known."""
        errors = [self.errors.get(name, math.nan) for name in wanted]
        unknown = self.failure or any(map(math.isnan, errors))
        return math.inf if unknown else max(errors, default=math.inf)


# what is to be run, nothing of it measured, and what measures it: gives fields of Row by name
Attempt = tuple[Row, Callable[[Progress], dict[str, Any]]]


def head_of(level: Level, step: float) -> Row:
    """Make the row of a level of the module in communication steps, s, before anything is measured."""
    return Row(level.fidelity_name, level.method_name, level.setting, step)


def attempt_all(
    attempts: Sequence[Attempt], progress: Progress | None = None, begin: float = 0.0
) -> list[Row]:
    """Make all runs; what fails is a row with the reason.

    Args:
        attempts: the runs; each is given a function to tell how much of it is done (0 to 1).
        progress: told how much is done. begin: share that was done before.
    """
    tell = progress or (lambda done: None)
    share = (1.0 - begin) / max(len(attempts), 1)
    rows = []
    for number, (head, run) in enumerate(attempts):
        start = begin + number * share
        try:
            found = run(lambda done, start=start: tell(start + done * share))  # type: ignore[misc]
        except FAILURES as error:
            found = {"failure": " ".join(str(error).split()) or type(error).__name__}
        rows.append(dataclasses.replace(head, **found))
        tell(start + share)
    return rows


# --- rows as text ---

_HEADS = ("fidelity", "method", "setting", "communication_step [s]")
_COSTS = {
    "wall_time_per_second [s]": "wall_time",
    "loop_time_per_second [s]": "loop_time",
    "rhs_evaluations": "evaluations",
    "contact_switches": "switches",
}


def write_rows(path: Path, rows: Sequence[Row]) -> Path:
    """Write all rows as CSV, failures too; whole or not at all."""
    names = list(dict.fromkeys(name for row in rows for name in row.errors))
    lines = []
    for row in rows:
        numbers = [row.errors.get(name, math.nan) for name in names]
        numbers += [getattr(row, name) for name in _COSTS.values()]
        cells = ["" if math.isnan(value) else float(value) for value in numbers]
        lines.append([row.fidelity, row.method, row.setting, row.communication_step, *cells, row.failure])
    headings = [*_HEADS, *(f"error {name}" for name in names), *_COSTS, "failure"]
    return results.write_rows(path, headings, lines)


def read_rows(path: Path) -> list[Row]:
    """Read rows that write_rows has written.

    Raises:
        OSError: there is no such file. ValueError: it is another table.
    """
    table = csv.DictReader(path.read_text().splitlines())
    if tuple(table.fieldnames or ())[: len(_HEADS)] != _HEADS:
        raise ValueError(f"{path} must begin with the headings {', '.join(_HEADS)}")
    rows = []
    for line in table:
        fidelity, method, setting, step, failure = (line.pop(name) for name in (*_HEADS, "failure"))
        numbers = {name: float(text) if text else math.nan for name, text in line.items()}
        costs = {cost: numbers.pop(name) for name, cost in _COSTS.items()}
        errors = {name.removeprefix("error "): value for name, value in numbers.items()}
        rows.append(Row(fidelity, method, setting, float(step), errors, failure=failure, **costs))
    return rows


def as_dict(row: Row) -> dict[str, Any]:
    """Give a row for machines: what is not known is None."""

    def known(value: float) -> float | None:
        return value if math.isfinite(value) else None

    heads = ("fidelity", "method", "setting", "communication_step")
    head = {name: getattr(row, name) for name in heads}
    costs = {name.partition(" ")[0]: known(getattr(row, cost)) for name, cost in _COSTS.items()}
    errors = {name: known(value) for name, value in row.errors.items()}
    return {**head, "errors": errors, **costs, "failure": row.failure}


def failure_lines(rows: Sequence[Row]) -> list[str]:
    """Say in a line for each kind of run that failed why it did."""
    labels: dict[str, dict[str, None]] = {}
    for row in rows:
        if row.failure:
            labels.setdefault(row.failure, {})[row.label] = None
    return [f"failed: {'; '.join(found)}: {reason}" for reason, found in labels.items()]
