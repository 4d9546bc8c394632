"""Mechanisms to scale: layout, modes, trajectories and arms of Karetin, wheels and forces of Lysenko."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from inertia_module.common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION

from . import lysenko
from .drawing import BROKEN, CENTRED, CHAIN, DOTTED, SMALL, Panel, draw, dress, mechanism, sheet, wheels
from .karetin import (
    DYNAMIC,
    GENERAL,
    MOVING,
    PAPER,
    PLANES,
    STOP,
    Geometry,
    Motion,
    exact,
    period,
    stop_mode,
    turned_x,
)
from .lysenko import EXAMPLE as M
from .lysenko import EXAMPLE_SPEED as W

View = tuple[float, float, float, float]
ARROW = {"arrowstyle": "-|>", "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0}
# a, b and c differ from 1, so that no two points are one
LAYOUT = replace(GENERAL, epsilon=0.0, gamma=0.0)
# where the dynamic mode is drawn: share of a turn of the drive
INSTANT = 0.08
# Lysenko's mechanism is drawn at this angle, rad
SHOWN = np.radians(130.0)
AT, TURN = lysenko.exact(M, SHOWN, W), np.exp(1j * M.b * SHOWN)


class Sketch:
    """A drawing in the plane of complex numbers, mm.

    Args:
        axes: to draw in. plane: names of both coordinates. view: left, right, bottom, top, mm.
    """

    def __init__(self, axes: Axes, plane: str, view: View, title: str = "") -> None:
        self.axes = axes
        axes.set_aspect("equal")
        axes.axis(view)
        dress(axes, f"${plane[0]}$ [mm]", f"${plane[1]}$ [mm]", title)

    def line(self, *places: complex, colour: str = BLACK, **look: Any) -> None:
        """A line through places."""
        self.axes.plot(np.real(places), np.imag(places), color=colour, **{"linewidth": 1.3, **look})

    def write(self, place: complex, text: str, colour: str = BLACK) -> None:
        """A text about a place."""
        self.axes.text(place.real, place.imag, text, color=colour, **CENTRED)

    def point(self, place: complex, name: str, aside: complex, colour: str = BLACK) -> None:
        """A point, its name aside."""
        self.line(place, colour=colour, marker="o", markersize=4, zorder=4)
        self.write(place + aside, name, colour)

    def arrow(self, start: complex, along: complex, colour: str, name: str = "", line: Any = "-") -> None:
        """An arrow, its name beyond the tip."""
        end = start + along
        look = {"color": colour, "linestyle": line} | ARROW
        self.axes.annotate("", (end.real, end.imag), (start.real, start.imag), arrowprops=look)
        self.write(end + 7.0 * along / abs(along), name, colour)

    def arc(self, corner: complex, start: complex, angle: float, radius: float, name: str) -> None:
        """An angle, rad, about a corner from a direction, its name in the middle."""
        turned = start / abs(start) * np.exp(1j * np.linspace(0.0, angle, 41))
        self.line(*(corner + radius * turned))
        self.write(corner + (radius + 7.0) * turned[20], name)


def linkage(axes: Axes, plane: str, motion: Motion, share: float, title: str) -> tuple[Sketch, Any]:
    """O, Q, A and D of Karetin's mechanism after a share of a turn of the drive, seen on a plane.

    Returns:
        The drawing; what makes places on it of places, m, shape (3,) or (3, n).
    """
    drawn = Sketch(axes, plane, (-130.0, 140.0, -125.0, 90.0), title)
    one, other = ("xyz".index(axis) for axis in plane)

    def seen(place: Any) -> Any:
        return 1e3 * (place[one] + 1j * place[other])

    now = exact(LAYOUT, motion, share * period(LAYOUT, motion) / LAYOUT.turns_in_period)
    apex = np.array([0.0, 0.0, LAYOUT.OQ])
    Q, A = (seen(turned_x(place, now.theta)) for place in (apex, now.centre_of_satellite))
    D = seen(now.position)
    drawn.line(0j, Q, A, linewidth=2.0)
    drawn.line(A, D, colour=ORANGE, linewidth=2.4)
    drawn.point(0j, "$O$", -8 - 7j)
    drawn.point(Q, "$Q$", -9 + 5j)
    drawn.point(A, "$A$", 9 + 3j)
    drawn.point(D, "$P$" if plane == "yz" else "$D$", 10 - 2j, VERMILION)
    return drawn, seen


def layout(axes: Axes) -> None:
    """Karetin's layout in section, xOz at the time 0."""
    g = LAYOUT
    told = f"a) layout: AD, QA, OQ = {1e3 * g.AD:.1f}, {1e3 * g.QA:.1f}, {1e3 * g.OQ:.1f} mm"
    drawn, seen = linkage(axes, "xz", STOP, 0.0, told)
    Q, *rims = (seen(place) for place in pitch_cones(g))
    for rim, colour in zip(rims, (GREY, BLUE), strict=True):
        drawn.line(Q, rim[0], rim[60], Q, colour=colour)
    centre, K = (0.5 * (rim[0] + rim[60]) for rim in rims)
    drawn.line(-125.0, 135.0, linewidth=0.8, linestyle=CHAIN)
    drawn.line(centre, Q, linewidth=0.8, linestyle=CHAIN)
    drawn.point(K, "$K$", -6 + 8j)
    drawn.point(centre, "$O_r$", -9 - 5j)
    drawn.point(rims[0][0], "$Π$", 2 - 8j)
    drawn.arc(Q, -1j, g.psi, 28.0, "$ψ$")
    drawn.arc(Q, -1j * np.exp(1j * g.psi), g.phi, 34.0, "$φ$")
    places = {"17": -52 - 28j, "6": 64 + 48j, "16, $ω_{16}$": 60j, "link 1, $ω_1$": -96 + 9j}
    for name, place in (places | {"link 2, $ω_2$": 112 - 32j}).items():
        drawn.write(place, name)


def mode(axes: Axes, motion: Motion, title: str) -> None:
    """Karetin's mechanism seen along Ox, which comes towards the reader, with a turn of the drive."""
    drawn, seen = linkage(axes, "yz", motion, INSTANT, title)
    times = np.linspace(0.0, period(LAYOUT, motion) / LAYOUT.turns_in_period, 361)
    D = seen(exact(LAYOUT, motion, INSTANT * times[-1]).position)
    drawn.line(*seen(exact(LAYOUT, motion, times).position), colour=VERMILION, label="P")
    drawn.line(0j, D, colour=GREY, linestyle=BROKEN)
    drawn.arc(0j, 1j, np.angle(D / 1j), 34.0, "$β_P$")
    if motion.carrier:
        drawn.line(0j, 60j, linewidth=0.8, linestyle=CHAIN)
        drawn.arc(0j, 1j, motion.carrier * INSTANT * times[-1], 16.0, "$ω_1t$")


def figure_1() -> Figure:
    """Karetin's figure 1: the layout in section, and both modes seen along the central axis."""
    told = f"All exact. b, c: one turn of the drive, drawn after {INSTANT:g} of it; P is D on yOz"
    figure = sheet(12.0, 4.2, f"{told}. {mechanism(LAYOUT)}")
    section, stop, dynamic = figure.subplots(1, 3)
    layout(section)
    mode(stop, STOP, "b) stop mode: ω2 = 0, OQ at rest")
    mode(dynamic, DYNAMIC, "c) dynamic mode: OQ turns about Ox")
    return figure


def pitch_cones(g: Geometry) -> tuple[Any, Any, Any]:
    """Apex and rims at the time 0.

    Returns:
        Q, m, shape (3,); rims of wheel 17 and of the satellite, m, shape (3, 121) each.
    """
    up, turn = np.array([0.0, 0.0, 1.0]), np.array([np.cos(g.gamma), np.sin(g.gamma), 0.0])
    sideways = np.cross(up, turn)
    around = np.linspace(0.0, 2.0 * np.pi, 121)

    def rim(half: float, axis: Any) -> Any:
        circle = np.outer(np.cross(axis, sideways), np.cos(around)) + np.outer(sideways, np.sin(around))
        return (g.OQ * up + g.L * np.cos(half) * axis)[:, None] + g.L * np.sin(half) * circle

    satellite = np.sin(g.shaft_angle) * turn - np.cos(g.shaft_angle) * up
    return g.OQ * up, rim(g.psi, -up), rim(g.phi, satellite)


def trajectories() -> Figure:
    """Karetin's figure 2: trajectory of D in the stop and in the dynamic mode, with the pitch cones."""
    figure = sheet(
        10.4, 5.2, f"Trajectory of D over a period, exact, with its place at the start. {mechanism(PAPER)}"
    )
    apex, wheel, satellite = pitch_cones(PAPER)
    start = exact(PAPER, stop_mode(1.0), [0.0])
    centre, A, D = np.zeros(3), start.centre_of_satellite[:, 0], start.position[:, 0]
    for n, (title, motion) in enumerate((("a) stop mode", STOP), ("b) dynamic mode, i = 2", DYNAMIC)), 1):
        axes: Any = figure.add_subplot(1, 2, n, projection="3d", computed_zorder=False)
        path = exact(PAPER, motion, np.linspace(0.0, period(PAPER, motion), 1441)).position
        axes.plot(
            path[0], path[1], 0.0 * path[2], color=GREY, linewidth=0.9, linestyle=BROKEN, label="H: D on xOy"
        )
        for rim, colour in ((wheel, GREY), (satellite, BLUE)):
            axes.plot(*rim, color=colour, linewidth=1.3)
            for place in rim[:, ::20].T:
                axes.plot(*np.stack([apex, place], axis=1), color=colour, linewidth=0.4)
        axes.plot(*path, color=VERMILION, linewidth=2.2, label="D")
        axes.plot(*np.stack([centre, apex, A], axis=1), color=BLACK, linewidth=1.2)
        axes.plot(*np.stack([A, D], axis=1), color=ORANGE, linewidth=2.0)
        reach = 1.2 * np.abs(path).max()
        for axis, name in zip(np.eye(3), "xyz", strict=True):
            axes.plot(*np.stack([centre, reach * axis], axis=1), color=BLACK, linewidth=0.9)
            axes.text(*(1.08 * reach * axis), f"${name}$", **CENTRED)
        for place, name in ((centre, "O"), (apex, "Q"), (A, "A"), (D, "D")):
            axes.plot(*place[:, None], "o", color=BLACK, markersize=4)
            axes.text(*(place + 0.09 * reach), f"${name}$", **CENTRED)
        axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", aspect="equal")
        axes.set_title(title, loc="left", fontsize=10)
        axes.legend(**SMALL, loc="lower left")
        axes.view_init(elev=24, azim=-46)
    return figure


def arms() -> Figure:
    """Karetin's (26) to (31): projections of V on the planes at one instant, arms and speeds over a turn."""
    turn, at = slice(0, len(MOVING.t) // int(GENERAL.turns_in_period), 5), 112
    turns = MOVING.t[turn] * MOVING.omega16 / (2.0 * np.pi)
    told = "exact, (26) to (30) as printed the same; in (31) the printed y_N is the x of N"
    scale = f"V: 1 m/s is 4 mm; the planes are drawn at {turns[at]:.2f} turns"
    figure = sheet(
        9.6, 8.0, f"Projections of V and their arms about O, {told}. {scale}. {mechanism(GENERAL)}"
    )
    grid = figure.subplots(3, 3, height_ratios=(2.2, 1.0, 1.0))
    for n, (plane, (one, other), point, foot) in enumerate(
        zip(("xOy", "yOz", "xOz"), PLANES, "HPF", "LMN", strict=True)
    ):

        def seen(place: Any, one: int = one, other: int = other) -> Any:
            return 1e3 * (place[one] + 1j * place[other])[turn]

        path, V, foot_of_O = (seen(v) for v in (MOVING.position, 4e-3 * MOVING.velocity, MOVING.feet[n]))
        mass, arrow, end = path[at], V[at], foot_of_O[at]
        drawn = Sketch(grid[0, n], plane[::2], (-200, 200, -200, 200), plane)
        drawn.axes.plot(path.real, path.imag, color=GREY, linewidth=0.8, label=f"${point}$")
        drawn.axes.axline(
            (mass.real, mass.imag), (end.real, end.imag), color=GREY, linestyle=BROKEN, linewidth=0.8
        )
        drawn.line(0j, end, colour=BLUE)
        drawn.arrow(mass, arrow, VERMILION)
        for place, name in ((0j, "O"), (mass, point), (end, foot)):
            drawn.point(place, f"${name}$", 9 + 9j)
        draw(grid[1, n], Panel(f"O{foot} [mm]", {f"O{foot}": 1e3 * MOVING.arms[n, turn]}), turns)
        draw(
            grid[2, n],
            Panel("speed [m/s]", {plane: MOVING.plane_speeds[n, turn]}),
            turns,
            "turns of the drive",
        )
    return figure


def wheels_at(axes: Axes, view: View) -> tuple[Sketch, complex, complex]:
    """Lysenko's wheels 1 and 2, carrier 3, imbalance and its epicycloid 4.

    Returns:
        The drawing; places of the axis of wheel 1 and of the imbalance, mm.
    """
    drawn, around = Sketch(axes, "XY", view), np.exp(2j * np.pi * np.linspace(0.0, 1.0, 721))
    x, y = lysenko.exact(M, np.linspace(0.0, 2.0 * np.pi / M.b, 721)).epicycloid
    centre, mass = 1e3 * AT.D * TURN, complex(1e3 * AT.place * TURN)
    drawn.line(*(1e3 * (x + 1j * y)), colour=GREY, label="epicycloid")
    drawn.line(*(1e3 * M.R0 * around), colour=GREY, linewidth=1.6)
    drawn.line(*(centre + 1e3 * M.r * around), colour=BLUE, linewidth=1.6)
    drawn.line(0j, centre)
    drawn.line(centre, mass, colour=BLUE)
    drawn.line(0j, mass, linestyle=BROKEN)
    drawn.write(0.5 * mass, "$ρ$")
    drawn.point(0j, "$O$", -5 - 5j)
    drawn.point(centre, "$O_1$", -8 + 3j)
    drawn.point(mass, "$S$", 3 - 7j, VERMILION)
    drawn.arc(0j, 1 + 0j, M.b * SHOWN, 22.0, "$bα$")
    drawn.arc(centre, -centre, SHOWN, 8.0, "$α$")
    return drawn, centre, mass


def epicycloid() -> Figure:
    """The figure of Lysenko, to scale: wheels 1 and 2, carrier 3, epicycloid 4, distance and angles."""
    figure = sheet(5.6, 6.0, f"Wheel 1 rolls around the held wheel 2 (exact), drawn at α = 130°. {wheels()}")
    drawn, centre, _ = wheels_at(figure.subplots(), (-105, 105, -105, 105))
    for name, place in (("1", centre + 15j), ("2", -37 - 37j), ("3", 0.4 * centre + 6j), ("4", -90 + 45j)):
        drawn.write(place, name)
    return figure


def speeds(axes: Axes) -> None:
    """Lysenko's angles and speeds of (6) to (8) and (13), 45 mm for V."""
    drawn, _, mass = wheels_at(axes, (-12, 132, -12, 112))
    spoke, velocity, scale = complex(AT.spoke * TURN), complex(AT.velocity * TURN), 45.0 / AT.V
    drawn.arrow(mass, scale * 1j * W * spoke, BLUE, "$V_1$")
    drawn.arrow(mass, scale * 1e-3j * M.b * W * mass, GREEN, "$V_2$")
    drawn.arrow(mass, scale * velocity, VERMILION, "$V$")
    for direction in (spoke, mass):
        drawn.line(mass, mass + 30.0 * direction / abs(direction), colour=GREY, linestyle=BROKEN)
    drawn.arc(mass, spoke, float(AT.beta1), 22.0, "$β_1$")
    drawn.arc(mass, velocity, float(AT.delta), 30.0, "$δ$")
    sizes = f"{AT.V1:.2f}, {AT.V2:.2f}, {AT.V:.2f} m/s"
    axes.set_title(f"angles and speeds: $V_1, V_2, V$ = {sizes}", loc="left", fontsize=9)


def forces(axes: Axes, page: Any) -> None:
    """Lysenko's forces and arms of (3) to (5) and (11) to (14), 24 mm for F1; grey as printed."""
    drawn, centre, mass = wheels_at(axes, (-12, 132, -12, 112))
    outward, scale = complex(AT.spoke * TURN) / M.arm, 24.0 / AT.F1
    wrong = outward * np.exp(1j * (page.beta1 - page.delta))
    for of, along, colour, name, aside in (
        (0j, outward, GREEN, "$n_1 = k_2$", 15 + 6j),
        (centre, mass / abs(mass), PURPLE, "$n_2$", 8 - 9j),
        (centre, wrong, GREY, "$k_1$", -6 - 2j),
        (0j, wrong, GREY, "$k_2$", -5 + 0j),
    ):
        # of the perpendicular from a point on the line of a force through the imbalance
        foot = mass + ((of - mass) * np.conj(along)).real * along
        drawn.line(mass, foot, colour=colour, linestyle=BROKEN)
        drawn.line(of, foot, colour=colour, linestyle=DOTTED)
        drawn.write(0.5 * (of + foot) + aside, name, colour)
    drawn.arrow(mass, scale * (AT.F1 + AT.Fk) * outward, ORANGE, "$F_k$")
    drawn.arrow(mass, scale * AT.F1 * outward, GREEN, "$F_1$")
    drawn.arrow(mass, scale * AT.F2 * mass / abs(mass), PURPLE, "$F_2$")
    drawn.arrow(mass, scale * page.Fk * wrong, GREY, "$F_k$", BROKEN)
    sizes = f"{AT.F1:.0f}, {AT.F2:.0f}, {AT.Fk:.0f} N (printed {page.Fk:.0f} N)"
    axes.set_title(f"forces and arms: $F_1, F_2, F_k$ = {sizes}", loc="left", fontsize=9)


def speeds_and_forces() -> Figure:
    """Angles, speeds, forces and arms of Lysenko's imbalance at one angle."""
    page = lysenko.printed(M, SHOWN, W)
    printed_arms = f"its arms as printed k1 = {1e3 * page.k1:.1f} and k2 = {1e3 * page.k2:.1f} mm"
    told = f"exact (Fk lies behind F1, on one line: k1 = 0), grey Fk as printed, {printed_arms}"
    figure = sheet(9.4, 5.0, f"At α = 130°, {told}. {wheels()}")
    left, right = figure.subplots(1, 2)
    speeds(left)
    forces(right, page)
    return figure


FIGURES: dict[str, Callable[[], Figure]] = {
    "karetin_1": figure_1,
    "karetin_2": trajectories,
    "karetin_arms": arms,
    "lysenko_1": epicycloid,
    "lysenko_forces": speeds_and_forces,
}
