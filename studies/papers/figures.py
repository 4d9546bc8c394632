"""Figures of curves: each equation that is wrong as printed beside its exact form, and what the papers draw.

Karetin's are drawn for the scene R1 with 40 teeth on wheel 17: then s = 2 is whole and one turn of the drive
is one period of the motion in link 1, as the paper has it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from inertia_module.common.colours import GREY

from . import karetin, lysenko, sketches, stelmashchuk
from .drawing import Panel, mechanism, numbers, panels, wheels
from .engine import Row
from .karetin import DYNAMIC, GENERAL, OFFSET, PAPER, STOP, exact, period
from .stelmashchuk import KAPPA2, Criteria, response
from .stepping import PHASES, law_of_motion, phase_starts

TURNS = np.linspace(0.0, 1.0, 1441)
# between the instants at which D is on an axis or the page divides by zero
BETWEEN = (np.arange(5760) + 0.5) / 5760
DRIVE = "turns of the drive"
ALPHA = "angle α of wheel 1 on the carrier [°]"
MODES = (("stop mode", STOP), ("dynamic mode, i = 2", DYNAMIC))
# quantity, symbol, unit, and that over the SI unit
VECTORS = (("velocity", "V", "m/s", 1.0), ("acceleration", "a", "km/s²", 1e-3))
# the dwell of Stelmashchuk's figures is not given
KAPPA = np.linspace(0.0, 3.5, 1401)
RELATIVE_TIME = "relative time κ = t/T [1]"


# of the equations of a paper: abscissa and the part of it that is shown, its label, mechanism and motion
SHEETS: dict[str, tuple[ModuleType, Any, slice, str, str]] = {
    "karetin": (
        karetin,
        karetin.STOPPED.t * karetin.STOPPED.omega16 / (2.0 * np.pi),
        slice(0, karetin.SAMPLES // GENERAL.turns_in_period, 10),
        DRIVE,
        mechanism(GENERAL),
    ),
    "lysenko": (lysenko, np.degrees(lysenko.INSIDE), slice(0, None, 18), ALPHA, wheels()),
    "stelmashchuk": (
        stelmashchuk,
        stelmashchuk.RISE,
        slice(0, None, 15),
        "relative time κ in phase I [1]",
        f"ν = 8, Π = 0.5, κ2 = {KAPPA2:g}.",
    ),
}


def equation(name: str, row: Row) -> Figure:
    """A panel for each component of an equation: exact, and as printed but fed with exact values."""
    paper, x, shown, label, case = SHEETS[name]
    page, right, _ = np.broadcast_arrays(*paper.EQUATIONS[row.number].forms()[:2], x)
    forms = zip(row.drawn.split(", "), np.atleast_2d(right), np.atleast_2d(page), strict=False)
    cells = [
        Panel(component, {"exact": one[shown], "as printed": other[shown]}) for component, one, other in forms
    ]
    return panels([cells], x[shown], label, f"Equation {row.number}, exact and as printed. {case}")


def in_period(motion: Any, turns: Any = TURNS, geometry: Any = PAPER) -> Any:
    """Karetin's exact forms over a period."""
    return exact(geometry, motion, turns * period(geometry, motion))


def by_mode(x: Any, told: str, curves: Callable[..., Mapping[str, Any]]) -> Figure:
    """Draw what curves gives of velocity and acceleration, each over a period in both modes."""
    rows = [
        [Panel(f"{name} [{unit}]", curves(name, symbol, scale, motion), title) for title, motion in MODES]
        for name, symbol, unit, scale in VECTORS
    ]
    return panels(rows, x, DRIVE, f"{told}. {mechanism(PAPER)}", sharey="row")


def velocity_and_acceleration() -> Figure:
    """Karetin's figure 3: velocity and acceleration of D, their moduli and components."""

    def curves(name: str, symbol: str, scale: float, motion: Any) -> Mapping[str, Any]:
        vector = scale * getattr(in_period(motion), name)
        parts = {f"${symbol}_{axis}$": part for axis, part in zip("xyz", vector, strict=True)}
        return parts | {f"$|{symbol}|$": karetin.modulus(vector)}

    return by_mode(TURNS, "Absolute velocity and acceleration of D and their components, exact", curves)


def in_a_row() -> Figure:
    """Moduli of velocity and acceleration, exact and as the page computes them."""

    def curves(name: str, symbol: str, scale: float, motion: Any) -> Mapping[str, Any]:
        k = in_period(motion, BETWEEN)
        velocity = "velocity" if motion.carrier else "velocity_in_link1"
        page = karetin.printed(PAPER, motion, k.t, velocity)
        if name == "acceleration":
            step = 1e-3 * k.t[0]
            after, before = (karetin.printed(PAPER, motion, k.t + h, velocity) for h in (step, -step))
            page = (after - before) / (2.0 * step)
        forms = {"exact": getattr(k, name), "as printed": page}
        return {form: scale * karetin.modulus(vector) for form, vector in forms.items()}

    told = "Moduli of velocity and acceleration, exact and as printed, the equations of the page in a row"
    figure = by_mode(BETWEEN, told, curves)
    # it has poles where the page divides by zero
    for axes, top in zip(figure.axes, (20.0, 20.0, 6.0, 6.0), strict=True):
        axes.set_ylim(0.0, top)
    return figure


def swing() -> Figure:
    """Conclusion 3: angles of D about Ox, Oy, Oz and their rates over a period, in both modes."""
    upper, lower = [], []
    for title, motion in MODES:
        k = in_period(motion, BETWEEN)
        beta, about = np.degrees(np.unwrap(k.angles)), zip("HPF", "zxy", strict=True)
        shown = {f"$β_{index}$, about $O{axis}$": beta[n] for n, (index, axis) in enumerate(about)}
        upper.append(Panel("angle of D [°]", shown | {"$-ω_1t$": -np.degrees(motion.carrier * k.t)}, title))
        rates = {f"$ω_{index}$": k.angular_velocities[n] for n, index in enumerate("HPF")}
        lower.append(Panel("angular velocity [rad/s]", rates, title))
    told = f"Angles of D about the axes, put right, and their rates, (5) and (6), exact. {mechanism(PAPER)}"
    figure = panels([upper, lower], BETWEEN, DRIVE, told)
    for axes in figure.axes[2:]:
        axes.set_ylim(-350.0, 300.0)
    return figure


def offsets() -> Figure:
    """Conclusion 2: |V| with the offsets epsilon and gamma, each beside its mirror image."""
    cases = ((0.0, 0.0), (OFFSET, 0.0), (0.0, OFFSET), (OFFSET, OFFSET / PAPER.s))
    rows = []
    for title, motion in MODES:
        row = []
        for epsilon, gamma in cases:
            geometry = replace(PAPER, epsilon=epsilon, gamma=gamma)
            span = period(geometry, motion)

            def speed(t: Any, geometry: Any = geometry, motion: Any = motion) -> Any:
                return exact(geometry, motion, t).speed

            share, instant = karetin.best_mirror(speed, span)
            both = {"exact": speed(TURNS * span), "mirrored": speed(2.0 * instant - TURNS * span)}
            told = f"ε = {epsilon:g}, γ = {gamma:g}: asymmetry {100.0 * share:.1f} %"
            row.append(Panel(f"|V| [m/s], {title}", both, told))
        rows.append(row)
    told = "Speed of D and its mirror image about the instant that suits best (broken), exact"
    return panels(rows, TURNS, DRIVE, f"{told}. {mechanism(PAPER, offsets=False)}", sharey="row")


def effective_offset() -> Figure:
    """Conclusion 2: asymmetry of |V| and |a| over gamma - epsilon/s, all that counts of the offsets."""
    gamma = np.linspace(0.0, 0.5 * np.pi, 25)
    found = {}
    for title, motion in MODES:
        for symbol, name in (("|V|", "speed"), ("|a|", "acceleration_modulus")):
            half = [
                100.0 * karetin.asymmetry(name, replace(PAPER, gamma=g), motion) for g in gamma[:13].tolist()
            ]
            # even, and repeated every pi/s: the drive has turned on by that when B has by pi
            found[f"{symbol}, {title}"] = np.array([*half, *half[-2::-1]])
    told = f"Asymmetry within a period, exact. {mechanism(PAPER, offsets=False)}"
    panel = Panel("asymmetry [% of the range]", found)
    return panels([[panel]], np.degrees(gamma), "effective offset γ - ε/s [°]", told)


def cycle() -> Figure:
    """Lysenko: moments and power of the drive over a cycle at constant speed, and the free motion."""
    alpha, m, omega = np.linspace(0.0, 2.0 * np.pi, 721), lysenko.EXAMPLE, lysenko.EXAMPLE_SPEED
    # the page divides by the speed, which is 0 at both ends
    e, page = (
        lysenko.exact(m, alpha, omega),
        lysenko.printed(m, np.clip(alpha, 1e-9, 2.0 * np.pi - 1e-9), omega),
    )
    quantities = (
        ("$M_1$ [N·m]", "moment about O1", e.M1, page.M1),
        ("$M$ [N·m]", "moment about O", e.M, page.M),
        ("$-(N_1 + N)$ [W]", "power of the drive, zero on average", *(-k.N1 - k.N for k in (e, page))),
    )
    cells = [
        Panel(label, {"exact": right, "as printed": wrong}, title)
        for label, title, right, wrong in quantities
    ]
    free = {"exact": lysenko.exact(m, alpha).free_speed, "as printed": page.J_limits[0] / page.J}
    cells.append(Panel("ω / ω min [1]", free, "free mechanism, no drive"))
    told = f"A cycle of the epicycloid, exact and as printed. {wheels()}"
    return panels([cells[:2], cells[2:]], np.degrees(alpha), ALPHA, told)


def _phases(figure: Figure) -> Figure:
    """Mark the phases of Stelmashchuk's law along the top of each panel."""
    edges = [*phase_starts(KAPPA2), KAPPA[-1]]
    for axes in figure.axes:
        for number, name in enumerate(PHASES):
            start, end = edges[number : number + 2]
            if number % 2:
                axes.axvspan(start, end, color=GREY, alpha=0.10, linewidth=0)
            at = 0.5 * (start + end), 0.98
            axes.text(*at, name, transform=axes.get_xaxis_transform(), ha="center", va="top", color=GREY)
    return figure


def accelerations(cases: Mapping[str, Criteria], over: str) -> Figure:
    """Stelmashchuk's figures 2 and 3: a'' with the balancer above that without it, to one scale."""
    rows = []
    for title, beta in (("with the balancer", 1.0), ("without the balancer", 0.0)):
        sine = {"sine": law_of_motion(KAPPA, KAPPA2)[2]}
        found = {name: response(KAPPA, case, KAPPA2, beta).acceleration for name, case in cases.items()}
        rows.append([Panel("a″ [1]", sine | found, title)])
    told = f"Acceleration of the driven mass over the {over}, exact; κ2 = {KAPPA2:g}"
    return _phases(
        panels(rows, KAPPA, RELATIVE_TIME, f"{told}. Accelerations in φ/T², times in T.", sharey=True)
    )


def over_printed() -> Figure:
    """Acceleration with the balancer as the page computes it, its equations in a row, beside the exact."""
    rows = []
    for nu in (4.4, 8.0, 100.0):
        case = Criteria(nu, 0.5)
        page = stelmashchuk.acceleration(stelmashchuk.printed(case, KAPPA2), KAPPA)
        right = response(KAPPA, case, KAPPA2).acceleration
        rows.append([Panel("a″ [1]", {"exact": right, "as printed": page}, f"ν = {nu:g}")])
    told = "Acceleration of the driven mass with the balancer, where the printed C1 of phase III leads"
    figure = panels(rows, KAPPA, RELATIVE_TIME, f"{told}; Π = 0.5, κ2 = 1. In φ/T², logarithmic beyond ±10.")
    for axes in figure.axes:
        axes.set_yscale("symlog", linthresh=10.0, linscale=2.0)
    return _phases(figure)


STIFFNESSES = {f"ν = {nu:g}": Criteria(nu, 0.5) for nu in (4.4, 8.0, 100.0)}
DAMPINGS = {f"Π = {Pi:g}": Criteria(8.0, Pi) for Pi in (0.0, 0.5, 1.0, 2.0, 3.0, 5.0)}
FIGURES: dict[str, Callable[[], Figure]] = {
    **sketches.FIGURES,
    "karetin_3": velocity_and_acceleration,
    "karetin_offsets": offsets,
    "karetin_effective_offset": effective_offset,
    "karetin_swing": swing,
    "karetin_printed": in_a_row,
    "lysenko_2": cycle,
    "stelmashchuk_2": partial(accelerations, STIFFNESSES, "stiffness, Π = 0.5"),
    "stelmashchuk_3": partial(accelerations, DAMPINGS, "damping, ν = 8"),
    "stelmashchuk_printed": over_printed,
    **{
        f"{name}_equation_{''.join(filter(str.isalnum, row.number))}": partial(equation, name, row)
        for name, (paper, *_) in SHEETS.items()
        for row in paper.ROWS
        if row.drawn
    },
}


def all_figures() -> dict[str, Callable[[], tuple[Figure, dict[str, Any]]]]:
    """The functions that draw the figures and return them with their numbers by column, by name."""

    def drawn(draw: Callable[[], Figure]) -> tuple[Figure, dict[str, Any]]:
        figure = draw()
        return figure, numbers(figure)

    return {name: partial(drawn, draw) for name, draw in FIGURES.items()}
