"""The formulas of the page, printing errors kept: for comparison only, use exact for numbers.

The page calls v what is nu here. It does not say what nu0, chi and nu1 are; the names below reproduce
every printed R. Errors kept: 4 pi^2 Pi in R'' (should be 4 pi Pi), the bracket in C1 of phase III
(R0' belongs inside), B of phase III, which is not defined (2 is right). Only Pi < nu is covered.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .criteria import Criteria
from .law import HALF, phase_of, phase_starts

Array = NDArray[np.float64]
Pair = tuple[float, float]

# not defined on the page: the velocity of phase II makes a continuous
B_DEFAULT = 2.0


@dataclass(frozen=True)
class Symbols:
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
        raise ValueError(
            f"nu = {nu}, Pi = {Pi} is refused: the printed form covers Pi < nu without resonance only"
        )
    return Symbols(nu, Pi, nu0, chi, float(np.sqrt(nu**2 - Pi**2)))


# --- equation (5) ---


def free_part(kappa: ArrayLike, C: Pair, s: Symbols) -> tuple[Array, Array]:
    """exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa) and its derivative, the solution of (4) less R.

    Args:
        kappa: from the beginning of the phase, shape (n,). C: constants (C1, C2). s: abbreviations.

    Returns:
        Two arrays of shape (n,), without unit.
    """
    time = np.asarray(kappa, dtype=np.float64)
    fading = np.exp(-s.Pi * time)
    sine, cosine = np.sin(s.nu1 * time), np.cos(s.nu1 * time)
    swing = C[0] * sine + C[1] * cosine
    return fading * swing, fading * (s.nu1 * (C[0] * cosine - C[1] * sine) - s.Pi * swing)


def free_acceleration(kappa: ArrayLike, C: Pair, s: Symbols) -> Array:
    """Equation (5) without R''.

    Args:
        kappa: from the beginning of the phase, shape (n,). C: constants (C1, C2). s: abbreviations.

    Returns:
        Shape (n,), without unit.
    """
    time = np.asarray(kappa, dtype=np.float64)
    sine, cosine = np.sin(s.nu1 * time), np.cos(s.nu1 * time)
    swing = (C[0] * sine + C[1] * cosine) * (s.Pi**2 - s.nu1**2)
    result: Array = np.exp(-s.Pi * time) * (swing - 2.0 * s.Pi * s.nu1 * (C[0] * cosine - C[1] * sine))
    return result


def particular_acceleration(kappa: ArrayLike, s: Symbols) -> Array:
    """R'' of phase I, and with the sign turned of phase III: with the printed 4 pi^2 Pi.

    Args:
        kappa: from the beginning of the phase, shape (n,). s: abbreviations.

    Returns:
        Shape (n,), without unit.
    """
    angle = 2.0 * np.pi * np.asarray(kappa, dtype=np.float64)
    result: Array = (
        2.0 * np.pi * s.nu0 / s.chi * (s.nu0 * np.sin(angle) - 4.0 * np.pi**2 * s.Pi * np.cos(angle))
    )
    return result


# --- the constants, phase by phase ---


def constants_1(s: Symbols) -> Pair:
    """C1, C2 of phase I from R0 = 2 Pi (nu0/chi - 1/nu^2) and R0' = 1 - nu0^2/chi."""
    R0 = 2.0 * s.Pi * (s.nu0 / s.chi - 1.0 / s.nu**2)
    R0_rate = 1.0 - s.nu0**2 / s.chi
    return -(R0_rate + s.Pi * R0) / s.nu1, -R0


def constants_2(s: Symbols, C: Pair) -> Pair:
    """C1, C2 of phase II from a and a' at the end of phase I; C: constants of phase I."""
    free, free_rate = free_part(HALF, C, s)
    a = float(free) + 0.5 - 2.0 * s.Pi * (s.nu0 / s.chi + 1.0 / s.nu**2)
    a_rate = float(free_rate) + 1.0 + s.nu0**2 / s.chi
    C2 = a + 4.0 * s.Pi / s.nu**2 - 0.5
    return (s.Pi * C2 + a_rate - 2.0) / s.nu1, C2


def constants_3(s: Symbols, C: Pair, kappa2: float, B: float = B_DEFAULT) -> Pair:
    """C1, C2 of phase III from a and a' at the end of phase II, the bracket of C1 as printed.

    Args:
        s: abbreviations. C: constants of phase II. kappa2: length of phase II. B: not defined on the page.
    """
    free, free_rate = free_part(kappa2, C, s)
    a = float(free) + 0.5 - 4.0 * s.Pi / s.nu**2 + 2.0 * kappa2
    a_rate = float(free_rate) + 2.0
    R0 = 0.5 + B * kappa2 - 2.0 * s.Pi * (1.0 / s.nu**2 + s.nu0 / s.chi)
    R0_rate = 1.0 + s.nu0**2 / s.chi
    return (a_rate + s.Pi * (a - R0)) / s.nu1 - R0_rate, a - R0


def constants_4(s: Symbols, C: Pair, kappa2: float) -> Pair:
    """C1, C2 of phase IV from a and a' at the end of phase III; C: constants of phase III."""
    free, free_rate = free_part(HALF, C, s)
    a = float(free) + 1.0 + 2.0 * kappa2 - 2.0 * s.Pi * (1.0 / s.nu**2 - s.nu0 / s.chi)
    a_rate = float(free_rate) + 1.0 - s.nu0**2 / s.chi
    C2 = a - 1.0 - 2.0 * kappa2
    return (a_rate + s.Pi * C2) / s.nu1, C2


def constants(criteria: Criteria, kappa2: float, B: float = B_DEFAULT) -> list[Pair]:
    """C1, C2 of phases I to IV, each from those before as the page has it.

    Raises:
        ValueError: see symbols.
    """
    s = symbols(criteria)
    first = constants_1(s)
    second = constants_2(s, first)
    third = constants_3(s, second, kappa2, B)
    return [first, second, third, constants_4(s, third, kappa2)]


def acceleration(kappa: ArrayLike, criteria: Criteria, kappa2: float, B: float = B_DEFAULT) -> Array:
    """Invariant a'' of the driven mass with the balancer, equation (5) with everything printed below it.

    Args:
        kappa: relative time, shape (n,), >= 0. criteria: nu and Pi. kappa2: length of phase II.
        B: not defined on the page.

    Returns:
        Shape (n,), without unit.

    Raises:
        ValueError: see symbols.
    """
    s = symbols(criteria)
    time = np.asarray(kappa, dtype=np.float64)
    number = phase_of(time, kappa2)
    local = time - phase_starts(kappa2)[number]
    result = np.zeros_like(time)
    for phase, C in enumerate(constants(criteria, kappa2, B)):
        result = np.where(number == phase, free_acceleration(local, C, s), result)
    sign = np.where(number == 0, 1.0, np.where(number == 2, -1.0, 0.0))
    return result + sign * particular_acceleration(local, s)
