"""The pitch cones of Karetin's standard layout, with axes, points and path of D, in three dimensions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia_module.common.colours import BLACK, BLUE, GREY, ORANGE, SKY, VERMILION

from ..karetin import Geometry, exact, stop_mode
from .style import BROKEN, CENTRED, SMALL

Array = NDArray[np.float64]

_RIM = 121
# between ticks of the axes, m
TICK = 0.05


def pitch_cones(g: Geometry) -> tuple[Array, Array, Array]:
    """Apex and rims at the time 0.

    Returns:
        Q, m, shape (3,); rims of wheel 17 and of the satellite, m, shape (3, 121) each.
    """
    turn, sideways, up = np.array(
        [[np.cos(g.gamma), np.sin(g.gamma), 0.0], [-np.sin(g.gamma), np.cos(g.gamma), 0.0], [0.0, 0.0, 1.0]]
    )
    sine, cosine = np.sin(g.shaft_angle), np.cos(g.shaft_angle)
    round_ = np.linspace(0.0, 2.0 * np.pi, _RIM)

    def rim(half: float, axis: Array, across: Array) -> Any:
        circle = np.outer(across, np.cos(round_)) + np.outer(sideways, np.sin(round_))
        return (g.OQ * up + g.L * np.cos(half) * axis)[:, None] + g.L * np.sin(half) * circle

    wheel = rim(g.psi, -up, turn)
    return g.OQ * up, wheel, rim(g.phi, sine * turn - cosine * up, cosine * turn + sine * up)


def _cone(axes: Any, apex: Array, rim: Array, colour: str) -> None:
    surface = np.stack([np.broadcast_to(apex[:, None], rim.shape), rim], axis=1)
    axes.plot_surface(*surface, color=colour, alpha=0.16, linewidth=0, shade=False, rcount=2, ccount=_RIM)
    axes.plot(*rim, color=colour, linewidth=1.3)
    for n in range(0, _RIM - 1, 20):
        axes.plot(*np.stack([apex, rim[:, n]], axis=1), color=colour, linewidth=0.4, alpha=0.6)


def _axes_of_frame(axes: Any, reach: float) -> None:
    for direction, name, share in zip(np.eye(3), "xyz", (1.0, 1.0, 0.8), strict=True):
        axes.quiver(0, 0, 0, *share * reach * direction, color=BLACK, linewidth=0.9, arrow_length_ratio=0.06)
        ticks = np.outer(direction, np.arange(TICK, share * reach, TICK))
        axes.plot(*ticks, "|" if name != "z" else "_", color=BLACK, markersize=6)
        axes.text(*(share + 0.09) * reach * direction, f"${name}$", color=BLACK, **CENTRED)


def _points(axes: Any, g: Geometry, reach: float) -> None:
    """Arms O-Q-A-D at the time 0 and their names."""
    e = exact(g, stop_mode(1.0), [0.0])
    origin, apex = np.zeros(3), np.array([0.0, 0.0, g.OQ])
    foot, start = e.centre_of_satellite[:, 0], e.position[:, 0]
    axes.plot(*np.stack([origin, apex, foot], axis=1), color=BLACK, linewidth=1.2)
    axes.plot(*np.stack([foot, start], axis=1), color=ORANGE, linewidth=2.0)
    for point, name, shift in (
        (origin, "$O$", (-0.09, 0.0, -0.09)),
        (apex, "$Q$", (-0.07, 0.0, 0.11)),
        (foot, "$A$", (0.05, 0.0, 0.08)),
        (start, "$D$", (0.08, 0.0, -0.1)),
    ):
        axes.plot(*point[:, None], "o", color=VERMILION if name == "$D$" else BLACK, markersize=5)
        axes.text(*(point + reach * np.array(shift)), name, **CENTRED)


def _arrows(axes: Any, path: Array, reach: float) -> None:
    """The sense in which D runs along its path, in six places spread evenly over its length."""
    steps = np.diff(path.T, axis=0)
    run = np.cumsum(np.linalg.norm(steps, axis=1))
    for n in np.searchsorted(run, (np.arange(6) + 0.35) / 6.0 * run[-1]):
        step = 0.08 * reach * steps[n] / np.linalg.norm(steps[n])
        axes.quiver(*(path[:, n] - step), *step, color=VERMILION, linewidth=1.6, arrow_length_ratio=0.9)


def layout(axes: Any, g: Geometry, path: Array, title: str) -> None:
    """Draw cones, axes, arm and path of D into three-dimensional axes.

    Args:
        axes: of projection "3d". g: of the mechanism. path: of D, m, shape (3, n). title: of the panel.
    """
    apex, wheel, satellite = pitch_cones(g)
    reach = 1.2 * float(np.abs(path).max())
    # where the path is over or under the base of wheel 17
    below, label = np.zeros(path.shape[1]), "$H$: $D$ on $xOy$"
    axes.plot(path[0], path[1], below, color=SKY, linewidth=0.9, linestyle=BROKEN, label=label)
    _cone(axes, apex, wheel, GREY)
    _cone(axes, apex, satellite, BLUE)
    axes.text(*(0.84 * wheel[:, 90]), "17", color=GREY, **CENTRED)
    axes.text(*(0.45 * apex + 0.55 * satellite[:, 15]), "6", color=BLUE, fontsize=11)
    _axes_of_frame(axes, reach)
    axes.plot(*path, color=VERMILION, linewidth=2.2, label="$D$")
    _arrows(axes, path, reach)
    _points(axes, g, reach)
    axes.set_title(title, fontsize=11, loc="left", y=0.97)
    everything = np.concatenate([path, wheel, satellite, [[0.0], [0.0], [0.8 * reach]]], axis=1)
    low, high = everything.min(axis=1), everything.max(axis=1)
    half = 0.5 * float((high - low).max())
    for limits, centre in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), 0.5 * (low + high), strict=True):
        limits(centre - half, centre + half)
    axes.set_box_aspect((1, 1, 1), zoom=1.3)
    axes.legend(**SMALL, loc="lower left")
    axes.view_init(elev=24, azim=-46)
    axes.set_axis_off()
