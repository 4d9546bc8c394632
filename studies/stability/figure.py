"""The map as pictures: what came out of each axis of extremes, and every extreme, by level of fidelity."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from inertia_module.common.colours import BLUE, GREEN, ORANGE, VERMILION

from .case import LEVELS
from .mechanisms import MECHANISMS
from .table import Row
from .verdict import OUTCOMES

COLOURS = dict(zip(OUTCOMES, (GREEN, BLUE, ORANGE, "#BBBBBB", VERMILION), strict=True))
COLUMNS = tuple((mechanism.layout, level.name) for mechanism in MECHANISMS for level in LEVELS)
ROW_HEIGHT = 0.17
# sheets side by side, so that the picture is no ribbon
SHEETS = 3


def _extremes(rows: Sequence[Row]) -> dict[tuple[str, str], dict[str, Row]]:
    """Rows by axis and value, then by layout."""
    found: dict[tuple[str, str], dict[str, Row]] = {}
    for row in rows:
        found.setdefault((row.axis, row.value), {})[row.layout] = row
    return found


def _draw_row(axes: Axes, y: int, layouts: dict[str, Row]) -> None:
    for x, (layout, level) in enumerate(COLUMNS):
        cell = layouts[layout].cells.get(level) if layout in layouts else None
        if cell is None:
            continue
        axes.add_patch(Rectangle((x + 0.04, y + 0.06), 0.92, 0.88, color=COLOURS[cell.outcome], linewidth=0))
        if cell.power is not None:
            axes.text(x + 0.5, y + 0.52, f"{cell.power}", ha="center", va="center", fontsize=5, color="white")


def _draw_sheet(axes: Axes, part: list[tuple[tuple[str, str], dict[str, Row]]]) -> None:
    last = ""
    for y, ((axis, value), layouts) in enumerate(part):
        _draw_row(axes, y, layouts)
        axes.text(len(COLUMNS) + 0.15, y + 0.5, value, ha="left", va="center", fontsize=6)
        if axis != last:
            axes.axhline(y, color="black", linewidth=0.6)
            axes.text(-0.15, y + 0.5, f"{axis}: ", ha="right", va="center", fontsize=6.5, fontweight="bold")
            last = axis
    axes.set_xlim(0, len(COLUMNS))
    axes.set_xticks([x + 0.5 for x in range(len(COLUMNS))])
    axes.set_xticklabels([f"{layout}, {level}" for layout, level in COLUMNS], rotation=90, fontsize=6)
    axes.xaxis.tick_top()
    axes.set_yticks([])
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def verdict_map(rows: Sequence[Row]) -> Figure:
    """The picture of the map: colours are verdicts, numbers powers of ten of the largest relative error.

    Args:
        rows: of rows_of or read_rows.

    Returns:
        A matplotlib Figure.
    """
    extremes = list(_extremes(rows).items())
    sheets = SHEETS if len(extremes) > 60 else 1
    height = -(-len(extremes) // sheets)
    figure = Figure(figsize=(5.2 * sheets, 2.2 + ROW_HEIGHT * height), dpi=120, layout="constrained")
    panels = figure.subplots(1, sheets, squeeze=False)[0]
    for n, axes in enumerate(panels):
        part = extremes[n * height : (n + 1) * height]
        _draw_sheet(axes, part)
        axes.set_ylim(height, 0)
    _legend(figure)
    return figure


def summary(rows: Sequence[Row]) -> Figure:
    """What came out of each axis, both layouts together: a bar for each level, parted as its verdicts are.

    Args:
        rows: of rows_of or read_rows.

    Returns:
        A matplotlib Figure.
    """
    axes_of_map = list(dict.fromkeys(row.axis for row in rows))
    figure = Figure(figsize=(8.5, 1.0 + 0.24 * len(axes_of_map)), dpi=120, layout="constrained")
    axes = figure.subplots()
    for y, axis in enumerate(axes_of_map):
        part = [row for row in rows if row.axis == axis]
        for x, level in enumerate(LEVELS):
            found = Counter(row.cells[level.name].outcome for row in part if level.name in row.cells)
            left = x + 0.03
            for outcome, colour in COLOURS.items():
                width = 0.94 * found[outcome] / max(1, found.total())
                axes.barh(y, width, left=left, color=colour, height=0.8)
                left += width
            if found:
                text = f"{found[OUTCOMES[0]]} of {found.total()}"
                axes.text(x + 0.5, y, text, ha="center", va="center", fontsize=6.5)
    axes.set_yticks(range(len(axes_of_map)), axes_of_map, fontsize=8)
    axes.set_xticks([x + 0.5 for x in range(len(LEVELS))], [level.name for level in LEVELS], fontsize=8)
    axes.set_xlim(0, len(LEVELS))
    axes.set_ylim(len(axes_of_map) - 0.5, -0.5)
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    _legend(figure)
    return figure


def _legend(figure: Figure) -> None:
    figure.legend(
        handles=[Patch(color=colour, label=outcome) for outcome, colour in COLOURS.items()],
        loc="outside lower center",
        ncols=len(COLOURS),
        fontsize=8,
        frameon=False,
    )
