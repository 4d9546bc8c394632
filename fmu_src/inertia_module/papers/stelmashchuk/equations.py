"""The equations of Stelmashchuk at nu = 8, Pi = 0.5, kappa2 = 1: printed form, exact form.

Each printed form is fed with exact values of all it takes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..report import Equations
from . import as_printed as page
from .criteria import Criteria
from .exact import response
from .law import TWO_PI, phase_starts
from .oscillation import constants

# the case of figure 2 that the text compares; the dwell of the figures is not given
REFERENCE = Criteria(nu=8.0, Pi=0.5)
KAPPA2 = 1.0
RISE = np.linspace(0.0, 0.5, 3001)[:-1]
DWELL = np.linspace(0.0, KAPPA2, 3001)[:-1]
SYMBOLS = page.symbols(REFERENCE)
RIGHT = constants(REFERENCE, KAPPA2)
# of each phase, from the right ones of the phase before
PRINTED = (
    page.constants_1(SYMBOLS),
    page.constants_2(SYMBOLS, RIGHT[0]),
    page.constants_3(SYMBOLS, RIGHT[1], KAPPA2),
    page.constants_4(SYMBOLS, RIGHT[2], KAPPA2),
)


def _law() -> tuple[Any, Any]:
    """The sinusoidal law for which the printed R stand, as the right side of (4), and the left side."""
    nu, Pi = REFERENCE.nu, REFERENCE.Pi
    motion = response(RISE, REFERENCE, KAPPA2)
    sine = np.sin(TWO_PI * RISE)
    right = nu**2 * (RISE - sine / TWO_PI) + TWO_PI * sine
    return right, motion.acceleration + 2.0 * Pi * motion.velocity + nu**2 * motion.angle


EQUATIONS: Equations = {
    "(1)": None,
    "(2)": False,
    "(3)": _law,
    "(4)": _law,
    # in phase II, where R'' is zero
    "(5)": lambda: (
        page.free_acceleration(DWELL, RIGHT[1], SYMBOLS),
        response(phase_starts(KAPPA2)[1] + DWELL, REFERENCE, KAPPA2).acceleration,
    ),
    # what of the exact a'' is not free oscillation
    "R″": lambda: (
        page.particular_acceleration(RISE, SYMBOLS),
        response(RISE, REFERENCE, KAPPA2).acceleration - page.free_acceleration(RISE, RIGHT[0], SYMBOLS),
    ),
    **{
        f"C {number}": lambda phase=phase: (np.array(PRINTED[phase]), np.array(RIGHT[phase]))  # type: ignore[misc]
        for phase, number in enumerate(("I", "II", "III", "IV"))
    },
}
