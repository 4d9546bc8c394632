"""Work-precision plots: error against what it costs, on log-log axes, slopes marked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from .rows import PEER, Row
from .trajectory import Array

_COLOURS = (VERMILION, BLUE, GREEN, ORANGE, SKY, PURPLE, BLACK, GREY)
_MARKERS = "osD^vPX*<>hp"
_DPI = 110
_COLUMNS = 4
# a slope is fitted to at least so many points
_FITTED = 3

Curve = list[Row]


def curves(rows: Sequence[Row]) -> dict[str, Curve]:
    """Rows that succeeded, by level and communication step."""
    steps = {row.communication_step for row in rows if row.fidelity != PEER}
    found: dict[str, Curve] = {}
    for row in rows:
        if row.failure:
            continue
        name = row.method if row.fidelity == PEER else row.level
        if row.fidelity != PEER and len(steps) > 1:
            name += f", steps of {row.communication_step:g} s"
        found.setdefault(name, []).append(row)
    return found


def slope(costs: Array, errors: Array) -> float:
    """Exponent p of error ~ cost^p, fitted; NaN of fewer than three different points."""
    if np.unique(costs).size < _FITTED:
        return math.nan
    return float(np.polyfit(np.log(costs), np.log(errors), 1)[0])


_COSTS = {"wall_time": "ms per simulated second", "evaluations": "right-hand sides"}


def _points(curve: Curve, error: str, cost: str) -> Array:
    """(cost, error) of the runs of a curve that have both, shape (n, 2)."""
    scale = 1e3 if cost == "wall_time" else 1.0
    pairs = [(scale * getattr(row, cost), row.errors.get(error, math.nan)) for row in curve]
    points = np.array(pairs, dtype=float)
    kept: Array = points[(points > 0.0).all(axis=1) & np.isfinite(points).all(axis=1)]
    return kept


def _panel(axes: Axes, rows: Sequence[Row], error: str, cost: str) -> None:
    """One panel: a line a curve, dashed for the peers."""
    for number, (name, curve) in enumerate(curves(rows).items()):
        points = _points(curve, error, cost)
        if points.size:
            axes.loglog(
                *points.T,
                linestyle="--" if curve[0].fidelity == PEER else "-",
                color=_COLOURS[number % len(_COLOURS)],
                marker=_MARKERS[number % len(_MARKERS)],
                markersize=4,
                linewidth=1.2,
                label=name,
            )
    axes.set_xlabel(_COSTS[cost])
    axes.set_ylabel(error.replace("_", " "))
    axes.grid(alpha=0.3, which="both", linewidth=0.4)


def _figure(
    rows: Sequence[Row],
    panels: Sequence[tuple[str, str]],
    title: str,
    size: tuple[float, float],
    slopes: Mapping[str, str],
    sharey: bool = False,
) -> Figure:
    """Panels of (error, cost), below them one legend with the slopes of a curve behind its name."""
    figure = Figure(figsize=size, dpi=_DPI, layout="constrained")
    figure.suptitle(title, fontsize=12)
    columns = min(_COLUMNS, len(panels))
    grid = figure.subplots(math.ceil(len(panels) / columns), columns, sharey=sharey, squeeze=False).ravel()
    for axes, (error, cost) in zip(grid, panels, strict=False):
        _panel(axes, rows, error, cost)
    for axes in grid[len(panels) :]:
        axes.set_axis_off()
    handles = {str(line.get_label()): line for axes in grid for line in axes.get_lines()}
    if handles:
        texts = [name + slopes.get(name, "") for name in handles]
        figure.legend(
            list(handles.values()), texts, loc="outside lower center", ncols=3, fontsize=7, frameon=False
        )
    return figure


def _slopes(curve: Curve, error: str) -> str:
    """Fitted slopes against both costs; "" where there are too few points."""
    fitted = [slope(*_points(curve, error, cost).T) for cost in _COSTS]
    return "" if any(map(math.isnan, fitted)) else f" (slopes {fitted[0]:.1f}, {fitted[1]:.1f})"


def work_precision(rows: Sequence[Row], error: str, title: str) -> Figure:
    """One error against wall time and against right-hand sides; the legend gives both slopes.

    Args:
        rows: measured. error: name in Row.errors. title: of the figure.
    """
    slopes = {name: _slopes(curve, error) for name, curve in curves(rows).items()}
    return _figure(rows, [(error, cost) for cost in _COSTS], title, (13.0, 8.0), slopes, sharey=True)


def all_errors(rows: Sequence[Row], names: Sequence[str], title: str) -> Figure:
    """Each error against wall time, a panel each."""
    size = 4.0 * min(_COLUMNS, len(names)), 3.4 * math.ceil(len(names) / _COLUMNS) + 1.6
    return _figure(rows, [(name, "wall_time") for name in names], title, size, {})
