"""The formulas of the page, printing errors kept: for comparison only, use exact for numbers.

The page calls v what is nu here. It does not say what nu0, chi and nu1 are; the names below reproduce
every printed R. Errors kept: 4 pi^2 Pi in R'' (should be 4 pi Pi), the bracket in C1 of phase III
(R0' belongs inside), B of phase III, which is not defined (2 is right). Only Pi < nu is covered.

kappa: numbers or arrays of shape (n,), as the results, all without unit; C: constants (C1, C2) of a phase.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .criteria import Criteria
from .law import HALF, phase_of, phase_starts

# a number or an array of shape (n,)
Value = Any
Pair = tuple[float, float]

# not defined on the page: the velocity of phase II makes a continuous
B_DEFAULT = 2.0


class Symbols(NamedTuple):
    """Abbreviations of the page: nu0 = nu^2 - 4 pi^2, chi = nu0^2 + (4 pi Pi)^2, nu1 = sqrt(nu^2 - Pi^2)."""

    nu: float
    Pi: float
    nu0: float
    chi: float
    nu1: float


def symbols(criteria: Criteria) -> Symbols:
    """Abbreviations for a system the printed form covers.

    Raises:
        ValueError: Pi >= nu, where nu1 is not a real number above 0, or chi = 0 (Pi = 0, nu = 2 pi).
    """
    nu, Pi = criteria.nu, criteria.Pi
    nu0 = nu**2 - 4.0 * np.pi**2
    chi = nu0**2 + (4.0 * np.pi * Pi) ** 2
    if nu <= Pi or chi == 0.0:
        raise ValueError(f"the printed form covers Pi < nu without resonance only, not nu = {nu}, Pi = {Pi}")
    return Symbols(nu, Pi, nu0, chi, float(np.sqrt(nu**2 - Pi**2)))


def free_part(kappa: Value, C: Pair, s: Symbols) -> tuple[Value, Value]:
    """exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa), the solution of (4) less R, and its derivative."""
    fading, sine, cosine = np.exp(-s.Pi * kappa), np.sin(s.nu1 * kappa), np.cos(s.nu1 * kappa)
    swing = C[0] * sine + C[1] * cosine
    return fading * swing, fading * (s.nu1 * (C[0] * cosine - C[1] * sine) - s.Pi * swing)


def free_acceleration(kappa: Value, C: Pair, s: Symbols) -> Value:
    """Equation (5) without R''; kappa from the beginning of the phase."""
    sine, cosine = np.sin(s.nu1 * kappa), np.cos(s.nu1 * kappa)
    swing = (C[0] * sine + C[1] * cosine) * (s.Pi**2 - s.nu1**2)
    return np.exp(-s.Pi * kappa) * (swing - 2.0 * s.Pi * s.nu1 * (C[0] * cosine - C[1] * sine))


def particular_acceleration(kappa: Value, s: Symbols) -> Value:
    """R'' of phase I, and with the sign turned of phase III: with the printed 4 pi^2 Pi."""
    angle = 2.0 * np.pi * kappa
    wave = s.nu0 * np.sin(angle) - 4.0 * np.pi**2 * s.Pi * np.cos(angle)
    return 2.0 * np.pi * s.nu0 / s.chi * wave


def constants_1(s: Symbols) -> Pair:
    """C1, C2 of phase I from R0 = 2 Pi (nu0/chi - 1/nu^2) and R0' = 1 - nu0^2/chi."""
    R0 = 2.0 * s.Pi * (s.nu0 / s.chi - 1.0 / s.nu**2)
    R0_rate = 1.0 - s.nu0**2 / s.chi
    return -(R0_rate + s.Pi * R0) / s.nu1, -R0


def constants_2(s: Symbols, C: Pair) -> Pair:
    """C1, C2 of phase II from a and a' at the end of phase I; C: constants of phase I."""
    free, free_rate = free_part(HALF, C, s)
    a = free + 0.5 - 2.0 * s.Pi * (s.nu0 / s.chi + 1.0 / s.nu**2)
    a_rate = free_rate + 1.0 + s.nu0**2 / s.chi
    C2 = float(a + 4.0 * s.Pi / s.nu**2 - 0.5)
    return float(s.Pi * C2 + a_rate - 2.0) / s.nu1, C2


def constants_3(s: Symbols, C: Pair, kappa2: float, B: float = B_DEFAULT) -> Pair:
    """C1, C2 of phase III from a and a' at the end of phase II, the bracket of C1 as printed.

    Args:
        s: abbreviations. C: constants of phase II. kappa2: length of phase II. B: not defined on the page.
    """
    free, free_rate = free_part(kappa2, C, s)
    a = free + 0.5 - 4.0 * s.Pi / s.nu**2 + 2.0 * kappa2
    a_rate = free_rate + 2.0
    R0 = 0.5 + B * kappa2 - 2.0 * s.Pi * (1.0 / s.nu**2 + s.nu0 / s.chi)
    R0_rate = 1.0 + s.nu0**2 / s.chi
    return float(a_rate + s.Pi * (a - R0)) / s.nu1 - R0_rate, float(a - R0)


def constants_4(s: Symbols, C: Pair, kappa2: float) -> Pair:
    """C1, C2 of phase IV from a and a' at the end of phase III; C: constants of phase III."""
    free, free_rate = free_part(HALF, C, s)
    a = free + 1.0 + 2.0 * kappa2 - 2.0 * s.Pi * (1.0 / s.nu**2 - s.nu0 / s.chi)
    a_rate = free_rate + 1.0 - s.nu0**2 / s.chi
    C2 = float(a - 1.0 - 2.0 * kappa2)
    return float(a_rate + s.Pi * C2) / s.nu1, C2


def acceleration(kappa: Value, criteria: Criteria, kappa2: float, B: float = B_DEFAULT) -> Value:
    """Invariant a'' of the driven mass with the balancer: (5) with everything printed below it, in a row.

    Args:
        kappa: relative time, shape (n,), >= 0. criteria: nu and Pi. kappa2: length of phase II.
        B: not defined on the page.

    Raises:
        ValueError: see symbols.
    """
    s = symbols(criteria)
    first = constants_1(s)
    second = constants_2(s, first)
    third = constants_3(s, second, kappa2, B)
    constants = (first, second, third, constants_4(s, third, kappa2))
    number = phase_of(kappa, kappa2)
    local = kappa - phase_starts(kappa2)[number]
    free = np.choose(number, [free_acceleration(local, C, s) for C in constants])
    return free + np.choose(number, [1.0, 0.0, -1.0, 0.0]) * particular_acceleration(local, s)
