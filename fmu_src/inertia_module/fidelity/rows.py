"""Table of measurements: one row per run, with its errors, its run time or the reason of its failure."""

from __future__ import annotations

import csv
import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic_core import to_jsonable_python

from ..common.equality import ByContent
from ..common.errors import sentence_of
from ..fmi import results
from .levels import Level

_HEADINGS = ("fidelity", "method", "setting", "communication_step [s]")
_COSTS = {
    "wall_time_per_second [s]": "wall_time",
    "rhs_evaluations": "evaluations",
    "contact_switches": "switches",
}
# fidelity in rows of other integrators
PEER = "peer"
# exceptions of a failed run: invalid parameters, missing libraries, failed integrators
FAILURES = (ValueError, RuntimeError, ArithmeticError, MemoryError)


@dataclass(frozen=True, eq=False)
class Row(ByContent):
    """Measurements of one run.

    Attributes:
        fidelity: Name of the fidelity, or PEER.
        method: Integrator of a peer; "" for the module.
        setting: Text of the setting, such as "tolerance 1e-06".
        communication_step: Communication step, s.
        errors: Relative errors by output; NaN without a reference.
        wall_time: Run time of the integration, s per simulated second.
        evaluations: Number of right-hand-side evaluations.
        switches: Number of contact switches; NaN if not counted.
        failure: Reason of a failed run; "" for a successful run.
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

    @classmethod
    def of_level(cls, level: Level, communication_step: float) -> Row:
        """Make the row of a level without measurements.

        Args:
            level: The level.
            communication_step: Communication step, s.
        """
        return cls(level.name, "", level.setting, communication_step)

    @property
    def level(self) -> str:
        """Return the fidelity and, for a peer, the method."""
        return f"{self.fidelity}, {self.method}" if self.method else self.fidelity

    @property
    def label(self) -> str:
        """Return fidelity, method and setting."""
        return f"{self.level}, {self.setting}" if self.setting else self.level

    def max_error_of(self, outputs: Sequence[str]) -> tuple[float, str]:
        """Return the maximum error of outputs and the name of the output; NaN if an output has no error.

        Args:
            outputs: Names of the outputs.
        """
        errors = [(self.errors.get(name, math.nan), name) for name in outputs]
        return max(errors, key=lambda pair: (math.isnan(pair[0]), pair[0]))

    def max_error(self, outputs: Sequence[str]) -> float:
        """Return the maximum error of outputs; infinite if an output has no error or the run failed.

        Args:
            outputs: Names of the outputs.
        """
        error, _ = self.max_error_of(outputs)
        return math.inf if self.failure or math.isnan(error) else error

    def as_dict(self) -> dict[str, Any]:
        """Return the row for JSON; NaN becomes None."""
        heads = ("fidelity", "method", "setting", "communication_step", "errors")
        head = {name: getattr(self, name) for name in heads}
        costs = {name.partition(" ")[0]: getattr(self, cost) for name, cost in _COSTS.items()}
        numbers = {**head, **costs, "failure": self.failure}
        row: dict[str, Any] = to_jsonable_python(numbers, inf_nan_mode="null")
        return row


def attempt(head: Row, measure: Callable[[], dict[str, Any]]) -> Row:
    """Measure a run and return its row; after a failure the row contains the reason.

    Args:
        head: Row without measurements.
        measure: Function that runs the measurement and returns fields of Row by name.
    """
    try:
        fields = measure()
    except FAILURES as error:
        fields = {"failure": sentence_of(error)}
    return dataclasses.replace(head, **fields)


def write_rows(path: Path, rows: Sequence[Row]) -> Path:
    """Write rows, including failed runs, to a CSV file and return its path.

    Args:
        path: Path of the file, which is written atomically.
        rows: The rows.
    """
    names = list(dict.fromkeys(name for row in rows for name in row.errors))
    lines = []
    for row in rows:
        numbers = [row.errors.get(name, math.nan) for name in names]
        numbers += [getattr(row, name) for name in _COSTS.values()]
        cells = ["" if math.isnan(value) else float(value) for value in numbers]
        lines.append([row.fidelity, row.method, row.setting, row.communication_step, *cells, row.failure])
    headings = [*_HEADINGS, *(f"error {name}" for name in names), *_COSTS, "failure"]
    return results.write_rows(path, headings, lines)


def read_rows(path: Path) -> list[Row]:
    """Read rows from a file of write_rows.

    Args:
        path: Path of the file.

    Raises:
        ValueError: The file contains another table.
    """
    table = csv.DictReader(path.read_text().splitlines())
    if tuple(table.fieldnames or ())[: len(_HEADINGS)] != _HEADINGS:
        raise ValueError(f"{path}: the first headings must be {', '.join(_HEADINGS)}")
    rows = []
    for line in table:
        fidelity, method, setting, step, failure = (line.pop(name) for name in (*_HEADINGS, "failure"))
        numbers = {name: float(text) if text else math.nan for name, text in line.items()}
        costs = {cost: numbers.pop(name) for name, cost in _COSTS.items()}
        errors = {name.removeprefix("error "): value for name, value in numbers.items()}
        rows.append(Row(fidelity, method, setting, float(step), errors, failure=failure, **costs))
    return rows


def failure_lines(rows: Sequence[Row]) -> list[str]:
    """Return a line for each reason of failed runs.

    Args:
        rows: The rows.
    """
    labels: dict[str, dict[str, None]] = {}
    for row in rows:
        if row.failure:
            labels.setdefault(row.failure, {})[row.label] = None
    return [f"failed: {'; '.join(names)}: {reason}" for reason, names in labels.items()]
