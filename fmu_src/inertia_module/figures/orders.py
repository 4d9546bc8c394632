"""Order spectra of a run: of each signal its spectrum, and a waterfall over the run."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..common.colours import VERMILION
from ..jobs.orders import BASES, Array, Orders
from .panels import dress, sheet, titled

# lines named in a panel, and the share of all that swings that a picture goes out to
NAMED = 3
SHOWN = 0.99
# decades of the colours
DECADES = 3
# of the height of a row, inches
ROW = 2.6


def order_figure(found: Orders, title: str) -> Figure:
    """Left the spectrum of each signal, right its waterfall: over the speed in a run-up, else over time.

    Returns:
        A matplotlib Figure, higher the more signals there are.
    """
    names = [name for name, amplitude in found.amplitude.items() if amplitude.any()]
    figure = sheet(title, 1.2 + ROW * len(names))
    panels = figure.subplots(len(names), 2, sharex=True, squeeze=False)
    lines = found.largest(NAMED)
    over, label = _run(found)
    for (left, right), name in zip(panels, names, strict=True):
        amplitude, unit = found.amplitude[name], found.units[name]
        left.plot(found.order, amplitude, color=VERMILION, linewidth=1.2)
        for line in lines[name]:
            place = (line.order, float(np.interp(line.order, found.order, amplitude)))
            left.annotate(f"{line.order:.4g}", place, ha="center", va="bottom", fontsize=9)
        left.set_ylim(0.0, 1.15 * float(amplitude.max()))
        dress(left, titled(name, unit))
        _waterfall(right, found.order, over, found.waterfall[name], unit)
        right.set_ylabel(label)
    panels[0, 0].set_xlim(0.0, _end(found))
    for axes in panels[-1]:
        axes.set_xlabel(f"order, cycles a {BASES[found.of]}")
    return figure


def _run(found: Orders) -> tuple[Array, str]:
    """Axis that the windows of a waterfall stand over."""
    if found.time.size > 1 and (np.diff(found.speed) > 1e-3 * found.speed[0]).all():
        return found.speed, "speed of link 1 [rad/s]"
    return found.time, "time [s]"


def _end(found: Orders) -> float:
    """A little above the order up to which SHOWN of all that swings is found, of every signal."""
    shares = (np.cumsum(values**2) / np.sum(values**2) for values in found.amplitude.values() if values.any())
    place = max(int(np.searchsorted(share, SHOWN)) for share in shares)
    return min(1.1 * float(found.order[place]), float(found.order[-1]))


def _waterfall(axes: Axes, order: Array, over: Array, amplitude: Array, unit: str) -> None:
    if over.size < 2:
        axes.text(0.5, 0.5, "one window", ha="center", transform=axes.transAxes)
        return
    largest = float(amplitude.max())
    norm = LogNorm(10.0**-DECADES * largest, largest, clip=True)
    drawn = axes.pcolormesh(order, over, amplitude, norm=norm, cmap="viridis", shading="nearest")
    axes.figure.colorbar(drawn, ax=axes, label=unit)
