"""Sketch of a mechanism to scale: pitch circles or pitch cones, unbalanced masses and their paths.

The sketch excludes dimensions that are not parameters: shafts, freewheels, gears 2 and 16, widths.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from ..common.colours import BLACK, BLUE, GREY, ORANGE, VERMILION, styled
from ..kernel import layout
from ..model import Module
from .panels import Array, new_figure

MILLIMETRES = 1e3
# angles of one revolution, rad, and a circle of radius 1 about Ox
TURN = np.linspace(0.0, math.tau, 181)
CIRCLE = np.stack([0.0 * TURN, np.sin(TURN), np.cos(TURN)], axis=1)
# maximum number of pinion-shaft revolutions of a path; a period can have a million
MAX_REVOLUTIONS = 20
# horizontal and vertical axis of a view by its title
PLANAR = {"view along the central axis, paths relative to link 1": (1, 2)}
BEVEL = {
    "section through the central axis and the pinion shaft": (0, 2),
    "view along the pinion shaft": (0, 1),
}


@styled()
def mechanism_figure(parameters: Mapping[str, float]) -> Figure:
    """Draw one module of a mechanism, in mm, with its unbalanced masses and their paths.

    Args:
        parameters: Parameters of the module, SI, by name.

    Raises:
        ParameterError: The parameters are invalid.
    """
    module = Module("plain")
    module.check(**parameters)
    figure, d = new_figure(height=5.6), module.derived
    views, draw = (PLANAR, _draw_planar) if d.planar else (BEVEL, _draw_bevel)
    for axes, (title, view) in zip(
        figure.subplots(1, len(views), squeeze=False)[0], views.items(), strict=True
    ):
        draw(axes, d, view)
        axes.set_title(title)
        axes.set_xlabel(f"{'xyz'[view[0]]} [mm]")
        axes.set_ylabel(f"{'xyz'[view[1]]} [mm]")
        axes.set_aspect("equal", adjustable="datalim")
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw(
    axes: Axes, places: Array, view: tuple[int, int], colour: str, label: str, is_filled: bool = True
) -> Array:
    """Draw a line through places, m, shape (n, 3), and return its projection, mm, shape (2, n)."""
    projection: Array = MILLIMETRES * places[:, view].T
    axes.plot(*projection, color=colour, linewidth=1.8 if is_filled else 0.8, label=label)
    if is_filled:
        axes.fill(*projection, color=colour, alpha=0.15, linewidth=0)
    return projection


def _draw_imbalance(axes: Axes, d: Any, view: tuple[int, int], q: Array, azimuth: float) -> None:
    """Draw the unbalanced mass of a satellite at an azimuth, rad, and its path over angles q, rad."""
    places = [layout.imbalance_position(d, angle, azimuth)[:3] for angle in q]
    if d.planar:
        places = [layout.to_fixed_frame(azimuth, *place) for place in places]
    projection = _draw(axes, np.array(places), view, VERMILION, "", is_filled=False)
    axes.plot(
        *projection[:, :1], "o", color=VERMILION, label="" if azimuth else "unbalanced mass and its path"
    )


def _draw_planar(axes: Axes, d: Any, view: tuple[int, int]) -> None:
    """Draw sun gear, carrier and satellites in their initial position."""
    _draw(axes, d.sun_radius * CIRCLE, view, BLUE, "sun gear, link 2")
    for azimuth in np.arange(d.satellites) * math.tau / d.satellites:
        centre = d.axial * np.array([0.0, -math.sin(azimuth), math.cos(azimuth)])
        _draw(axes, np.stack([0.0 * centre, centre]), view, BLACK, "" if azimuth else "carrier, link 1")
        circle = centre + d.satellite_radius * CIRCLE
        _draw(axes, circle, view, ORANGE, "" if azimuth else "satellite")
        _draw_imbalance(axes, d, view, d.drive_angle_start + TURN, azimuth)


def _draw_bevel(axes: Axes, d: Any, view: tuple[int, int]) -> None:
    """Draw the pitch cones with satellite 0 in the plane of the central axis and the pinion shaft."""
    phi = math.atan2(math.sin(d.shaft_angle), d.s + math.cos(d.shaft_angle))
    psi = d.shaft_angle - phi
    slant = d.wheel_radius / math.sin(psi)
    apex = np.array([0.0, 0.0, d.c * slant * math.cos(psi)])
    for line in (axes.axvline, axes.axhline):
        line(0.0, color=GREY, linewidth=0.9, dashes=(10, 3, 2, 3))
    _draw_cone(axes, view, BLUE, "gear 17, fixed to link 1", apex, slant * _cone(psi, math.pi, 0.0))
    revolutions = min(int(d.period_turns), MAX_REVOLUTIONS)
    path = np.linspace(0.0, math.tau * revolutions, TURN.size * revolutions) - d.phase_a
    for azimuth in np.arange(d.satellites) * math.tau / d.satellites:
        cone = slant * _cone(phi, math.pi - d.shaft_angle, azimuth)
        _draw_cone(axes, view, ORANGE, "" if azimuth else "satellite gear 6", apex, cone)
        _draw_imbalance(axes, d, view, path[:1] if azimuth else path, azimuth)


def _cone(half: float, polar: float, azimuth: float) -> Array:
    """Return the rim of a cone of slant 1 relative to its apex, shape (n, 3); angles in rad."""
    about_x = np.array([math.cos(half), 0.0, 0.0]) + math.sin(half) * CIRCLE
    rim: Array = Rotation.from_euler("yz", [polar - 0.5 * math.pi, azimuth]).apply(about_x)
    return rim


def _draw_cone(axes: Axes, view: tuple[int, int], colour: str, label: str, apex: Array, rim: Array) -> None:
    """Draw the rim of a cone and, if the apex is outside the projected rim, its outline."""
    _draw(axes, apex + rim, view, colour, label)
    angles = np.unwrap(np.arctan2(*rim[:, view[::-1]].T))
    if np.ptp(angles) < math.pi:
        ends = rim[[angles.argmin(), angles.argmax()]]
        _draw(axes, apex + np.stack([ends[0], 0.0 * apex, ends[1]]), view, colour, "")
