"""Common style of all figures: size, grid, legend, labels with units, smoothed curves."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ..common.colours import Picture
from ..scene.keys import MECHANISM

# 1200 x 900 pixels
SIZE = (12.0, 9.0)
DPI = 100
# averaging time that removes pulses, s
SMOOTHING = 1.0

Array = NDArray[np.float64]


def sheet(title: str = "", height: float = SIZE[1], width: float = SIZE[0]) -> Picture:
    """Make an empty figure with a title.

    Args:
        title: Title; "" for none.
        height: Height, inches.
        width: Width, inches.
    """
    figure = Picture(figsize=(width, height), dpi=DPI, layout="constrained")
    if title:
        figure.suptitle(title, fontsize=15, fontweight="bold")
    return figure


def plain(axes: Axes) -> None:
    """Add a grid and remove the upper and right frame.

    Args:
        axes: The panel.
    """
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)


def dress(axes: Axes, label: str) -> None:
    """Add a label, a grid and, above the panel, a legend.

    Args:
        axes: The panel.
        label: Label of the vertical axis.
    """
    axes.set_ylabel(label)
    axes.margins(x=0.0)
    plain(axes)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=6,
            fontsize=9,
            frameon=False,
            borderpad=0.1,
            columnspacing=1.2,
        )


def titled(name: str, unit: str) -> str:
    """Return the label of a key or metric, with its unit.

    Args:
        name: Name of the key or metric.
        unit: Unit; "" or "1" for none.
    """
    text = name.removeprefix(MECHANISM).replace("_", " ")
    return f"{text} [{unit}]" if unit not in ("", "1") else text


def headline(axes: Axes, text: str) -> None:
    """Add a line of text above the legend of a panel.

    Args:
        axes: The panel.
        text: The line.
    """
    axes.set_title(text, loc="left", fontsize=11, pad=22)


def smooth(time: Array, values: Array, window: float = SMOOTHING) -> Array:
    """Return the mean of values over a Hann window around each row, truncated at the ends, shape (n,).

    Args:
        time: Times in equal steps, s, shape (n,).
        values: Values, shape (n,).
        window: Length of the window, s.
    """
    rows = round(window / float(time[1] - time[0]))
    weights = np.hanning(min(max(rows, 1), len(time)) + 2)[1:-1]
    total = np.convolve(values, weights, mode="same")
    return total / np.convolve(np.ones(len(time)), weights, mode="same")
