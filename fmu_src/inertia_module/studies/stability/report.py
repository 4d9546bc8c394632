"""The map for people, a line for each level of fidelity on a terminal, and for machines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from ...terminal import terminal
from .case import RUNGS
from .table import Row, reasons
from .verdict import WORDS, Verdict


def print_rows(rows: Sequence[Row]) -> None:
    """Print a line for each axis and level of fidelity, below them what is not exact, and the counts."""
    from rich import box
    from rich.table import Table

    console = terminal()
    for axis in dict.fromkeys(row.axis for row in rows):
        here = [row for row in rows if row.axis == axis]
        seen = {cell.word for row in here for cell in row.cells.values()}
        words = [word for word in WORDS if word in seen]
        table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
        table.add_column("level of fidelity", no_wrap=True)
        for word in words:
            table.add_column(word, justify="right", no_wrap=True)
        table.add_column("error up to", justify="right")
        for rung in RUNGS:
            cells = [row.cells[rung.name] for row in here if rung.name in row.cells]
            counted = Counter(cell.word for cell in cells)
            powers = [cell.power for cell in cells if cell.power is not None]
            largest = f"1e{max(powers):+03d}" if powers else "-"
            if cells:
                table.add_row(rung.name, *(str(counted[word]) for word in words), largest)
        console.print(f"\n{axis}", style="bold")
        console.print(table)
        for line in reasons(here):
            console.print(f"- {line}")
    total = Counter(cell.word for row in rows for cell in row.cells.values())
    console.print("\n" + ", ".join(f"{total[word]} {word}" for word in WORDS))


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
