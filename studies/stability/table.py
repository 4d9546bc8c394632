"""The map as a table: a row for each extreme and layout, a cell for each level of fidelity.

A cell holds the verdict, the power of ten below which all relative errors stayed, and why it is not
exact: coarse enough to be the same on any machine.
"""

from __future__ import annotations

import csv
import dataclasses
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from inertia_module.harness import results
from inertia_module.harness.results import TableError

from .case import LEVELS
from .verdict import BROKEN, EXACT, OUTCOMES, REFUSED, Verdict, cause

HEADINGS = ("axis", "value", "layout", *(level.name for level in LEVELS))
# below this errors are rounding
LEAST_POWER = -15
SEPARATOR = " | "


@dataclass(frozen=True)
class Cell:
    """Verdict at one level: outcome, power of ten of the largest relative error (or None), and a reason."""

    outcome: str
    power: int | None = None
    reason: str = ""

    def __str__(self) -> str:
        size = "" if self.power is None else f"1e{self.power:+03d}"
        return SEPARATOR.join(part for part in (self.outcome, size, self.reason) if part)


@dataclass(frozen=True)
class Row:
    """An extreme with its cells by name of the level (only those it says something about)."""

    axis: str
    value: str
    layout: str
    cells: dict[str, Cell]


def cell_of(verdict: Verdict) -> Cell:
    """A verdict, coarsely."""
    if verdict.outcome in (REFUSED, BROKEN):
        return Cell(verdict.outcome, None, cause(verdict.reason))
    error = verdict.error
    power = LEAST_POWER if error == 0.0 else max(LEAST_POWER, math.ceil(math.log10(error)))
    return Cell(verdict.outcome, power, ", ".join(verdict.missed))


def rows_of(verdicts: Iterable[Verdict]) -> list[Row]:
    """Rows of these verdicts, in their order."""
    rows: dict[tuple[str, str, str], dict[str, Cell]] = {}
    for verdict in verdicts:
        key = (verdict.case.axis, verdict.case.extreme.value, verdict.case.layout)
        rows.setdefault(key, {})[verdict.case.level.name] = cell_of(verdict)
    return [Row(*key, cells) for key, cells in rows.items()]


def reasons(rows: Iterable[Row]) -> list[str]:
    """A line for each reason of a verdict that is not exact, with where it is given."""
    found: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        for level, cell in row.cells.items():
            if cell.outcome != EXACT:
                places = found.setdefault((cell.outcome, cell.reason), [])
                places.append(f"{row.value} ({row.layout}, {level})")
    return [
        f"{outcome}: {reason}. "
        + ("; ".join(places) if len(places) <= 6 else f"{len(places)} cases, the first: {places[0]}")
        + "."
        for (outcome, reason), places in found.items()
    ]


def write_rows(path: Path, rows: Iterable[Row]) -> Path:
    """Write the rows as CSV, whole or not at all."""
    named = (
        [row.axis, row.value, row.layout, *(row.cells.get(name, "") for name in HEADINGS[3:])] for row in rows
    )
    return results.write_rows(path, HEADINGS, named)


def read_rows(path: Path) -> list[Row]:
    """Rows that write_rows has written.

    Raises:
        TableError: other headings, or a cell that is no verdict.
    """
    table = csv.DictReader(path.read_text().splitlines())
    if tuple(table.fieldnames or ()) != HEADINGS:
        raise TableError(f"{path} must have the headings {', '.join(HEADINGS)}")
    rows = []
    for line in table:
        axis, value, layout = (line.pop(name) for name in HEADINGS[:3])
        cells = {name: _cell(text, table.line_num) for name, text in line.items() if text}
        rows.append(Row(axis, value, layout, cells))
    return rows


def _cell(text: str, line: int) -> Cell:
    outcome, *rest = text.split(SEPARATOR)
    if outcome not in OUTCOMES:
        raise TableError(f"line {line}: a verdict must be one of {', '.join(OUTCOMES)}, is {text!r}")
    power = int(rest.pop(0)[2:]) if rest and rest[0].startswith("1e") else None
    return Cell(outcome, power, SEPARATOR.join(rest))


# --- every case with every figure ---


def as_records(verdicts: Iterable[Verdict]) -> list[dict[str, Any]]:
    """Verdicts as plain dictionaries with all figures and bounds."""
    records = []
    for verdict in verdicts:
        case = verdict.case
        places = {"axis": case.axis, "value": case.extreme.value, "layout": case.layout}
        judged = {"level": case.level.name, "verdict": verdict.outcome, "reason": verdict.reason}
        figures = {name: dataclasses.asdict(figure) for name, figure in verdict.figures.items()}
        records.append({**places, **judged, "figures": figures})
    return records


def write_cases(path: Path, verdicts: Sequence[Verdict]) -> Path:
    """Write a row for each case with every figure and its bound, as CSV, whole or not at all."""
    names = list(dict.fromkeys(name for verdict in verdicts for name in verdict.figures))
    columns = [(name, part) for name in names for part in ("value", "bound")]
    rows = []
    for record in as_records(verdicts):
        figures = record.pop("figures")
        rows.append([*record.values(), *(figures.get(name, {}).get(part, "") for name, part in columns)])
    heads = [name if part == "value" else f"{name}, bound" for name, part in columns]
    return results.write_rows(path, ["axis", "value", "layout", "level", "verdict", "reason", *heads], rows)
