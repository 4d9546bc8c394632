"""The table of docs/coupling.md from the committed rows; the text around it is written by hand."""

import csv
from pathlib import Path

HERE = Path(__file__).parent
BEGIN, END = "<!-- table: coupling_urban.csv -->\n", "<!-- end of table -->\n"
HEADS = (
    *("coupling", "step, ms", "engine, kJ", "load, kJ", "not accounted for, %", "gross, %"),
    "steps of the FMU a second",
)


def urban_table():
    """Lines of the energy balance over the urban cycle."""
    yield f"| {' | '.join(HEADS)} |\n"
    yield f"|{'---|' * len(HEADS)}\n"
    with (HERE / "coupling_urban.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            step, engine, output, residual, gross, cost = (
                float(row[name])
                for name in ("step [s]", "engine [J]", "output [J]", "residual", "gross", "cost [1/s]")
            )
            lost = f"{round(100 * residual, 2) + 0.0:.2f}"  # no sign on what rounds to nothing
            yield (
                f"| {row['scheme']} | {1e3 * step:g} | {engine / 1e3:.1f} | {output / 1e3:.1f} | {lost}"
                f" | {100 * gross:.1f} | {cost:.0f} |\n"
            )


def page():
    """The page with its table made anew."""
    head, _, rest = (HERE / "coupling.md").read_text(encoding="utf-8").partition(BEGIN)
    return head + BEGIN + "".join(urban_table()) + END + rest.partition(END)[2]
