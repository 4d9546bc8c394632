"""Parts of all figures: size, grid, legend, labels with units, smoothed curves."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.text import Text
from numpy.typing import NDArray

from ..common.colours import Picture, styled
from ..common.errors import must_be
from ..common.units import printed_unit
from ..scene.headings import heading
from ..scene.keys import MECHANISM

# 1200 x 900 pixels
SIZE = (12.0, 9.0)
DPI = 100
# size of a figure with one panel, inches, and enlargement of its text: a slide of 16:9
SLIDE, SLIDE_TEXT = (12.8, 7.2), 1.7
# maximum number of characters in a line of its title
SLIDE_COLUMNS = 60
# size of tick labels, and distance of a title above a legend, points
TICK_SIZE, TITLE_PAD = 10.0, 22.0
# maximum ratio of the ends of a linear axis; a larger ratio makes the axis logarithmic
MAX_LINEAR_RATIO = 10.0
# averaging time that removes pulses, s
SMOOTHING = 1.0

Array = NDArray[np.float64]


def new_figure(title: str = "", height: float = SIZE[1], width: float = SIZE[0]) -> Picture:
    """Make an empty figure with a title.

    Args:
        title: Title; "" for none.
        height: Height, inches.
        width: Width, inches.
    """
    figure = Picture(figsize=(width, height), dpi=DPI, layout="constrained")
    if title:
        figure.suptitle(title)
    return figure


def add_label_and_legend(axes: Axes, label: str) -> None:
    """Add a label and, above the panel, a legend.

    Args:
        axes: The panel.
        label: Label of the vertical axis.
    """
    axes.set_ylabel(label)
    axes.margins(x=0.0)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=6,
            borderpad=0.1,
        )


def label_with_unit(name: str, unit: str) -> str:
    """Return the label of a key or metric, with its unit.

    Args:
        name: Name of the key or metric.
        unit: Unit; "" or "1" for none.
    """
    text = heading(name.removeprefix(MECHANISM))
    return f"{text} [{printed_unit(unit)}]" if unit not in ("", "1") else text


def headline(axes: Axes, text: str) -> None:
    """Add a line of text above the legend of a panel.

    Args:
        axes: The panel.
        text: The line.
    """
    axes.set_title(text, pad=TITLE_PAD)


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


def envelope(time: Array, values: Array, bins: int) -> tuple[Array, Array, Array]:
    """Return times, minima and maxima of values in bins of equal duration, shape (bins,) each.

    Args:
        time: Times in equal steps, s, shape (n,).
        values: Values, shape (n,).
        bins: Number of bins, at most n.
    """
    starts = np.linspace(0, len(time), bins, endpoint=False).astype(np.int64)
    ends = np.append(starts[1:], len(time)) - 1
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    times = 0.5 * (time[starts] + time[ends])
    times[0], times[-1] = time[0], time[-1]
    return times, low, high


@styled()
def single_panel(figure: Figure, number: int) -> Figure:
    """Reduce a figure to one panel in the size of a slide, with large text.

    Args:
        figure: The figure, which is changed.
        number: Number of the panel from 1, row by row.

    Raises:
        ValueError: The figure has no panel of this number.
    """
    panels = list(dict.fromkeys(axes.get_subplotspec() for axes in figure.axes if axes.get_subplotspec()))
    if not 1 <= number <= len(panels):
        raise ValueError(must_be("--panel", f"between 1 and {len(panels)}", number))
    remaining = [axes for axes in figure.axes if axes.get_subplotspec() == panels[number - 1]]
    for axes in remaining:
        sharing = axes.get_shared_x_axes().get_siblings(axes)
        axes.set_xlabel(next((other.get_xlabel() for other in sharing if other.get_xlabel()), ""))
        axes.tick_params(labelbottom=True)
        pad = SLIDE_TEXT * (TITLE_PAD if axes.get_legend() else 6.0)
        axes.set_title(axes.get_title(loc="left"), pad=pad)
    artists = [artist for axes in remaining for artist in (*axes.collections, *axes.images)]
    colour_bars = [artist.colorbar.ax for artist in artists if artist.colorbar is not None]
    for axes in figure.axes:
        if axes not in (*remaining, *colour_bars):
            axes.remove()
    whole = GridSpec(1, 1, figure=figure)[0]
    for axes in remaining:
        axes.set_subplotspec(whole)
    figure.set_size_inches(*SLIDE)
    if title := figure.get_suptitle():
        figure.suptitle(textwrap.fill(title, SLIDE_COLUMNS))
    for text in figure.findobj(Text):
        text.set_fontsize(SLIDE_TEXT * float(text.get_fontsize()))
    for axes in (*remaining, *colour_bars):
        axes.tick_params(which="both", labelsize=SLIDE_TEXT * TICK_SIZE)
    for line in (line for axes in remaining for line in axes.lines):
        line.set_linewidth(SLIDE_TEXT * line.get_linewidth())
    return figure
