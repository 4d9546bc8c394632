"""The claims in the text of Stelmashchuk: figures found, and whether what is said is so.

The dwell kappa2 is 1 where not told.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from inertia_module.loops.stepping import TWO_PI, law_of_motion, phase_of
from inertia_module.memory import DrivenShaft

from ..report import ROUNDING, Finding, percent, rounds_to, shown
from . import equations
from .equations import KAPPA2, REFERENCE
from .exact import Criteria, free_oscillation, response

Rows = Iterator[tuple[str, Finding]]
# the dwell of the paper's figures is not given: peaks are looked for over these
DWELLS = np.linspace(0.25, 3.0, 111)
TIMES = np.linspace(0.0, 6.0, 4001)
STIFFNESSES = (4.4, 8.0, 100.0)
DAMPINGS = (5.0, 2.0, 1.0, 0.5, 0.1)
CASES = [Criteria(nu, Pi) for nu in STIFFNESSES for Pi in DAMPINGS]
# phases in which the driving wheel changes its speed, and in which it does not
DRIVEN, FREE = [0, 2], [1, 3]


def phase_peaks(values: Any, kappa2: float = KAPPA2) -> Any:
    """Largest magnitude in each of phases I to IV, shape (4,); values over TIMES, shape (4001,)."""
    phase = phase_of(TIMES, kappa2)
    return np.array([np.abs(values[phase == number]).max() for number in range(4)])


def acceleration(criteria: Criteria, beta: float = 1.0, kappa2: float = KAPPA2) -> Any:
    """Invariant a'' over TIMES, shape (4001,)."""
    return response(TIMES, criteria, kappa2, beta).acceleration


def deviation(criteria: Criteria, beta: float = 1.0) -> Any:
    """Difference of a'' from the sine a_k'', over the peak 2 pi of the sine, over TIMES, shape (4001,)."""
    return (acceleration(criteria, beta) - law_of_motion(TIMES, KAPPA2)[2]) / TWO_PI


def lowered(criteria: Criteria, phase: int = 1) -> Any:
    """Factors by which the balancer lowers amplitude and peak of the free oscillation."""
    without, balanced = (free_oscillation(criteria, KAPPA2, beta, phase) for beta in (0.0, 1.0))
    return np.array(without) / balanced


def under_load(Pi: float, load: float) -> float:
    """Work on a load over all work put in, the balancer's too, by the driven shaft of the FMU at nu = 8.

    Args:
        Pi: damping. load: torque that the mass turns against, over the largest inertia torque 2 pi J4.
    """
    stiffness, torque = REFERENCE.nu**2, load * TWO_PI
    times = np.linspace(0.0, 6.0, 601)
    speeds, step = law_of_motion(times, KAPPA2)[1], times[1]
    mass = {"driven_inertia": 1.0, "driven_friction": 2.0 * Pi, "balancer": 1.0, "load_torque": torque}
    spring = {"shaft_stiffness": stiffness, "shaft_damping": 0.0, "twist_start": torque / stiffness}
    shaft = DrivenShaft().start(**mass, **spring)
    balancer = 0.0
    for speed, gain in zip(speeds, np.diff(speeds), strict=False):
        before = shaft["omega_out"]
        shaft.set(hub_speed=float(speed))
        shaft.set_rates(hub_speed=float(gain / step))
        shaft.advance(step)
        balancer += gain * 0.5 * (before + shaft["omega_out"])
    return shaft["energy_out"] / (shaft["energy_in"] + balancer)


def of_figure_2() -> Rows:
    """The printed solution, and what balancer and stiffness do."""
    exact = acceleration(REFERENCE)
    page = equations.acceleration(equations.printed(REFERENCE, KAPPA2), TIMES)
    share = phase_peaks(exact - page) / np.abs(exact).max()
    yield "solution", Finding(*(share < ROUNDING), share=share)

    # deviation without over with the balancer; much nearer: by half
    every = np.array([phase_peaks(deviation(c, 0.0)) / phase_peaks(deviation(c)) for c in CASES])[:, DRIVEN]
    figures = {"at": every[CASES.index(REFERENCE)], "least": every.min(), "most": every.max()}
    yield "sine_approached", Finding(*(every > 2.0).ravel(), **figures)

    # peaks of phases, shape (111, 4), without over with the balancer, over the dwell
    without, balanced = (
        np.array([phase_peaks(acceleration(REFERENCE, beta, k), k) for k in DWELLS.tolist()])
        for beta in (0.0, 1.0)
    )
    whole = without.max(axis=1) / balanced.max(axis=1)
    first, second, third, fourth = (without / balanced).T
    near = DWELLS[[rounds_to(ratio, "3") for ratio in third]]
    at = (near.min(), near[near < 1.0].max(), near[near > 1.0].min(), near.max())
    figures = {"first": first[0], "third": (third.min(), third.max()), "whole": (whole.min(), whole.max())}
    says: Any = (rounds_to(ratio, "3") for ratio in (*first, *third, *whole))
    yield "peaks", Finding(*says, near=at, **figures)

    amplitude = [lowered(REFERENCE, phase)[0] for phase in FREE]
    figures = {"second": (second.min(), second.max()), "fourth": (fourth.min(), fourth.max())}
    says = (rounds_to(ratio, "7") for ratio in (*amplitude, *second, *fourth))
    yield "oscillation_ratio", Finding(*says, amplitude=amplitude, **figures)

    off, phase = 100.0 * np.abs(deviation(Criteria(100.0, 0.5))), phase_of(TIMES, KAPPA2)
    mean = [off[phase == number].mean() for number in DRIVEN]
    most, softer = phase_peaks(off)[DRIVEN], 100.0 * phase_peaks(deviation(REFERENCE))[DRIVEN]
    says = (*(rounds_to(value, "0.05") for value in mean), *(most < softer))
    yield "stiff_difference", Finding(*says, mean=mean, most=most.max())

    peaks = {Pi: phase_peaks(acceleration(Criteria(100.0, Pi))) for Pi in (*DAMPINGS, 0.0)}
    shares = {Pi: 100.0 * peak[FREE].max() / peak[DRIVEN].min() for Pi, peak in peaks.items()}
    says = (value < 1.0 for value in shares.values())
    yield "stiff_oscillation", Finding(*says, at=shares[0.5], most=max(shares.values()))

    soft = acceleration(Criteria(4.4, 0.5))
    share = 100.0 * phase_peaks(soft - exact) / TWO_PI
    height = 100.0 * (phase_peaks(soft) / phase_peaks(exact) - 1.0)[DRIVEN]
    says = share[FREE].min() > 2.0 * share[DRIVEN].max(), np.abs(height).max() < 5.0
    yield "soft_shaft", Finding(*says, share=share, height=height)


def of_figure_3() -> Rows:
    """Effect of friction, and the conclusions."""
    rows = np.array([phase_peaks(deviation(Criteria(8.0, Pi)))[:2] for Pi in (*DAMPINGS, 0.0)])
    first, second = (percent(column, 1) for column in rows.T)
    yield "less_friction", Finding(*np.all(np.diff(rows, axis=0) < 0.0, axis=0), first=first, second=second)

    off = max(np.abs(deviation(Criteria(nu, 0.0))).max() for nu in (*STIFFNESSES, TWO_PI))
    yield "no_friction", Finding(off < ROUNDING, off=shown(off))

    amplitude, peak = lowered(Criteria(8.0, 5.0))
    balanced, without = (phase_peaks(acceleration(Criteria(4.4, 0.5), beta))[2] for beta in (1.0, 0.0))
    says = (*(lowered(criteria)[0] > 1.0 for criteria in CASES), balanced < without)
    yield "improvement", Finding(*says, damped=1.0 / amplitude, peak=peak, third=balanced / without)

    ratios = [lowered(Criteria(8.0, Pi))[0] for Pi in DAMPINGS]
    told = ", ".join(f"{ratio:.3g}" for ratio in ratios)
    yield "low_friction", Finding(*np.diff(ratios) > 0.0, ratios=told)

    # what friction takes over the whole motion, over the largest kinetic energy
    speeds = [response(TIMES, Criteria(8.0, Pi), KAPPA2).velocity for Pi in DAMPINGS]
    energies = [2.0 * Pi * np.sum(v[:-1] ** 2) * TIMES[1] for Pi, v in zip(DAMPINGS, speeds, strict=True)]
    lost = [energy / (0.5 * 2.0**2) for energy in energies]
    loaded = [[under_load(Pi, load) for Pi in DAMPINGS] for load in (1.0, 0.1)]
    says = (all(np.diff(lost) < 0.0), np.all(np.diff(loaded) > 0.0), *(row[-1] > 0.9 for row in loaded))
    told = ", ".join(f"{loss:.2g}" for loss in lost)
    yield "efficiency", Finding(*says, lost=told, full=percent(loaded[0]), tenth=percent(loaded[1]))


def findings() -> dict[str, Finding]:
    """The rows of the table of claims."""
    return {**dict(of_figure_2()), **dict(of_figure_3())}
