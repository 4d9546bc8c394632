"""Karetin's figure 1, to scale: the standard layout, the stop mode and the dynamic mode."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc

from inertia_module.common.colours import BLACK, BLUE, GREY, ORANGE, VERMILION

from ..karetin import Motion, exact
from ..karetin.cases import DYNAMIC, GENERAL, STOP, period
from . import style
from .karetin_cones import Array
from .style import BROKEN, CENTRED, Columns, Drawings, dress, sheet

# a, b and c differ from 1, so that no two points are one
SHOWN = replace(GENERAL, epsilon=0.0, gamma=0.0)
# where the dynamic mode is drawn: share of a turn of the drive
INSTANT = 0.08


def _point(axes: Axes, place: Array, name: str, aside: tuple[float, float], colour: str = BLACK) -> None:
    axes.plot(*place, "o", color=colour, markersize=4, zorder=4)
    x, y = place + np.array(aside)
    axes.text(x, y, name, color=colour, **CENTRED)


def _line(axes: Axes, *places: Array, colour: str = BLACK, width: float = 1.3, line: Any = "-") -> None:
    axes.plot(*np.transpose(places), color=colour, linewidth=width, linestyle=line)


def _arc(axes: Axes, corner: Array, low: float, high: float, radius: float, name: str) -> None:
    """An arc from one angle to another, degrees from the right, its name beside it."""
    axes.add_patch(Arc(tuple(corner), 2 * radius, 2 * radius, theta1=low, theta2=high, color=BLACK))
    middle = np.radians(0.5 * (low + high))
    x, y = corner + (radius + 9.0) * np.array([np.cos(middle), np.sin(middle)])
    axes.text(x, y, name, **CENTRED)


def _layout(axes: Axes) -> None:
    """a) the section xOz at the time 0, in mm."""
    g = SHOWN
    origin, apex = np.zeros(2), np.array([0.0, 1e3 * g.OQ])
    along = np.array([np.sin(g.shaft_angle), -np.cos(g.shaft_angle)])
    across = np.array([along[1], -along[0]])
    foot, base = apex + 1e3 * g.QA * along, apex + 1e3 * g.L * np.cos(g.phi) * along
    mass, rim = foot + 1e3 * g.AD * across, 1e3 * g.L * np.sin(g.phi) * across
    centre = apex - np.array([0.0, 1e3 * g.L * np.cos(g.psi)])
    radius = np.array([1e3 * g.wheel_radius, 0.0])
    _line(axes, apex, centre - radius, centre + radius, apex, colour=GREY)
    _line(axes, apex, base - rim, base + rim, apex, colour=BLUE)
    _line(axes, np.array([-125.0, 0.0]), np.array([135.0, 0.0]), width=0.8, line=(0, (8, 3, 2, 3)))
    _line(axes, centre, apex, width=0.8, line=(0, (8, 3, 2, 3)))
    _line(axes, origin, apex, foot, width=2.0)
    _line(axes, foot, mass, colour=ORANGE, width=2.4)
    for place, name, aside in (
        (origin, "$O$", (-7, -6)),
        (apex, "$Q$", (-8, 4)),
        (foot, "$A$", (9, 2)),
        (base, "$K$", (-6, 8)),
        (centre, "$O_r$", (-9, -5)),
        (centre + radius, "$Π$", (2, -8)),
    ):
        _point(axes, place, name, aside)
    _point(axes, mass, "$D$", (10, 0), VERMILION)
    half = np.degrees([g.psi, g.phi])
    _arc(axes, apex, 270.0, 270.0 + half[0], 28.0, "$ψ$")
    _arc(axes, apex, 270.0 + half[0], 270.0 + half.sum(), 34.0, "$φ$")
    for place, text in (
        ((-52, -28), "17"),
        ((64, 48), "6"),
        ((0, 60), "16, $ω_{16}$"),
        ((-96, 9), "link 1, $ω_1$"),
        ((112, -32), "link 2, $ω_2$"),
    ):
        axes.text(*place, text, **CENTRED)
    axes.set_title(
        f"a) layout: $AD, QA, OQ$ = {1e3 * g.AD:.1f}, {1e3 * g.QA:.1f}, {1e3 * g.OQ:.1f} mm",
        loc="left",
        fontsize=9,
    )


def _mode(axes: Axes, motion: Motion, title: str) -> None:
    """b), c) seen along Ox, which comes towards the reader: OQ, A, D and a turn of the drive, in mm."""
    span = period(SHOWN, motion) / float(SHOWN.turns_in_period)
    path = 1e3 * exact(SHOWN, motion, np.linspace(0.0, span, 361)).position
    now = exact(SHOWN, motion, [INSTANT * span])
    turn = motion.carrier * INSTANT * span
    up = 1e3 * SHOWN.OQ * np.array([-np.sin(turn), np.cos(turn)])
    arm = now.arm_of_imbalance[1:, 0]
    back = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    mass = 1e3 * now.position[1:, 0]
    foot = mass - 1e3 * back @ arm
    axes.plot(*path[1:], color=VERMILION, linewidth=1.2)
    _line(axes, np.zeros(2), up, foot, width=2.0)
    _line(axes, foot, mass, colour=ORANGE, width=2.4)
    _line(axes, np.zeros(2), mass, colour=GREY, line=BROKEN)
    for place, name, aside in ((np.zeros(2), "$O$", (-8, -7)), (up, "$Q$", (-9, 5)), (foot, "$A$", (9, 3))):
        _point(axes, place, name, aside)
    _point(axes, mass, "$P$", (10, -2), VERMILION)
    angle = float(np.degrees(np.arctan2(mass[1], mass[0])))
    _arc(axes, np.zeros(2), min(angle, 90.0), max(angle, 90.0), 34.0, "$β_P$")
    if turn:
        _line(axes, np.zeros(2), np.array([0.0, 60.0]), width=0.8, line=(0, (8, 3, 2, 3)))
        _arc(axes, np.zeros(2), 90.0, 90.0 + float(np.degrees(turn)), 16.0, "$ω_1t$")
    axes.set_title(title, loc="left", fontsize=9)


def figure_1() -> tuple[Figure, Columns]:
    """Figure 1: the layout in section, and both modes seen along the central axis, with a turn of D.

    Returns:
        The figure, and columns of one row: the lengths (m) and angles (rad) of the layout.
    """
    figure = sheet(12.0, 4.2)
    panels = figure.subplots(1, 3)
    _layout(panels[0])
    _mode(panels[1], STOP, "b) stop mode: $ω_2 = 0$, $OQ$ at rest")
    _mode(panels[2], DYNAMIC, "c) dynamic mode: $OQ$ turns about $Ox$")
    for axes, across in zip(panels, "xyy", strict=True):
        axes.set_aspect("equal")
        axes.set_xlim(-130.0, 140.0)
        axes.set_ylim(-125.0, 90.0)
        dress(axes, "$z$ [mm]", axes.get_title(loc="left"))
        axes.set_xlabel(f"${across}$ [mm]")
    told = f"All exact. b, c: one turn of the drive, drawn after {INSTANT:g} of it; P is D on yOz"
    style.caption(figure, f"{told}. {style.mechanism(SHOWN)}")
    lengths = {"AD": SHOWN.AD, "QA": SHOWN.QA, "OQ": SHOWN.OQ, "Q Pi": SHOWN.L, "Or Pi": SHOWN.wheel_radius}
    columns = {f"{name} [m]": np.array([value]) for name, value in lengths.items()}
    return figure, columns | {f"{name} [rad]": np.array([getattr(SHOWN, name)]) for name in ("phi", "psi")}


FIGURES: Drawings = {"karetin_1": figure_1}
