"""Lysenko's mechanism: the epicycloid, and moments, torque and power over a cycle, exact and printed."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle

from inertia_module.common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION

from ..lysenko.as_printed import printed
from ..lysenko.exact import exact
from ..lysenko.mechanism import EXAMPLE as M
from ..lysenko.mechanism import EXAMPLE_SPEED as W
from . import style
from .style import CENTRED, Columns, Drawings, dress, sheet

POINTS = 721
# where the mechanism is drawn, rad
SHOWN = np.radians(130.0)
CLEAR = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
AT = f"α = {np.degrees(SHOWN):.0f}°"
E, TURN = exact(M, SHOWN, W), np.exp(1j * M.b * SHOWN)
# lengths of the arrows of F1 and of V, m; what is seen of the mechanism, mm
FORCE, SPEED = 0.024, 0.045
VIEW = (-12, 132, -12, 112)


def _line(axes: Axes, start: complex, end: complex, colour: str, name: str = "", line: Any = "-") -> None:
    """A line between two points of the plane, its name in the middle."""
    axes.plot((start.real, end.real), (start.imag, end.imag), color=colour, linewidth=1.4, linestyle=line)
    if name:
        middle = 0.5 * (start + end)
        axes.text(middle.real, middle.imag, name, color=colour, **CENTRED, bbox=CLEAR)


def _arrow(
    axes: Axes, start: complex, along: complex, colour: str, name: str, line: Any = "-", below: bool = False
) -> None:
    """An arrow from a point of the plane, its name beyond the tip or below it."""
    look = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.6, "mutation_scale": 13}
    look |= {"linestyle": line, "shrinkA": 0, "shrinkB": 0}
    end = start + along
    axes.annotate("", (end.real, end.imag), (start.real, start.imag), arrowprops=look)
    beyond = end + (-0.006j if below else 0.007 * along / abs(along))
    axes.text(beyond.real, beyond.imag, name, color=colour, **CENTRED)


def _angle(axes: Axes, corner: complex, start: complex, angle: float, radius: float, name: str) -> None:
    """An arc about a corner from a direction, rad, its name in the middle."""
    begin = np.degrees(np.angle(start))
    low, high = sorted((begin, begin + np.degrees(angle)))
    axes.add_patch(Arc((corner.real, corner.imag), 2 * radius, 2 * radius, theta1=low, theta2=high))
    place = corner + (radius + 0.006) * start / abs(start) * np.exp(0.5j * angle)
    axes.text(place.real, place.imag, name, **CENTRED)


def _arm(
    axes: Axes, of: complex, place: complex, direction: complex, colour: str, name: str, aside: complex = 0j
) -> None:
    """The perpendicular from a point on the line of a force through a place, its name aside."""
    unit = direction / abs(direction)
    foot = place + ((of - place) * unit.conjugate()).real * unit
    _line(axes, place, foot, colour, line=style.BROKEN)
    _line(axes, of, foot, colour, line=(0, (1, 1)))
    middle = 0.5 * (of + foot) + aside
    axes.text(middle.real, middle.imag, name, color=colour, **CENTRED)


def _wheels(axes: Axes, view: tuple[float, float, float, float]) -> tuple[complex, complex]:
    """Wheels 1 and 2, carrier 3, imbalance and its epicycloid 4 within left, right, bottom, top, mm.

    Returns:
        Places of the axis of wheel 1 and of the imbalance, m.
    """
    centre, mass = (complex(place) for place in np.array([E.D, E.place]) * TURN)
    axes.plot(*exact(M, np.linspace(0.0, 2.0 * np.pi / M.b, POINTS)).epicycloid, color=GREY, linewidth=1.0)
    for middle, radius, colour in ((0j, M.R0, GREY), (centre, M.r, BLUE)):
        circle = Circle((middle.real, middle.imag), radius, fill=False, color=colour, linewidth=1.6)
        axes.add_patch(circle)
    _line(axes, 0j, centre, BLACK)
    _line(axes, centre, mass, BLUE)
    for name, place, beyond, colour in (
        ("$O$", 0j, -0.005 - 0.005j, BLACK),
        ("$O_1$", centre, -0.008 + 0.003j, BLACK),
        ("$S$", mass, 0.003 - 0.007j, VERMILION),
    ):
        axes.plot(place.real, place.imag, "o", color=colour, markersize=5, zorder=4)
        axes.text((place + beyond).real, (place + beyond).imag, name, color=colour, **CENTRED)
    axes.set_aspect("equal")
    axes.set_xlim(1e-3 * view[0], 1e-3 * view[1])
    axes.set_ylim(1e-3 * view[2], 1e-3 * view[3])
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda x, _: f"{1e3 * x:.0f}")
    dress(axes, "$Y$ [mm]")
    axes.set_xlabel("$X$ [mm]")
    return centre, mass


def epicycloid() -> tuple[Figure, Columns]:
    """The figure of the paper, to scale: wheels 1 and 2, carrier 3, epicycloid 4, distance and angles.

    Returns:
        The figure, and columns of shape (721,) over a turn of the carrier: alpha (rad), X and Y (m).
    """
    figure = sheet(5.6, 6.0)
    axes = figure.subplots()
    centre, mass = _wheels(axes, (-105, 105, -105, 105))
    _line(axes, 0j, mass, BLACK, "$ρ$", style.BROKEN)
    _angle(axes, centre, -centre, SHOWN, 0.010, "$α$")
    _angle(axes, 0j, 1 + 0j, M.b * SHOWN, 0.022, "$bα$")
    for name, place in (
        ("1", centre + 0.015j),
        ("2", -0.037 - 0.037j),
        ("3", 0.4 * centre + 0.006j),
        ("4", -0.09 + 0.045j),
    ):
        axes.text(place.real, place.imag, name, **CENTRED)
    style.caption(
        figure, f"Wheel 1 rolls around the held wheel 2 (exact), drawn at {AT}. {style.wheels(M, W)}"
    )
    alpha = np.linspace(0.0, 2.0 * np.pi / M.b, POINTS)
    x, y = exact(M, alpha).epicycloid
    return figure, {"alpha [rad]": alpha, "X [m]": x, "Y [m]": y}


def forces() -> tuple[Figure, Columns]:
    """Angles and speeds of (6) to (8) and (13), forces and arms of (3) to (5) and (11) to (14), to scale.

    Returns:
        The figure, and columns of one row: each force (N), speed (m/s), angle (rad) and arm (m), both forms.
    """
    figure, page = sheet(9.4, 5.0), printed(M, SHOWN, W)
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    centre, mass = _wheels(left, VIEW)
    _wheels(right, VIEW)
    spoke, velocity = complex(E.spoke * TURN), complex(E.velocity * TURN)
    outward, scale = spoke / M.arm, SPEED / E.V
    _line(left, 0j, mass, BLACK, "$ρ$", style.BROKEN)
    _arrow(left, mass, scale * 1j * W * spoke, BLUE, "$V_1$")
    _arrow(left, mass, scale * 1j * M.b * W * mass, GREEN, "$V_2$")
    _arrow(left, mass, scale * velocity, VERMILION, "$V$")
    _line(left, mass, mass + 0.03 * outward, GREY, line=style.BROKEN)
    _line(left, mass, mass + 0.03 * mass / abs(mass), GREY, line=style.BROKEN)
    for corner, start, angle, radius, name in (
        (centre, -centre, SHOWN, 0.008, "$α$"),
        (0j, 1 + 0j, M.b * SHOWN, 0.022, "$bα$"),
        (mass, spoke, float(E.beta1), 0.022, "$β_1$"),
        (mass, velocity, float(E.delta), 0.03, "$δ$"),
    ):
        _angle(left, corner, start, angle, radius, name)
    speeds = f"$V_1, V_2, V$ = {M.arm * W:.2f}, {E.rho * M.b * W:.2f}, {E.V:.2f} m/s"
    left.set_title(f"angles and speeds: {speeds}", loc="left", fontsize=9)
    wrong, scale = outward * np.exp(1j * (page.beta1 - page.delta)), FORCE / E.F1
    _arm(right, 0j, mass, outward, GREEN, "$n_1 = k_2$", 0.015 + 0.006j)
    _arm(right, centre, mass, mass, PURPLE, "$n_2$", 0.008 - 0.009j)
    _arm(right, centre, mass, wrong, GREY, "$k_1$", -0.006 - 0.002j)
    _arm(right, 0j, mass, wrong, GREY, "$k_2$", -0.005 + 0j)
    _arrow(right, mass, scale * (E.F1 + E.Fk) * outward, ORANGE, "$F_k$")
    _arrow(right, mass, scale * E.F1 * outward, GREEN, "$F_1$", below=True)
    _arrow(right, mass, scale * E.F2 * mass / E.rho, PURPLE, "$F_2$")
    _arrow(right, mass, scale * page.Fk * wrong, GREY, "$F_k$", style.BROKEN)
    sizes = f"$F_1, F_2, F_k$ = {E.F1:.0f}, {E.F2:.0f}, {E.Fk:.0f} N (printed {page.Fk:.0f} N)"
    right.set_title(f"forces and arms: {sizes}", loc="left", fontsize=9)
    arms = f"its arms as printed k1 = {1e3 * page.k1:.1f} and k2 = {1e3 * page.k2:.1f} mm"
    told = f"exact (Fk lies behind F1, on one line: k1 = 0), grey Fk as printed, {arms}"
    style.caption(figure, f"At {AT}, {told}. {style.wheels(M, W)}")
    shown = (
        "F1 [N]",
        "F2 [N]",
        "Fk [N]",
        "V [m/s]",
        "beta1 [rad]",
        "delta [rad]",
        "n1 [m]",
        "n2 [m]",
        "k1 [m]",
        "k2 [m]",
    )
    columns = {}
    for heading in shown:
        for form, quantities in (("exact", E), ("as printed", page)):
            columns[f"{heading}, {form}"] = np.atleast_1d(getattr(quantities, heading.partition(" ")[0]))
    return figure, columns


def cycle() -> tuple[Figure, Columns]:
    """Moments M1, M and the power of the drive over a cycle at constant speed, and the free motion.

    Returns:
        The figure, and columns of shape (721,) over alpha (rad): moments (N m), power (W), and the speed
        of free motion over its lowest (none).
    """
    alpha = np.linspace(0.0, 2.0 * np.pi, POINTS)
    figure, columns = sheet(7.6, 6.6), {"alpha [rad]": alpha}
    style.caption(figure, f"A cycle of the epicycloid, exact and as printed. {style.wheels(M, W)}")
    panels = figure.subplots(2, 2, sharex=True).ravel()
    e = exact(M, alpha, W)
    # the page divides by the speed, which is 0 at both ends
    page = printed(M, np.clip(alpha, 1e-9, 2.0 * np.pi - 1e-9), W)
    power = [-forms.N1 - forms.N for forms in (e, page)]
    speed = exact(M, alpha).free_speed, page.J_limits[0] / page.J
    rows = (
        ("M1 [N·m]", "$M_1$ [N·m]", "moment of the inertia forces about $O_1$", e.M1, page.M1),
        ("M [N·m]", "$M$ [N·m]", "moment of the inertia forces about $O$", e.M, page.M),
        ("power of the drive [W]", "$-(N_1 + N)$ [W]", "power of the drive, zero on average", *power),
        ("free speed over lowest [1]", "$ω\\,/\\,ω_{\\mathrm{min}}$", "free mechanism, no drive", *speed),
    )
    for axes, (name, label, title, right, shown) in zip(panels, rows, strict=True):
        columns |= style.compare(axes, np.degrees(alpha), name, right, shown)
        dress(axes, label, title, zero=True)
    for axes in panels[2:]:
        axes.set_xlabel("angle α of wheel 1 on the carrier [°]")
        axes.set_xticks(range(0, 361, 90))
    panels[3].set_ylim(bottom=0.0)
    panels[0].legend(**style.SMALL, loc="upper right")
    return figure, columns


FIGURES: Drawings = {"lysenko_1": epicycloid, "lysenko_forces": forces, "lysenko_2": cycle}
