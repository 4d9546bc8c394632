"""The size of the house against its budgets, folder by folder: `make size`.

Budgets count lines as the formatter leaves them, docstrings included; statements are counted beside them,
for a line that is saved by denser code is not saved.
"""

from __future__ import annotations

import ast
import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated

import typer
from matplotlib.figure import Figure

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "fmu_src" / "inertia_module"
# as it was before the studies left the package; columns as of Room
BEFORE = ROOT / "docs" / "house.csv"
# share of a budget that may be exceeded
MARGIN = 0.05

# rooms from the ground up: name, folders, most lines
ROOMS: tuple[tuple[str, tuple[str, ...], int], ...] = (
    ("kernel", ("kernel",), 5500),
    ("compiling", ("compiling",), 550),
    ("contract", ("contract",), 800),
    ("fmu", ("fmu",), 1600),
    ("harness", ("harness", "memory.py"), 1800),
    ("loops", ("loops",), 1400),
    ("bridge", ("bridge",), 850),
    ("scene", ("scene",), 1900),
    ("fidelity", ("fidelity",), 700),
    ("jobs", ("jobs",), 2500),
    ("figures", ("figures",), 750),
    ("export, page, cli, common", ("export", "page", "cli.py", "common"), 1650),
)
PACKAGE_LINES = 20_000
BESIDE = (("studies", "studies", 5400), ("tests", "tests", 15_000))
# rooms that are over their budget today may not grow beyond this; what is mended is struck here
OVER: Mapping[str, int] = {
    "kernel": 7550,
    "harness": 2025,
    "jobs": 3074,
    "figures": 1098,
    "package": 22591,
    "studies": 6713,
    "tests": 16686,
}


@dataclass(frozen=True)
class Room:
    """Size of a part of the house.

    Attributes:
        name: of it. files, lines, statements: of Python. budget: lines at most, with MARGIN.
    """

    name: str
    files: int
    lines: int
    statements: int
    budget: int

    @property
    def allowed(self) -> int:
        """Lines at which the test of the budgets turns red."""
        return max(int((1.0 + MARGIN) * self.budget), OVER.get(self.name, 0))


@cache
def statements(text: str) -> int:
    """Number of statements of a Python file, docstrings left out."""

    def is_docstring(node: ast.AST) -> bool:
        return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)

    return sum(isinstance(node, ast.stmt) and not is_docstring(node) for node in ast.walk(ast.parse(text)))


def room(name: str, places: Iterable[Path], budget: int) -> Room:
    """Count the Python files that are, or are below, some places."""
    files = (path for place in places for path in ([place] if place.is_file() else place.rglob("*.py")))
    texts = [path.read_text(encoding="utf-8") for path in files]
    lines = sum(text.count("\n") for text in texts)
    return Room(name, len(texts), lines, sum(map(statements, texts)), budget)


def house() -> list[Room]:
    """Rooms of the package from the ground up, the package as a whole, studies and tests."""
    rooms = [room(name, [PACKAGE / folder for folder in folders], most) for name, folders, most in ROOMS]
    rooms.append(room("package", [PACKAGE], PACKAGE_LINES))
    return rooms + [room(name, [ROOT / folder], budget) for name, folder, budget in BESIDE]


def picture(houses: Mapping[str, Mapping[str, int]]) -> Figure:
    """Draw houses beside each other: the kernel on the ground, a room a bar as long as its lines.

    Args:
        houses: title, and lines of each room by name.
    """
    from inertia_module.common.colours import BLUE, GREY, ORANGE

    names = [name for name, _, _ in ROOMS]
    figure = Figure(figsize=(8.0, 4.8), layout="constrained")
    axes, height = figure.subplots(), 0.8 / len(houses)
    for n, ((title, lines), colour) in enumerate(zip(houses.items(), (GREY, BLUE, ORANGE), strict=True)):
        label = f"{title}: {lines['package']} lines, beside them studies {lines['studies']}"
        places = [place + n * height for place in range(len(names))]
        bars = axes.barh(places, [lines[name] for name in names], height, color=colour, label=label)
        axes.bar_label(bars, fontsize=6, padding=2)
    axes.set_yticks([place + height for place in range(len(names))], names)
    axes.set_xlabel("lines")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize=8, frameon=False)
    return figure


def main(
    draw: Annotated[Path | None, typer.Option("--picture", metavar="FILE", help="Draw it too.")] = None,
) -> None:
    """Print folder, files, lines, statements and budget of each room."""
    from inertia_module.harness.results import write_figure

    rooms = house()
    typer.echo(f"{'room':28}{'files':>7}{'lines':>8}{'statements':>12}{'budget':>8}")
    for found in rooms:
        over = f"  over by {found.lines - found.budget}" if found.lines > found.budget else ""
        typer.echo(
            f"{found.name:28}{found.files:7}{found.lines:8}{found.statements:12}{found.budget:8}{over}"
        )
    if draw is not None:
        with BEFORE.open(encoding="utf-8", newline="") as rows:
            before = {row["room"]: int(row["lines"]) for row in csv.DictReader(rows)}
        now, budgets = ({one.name: getattr(one, size) for one in rooms} for size in ("lines", "budget"))
        write_figure(draw, picture({"before": before, "now": now, "as it shall be": budgets}))


if __name__ == "__main__":
    typer.run(main)
