"""The map as a picture: couplings from top to bottom, steps within inertia ratios from left to right."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from .trial import Trial

# from blue (good) to red, which the colour-blind tell apart by lightness: ColorBrewer's RdYlBu reversed
_COLOURS = ListedColormap(["#313695", "#4575b4", "#abd9e9", "#ffffbf", "#fdae61", "#d73027"], name="errors")
_BOUNDS = (1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 1.0)
_UNSTABLE = "#222222"
_NORM = BoundaryNorm(_BOUNDS, _COLOURS.N)


def map_figure(rows: Sequence[Trial]) -> Figure:
    """The map of the worst errors; black is unstable.

    Args:
        rows: of the part map.
    """
    cases = list(dict.fromkeys(row.case for row in rows))
    schemes = list(dict.fromkeys(row.scheme for row in rows))
    columns = sorted({(row.ratio, row.step) for row in rows})
    figure = Figure(figsize=(11, 0.6 + 1.9 * len(cases)), dpi=110, layout="constrained")
    panels = list(figure.subplots(len(cases), 1, squeeze=False)[:, 0])
    for axes, case in zip(panels, cases, strict=True):
        found = {(row.scheme, row.ratio, row.step): row.worst for row in rows if row.case == case}
        grid = np.array([[found.get((name, *column), math.inf) for column in columns] for name in schemes])
        shown = np.clip(np.ma.masked_invalid(grid), _BOUNDS[0], 0.999 * _BOUNDS[-1])
        axes.set_facecolor(_UNSTABLE)
        axes.pcolormesh(shown, cmap=_COLOURS, norm=_NORM, edgecolors="white", linewidth=0.4)
        axes.invert_yaxis()
        axes.tick_params(length=0, labelsize=6.5)
        axes.set_yticks(np.arange(len(schemes)) + 0.5, schemes)
        axes.set_xticks(np.arange(len(columns)) + 0.5, [f"{1e3 * step:g}" for _, step in columns])
        for number, (ratio, _) in enumerate(columns):
            if number == 0 or columns[number - 1][0] != ratio:
                axes.axvline(number, color="black", linewidth=1.2)
                axes.text(number + 0.1, -0.15, f"Φ/J_E = {ratio:g}", fontsize=7.5)
        axes.set_xlabel(f"communication step, ms ({case})", fontsize=8)
    bar = figure.colorbar(ScalarMappable(_NORM, _COLOURS), ax=panels, fraction=0.03, pad=0.01)
    bar.set_ticks(list(_BOUNDS))
    bar.set_ticklabels([f"{100 * bound:g} %" for bound in _BOUNDS])
    bar.ax.tick_params(labelsize=7)
    return figure
