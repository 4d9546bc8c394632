"""The map of the extremes: a row for each extreme and layout, a cell for each level; as table and picture.

A cell holds the verdict, the power of ten below which all relative errors stayed, and why it is not
exact: coarse enough to be the same on any machine.
"""

from __future__ import annotations

import csv
import dataclasses
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Picture
from matplotlib.patches import Patch, Rectangle

from inertia_module.common.colours import BLUE, GREEN, ORANGE, VERMILION
from inertia_module.common.errors import did_you_mean
from inertia_module.common.terminal import terminal
from inertia_module.harness import results
from inertia_module.harness.results import TableError
from inertia_module.harness.simulate import Progress

from .extremes import MECHANISMS, Case, axes
from .motion import LEVELS
from .trial import BROKEN, EXACT, OUTCOMES, REFUSED, Verdict, cause, judge, try_case

PLACES = ("axis", "value", "layout")
HEADINGS = (*PLACES, *(level.name for level in LEVELS))
# below this errors are rounding
LEAST_POWER = -15
SEPARATOR = " | "


def chosen_cases(only: str | None = None, quick: bool = False) -> list[Case]:
    """Cases of all axes, or of one.

    Args:
        only: name of an axis. quick: leave out those that take long.

    Raises:
        ValueError: there is none of this name.
    """
    if only is not None and only not in axes():
        raise ValueError(f"axis must be one of the map, is {only} {did_you_mean(only, axes())}")
    chosen = [only] if only else axes()
    return [case for axis in chosen for case in axes()[axis] if not (quick and case.slow)]


def run_study(chosen: Sequence[Case], report: Progress = lambda done: None) -> list[Verdict]:
    """Verdicts on these cases, in their order; report is told how much is done (0 to 1)."""
    verdicts = []
    for number, case in enumerate(chosen, 1):
        verdicts.append(judge(try_case(case)))
        report(number / len(chosen))
    return verdicts


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
        case = verdict.case
        rows.setdefault((case.axis, case.value, case.layout), {})[case.level.name] = cell_of(verdict)
    return [Row(*key, cells) for key, cells in rows.items()]


def write_rows(path: Path, rows: Iterable[Row]) -> Path:
    """Write the rows as CSV, whole or not at all."""
    cells = (
        [row.axis, row.value, row.layout, *(row.cells.get(level.name, "") for level in LEVELS)]
        for row in rows
    )
    return results.write_rows(path, HEADINGS, cells)


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
        axis, value, layout = (line.pop(name) for name in PLACES)
        cells = {name: _cell(text, table.line_num) for name, text in line.items() if text}
        rows.append(Row(axis, value, layout, cells))
    return rows


def _cell(text: str, line: int) -> Cell:
    outcome, *rest = text.split(SEPARATOR)
    if outcome not in OUTCOMES:
        raise TableError(f"line {line}: a verdict must be one of {', '.join(OUTCOMES)}, is {text!r}")
    power = int(rest.pop(0)[2:]) if rest and rest[0].startswith("1e") else None
    return Cell(outcome, power, SEPARATOR.join(rest))


def as_records(verdicts: Iterable[Verdict]) -> list[dict[str, Any]]:
    """Verdicts as plain dictionaries with all figures and bounds."""
    records = []
    for verdict in verdicts:
        case = verdict.case
        records.append(
            {
                **{"axis": case.axis, "value": case.value, "layout": case.layout},
                **{"level": case.level.name, "verdict": verdict.outcome, "reason": verdict.reason},
                "figures": {name: dataclasses.asdict(figure) for name, figure in verdict.figures.items()},
            }
        )
    return records


def write_cases(path: Path, verdicts: Sequence[Verdict]) -> Path:
    """Write a row for each case with every figure and its bound, as CSV, whole or not at all."""
    names = list(dict.fromkeys(name for verdict in verdicts for name in verdict.figures))
    rows = []
    for record in as_records(verdicts):
        figures = record.pop("figures")
        parts = (figures.get(name, {}).get(part, "") for name in names for part in ("value", "bound"))
        rows.append([*record.values(), *parts])
    heads = [head for name in names for head in (name, f"{name}, bound")]
    return results.write_rows(path, [*PLACES, "level", "verdict", "reason", *heads], rows)


# --- printed ---


def counts(rows: Sequence[Row]) -> dict[str, tuple[Counter[str], str]]:
    """For each level with a verdict: how many there are of each, and the largest error as a power of ten."""
    found = {}
    for level in LEVELS:
        cells = [row.cells[level.name] for row in rows if level.name in row.cells]
        powers = [cell.power for cell in cells if cell.power is not None]
        if cells:
            largest = f"1e{max(powers):+03d}" if powers else "-"
            found[level.name] = Counter(cell.outcome for cell in cells), largest
    return found


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


def print_rows(rows: Sequence[Row]) -> None:
    """Print a line for each axis and level of fidelity, below them what is not exact, and the counts."""
    from rich import box
    from rich.table import Table

    console = terminal()
    for axis in dict.fromkeys(row.axis for row in rows):
        here = [row for row in rows if row.axis == axis]
        counted = counts(here)
        outcomes = [name for name in OUTCOMES if any(count[name] for count, _ in counted.values())]
        table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
        table.add_column("level of fidelity", no_wrap=True)
        for name in outcomes:
            table.add_column(name, justify="right", no_wrap=True)
        table.add_column("error up to", justify="right")
        for level, (count, largest) in counted.items():
            table.add_row(level, *(str(count[name]) for name in outcomes), largest)
        console.print(f"\n{axis}", style="bold")
        console.print(table)
        for line in reasons(here):
            console.print(f"- {line}")
    total = sum((count for count, _ in counts(rows).values()), Counter[str]())
    console.print("\n" + ", ".join(f"{total[name]} {name}" for name in OUTCOMES))


# --- drawn ---

COLOURS = dict(zip(OUTCOMES, (GREEN, BLUE, ORANGE, "#BBBBBB", VERMILION), strict=True))
COLUMNS = tuple((mechanism.layout, level.name) for mechanism in MECHANISMS for level in LEVELS)
ROW_HEIGHT = 0.17
# sheets side by side, so that the picture is no ribbon
SHEETS = 3


def verdict_map(rows: Sequence[Row]) -> Picture:
    """Draw every extreme: colours are verdicts, numbers powers of ten of the largest relative error.

    Args:
        rows: of rows_of or read_rows.
    """
    extremes: dict[tuple[str, str], dict[str, Row]] = {}
    for row in rows:
        extremes.setdefault((row.axis, row.value), {})[row.layout] = row
    sheets = SHEETS if len(extremes) > 60 else 1
    height = -(-len(extremes) // sheets)
    picture = Picture(figsize=(5.2 * sheets, 2.2 + ROW_HEIGHT * height), dpi=120, layout="constrained")
    for n, sheet in enumerate(picture.subplots(1, sheets, squeeze=False)[0]):
        last = ""
        for y, ((axis, value), layouts) in enumerate(list(extremes.items())[n * height : (n + 1) * height]):
            _draw_row(sheet, y, layouts)
            sheet.text(len(COLUMNS) + 0.15, y + 0.5, value, ha="left", va="center", fontsize=6)
            if axis != last:
                sheet.axhline(y, color="black", linewidth=0.6)
                label = {"ha": "right", "va": "center", "fontsize": 6.5, "fontweight": "bold"}
                sheet.text(-0.15, y + 0.5, f"{axis}: ", **label)
                last = axis
        sheet.set_xticks([x + 0.5 for x in range(len(COLUMNS))])
        sheet.set_xticklabels([f"{layout}, {level}" for layout, level in COLUMNS], rotation=90, fontsize=6)
        sheet.set_yticks([])
        _frame(sheet, len(COLUMNS), 0.0, height)
    _legend(picture)
    return picture


def _draw_row(sheet: Axes, y: int, layouts: dict[str, Row]) -> None:
    for x, (layout, level) in enumerate(COLUMNS):
        cell = layouts[layout].cells.get(level) if layout in layouts else None
        if cell is None:
            continue
        sheet.add_patch(Rectangle((x + 0.04, y + 0.06), 0.92, 0.88, color=COLOURS[cell.outcome], linewidth=0))
        if cell.power is not None:
            sheet.text(
                x + 0.5, y + 0.52, f"{cell.power}", ha="center", va="center", fontsize=5, color="white"
            )


def summary(rows: Sequence[Row]) -> Picture:
    """Draw what came out of each axis, both layouts together: a bar for each level, parted by verdicts.

    Args:
        rows: of rows_of or read_rows.
    """
    names = list(dict.fromkeys(row.axis for row in rows))
    picture = Picture(figsize=(8.5, 1.0 + 0.24 * len(names)), dpi=120, layout="constrained")
    sheet = picture.subplots()
    for y, axis in enumerate(names):
        part = [row for row in rows if row.axis == axis]
        for x, level in enumerate(LEVELS):
            found = Counter(row.cells[level.name].outcome for row in part if level.name in row.cells)
            left = x + 0.03
            for outcome, colour in COLOURS.items():
                width = 0.94 * found[outcome] / max(1, found.total())
                sheet.barh(y, width, left=left, color=colour, height=0.8)
                left += width
            if found:
                text = f"{found[EXACT]} of {found.total()}"
                sheet.text(x + 0.5, y, text, ha="center", va="center", fontsize=6.5)
    sheet.set_yticks(range(len(names)), names, fontsize=8)
    sheet.set_xticks([x + 0.5 for x in range(len(LEVELS))], [level.name for level in LEVELS], fontsize=8)
    _frame(sheet, len(LEVELS), -0.5, len(names) - 0.5)
    _legend(picture)
    return picture


def _frame(sheet: Axes, width: float, top: float, bottom: float) -> None:
    """Let rows run downwards below the names of the columns."""
    sheet.set_xlim(0, width)
    sheet.set_ylim(bottom, top)
    sheet.xaxis.tick_top()
    sheet.tick_params(length=0)
    sheet.spines[:].set_visible(False)


def _legend(picture: Picture) -> None:
    picture.legend(
        handles=[Patch(color=colour, label=outcome) for outcome, colour in COLOURS.items()],
        loc="outside lower center",
        ncols=len(COLOURS),
        fontsize=8,
        frameon=False,
    )
