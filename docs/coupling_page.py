"""Write the table of docs/verification/coupling.md from coupling_urban.csv."""

import csv
from pathlib import Path

HERE = Path(__file__).parent / "verification"
BEGIN, END = "<!-- table: coupling_urban.csv -->\n", "<!-- end of table -->\n"
HEADINGS = (
    *("scheme", "step, ms", "engine, kJ", "load, kJ", "interface loss, %", "gross loss, %"),
    "FMU steps per second",
)


def urban_table():
    """Yield the lines of the energy balance over the urban cycle."""
    yield f"| {' | '.join(HEADINGS)} |\n"
    yield f"|{'---|' * len(HEADINGS)}\n"
    with (HERE / "coupling_urban.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            step, engine, output, residual, gross, cost = (
                float(row[name])
                for name in ("step [s]", "engine [J]", "output [J]", "residual", "gross", "cost [1/s]")
            )
            loss = f"{round(100 * residual, 2) + 0.0:.2f}"  # + 0.0 removes the sign of a negative zero
            yield (
                f"| {row['scheme']} | {1e3 * step:g} | {engine / 1e3:.1f} | {output / 1e3:.1f} | {loss}"
                f" | {100 * gross:.1f} | {cost:.0f} |\n"
            )


def page():
    """Return the page with its table regenerated."""
    head, _, rest = (HERE / "coupling.md").read_text(encoding="utf-8").partition(BEGIN)
    return head + BEGIN + "".join(urban_table()) + END + rest.partition(END)[2]
