"""The plot of a scene of the driven shaft alone."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..common.colours import BLACK, BLUE, GREEN, PURPLE, VERMILION
from ..harness.picture import Picture
from ..harness.simulate import Result
from ..scene.shaft import ShaftResult
from .panels import DPI, SIZE, dress, headline, in_thousands


def shaft_figure(result: ShaftResult) -> Figure:
    """Speeds and accelerations of hub and driven mass, twist and energy, one below the other.

    Args:
        result: of run_shaft_scene.

    Returns:
        A matplotlib Figure of 1200 x 900 pixels; save it with figure.savefig(path).
    """
    table, numbers = result.record, result.summary
    figure = Picture(figsize=SIZE, dpi=DPI, layout="constrained")
    figure.suptitle(result.scene.title, fontsize=15, fontweight="bold")
    panels = figure.subplots(4, 1, sharex=True)
    time = table.time
    panels[0].plot(time, table["hub_speed"], color=BLACK, linewidth=1.2, label="hub")
    panels[0].plot(time, table["omega_out"], color=VERMILION, linewidth=1.6, label="driven mass")
    dress(panels[0], "speed [rad/s]")
    law = np.gradient(table["hub_speed"], time)
    panels[1].plot(time, law, color=BLACK, linewidth=1.2, label="hub")
    panels[1].plot(time, table["driven_acceleration"], color=VERMILION, linewidth=1.6, label="driven mass")
    dress(panels[1], "acceleration [rad/s²]")
    panels[2].plot(time, 1e3 * table["twist"], color=PURPLE, linewidth=1.6, label="twist")
    dress(panels[2], "twist [mrad]")
    _energies(panels[3], table)
    panels[3].set_xlabel("time [s]")
    headline(
        panels[0],
        f"driven mass at most {numbers['driven_acceleration_peak']:.4g} rad/s²,"
        f" hub {np.abs(law).max():.4g} rad/s²",
    )
    return figure


def _energies(axes: Axes, table: Result) -> None:
    energies = {
        "in": (table["energy_in"], BLACK),
        "out to the load": (table["energy_out"], GREEN),
        "gain of stored": (table["energy_stored"] - table["energy_stored"][0], BLUE),
        "lost, less the balancer's work": (table["energy_lost"], VERMILION),
    }
    factor, unit = in_thousands("J", *(values for values, _ in energies.values()))
    for name, (values, colour) in energies.items():
        axes.plot(table.time, values / factor, color=colour, linewidth=1.5, label=name)
    dress(axes, f"energy [{unit}]")
