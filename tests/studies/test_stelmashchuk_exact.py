"""Stelmashchuk exact against numerical integration and against a propagator in 50 digits."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stelmashchuk_reference import TWO_PI, Propagator, integrated, law_in_words

from inertia_module.loops import stepping as law
from studies.papers.stelmashchuk.exact import Criteria, constants, free_oscillation, response

RESONANCE = Criteria(TWO_PI, 0.0)

# (nu, Pi): under-, critically and overdamped, near to critical and to resonance, soft and stiff
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
regimes = pytest.mark.parametrize("nu, Pi", REGIMES)
balancers = pytest.mark.parametrize("beta", [0.0, 1.0, 0.6])


# --- against independent solutions ---


@pytest.mark.parametrize("kappa2, beta", [(0.0, 1.0), (0.37, 0.0), (1.0, 0.6), (1.0, 1.0), (1.0, 0.0)])
@pytest.mark.parametrize(
    "nu, Pi", [(8.0, 0.5), (4.4, 5.0), (8.0, 8.0), (TWO_PI, 0.0), (30.0, 2.0), (0.1, 1.0)]
)
def test_closed_form_is_what_integration_gives(nu, Pi, kappa2, beta):
    kappa = np.linspace(0.0, 2.5 + kappa2, 36)
    found = response(kappa, Criteria(nu, Pi), kappa2, beta)
    angle, velocity, acceleration = integrated(kappa, nu, Pi, kappa2, beta)
    assert found.angle == pytest.approx(angle, abs=1e-10)
    assert found.velocity == pytest.approx(velocity, abs=1e-10)
    assert found.acceleration == pytest.approx(acceleration, abs=1e-10)


@balancers
@regimes
def test_closed_form_keeps_its_digits_in_every_regime(nu, Pi, beta):
    kappa = np.array([0.03, 0.2, 0.499, 0.5, 0.7, 1.3, 1.5, 1.8, 2.0, 2.3, 4.0])
    found = response(kappa, Criteria(nu, Pi), 1.0, beta)
    _, velocity, acceleration = law.law_of_motion(kappa, 1.0)
    twist, rate, rate2 = np.array([*map(Propagator(nu, Pi, 1, beta), kappa)]).T
    # the twist itself, not only next to the angle: it is 1e-12 of it at nu = 1e6
    assert found.twist == pytest.approx(twist, abs=1e-12 * np.abs(twist).max() + 1e-16 * (nu < 1e3))
    assert found.velocity - velocity == pytest.approx(rate, abs=5e-15 + 1e-12 * np.abs(rate).max())
    assert found.acceleration - acceleration == pytest.approx(rate2, abs=1e-12)


def test_strongly_damped_mass_creeps_with_all_its_digits():
    # time constant 2 Pi / nu^2 = 2e5: the slow root is a difference of nearly equal numbers
    kappa = np.array([1.0, 3e4, 1e5])
    twist, rate, _ = np.array([*map(Propagator(0.1, 1e3, 200000, 1.0), kappa)]).T
    found = response(kappa, Criteria(0.1, 1e3), 2e5)
    assert found.twist == pytest.approx(twist, rel=1e-13)
    assert found.velocity == pytest.approx(2.0 + rate, abs=1e-14)


def test_odefun_agrees_at_the_end_of_phase_1():
    mp.mp.dps = 20
    nu, Pi = mp.mpf(8), mp.mpf("0.5")

    def rates(t, y):
        driving = t - mp.sin(2 * mp.pi * t) / (2 * mp.pi)
        return [y[1], nu**2 * (driving - y[0]) + 2 * mp.pi * mp.sin(2 * mp.pi * t) - 2 * Pi * y[1]]

    angle, velocity = mp.odefun(rates, 0, [0, 0])(mp.mpf("0.5"))
    found = response(0.5, Criteria(8.0, 0.5), 1.0)
    assert float(found.angle) == pytest.approx(float(angle), abs=1e-13)
    assert float(found.velocity) == pytest.approx(float(velocity), abs=1e-13)


# --- behaviour ---


@balancers
@regimes
def test_motion_is_continuous_from_phase_to_phase(nu, Pi, beta):
    edges = law.phase_starts(0.6)[1:]
    before, after = (
        response(times, Criteria(nu, Pi), 0.6, beta) for times in (np.nextafter(edges, 0.0), edges)
    )
    # in one unit of rounding of kappa a' turns by up to nu^2 eps, a'' by nu^3 eps of the free oscillation
    assert before.angle == pytest.approx(after.angle, abs=1e-14)
    assert before.velocity == pytest.approx(after.velocity, abs=1e-13)
    assert before.acceleration == pytest.approx(after.acceleration, abs=1e-12 * (1 + Pi) + 1e-15 * nu)


@regimes
@balancers
def test_equation_3_is_fulfilled(nu, Pi, beta):
    kappa = np.linspace(0.0, 3.0, 301)
    motion = response(kappa, Criteria(nu, Pi), 0.8, beta)
    _, velocity, acceleration = law.law_of_motion(kappa, 0.8)
    left = motion.acceleration + 2 * Pi * motion.velocity + nu**2 * motion.twist
    assert left == pytest.approx(beta * acceleration, abs=1e-12 * (1 + Pi + nu * 1e-2))
    assert motion.angle - motion.twist == pytest.approx(law.law_of_motion(kappa, 0.8)[0], abs=1e-15)
    assert np.isfinite(velocity).all()


def test_without_friction_the_balanced_mass_follows_exactly():
    kappa = np.linspace(0.0, 4.0, 401)
    for nu in (0.1, 4.4, TWO_PI, 8.0, 1e6):
        motion = response(kappa, Criteria(nu, 0.0), 1.0)
        assert (motion.twist == 0.0).all()
        assert (motion.acceleration == law.law_of_motion(kappa, 1.0)[2]).all()


def test_resonance_without_balancer_and_friction_grows_with_time():
    # a'' + w^2 a = w^2 kappa - w sin(w kappa), solved by hand
    kappa = np.linspace(0.0, 0.5, 51)
    w = TWO_PI
    expected = kappa - 1.5 * np.sin(w * kappa) / w + 0.5 * kappa * np.cos(w * kappa)
    assert response(kappa, RESONANCE, 1.0, 0.0).angle == pytest.approx(expected, abs=1e-15)


def test_stiff_shaft_follows_within_the_quasistatic_twist():
    kappa = np.linspace(0.01, 2.99, 300)
    motion = response(kappa, Criteria(1e6, 0.5), 1.0)
    _, velocity, acceleration = law.law_of_motion(kappa, 1.0)
    assert motion.twist == pytest.approx(-velocity / 1e12, abs=1e-16)
    assert motion.acceleration == pytest.approx(acceleration, abs=1e-9)


def test_response_is_linear_in_the_gain_of_the_balancer():
    kappa = np.linspace(0.0, 4.0, 101)
    without, half, full = (response(kappa, Criteria(5.0, 0.7), 1.2, beta) for beta in (0.0, 0.5, 1.0))
    assert half.acceleration == pytest.approx(0.5 * (without.acceleration + full.acceleration), abs=1e-13)


def test_long_dwell_ends_in_steady_motion():
    motion = response(np.array([1e5, 1e6]), Criteria(8.0, 0.5), 2e6)
    # the friction 2 Pi a' at a' = 2 twists the shaft by 4 Pi / nu^2
    assert motion.twist == pytest.approx([-4 * 0.5 / 64] * 2, rel=1e-14)
    assert motion.velocity == pytest.approx([2.0, 2.0], rel=1e-15)
    assert motion.acceleration == pytest.approx([0.0, 0.0], abs=1e-13)


@given(st.floats(0.2, 200.0), st.floats(0.001, 0.9), st.floats(0.05, 4.0), st.sampled_from([1, 3]))
def test_balancer_lowers_the_free_oscillation_by_nu_over_twice_pi(nu, share, kappa2, phase):
    criteria = Criteria(nu, share * nu)
    with_it, without = (free_oscillation(criteria, kappa2, beta, phase)[0] for beta in (1.0, 0.0))
    assert with_it * nu == pytest.approx(without * 2 * criteria.Pi, rel=1e-6, abs=1e-9)


def test_amplitude_is_that_of_the_envelope():
    criteria, kappa2 = Criteria(8.0, 0.5), 1.0
    (C1, C2), amplitude = constants(criteria, kappa2)[1], free_oscillation(criteria, kappa2)[0]
    assert amplitude == pytest.approx(64.0 * math.hypot(C1, C2), rel=1e-13)
    local = np.linspace(0.0, kappa2, 500, endpoint=False)
    swing = np.abs(response(0.5 + local, criteria, kappa2).acceleration) * np.exp(0.5 * local)
    assert swing.max() <= amplitude * (1 + 1e-12)
    assert swing.max() == pytest.approx(amplitude, rel=1e-3)


def test_before_the_start_everything_rests():
    motion = response(np.array([-3.0, -1e-9, 0.0]), Criteria(8.0, 0.5), 1.0)
    for values in (motion.angle, motion.velocity, motion.acceleration, motion.twist):
        assert (values == 0.0).all()


@pytest.mark.parametrize("shape", [(), (0,), (3,), (2, 3)])
def test_shape_of_the_times_is_kept(shape):
    motion = response(np.full(shape, 0.8), Criteria(8.0, 0.5), 1.0)
    assert motion.angle.shape == motion.velocity.shape == motion.acceleration.shape == shape


@given(st.floats(0.0, 3.0), st.floats(0.0, 2.0))
def test_law_of_motion_is_the_one_of_the_phases(kappa, kappa2):
    found = [float(values) for values in law.law_of_motion(kappa, kappa2)]
    assert found == pytest.approx(law_in_words(kappa, kappa2), abs=1e-13)


def test_boundary_counts_to_the_later_phase():
    assert law.phase_of([-1.0, 0.0, 0.5, 1.2, 1.5, 2.0, 9.0], 1.0).tolist() == [0, 0, 1, 1, 2, 3, 3]


# --- criteria ---


def test_response_in_physical_units_solves_the_driven_shaft():
    # c = 400 N m/rad, J4 = 0.5 kg m2, f = 2 N m s/rad, T = 0.3 s, phi = 0.7 rad, balanced by half
    c, J4, f, T, phi, beta, kappa2 = 400.0, 0.5, 2.0, 0.3, 0.7, 0.5, 1.0
    criteria = Criteria(nu=T * math.sqrt(c / J4), Pi=0.5 * f * T / J4)
    kappa = np.linspace(0.0, 3.0, 60)
    motion = response(kappa, criteria, kappa2, beta)
    driving, _, driving_acceleration = law.law_of_motion(kappa, kappa2)
    shaft = c * phi * (driving - motion.angle)
    balance = beta * J4 * phi / T**2 * driving_acceleration
    friction = f * phi / T * motion.velocity
    assert J4 * phi / T**2 * motion.acceleration == pytest.approx(shaft - friction + balance, abs=1e-10)
