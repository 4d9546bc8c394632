"""What was measured of a run, as a row; rows as CSV, for machines and in lines of text."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
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
    """What was measured of one run.

    Attributes:
        fidelity: its name, or "peer". method: of integration. setting: such as "tolerance 1e-06".
        communication_step: s. errors: by name, NaN where nothing is known.
        wall_time: s per simulated second, of the integration alone. evaluations: of the right-hand side.
        switches: counted, or None. failure: why there is nothing measured, else "".
        loop_time: s per simulated second of the module with what is around it, NaN where there is nothing.
    """

    fidelity: str
    method: str
    setting: str
    communication_step: float
    errors: Mapping[str, float]
    wall_time: float
    evaluations: float
    switches: float | None
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


# fidelity, method and setting by name, and the communication step, s
Head = tuple[str, str, str, float]
# gives the fields of Row that follow those of Head
Attempt = tuple[Head, Callable[[Progress], tuple[Any, ...]]]


def head_of(level: Level, step: float) -> Head:
    """What a level of the module in communication steps, s, is called."""
    return level.fidelity_name, level.method_name, level.setting, step


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
            rows.append(Row(*head, *run(lambda done, start=start: tell(start + done * share))))  # type: ignore[misc]
        except FAILURES as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            rows.append(Row(*head, {}, math.nan, math.nan, None, reason))
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

    def cell(value: float | None) -> str:
        return "" if value is None or math.isnan(value) else repr(float(value))

    names = list(dict.fromkeys(name for row in rows for name in row.errors))
    lines = [
        [row.fidelity, row.method, row.setting, repr(row.communication_step)]
        + [cell(row.errors.get(name)) for name in names]
        + [cell(getattr(row, name)) for name in _COSTS.values()]
        + [row.failure]
        for row in rows
    ]
    return results.write_rows(
        path, [*_HEADS, *(f"error {name}" for name in names), *_COSTS, "failure"], lines
    )


def read_rows(path: Path) -> list[Row]:
    """Rows that write_rows has written.

    Raises:
        OSError: there is no such file. ValueError: it is another table.
    """
    headings, *lines = csv.reader(path.read_text().splitlines())
    if tuple(headings[: len(_HEADS)]) != _HEADS:
        raise ValueError(f"{path} must begin with the headings {', '.join(_HEADS)}")
    rows = []
    for fidelity, method, setting, *cells, failure in lines:
        texts = zip(headings[len(_HEADS) - 1 : -1], cells, strict=True)
        numbers = {name: float(text) if text else math.nan for name, text in texts}
        errors = {name[6:]: value for name, value in numbers.items() if name.startswith("error ")}
        wall_time, loop_time, evaluations, switches = (numbers[name] for name in _COSTS)
        head = fidelity, method, setting, numbers[_HEADS[-1]]
        counted = None if math.isnan(switches) else switches
        rows.append(Row(*head, errors, wall_time, evaluations, counted, failure, loop_time))
    return rows


def as_dict(row: Row) -> dict[str, Any]:
    """A row for machines: what is not known is None."""

    def known(value: float | None) -> float | None:
        return None if value is None or not math.isfinite(value) else value

    return {
        "fidelity": row.fidelity,
        "method": row.method,
        "setting": row.setting,
        "communication_step": row.communication_step,
        "errors": {name: known(value) for name, value in row.errors.items()},
        "wall_time_per_second": known(row.wall_time),
        "loop_time_per_second": known(row.loop_time),
        "rhs_evaluations": known(row.evaluations),
        "contact_switches": known(row.switches),
        "failure": row.failure,
    }


def failure_lines(rows: Sequence[Row]) -> list[str]:
    """One line for each kind of run that failed, with its reason."""
    labels: dict[str, dict[str, None]] = {}
    for row in rows:
        if row.failure:
            labels.setdefault(row.failure, {})[row.label] = None
    return [f"failed: {'; '.join(found)}: {reason}" for reason, found in labels.items()]
