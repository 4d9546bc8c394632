"""Every claim in the text of the paper with what the exact solution says. Dwell kappa2 = 1 where not told."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..report import HOLDS, PARTLY, Claim
from .criteria import Criteria
from .exact import response
from .law import TWO_PI, driving_acceleration, phase_of
from .oscillation import free_oscillation

Array = NDArray[np.float64]

REFERENCE = Criteria(nu=8.0, Pi=0.5)
KAPPA2 = 1.0
# the dwell of the paper's figures is not given: peaks are looked for over these
DWELLS = np.linspace(0.25, 3.0, 111)
TIMES = np.linspace(0.0, 6.0, 4001)


def phase_peaks(values: Array, kappa2: float = KAPPA2) -> Array:
    """Largest magnitude in each of phases I to IV, shape (4,); values over TIMES, shape (4001,)."""
    phase = phase_of(TIMES, kappa2)
    return np.array([np.abs(values[phase == number]).max() for number in range(4)])


def acceleration(criteria: Criteria, beta: float, kappa2: float = KAPPA2) -> Array:
    """Invariant a'' over TIMES, shape (4001,)."""
    return response(TIMES, criteria, kappa2, beta).acceleration


def deviation(criteria: Criteria, beta: float) -> Array:
    """Largest difference of a'' from the sine a_k'' in each phase, over the peak 2 pi of the sine: (4,)."""
    return phase_peaks(acceleration(criteria, beta) - driving_acceleration(TIMES, KAPPA2)) / TWO_PI


def peak_ratios() -> tuple[Array, Array]:
    """Peaks without the balancer over peaks with it at nu = 8, Pi = 0.5.

    Returns:
        Of each phase, shape (111, 4), and of the whole motion, shape (111,), over DWELLS.
    """
    by_phase, whole = [], []
    for kappa2 in DWELLS:
        without, balanced = (acceleration(REFERENCE, beta, float(kappa2)) for beta in (0.0, 1.0))
        by_phase.append(phase_peaks(without, float(kappa2)) / phase_peaks(balanced, float(kappa2)))
        whole.append(np.abs(without).max() / np.abs(balanced).max())
    return np.array(by_phase), np.array(whole)


def _sine_approached() -> str:
    ratios = [
        (deviation(Criteria(nu, Pi), 0.0)[[0, 2]] / deviation(Criteria(nu, Pi), 1.0)[[0, 2]])
        for nu in (4.4, 8.0, 100.0)
        for Pi in (0.1, 0.5, 1.0, 2.0, 5.0)
    ]
    at = deviation(REFERENCE, 0.0)[[0, 2]] / deviation(REFERENCE, 1.0)[[0, 2]]
    return (
        f"largest deviation from the sine in phases I and III: {at[0]:.1f} and {at[1]:.1f} times smaller with"
        f" the balancer at ν = 8, Π = 0.5; over ν = 4.4 to 100 and Π = 0.1 to 5 between {np.min(ratios):.2f}"
        f" (at ν = 4.4, Π = 5: hardly nearer) and {np.max(ratios):.0f} times"
    )


def _peaks() -> str:
    ratios, whole = peak_ratios()
    third = ratios[:, 2]
    near = DWELLS[third >= 3.0]
    return (
        f"phase I {ratios[0, 0]:.2f} times lower, whatever the dwell; phase III {third.min():.2f} to"
        f" {third.max():.2f} times, depending on κ2: three times only for κ2 of {near.min():.2f} to"
        f" {near.max():.2f}, where the oscillation left from phase I and that of phase III add up without the"
        f" balancer; highest peak of all {whole.min():.2f} to {whole.max():.2f} times"
    )


def _oscillation_ratio() -> str:
    ratios, _ = peak_ratios()
    exact = [
        free_oscillation(REFERENCE, KAPPA2, 0.0, phase).amplitude
        / free_oscillation(REFERENCE, KAPPA2, 1.0, phase).amplitude
        for phase in (1, 3)
    ]
    peaks = ratios[:, [1, 3]]
    return (
        f"amplitude {exact[0]:.3f} and {exact[1]:.3f} times lower in phases II and IV: exactly ν/(2Π) for any"
        f" dwell; largest |a″| there {peaks.min():.2f} to {peaks.max():.2f} times, depending on κ2"
    )


def _stiff_difference() -> str:
    stiff = Criteria(100.0, 0.5)
    peaks = np.abs(phase_peaks(acceleration(stiff, 1.0))[[0, 2]] / TWO_PI - 1.0)
    worst = deviation(stiff, 1.0)[[0, 2]].max()
    return (
        f"peaks differ from that of the sine by {100 * peaks[0]:.3f} % in phase I and {100 * peaks[1]:.3f} %"
        f" in phase III; at one and the same time the curves differ by up to {100 * worst:.2f} %"
    )


def _stiff_oscillation() -> str:
    peaks = phase_peaks(acceleration(Criteria(100.0, 0.5), 1.0))
    return f"{100 * peaks[[1, 3]].max() / peaks[[0, 2]].max():.2f} % of the peak in phases I and III"


def _soft_shaft() -> str:
    change = acceleration(Criteria(4.4, 0.5), 1.0) - acceleration(REFERENCE, 1.0)
    share = 100.0 * phase_peaks(change) / TWO_PI
    heights = (
        100.0 * phase_peaks(acceleration(Criteria(4.4, 0.5), 1.0)) / phase_peaks(acceleration(REFERENCE, 1.0))
    )
    return (
        f"from ν = 8 to 4.4 a″ changes by up to {share[0]:.0f}, {share[1]:.0f}, {share[2]:.0f} and"
        f" {share[3]:.0f} % of the peak of the sine in phases I to IV: most in II, but in I and III no less"
        f" than half as much; the peaks in I and III change by {heights[0] - 100:+.0f} and"
        f" {heights[2] - 100:+.0f} %"
    )


def _less_friction() -> str:
    rows = [deviation(Criteria(8.0, Pi), 1.0) for Pi in (5.0, 2.0, 1.0, 0.5, 0.1, 0.0)]
    first = ", ".join(f"{100 * row[0]:.1f}" for row in rows)
    second = ", ".join(f"{100 * row[1]:.1f}" for row in rows)
    return (
        f"for Π = 5, 2, 1, 0.5, 0.1, 0 at ν = 8 the largest deviation from the sine is {first} % of its peak"
        f" in phase I, and the free oscillation in phase II {second} %"
    )


def _no_friction() -> str:
    worst = max(deviation(Criteria(nu, 0.0), 1.0).max() for nu in (4.4, TWO_PI, 8.0, 100.0))
    return f"largest deviation from the sine {worst:.0e} of its peak, at ν = 4.4, 2π, 8 and 100"


def _improvement() -> str:
    damped = Criteria(8.0, 5.0)
    worse = free_oscillation(damped, KAPPA2, 1.0).amplitude / free_oscillation(damped, KAPPA2, 0.0).amplitude
    peak = free_oscillation(damped, KAPPA2, 0.0).peak / free_oscillation(damped, KAPPA2, 1.0).peak
    soft = phase_peaks(acceleration(Criteria(4.4, 0.5), 1.0)) / phase_peaks(
        acceleration(Criteria(4.4, 0.5), 0.0)
    )
    return (
        f"the amplitude of the free oscillation falls ν/(2Π) times, so it grows where Π > ν/2: {worse:.2f}"
        f" times at ν = 8, Π = 5 (though its largest |a″| in phase II falls {peak:.2f} times); the peak in"
        f" phase III can grow as well, {soft[2]:.2f} times at ν = 4.4, Π = 0.5, κ2 = 1"
    )


CLAIMS = (
    Claim(
        "text on figure 2",
        "With the balancer the accelerations of the driven mass in phases I and III come much nearer to the"
        " sine at various ν and Π.",
        PARTLY,
        _sine_approached,
    ),
    Claim(
        "text on figure 2",
        "At ν = 8, Π = 0.5 the balancer lowers the peaks of acceleration threefold.",
        PARTLY,
        _peaks,
    ),
    Claim(
        "text on figure 2",
        "At ν = 8, Π = 0.5 it lowers the amplitude of the free oscillation in phases II and IV sevenfold.",
        HOLDS,
        _oscillation_ratio,
    ),
    Claim(
        "text on figure 2",
        "With a stiff shaft, ν = 100, the accelerations differ from the sine by 0.05 %.",
        PARTLY,
        _stiff_difference,
    ),
    Claim(
        "text on figure 2",
        "With ν = 100 the free oscillation in phases II and IV is below 1 % of the peak in I and III.",
        HOLDS,
        _stiff_oscillation,
    ),
    Claim(
        "text on figure 2",
        "Lowering ν to 4.4 acts mainly on phases II and IV, little on I and III.",
        PARTLY,
        _soft_shaft,
    ),
    Claim(
        "text on figure 3",
        "With less friction the accelerations come nearer to the sine and the free oscillation in II and IV"
        " falls considerably.",
        HOLDS,
        _less_friction,
    ),
    Claim(
        "text on figure 3",
        "At Π = 0 nothing oscillates and the acceleration is the sine exactly.",
        HOLDS,
        _no_friction,
    ),
    Claim(
        "conclusion",
        "The balancer, above all with low friction, improves the dynamics of the driven system in a wide"
        " range of compliance.",
        PARTLY,
        _improvement,
    ),
)
