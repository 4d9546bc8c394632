"""Karetin's figures 2 and 3, what offsets do (conclusion 2), the swing (conclusion 3), and the printed form.

Drawn for the scene R1 with 40 teeth on wheel 17: then s = 2 is whole and one turn of the drive is one
period of the motion in link 1, as the paper has it. Each function returns the figure and its columns.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from inertia_module.common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION

from ..forms import Forms
from ..karetin import Motion, conclusions, exact
from ..karetin.as_printed import printed
from ..karetin.cases import DYNAMIC, PAPER, STOP, period
from ..karetin.exact import modulus
from . import style
from .karetin_cones import layout
from .style import SMALL, Columns, Drawings, dress, sheet

POINTS = 1441
OFFSET = 0.5
MODES = (("stop", STOP, "stop mode"), ("dynamic", DYNAMIC, "dynamic mode, $i = 2$"))
AXES = tuple(zip("xyz", (BLUE, GREEN, ORANGE), strict=True))
CASE = style.mechanism(PAPER)
TURNS = np.linspace(0.0, 1.0, POINTS)
# label, epsilon, gamma and colour
OFFSETS = (
    ("$ε = γ = 0$", 0.0, 0.0, GREY),
    (f"$ε = {OFFSET}$", OFFSET, 0.0, BLUE),
    (f"$γ = {OFFSET}$", 0.0, OFFSET, VERMILION),
    (f"$ε = {OFFSET}$, $γ = ε/s$", OFFSET, OFFSET / PAPER.s, GREEN),
)
# index of the angle, axis, place in beta and colour
SWINGS = (("P", "x", 1, BLUE), ("F", "y", 2, ORANGE), ("H", "z", 0, PURPLE))
# symbol, unit, the same in the name of a column, unit over the SI unit, quantity of the exact forms
VECTORS = (("V", "m/s", "m/s", 1.0, "velocity"), ("a", "km/s²", "km/s2", 1e-3, "acceleration"))


def _between(count: int) -> Any:
    """Turns of the drive between the instants at which D is on an axis or the page divides by zero."""
    return (np.arange(count) + 0.5) / count


def _exact(motion: Motion, turns: Any = TURNS) -> Forms:
    return exact(PAPER, motion, turns * period(PAPER, motion))


def _abscissa(panel: Axes, label: str = "turns of the drive, $ω_{16}t\\,/\\,2π$") -> None:
    panel.set_xlabel(label)
    panel.set_xticks((0.0, 0.25, 0.5, 0.75, 1.0), ("0", "¼", "½", "¾", "1"))


def trajectories() -> tuple[Figure, Columns]:
    """Figure 2: trajectory of D in the stop and in the dynamic mode, m, with the pitch cones."""
    figure, columns = sheet(10.4, 5.2), {"turns of the drive": TURNS}
    for n, (name, motion, title) in enumerate(MODES):
        path = _exact(motion).position
        panel = figure.add_subplot(1, 2, n + 1, projection="3d", computed_zorder=False)
        layout(panel, PAPER, path, f"{'ab'[n]}) {title}")
        columns |= {f"{axis} [m], {name}": path[m] for m, (axis, _) in enumerate(AXES)}
    style.caption(figure, f"Trajectory of D, exact; the frame Oxyz has ticks of 50 mm. {CASE}")
    return figure, columns


def velocity_and_acceleration() -> tuple[Figure, Columns]:
    """Figure 3: |V|, m/s, |a|, km/s^2, and their components over one period, in both modes."""
    figure, columns = sheet(9.6, 6.6), {"turns of the drive": TURNS}
    panels = figure.subplots(2, 2, sharex=True, sharey="row")
    for n, (name, motion, title) in enumerate(MODES):
        for m, (symbol, unit, plain, scale, what) in enumerate(VECTORS):
            panel, vector = panels[m, n], scale * getattr(_exact(motion), what)
            columns[f"|{symbol}| [{plain}], {name}"] = modulus(vector)
            for component, (axis, colour) in zip(vector, AXES, strict=True):
                columns[f"{symbol}{axis} [{plain}], {name}"] = component
                panel.plot(TURNS, component, color=colour, linewidth=1.2, label=f"${symbol}_{axis}$")
            panel.plot(TURNS, modulus(vector), color=VERMILION, linewidth=2.2, label=f"$|{symbol}|$")
            dress(panel, "" if n else f"{what} [{unit}]", f"{'ab'[m]}) {what}, {title}", zero=True)
        _abscissa(panels[1, n])
    style.caption(figure, f"Absolute velocity and acceleration of D and their components, exact. {CASE}")
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
            dress(panel, "" if m else f"$|V|$ [m/s], {title}", "" if n else label)
            text = f"asymmetry {100.0 * found.asymmetry:.1f} %"
            panel.text(0.5, 0.93, text, transform=panel.transAxes, ha="center", fontsize=9)
            panel.set_ylim(0.0, 18.9)
            columns[f"|V| [m/s], {name}, eps={epsilon:g} gam={gamma:g}"] = values
        _abscissa(panels[1, m], "turns of the drive")
    told = "Speed of D (colour) and its mirror image about the instant that suits best (broken), exact"
    style.caption(figure, f"{told}. {style.mechanism(PAPER, offsets=False)}")
    return figure, columns


def effective_offset() -> tuple[Figure, Columns]:
    """Conclusion 2: asymmetry of |V| and |a| over gamma - epsilon/s, rad, all that counts of the offsets."""
    figure, gamma = sheet(6.6, 4.2), np.linspace(0.0, 0.5 * np.pi, 25)
    panel, columns = figure.subplots(), {"gamma - epsilon/s [rad]": gamma}
    half = [replace(PAPER, gamma=float(value)) for value in gamma[:13]]
    quantities = (("|V|", "speed", "o", 1.5), ("|a|", "acceleration_modulus", "s", 0.9))
    for (name, motion, title), colour in zip(MODES, (BLUE, VERMILION), strict=True):
        for symbol, quantity, marker, width in quantities:
            functions = (conclusions.quantity(quantity, g, motion) for g in half)
            mirrors = (conclusions.best_mirror(f, period(PAPER, motion), samples=400) for f in functions)
            values = [mirror.asymmetry for mirror in mirrors]
            # even, and repeated every pi/s: the drive has turned on by that when B has by pi
            columns[f"asymmetry of {symbol} [1], {name}"] = both = np.array([*values, *values[-2::-1]])
            look: dict[str, Any] = {"marker": marker, "markersize": 4, "color": colour, "linewidth": width}
            panel.plot(np.degrees(gamma), 100.0 * both, **look, label=f"${symbol}$, {title}")
    dress(panel, "asymmetry [% of the range]")
    panel.set_xlabel("effective offset $γ - ε/s$ [°]")
    panel.set_xticks(range(0, 91, 15))
    panel.legend(**SMALL, loc="lower center", bbox_to_anchor=(0.5, 0.1), ncols=2)
    told = "Asymmetry within a period, exact"
    style.caption(figure, f"{told}. {style.mechanism(PAPER, offsets=False)}")
    return figure, columns


def swing() -> tuple[Figure, Columns]:
    """Conclusion 3: angles of D about Ox, Oy, Oz, rad, and their rates, rad/s, over one period."""
    turns = _between(4 * POINTS - 4)
    figure, columns = sheet(9.6, 6.6), {"turns of the drive": turns}
    panels = figure.subplots(2, 2, sharex=True)
    for n, (name, motion, title) in enumerate(MODES):
        k, (upper, lower) = _exact(motion, turns), panels[:, n]
        beta = np.unwrap(k.angles)
        for index, axis, place, colour in SWINGS:
            label = f"$β_{index}$, about $O{axis}$"
            upper.plot(turns, np.degrees(beta[place]), color=colour, linewidth=1.8, label=label)
            columns[f"beta_{index} [rad], {name}"] = beta[place]
            columns[f"omega_{index} [rad/s], {name}"] = omega = k.angular_velocities[place]
            lower.plot(turns, omega, color=colour, linewidth=1.5, label=f"$ω_{index}$")
        if motion.carrier != 0.0:
            turned = -np.degrees(motion.carrier * k.t)
            upper.plot(turns, turned, color=GREY, linewidth=1.0, linestyle=(0, (4, 3)), label="$-ω_1t$")
        dress(upper, "" if n else "angle of $D$ [°]", f"{'ab'[n]}) {title}")
        dress(lower, "" if n else "angular velocity [rad/s]", zero=True)
        upper.yaxis.set_major_locator(MultipleLocator((90.0, 180.0)[n]))
        upper.legend(**SMALL)
        lower.set_ylim(-350.0, 300.0)
        lower.legend(**SMALL, ncols=3, loc="lower right")
        _abscissa(lower)
    style.caption(
        figure, f"Angles of D about the axes, put right, and their rates, (5) and (6), exact. {CASE}"
    )
    return figure, columns


def as_printed() -> tuple[Figure, Columns]:
    """What the page computes beside the exact: |V|, m/s, and |a|, km/s^2, of both modes."""
    turns = _between(POINTS - 1)
    figure, columns = sheet(9.6, 6.6), {"turns of the drive": turns}
    panels = figure.subplots(2, 2, sharex=True)
    for n, (name, motion, title) in enumerate(MODES):
        k = _exact(motion, turns)
        for m, ((symbol, unit, plain, scale, what), top) in enumerate(zip(VECTORS, (1.25, 2.0), strict=True)):
            right = scale * modulus(getattr(k, what))
            page = scale * modulus(printed(PAPER, motion, k.t, what if n else f"{what}_in_link1"))
            columns |= style.compare(panels[m, n], turns, f"|{symbol}| [{plain}], {name}", right, page)
            panels[m, n].set_ylim(0.0, top * float(right.max()))
            dress(panels[m, n], "" if n else f"$|{symbol}|$ [{unit}]", "" if m else f"{'ab'[n]}) {title}")
        _abscissa(panels[1, n])
    panels[0, 0].legend(**SMALL, loc="upper right", bbox_to_anchor=(1.0, 1.12), ncols=2)
    told = "Moduli of velocity and acceleration, exact and as printed, the equations of the page in a row"
    style.caption(figure, f"{told}. {CASE}")
    return figure, columns


FIGURES: Drawings = {
    "karetin_2": trajectories,
    "karetin_3": velocity_and_acceleration,
    "karetin_offsets": offsets,
    "karetin_effective_offset": effective_offset,
    "karetin_swing": swing,
    "karetin_printed": as_printed,
}
