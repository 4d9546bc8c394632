"""Lysenko's mechanism: the epicycloid, and moments, torque and power over a cycle, exact and printed."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ...common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, VERMILION
from ...papers.lysenko.as_printed import printed
from ...papers.lysenko.exact import exact
from ...papers.lysenko.mechanism import EXAMPLE as M
from ...papers.lysenko.mechanism import EXAMPLE_SPEED as W
from . import style
from .style import CENTRED, Columns, Drawings, dress, sheet

POINTS = 721
# where the mechanism is drawn, rad
SHOWN = np.radians(130.0)


def _arrow(axes: Axes, start: complex, end: complex, colour: str, name: str, broken: bool = False) -> None:
    """An arrow between two points of the plane, its name beyond the tip."""
    look = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.6, "mutation_scale": 13}
    look |= {"linestyle": (0, (3, 2)) if broken else "-", "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (end.real, end.imag), (start.real, start.imag), arrowprops=look)
    beyond = end + (0.006 + 0.0011 * len(name.replace("$", ""))) * (end - start) / abs(end - start)
    axes.text(beyond.real, beyond.imag, name, color=colour, **CENTRED)


def _mechanism(axes: Axes) -> None:
    """The wheels, the carrier and, to one scale, the inertia forces at one angle."""
    e, page = exact(M, SHOWN, W), printed(M, SHOWN, W)
    turn = np.exp(1j * M.b * SHOWN)
    centre, mass, outward = (complex(v * turn) for v in (M.centre_distance, e.place, e.spoke / M.arm))
    for middle, radius, colour, width in ((0j, M.R0, GREY, 1.8), (centre, M.r, BLUE, 1.6)):
        axes.add_patch(Circle((middle.real, middle.imag), radius, fill=False, color=colour, linewidth=width))
    for start, end, colour, width, line in (
        (0j, centre, BLACK, 2.0, "-"),
        (0j, mass, BLACK, 1.0, (0, (4, 3))),
        (centre, mass, BLUE, 1.4, "-"),
    ):
        axes.plot(
            (start.real, end.real), (start.imag, end.imag), color=colour, linewidth=width, linestyle=line
        )
    axes.plot((0.0, centre.real), (0.0, centre.imag), "o", color=BLACK, markersize=5)
    axes.plot(mass.real, mass.imag, "o", color=VERMILION, markersize=9, zorder=4)
    scale = 0.032 / e.F1
    tip = mass + scale * e.F1 * outward
    _arrow(axes, mass, tip + scale * e.Fk * outward, ORANGE, "$F_k$")
    _arrow(axes, mass, tip, GREEN, "")
    _arrow(axes, mass, mass + scale * e.F2 * mass / e.rho, VERMILION, "$F_2$")
    wrong = page.Fk * outward * np.exp(1j * (page.beta1 - page.delta))
    _arrow(axes, mass, mass + scale * wrong, GREY, "$F_k$ as printed", broken=True)
    side = mass + 0.5 * (tip - mass) - 0.006j * outward
    axes.text(side.real, side.imag, "$F_1$", color=GREEN, **CENTRED)
    for name, place in (
        ("$O$", -0.005 - 0.005j),
        ("$O_1$", centre - 0.006 + 0.003j),
        ("$m$", mass + 0.0035 + 0.0105j),
        ("1", centre + 0.002 + 1j * (M.r - 0.005)),
        ("2", -0.62 * M.R0 * (1 + 1j)),
        ("3", 0.45 * centre - 0.004 + 0.004j),
        ("4", -0.092 + 0.045j),
        ("$ρ$", 0.55 * mass + 0.002 - 0.005j),
        ("$l$", 0.5 * (centre + mass) + 0.0045j),
    ):
        axes.text(place.real, place.imag, name, **CENTRED)


def epicycloid() -> tuple[Figure, Columns]:
    """The figure of the paper: wheels 1 and 2, carrier 3, epicycloid 4 and the inertia forces, to scale.

    Returns:
        The figure, and columns of shape (721,) over a turn of the carrier: alpha (rad), X and Y (m).
    """
    alpha = np.linspace(0.0, 2.0 * np.pi / M.b, POINTS)
    x, y = exact(M, alpha).epicycloid
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


def cycle() -> tuple[Figure, Columns]:
    """Moments M1, M and the power of the drive over a cycle at constant speed, and the free motion.

    Returns:
        The figure, and columns of shape (721,) over alpha (rad): moments (N m), power (W), and the speed
        of free motion over its lowest (none).
    """
    alpha = np.linspace(0.0, 2.0 * np.pi, POINTS)
    figure, columns = sheet(7.6, 6.6), {"alpha": alpha}
    figure.suptitle("A cycle of the epicycloid: $b = 1/3$, $l = r$, ω = 100 rad/s", fontsize=11)
    panels = figure.subplots(2, 2, sharex=True).ravel()
    e = exact(M, alpha, W)
    # the page divides by the speed, which is 0 at both ends
    page = printed(M, np.clip(alpha, 1e-9, 2.0 * np.pi - 1e-9), W)
    power = [-forms.N1 - forms.N for forms in (e, page)]
    speed = exact(M, alpha).free_speed, page.J_limits[0] / page.J
    rows = (
        ("M1", "$M_1$ [N·m]", "moment of the inertia forces about $O_1$", e.M1, page.M1),
        ("M", "$M$ [N·m]", "moment of the inertia forces about $O$", e.M, page.M),
        ("power of the drive", "$-(N_1 + N)$ [W]", "power of the drive, zero on average", *power),
        ("free speed over lowest", "$ω\\,/\\,ω_{\\mathrm{min}}$", "free mechanism, no drive", *speed),
    )
    for axes, (name, label, title, right, shown) in zip(panels, rows, strict=True):
        columns |= style.compare(axes, np.degrees(alpha), name, right, shown)
        axes.fill_between(np.degrees(alpha), right, shown, color=VERMILION, alpha=0.10, linewidth=0)
        dress(axes, label, title, zero=True)
    for axes in panels[2:]:
        axes.set_xlabel("angle α of wheel 1 on the carrier [°]")
        axes.set_xticks(range(0, 361, 90))
    panels[3].set_ylim(bottom=0.0)
    panels[0].legend(**style.SMALL, loc="upper right")
    return figure, columns


FIGURES: Drawings = {"lysenko_1": epicycloid, "lysenko_2": cycle}
