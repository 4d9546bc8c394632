"""Every equation of the paper with the verdict on it. Differences at nu = 8, Pi = 0.5, kappa2 = 1."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..report import Equation
from . import as_printed
from .criteria import Criteria
from .exact import response
from .law import TWO_PI, phase_starts
from .oscillation import constants

Array = NDArray[np.float64]

# the case of figure 2 the text compares; the dwell of the figures is not given
CRITERIA = Criteria(nu=8.0, Pi=0.5)
KAPPA2 = 1.0
POINTS = 3001


def period() -> Array:
    """Times over phases I to IV, kappa from 0 to 3, shape (3001,)."""
    return np.linspace(0.0, 3.0, POINTS)


def _relative(printed: Array, exact: Array) -> float:
    return float(np.abs(printed - exact).max() / np.abs(exact).max())


def acceleration_difference() -> float:
    """Everything printed together against exact."""
    kappa = period()
    return _relative(
        as_printed.acceleration(kappa, CRITERIA, KAPPA2), response(kappa, CRITERIA, KAPPA2).acceleration
    )


def free_acceleration_difference() -> float:
    """Equation (5) itself, in phase II, where R'' is zero, with the constants put right."""
    local = np.linspace(0.0, KAPPA2, POINTS)[:-1]
    s = as_printed.symbols(CRITERIA)
    printed = as_printed.free_acceleration(local, constants(CRITERIA, KAPPA2)[1], s)
    return _relative(printed, response(phase_starts(KAPPA2)[1] + local, CRITERIA, KAPPA2).acceleration)


def particular_difference() -> float:
    """R'' of phase I: what of the exact a'' is not free oscillation."""
    kappa = np.linspace(0.0, 0.5, POINTS)[:-1]
    s = as_printed.symbols(CRITERIA)
    free = as_printed.free_acceleration(kappa, constants(CRITERIA, KAPPA2)[0], s)
    exact = response(kappa, CRITERIA, KAPPA2).acceleration - free
    return _relative(as_printed.particular_acceleration(kappa, s), exact)


def constants_difference(phase: int) -> float:
    """C1 and C2 of a phase, 0 to 3, made from right constants of the phase before."""
    s = as_printed.symbols(CRITERIA)
    right = constants(CRITERIA, KAPPA2)
    printed = (
        as_printed.constants_1(s),
        as_printed.constants_2(s, right[0]),
        as_printed.constants_3(s, right[1], KAPPA2),
        as_printed.constants_4(s, right[2], KAPPA2),
    )
    return _relative(np.array(printed[phase]), np.array(right[phase]))


def law_difference() -> float:
    """The acceleration 2 pi sin 2 pi kappa the printed R stand for, from what (4) makes of them."""
    kappa = np.linspace(0.0, 0.5, POINTS)[:-1]
    nu, Pi = CRITERIA.nu, CRITERIA.Pi
    motion = response(kappa, CRITERIA, KAPPA2)
    left = motion.acceleration + 2.0 * Pi * motion.velocity + nu**2 * motion.angle
    sine = np.sin(TWO_PI * kappa)
    return _relative(nu**2 * (kappa - sine / TWO_PI) + TWO_PI * sine, left)


EQUATIONS = (
    Equation("(1)", "not known", "", "", right=None, correction="on the first page, which is missing"),
    Equation(
        "(2)",
        "torque of the balancer",
        "criteria.balancing_torque",
        "",
        right=False,
        correction="d²ψ/dt² for dψ/dt² (as scanned)",
    ),
    Equation(
        "(3)",
        "motion of the driven mass in relative time",
        "exact.response",
        "",
        right=True,
        correction="the last term c_κ (as scanned) is to be read as a_κ″: nothing else gives the printed R",
        difference=law_difference,
    ),
    Equation(
        "(4)",
        "the same for the sinusoidal law",
        "exact.response, law.law_of_motion",
        "",
        right=True,
        correction="reads like (3); the law itself is on the missing page",
        difference=law_difference,
    ),
    Equation(
        "(5)",
        "acceleration invariant a″",
        "exact.response",
        "as_printed.free_acceleration",
        right=True,
        correction="for Π < ν only; ν1 = √(ν² − Π²), not defined on the page",
        difference=free_acceleration_difference,
    ),
    Equation(
        "R″ of phases I and III",
        "second derivative of the particular solution",
        "exact.response",
        "as_printed.particular_acceleration",
        right=False,
        correction="4πΠ for 4π²Π",
        difference=particular_difference,
    ),
    Equation(
        "C1, C2 of phase I",
        "constants, with R0 and R0′",
        "oscillation.constants",
        "as_printed.constants_1",
        right=True,
        difference=lambda: constants_difference(0),
    ),
    Equation(
        "C1, C2 of phase II",
        "constants, with the state at κ1 = 0.5",
        "oscillation.constants",
        "as_printed.constants_2",
        right=True,
        difference=lambda: constants_difference(1),
    ),
    Equation(
        "C1, C2 of phase III",
        "constants, with the state at κ2",
        "oscillation.constants",
        "as_printed.constants_3",
        right=False,
        correction="C1 = (a′ − R0′ + Π(a − R0))/ν1: R0′ belongs inside the bracket; B, not defined, is 2",
        difference=lambda: constants_difference(2),
    ),
    Equation(
        "C1, C2 of phase IV",
        "constants, with the state at κ3 = 0.5",
        "oscillation.constants",
        "as_printed.constants_4",
        right=True,
        difference=lambda: constants_difference(3),
    ),
    Equation(
        "(5) with all below it",
        "a″ through the four phases",
        "exact.response",
        "as_printed.acceleration",
        right=False,
        correction="R″ and C1 of phase III as above; Π ≥ ν and resonance are not covered",
        difference=acceleration_difference,
    ),
)
