"""Sketch of a mechanism to scale: pitch circles or pitch cones, imbalances and their paths.

Sizes that no parameter gives (shafts, freewheels, wheels 2 and 16, widths) are not drawn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from ..common.colours import BLACK, BLUE, GREY, ORANGE, VERMILION
from ..kernel import layout
from ..memory import Module
from .panels import Array, plain, sheet

MILLIMETRES = 1e3
# a turn, for circles and paths, rad, and a circle of radius 1 about Ox
TURN = np.linspace(0.0, math.tau, 181)
CIRCLE = np.stack([0.0 * TURN, np.sin(TURN), np.cos(TURN)], axis=1)
# turns of the drive at most that a path shows: a whole period may take a million
MOST_TURNS = 20
# axes across and up, by what a view is
PLANAR = {"view along the central axis, paths relative to link 1": (1, 2)}
BEVEL = {
    "section through the central axis and the pinion shaft": (0, 2),
    "view along the pinion shaft": (0, 1),
}


def mechanism_figure(parameters: Mapping[str, float]) -> Figure:
    """Draw one module of a mechanism, by its parameters, in mm, with its imbalances and their paths."""
    module = Module("plain")
    module.check(**parameters)
    figure, d = sheet(height=5.6), module.derived
    views, draw = (PLANAR, _draw_planar) if d.planar else (BEVEL, _draw_bevel)
    for axes, (title, view) in zip(
        figure.subplots(1, len(views), squeeze=False)[0], views.items(), strict=True
    ):
        draw(axes, d, view)
        axes.set_title(title, loc="left", fontsize=12)
        axes.set_xlabel(f"{'xyz'[view[0]]} [mm]")
        axes.set_ylabel(f"{'xyz'[view[1]]} [mm]")
        axes.set_aspect("equal", adjustable="datalim")
        plain(axes)
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    return figure


def _draw(
    axes: Axes, places: Array, view: tuple[int, int], colour: str, label: str, filled: bool = True
) -> Array:
    """Draw a line through places, m, shape (n, 3); what is seen of it, mm, shape (2, n)."""
    seen: Array = MILLIMETRES * places[:, view].T
    axes.plot(*seen, color=colour, linewidth=1.8 if filled else 0.8, label=label)
    if filled:
        axes.fill(*seen, color=colour, alpha=0.15, linewidth=0)
    return seen


def _draw_imbalance(axes: Axes, d: Any, view: tuple[int, int], q: Array, turned: float) -> None:
    """Draw an imbalance of a satellite turned from satellite 0, and its path over drive angles q, rad."""
    places = [layout.imbalance(d, angle, turned)[:3] for angle in q]  # type: ignore[no-untyped-call]
    if d.planar:
        places = [layout.to_fixed_frame(turned, *place) for place in places]  # type: ignore[no-untyped-call]
    seen = _draw(axes, np.array(places), view, VERMILION, "", filled=False)
    axes.plot(*seen[:, :1], "o", color=VERMILION, label="" if turned else "unbalanced mass and its path")


def _draw_planar(axes: Axes, d: Any, view: tuple[int, int]) -> None:
    """Draw sun wheel, carrier and satellites at the start."""
    _draw(axes, d.sun_radius * CIRCLE, view, BLUE, "sun gear, link 2")
    for turned in np.arange(d.satellites) * math.tau / d.satellites:
        centre = d.axial * np.array([0.0, -math.sin(turned), math.cos(turned)])
        _draw(axes, np.stack([0.0 * centre, centre]), view, BLACK, "" if turned else "carrier, link 1")
        circle = centre + d.satellite_radius * CIRCLE
        _draw(axes, circle, view, ORANGE, "" if turned else "satellite")
        _draw_imbalance(axes, d, view, d.drive_angle_start + TURN, turned)


def _draw_bevel(axes: Axes, d: Any, view: tuple[int, int]) -> None:
    """Draw the pitch cones with satellite 0 in the plane of central axis and drive."""
    phi = math.atan2(math.sin(d.shaft_angle), d.s + math.cos(d.shaft_angle))
    psi = d.shaft_angle - phi
    slant = d.wheel_radius / math.sin(psi)
    apex = np.array([0.0, 0.0, d.c * slant * math.cos(psi)])
    for line in (axes.axvline, axes.axhline):
        line(0.0, color=GREY, linewidth=0.9, dashes=(10, 3, 2, 3))
    _draw_cone(axes, view, BLUE, "gear 17, fixed to link 1", apex, slant * _cone(psi, math.pi, 0.0))
    turns = min(int(d.period_turns), MOST_TURNS)
    path = np.linspace(0.0, math.tau * turns, TURN.size * turns) - d.phase_a
    for turned in np.arange(d.satellites) * math.tau / d.satellites:
        cone = slant * _cone(phi, math.pi - d.shaft_angle, turned)
        _draw_cone(axes, view, ORANGE, "" if turned else "satellite gear 6", apex, cone)
        _draw_imbalance(axes, d, view, path[:1] if turned else path, turned)


def _cone(half: float, polar: float, azimuth: float) -> Array:
    """Rim of a cone of slant 1 and this half angle, its axis at these angles; from its apex, shape (n, 3)."""
    about_x = np.array([math.cos(half), 0.0, 0.0]) + math.sin(half) * CIRCLE
    rim: Array = Rotation.from_euler("yz", [polar - 0.5 * math.pi, azimuth]).apply(about_x)
    return rim


def _draw_cone(axes: Axes, view: tuple[int, int], colour: str, label: str, apex: Array, rim: Array) -> None:
    """Draw the rim of a cone, from its apex, and its outline, where the apex is seen outside the rim."""
    _draw(axes, apex + rim, view, colour, label)
    angles = np.unwrap(np.arctan2(*rim[:, view[::-1]].T))
    if np.ptp(angles) < math.pi:
        ends = rim[[angles.argmin(), angles.argmax()]]
        _draw(axes, apex + np.stack([ends[0], 0.0 * apex, ends[1]]), view, colour, "")
