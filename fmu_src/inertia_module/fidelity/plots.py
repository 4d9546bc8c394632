"""Work-precision plots: the least error for what it costs, on log-log axes, levels and slopes at the line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..common.colours import BLUE, VERMILION
from .rows import PEER, Row

Array = NDArray[np.float64]

_DPI = 110
_COLUMNS = 4
# a slope is fitted to at least so many points
_FITTED = 3
_COSTS = {"wall_time": "ms per simulated second", "evaluations": "right-hand sides"}


def front(rows: Sequence[Row], error: str, cost: str) -> list[Row]:
    """Rows that succeeded and that no other one beats, cheapest first: each is more accurate than the last.

    Args:
        rows: measured. error: name in Row.errors. cost: wall_time or evaluations.
    """
    known = [
        row
        for row in rows
        if not row.failure and getattr(row, cost) > 0.0 and row.errors.get(error, 0.0) > 0.0
    ]
    best: list[Row] = []
    for row in sorted(known, key=lambda row: (getattr(row, cost), row.errors[error])):
        if not best or row.errors[error] < best[-1].errors[error]:
            best.append(row)
    return best


def slope(costs: Array, errors: Array) -> float:
    """Exponent p of error ~ cost^p, fitted; NaN of fewer than three different points."""
    if np.unique(costs).size < _FITTED:
        return math.nan
    return float(np.polyfit(np.log(costs), np.log(errors), 1)[0])


def _name(row: Row) -> str:
    return row.method.partition(",")[0] if row.fidelity == PEER else row.level


def _draw(axes: Axes, rows: Sequence[Row], error: str, cost: str, colour: str, side: int) -> None:
    """One front, and beside it (side 1 the right, -1 the left) where a level begins its name and slope."""
    scale = 1e3 if cost == "wall_time" else 1.0
    points = [(scale * getattr(row, cost), row.errors[error]) for row in rows]
    axes.loglog(*zip(*points, strict=True), color=colour, marker="o", markersize=3, linewidth=1.2)
    for name, part in groupby(zip(rows, points, strict=True), key=lambda pair: _name(pair[0])):
        costs, errors = np.transpose([point for _, point in part])
        fitted = slope(costs, errors)
        text = name if math.isnan(fitted) else f"{name} (slope {fitted:.1f})"
        look: dict[str, Any] = {"ha": "left" if side > 0 else "right", "fontsize": 7, "color": colour}
        axes.annotate(
            text, (costs[0], errors[0]), xytext=(6 * side, 2 * side), textcoords="offset points", **look
        )


def _panel(axes: Axes, rows: Sequence[Row], error: str, cost: str) -> None:
    """One panel: the front of the module, and that of the peers."""
    for peers, colour, side in ((False, VERMILION, -1), (True, BLUE, 1)):
        found = front([row for row in rows if (row.fidelity == PEER) is peers], error, cost)
        if found:
            _draw(axes, found, error, cost, colour, side)
    # room for the names at the line
    axes.margins(x=0.3)
    axes.set_xlabel(_COSTS[cost])
    axes.set_ylabel(f"error of {error.replace('_', ' ')} [1]")
    axes.grid(alpha=0.3, linewidth=0.4)


def _figure(
    rows: Sequence[Row],
    panels: Sequence[tuple[str, str]],
    title: str,
    size: tuple[float, float],
    sharey: bool = False,
) -> Figure:
    """Panels of (error, cost)."""
    figure = Figure(figsize=size, dpi=_DPI, layout="constrained")
    figure.suptitle(f"{title}: least relative error for the cost", fontsize=11)
    columns = min(_COLUMNS, len(panels))
    grid = figure.subplots(math.ceil(len(panels) / columns), columns, sharey=sharey, squeeze=False).ravel()
    for axes, (error, cost) in zip(grid, panels, strict=False):
        _panel(axes, rows, error, cost)
    for axes in grid[len(panels) :]:
        axes.set_axis_off()
    return figure


def work_precision(rows: Sequence[Row], error: str, title: str) -> Figure:
    """One error against wall time and against right-hand sides.

    Args:
        rows: measured. error: name in Row.errors. title: of the figure.
    """
    return _figure(rows, [(error, cost) for cost in _COSTS], title, (11.0, 5.0), sharey=True)


def all_errors(rows: Sequence[Row], names: Sequence[str], title: str) -> Figure:
    """Each error against wall time, a panel each."""
    size = 4.0 * min(_COLUMNS, len(names)), 3.4 * math.ceil(len(names) / _COLUMNS) + 0.6
    return _figure(rows, [(name, "wall_time") for name in names], title, size)
