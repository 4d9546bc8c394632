"""The formulas of the page, printing errors kept: for comparison only, use exact for numbers.

The page calls v what is nu here. It does not say what nu0, chi and nu1 are; the names below reproduce
every printed R. Errors kept: 4 pi^2 Pi in R'' (should be 4 pi Pi), the bracket in C1 of phase III
(R0' belongs inside), B of phase III, which is not defined (2 is right). Only Pi < nu is covered.

kappa: from the beginning of a phase, numbers or arrays of shape (n,), as the results, all without unit;
C: constants (C1, C2) of a phase.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia_module.loops.stepping import HALF, phase_of, phase_starts

from ..forms import Forms, Formulas
from .criteria import Criteria

Pair = tuple[Any, Any]


def printed(criteria: Criteria, kappa2: float, B: float = 2.0) -> Forms:
    """Abbreviations and constants of the page, each fed with the printed ones before it.

    Args:
        criteria: nu and Pi. kappa2: length of phase II. B: not defined on the page; the velocity of phase
            II, 2, makes a continuous.

    Raises:
        ValueError: Pi >= nu, where nu1 is not a real number above 0, or chi = 0 (Pi = 0, nu = 2 pi).
    """
    nu, Pi = criteria.nu, criteria.Pi
    s = Forms(PRINTED, nu=nu, Pi=Pi, kappa2=kappa2, B=B)
    if nu <= Pi or s.chi == 0.0:
        raise ValueError(f"the printed form covers Pi < nu without resonance only, not nu = {nu}, Pi = {Pi}")
    return s


def free_part(s: Forms, kappa: Any, C: Pair) -> Pair:
    """exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa), the solution of (4) less R, and its derivative."""
    fading, sine, cosine = np.exp(-s.Pi * kappa), np.sin(s.nu1 * kappa), np.cos(s.nu1 * kappa)
    swing = C[0] * sine + C[1] * cosine
    return fading * swing, fading * (s.nu1 * (C[0] * cosine - C[1] * sine) - s.Pi * swing)


def free_acceleration(s: Forms, kappa: Any, C: Pair) -> Any:
    """Equation (5) without R''."""
    sine, cosine = np.sin(s.nu1 * kappa), np.cos(s.nu1 * kappa)
    swing = (C[0] * sine + C[1] * cosine) * (s.Pi**2 - s.nu1**2)
    return np.exp(-s.Pi * kappa) * (swing - 2.0 * s.Pi * s.nu1 * (C[0] * cosine - C[1] * sine))


def particular_acceleration(s: Forms, kappa: Any) -> Any:
    """R'' of phase I, and with the sign turned of phase III: with the printed 4 pi^2 Pi."""
    angle = 2.0 * np.pi * kappa
    wave = s.nu0 * np.sin(angle) - 4.0 * np.pi**2 * s.Pi * np.cos(angle)
    return 2.0 * np.pi * s.nu0 / s.chi * wave


def acceleration(s: Forms, kappa: Any) -> Any:
    """Invariant a'' of the driven mass with the balancer: (5) with everything printed below it, in a row.

    Args:
        s: see printed. kappa: relative time, shape (n,), >= 0.
    """
    number = phase_of(kappa, s.kappa2)
    local = kappa - phase_starts(s.kappa2)[number]
    free = np.choose(number, [free_acceleration(s, local, C) for C in (s.C_I, s.C_II, s.C_III, s.C_IV)])
    return free + np.choose(number, [1.0, 0.0, -1.0, 0.0]) * particular_acceleration(s, local)


def _phase_1(s: Any) -> Pair:
    R0 = 2.0 * s.Pi * (s.nu0 / s.chi - 1.0 / s.nu**2)
    R0_rate = 1.0 - s.nu0**2 / s.chi
    return -(R0_rate + s.Pi * R0) / s.nu1, -R0


def _phase_2(s: Any) -> Pair:
    free, free_rate = free_part(s, HALF, s.C_I)
    a = free + 0.5 - 2.0 * s.Pi * (s.nu0 / s.chi + 1.0 / s.nu**2)
    a_rate = free_rate + 1.0 + s.nu0**2 / s.chi
    C2 = a + 4.0 * s.Pi / s.nu**2 - 0.5
    return (s.Pi * C2 + a_rate - 2.0) / s.nu1, C2


def _phase_3(s: Any) -> Pair:
    free, free_rate = free_part(s, s.kappa2, s.C_II)
    a = free + 0.5 - 4.0 * s.Pi / s.nu**2 + 2.0 * s.kappa2
    a_rate = free_rate + 2.0
    R0 = 0.5 + s.B * s.kappa2 - 2.0 * s.Pi * (1.0 / s.nu**2 + s.nu0 / s.chi)
    R0_rate = 1.0 + s.nu0**2 / s.chi
    # the bracket closes too early
    return (a_rate + s.Pi * (a - R0)) / s.nu1 - R0_rate, a - R0


def _phase_4(s: Any) -> Pair:
    free, free_rate = free_part(s, HALF, s.C_III)
    a = free + 1.0 + 2.0 * s.kappa2 - 2.0 * s.Pi * (1.0 / s.nu**2 - s.nu0 / s.chi)
    a_rate = free_rate + 1.0 - s.nu0**2 / s.chi
    C2 = a - 1.0 - 2.0 * s.kappa2
    return (a_rate + s.Pi * C2) / s.nu1, C2


PRINTED: Formulas = {
    "nu0": lambda s: s.nu**2 - 4.0 * np.pi**2,
    "chi": lambda s: s.nu0**2 + (4.0 * np.pi * s.Pi) ** 2,
    "nu1": lambda s: np.sqrt(s.nu**2 - s.Pi**2),
    # C1, C2 of the phases, from a and a' at the end of the phase before
    "C_I": _phase_1,
    "C_II": _phase_2,
    "C_III": _phase_3,
    "C_IV": _phase_4,
}
