"""Panels of a real machine: power in, out and lost by cause, forces on bearing and mount."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..common.colours import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from ..contract.variables import LOSSES, LOST_TO
from ..harness.simulate import Result
from ..scene.summary import forces
from .panels import SMOOTHING, Array, dress, in_thousands, plot_instants, smooth

COLOURS = (VERMILION, ORANGE, PURPLE, SKY, BLUE)
# largest share of the run over which its powers are averaged
WINDOW = 1.0 / 8.0
FORCES = {"satellite_force": (PURPLE, "on the satellite's bearing"), "shaking_force": (BLUE, "on the mount")}


def losses(table: Result) -> dict[str, tuple[Array, str]]:
    """Energy lost since the start, J, and a colour, by cause: of those that lose any."""
    return {
        name.removeprefix(LOST_TO).replace("_", " "): (table[name], COLOURS[n % len(COLOURS)])
        for n, name in enumerate(LOSSES)
        if table[name].any()
    }


def _powers(
    axes: Axes, table: Result, rows: slice, zoomed: bool, energies: dict[str, tuple[Array, str]]
) -> str:
    """Rates of energies, in the whole run without its pulses; the unit."""
    time = table.time[1:]
    powers = {name: np.diff(energy) / np.diff(table.time) for name, (energy, _) in energies.items()}
    if zoomed:
        shown = slice(rows.start, None)
    else:
        window = min(SMOOTHING, WINDOW * float(time[-1] - time[0]))
        powers = {name: smooth(time, power, window) for name, power in powers.items()}
        # at the ends the window is cut off within a pulse
        cut = round(0.5 * window / float(time[1] - time[0]))
        shown = slice(cut, len(time) - cut)
    factor, unit = in_thousands("W", *(power[shown] for power in powers.values()))
    for name, power in powers.items():
        axes.plot(time[shown], power[shown] / factor, color=energies[name][1], linewidth=1.5, label=name)
    return unit


def power_panel(axes: Axes, table: Result, rows: slice, zoomed: bool = False) -> None:
    """Power in, out to the load and lost."""
    energies = {
        "in": (table["energy_in"], BLACK),
        "out to the load": (table["energy_out"], GREEN),
        "lost": (table["energy_lost"], VERMILION),
    }
    dress(axes, f"power [{_powers(axes, table, rows, zoomed, energies)}]")


def loss_panel(axes: Axes, table: Result, rows: slice, zoomed: bool = False) -> None:
    """Power lost by cause."""
    dress(axes, f"lost [{_powers(axes, table, rows, zoomed, losses(table))}]")
    axes.set_ylim(bottom=min(axes.get_ylim()[0], 0.0))


def force_panel(axes: Axes, table: Result, rows: slice) -> None:
    """Magnitudes of the forces that are recorded."""
    found = {name: values for name, values in forces(table).items() if name in FORCES}
    factor, unit = in_thousands("N", *found.values())
    for name, values in found.items():
        colour, label = FORCES[name]
        plot_instants(axes, table, values / factor, rows, label, color=colour, linewidth=0.9)
    axes.set_ylim(bottom=0.0)
    dress(axes, f"force [{unit}]")
