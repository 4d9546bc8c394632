"""The exact forms against the chain of rotation matrices and its differences in extended precision."""

import math

import numpy as np
import pytest
from karetin_cases import geometry, random_motion, random_parameters, random_times, reach
from mpmath import mp, mpf
from rigid_chain import DIGITS, STEP, Chain, dot, length, relative_error

from studies.papers.karetin import Geometry, Motion, dynamic_mode, exact, projections, stop_mode
from studies.papers.karetin.exact import turned
from studies.papers.karetin.motion import ONE_RADIAN, angle_turned, exact_rates, transmission_ratios

TIMES = 60
# xOy, yOz, xOz: the coordinates of the planes of H, P and F
PLANES = ((0, 1), (2, 1), (0, 2))


@pytest.fixture(scope="module", params=range(16))
def case(request):
    """A random mechanism at random times: (chain, times, exact set)."""
    rng = np.random.default_rng(request.param)
    p, motion, t = random_parameters(rng), random_motion(rng), random_times(rng, TIMES)
    g = Geometry(**p)
    chain = Chain(p, motion.omega1, motion.omega2, motion.carrier)
    return chain, t, exact(g, motion, t)


def worst_relative_error(values, references):
    return max(relative_error(v, e) for v, e in zip(values, references, strict=True))


def test_position_velocity_and_acceleration_are_those_of_the_chain(case):
    chain, t, k = case
    r, v, a = zip(*(chain.motion(time) for time in t), strict=True)
    assert worst_relative_error(k.position.T, r) < 1e-13
    assert worst_relative_error(k.velocity.T, v) < 1e-11
    assert worst_relative_error(k.acceleration.T, a) < 1e-9


def test_moduli_and_projections_are_lengths_of_the_vectors(case):
    _, _, k = case
    for vector, modulus in (
        (k.position, k.radius),
        (k.about_satellite, k.speed_about_satellite),
        (k.about_drive, k.speed_about_drive),
        (k.about_centre, k.speed_about_centre),
        (k.velocity_in_link1, k.speed_in_link1),
        (k.velocity, k.speed),
        (k.acceleration, k.acceleration_modulus),
    ):
        np.testing.assert_allclose(modulus, np.linalg.norm(vector, axis=0), rtol=1e-15)
    for vector, lengths in ((k.position, k.projections), (k.velocity, k.plane_speeds)):
        expected = np.stack([np.hypot(vector[u], vector[v]) for u, v in PLANES])
        np.testing.assert_allclose(lengths, expected, rtol=1e-15)


def test_angles_and_their_rates_are_those_of_the_chain(case):
    chain, t, k = case
    for n in range(0, TIMES, 5):
        with mp.workdps(DIGITS):
            time = mpf(float(t[n]))
            before, now, after = (chain.position(time + m * STEP) for m in (-1, 0, 1))
            for column, (u, v) in enumerate(PLANES):
                distance = mp.hypot(now[u], now[v])
                # near an axis the direction is known the less, the nearer
                loss = length(now) / distance
                error = k.angles[column, n] - mp.atan2(now[v], now[u])
                error -= 2 * mp.pi * mp.nint(error / (2 * mp.pi))
                assert abs(error) < 1e-14 * loss
                step = mp.atan2(after[v], after[u]) - mp.atan2(before[v], before[u])
                step -= 2 * mp.pi * mp.nint(step / (2 * mp.pi))
                rate = step / (2 * STEP)
                scale = k.plane_speeds[column, n] / distance
                assert abs(k.angular_velocities[column, n] - rate) < 1e-13 * loss * (scale + abs(rate))


def test_feet_are_the_nearest_points_of_the_lines_of_velocity(case):
    chain, t, k = case
    for n in range(0, TIMES, 5):
        r, v, _ = chain.motion(t[n])
        with mp.workdps(DIGITS):
            for column, (u, w) in enumerate(((0, 1), (1, 2), (0, 2))):
                point, way = [r[u], r[w]], [v[u], v[w]]
                along = dot(point, way) / dot(way, way)
                foot = [p - along * q for p, q in zip(point, way, strict=True)]
                tolerance = 1e-14 * length(r) * length(v) / length(way)
                found = k.feet[2 * column : 2 * column + 2, n]
                assert length([mpf(float(f)) - e for f, e in zip(found, foot, strict=True)]) < tolerance
                assert abs(k.arms[column, n] - length(foot)) < tolerance


def test_the_three_velocities_are_turns_about_their_axes(case):
    _, _, k = case
    arm, spin = k.arm_of_imbalance, k.spin_of_satellite
    r = k.position_in_link1
    about = (
        (k.about_satellite, np.cross(spin, arm, axis=0)),
        (k.about_drive, np.cross(k.spin_of_drive, r, axis=0)),
        (k.about_centre, np.cross(k.spin_of_link1, r, axis=0)),
    )
    for found, expected in about:
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14 * np.abs(expected).max())
    total = turned(k, k.about_satellite + k.about_drive + k.about_centre)
    np.testing.assert_allclose(total, k.velocity, rtol=0, atol=1e-15 * k.speed.max())
    np.testing.assert_array_equal(k.velocity_in_link1, k.about_satellite + k.about_drive)


def test_the_arm_of_the_imbalance_is_rigid_and_across_the_axis_of_the_satellite(case):
    _, _, k = case
    g = k.g
    arm, axis = k.arm_of_imbalance, k.centre_of_satellite - [[0.0], [0.0], [g.OQ]]
    np.testing.assert_allclose(np.linalg.norm(arm, axis=0), g.AD, rtol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(axis, axis=0), abs(g.QA), rtol=0, atol=1e-15 * reach(g))
    assert np.abs((arm * axis).sum(axis=0)).max() < 1e-14 * reach(g) ** 2
    np.testing.assert_allclose(
        k.position_in_link1, k.centre_of_satellite + arm, rtol=0, atol=1e-15 * reach(g)
    )


def test_the_pole_of_the_cones_is_at_rest_in_link_1():
    """Rolling: with a = b = c = 1 the imbalance passes through the line on which the cones touch."""
    g = geometry(z17=37, z6=19, shaft_angle=1.1)
    k = exact(g, stop_mode(80.0), np.array([0.0, 2.0 * math.pi * 19 / 37 / 80.0]))
    assert k.speed.max() < 1e-13 * 80.0 * g.L
    # where it touches wheel 17: on the rim
    np.testing.assert_allclose(k.projections[0], g.wheel_radius, rtol=1e-14)


def test_the_half_angles_of_the_cones_share_the_shaft_angle():
    g = geometry(z17=37, z6=19, shaft_angle=1.1)
    assert g.phi + g.psi == pytest.approx(1.1, rel=1e-15)
    assert math.sin(g.psi) / math.sin(g.phi) == pytest.approx(g.s, rel=1e-15)
    assert g.wheel_radius / math.sin(g.psi) == pytest.approx(g.L, rel=1e-15)


def test_transmission_ratios():
    g = geometry(z2=30, z16=20, z17=40, z6=10)
    assert transmission_ratios(g, dynamic_mode(90.0, 3.0)) == (30.0, 90.0, 360.0)
    assert transmission_ratios(g, stop_mode(90.0)) == (0.0, 135.0, 540.0)
    assert transmission_ratios(g, dynamic_mode(90.0, 1.0)) == (90.0, 0.0, 0.0)
    assert dynamic_mode(90.0, math.inf) == Motion(90.0, 0.0, 90.0)


def test_angles_of_long_runs_lose_nothing():
    with mp.workdps(120):
        assert abs(mpf(ONE_RADIAN.numerator) / ONE_RADIAN.denominator - 1 / (2 * mp.pi)) < mpf(2) ** -320
    g = geometry(z17=61, z6=17, epsilon=0.3)
    _, rate = exact_rates(g, stop_mode(123.456))
    t = np.array([0.0, 1e-9, 1.0, 1e6, -1e6, 1e9, 1e12])
    found = angle_turned(rate, g.epsilon, t)
    with mp.workdps(DIGITS):
        for angle, time in zip(found, t, strict=True):
            right = mpf(rate.numerator) / rate.denominator * mpf(float(time)) + mpf(g.epsilon)
            turns = (mpf(float(angle)) - right) / (2 * mp.pi)
            assert abs(turns - mp.nint(turns)) * 2 * mp.pi < 2e-15


def test_arrays_are_vectorised_over_time():
    g, motion = geometry(), dynamic_mode(100.0, 3.0)
    t = np.linspace(0.0, 1.0, 2007)
    k = exact(g, motion, t)
    assert k.position.shape == k.angles.shape == k.arms.shape == (3, len(t))
    assert k.feet.shape == (6, len(t))
    assert k.speed.shape == (len(t),)
    for n in (0, 1000, 2006):
        alone = exact(g, motion, t[n : n + 1])
        np.testing.assert_allclose(k.acceleration[:, n], alone.acceleration[:, 0], rtol=1e-12)
    assert exact(g, motion, []).position.shape == (3, 0)


def test_continuous_angles_have_no_jumps_and_count_turns():
    g, motion = geometry(a=0.5, c=2.0), stop_mode(100.0)
    t = np.linspace(0.0, 0.9 * math.tau / 100.0 * 5, 4001)
    k = exact(g, motion, t)
    beta = np.unwrap(k.angles)
    assert np.abs(np.diff(beta)).max() < 0.1
    assert beta[0, -1] - beta[0, 0] == pytest.approx(0.9 * math.tau * 5, abs=0.6)
    assert np.abs(np.diff(k.angles[0])).max() > 6.0


def test_angular_velocities_are_positive_in_the_sense_of_the_angles():
    """beta_H from Ox to Oy, beta_P from Oz to Oy, beta_F from Ox to Oz."""
    r, further = np.array([[1.0, 1.0, 1.0]]).T, np.array([[1.0, 1.001, 1.0]]).T
    beta = projections.angles(further) - projections.angles(r)
    omega = projections.angular_velocities(r, np.array([[0.0, 1.0, 0.0]]).T).T
    np.testing.assert_array_equal(np.sign(beta).T, [[1.0, 1.0, 0.0]])
    np.testing.assert_array_equal(np.sign(omega), [[1.0, 1.0, 0.0]])
    np.testing.assert_allclose(omega, [[0.5, 0.5, 0.0]])
    np.testing.assert_allclose(
        projections.angular_velocities(r, np.array([[0.0, 0.0, 1.0]]).T).T, [[0, -0.5, 0.5]]
    )
