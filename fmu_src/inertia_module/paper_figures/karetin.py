"""Karetin's figures 2 and 3, what offsets do (conclusion 2), the swing (conclusion 3), and the printed form.

Drawn for the scene R1 with 40 teeth on wheel 17: then s = 2 is whole and one turn of the drive is one
period of the motion in link 1, as the paper has it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from ..papers.karetin import Kinematics, Motion, conclusions
from ..papers.karetin.as_printed import printed
from ..papers.karetin.cases import DYNAMIC, PAPER, STOP, period
from ..papers.karetin.projections import continuous
from .karetin_cones import layout
from .style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION, dress, sheet

Array = NDArray[np.float64]
Columns = dict[str, Array]

POINTS = 1441
OFFSET = 0.5
MODES = (("stop", STOP, "stop mode"), ("dynamic", DYNAMIC, "dynamic mode, $i = 2$"))
AXES = tuple(zip("xyz", (BLUE, GREEN, ORANGE), strict=True))
_QUARTERS, _QUARTER_NAMES = (0.0, 0.25, 0.5, 0.75, 1.0), ("0", "¼", "½", "¾", "1")
_TURNS = "turns of the drive, $ω_{16}t\\,/\\,2π$"


def _over_a_period(motion: Motion, points: int = POINTS) -> tuple[Array, Kinematics]:
    """Turns of the drive from 0 to 1 and the exact set there."""
    turns = np.linspace(0.0, 1.0, points)
    return turns, Kinematics(PAPER, motion, turns * period(PAPER, motion))


def trajectories() -> tuple[Figure, Columns]:
    """Figure 2: trajectory of D in the stop and in the dynamic mode, with the pitch cones.

    Returns:
        The figure, and columns of shape (1441,): turns of the drive, x, y, z of both modes (m).
    """
    figure = sheet(10.4, 5.2)
    columns: Columns = {}
    for n, (name, motion, title) in enumerate(MODES):
        turns, k = _over_a_period(motion)
        panel = figure.add_subplot(1, 2, n + 1, projection="3d", computed_zorder=False)
        layout(panel, PAPER, k.position, f"{'ab'[n]}) {title}")
        columns |= {"turns of the drive": turns}
        columns |= {f"{axis} [m], {name}": k.position[:, m] for m, (axis, _) in enumerate(AXES)}
    return figure, columns


def _curves(panel: Axes, turns: Array, symbol: str, modulus: Array, vector: Array) -> None:
    for n, (axis, colour) in enumerate(AXES):
        panel.plot(turns, vector[:, n], color=colour, linewidth=1.2, label=f"${symbol}_{axis}$")
    panel.plot(turns, modulus, color=VERMILION, linewidth=2.2, label=f"$|{symbol}|$")
    panel.axhline(0.0, color=BLACK, linewidth=0.6)


def velocity_and_acceleration() -> tuple[Figure, Columns]:
    """Figure 3: |V|, |a| and their components over one period, in both modes.

    Returns:
        The figure, and columns of shape (1441,): turns of the drive, V (m/s) and a (km/s^2) of both modes.
    """
    figure = sheet(9.6, 6.6)
    panels = figure.subplots(2, 2, sharex=True, sharey="row")
    columns: Columns = {}
    for n, (name, motion, title) in enumerate(MODES):
        turns, k = _over_a_period(motion)
        acceleration = 1e-3 * k.acceleration
        _curves(panels[0, n], turns, "V", k.speed, k.velocity)
        _curves(panels[1, n], turns, "a", 1e-3 * k.acceleration_modulus, acceleration)
        dress(panels[0, n], "velocity [m/s]" if n == 0 else "", f"a) velocity, {title}")
        dress(panels[1, n], "acceleration [km/s²]" if n == 0 else "", f"b) acceleration, {title}")
        panels[1, n].set_xticks(_QUARTERS, _QUARTER_NAMES)
        panels[1, n].set_xlabel(_TURNS)
        columns |= {"turns of the drive": turns, f"|V| [m/s], {name}": k.speed}
        columns |= {f"V{axis} [m/s], {name}": k.velocity[:, m] for m, (axis, _) in enumerate(AXES)}
        columns |= {f"|a| [km/s2], {name}": 1e-3 * k.acceleration_modulus}
        columns |= {f"a{axis} [km/s2], {name}": acceleration[:, m] for m, (axis, _) in enumerate(AXES)}
    for row in panels:
        row[1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=10, frameon=False)
    return figure, columns


def _offset_cases() -> tuple[tuple[str, float, float, str], ...]:
    return (
        ("$ε = γ = 0$", 0.0, 0.0, GREY),
        (f"$ε = {OFFSET}$", OFFSET, 0.0, BLUE),
        (f"$γ = {OFFSET}$", 0.0, OFFSET, VERMILION),
        (f"$ε = {OFFSET}$, $γ = ε/s$", OFFSET, OFFSET / PAPER.s, GREEN),
    )


def offsets() -> tuple[Figure, Columns]:
    """Conclusion 2: |V| over a period with the offsets epsilon and gamma, each beside its mirror image.

    Returns:
        The figure, and columns of shape (1441,): turns of the drive, |V| (m/s) of every case.
    """
    figure = sheet(9.6, 6.6)
    panels = figure.subplots(2, 4, sharex=True, sharey="row")
    columns: Columns = {}
    for m, (label, epsilon, gamma, colour) in enumerate(_offset_cases()):
        geometry = replace(PAPER, epsilon=epsilon, gamma=gamma)
        for n, (name, motion, title) in enumerate(MODES):
            panel = panels[n, m]
            turns = np.linspace(0.0, 1.0, POINTS)
            span = period(geometry, motion)
            speed = conclusions.quantity("speed", geometry, motion)
            found = conclusions.best_mirror(speed, span)
            mirrored = speed(2.0 * found.instant - turns * span)
            panel.plot(turns, speed(turns * span), color=colour, linewidth=2.0)
            panel.plot(turns, mirrored, color=BLACK, linewidth=1.0, linestyle=(0, (3, 2)))
            dress(panel, f"$|V|$ [m/s], {title}" if m == 0 else "", label if n == 0 else "")
            panel.text(
                0.5,
                0.93,
                f"asymmetry {100.0 * found.asymmetry:.1f} %",
                transform=panel.transAxes,
                ha="center",
                fontsize=9,
            )
            panel.set_ylim(0.0, 18.9)
            panel.set_xticks(_QUARTERS, _QUARTER_NAMES)
            columns |= {"turns of the drive": turns}
            columns |= {f"|V| [m/s], {name}, eps={epsilon:g} gam={gamma:g}": speed(turns * span)}
        panels[1, m].set_xlabel("turns of the drive")
    figure.suptitle("Speed of $D$ (colour) and its mirror image about the instant that suits best (broken)")
    return figure, columns


def effective_offset() -> tuple[Figure, Columns]:
    """Conclusion 2: asymmetry of |V| and |a| over gamma - epsilon/s, all that counts of the offsets.

    Returns:
        The figure, and columns of shape (25,): gamma - epsilon/s (rad), asymmetries (none).
    """
    figure = sheet(6.6, 4.2)
    panel = figure.subplots()
    half = np.linspace(0.0, 0.25 * np.pi, 13)
    columns: Columns = {}
    quantities = (("|V|", "speed", "o"), ("|a|", "acceleration_modulus", "s"))
    for (name, motion, title), colour in zip(MODES, (BLUE, VERMILION), strict=True):
        span = period(PAPER, motion)
        for symbol, name_of, marker in quantities:
            values = [
                conclusions.best_mirror(
                    conclusions.quantity(name_of, replace(PAPER, gamma=float(gamma)), motion),
                    span,
                    samples=400,
                ).asymmetry
                for gamma in half
            ]
            # even, and repeated every pi/s: the drive has turned on by that when B has by pi
            both = np.array([*values, *values[-2::-1]])
            gamma = np.linspace(0.0, 0.5 * np.pi, len(both))
            columns |= {"gamma - epsilon/s [rad]": gamma, f"asymmetry of {symbol}, {name}": both}
            panel.plot(
                np.degrees(gamma),
                100.0 * both,
                marker=marker,
                markersize=4,
                color=colour,
                linewidth=1.5 if symbol == "|V|" else 0.9,
                label=f"${symbol}$, {title}",
            )
    dress(panel, "asymmetry [% of the range]", "")
    panel.set_xlabel("effective offset $γ - ε/s$ [°]")
    panel.set_xticks(range(0, 91, 15))
    panel.legend(fontsize=9, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 0.1), ncols=2)
    return figure, columns


def swing() -> tuple[Figure, Columns]:
    """Conclusion 3: angles of D about Ox, Oy, Oz and their rates over one period, in both modes.

    Returns:
        The figure, and columns of shape (5760,): turns of the drive, angles (rad) and rates (rad/s).
    """
    figure = sheet(9.6, 6.6)
    panels = figure.subplots(2, 2, sharex=True)
    columns: Columns = {}
    styles = (("P", "x", 1, BLUE), ("F", "y", 2, ORANGE), ("H", "z", 0, PURPLE))
    for n, (name, motion, title) in enumerate(MODES):
        # between the instants at which D is on an axis
        turns = (np.arange(4 * POINTS - 4) + 0.5) / (4 * POINTS - 4)
        k = Kinematics(PAPER, motion, turns * period(PAPER, motion))
        beta = continuous(k.angles)
        columns |= {"turns of the drive": turns}
        for index, axis, column, colour in styles:
            label = f"$β_{index}$, about $O{axis}$"
            panels[0, n].plot(turns, np.degrees(beta[:, column]), color=colour, linewidth=1.8, label=label)
            rate = k.angular_velocities[:, column]
            panels[1, n].plot(turns, rate, color=colour, linewidth=1.5, label=f"$ω_{index}$")
            columns |= {f"beta_{index} [rad], {name}": beta[:, column]}
            columns |= {f"omega_{index} [rad/s], {name}": rate}
        if motion.carrier != 0.0:
            turned = -np.degrees(motion.carrier * turns * period(PAPER, motion))
            panels[0, n].plot(
                turns, turned, color=GREY, linewidth=1.0, linestyle=(0, (4, 3)), label="$-ω_1t$"
            )
        dress(panels[0, n], "angle of $D$ [°]" if n == 0 else "", f"{'ab'[n]}) {title}")
        dress(panels[1, n], "angular velocity [rad/s]" if n == 0 else "", "")
        panels[0, n].yaxis.set_major_locator(MultipleLocator((90.0, 180.0)[n]))
        panels[0, n].legend(fontsize=9, frameon=False)
        panels[1, n].set_ylim(-350.0, 300.0)
        panels[1, n].axhline(0.0, color=BLACK, linewidth=0.6)
        panels[1, n].legend(fontsize=9, frameon=False, ncols=3, loc="lower right")
        panels[1, n].set_xticks(_QUARTERS, _QUARTER_NAMES)
        panels[1, n].set_xlabel(_TURNS)
    return figure, columns


def as_printed() -> tuple[Figure, Columns]:
    """What the page computes beside the exact: |V| and |a| of both modes, printed chain and exact.

    Returns:
        The figure, and columns of shape (1440,): turns of the drive, |V| (m/s), |a| (km/s^2).
    """
    figure = sheet(9.6, 6.6)
    panels = figure.subplots(2, 2, sharex=True)
    columns: Columns = {}
    for n, (name, motion, title) in enumerate(MODES):
        turns = (np.arange(POINTS - 1) + 0.5) / (POINTS - 1)
        t = turns * period(PAPER, motion)
        k, page = Kinematics(PAPER, motion, t), printed(PAPER, motion, t)
        velocity, acceleration = (
            (page.stop_velocity, page.stop_acceleration) if n == 0 else (page.velocity, page.acceleration)
        )
        columns |= {"turns of the drive": turns}
        for m, (symbol, unit, scale, right, wrong) in enumerate(
            (
                ("|V|", "m/s", 1.0, k.speed, velocity),
                ("|a|", "km/s²", 1e-3, k.acceleration_modulus, acceleration),
            )
        ):
            shown = scale * np.sqrt((wrong**2).sum(axis=1))
            panel = panels[m, n]
            panel.plot(turns, scale * right, color=BLUE, linewidth=2.0, label="exact")
            panel.plot(
                turns, shown, color=VERMILION, linewidth=1.3, linestyle=(0, (4, 2)), label="as printed"
            )
            panel.set_ylim(0.0, (1.25, 2.0)[m] * scale * float(right.max()))
            dress(panel, f"${symbol}$ [{unit}]" if n == 0 else "", f"{'ab'[n]}) {title}" if m == 0 else "")
            head = f"{symbol} [{unit.replace('²', '2')}], {name}"
            columns |= {f"{head}, exact": scale * right, f"{head}, as printed": shown}
        panels[1, n].set_xlabel(_TURNS)
        panels[1, n].set_xticks(_QUARTERS, _QUARTER_NAMES)
    panels[0, 0].legend(fontsize=9, frameon=False, loc="upper right", bbox_to_anchor=(1.0, 1.12), ncols=2)
    return figure, columns


FIGURES: dict[str, Callable[[], tuple[Figure, Columns]]] = {
    "karetin_2": trajectories,
    "karetin_3": velocity_and_acceleration,
    "karetin_offsets": offsets,
    "karetin_effective_offset": effective_offset,
    "karetin_swing": swing,
    "karetin_printed": as_printed,
}
