"""Lysenko's mechanism: the epicycloid, and moments, torque and power over a cycle, exact and printed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from ...papers.lysenko import exact, motion
from ...papers.lysenko.as_printed import Printed
from ...papers.lysenko.mechanism import EXAMPLE, EXAMPLE_SPEED
from .style import BLACK, BLUE, GREEN, GREY, ORANGE, VERMILION, dress, sheet

Array = NDArray[np.float64]
Columns = dict[str, Array]

POINTS = 721
# where the mechanism is drawn, rad
SHOWN = np.radians(130.0)


Point = tuple[float, float]


def _arrow(axes: Axes, start: complex, end: complex, colour: str, name: str, broken: bool = False) -> None:
    """An arrow between two points of the plane, its name beyond the tip."""
    style = {
        "arrowstyle": "-|>",
        "color": colour,
        "linewidth": 1.6,
        "linestyle": (0, (3, 2)) if broken else "-",
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 13,
    }
    axes.annotate("", (end.real, end.imag), (start.real, start.imag), arrowprops=style)
    beyond = end + (0.006 + 0.0011 * len(name.replace("$", ""))) * (end - start) / abs(end - start)
    axes.text(beyond.real, beyond.imag, name, color=colour, fontsize=11, ha="center", va="center")


def _forces(axes: Axes, centre: complex, mass: complex) -> None:
    """The inertia forces at the imbalance to one scale; the Coriolis force as printed in broken line."""
    b, omega = EXAMPLE.b, EXAMPLE_SPEED
    outward = (mass - centre) / EXAMPLE.arm
    first = exact.relative_force(EXAMPLE, omega)
    scale = 0.032 / first
    tip = mass + scale * first * outward
    _arrow(axes, mass, tip + scale * exact.coriolis_force(EXAMPLE, omega) * outward, ORANGE, "$F_k$")
    _arrow(axes, mass, tip, GREEN, "")
    side = mass + 0.5 * (tip - mass) - 0.006j * outward
    axes.text(side.real, side.imag, "$F_1$", color=GREEN, fontsize=11, ha="center", va="center")
    _arrow(axes, mass, mass + scale * EXAMPLE.m * (b * omega) ** 2 * mass, VERMILION, "$F_2$")
    page = Printed(EXAMPLE, SHOWN, omega)
    printed = page.Fk * outward * np.exp(1j * (page.beta1 - page.delta))
    _arrow(axes, mass, mass + scale * printed, GREY, "$F_k$ as printed", broken=True)


def _mechanism(axes: Axes) -> None:
    """The wheels, the carrier and the forces at one angle."""
    b, D = EXAMPLE.b, EXAMPLE.centre_distance
    centre = D * complex(np.cos(b * SHOWN), np.sin(b * SHOWN))
    x, y = exact.epicycloid(EXAMPLE, SHOWN)
    mass = complex(float(x), float(y))
    axes.add_patch(Circle((0.0, 0.0), EXAMPLE.R0, fill=False, color=GREY, linewidth=1.8))
    axes.add_patch(Circle((centre.real, centre.imag), EXAMPLE.r, fill=False, color=BLUE, linewidth=1.6))
    axes.plot((0.0, centre.real), (0.0, centre.imag), color=BLACK, linewidth=2.0)
    axes.plot((0.0, mass.real), (0.0, mass.imag), color=BLACK, linewidth=1.0, linestyle=(0, (4, 3)))
    axes.plot((centre.real, mass.real), (centre.imag, mass.imag), color=BLUE, linewidth=1.4)
    axes.plot((0.0, centre.real), (0.0, centre.imag), "o", color=BLACK, markersize=5)
    _forces(axes, centre, mass)
    axes.plot(mass.real, mass.imag, "o", color=VERMILION, markersize=9, zorder=4)
    labels: tuple[tuple[str, Point], ...] = (
        ("$O$", (-0.005, -0.005)),
        ("$O_1$", (centre.real - 0.006, centre.imag + 0.003)),
        ("$m$", (mass.real + 0.0035, mass.imag + 0.0105)),
        ("1", (centre.real + 0.002, centre.imag + EXAMPLE.r - 0.005)),
        ("2", (-0.62 * EXAMPLE.R0, -0.62 * EXAMPLE.R0)),
        ("3", (0.45 * centre.real - 0.004, 0.45 * centre.imag + 0.004)),
        ("4", (-0.092, 0.045)),
        ("$ρ$", (0.55 * mass.real + 0.002, 0.55 * mass.imag - 0.005)),
        ("$l$", (0.5 * (centre + mass).real, 0.5 * (centre + mass).imag + 0.0045)),
    )
    for name, place in labels:
        axes.text(*place, name, fontsize=11, ha="center", va="center")


def epicycloid() -> tuple[Figure, Columns]:
    """The figure of the paper: wheels 1 and 2, carrier 3, epicycloid 4 and the inertia forces, to scale.

    Returns:
        The figure, and columns of shape (721,) over a turn of the carrier: alpha (rad), X and Y (m).
    """
    alpha = np.linspace(0.0, 2.0 * np.pi / EXAMPLE.b, POINTS)
    x, y = exact.epicycloid(EXAMPLE, alpha)
    figure = sheet(6.8, 5.6)
    axes = figure.subplots()
    axes.plot(x, y, color=VERMILION, linewidth=1.6)
    _mechanism(axes)
    axes.set_aspect("equal")
    axes.set_xlim(-0.105, 0.152)
    axes.set_ylim(-0.1, 0.105)
    axes.axis("off")
    axes.set_title("Wheel 1 rolls around the held wheel 2: $b = r/R_0 = 1/3$, $l = r$, α = 130°", fontsize=11)
    return figure, {"alpha": alpha, "X": x, "Y": y}


def _compare(axes: Axes, alpha: Array, name: str, right: Array, printed: Array) -> Columns:
    """Exact in full, printed in broken line."""
    degrees = np.degrees(alpha)
    axes.plot(degrees, right, color=BLUE, linewidth=1.8, label="exact")
    axes.plot(degrees, printed, color=VERMILION, linewidth=1.4, linestyle=(0, (4, 2)), label="as printed")
    axes.fill_between(degrees, right, printed, color=VERMILION, alpha=0.10, linewidth=0)
    axes.axhline(0.0, color=BLACK, linewidth=0.6)
    return {f"{name}, exact": right, f"{name}, as printed": printed}


def cycle() -> tuple[Figure, Columns]:
    """Moments M1, M and the power of the drive over a cycle at constant speed, and the free motion.

    Returns:
        The figure, and columns of shape (721,) over alpha (rad): moments (N m), power (W), and the speed
        of free motion over its lowest (none).
    """
    alpha = np.linspace(0.0, 2.0 * np.pi, POINTS)
    columns: Columns = {"alpha": alpha}
    figure = sheet(7.6, 6.6)
    figure.suptitle("A cycle of the epicycloid: $b = 1/3$, $l = r$, ω = 100 rad/s", fontsize=11)
    panels = figure.subplots(2, 2, sharex=True).ravel()
    # the page divides by the speed, which is 0 at both ends
    page = Printed(EXAMPLE, np.clip(alpha, 1e-9, 2.0 * np.pi - 1e-9), EXAMPLE_SPEED)
    first = [exact.wheel_moment(EXAMPLE, alpha, EXAMPLE_SPEED), page.M1]
    second = [exact.carrier_moment(EXAMPLE, alpha, EXAMPLE_SPEED), page.M]
    columns |= _compare(panels[0], alpha, "M1", *first)
    columns |= _compare(panels[1], alpha, "M", *second)
    drive = [-EXAMPLE_SPEED * (m1 + EXAMPLE.b * m) for m1, m in zip(first, second, strict=True)]
    columns |= _compare(panels[2], alpha, "power of the drive", *drive)
    ratio = motion.free_omega(EXAMPLE, alpha, 1.0)
    printed = page.J_limits[0] / page.J
    columns |= _compare(panels[3], alpha, "free speed over lowest", ratio, printed)
    dress(panels[0], "$M_1$ [N·m]", "moment of the inertia forces about $O_1$")
    dress(panels[1], "$M$ [N·m]", "moment of the inertia forces about $O$")
    dress(panels[2], "$-(N_1 + N)$ [W]", "power of the drive, zero on average")
    dress(panels[3], "$ω\\,/\\,ω_{\\mathrm{min}}$", "free mechanism, no drive")
    for axes in panels[2:]:
        axes.set_xlabel("angle α of wheel 1 on the carrier [°]")
        axes.set_xticks(range(0, 361, 90))
    panels[3].set_ylim(bottom=0.0)
    panels[0].legend(loc="upper right", fontsize=9, frameon=False)
    return figure, columns


FIGURES: dict[str, Callable[[], tuple[Figure, Columns]]] = {"lysenko_1": epicycloid, "lysenko_2": cycle}
