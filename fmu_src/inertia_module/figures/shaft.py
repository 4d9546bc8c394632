"""The plot of a scene of the driven shaft alone."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ..common.colours import BLACK, PURPLE, VERMILION
from ..scene.shaft import ShaftResult
from .panels import dress, energy_panel, headline, sheet


def shaft_figure(result: ShaftResult) -> Figure:
    """Speeds and accelerations of hub and driven mass, twist and energy, one below the other.

    Args:
        result: of run_shaft_scene.

    Returns:
        A matplotlib Figure of 1200 x 900 pixels; save it with figure.savefig(path).
    """
    table, numbers = result.record, result.summary
    figure = sheet(result.scene.title)
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
    energy_panel(panels[3], table, lost="lost, less the balancer's work")
    panels[3].set_xlabel("time [s]")
    headline(
        panels[0],
        f"driven mass at most {numbers['driven_acceleration_peak']:.4g} rad/s²,"
        f" hub {np.abs(law).max():.4g} rad/s²",
    )
    return figure
