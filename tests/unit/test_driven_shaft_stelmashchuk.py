"""Driven by Stelmashchuk's law of motion, DrivenShaft gives the closed form of his mechanism.

In relative time kappa = t/T: nu^2 = c T^2/J4, 2 Pi = f T/J4, no relative damping. The speed of the hub is
sent at the communication points and goes on linearly between them, so the error falls with the square
of the step.
"""

import numpy as np
import pytest

from inertia_module.loops.stepping import law_of_motion
from inertia_module.memory import DrivenShaft
from studies.papers.stelmashchuk.exact import Criteria, response

KAPPA2 = 1.0
END = 2.75  # rise, dwell, fall, and three quarters of a unit at rest
T = 0.2  # s
PHI = 0.5  # rad that a = 1 stands for
J4 = 0.3
CASES = {
    "underdamped": Criteria(8.0, 0.5),
    "hardly damped": Criteria(8.0, 1e-4),
    "resonance": Criteria(2.0 * np.pi, 0.2),
    "critical": Criteria(8.0, 8.0),
    "overdamped": Criteria(8.0, 30.0),
    "stiff": Criteria(100.0, 0.5),
}


def errors(criteria, beta, steps):
    """Largest errors of twist, speed and acceleration of the driven mass over the run, as invariants."""
    h = END * T / steps
    shaft = DrivenShaft("compiled").start(
        driven_inertia=J4,
        shaft_stiffness=criteria.nu**2 * J4 / T**2,
        shaft_damping=0.0,
        driven_friction=2.0 * criteria.Pi * J4 / T,
        balancer=beta,
        input_hold=1,
    )
    kappa = np.linspace(0.0, END, steps + 1)
    found = []
    for speed in law_of_motion(kappa[:-1], KAPPA2)[1] * PHI / T:
        shaft.set(hub_speed=float(speed))
        shaft.advance(h)
        found.append(
            (shaft["twist"] / PHI, shaft["omega_out"] * T / PHI, shaft["driven_acceleration"] * T**2 / PHI)
        )
    exact = response(kappa[1:], criteria, KAPPA2, beta)
    right = np.column_stack((-exact.twist, exact.velocity, exact.acceleration))
    scale = np.abs(right).max(axis=0)
    return np.abs(np.array(found) - right).max(axis=0) / np.where(scale > 0.0, scale, 1.0)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("beta", [0.0, 1.0])
def test_closed_form_is_met_with_the_square_of_the_step(name, beta):
    criteria = CASES[name]
    coarse, fine = (errors(criteria, beta, steps) for steps in (2000, 8000))
    # the balancer pushes with the slope of the step before: its acceleration is right to first order
    order = np.log(coarse / fine) / np.log(4.0)
    assert order[:2] == pytest.approx(2.0, abs=0.1)
    assert order[2] == pytest.approx(2.0 if beta == 0.0 else 1.0, abs=0.1)
    assert fine[:2].max() < 1e-4
    assert fine[2] < (1e-4 if beta == 0.0 else 2e-2)


def test_balancer_without_friction_leaves_no_twist():
    """a = a_k, the paper's ideal: what is left is the line the hub's speed is taken for."""
    assert np.abs(errors(Criteria(8.0, 0.0), 1.0, 8000)[1]) < 1e-5
