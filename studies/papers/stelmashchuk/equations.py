"""The equations of Stelmashchuk at nu = 8, Pi = 0.5, kappa2 = 1.

Each printed form is fed with exact values of all it takes.
"""

from __future__ import annotations

import numpy as np

from inertia_module.loops.stepping import PHASES, TWO_PI, phase_starts

from ..report import Equation, compared
from .as_printed import PRINTED, free_acceleration, particular_acceleration, printed
from .exact import Criteria, constants, response

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
