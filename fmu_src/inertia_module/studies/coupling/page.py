"""The table of docs/coupling.md from the committed rows; the text around it is written by hand."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

BEGIN, END = "<!-- table: coupling_urban.csv -->\n", "<!-- end of table -->\n"
_HEADS = (
    "coupling",
    "step, ms",
    "engine, kJ",
    "load, kJ",
    "not accounted for, %",
    "gross, %",
    "steps of the FMU a second",
)


def urban_table(path: Path) -> Iterator[str]:
    """Lines of the energy balance over the urban cycle, in Markdown, from its rows as CSV."""
    yield f"| {' | '.join(_HEADS)} |\n"
    yield f"|{'---|' * len(_HEADS)}\n"
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            step, engine, output, residual, gross, cost = (
                float(row[name]) for name in ("step", "engine", "output", "residual", "gross", "cost")
            )
            lost = f"{round(100 * residual, 2) + 0.0:.2f}"  # no sign on what rounds to nothing
            yield (
                f"| {row['scheme']} | {1e3 * step:g} | {engine / 1e3:.1f} | {output / 1e3:.1f} | {lost}"
                f" | {100 * gross:.1f} | {cost:.0f} |\n"
            )


def coupling_page(folder: Path) -> str:
    """The page with its table made anew.

    Args:
        folder: of the page and of coupling_urban.csv.
    """
    head, _, rest = (folder / "coupling.md").read_text(encoding="utf-8").partition(BEGIN)
    table = "".join(urban_table(folder / "coupling_urban.csv"))
    return head + BEGIN + table + END + rest.partition(END)[2]
