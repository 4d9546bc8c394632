"""The equations of Stelmashchuk as printed, errors kept, judged at nu = 8, Pi = 0.5, kappa2 = 1.

The page calls v what is nu here. It does not say what nu0, chi and nu1 are; the names below reproduce
every printed R. Errors kept: 4 pi^2 Pi in R'' (should be 4 pi Pi), the bracket in C1 of phase III
(R0' belongs inside), B of phase III, which is not defined (2 is right). Only Pi < nu is covered, and no
resonance without friction.

kappa: from the beginning of a phase, numbers or arrays of shape (n,), as the results, all without unit;
C: constants (C1, C2) of a phase.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia_module.loops.stepping import PHASES, TWO_PI, phase_of, phase_starts

from ..forms import Forms, Row, tables
from ..report import Equation, compared
from .exact import Criteria, constants, response

Pair = tuple[Any, Any]


def printed(criteria: Criteria, kappa2: float, **known: Any) -> Forms:
    """Abbreviations and constants of the page, each fed with the printed ones before it.

    Args:
        criteria: nu and Pi. kappa2: length of phase II. known: quantities in place of the printed; B is not
            defined on the page: the velocity of phase II, 2, makes a continuous.
    """
    return Forms(PRINTED, **{"nu": criteria.nu, "Pi": criteria.Pi, "kappa2": kappa2, "B": 2.0} | known)


def free_part(kappa: Any, C: Pair, nu1: float, Pi: float) -> Pair:
    """exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa), the solution of (4) less R, and its derivative."""
    fading, sine, cosine = np.exp(-Pi * kappa), np.sin(nu1 * kappa), np.cos(nu1 * kappa)
    swing = C[0] * sine + C[1] * cosine
    return fading * swing, fading * (nu1 * (C[0] * cosine - C[1] * sine) - Pi * swing)


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


# R at the beginning of a phase and a at the end, with their rates; C1 and C2 from those of the phase before
ROWS = (
    Row("", "nu0", "nu**2 - 4 * pi**2"),
    Row("", "chi", "nu0**2 + (4 * pi * Pi) ** 2"),
    Row("", "nu1", "sqrt(nu**2 - Pi**2)"),
    Row("", "R_I, R_I_rate", "2 * Pi * (nu0 / chi - 1 / nu**2), 1 - nu0**2 / chi"),
    Row("C I", "C_I", "-(R_I_rate + Pi * R_I) / nu1, -R_I"),
    Row("", "free_I, free_I_rate", "free_part(0.5, C_I, nu1, Pi)"),
    Row("", "a_I", "free_I + 0.5 - 2 * Pi * (nu0 / chi + 1 / nu**2)"),
    Row("", "a_I_rate", "free_I_rate + 1 + nu0**2 / chi"),
    Row("", "C2_II", "a_I + 4 * Pi / nu**2 - 0.5"),
    Row("C II", "C_II", "(Pi * C2_II + a_I_rate - 2) / nu1, C2_II"),
    Row("", "free_II, free_II_rate", "free_part(kappa2, C_II, nu1, Pi)"),
    Row("", "a_II, a_II_rate", "free_II + 0.5 - 4 * Pi / nu**2 + 2 * kappa2, free_II_rate + 2"),
    Row("", "R_III", "0.5 + B * kappa2 - 2 * Pi * (1 / nu**2 + nu0 / chi)"),
    Row("", "R_III_rate", "1 + nu0**2 / chi"),
    # the bracket closes too early
    Row("C III", "C_III", "(a_II_rate + Pi * (a_II - R_III)) / nu1 - R_III_rate, a_II - R_III"),
    Row("", "free_III, free_III_rate", "free_part(0.5, C_III, nu1, Pi)"),
    Row("", "a_III", "free_III + 1 + 2 * kappa2 - 2 * Pi * (1 / nu**2 - nu0 / chi)"),
    Row("", "a_III_rate", "free_III_rate + 1 - nu0**2 / chi"),
    Row("", "C2_IV", "a_III - 1 - 2 * kappa2"),
    Row("C IV", "C_IV", "(a_III_rate + Pi * C2_IV) / nu1, C2_IV"),
)
PRINTED, _ = tables(ROWS, free_part)

# the case of figure 2 that the text compares; the dwell of the figures is not given
REFERENCE = Criteria(nu=8.0, Pi=0.5)
KAPPA2 = 1.0
RISE = np.linspace(0.0, 0.5, 3001)[:-1]
DWELL = np.linspace(0.0, KAPPA2, 3001)[:-1]
# the abbreviations of the page, with the right constants
CONSTANTS = dict(zip([f"C_{phase}" for phase in PHASES], constants(REFERENCE, KAPPA2), strict=True))
RIGHT = printed(REFERENCE, KAPPA2, **CONSTANTS)
RISING = response(RISE, REFERENCE, KAPPA2)
IN_DWELL = response(phase_starts(KAPPA2)[1] + DWELL, REFERENCE, KAPPA2)
# the sinusoidal law for which the printed R stand, as the right side of (4), and the left side
SINE = np.sin(TWO_PI * RISE)
LAW = REFERENCE.nu**2 * (RISE - SINE / TWO_PI) + TWO_PI * SINE
LEFT = RISING.acceleration + 2.0 * REFERENCE.Pi * RISING.velocity + REFERENCE.nu**2 * RISING.angle
# R'' is zero in phase II; in phase I it is what of a'' is not free oscillation
FREE = free_acceleration(RIGHT, DWELL, RIGHT.C_II)
R2 = RISING.acceleration - free_acceleration(RIGHT, RISE, RIGHT.C_I)

EQUATIONS = {
    "(1)": Equation(verdict="not known"),
    "(2)": Equation(verdict="wrong"),
    "(3)": Equation("law_of_motion", lambda: (LAW, LEFT)),
    "(4)": Equation("law_of_motion", lambda: (LAW, LEFT)),
    "(5)": Equation("free_acceleration", lambda: (FREE, IN_DWELL.acceleration)),
    "R″": Equation("particular_acceleration", lambda: (particular_acceleration(RIGHT, RISE), R2)),
    **{f"C {phase}": compared(f"C_{phase}", PRINTED, RIGHT) for phase in PHASES},
}
