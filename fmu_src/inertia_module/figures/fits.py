"""Picture of a fit: each measured column with what the fitted scene computes, and the residuals below."""

from __future__ import annotations

from matplotlib.figure import Figure

from ..common.colours import BLUE, GREY, VERMILION
from ..jobs.fit import FitResult
from .panels import dress, sheet, titled

# of a column, inches
ROW = 4.0
# standard deviations that 95 % of normal noise are within
WITHIN = 1.96


def fit_figure(found: FitResult) -> Figure:
    """Measured and computed over time, below it residuals over noise with the band of 95 % of normal noise.

    Args:
        found: of fit.

    Returns:
        A matplotlib Figure, higher the more columns there are.
    """
    data, table = found.measurement, found.table()
    figure = sheet(found.scene.title, 1.0 + ROW * len(data.columns))
    panels = figure.subplots(2 * len(data.columns), 1, sharex=True, height_ratios=(2, 1) * len(data.columns))
    for n, name in enumerate(data.columns):
        curves, residuals = panels[2 * n : 2 * n + 2]
        counted, time = data.counted[:, n], table.time
        curves.plot(time, table[f"{name}_measured"], ".", color=GREY, markersize=4, label="measured")
        curves.plot(time, table[f"{name}_computed"], color=VERMILION, linewidth=1.2, label="computed")
        dress(curves, titled(name, data.table.units.get(name, "")))
        over = table[f"{name}_residual"] / data.noise.get(name, found.noise[name])
        residuals.axhspan(-WITHIN, WITHIN, color=BLUE, alpha=0.12)
        residuals.plot(time[counted], over[counted], ".", color=BLUE, markersize=4)
        dress(residuals, "residual / noise")
    panels[-1].set_xlabel("time [s]")
    return figure
