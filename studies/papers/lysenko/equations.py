"""The numbered equations of Lysenko over a cycle of the example mechanism."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..report import Equation, compared
from .as_printed import PRINTED
from .exact import exact
from .mechanism import EXAMPLE as M
from .mechanism import EXAMPLE_SPEED as W

# even: the cycle is met at 0 and pi, where the quadrants of arcsin change
ALPHA = np.linspace(0.0, 2.0 * np.pi, 3601)
# between the cusps, where the speed is 0 and the page divides by it
INSIDE = ALPHA[1:-1]
CYCLE = exact(M, INSIDE, W)


def _arm_of_coriolis_force() -> tuple[Any, ...]:
    """With the printed delta, over l: the exact arm is 0."""
    return PRINTED["k1"](CYCLE.given(delta=PRINTED["delta"](CYCLE))), CYCLE.k1, M.arm


NAMES = (
    *("epicycloid", "rho", "F1", "F2", "Fk", "resultant", "V", "beta1", "M1_of_forces", "M_of_forces"),
    *("n1", "n2", "k1", "k2", "M1", "M", "N1", "N", "J", "J_limits", "omega_max", "T1", "T2", "T2_of_T1"),
)
EQUATIONS = {f"({n})": compared(name, PRINTED, CYCLE) for n, name in enumerate(NAMES, 1)} | {
    "(2), note": compared("rho_of_note", PRINTED, CYCLE),
    "(13)": Equation("k1", _arm_of_coriolis_force),
}
