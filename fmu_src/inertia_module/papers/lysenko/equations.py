"""The numbered equations of Lysenko over a cycle of the example mechanism: printed form, exact form.

Each printed form is fed with exact values of all it takes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..report import Equations
from . import exact, motion
from .as_printed import Printed
from .mechanism import EXAMPLE as M
from .mechanism import EXAMPLE_SPEED as W

# even: the cycle is met at 0 and pi, where the quadrants of arcsin change
ALPHA = np.linspace(0.0, 2.0 * np.pi, 3601)
# between the cusps, where the speed is 0 and the page divides by it
INSIDE = ALPHA[1:-1]
FASTEST = W * motion.speed_ratio(M)

RIGHT: dict[str, Any] = {
    "rho": exact.rho(M, INSIDE),
    "F1": exact.relative_force(M, W),
    "F2": exact.carrier_force(M, INSIDE, W),
    "Fk": exact.coriolis_force(M, W),
    "V": exact.speed(M, INSIDE, W),
    "beta1": exact.beta1(M, INSIDE),
    "n1": exact.n1(M, INSIDE),
    "n2": exact.n2(M, INSIDE),
    "delta": exact.delta(M, INSIDE),
    "k1": 0.0 * INSIDE,
    "k2": exact.n1(M, INSIDE),
    "M1": exact.wheel_moment(M, INSIDE, W),
    "M": exact.carrier_moment(M, INSIDE, W),
    "omega_max": FASTEST,
    "T1": motion.kinetic_energy(M, np.pi, W / M.b),
}
ALONG, ACROSS = exact.position(M, INSIDE)
INERTIA = M.constant_inertia + M.m * np.hypot(*exact.position(M, ALPHA)) ** 2


def alone(*names: str) -> Any:
    """The first quantity as printed, of exact values of all it takes but the further ones."""
    return getattr(Printed(M, INSIDE, W, **{k: v for k, v in RIGHT.items() if k not in names}), names[0])


def _in_frame() -> tuple[Any, Any]:
    """S in the fixed frame by turning it with the carrier."""
    place = (ALONG + 1j * ACROSS) * np.exp(1j * M.b * INSIDE)
    return place.real, place.imag


EQUATIONS: Equations = {
    "(1)": lambda: (alone("epicycloid"), _in_frame()),
    "(2)": lambda: (alone("rho"), np.hypot(ALONG, ACROSS)),
    "(2), note": lambda: (alone("rho_of_note"), RIGHT["rho"]),
    # centripetal, on the circle about O1
    "(3)": lambda: (alone("F1"), M.m * W**2 * np.hypot(ALONG - M.centre_distance, ACROSS)),
    "(4)": lambda: (alone("F2"), RIGHT["F2"]),
    "(5)": lambda: (alone("Fk"), RIGHT["Fk"]),
    "(6)": lambda: (alone("resultant"), RIGHT["V"]),
    "(7)": lambda: (alone("V"), RIGHT["V"]),
    "(8)": lambda: (alone("beta1"), RIGHT["beta1"]),
    "(9)": lambda: (alone("M1_of_forces"), RIGHT["M1"]),
    "(10)": lambda: (alone("M_of_forces"), RIGHT["M"]),
    "(11)": lambda: (alone("n1"), RIGHT["n1"]),
    "(12)": lambda: (alone("n2"), RIGHT["n2"]),
    "(13)": lambda: (alone("k1", "delta"), RIGHT["k1"], M.arm),
    "(14)": lambda: (alone("k2"), RIGHT["k2"]),
    "(15)": lambda: (alone("M1"), RIGHT["M1"]),
    "(16)": lambda: (alone("M"), RIGHT["M"]),
    "(17)": lambda: (alone("N1"), exact.wheel_power(M, INSIDE, W)),
    "(18)": lambda: (alone("N"), exact.carrier_power(M, INSIDE, W)),
    "(19)": lambda: (alone("J"), INERTIA[1:-1]),
    "(20)": lambda: (alone("J_limits"), INERTIA[[len(ALPHA) // 2, 0]]),
    "(21)": lambda: (alone("omega_max"), FASTEST),
    "(22)": lambda: (alone("T1"), RIGHT["T1"]),
    "(23)": lambda: (alone("T2"), motion.kinetic_energy(M, 0.0, FASTEST / M.b)),
    "(24)": lambda: (alone("T2_of_T1"), RIGHT["T1"]),
}
