"""Karetin's exact forms against a chain of rotation matrices in 50 digits; the module moves as they say.

Nothing of the chain is shared with the code under test: the cones follow from the line on which they roll,
derivatives from positions alone.
"""

import itertools
import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp, mpf
from scenes import advanced, started, vector

from studies.papers import karetin
from studies.papers.karetin import PAPER, PLANES, STANDARD, Geometry, Motion, dynamic_mode, exact, stop_mode

DIGITS = 50
TIMES = 21
# coordinates in which the angles of H, P and F count
SENSES = ((0, 1), (2, 1), (0, 2))
MODULI = {
    "position": "radius",
    "about_satellite": "speed_about_satellite",
    "about_drive": "speed_about_drive",
    "velocity_in_link1": "speed_in_link1",
    "velocity": "speed",
    "acceleration": "acceleration_modulus",
}


def random_parameters(rng):
    teeth = {name: int(rng.integers(8, 90)) for name in ("z2", "z16", "z17", "z6")}
    factors = {name: float(rng.uniform(0.05, 3.0)) for name in "abc"}
    phases = {name: float(rng.uniform(-7.0, 7.0)) for name in ("epsilon", "gamma")}
    sizes = {"shaft_angle": float(rng.uniform(0.1, 3.0)), "wheel_radius": float(rng.uniform(0.01, 1.0))}
    return teeth | factors | phases | sizes


def reach(g):
    """No point of the trajectory is further than this from O, m."""
    return math.hypot(g.across, g.height) + g.AD


def precise(*values):
    return np.array([mpf(float(value)) for value in values])


def length(v):
    return mp.sqrt((v * v).sum())


def turned(axis, angle, v):
    """A vector turned about a coordinate axis."""
    result, (one, other) = v.copy(), ((axis + 1) % 3, (axis + 2) % 3)
    result[one] = mp.cos(angle) * v[one] - mp.sin(angle) * v[other]
    result[other] = mp.sin(angle) * v[one] + mp.cos(angle) * v[other]
    return result


class Chain:
    """Link 1 about Ox, drive about its z axis, satellite about an axis inclined by Sigma, imbalance on it."""

    def __init__(self, g, motion):
        self.s, k = mpf(g.z17) / g.z6, mpf(g.z2) / g.z16
        self.g, self.motion = g, motion
        self.rate = k * (mpf(motion.omega1) - mpf(motion.omega2))
        drive = precise(0, 0, 1)
        satellite = turned(1, -mpf(g.shaft_angle), drive)
        # points of the satellite are at rest in link 1 on the line of the sum of both spins
        line = drive + self.s * satellite
        line = line / length(line)
        cone = g.wheel_radius / length(np.cross(line, drive))
        arm = g.a * cone * length(np.cross(line, satellite))
        self.place = np.array([-arm, mpf(0), -g.b * cone * (line @ satellite)])
        self.height = np.array([mpf(0), mpf(0), g.c * cone * (line @ drive)])

    def position(self, t):
        q = self.rate * t
        r = turned(1, -mpf(self.g.shaft_angle), turned(2, self.s * q + mpf(self.g.epsilon), self.place))
        return turned(0, self.motion.carrier * t, turned(2, q + mpf(self.g.gamma), r) + self.height)

    def motion_at(self, t):
        """(position, velocity, acceleration), and angles with their rates, (3,) each, by differences."""
        # right to 1e-20 at 1e5 rad/s
        step, t = mpf(10) ** -15, mpf(float(t))
        before, now, after = (self.position(t + n * step) for n in (-1, 0, 1))
        angles = [[mp.atan2(r[v], r[u]) for u, v in SENSES] for r in (before, now, after)]
        rates = [nearest(late - early) / (2 * step) for early, _, late in zip(*angles, strict=True)]
        velocity, acceleration = (after - before) / (2 * step), (after - 2 * now + before) / step**2
        return now, velocity, acceleration, angles[1], rates


def nearest(angle):
    """An angle without whole turns."""
    return angle - 2 * mp.pi * mp.nint(angle / (2 * mp.pi))


def relative_error(values, right):
    return float(length(precise(*values) - right) / length(right))


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(DIGITS):
        yield


@pytest.fixture(scope="module", params=range(8))
def case(request):
    """A random mechanism at random times, 0 included: stop mode, dynamic mode, link 2 ahead or back."""
    rng = np.random.default_rng(request.param)
    g, omega1 = Geometry(**random_parameters(rng)), float(rng.uniform(-500.0, 500.0))
    carrier = omega1 if rng.random() < 0.7 else 0.0
    motion = Motion(omega1, float(rng.choice([0.0, rng.uniform(-1.5, 1.5)])) * omega1, carrier)
    t = np.concatenate([[0.0], rng.uniform(-2e-3, 2e-3, TIMES - 1)])
    with mp.workdps(DIGITS):
        return Chain(g, motion), t, exact(g, motion, t)


def test_position_its_rates_its_angles_and_the_feet_are_those_of_the_chain(case):
    chain, t, k = case
    for n in range(TIMES):
        r, v, a, angles, rates = chain.motion_at(t[n])
        assert relative_error(k.position[:, n], r) < 1e-13
        assert relative_error(k.velocity[:, n], v) < 1e-11
        assert relative_error(k.acceleration[:, n], a) < 1e-9
        for column, (one, other) in enumerate(PLANES):
            # near an axis the direction is known the less, the nearer
            place, way = r[[one, other]], v[[one, other]]
            loss, speed = length(r) / length(place), length(way)
            assert abs(nearest(k.angles[column, n] - angles[column])) < 1e-14 * loss
            off = abs(k.angular_velocities[column, n] - rates[column])
            assert off < 1e-13 * loss * (speed / length(place) + abs(rates[column]))
            foot = place - (place @ way) / speed**2 * way
            tolerance = 1e-14 * length(r) * length(v) / speed
            assert length(precise(*k.feet[column, [one, other], n]) - foot) < tolerance
            assert abs(k.arms[column, n] - length(foot)) < tolerance


def test_moduli_and_projections_are_those_of_their_vectors(case):
    _, _, k = case
    for name, modulus in MODULI.items():
        np.testing.assert_allclose(k[modulus], np.linalg.norm(k[name], axis=0), rtol=1e-15)
    for whole, lengths in ((k.position, k.projections), (k.velocity, k.plane_speeds)):
        expected = np.stack([np.hypot(whole[u], whole[v]) for u, v in PLANES])
        np.testing.assert_allclose(lengths, expected, rtol=1e-15)


def test_pole_of_the_cones_is_at_rest_in_link_1_and_half_angles_share_the_shaft_angle():
    """Rolling: with a = b = c = 1 the imbalance passes through the line on which the cones touch."""
    g = Geometry(z17=37, z6=19, shaft_angle=1.1, wheel_radius=1.0)
    k = exact(g, stop_mode(80.0), np.array([0.0, 2.0 * math.pi * 19 / 37 / 80.0]))
    assert k.speed.max() < 1e-13 * 80.0 * g.L
    # where it touches wheel 17: on the rim
    np.testing.assert_allclose(k.projections[0], g.wheel_radius, rtol=1e-14)
    assert g.phi + g.psi == pytest.approx(1.1, rel=1e-15)
    assert math.sin(g.psi) / math.sin(g.phi) == pytest.approx(g.s, rel=1e-15)
    assert g.wheel_radius / math.sin(g.psi) == pytest.approx(g.L, rel=1e-15)


# --- limits ---

ANGLES = (1e-6, 1e-3, math.pi / 2, 2.0, math.pi - 1e-3, 3.141591)
# equal wheels, needle of a satellite, needle of a wheel, internal satellite
TEETH = ((20, 20), (1_000_000, 1), (1, 1_000_000), (20, 21), (10, 40))
FACTORS = ((1, 1, 1), (0, 1, 1), (1, 0, 1), (1, 1, 0), (0, 0, 0), (1e-300, 1e-9, 1e-160))
MOTIONS = (
    *(stop_mode(100.0), dynamic_mode(100.0, 2.0), dynamic_mode(100.0, math.inf), dynamic_mode(100.0, 1.0)),
    *(dynamic_mode(-100.0, -0.5), stop_mode(0.0), dynamic_mode(1e-300, 2.0)),
)
# angles have no rate on an axis, and feet none without a velocity; the coefficients of the page, infinite at
# QA = 0, OQ = 0, x = 0 and V_y = 0, are not needed
NAMES = ("position", "projections", "angles", "velocity_in_link1", "velocity", "plane_speeds", "acceleration")
MOMENTS = np.array([0.0, 1e-300, 1e-9, math.pi / 200.0, math.pi / 100.0, 0.1, 1.0, 1e6, -1e6])


@pytest.mark.parametrize("shaft_angle", ANGLES)
def test_everything_is_finite_at_the_limits_and_lengths_are_right(shaft_angle):
    for (z17, z6), (a, b, c), motion in itertools.product(TEETH, FACTORS, MOTIONS):
        g = Geometry(z17=z17, z6=z6, shaft_angle=shaft_angle, a=float(a), b=float(b), c=float(c))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            k = exact(g, motion, MOMENTS)
        for name in NAMES:
            assert np.isfinite(getattr(k, name)).all(), (name, g)
    for z17, z6 in TEETH:
        g = Geometry(z17=z17, z6=z6, shaft_angle=shaft_angle, wheel_radius=0.1)
        chain = Chain(g, Motion(1.0, 0.0, 0.0))
        right = np.array([*chain.place, chain.height[2]])
        assert relative_error([-g.AD, 0.0, -g.QA, g.OQ], right) < 1e-15
        r, found = chain.position(mpf(0)), exact(g, stop_mode(1.0), [0.0]).position[:, 0]
        assert length(precise(*found) - r) < 1e-15 * reach(g)


def test_near_an_axis_the_rate_is_large_and_feet_exist_where_the_printed_slope_is_infinite():
    r = np.array([[1.0, 1e-12, 0.0]]).T
    assert karetin.angular_velocities_of(r, np.array([[0.0, 0.0, 1.0]]).T)[1, 0] == pytest.approx(-1e12)
    # V_y = 0, where (27) and (30) divide by 0; in xOz: n = (4, -3)/5, n r = -1
    foot = karetin.feet_of(np.array([[1.0, 2.0, 3.0]]).T, np.array([[3.0, 0.0, 4.0]]).T)[..., 0]
    np.testing.assert_allclose(foot, [[0.0, 2.0, 0.0], [0.0, 2.0, 0.0], [-0.8, 0.0, 0.6]], atol=1e-15)


# --- conclusions ---

# of the search for the best instant
SEARCH = 1e-6


def asymmetries(base, motion, **offsets):
    g = replace(base, **offsets)
    return np.array([karetin.asymmetry(name, g, motion) for name in ("speed", "acceleration_modulus")])


@pytest.mark.parametrize("base", [STANDARD, karetin.GENERAL], ids=["standard", "general"])
def test_conclusion_2_offsets_make_the_dynamic_mode_asymmetric_and_leave_the_stop_mode_symmetric(base):
    for epsilon, gamma in ((0.5, 0.0), (0.0, 0.5), (0.5, 0.5)):
        assert (asymmetries(base, karetin.STOP, epsilon=epsilon, gamma=gamma) < SEARCH).all()
        # together they may make up for each other
        if epsilon * gamma == 0.0:
            assert (asymmetries(base, karetin.DYNAMIC, epsilon=epsilon, gamma=gamma) > 0.02).all()


@pytest.mark.parametrize("epsilon", [0.0, 1.7])
def test_conclusion_2_offsets_that_only_shift_time_leave_all_symmetric(epsilon):
    shifted = {"epsilon": epsilon, "gamma": epsilon / PAPER.s}
    assert (asymmetries(PAPER, karetin.DYNAMIC, **shifted) < SEARCH).all()
    assert karetin.asymmetry_of_components(replace(PAPER, **shifted), karetin.STOP) < SEARCH


def test_the_best_mirror_of_a_known_function_is_found():
    """sin t + 0.3 sin 2t has no mirror, cos(t - 1) one at 1 (or 1 + pi)."""
    share, instant = karetin.best_mirror(lambda t: 5.0 * np.cos(t - 1.0) + 2.0, math.tau)
    assert share < SEARCH
    assert math.remainder(instant - 1.0, math.pi) == pytest.approx(0.0, abs=1e-5)

    def skewed(t):
        return np.sin(t) + 0.3 * np.sin(2.0 * t)

    assert karetin.best_mirror(skewed, math.tau)[0] > 0.1
    assert karetin.best_mirror(skewed, math.tau, sign=-1.0)[0] < SEARCH


# --- the module ---

SPEED = 96.0
# a power of two, and numbers of steps: their sum is the time, without rounding
STEP = 2.0**-7
IMBALANCE = {"": "position", "_velocity": "velocity", "_acceleration": "acceleration"}


# exact in binary, so that omega2 = omega1/i is the same number on both sides
@pytest.mark.parametrize("ratio", [0.0, 0.5, -0.25, 1.0, 2.0])
@pytest.mark.parametrize("seed", [*range(5), None], ids=str)
def test_imbalance_of_the_module_moves_as_the_exact_form(seed, ratio, compiled):
    p = {} if seed is None else random_parameters(np.random.default_rng(seed))
    g, motion = Geometry(**p), dynamic_mode(SPEED, 1.0 / ratio if ratio else math.inf)
    module = started(compiled, p, fidelity=0, kinematic_ratio=ratio, omega1=SPEED)
    passed = 0
    for steps in (1, 3, 20, 64, 4096):
        advanced(module, *[STEP] * (steps - passed))
        passed, time = steps, steps * STEP
        k = exact(g, motion, [time])
        # the module carries q as a double or two; what the speeds make of an error of q is allowed too
        scale = {"": reach(g), "_velocity": k.speed[0] + SPEED * reach(g)}
        scale["_acceleration"] = k.acceleration_modulus[0] + SPEED * scale["_velocity"]
        for name, quantity in IMBALANCE.items():
            off = np.abs(vector(module, f"imbalance{name}") - k[quantity][:, 0]).max()
            assert off < (1e-12 if time < 1.0 else 1e-11) * scale[name]
