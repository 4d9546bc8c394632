"""The map as a small table: a row for each extreme and layout, a cell for each rung.

A cell holds the verdict, the power of ten below which all relative errors stayed, and why it is not
exact: coarse enough to be the same on any machine.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...results import TableError, write_text
from .case import RUNGS
from .verdict import BROKEN, EXACT, REFUSED, WORDS, Verdict, cause

HEADINGS = ("axis", "value", "layout", *(rung.name for rung in RUNGS))
# below this errors are rounding
LEAST_POWER = -15
SEPARATOR = " | "


@dataclass(frozen=True)
class Cell:
    """Verdict on one rung: word, power of ten of the largest relative error (or None), and a reason."""

    word: str
    power: int | None = None
    reason: str = ""

    def __str__(self) -> str:
        size = "" if self.power is None else f"1e{self.power:+03d}"
        return SEPARATOR.join(part for part in (self.word, size, self.reason) if part)

    def agrees_with(self, other: Cell) -> bool:
        """Whether another machine may have measured it: the same verdict, errors within a power of ten."""
        if self.word != other.word or self.reason != other.reason:
            return False
        if self.power is None or other.power is None:
            return self.power is other.power
        return abs(self.power - other.power) <= 1


@dataclass(frozen=True)
class Row:
    """An extreme with its cells by name of the rung (only those it says something about)."""

    axis: str
    value: str
    layout: str
    cells: dict[str, Cell]


def cell_of(verdict: Verdict) -> Cell:
    """A verdict, coarsely."""
    if verdict.word not in (REFUSED, BROKEN):
        error = verdict.error
        power = LEAST_POWER if error == 0.0 else max(LEAST_POWER, math.ceil(math.log10(error)))
        missed = [name for name, figure in verdict.figures.items() if not figure.holds]
        return Cell(verdict.word, power, ", ".join(missed))
    return Cell(verdict.word, None, cause(verdict.reason))


def rows_of(verdicts: Iterable[Verdict]) -> list[Row]:
    """Rows of these verdicts, in their order."""
    rows: dict[tuple[str, str, str], dict[str, Cell]] = {}
    for verdict in verdicts:
        key = (verdict.case.axis, verdict.case.extreme.value, verdict.case.layout)
        rows.setdefault(key, {})[verdict.case.rung.name] = cell_of(verdict)
    return [Row(*key, cells) for key, cells in rows.items()]


def reasons(rows: Iterable[Row]) -> list[str]:
    """A line for each reason of a verdict that is not exact, with where it is given."""
    found: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        for rung, cell in row.cells.items():
            if cell.word != EXACT:
                found.setdefault((cell.word, cell.reason), []).append(f"{row.value} ({row.layout}, {rung})")
    lines = []
    for (word, reason), places in found.items():
        where = "; ".join(places) if len(places) <= 6 else f"{len(places)} cases, the first: {places[0]}"
        lines.append(f"{word}: {reason}. {where}.")
    return lines


def write_rows(path: Path, rows: Sequence[Row]) -> Path:
    """Write the rows as CSV, whole or not at all."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(HEADINGS)
    for row in rows:
        cells = [str(row.cells.get(rung.name, "")) for rung in RUNGS]
        writer.writerow([row.axis, row.value, row.layout, *cells])
    return write_text(path, stream.getvalue())


def _read_cell(text: str, line: int) -> Cell:
    word, *rest = text.split(SEPARATOR)
    if word not in WORDS:
        raise TableError(f"line {line}: {text!r} is refused: allowed are {', '.join(WORDS)}")
    power = int(rest.pop(0)[2:]) if rest and rest[0].startswith("1e") else None
    return Cell(word, power, SEPARATOR.join(rest))


def read_rows(path: Path) -> list[Row]:
    """Rows that write_rows has written.

    Raises:
        TableError: other headings, or a cell that is no verdict.
    """
    lines = list(csv.reader(io.StringIO(path.read_text())))
    if not lines or tuple(lines[0]) != HEADINGS:
        raise TableError(f"{path} is refused: allowed are the headings {', '.join(HEADINGS)}")
    rows = []
    for number, (axis, value, layout, *texts) in enumerate(lines[1:], 2):
        named = zip(HEADINGS[3:], texts, strict=True)
        rows.append(
            Row(axis, value, layout, {name: _read_cell(text, number) for name, text in named if text})
        )
    return rows
