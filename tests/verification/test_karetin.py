"""Test Karetin's exact forms with a chain of rotated bodies.

tests/unit/test_paper_scenes.py compares the module with them. The chain (geometry.py) shares no code with the
tested code: the cones follow from the line on which they roll, and derivatives from positions only.
"""

import cmath
import math
from dataclasses import asdict

import numpy as np
import pytest
from geometry import derivatives, position, taylor, turn

from papers import karetin
from papers.karetin import PLANES, Geometry, Motion, exact, stop_mode

TIMES = 21
# coordinates of the angles of H, P and F
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
    """Return an upper bound of the distance of the trajectory from O, m."""
    return math.hypot(g.across, g.height) + g.AD


@pytest.fixture(scope="module", params=range(8))
def case(request):
    """Return a random mechanism and motion at time 0 and random times."""
    rng = np.random.default_rng(request.param)
    g, omega1 = Geometry(**random_parameters(rng)), float(rng.uniform(-500.0, 500.0))
    carrier = omega1 if rng.random() < 0.7 else 0.0
    motion = Motion(omega1, float(rng.choice([0.0, rng.uniform(-1.5, 1.5)])) * omega1, carrier)
    return exact(g, motion, np.concatenate([[0.0], rng.uniform(-2e-3, 2e-3, TIMES - 1)]))


def test_position_rates_angles_and_feet_agree_with_the_chain(case):
    g, motion, size = case.g, case.motion, reach(case.g)
    drive, p = g.k * (motion.omega1 - motion.omega2), {"layout": 0, "satellites": 1, **asdict(g)}
    fastest = abs(motion.carrier) + (1.0 + g.s) * abs(drive)

    def place(t):
        return turn(0, motion.carrier * t) @ position(p, drive * t)

    for n, time in enumerate(case.t):
        r, v, a = derivatives(taylor(place, time, radius=0.25 / fastest))
        assert case.position[:, n] == pytest.approx(r, abs=1e-12 * size)
        assert case.velocity[:, n] == pytest.approx(v, abs=1e-11 * size * fastest)
        assert case.acceleration[:, n] == pytest.approx(a, abs=1e-10 * size * fastest**2)
        for column, ((i, j), (u, w)) in enumerate(zip(PLANES, SENSES, strict=True)):
            # the direction is inaccurate near an axis
            in_plane, plane_velocity = complex(r[u], r[w]), complex(v[u], v[w])
            loss = size / abs(in_plane)
            difference = math.remainder(case.angles[column, n] - cmath.phase(in_plane), math.tau)
            assert difference == pytest.approx(0.0, abs=1e-12 * loss)
            rate = (plane_velocity / in_plane).imag
            assert case.angular_velocities[column, n] == pytest.approx(rate, abs=1e-11 * loss**2 * fastest)
            # OL is perpendicular to the velocity, with the distance of the line from O
            in_plane, plane_velocity = complex(r[i], r[j]), complex(v[i], v[j])
            foot, bound = complex(*case.feet[column, [i, j], n]), 1e-11 * size / abs(plane_velocity)
            assert foot / plane_velocity == pytest.approx(
                1j * (in_plane / plane_velocity).imag, abs=bound * size * fastest / abs(plane_velocity)
            )
            assert case.arms[column, n] == pytest.approx(abs(foot), abs=1e-14 * size)


def test_moduli_and_projections_agree_with_their_vectors(case):
    for name, modulus in MODULI.items():
        np.testing.assert_allclose(case[modulus], np.linalg.norm(case[name], axis=0), rtol=1e-15)
    for vectors, lengths in ((case.position, case.projections), (case.velocity, case.plane_speeds)):
        expected = np.stack([np.hypot(vectors[u], vectors[v]) for u, v in PLANES])
        np.testing.assert_allclose(lengths, expected, rtol=1e-15)


def test_pole_of_the_cones_rests_in_link_1_and_half_angles_sum_to_the_shaft_angle():
    """Rolling: with a = b = c = 1 the imbalance passes through the contact line of the cones."""
    g = Geometry(z17=37, z6=19, shaft_angle=1.1, wheel_radius=1.0)
    k = exact(g, stop_mode(80.0), np.array([0.0, 2.0 * math.pi * 19 / 37 / 80.0]))
    assert k.speed.max() < 1e-13 * 80.0 * g.L
    # contact with wheel 17 on the rim
    np.testing.assert_allclose(k.projections[0], g.wheel_radius, rtol=1e-14)
    assert g.phi + g.psi == pytest.approx(1.1, rel=1e-15)
    assert math.sin(g.psi) / math.sin(g.phi) == pytest.approx(g.s, rel=1e-15)
    assert g.wheel_radius / math.sin(g.psi) == pytest.approx(g.L, rel=1e-15)


def test_best_mirror_of_functions_with_and_without_symmetry():
    """sin t + 0.3 sin 2t has no even symmetry, cos(t - 1) is symmetric about 1 and 1 + pi."""
    share, instant = karetin.best_mirror(lambda t: 5.0 * np.cos(t - 1.0) + 2.0, math.tau)
    assert share < 1e-6
    assert math.remainder(instant - 1.0, math.pi) == pytest.approx(0.0, abs=1e-5)

    def skewed(t):
        return np.sin(t) + 0.3 * np.sin(2.0 * t)

    assert karetin.best_mirror(skewed, math.tau)[0] > 0.1
    assert karetin.best_mirror(skewed, math.tau, sign=-1.0)[0] < 1e-6
