"""Karetin's figures 2 and 3, what offsets do (conclusion 2), the swing (conclusion 3), and the printed form.

Drawn for the scene R1 with 40 teeth on wheel 17: then s = 2 is whole and one turn of the drive is one
period of the motion in link 1, as the paper has it. Each function returns the figure and its columns.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from ...papers.karetin import Kinematics, Motion, conclusions
from ...papers.karetin.as_printed import printed
from ...papers.karetin.cases import DYNAMIC, PAPER, STOP, period
from ...papers.karetin.projections import continuous
from .karetin_cones import layout
from .style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION, dress, sheet

Array = NDArray[np.float64]
Columns = dict[str, Array]

POINTS = 1441
OFFSET = 0.5
MODES = (("stop", STOP, "stop mode"), ("dynamic", DYNAMIC, "dynamic mode, $i = 2$"))
AXES = tuple(zip("xyz", (BLUE, GREEN, ORANGE), strict=True))
TURNS = np.linspace(0.0, 1.0, POINTS)
# label, epsilon, gamma and colour
OFFSETS = (
    ("$ε = γ = 0$", 0.0, 0.0, GREY),
    (f"$ε = {OFFSET}$", OFFSET, 0.0, BLUE),
    (f"$γ = {OFFSET}$", 0.0, OFFSET, VERMILION),
    (f"$ε = {OFFSET}$, $γ = ε/s$", OFFSET, OFFSET / PAPER.s, GREEN),
)
# index of the angle, axis, column and colour
SWINGS = (("P", "x", 1, BLUE), ("F", "y", 2, ORANGE), ("H", "z", 0, PURPLE))
_SMALL: dict[str, Any] = {"fontsize": 9, "frameon": False}


def _between(count: int) -> Array:
    """Turns of the drive between the instants at which D is on an axis or the page divides by zero."""
    return (np.arange(count) + 0.5) / count


def _kinematics(motion: Motion, turns: Array = TURNS) -> Kinematics:
    return Kinematics(PAPER, motion, turns * period(PAPER, motion))


def _abscissa(panel: Axes, label: str = "turns of the drive, $ω_{16}t\\,/\\,2π$") -> None:
    panel.set_xlabel(label)
    panel.set_xticks((0.0, 0.25, 0.5, 0.75, 1.0), ("0", "¼", "½", "¾", "1"))


def trajectories() -> tuple[Figure, Columns]:
    """Figure 2: trajectory of D in the stop and in the dynamic mode, m, with the pitch cones."""
    figure, columns = sheet(10.4, 5.2), {"turns of the drive": TURNS}
    for n, (name, motion, title) in enumerate(MODES):
        path = _kinematics(motion).position
        panel = figure.add_subplot(1, 2, n + 1, projection="3d", computed_zorder=False)
        layout(panel, PAPER, path, f"{'ab'[n]}) {title}")
        columns |= {f"{axis} [m], {name}": path[:, m] for m, (axis, _) in enumerate(AXES)}
    return figure, columns


def velocity_and_acceleration() -> tuple[Figure, Columns]:
    """Figure 3: |V|, m/s, |a|, km/s^2, and their components over one period, in both modes."""
    figure, columns = sheet(9.6, 6.6), {"turns of the drive": TURNS}
    panels = figure.subplots(2, 2, sharex=True, sharey="row")
    for n, (name, motion, title) in enumerate(MODES):
        k = _kinematics(motion)
        for m, (symbol, unit, what, modulus, vector) in enumerate(
            (
                ("V", "m/s", "velocity", k.speed, k.velocity),
                ("a", "km/s²", "acceleration", 1e-3 * k.acceleration_modulus, 1e-3 * k.acceleration),
            )
        ):
            panel, ending = panels[m, n], f"[{unit.replace('²', '2')}], {name}"
            columns[f"|{symbol}| {ending}"] = modulus
            for index, (axis, colour) in enumerate(AXES):
                columns[f"{symbol}{axis} {ending}"] = vector[:, index]
                panel.plot(TURNS, vector[:, index], color=colour, linewidth=1.2, label=f"${symbol}_{axis}$")
            panel.plot(TURNS, modulus, color=VERMILION, linewidth=2.2, label=f"$|{symbol}|$")
            panel.axhline(0.0, color=BLACK, linewidth=0.6)
            dress(panel, f"{what} [{unit}]" if n == 0 else "", f"{'ab'[m]}) {what}, {title}")
        _abscissa(panels[1, n])
    for row in panels:
        row[1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=10, frameon=False)
    return figure, columns


def offsets() -> tuple[Figure, Columns]:
    """Conclusion 2: |V|, m/s, with the offsets epsilon and gamma, each beside its mirror image."""
    figure, columns = sheet(9.6, 6.6), {"turns of the drive": TURNS}
    panels = figure.subplots(2, 4, sharex=True, sharey="row")
    for m, (label, epsilon, gamma, colour) in enumerate(OFFSETS):
        geometry = replace(PAPER, epsilon=epsilon, gamma=gamma)
        for n, (name, motion, title) in enumerate(MODES):
            panel, span = panels[n, m], period(geometry, motion)
            speed = conclusions.quantity("speed", geometry, motion)
            found = conclusions.best_mirror(speed, span)
            values, mirrored = speed(TURNS * span), speed(2.0 * found.instant - TURNS * span)
            panel.plot(TURNS, values, color=colour, linewidth=2.0)
            panel.plot(TURNS, mirrored, color=BLACK, linewidth=1.0, linestyle=(0, (3, 2)))
            dress(panel, f"$|V|$ [m/s], {title}" if m == 0 else "", label if n == 0 else "")
            text = f"asymmetry {100.0 * found.asymmetry:.1f} %"
            panel.text(0.5, 0.93, text, transform=panel.transAxes, ha="center", fontsize=9)
            panel.set_ylim(0.0, 18.9)
            columns[f"|V| [m/s], {name}, eps={epsilon:g} gam={gamma:g}"] = values
        _abscissa(panels[1, m], "turns of the drive")
    figure.suptitle("Speed of $D$ (colour) and its mirror image about the instant that suits best (broken)")
    return figure, columns


def effective_offset() -> tuple[Figure, Columns]:
    """Conclusion 2: asymmetry of |V| and |a| over gamma - epsilon/s, rad, all that counts of the offsets."""
    figure = sheet(6.6, 4.2)
    panel = figure.subplots()
    half = [replace(PAPER, gamma=float(gamma)) for gamma in np.linspace(0.0, 0.25 * np.pi, 13)]
    gamma = np.linspace(0.0, 0.5 * np.pi, 25)
    columns: Columns = {"gamma - epsilon/s [rad]": gamma}
    quantities = (("|V|", "speed", "o", 1.5), ("|a|", "acceleration_modulus", "s", 0.9))
    for (name, motion, title), colour in zip(MODES, (BLUE, VERMILION), strict=True):
        for symbol, modulus, marker, width in quantities:
            functions = (conclusions.quantity(modulus, g, motion) for g in half)
            mirrors = (conclusions.best_mirror(f, period(PAPER, motion), samples=400) for f in functions)
            values = [mirror.asymmetry for mirror in mirrors]
            # even, and repeated every pi/s: the drive has turned on by that when B has by pi
            columns[f"asymmetry of {symbol}, {name}"] = both = np.array([*values, *values[-2::-1]])
            style: dict[str, Any] = {"marker": marker, "markersize": 4, "color": colour, "linewidth": width}
            panel.plot(np.degrees(gamma), 100.0 * both, **style, label=f"${symbol}$, {title}")
    dress(panel, "asymmetry [% of the range]", "")
    panel.set_xlabel("effective offset $γ - ε/s$ [°]")
    panel.set_xticks(range(0, 91, 15))
    panel.legend(**_SMALL, loc="lower center", bbox_to_anchor=(0.5, 0.1), ncols=2)
    return figure, columns


def swing() -> tuple[Figure, Columns]:
    """Conclusion 3: angles of D about Ox, Oy, Oz, rad, and their rates, rad/s, over one period."""
    turns = _between(4 * POINTS - 4)
    figure, columns = sheet(9.6, 6.6), {"turns of the drive": turns}
    panels = figure.subplots(2, 2, sharex=True)
    for n, (name, motion, title) in enumerate(MODES):
        k, (upper, lower) = _kinematics(motion, turns), panels[:, n]
        beta = continuous(k.angles)
        for index, axis, column, colour in (
            ("P", "x", 1, BLUE),
            ("F", "y", 2, ORANGE),
            ("H", "z", 0, PURPLE),
        ):
            angle, rate = beta[:, column], k.angular_velocities[:, column]
            label = f"$β_{index}$, about $O{axis}$"
            upper.plot(turns, np.degrees(angle), color=colour, linewidth=1.8, label=label)
            lower.plot(turns, rate, color=colour, linewidth=1.5, label=f"$ω_{index}$")
            columns |= {f"beta_{index} [rad], {name}": angle, f"omega_{index} [rad/s], {name}": rate}
        if motion.carrier != 0.0:
            turned = -np.degrees(motion.carrier * k.t)
            upper.plot(turns, turned, color=GREY, linewidth=1.0, linestyle=(0, (4, 3)), label="$-ω_1t$")
        dress(upper, "angle of $D$ [°]" if n == 0 else "", f"{'ab'[n]}) {title}")
        dress(lower, "angular velocity [rad/s]" if n == 0 else "", "")
        upper.yaxis.set_major_locator(MultipleLocator((90.0, 180.0)[n]))
        upper.legend(**_SMALL)
        lower.set_ylim(-350.0, 300.0)
        lower.axhline(0.0, color=BLACK, linewidth=0.6)
        lower.legend(**_SMALL, ncols=3, loc="lower right")
        _abscissa(lower)
    return figure, columns


def as_printed() -> tuple[Figure, Columns]:
    """What the page computes beside the exact: |V|, m/s, and |a|, km/s^2, of both modes."""
    turns = _between(POINTS - 1)
    figure, columns = sheet(9.6, 6.6), {"turns of the drive": turns}
    panels = figure.subplots(2, 2, sharex=True)
    for n, (name, motion, title) in enumerate(MODES):
        k = _kinematics(motion, turns)
        page = printed(PAPER, motion, k.t)
        stop = (page.stop_velocity, page.stop_acceleration)
        velocity, acceleration = stop if n == 0 else (page.velocity, page.acceleration)
        for panel, symbol, unit, scale, exact, wrong, top in (
            (panels[0, n], "|V|", "m/s", 1.0, k.speed, velocity, 1.25),
            (panels[1, n], "|a|", "km/s²", 1e-3, k.acceleration_modulus, acceleration, 2.0),
        ):
            right, shown = scale * exact, scale * np.sqrt((wrong**2).sum(axis=1))
            panel.plot(turns, right, color=BLUE, linewidth=2.0, label="exact")
            broken: dict[str, Any] = {"color": VERMILION, "linewidth": 1.3, "linestyle": (0, (4, 2))}
            panel.plot(turns, shown, **broken, label="as printed")
            panel.set_ylim(0.0, top * float(right.max()))
            above = f"{'ab'[n]}) {title}" if symbol == "|V|" else ""
            dress(panel, f"${symbol}$ [{unit}]" if n == 0 else "", above)
            head = f"{symbol} [{unit.replace('²', '2')}], {name}"
            columns |= {f"{head}, exact": right, f"{head}, as printed": shown}
        _abscissa(panels[1, n])
    panels[0, 0].legend(**_SMALL, loc="upper right", bbox_to_anchor=(1.0, 1.12), ncols=2)
    return figure, columns


FIGURES: dict[str, Callable[[], tuple[Figure, Columns]]] = {
    "karetin_2": trajectories,
    "karetin_3": velocity_and_acceleration,
    "karetin_offsets": offsets,
    "karetin_effective_offset": effective_offset,
    "karetin_swing": swing,
    "karetin_printed": as_printed,
}
