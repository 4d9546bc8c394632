"""Panels of a scene's figure: their dress, pulses, means over pulses."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ..common.colours import BLACK, BLUE, GREEN, VERMILION
from ..harness.picture import Picture
from ..harness.simulate import Result
from ..scene.keys import MECHANISM

# 1200 x 900 pixels
SIZE = (12.0, 9.0)
DPI = 100
# a weighted mean over this time, s, shows the drive behind the pulses
SMOOTHING = 1.0
# switches of freewheels in a row that has any, on average, above which a line does not say what instants did
MOST_SWITCHES = 1.1

Array = NDArray[np.float64]


def sheet(title: str, height: float = SIZE[1]) -> Picture:
    """An empty figure with a title; height: inches."""
    figure = Picture(figsize=(SIZE[0], height), dpi=DPI, layout="constrained")
    figure.suptitle(title, fontsize=15, fontweight="bold")
    return figure


def dress(axes: Axes, label: str) -> None:
    """Label, grid and, above the panel where it hides nothing, legend."""
    axes.set_ylabel(label)
    axes.grid(alpha=0.25)
    axes.margins(x=0.0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
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
    """Name of a key or a figure as a label, with its unit."""
    text = name.removeprefix(MECHANISM).replace("_", " ")
    return f"{text} [{unit}]" if unit not in ("", "1") else text


def headline(axes: Axes, text: str) -> None:
    """A line above the legend of a panel."""
    axes.set_title(text, loc="left", fontsize=11, pad=22)


def in_thousands(unit: str, *values: Array) -> tuple[float, str]:
    """Divisor and unit in which values are shown: with a k where they are large."""
    largest = max(float(np.abs(part).max()) for part in values)
    return (1e3, f"k{unit}") if largest > 2e3 else (1.0, unit)


def energy_panel(axes: Axes, table: Result, rows: slice = slice(None), lost: str = "lost") -> None:
    """Energies since the start: in, out, gain of what is stored and, if there is any, what is lost."""
    energies = {
        "in": (table["energy_in"], BLACK),
        "out to the load": (table["energy_out"], GREEN),
        "gain of stored": (table["energy_stored"] - table["energy_stored"][0], BLUE),
    }
    if table["energy_lost"].any():
        energies[lost] = table["energy_lost"], VERMILION
    factor, unit = in_thousands("J", *(values for values, _ in energies.values()))
    for name, (values, colour) in energies.items():
        axes.plot(table.time[rows], values[rows] / factor, color=colour, linewidth=1.5, label=name)
    dress(axes, f"energy [{unit}]")


def is_coarse(table: Result) -> bool:
    """Tell whether the rows are too far apart for the pulses: instants make no curve then."""
    switches = np.diff(table["contact_switches"])
    return bool(switches.sum() > MOST_SWITCHES * np.count_nonzero(switches))


def plot_instants(axes: Axes, table: Result, values: Array, rows: slice, label: str, **style: Any) -> None:
    """Draw what swings with the pulses: a line, or dots where the rows are too far apart for one."""
    dots: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 2.0} if is_coarse(table) else {}
    shown = f"{label}, at instants" if dots else label
    axes.plot(table.time[rows], values[rows], label=shown, **style, **dots)


def pulse_starts(table: Result) -> NDArray[np.int64]:
    """Rows at which a torque pulse on the output shaft begins, as far as the rows show."""
    driving = table["output_torque_mean"] > 0.0
    return np.flatnonzero(~driving[:-1] & driving[1:]).astype(np.int64)


def smooth(time: Array, values: Array, window: float = SMOOTHING) -> Array:
    """Mean of values over a Hann window, s, around each row (cut off at the ends).

    Args:
        time, values: shape (n,), time in equal steps.
    """
    rows = round(window / float(time[1] - time[0]))
    weights = np.hanning(min(max(rows, 1), len(time)) + 2)[1:-1]
    total = np.convolve(values, weights, mode="same")
    return total / np.convolve(np.ones(len(time)), weights, mode="same")
