"""The levels of fidelity on a terminal: a line each, with its errors in the wanted outputs and its cost."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from .choice import cheapest, why_not
from .rows import PEER, Row

# the largest error of a level shown where none is asked for
USUAL_ERROR = 0.01
# columns that any table fits in
_WIDE = 10_000


def at_levels(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> list[Row]:
    """A row for each fidelity and method: its cheapest that meets the error, else its most accurate.

    The cheapest is found as in choice.recommend, so the recommended row is one of these.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        levels.setdefault(row.level, []).append(row)
    return [
        cheapest([row for row in level if not why_not(row, error, wanted)])
        or min(level, key=lambda row: row.worst(wanted))
        for level in levels.values()
    ]


def _table(rows: Sequence[Row], wanted: Sequence[str], largest: bool) -> Any:
    """A column for each wanted output, or one for the largest error and one for where it is."""
    from rich import box
    from rich.table import Table

    def text(number: float, form: str) -> str:
        return "-" if math.isnan(number) else format(number, form)

    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for heading in ("level of fidelity", "setting"):
        table.add_column(heading, no_wrap=True)
    for heading in ("error",) if largest else wanted:
        table.add_column(heading.replace("_", " "), justify="right")
    table.add_column("ms per s", justify="right")
    if largest:
        table.add_column("largest error in", no_wrap=True)
    for row in rows:
        known = {name: row.errors.get(name, math.nan) for name in wanted}
        # an output that nothing is known of counts as the worst
        worst = [max(known, key=lambda name: (math.isnan(known[name]), known[name]))] if largest else []
        errors = [text(known[name], ".1e") for name in worst or wanted]
        level = row.method if row.fidelity == PEER else row.level
        table.add_row(level, row.setting, *errors, text(1e3 * row.wall_time, ".3g"), *worst)
    return table


def print_levels(title: str, rows: Sequence[Row], wanted: Sequence[str], error: float | None = None) -> None:
    """Print a line for each level of fidelity: its errors in the wanted outputs, and its cost.

    Where the terminal is too narrow for all of these outputs, the one with the largest error is named.

    Args:
        title: of the table. rows: measured, in one communication step. wanted: names in Row.errors.
        error: largest allowed; by default USUAL_ERROR.
    """
    from ..common.terminal import terminal

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
