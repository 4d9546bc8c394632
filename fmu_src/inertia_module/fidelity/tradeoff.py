"""Trade of speed for accuracy of a scene: measured rows, their files, and a plot of error against cost."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..common.colours import BLUE, VERMILION
from ..common.files import write_figure
from ..common.terminal import Progress
from ..harness.simulate import whole_steps
from ..scene import Scene
from ..scene.schema import is_elastic
from .levels import PEER, Row, all_levels, write_rows
from .trials import measure_scene

Array = NDArray[np.float64]

# communication steps of a scene over its own
_LONGER = (1, 10, 100)
WORST = "worst"
_DPI = 110
# a slope is fitted to at least so many points
_FITTED = 3
_COSTS = {"wall_time": "ms per simulated second", "evaluations": "right-hand sides"}


# --- least error for the cost, on log-log axes ---


def front(rows: Sequence[Row], error: str, cost: str) -> list[Row]:
    """Pick rows that succeeded and no other one beats, cheapest first: each is more accurate than the last.

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
    """Fit the exponent p of error ~ cost^p; NaN of fewer than three different points."""
    if np.unique(costs).size < _FITTED:
        return math.nan
    return float(np.polyfit(np.log(costs), np.log(errors), 1)[0])


def _panel(axes: Axes, rows: Sequence[Row], error: str, cost: str) -> None:
    """Draw the front of the module and that of the peers; where a level begins, its name and slope."""
    scale = 1e3 if cost == "wall_time" else 1.0
    for peers, colour, side in ((False, VERMILION, -1), (True, BLUE, 1)):
        found = front([row for row in rows if (row.fidelity == PEER) is peers], error, cost)
        costs = np.array([scale * getattr(row, cost) for row in found])
        errors = np.array([row.errors[error] for row in found])
        if found:
            axes.loglog(costs, errors, color=colour, marker="o", markersize=3, linewidth=1.2)
        names = [row.method.partition(",")[0] if peers else row.level for row in found]
        for name, part in groupby(range(len(found)), key=names.__getitem__):
            places = list(part)
            fitted = slope(costs[places], errors[places])
            axes.annotate(
                name if math.isnan(fitted) else f"{name} (slope {fitted:.1f})",
                (costs[places[0]], errors[places[0]]),
                xytext=(6 * side, 2 * side),
                textcoords="offset points",
                ha="left" if peers else "right",
                fontsize=7,
                color=colour,
            )
    # room for the names at the line
    axes.margins(x=0.3)
    axes.set_xlabel(_COSTS[cost])
    axes.set_ylabel(f"error of {error.replace('_', ' ')} [1]")
    axes.grid(alpha=0.3, linewidth=0.4)


def work_precision(rows: Sequence[Row], error: str, title: str) -> Figure:
    """Draw one error against wall time and against right-hand sides.

    Args:
        rows: measured. error: name in Row.errors. title: of the figure.
    """
    figure = Figure(figsize=(11.0, 5.0), dpi=_DPI, layout="constrained")
    figure.suptitle(f"{title}: least relative error for the cost", fontsize=11)
    for axes, cost in zip(figure.subplots(1, 2, sharey=True), _COSTS, strict=True):
        _panel(axes, rows, error, cost)
    return figure


# --- a scene ---


def measured_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Measure a scene at all levels, in its own communication step and in longer ones.

    Raises:
        Refused: the module refuses the scene.
    """
    longer = (factor * scene.run.communication_step for factor in _LONGER)
    steps = [step for step in longer if whole_steps(scene.run.stop_time, step)]
    levels = list(all_levels(is_elastic(scene.given), kinematic=False))
    return measure_scene(scene, levels, steps, progress)


def with_worst(rows: Sequence[Row], wanted: Sequence[str]) -> list[Row]:
    """Rows with the errors of the wanted outputs alone, and WORST, the largest of them."""
    kept = []
    for row in rows:
        errors = {name: row.errors[name] for name in wanted if name in row.errors}
        kept.append(dataclasses.replace(row, errors={**errors, WORST: row.worst(wanted)} if errors else {}))
    return kept


def leave_rows(folder: Path, title: str, rows: Sequence[Row]) -> dict[str, Path]:
    """Leave rows of with_worst in a folder, as CSV, and a plot as PNG and SVG. Returns the files by name."""
    files = {"rows": write_rows(folder / "tradeoff.csv", rows)}
    figure = work_precision(rows, WORST, title)
    for kind in ("png", "svg"):
        files[f"tradeoff_{kind}"] = write_figure(folder / f"tradeoff.{kind}", figure)
    return files
