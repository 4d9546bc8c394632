"""The numbered equations of Lysenko over a cycle of the example mechanism: printed form, exact form.

Each printed form is fed with exact values of all it takes.
"""

from __future__ import annotations

import numpy as np

from ..report import Equations
from . import as_printed as page
from . import exact, motion
from .mechanism import EXAMPLE as M
from .mechanism import EXAMPLE_SPEED as W

# even: the cycle is met at 0 and pi, where the quadrants of arcsin change
ALPHA = np.linspace(0.0, 2.0 * np.pi, 3601)
# between them where the page divides by the speed, which is 0 at the cusp
ALPHA_INSIDE = ALPHA[1:-1]

RHO, BETA1, DELTA = (form(M, ALPHA_INSIDE) for form in (exact.rho, exact.beta1, exact.delta))
INSIDE = (M, ALPHA_INSIDE)
ALONG, ACROSS = exact.position(M, ALPHA)
F1, F2, FK = exact.relative_force(M, W), exact.carrier_force(M, ALPHA, W), exact.coriolis_force(M, W)
ARM1, ARM2 = exact.n1(M, ALPHA), exact.n2(M, ALPHA)
MOMENT1, MOMENT = exact.wheel_moment(M, ALPHA, W), exact.carrier_moment(M, ALPHA, W)
FREE = motion.speed_ratio(M)
ENERGY = float(motion.kinetic_energy(M, np.pi, 1.0 / M.b))


def _in_frame() -> tuple[np.ndarray, np.ndarray]:
    """S in the fixed frame by turning it with the carrier."""
    place = (ALONG + 1j * ACROSS) * np.exp(1j * M.b * ALPHA)
    return place.real, place.imag


EQUATIONS: Equations = {
    "(1)": lambda: (page.epicycloid(M, ALPHA), _in_frame()),
    "(2)": lambda: (page.rho(M, ALPHA), exact.rho(M, ALPHA)),
    "(2), note": lambda: (page.rho(M, page.phi_of_note(M, ALPHA)), exact.rho(M, ALPHA)),
    # centripetal, on the circle about O1
    "(3)": lambda: (page.relative_force(M, W), M.m * W**2 * np.hypot(ALONG - M.centre_distance, ACROSS)),
    "(4)": lambda: (page.carrier_force(M, W, exact.rho(M, ALPHA)), F2),
    "(5)": lambda: (page.coriolis_force(M, W, exact.speed(M, ALPHA, W)), FK),
    "(6)": lambda: (page.resultant_speed(M.arm * W, RHO * M.b * W, np.pi - BETA1), exact.speed(*INSIDE, W)),
    "(7)": lambda: (page.speed(M, W, RHO, BETA1), exact.speed(*INSIDE, W)),
    "(8)": lambda: (page.beta1(*INSIDE, RHO), BETA1),
    "(9)": lambda: (page.wheel_moment_of_forces(F2, ARM2, FK, 0.0), MOMENT1),
    "(10)": lambda: (page.carrier_moment_of_forces(F1, ARM1, F2, ARM2, FK, ARM1), MOMENT),
    "(11)": lambda: (page.n1(M, ALPHA), ARM1),
    "(12)": lambda: (page.n2(M, ALPHA, exact.rho(M, ALPHA)), ARM2),
    "(13)": lambda: (page.k1(M, BETA1, page.delta(*INSIDE, RHO, BETA1)), 0.0 * RHO, M.arm),
    "(14)": lambda: (page.k2(*INSIDE, BETA1, DELTA), exact.n1(*INSIDE)),
    "(15)": lambda: (page.wheel_moment(*INSIDE, W, RHO, BETA1, DELTA), exact.wheel_moment(*INSIDE, W)),
    "(16)": lambda: (page.carrier_moment(*INSIDE, W, RHO, BETA1, DELTA), exact.carrier_moment(*INSIDE, W)),
    "(17)": lambda: (page.wheel_power(W, MOMENT1), exact.wheel_power(M, ALPHA, W)),
    "(18)": lambda: (page.carrier_power(M, W, MOMENT), exact.carrier_power(M, ALPHA, W)),
    "(19)": lambda: (
        page.moment_of_inertia(M, exact.rho(M, ALPHA)),
        M.constant_inertia + M.m * (ALONG**2 + ACROSS**2),
    ),
    "(20)": lambda: (
        np.array(page.inertia_limits(M)),
        M.constant_inertia + M.m * (ALONG**2 + ACROSS**2)[[len(ALPHA) // 2, 0]],
    ),
    "(21)": lambda: (page.omega_max(M, 1.0), FREE),
    "(22)": lambda: (page.energy_farthest(M, 1.0), ENERGY),
    "(23)": lambda: (page.energy_nearest(M, FREE), float(motion.kinetic_energy(M, 0.0, FREE / M.b))),
    "(24)": lambda: (page.energy_nearest_of_farthest(M, ENERGY), ENERGY),
}
