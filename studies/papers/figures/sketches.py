"""Mechanisms to scale: layout, modes, trajectories and arms of Karetin, wheels and forces of Lysenko."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle

from inertia_module.common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION

from ..karetin import Geometry, Motion, exact, stop_mode
from ..karetin.equations import MOVING, PLANES, turned_x
from ..karetin.mechanism import DYNAMIC, GENERAL, PAPER, STOP, period
from ..lysenko import equations as lysenko
from ..lysenko.equations import EXAMPLE as M
from ..lysenko.equations import EXAMPLE_SPEED as W
from .drawing import BROKEN, CENTRED, CHAIN, DOTTED, SMALL, Panel, draw, dress, mechanism, sheet, wheels

# a, b and c differ from 1, so that no two points are one
LAYOUT = replace(GENERAL, epsilon=0.0, gamma=0.0)
# where the dynamic mode is drawn: share of a turn of the drive
INSTANT = 0.08
# Lysenko's mechanism is drawn at this angle, rad
SHOWN = np.radians(130.0)


class Sketch:
    """A drawing in the plane of complex numbers, mm.

    Args:
        axes: to draw in. abscissa, ordinate: names of the coordinates.
        view: left, right, bottom, top, mm.
    """

    def __init__(
        self,
        axes: Axes,
        abscissa: str,
        ordinate: str,
        view: tuple[float, float, float, float],
        title: str = "",
    ) -> None:
        self.axes = axes
        axes.set_aspect("equal")
        axes.axis(view)
        dress(axes, f"${abscissa}$ [mm]", f"${ordinate}$ [mm]", title)

    def line(self, *places: complex, colour: str = BLACK, name: str = "", **look: Any) -> None:
        """A line through places, its name in the middle of the first part."""
        points = np.array(places)
        self.axes.plot(points.real, points.imag, color=colour, **{"linewidth": 1.3, **look})
        self.write(0.5 * (points[0] + points[1]), name, colour)

    def write(self, place: complex, text: str, colour: str = BLACK) -> None:
        """A text about a place."""
        self.axes.text(place.real, place.imag, text, color=colour, **CENTRED)

    def point(self, place: complex, name: str, aside: complex, colour: str = BLACK) -> None:
        """A point, its name aside."""
        self.axes.plot(place.real, place.imag, "o", color=colour, markersize=4, zorder=4)
        self.write(place + aside, name, colour)

    def arrow(self, start: complex, along: complex, colour: str, name: str = "", line: Any = "-") -> None:
        """An arrow, its name beyond the tip."""
        end = start + along
        look = {
            "arrowstyle": "-|>",
            "color": colour,
            "linewidth": 1.6,
            "linestyle": line,
            "shrinkA": 0,
            "shrinkB": 0,
        }
        self.axes.annotate("", (end.real, end.imag), (start.real, start.imag), arrowprops=look)
        self.write(end + 7.0 * along / abs(along), name, colour)

    def arc(self, corner: complex, start: complex, angle: float, radius: float, name: str) -> None:
        """An angle, rad, about a corner from a direction, its name in the middle."""
        begin = np.degrees(np.angle(start))
        low, high = sorted((begin, begin + np.degrees(angle)))
        self.axes.add_patch(Arc((corner.real, corner.imag), 2 * radius, 2 * radius, theta1=low, theta2=high))
        self.write(corner + (radius + 7.0) * start / abs(start) * np.exp(0.5j * angle), name)


def layout(axes: Axes) -> None:
    """Karetin's layout in section, xOz at the time 0."""
    g = LAYOUT
    told = f"a) layout: AD, QA, OQ = {1e3 * g.AD:.1f}, {1e3 * g.QA:.1f}, {1e3 * g.OQ:.1f} mm"
    drawn = Sketch(axes, "x", "z", (-130.0, 140.0, -125.0, 90.0), told)
    along = np.exp(1j * (g.shaft_angle - 0.5 * np.pi))
    Q = 1e3j * g.OQ
    A, K, wheel = (
        Q + 1e3 * g.QA * along,
        Q + 1e3 * g.L * np.cos(g.phi) * along,
        Q - 1e3j * g.L * np.cos(g.psi),
    )
    D, rim, radius = A - 1e3j * g.AD * along, -1e3j * g.L * np.sin(g.phi) * along, 1e3 * g.wheel_radius
    drawn.line(Q, wheel - radius, wheel + radius, Q, colour=GREY)
    drawn.line(Q, K - rim, K + rim, Q, colour=BLUE)
    drawn.line(-125.0, 135.0, linewidth=0.8, linestyle=CHAIN)
    drawn.line(wheel, Q, linewidth=0.8, linestyle=CHAIN)
    drawn.line(0j, Q, A, linewidth=2.0)
    drawn.line(A, D, colour=ORANGE, linewidth=2.4)
    drawn.point(0j, "$O$", -7 - 6j)
    drawn.point(Q, "$Q$", -8 + 4j)
    drawn.point(A, "$A$", 9 + 2j)
    drawn.point(K, "$K$", -6 + 8j)
    drawn.point(wheel, "$O_r$", -9 - 5j)
    drawn.point(wheel + radius, "$Π$", 2 - 8j)
    drawn.point(D, "$D$", 10, VERMILION)
    drawn.arc(Q, -1j, g.psi, 28.0, "$ψ$")
    drawn.arc(Q, -1j * np.exp(1j * g.psi), g.phi, 34.0, "$φ$")
    places = {"17": -52 - 28j, "6": 64 + 48j, "16, $ω_{16}$": 60j, "link 1, $ω_1$": -96 + 9j}
    for name, place in (places | {"link 2, $ω_2$": 112 - 32j}).items():
        drawn.write(place, name)


def mode(axes: Axes, motion: Motion, title: str) -> None:
    """Karetin's mechanism seen along Ox, which comes towards the reader, with a turn of the drive."""
    drawn = Sketch(axes, "y", "z", (-130.0, 140.0, -125.0, 90.0), title)
    span = period(LAYOUT, motion) / LAYOUT.turns_in_period
    now = exact(LAYOUT, motion, [INSTANT * span])

    def seen(place: Any) -> Any:
        return 1e3 * (place[1] + 1j * place[2])

    path = seen(exact(LAYOUT, motion, np.linspace(0.0, span, 361)).position)
    D, A = (complex(seen(place)[0]) for place in (now.position, turned_x(now.centre_of_satellite, now.theta)))
    turn = motion.carrier * INSTANT * span
    Q = 1e3j * LAYOUT.OQ * np.exp(1j * turn)
    drawn.axes.plot(path.real, path.imag, color=VERMILION, linewidth=1.2, label="P")
    drawn.line(0j, Q, A, linewidth=2.0)
    drawn.line(A, D, colour=ORANGE, linewidth=2.4)
    drawn.line(0j, D, colour=GREY, linestyle=BROKEN)
    drawn.point(0j, "$O$", -8 - 7j)
    drawn.point(Q, "$Q$", -9 + 5j)
    drawn.point(A, "$A$", 9 + 3j)
    drawn.point(D, "$P$", 10 - 2j, VERMILION)
    drawn.arc(0j, 1j, np.angle(D / 1j), 34.0, "$β_P$")
    if turn:
        drawn.line(0j, 60j, linewidth=0.8, linestyle=CHAIN)
        drawn.arc(0j, 1j, turn, 16.0, "$ω_1t$")


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
        drawn = Sketch(grid[0, n], plane[0], plane[2], (-200, 200, -200, 200), plane)
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


def wheels_at(axes: Axes, view: tuple[float, float, float, float]) -> tuple[Sketch, complex, complex]:
    """Lysenko's wheels 1 and 2, carrier 3, imbalance and its epicycloid 4.

    Returns:
        The drawing; places of the axis of wheel 1 and of the imbalance, mm.
    """
    drawn, turn = Sketch(axes, "X", "Y", view), np.exp(1j * M.b * SHOWN)
    e = lysenko.exact(M, SHOWN, W)
    centre, mass = 1e3 * e.D * turn, complex(1e3 * e.place * turn)
    x, y = lysenko.exact(M, np.linspace(0.0, 2.0 * np.pi / M.b, 721)).epicycloid
    axes.plot(1e3 * x, 1e3 * y, color=GREY, linewidth=1.0, label="epicycloid")
    for middle, radius, colour in ((0j, M.R0, GREY), (centre, M.r, BLUE)):
        axes.add_patch(
            Circle((middle.real, middle.imag), 1e3 * radius, fill=False, color=colour, linewidth=1.6)
        )
    drawn.line(0j, centre)
    drawn.line(centre, mass, colour=BLUE)
    drawn.line(0j, mass, name="$ρ$", linestyle=BROKEN)
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


def forces() -> Figure:
    """Lysenko's angles and speeds of (6) to (8) and (13), forces and arms of (3) to (5) and (11) to (14)."""
    e, page = lysenko.exact(M, SHOWN, W), lysenko.printed(M, SHOWN, W)
    arms_told = f"its arms as printed k1 = {1e3 * page.k1:.1f} and k2 = {1e3 * page.k2:.1f} mm"
    told = f"exact (Fk lies behind F1, on one line: k1 = 0), grey Fk as printed, {arms_told}"
    figure = sheet(9.4, 5.0, f"At α = 130°, {told}. {wheels()}")
    left, right = (wheels_at(axes, (-12, 132, -12, 112)) for axes in figure.subplots(1, 2))
    drawn, centre, mass = left
    turn = np.exp(1j * M.b * SHOWN)
    spoke, velocity = complex(e.spoke * turn), complex(e.velocity * turn)
    outward = spoke / M.arm
    # 45 mm for V
    scale = 45.0 / e.V
    drawn.arrow(mass, scale * 1j * W * spoke, BLUE, "$V_1$")
    drawn.arrow(mass, scale * 1e-3j * M.b * W * mass, GREEN, "$V_2$")
    drawn.arrow(mass, scale * velocity, VERMILION, "$V$")
    drawn.line(mass, mass + 30.0 * outward, colour=GREY, linestyle=BROKEN)
    drawn.line(mass, mass + 30.0 * mass / abs(mass), colour=GREY, linestyle=BROKEN)
    drawn.arc(mass, spoke, float(e.beta1), 22.0, "$β_1$")
    drawn.arc(mass, velocity, float(e.delta), 30.0, "$δ$")
    speeds = f"{M.arm * W:.2f}, {e.rho * M.b * W:.2f}, {e.V:.2f} m/s"
    drawn.axes.set_title(f"angles and speeds: $V_1, V_2, V$ = {speeds}", loc="left", fontsize=9)

    drawn, centre, mass = right
    wrong = outward * np.exp(1j * (page.beta1 - page.delta))

    def arm(of: complex, direction: complex, colour: str, name: str, aside: complex) -> None:
        """The perpendicular from a point on the line of a force through the imbalance."""
        unit = direction / abs(direction)
        foot = mass + ((of - mass) * unit.conjugate()).real * unit
        drawn.line(mass, foot, colour=colour, linestyle=BROKEN)
        drawn.line(of, foot, colour=colour, linestyle=DOTTED)
        drawn.write(0.5 * (of + foot) + aside, name, colour)

    arm(0j, outward, GREEN, "$n_1 = k_2$", 15 + 6j)
    arm(centre, mass, PURPLE, "$n_2$", 8 - 9j)
    arm(centre, wrong, GREY, "$k_1$", -6 - 2j)
    arm(0j, wrong, GREY, "$k_2$", -5 + 0j)
    # 24 mm for F1
    scale = 24.0 / e.F1
    drawn.arrow(mass, scale * (e.F1 + e.Fk) * outward, ORANGE, "$F_k$")
    drawn.arrow(mass, scale * e.F1 * outward, GREEN, "$F_1$")
    drawn.arrow(mass, scale * e.F2 * mass / abs(mass), PURPLE, "$F_2$")
    drawn.arrow(mass, scale * page.Fk * wrong, GREY, "$F_k$", BROKEN)
    sizes = f"{e.F1:.0f}, {e.F2:.0f}, {e.Fk:.0f} N (printed {page.Fk:.0f} N)"
    drawn.axes.set_title(f"forces and arms: $F_1, F_2, F_k$ = {sizes}", loc="left", fontsize=9)
    return figure


FIGURES: dict[str, Callable[[], Figure]] = {
    "karetin_1": figure_1,
    "karetin_2": trajectories,
    "karetin_arms": arms,
    "lysenko_1": epicycloid,
    "lysenko_forces": forces,
}
