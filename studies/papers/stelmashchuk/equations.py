"""The equations of Stelmashchuk at nu = 8, Pi = 0.5, kappa2 = 1.

Each printed form is fed with exact values of all it takes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia_module.loops.stepping import PHASES, TWO_PI, phase_starts

from ..report import Equation, compared
from .as_printed import PRINTED, free_acceleration, particular_acceleration, printed
from .criteria import Criteria
from .exact import response
from .oscillation import constants

# the case of figure 2 that the text compares; the dwell of the figures is not given
REFERENCE = Criteria(nu=8.0, Pi=0.5)
KAPPA2 = 1.0
RISE = np.linspace(0.0, 0.5, 3001)[:-1]
DWELL = np.linspace(0.0, KAPPA2, 3001)[:-1]
NAMES = [f"C_{phase}" for phase in PHASES]
# the abbreviations of the page, with the right constants
RIGHT = printed(REFERENCE, KAPPA2).given(**dict(zip(NAMES, constants(REFERENCE, KAPPA2), strict=True)))


def _law() -> tuple[Any, ...]:
    """The sinusoidal law for which the printed R stand, as the right side of (4), and the left side."""
    nu, Pi = REFERENCE.nu, REFERENCE.Pi
    motion = response(RISE, REFERENCE, KAPPA2)
    sine = np.sin(TWO_PI * RISE)
    right = nu**2 * (RISE - sine / TWO_PI) + TWO_PI * sine
    return right, motion.acceleration + 2.0 * Pi * motion.velocity + nu**2 * motion.angle


def _free_acceleration() -> tuple[Any, ...]:
    """In phase II, where R'' is zero."""
    exact = response(phase_starts(KAPPA2)[1] + DWELL, REFERENCE, KAPPA2)
    return free_acceleration(RIGHT, DWELL, RIGHT.C_II), exact.acceleration


def _particular_acceleration() -> tuple[Any, ...]:
    """What of the exact a'' is not free oscillation."""
    exact = response(RISE, REFERENCE, KAPPA2).acceleration - free_acceleration(RIGHT, RISE, RIGHT.C_I)
    return particular_acceleration(RIGHT, RISE), exact


EQUATIONS = {
    "(1)": Equation(verdict="not known"),
    "(2)": Equation(verdict="wrong"),
    "(3)": Equation("law_of_motion", _law),
    "(4)": Equation("law_of_motion", _law),
    "(5)": Equation("free_acceleration", _free_acceleration),
    "R″": Equation("particular_acceleration", _particular_acceleration),
    **{f"C {phase}": compared(f"C_{phase}", PRINTED, RIGHT) for phase in PHASES},
}
