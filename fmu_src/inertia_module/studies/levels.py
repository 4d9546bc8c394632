"""The levels of fidelity on a terminal: a line each, with its errors in the wanted outputs and its cost."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from .choice import cheapest, why_not
from .trajectory import Row

# the largest error of a level shown where none is asked for
USUAL_ERROR = 0.01
# columns that any table fits in
_WIDE = 10_000


def at_levels(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> list[Row]:
    """A row for each fidelity and method: its cheapest that meets the error, else its most accurate.

    The cheapest is found as in choice.recommend, so the recommended row is one of these.
    """
    levels: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        levels.setdefault((row.rung, row.method), []).append(row)
    return [
        cheapest([row for row in level if not why_not(row, error, wanted)])
        or min(level, key=lambda row: row.worst(wanted))
        for level in levels.values()
    ]


def _worst(row: Row, wanted: Sequence[str]) -> str:
    """The wanted output with the largest error, or one that the row knows nothing of."""
    unknown = [name for name in wanted if math.isnan(row.errors.get(name, math.nan))]
    return unknown[0] if unknown else max(wanted, key=lambda name: row.errors[name])


def _number(value: float, form: str) -> str:
    return "-" if math.isnan(value) else format(value, form)


def _table(rows: Sequence[Row], wanted: Sequence[str], largest: bool) -> Any:
    """A column for each wanted output, or one for the largest error and one for where it is."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for heading in ("level of fidelity", "setting"):
        table.add_column(heading, no_wrap=True)
    for heading in ("error",) if largest else wanted:
        table.add_column(heading.replace("_", " "), justify="right")
    table.add_column("ms per s", justify="right")
    if largest:
        table.add_column("largest error in", no_wrap=True)
    for row in rows:
        level = row.method if row.rung == "peer" else ", ".join(filter(None, (row.rung, row.method)))
        worst = [_worst(row, wanted)] if largest else []
        errors = [_number(row.errors.get(name, math.nan), ".1e") for name in worst or wanted]
        table.add_row(level, row.setting, *errors, _number(1e3 * row.wall_time, ".3g"), *worst)
    return table


def print_levels(title: str, rows: Sequence[Row], wanted: Sequence[str], error: float | None = None) -> None:
    """Print a line for each level of fidelity: its errors in the wanted outputs, and its cost.

    Where the terminal is too narrow for all of these outputs, the one with the largest error is named.

    Args:
        title: of the table. rows: measured, in one communication step. wanted: names in Row.errors.
        error: largest allowed; by default USUAL_ERROR.
    """
    from ..terminal import terminal

    console = terminal()
    allowed = USUAL_ERROR if error is None else error
    levels = at_levels(rows, allowed, wanted)
    console.print(title, style="bold")
    console.print(
        f"Each level at its cheapest setting with errors up to {allowed:g}, else at its most accurate;"
        f" communication step {rows[0].communication_step:g} s; ms of the kernel per simulated second"
    )
    table = _table(levels, wanted, largest=False)
    if console.measure(table, options=console.options.update(width=_WIDE)).minimum > console.width:
        table = _table(levels, wanted, largest=True)
    console.print(table)
