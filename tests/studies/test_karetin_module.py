"""The module moves its imbalance as Karetin's exact form says."""

import math

import numpy as np
import pytest
from karetin_cases import random_parameters, reach
from scenes import advanced, started, vector

from studies.papers.karetin import Geometry, dynamic_mode, exact, stop_mode

# powers of two: their sum is the time, without rounding
STEP = 2.0**-7
READINGS = (1, 2, 17, 44)  # steps between readings
SPEED = 96.0


def kinematic_module(parameters, ratio, omega1=SPEED):
    return started("plain", parameters, fidelity=0, kinematic_ratio=ratio, omega1=omega1)


@pytest.mark.parametrize("seed", range(12))
# exact in binary, so that omega2 = omega1/i is the same number on both sides
@pytest.mark.parametrize("ratio", [0.0, 0.5, -0.25, 1.0, 2.0])
def test_imbalance_of_the_module_moves_as_the_exact_form(seed, ratio):
    p = random_parameters(np.random.default_rng(seed))
    g = Geometry(**p)
    motion = dynamic_mode(SPEED, 1.0 / ratio if ratio else math.inf)
    module = kinematic_module(p, ratio)
    steps = 0
    for more in READINGS:
        advanced(module, *[STEP] * more)
        steps += more
        k = exact(g, motion, [steps * STEP])
        # the module carries q as a double or two; what the speeds make of an error of q is allowed too
        speed = k.speed[0] + SPEED * reach(g)
        acceleration = k.acceleration_modulus[0] + SPEED * speed
        assert np.abs(vector(module, "imbalance") - k.position[:, 0]).max() < 1e-12 * reach(g)
        assert np.abs(vector(module, "imbalance_velocity") - k.velocity[:, 0]).max() < 1e-12 * speed
        found = vector(module, "imbalance_acceleration")
        assert np.abs(found - k.acceleration[:, 0]).max() < 1e-12 * acceleration


@pytest.mark.parametrize("seed", range(4))
def test_seen_from_link_1_the_module_with_link_2_held_is_in_the_stop_mode(seed):
    p = random_parameters(np.random.default_rng(seed))
    g, module = Geometry(**p), kinematic_module(p, 0.0)
    advanced(module, 0.037)
    at = exact(g, stop_mode(SPEED), [0.037])
    theta = module["input_angle"]
    x, y, z = vector(module, "imbalance")
    turned_back = (x, y * math.cos(theta) + z * math.sin(theta), z * math.cos(theta) - y * math.sin(theta))
    assert np.abs(turned_back - at.position_in_link1[:, 0]).max() < 1e-12 * reach(g)


def test_defaults_of_the_module_and_of_the_geometry_are_the_same_mechanism():
    module = kinematic_module({}, 0.5)
    advanced(module, 0.01)
    k = exact(Geometry(), dynamic_mode(SPEED, 2.0), [0.01])
    assert vector(module, "imbalance") == pytest.approx(k.position[:, 0], rel=1e-12)
    assert module["imbalance_acceleration"] == pytest.approx(k.acceleration_modulus[0], rel=1e-12)


def test_module_and_exact_form_agree_after_a_long_run():
    module = kinematic_module({"epsilon": 0.3, "gamma": 0.2}, 0.5)
    advanced(module, *[STEP] * 4096)
    k = exact(Geometry(epsilon=0.3, gamma=0.2), dynamic_mode(SPEED, 2.0), [4096 * STEP])
    for name, expected in (
        ("imbalance", k.position),
        ("imbalance_velocity", k.velocity),
        ("imbalance_acceleration", k.acceleration),
    ):
        difference = np.linalg.norm(vector(module, name) - expected[:, 0])
        assert difference < 1e-11 * np.linalg.norm(expected[:, 0])
