"""The claims in the text of Stelmashchuk: the figures found of each and whether what it says is so.

The dwell kappa2 is 1 where not told.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia_module.loops.stepping import TWO_PI, law_of_motion, phase_of
from inertia_module.memory.instances import DrivenShaft

from ..report import ROUNDING, Finding, rounds_to, shown
from . import as_printed
from .criteria import Criteria
from .equations import KAPPA2, REFERENCE
from .exact import response
from .oscillation import free_oscillation

Array = NDArray[np.float64]

# the dwell of the paper's figures is not given: peaks are looked for over these
DWELLS = np.linspace(0.25, 3.0, 111)
TIMES = np.linspace(0.0, 6.0, 4001)
STIFFNESSES = (4.4, 8.0, 100.0)
DAMPINGS = (5.0, 2.0, 1.0, 0.5, 0.1)
CASES = [Criteria(nu, Pi) for nu in STIFFNESSES for Pi in DAMPINGS]
# phases in which the driving wheel changes its speed, and in which it does not
DRIVEN, FREE = [0, 2], [1, 3]


def phase_peaks(values: Array, kappa2: float = KAPPA2) -> Array:
    """Largest magnitude in each of phases I to IV, shape (4,); values over TIMES, shape (4001,)."""
    phase = phase_of(TIMES, kappa2)
    return np.array([np.abs(values[phase == number]).max() for number in range(4)])


def acceleration(criteria: Criteria, beta: float, kappa2: float = KAPPA2) -> Array:
    """Invariant a'' over TIMES, shape (4001,)."""
    return response(TIMES, criteria, kappa2, beta).acceleration


def deviation(criteria: Criteria, beta: float = 1.0) -> Array:
    """Difference of a'' from the sine a_k'', over the peak 2 pi of the sine, over TIMES, shape (4001,)."""
    return (acceleration(criteria, beta) - law_of_motion(TIMES, KAPPA2)[2]) / TWO_PI


@cache
def peak_ratios() -> tuple[Array, Array]:
    """Peaks without the balancer over peaks with it at nu = 8, Pi = 0.5.

    Returns:
        Of each phase, shape (111, 4), and of the whole motion, shape (111,), over DWELLS.
    """
    without, balanced = (
        np.array([phase_peaks(acceleration(REFERENCE, beta, float(k)), float(k)) for k in DWELLS])
        for beta in (0.0, 1.0)
    )
    return without / balanced, without.max(axis=1) / balanced.max(axis=1)


def _lowered(criteria: Criteria, phase: int = 1) -> Any:
    """How many times the balancer lowers amplitude and peak of the free oscillation."""
    without, balanced = (free_oscillation(criteria, KAPPA2, beta, phase) for beta in (0.0, 1.0))
    return np.array(without) / balanced


def solution() -> Finding:
    """(5) with all printed below it, phase by phase."""
    exact = acceleration(REFERENCE, 1.0)
    page = as_printed.acceleration(as_printed.printed(REFERENCE, KAPPA2), TIMES)
    share = phase_peaks(exact - page) / np.abs(exact).max()
    return Finding(*(share < ROUNDING), share=share)


def sine_approached() -> Finding:
    """Deviation from the sine in I and III, without over with the balancer; much nearer: by half."""
    every = np.array([phase_peaks(deviation(c, 0.0)) / phase_peaks(deviation(c)) for c in CASES])[:, DRIVEN]
    return Finding(
        *(every > 2.0).ravel(), at=every[CASES.index(REFERENCE)], least=every.min(), most=every.max()
    )


def peaks() -> Finding:
    """Peaks threefold lower: in phase I, in phase III, on the whole, over the dwell."""
    ratios, whole = peak_ratios()
    first, third = ratios[:, 0], ratios[:, 2]
    near = DWELLS[[rounds_to(ratio, "3") for ratio in third]]
    figures = {"first": first[0], "third": (third.min(), third.max()), "whole": (whole.min(), whole.max())}
    at = (near.min(), near[near < 1.0].max(), near[near > 1.0].min(), near.max())
    return Finding(*(rounds_to(ratio, "3") for ratio in (*first, *third, *whole)), near=at, **figures)


def oscillation_ratio() -> Finding:
    """Free oscillation sevenfold lower: its amplitude, and the largest |a''|, over the dwell."""
    amplitude = [_lowered(REFERENCE, phase)[0] for phase in (1, 3)]
    second, fourth = peak_ratios()[0][:, FREE].T
    figures = {"second": (second.min(), second.max()), "fourth": (fourth.min(), fourth.max())}
    says = (rounds_to(ratio, "7") for ratio in (*amplitude, *second, *fourth))
    return Finding(*says, amplitude=amplitude, **figures)


def stiff_difference() -> Finding:
    """How far a'' is from the sine on average at nu = 100, %, and at most."""
    off, phase = 100.0 * np.abs(deviation(Criteria(100.0, 0.5))), phase_of(TIMES, KAPPA2)
    mean = [off[phase == number].mean() for number in DRIVEN]
    most, softer = phase_peaks(off)[DRIVEN], 100.0 * phase_peaks(deviation(REFERENCE))[DRIVEN]
    return Finding(
        *(rounds_to(value, "0.05") for value in mean), *(most < softer), mean=mean, most=most.max()
    )


def stiff_oscillation() -> Finding:
    """Largest |a''| in phases II and IV over that in I and III at nu = 100, %, over the damping."""
    peak = {Pi: phase_peaks(acceleration(Criteria(100.0, Pi), 1.0)) for Pi in (*DAMPINGS, 0.0)}
    share = {Pi: 100.0 * p[FREE].max() / p[DRIVEN].min() for Pi, p in peak.items()}
    return Finding(*(value < 1.0 for value in share.values()), at=share[0.5], most=max(share.values()))


def soft_shaft() -> Finding:
    """What changes in each phase from nu = 8 to 4.4, % of the peak of the sine."""
    soft, stiff = acceleration(Criteria(4.4, 0.5), 1.0), acceleration(REFERENCE, 1.0)
    share = 100.0 * phase_peaks(soft - stiff) / TWO_PI
    height = 100.0 * (phase_peaks(soft) / phase_peaks(stiff) - 1.0)[DRIVEN]
    mainly = share[FREE].min() > 2.0 * share[DRIVEN].max()
    return Finding(mainly, np.abs(height).max() < 5.0, share=share, height=height)


def less_friction() -> Finding:
    """Deviation in phase I and free oscillation in phase II over the damping, % of the peak of the sine."""
    rows = np.array([phase_peaks(deviation(Criteria(8.0, Pi)))[:2] for Pi in (*DAMPINGS, 0.0)])
    first, second = (", ".join(f"{100 * value:.1f}" for value in column) for column in rows.T)
    return Finding(*np.all(np.diff(rows, axis=0) < 0.0, axis=0), first=first, second=second)


def no_friction() -> Finding:
    """Largest deviation from the sine at Pi = 0."""
    off = max(np.abs(deviation(Criteria(nu, 0.0))).max() for nu in (*STIFFNESSES, TWO_PI))
    return Finding(off < ROUNDING, off=shown(off))


def improvement() -> Finding:
    """The free oscillation and the peak in phase III, with over without the balancer, in a wide range."""
    amplitude, peak = _lowered(Criteria(8.0, 5.0))
    balanced, without = (phase_peaks(acceleration(Criteria(4.4, 0.5), beta))[2] for beta in (1.0, 0.0))
    says = (_lowered(criteria)[0] > 1.0 for criteria in CASES)
    return Finding(*says, balanced < without, damped=1.0 / amplitude, peak=peak, third=balanced / without)


def low_friction() -> Finding:
    """How many times the balancer lowers the free oscillation at nu = 8, over the damping."""
    ratios = [_lowered(Criteria(8.0, Pi))[0] for Pi in DAMPINGS]
    return Finding(*np.diff(ratios) > 0.0, ratios=", ".join(f"{ratio:.3g}" for ratio in ratios))


def _under_load(Pi: float, load: float) -> float:
    """Work on a load over all work put in, the balancer's too, by the driven shaft of the FMU at nu = 8.

    Args:
        Pi: damping. load: torque that the mass turns against, over the largest inertia torque 2 pi J4.
    """
    stiffness, torque = REFERENCE.nu**2, load * TWO_PI
    times = np.linspace(0.0, 6.0, 601)
    speeds, step = law_of_motion(times, KAPPA2)[1], times[1]
    shaft = DrivenShaft().start(
        driven_inertia=1.0,
        shaft_stiffness=stiffness,
        shaft_damping=0.0,
        driven_friction=2.0 * Pi,
        balancer=1.0,
        load_torque=torque,
        twist_start=torque / stiffness,
    )
    balancer = 0.0
    for speed, gain in zip(speeds, np.diff(speeds), strict=False):
        before = shaft["omega_out"]
        shaft.set(hub_speed=float(speed))
        shaft.set_rates(hub_speed=float(gain / step))
        shaft.advance(step)
        balancer += gain * 0.5 * (before + shaft["omega_out"])
    return shaft["energy_out"] / (shaft["energy_in"] + balancer)


def efficiency() -> Finding:
    """What friction takes over the whole motion, over the largest kinetic energy; efficiency under loads."""
    energy = 0.5 * 2.0**2
    speeds = [response(TIMES, Criteria(8.0, Pi), KAPPA2).velocity for Pi in DAMPINGS]
    lost = [
        2.0 * Pi * np.sum(v[:-1] ** 2) * TIMES[1] / energy for Pi, v in zip(DAMPINGS, speeds, strict=True)
    ]
    loaded = [[_under_load(Pi, load) for Pi in DAMPINGS] for load in (1.0, 0.1)]
    full, tenth = (", ".join(f"{100 * share:.0f}" for share in row) for row in loaded)
    says = (all(np.diff(lost) < 0.0), np.all(np.diff(loaded) > 0.0), *(row[-1] > 0.9 for row in loaded))
    return Finding(*says, lost=", ".join(f"{loss:.2g}" for loss in lost), full=full, tenth=tenth)
