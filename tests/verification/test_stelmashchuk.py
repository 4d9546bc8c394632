"""Test Stelmashchuk's closed form with his equation 3, and the law of motion of the driving wheel.

tests/unit/test_paper_scenes.py compares the driven shaft of the FMU with it.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from papers import stelmashchuk
from papers.stelmashchuk import TWO_PI, Criteria, constants, free_oscillation, law_of_motion, response

# (nu, Pi): under-, critically and overdamped, near critical damping and resonance, soft and stiff
REGIMES = [
    (4.4, 0.0),
    (8.0, 0.5),
    (100.0, 0.5),
    (4.4, 5.0),
    (8.0, 8.0),
    (8.0, 8.0 * (1 - 1e-12)),
    (8.0, 8.0 * (1 + 1e-9)),
    (TWO_PI, 0.0),
    (TWO_PI * (1 + 1e-9), 0.0),
    (TWO_PI, 1e-7),
    (0.1, 0.0),
    (0.1, 0.1),
    (0.1, 50.0),
    (1e6, 0.5),
]


def law_by_phase(kappa, kappa2):
    """Return angle, velocity and acceleration of the driving wheel by the text of the paper."""
    if kappa < 0.5:
        angle = TWO_PI * kappa
        return kappa - math.sin(angle) / TWO_PI, 1 - math.cos(angle), TWO_PI * math.sin(angle)
    kappa -= 0.5
    if kappa < kappa2:
        return 0.5 + 2 * kappa, 2.0, 0.0
    kappa -= kappa2
    if kappa < 0.5:
        angle = TWO_PI * kappa
        turned = 0.5 + 2 * kappa2 + kappa + math.sin(angle) / TWO_PI
        return turned, 1 + math.cos(angle), -TWO_PI * math.sin(angle)
    return 1 + 2 * kappa2, 0.0, 0.0


# --- equation 3 from rest, by phases ---


@pytest.mark.parametrize("beta", [0.0, 1.0, 0.6])
@pytest.mark.parametrize("nu, Pi", REGIMES)
def test_closed_form_is_continuous_and_satisfies_equation_3(nu, Pi, beta):
    edges = stelmashchuk.phase_starts(0.6)[1:]
    before, after = (
        response(times, Criteria(nu, Pi), 0.6, beta) for times in (np.nextafter(edges, 0.0), edges)
    )
    # within one rounding unit of kappa, a' changes by up to nu^2 eps and a'' by up to nu^3 eps of the
    # oscillation
    for name, bound in (
        ("angle", 1e-14),
        ("velocity", 1e-13),
        ("acceleration", 1e-12 * (1 + Pi) + 1e-15 * nu),
    ):
        assert getattr(before, name) == pytest.approx(getattr(after, name), abs=bound)
    # with and without a dwell
    kappa = np.linspace(0.0, 3.0, 301)
    for kappa2 in (0.8, 0.0):
        motion, driving = response(kappa, Criteria(nu, Pi), kappa2, beta), law_of_motion(kappa, kappa2)
        left = motion.acceleration + 2 * Pi * motion.velocity + nu**2 * motion.twist
        assert left == pytest.approx(beta * driving[2], abs=1e-12 * (1 + Pi + nu * 1e-2))
        assert motion.angle - motion.twist == pytest.approx(driving[0], abs=1e-15)


def test_amplitude_is_the_start_of_the_envelope():
    criteria, kappa2 = Criteria(8.0, 0.5), 1.0
    (C1, C2), (amplitude, _) = constants(criteria, kappa2)[1], free_oscillation(criteria, kappa2)
    assert amplitude == pytest.approx(64.0 * math.hypot(C1, C2), rel=1e-13)
    local = np.linspace(0.0, kappa2, 500, endpoint=False)
    swing = np.abs(response(0.5 + local, criteria, kappa2).acceleration) * np.exp(0.5 * local)
    assert swing.max() <= amplitude * (1 + 1e-12)
    assert swing.max() == pytest.approx(amplitude, rel=1e-3)


def test_response_is_zero_before_the_start_with_the_shape_of_the_times():
    for times in (np.array([[-3.0, -1e-9, 0.0]]), np.array(-1.0), np.array([])):
        for values in response(times, Criteria(8.0, 0.5), 1.0):
            assert values.shape == times.shape
            assert (values == 0.0).all()


@given(st.floats(0.0, 3.0), st.floats(0.0, 2.0))
def test_law_of_motion_agrees_with_the_phases(kappa, kappa2):
    motion = [float(values) for values in law_of_motion(kappa, kappa2)]
    assert motion == pytest.approx(law_by_phase(kappa, kappa2), abs=1e-13)
    # a boundary belongs to the later phase
    assert stelmashchuk.phase_of([-1.0, 0.0, 0.5, 1.2, 1.5, 2.0, 9.0], 1.0).tolist() == [0, 0, 1, 1, 2, 3, 3]
