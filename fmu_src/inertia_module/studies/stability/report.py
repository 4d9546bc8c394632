"""The map for people, a table for each axis on a terminal, and for machines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from .case import RUNGS
from .table import Cell, Row
from .verdict import BROKEN, DEGRADED, EXACT, REFUSED, WORDS, Verdict

STYLES = {EXACT: "green", DEGRADED: "yellow", REFUSED: "bright_black", BROKEN: "bold red"}


def _text(cell: Cell | None) -> Text:
    if cell is None:
        return Text("")
    size = "" if cell.power is None else f" 1e{cell.power:+03d}"
    return Text(f"{cell.word}{size}", style=STYLES[cell.word])


def print_rows(rows: Sequence[Row], console: Console | None = None) -> None:
    """Print a table for each axis, with the reasons of what is not exact below it, and the counts."""
    console = console or Console(soft_wrap=True)
    for axis in dict.fromkeys(row.axis for row in rows):
        here = [row for row in rows if row.axis == axis]
        table = Table(title=axis, title_justify="left", title_style="bold")
        table.add_column("value")
        table.add_column("layout")
        names = [rung.name for rung in RUNGS if any(rung.name in row.cells for row in here)]
        for name in names:
            table.add_column(name)
        for row in here:
            table.add_row(row.value, row.layout, *(_text(row.cells.get(name)) for name in names))
        console.print(table)
        cells = [cell for row in here for cell in row.cells.values()]
        reasons = Counter((cell.word, cell.reason) for cell in cells if cell.word != EXACT)
        for (word, reason), count in reasons.items():
            console.print(Text(f"  {word} ({count}): {reason}", style=STYLES[word]))
    total = Counter(cell.word for row in rows for cell in row.cells.values())
    console.print(", ".join(f"{total[word]} {word}" for word in WORDS))


def as_records(verdicts: Sequence[Verdict]) -> list[dict[str, Any]]:
    """Verdicts as plain dictionaries with all figures and bounds."""
    return [
        {
            "axis": verdict.case.axis,
            "value": verdict.case.extreme.value,
            "layout": verdict.case.layout,
            "rung": verdict.case.rung.name,
            "verdict": verdict.word,
            "reason": verdict.reason,
            "figures": {
                name: {"value": figure.value, "bound": figure.bound}
                for name, figure in verdict.figures.items()
            },
        }
        for verdict in verdicts
    ]
