"""The exact forms against the chain of rotation matrices and its differences in extended precision."""

import itertools
import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from karetin_cases import geometry, random_motion, random_parameters, random_times, reach
from mpmath import mp, mpf
from rigid_chain import DIGITS, STEP, Chain, dot, length, relative_error

from studies.papers.karetin import Geometry, Motion, claims, dynamic_mode, exact, stop_mode
from studies.papers.karetin.equations import (
    angles_of,
    angular_velocities_of,
    feet_of,
    turned_x,
)
from studies.papers.karetin.mechanism import DYNAMIC, GENERAL, PAPER, STANDARD, STOP

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
                found = k.feet[column, [u, w], n]
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
    total = turned_x(k.about_satellite + k.about_drive + k.about_centre, k.theta)
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
    for motion, found in (
        (dynamic_mode(90.0, 3.0), (30.0, 90.0, 360.0)),
        (stop_mode(90.0), (0.0, 135.0, 540.0)),
        (dynamic_mode(90.0, 1.0), (90.0, 0.0, 0.0)),
    ):
        assert exact(g, motion, 0.0).speeds == found
    assert dynamic_mode(90.0, math.inf) == Motion(90.0, 0.0, 90.0)


def test_arrays_are_vectorised_over_time():
    g, motion = geometry(), dynamic_mode(100.0, 3.0)
    t = np.linspace(1e-3, 1.0, 2007)
    k = exact(g, motion, t)
    assert k.position.shape == k.angles.shape == k.arms.shape == (3, len(t))
    assert k.feet.shape == (3, 3, len(t))
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
    beta = angles_of(further) - angles_of(r)
    omega = angular_velocities_of(r, np.array([[0.0, 1.0, 0.0]]).T).T
    np.testing.assert_array_equal(np.sign(beta).T, [[1.0, 1.0, 0.0]])
    np.testing.assert_array_equal(np.sign(omega), [[1.0, 1.0, 0.0]])
    np.testing.assert_allclose(omega, [[0.5, 0.5, 0.0]])
    np.testing.assert_allclose(angular_velocities_of(r, np.array([[0.0, 0.0, 1.0]]).T).T, [[0, -0.5, 0.5]])


# --- limits ---

SMALLEST_ANGLE, LARGEST_ANGLE = 1e-6, 3.141591
ANGLES = (SMALLEST_ANGLE, 1e-3, math.pi / 2, 2.0, math.pi - 1e-3, LARGEST_ANGLE)
# equal wheels, needle of a satellite, needle of a wheel, internal satellite
TEETH = ((20, 20), (1_000_000, 1), (1, 1_000_000), (20, 21), (10, 40))
FACTORS = (
    (1.0, 1.0, 1.0),
    (0.0, 1.0, 1.0),
    (1.0, 0.0, 1.0),
    (1.0, 1.0, 0.0),
    (0.0, 0.0, 0.0),
    (1e-300, 1e-9, 1e-160),
)
MOTIONS = {
    "stop": stop_mode(100.0),
    "dynamic": dynamic_mode(100.0, 2.0),
    "link 2 held": dynamic_mode(100.0, math.inf),
    "locked": dynamic_mode(100.0, 1.0),
    "turning back": dynamic_mode(-100.0, -0.5),
    "at rest": stop_mode(0.0),
    "hardly moving": dynamic_mode(1e-300, 2.0),
}
# angles have no rate on an axis, and feet none without a velocity; the coefficients of the page, infinite at
# QA = 0, OQ = 0, x = 0 and V_y = 0, are not needed
NAMES = ("position", "projections", "angles", "velocity_in_link1", "velocity", "plane_speeds", "acceleration")
MOMENTS = np.array([0.0, 1e-300, 1e-9, math.pi / 200.0, math.pi / 100.0, 0.1, 1.0, 1e6, -1e6])


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
@pytest.mark.parametrize("shaft_angle", ANGLES)
def test_everything_is_finite_at_the_limits(shaft_angle, motion):
    for (z17, z6), (a, b, c) in itertools.product(TEETH, FACTORS):
        g = Geometry(z17=z17, z6=z6, shaft_angle=shaft_angle, a=a, b=b, c=c)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            k = exact(g, motion, MOMENTS)
        for name in NAMES:
            assert np.isfinite(getattr(k, name)).all(), (name, g)


@pytest.mark.parametrize("shaft_angle", ANGLES)
@pytest.mark.parametrize("teeth", TEETH)
def test_lengths_are_right_however_flat_or_sharp_the_cones(teeth, shaft_angle):
    p = {
        "z2": 20,
        "z16": 20,
        "z17": teeth[0],
        "z6": teeth[1],
        "shaft_angle": shaft_angle,
        "wheel_radius": 0.1,
    }
    p |= {"a": 1.0, "b": 1.0, "c": 1.0, "epsilon": 0.0, "gamma": 0.0}
    g, chain = Geometry(**p), Chain(p, 1.0, 0.0, 0.0)
    assert relative_error([-g.AD, 0.0, -g.QA, g.OQ], [*chain.place, chain.height]) < 1e-15
    r, _, _ = chain.motion(0.0)
    k = exact(g, stop_mode(1.0), [0.0])
    assert relative_error(k.position[:, 0], r) * float(length(r)) < 1e-15 * reach(g)


def test_close_to_an_axis_the_rate_is_large_but_finite_and_right():
    r = np.array([[1.0, 1e-12, 0.0]]).T
    assert angular_velocities_of(r, np.array([[0.0, 0.0, 1.0]]).T)[1, 0] == pytest.approx(-1e12)


def test_velocity_across_an_axis_has_feet_where_the_printed_slope_is_infinite():
    """V_y = 0, where (27) and (30) divide by 0."""
    foot = feet_of(np.array([[1.0, 2.0, 3.0]]).T, np.array([[3.0, 0.0, 4.0]]).T)[..., 0]
    # in xOz: n = (4, -3)/5, n r = -1
    np.testing.assert_allclose(foot, [[0.0, 2.0, 0.0], [0.0, 2.0, 0.0], [-0.8, 0.0, 0.6]], atol=1e-15)


def test_imbalance_on_the_axis_of_the_satellite_only_turns_with_the_drive():
    k = exact(geometry(a=0.0), stop_mode(100.0), MOMENTS)
    assert (k.about_satellite == 0.0).all()
    np.testing.assert_allclose(k.angular_velocities[0], 100.0, rtol=1e-13)


def test_locked_links_turn_as_one_body():
    g = geometry(epsilon=0.4, gamma=0.3)
    k = exact(g, dynamic_mode(100.0, 1.0), np.linspace(0.0, 1.0, 50))
    assert k.speeds[1:] == (0.0, 0.0)
    np.testing.assert_allclose(k.angular_velocities[1], -100.0, rtol=1e-12)
    np.testing.assert_allclose(k.acceleration_modulus, 1e4 * k.projections[1], rtol=1e-13)


def test_internal_satellites_have_negative_cone_heights():
    g = geometry(z17=10, z6=40, shaft_angle=2.5)
    assert g.phi > math.pi / 2
    assert g.QA < 0.0 < g.OQ
    assert geometry(z17=40, z6=10, shaft_angle=2.5).OQ < 0.0


# --- conclusions ---

# of the search for the best instant
SEARCH = 1e-6


@pytest.mark.parametrize("base", [STANDARD, PAPER, GENERAL], ids=["standard", "paper", "general"])
@pytest.mark.parametrize(("epsilon", "gamma"), [(0.5, 0.0), (0.0, 0.5), (0.5, 0.5)])
def test_conclusion_2_offsets_leave_the_moduli_of_the_stop_mode_symmetric(base, epsilon, gamma):
    g = replace(base, epsilon=epsilon, gamma=gamma)
    assert claims.asymmetry("speed", g, STOP) < SEARCH
    assert claims.asymmetry("acceleration_modulus", g, STOP) < SEARCH


@pytest.mark.parametrize("base", [STANDARD, PAPER, GENERAL], ids=["standard", "paper", "general"])
@pytest.mark.parametrize(("epsilon", "gamma"), [(0.5, 0.0), (0.0, 0.5)], ids=["epsilon", "gamma"])
def test_conclusion_2_either_offset_alone_makes_the_dynamic_mode_asymmetric(base, epsilon, gamma):
    g = replace(base, epsilon=epsilon, gamma=gamma)
    assert claims.asymmetry("speed", g, DYNAMIC) > 0.02
    assert claims.asymmetry("acceleration_modulus", g, DYNAMIC) > 0.02


@pytest.mark.parametrize("epsilon", [0.0, 0.5, 1.7])
def test_conclusion_2_offsets_that_only_shift_time_leave_all_symmetric(epsilon):
    g = replace(PAPER, epsilon=epsilon, gamma=epsilon / PAPER.s)
    assert claims.asymmetry("speed", g, DYNAMIC) < SEARCH
    assert claims.asymmetry("acceleration_modulus", g, DYNAMIC) < SEARCH
    assert claims.asymmetry_of_components(g, STOP) < SEARCH


def test_the_best_mirror_of_a_known_function_is_found():
    """sin t + 0.3 sin 2t has no mirror, cos(t - 1) one at 1 (or 1 + pi)."""
    share, instant = claims.best_mirror(lambda t: 5.0 * np.cos(t - 1.0) + 2.0, math.tau)
    assert share < SEARCH
    assert math.remainder(instant - 1.0, math.pi) == pytest.approx(0.0, abs=1e-5)

    def skewed(t):
        return np.sin(t) + 0.3 * np.sin(2.0 * t)

    assert claims.best_mirror(skewed, math.tau)[0] > 0.1
    assert claims.best_mirror(skewed, math.tau, sign=-1.0)[0] < SEARCH


def test_conclusion_3_the_swing_of_the_stop_mode_and_the_turn_of_the_dynamic_mode():
    turns, amplitudes = claims.swings(PAPER, STOP)
    assert turns.tolist() == [0, 0, 1]
    assert math.degrees(amplitudes[0]) == pytest.approx(45.0, abs=0.01)
    # two turns of link 1 in a period
    assert claims.swings(PAPER, DYNAMIC)[0][0] == -2
    assert claims.swings(GENERAL, DYNAMIC)[0][1] != 0
