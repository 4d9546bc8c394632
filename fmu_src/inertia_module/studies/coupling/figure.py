"""The map as a picture: schemes from top to bottom, steps within inertia ratios from left to right."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from .shafts import ShaftTrial
from .trial import STABLE, Trial

# from blue (good) to red, which the colour-blind tell apart by lightness: ColorBrewer's RdYlBu turned round
_COLOURS = ListedColormap(["#313695", "#4575b4", "#abd9e9", "#ffffbf", "#fdae61", "#d73027"], name="errors")
_BOUNDS = (1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 1.0)
_UNSTABLE = "#222222"
_NORM = BoundaryNorm(_BOUNDS, _COLOURS.N)


def worst(row: Trial) -> float:
    """Worst of the errors of a trial: speed, output speed, energy lost on the bond; infinite if unstable."""
    if row.word != STABLE:
        return math.inf
    return max(row.speed_error, row.output_error, abs(row.energy_error))


def _paint(axes: Axes, values: Sequence[Sequence[float]]) -> None:
    grid = np.array(values, dtype=float)
    axes.set_facecolor(_UNSTABLE)
    shown = np.ma.masked_invalid(np.clip(grid, _BOUNDS[0], None))
    inside = np.ma.masked_where(~np.isfinite(grid), np.ma.minimum(shown, 0.999 * _BOUNDS[-1]))
    axes.pcolormesh(inside, cmap=_COLOURS, norm=_NORM, edgecolors="white", linewidth=0.4)
    axes.invert_yaxis()
    axes.tick_params(length=0, labelsize=6.5)


def _colour_bar(figure: Figure, panels: Sequence[Axes]) -> None:
    bar = figure.colorbar(ScalarMappable(_NORM, _COLOURS), ax=panels, fraction=0.03, pad=0.01)
    bar.set_ticks(list(_BOUNDS))
    bar.set_ticklabels([f"{100 * bound:g} %" for bound in _BOUNDS])
    bar.ax.tick_params(labelsize=7)


def map_figure(rows: Sequence[Trial]) -> Figure:
    """The map of the worst errors; black is unstable.

    Args:
        rows: of the part map.
    """
    cases = list(dict.fromkeys(row.case for row in rows))
    figure = Figure(figsize=(11, 0.6 + 3.5 * len(cases)), dpi=110, layout="constrained")
    panels = figure.subplots(len(cases), 1, squeeze=False)[:, 0]
    for axes, case in zip(panels, cases, strict=True):
        here = [row for row in rows if row.case == case]
        columns = list(dict.fromkeys((row.ratio, row.step) for row in here if row.word == STABLE))
        columns.sort()
        schemes = list(dict.fromkeys(row.scheme for row in here))
        found = {(row.scheme, row.ratio, row.step): worst(row) for row in here}
        _paint(axes, [[found.get((name, *column), math.inf) for column in columns] for name in schemes])
        axes.set_yticks(np.arange(len(schemes)) + 0.5, schemes)
        axes.set_xticks(np.arange(len(columns)) + 0.5, [f"{1e3 * step:g}" for _, step in columns])
        for number, (ratio, _) in enumerate(columns):
            if number == 0 or columns[number - 1][0] != ratio:
                axes.axvline(number, color="black", linewidth=1.2)
                axes.text(number + 0.1, -0.3, f"Φ/J_E = {ratio:g}", fontsize=7.5)
        axes.set_xlabel(f"communication step, ms ({case})", fontsize=8)
    _colour_bar(figure, list(panels))
    return figure


def shafts_figure(rows: Sequence[ShaftTrial]) -> Figure:
    """Error of the driven mass over the step, a panel for each stiffness.

    Args:
        rows: of the part shafts.
    """
    stiffnesses = list(dict.fromkeys(row.stiffness for row in rows))
    figure = Figure(figsize=(11, 4.0), dpi=110, layout="constrained")
    panels = figure.subplots(1, len(stiffnesses), sharey=True, squeeze=False)[0]
    for axes, stiffness in zip(panels, stiffnesses, strict=True):
        for number, name in enumerate(dict.fromkeys(row.scheme for row in rows)):
            kept = [row for row in rows if (row.scheme, row.stiffness) == (name, stiffness) and row.stable]
            axes.loglog(
                [row.step for row in kept],
                [row.driven_error for row in kept],
                marker="osD^vPX*<"[number],
                markersize=3.5,
                linewidth=1.0,
                label=name,
            )
        axes.set_title(f"c = {stiffness:g} N·m/rad", fontsize=8)
        axes.set_xlabel("communication step, s", fontsize=8)
        axes.tick_params(labelsize=7)
        axes.set_xlim(1e-5, 1e-2)
        axes.set_ylim(1e-7, 1.0)
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("error of the driven mass, rms", fontsize=8)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=5, fontsize=7, frameon=False)
    return figure
