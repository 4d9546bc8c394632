"""Table of the fidelity levels on the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..common.terminal import terminal
from .choice import best_rows
from .rows import Row


def print_levels(title: str, rows: Sequence[Row], outputs: Sequence[str], error: float = 0.01) -> None:
    """Print a table with the maximum error and the run time of each level.

    Args:
        title: Title of the table.
        rows: Measured rows with one communication step.
        outputs: Names of the outputs.
        error: Allowed relative error.
    """
    from rich import box
    from rich.table import Table

    def text(number: float, form: str) -> str:
        return "-" if math.isnan(number) else format(number, form)

    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for heading in ("fidelity level", "setting", "error", "maximum in", "ms per s"):
        table.add_column(heading, no_wrap=heading != "maximum in")
    for row in best_rows(rows, error, outputs):
        maximum, output = row.max_error_of(outputs)
        cost = text(1e3 * row.wall_time, ".3g")
        table.add_row(row.level, row.setting, text(maximum, ".1e"), output.replace("_", " "), cost)
    console = terminal()
    console.print(title, style="bold")
    console.print(
        f"Each level at its cheapest setting with an error of at most {error:g}, otherwise at its most"
        f" accurate setting; communication step {rows[0].communication_step:g} s;"
        " kernel time in ms per simulated second"
    )
    console.print(table)
