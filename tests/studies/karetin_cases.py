"""Random mechanisms and motions the tests of Karetin's kinematics share."""

import math

import numpy as np

from studies.papers.karetin import Geometry, Motion


def random_parameters(rng):
    teeth = {name: int(rng.integers(8, 90)) for name in ("z2", "z16", "z17", "z6")}
    factors = {name: float(rng.uniform(0.05, 3.0)) for name in "abc"}
    phases = {name: float(rng.uniform(-7.0, 7.0)) for name in ("epsilon", "gamma")}
    return (
        teeth
        | factors
        | phases
        | {"shaft_angle": float(rng.uniform(0.1, 3.0)), "wheel_radius": float(rng.uniform(0.01, 1.0))}
    )


def random_motion(rng):
    """Stop mode, dynamic mode, link 2 ahead or turning back."""
    omega1 = float(rng.uniform(-500.0, 500.0))
    carrier = omega1 if rng.random() < 0.7 else 0.0
    return Motion(omega1, float(rng.choice([0.0, rng.uniform(-1.5, 1.5)])) * omega1, carrier)


def random_times(rng, count):
    """Within a few turns, 0 included."""
    return np.concatenate([[0.0], rng.uniform(-2e-3, 2e-3, count - 1)])


def geometry(**parameters):
    """A geometry of simple numbers: phi = psi = 45 degrees, wheel radius 1 m, AD = QA = OQ = 1 m."""
    return Geometry(**({"z17": 20, "z6": 20, "shaft_angle": math.pi / 2, "wheel_radius": 1.0} | parameters))


def reach(g):
    """No point of the trajectory is further than this from O, m."""
    return math.hypot(g.across, g.height) + g.AD
