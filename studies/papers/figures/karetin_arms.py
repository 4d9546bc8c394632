"""Karetin's (26) to (31): projections of V on three planes, and their arms about O."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from inertia_module.common.colours import BLACK, BLUE, GREEN, GREY, VERMILION

from ..karetin.cases import GENERAL as G
from ..karetin.equations import MOVING
from . import style
from .style import BROKEN, CENTRED, Columns, Drawings, dress, sheet

# plane: its axes, by number; names of D and of the foot on it; place of the foot among the feet
PLANES = (
    ("xOy", (0, 1), "H", "L", (0, 1)),
    ("yOz", (1, 2), "P", "M", (2, 3)),
    ("xOz", (0, 2), "F", "N", (4, 5)),
)
# the first of ten turns of the drive, by samples; where the planes are drawn; s of V an arrow shows
TURN = slice(0, len(MOVING.t) // int(G.turns_in_period), 5)
SHOWN = 112
ARROW = 4e-3


def _plane(
    axes: Axes, plane: str, at: tuple[int, int], point: str, foot: str, place: tuple[int, int]
) -> None:
    """D and V on a plane, the line of V, and the perpendicular from O on it; mm."""
    path, speed, feet = (1e3 * v[:, TURN] for v in (MOVING.position, ARROW * MOVING.velocity, MOVING.feet))
    mass, arrow, end = path[list(at), SHOWN], speed[list(at), SHOWN], feet[list(place), SHOWN]
    axes.plot(*path[list(at)], color=GREY, linewidth=0.8)
    axes.axline(mass, mass + arrow, color=GREY, linewidth=0.8, linestyle=BROKEN)
    axes.plot((0.0, end[0]), (0.0, end[1]), color=BLUE, linewidth=2.0)
    look = {"arrowstyle": "-|>", "color": VERMILION, "shrinkA": 0, "shrinkB": 0, "linewidth": 1.6}
    axes.annotate("", mass + arrow, mass, arrowprops=look)
    for name, where, colour in (("O", np.zeros(2), BLACK), (point, mass, VERMILION), (foot, end, BLUE)):
        axes.plot(*where, "o", color=colour, markersize=4)
        axes.text(where[0] + 9.0, where[1] + 9.0, f"${name}$", color=colour, **CENTRED)
    axes.set_aspect("equal", adjustable="datalim")
    dress(axes, f"${plane[2]}$ [mm]", f"${plane}$")
    axes.set_xlabel(f"${plane[0]}$ [mm]")


def arms() -> tuple[Figure, Columns]:
    """The planes at one instant, then arms (m) and speeds (m/s) on them over a turn of the drive.

    Returns:
        The figure, and columns over the turns of the drive: arms and speeds.
    """
    turns = MOVING.t[TURN] * MOVING.omega16 / (2.0 * np.pi)
    figure, columns = sheet(9.6, 8.0), {"turns of the drive": turns}
    panels = figure.subplots(3, 3, height_ratios=(2.2, 1.0, 1.0), sharey="row")
    for n, (plane, at, point, foot, place) in enumerate(PLANES):
        _plane(panels[0, n], plane, at, point, foot, place)
        columns[f"arm O{foot} [m]"] = arm = MOVING.arms[n, TURN]
        columns[f"speed on {plane} [m/s]"] = speed = MOVING.plane_speeds[n, TURN]
        panels[1, n].plot(turns, 1e3 * arm, color=BLUE)
        panels[2, n].plot(turns, speed, color=VERMILION)
        for axes, label in ((panels[1, n], f"$O{foot}$ [mm]"), (panels[2, n], "speed [m/s]")):
            axes.axvline(turns[SHOWN], color=GREEN, linewidth=0.8)
            dress(axes, label)
        panels[2, n].set_xlabel("turns of the drive")
    told = "exact, (26) to (30) as printed the same; in (31) the printed y_N is the x of N"
    drawn = f"V: 1 m/s is {1e3 * ARROW:g} mm; the planes are drawn at {turns[SHOWN]:.2f} turns (green)"
    style.caption(
        figure,
        f"Projections of V and their arms about O in the dynamic mode, {told}. {drawn}. {style.mechanism(G)}",
    )
    return figure, columns


FIGURES: Drawings = {"karetin_arms": arms}
