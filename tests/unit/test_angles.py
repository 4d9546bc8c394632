"""Test that angles are wrapped and turns counted without loss of digits, and exact sines and inertias."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import SCENES, advanced, drive_angle, started

from inertia_module.interface.records import record_type
from inertia_module.kernel import fields
from inertia_module.kernel.accumulate import wrap_drive_angle, wrap_input_angle
from inertia_module.kernel.inertia import reduced_inertia
from inertia_module.kernel.sine import MAX_ANGLE, sine_cosine

# The number pi with 60 digits.
PI = Fraction(3141592653589793238462643383279502884197169399375105820974944, 10**60)
ULP = 2.0**-52
TINY = 2.0**-16  # s; speeds that are powers of two make each increment exact


def wrapped(angle, period):
    """Return the exact angle within one period, and the whole turns removed."""
    periods = angle // period
    return angle - periods * period, periods * round(period / (2 * PI))


def distance(angle, exact, period):
    """Return the distance of two angles on the circle."""
    gap = (Fraction(angle) - exact) % period
    return float(min(gap, period - gap))


@pytest.mark.parametrize("teeth", [(34, 20), (20, 20), (13, 20), (36, 24)], ids=str)
@pytest.mark.parametrize("ratio", [0.0, 0.5, -0.25, 2.0])
def test_angles_over_many_steps_are_exact_except_for_full_turns(compiled, teeth, ratio):
    z17, z6 = teeth
    omega1 = 4096.0 if z17 > z6 else -4096.0
    period = 2 * PI * Fraction(z17, z6).denominator
    module = started(compiled, fidelity=0, z17=z17, z6=z6, kinematic_ratio=ratio, omega1=omega1)
    steps = 10_000
    for _ in range(steps):
        module.advance(TINY)
    theta1 = steps * Fraction(TINY) * Fraction(omega1)
    q = theta1 * (1 - Fraction(ratio))
    for name, turns, exact, around in [
        ("drive_angle", "drive_turns", q, period),
        ("input_angle", "input_turns", theta1, 2 * PI),
    ]:
        expected, whole = wrapped(exact, around)
        assert module[name] == pytest.approx(float(expected), rel=1e-14, abs=1e-12)
        assert module[turns] == whole
    assert module["input_flange_angle"] == pytest.approx(float(theta1), rel=1e-14)


def test_fast_input_keeps_its_angles_over_long_steps(compiled, scene):
    for steps in (1000, 1):
        module = advanced(started(compiled, scene, fidelity=0, omega1=1e5), *[1.0 / steps] * steps)
        theta1 = steps * Fraction(1.0 / steps) * Fraction(1e5)
        planar = module["layout"]
        k = Fraction(module["sun_radius"]) / Fraction(module["satellite_radius"]) if planar else 1
        assert distance(module["input_angle"], theta1, 2 * PI) < 1e-11 * float(theta1)
        period = 2 * PI * (1 if planar else 10)
        assert distance(module["drive_angle"], k * theta1, period) < 1e-11 * float(k * theta1)


def test_link_2_held_by_its_freewheel_keeps_the_same_angles(compiled, scene):
    held = started(compiled, scene, load_torque=1e7, omega1=4096.0)
    prescribed = started(compiled, scene, fidelity=0, omega1=4096.0)
    for module in (held, prescribed):
        advanced(module, 0.25, 1.0, 0.0625)
    assert held["contact_mode"] == 3
    assert drive_angle(held) == pytest.approx(drive_angle(prescribed), rel=1e-12)
    assert held["input_turns"] == prescribed["input_turns"]


@pytest.mark.parametrize("fidelity", range(4))
def test_angle_of_link_1_follows_its_mean_speed(compiled, fidelity):
    module = started(compiled, SCENES["planar"], fidelity=fidelity, omega1=100.0)
    module.set_rates(omega1=40.0)
    module.advance(0.5)
    assert module["input_flange_angle"] == pytest.approx(55.0, rel=1e-12)


@pytest.mark.parametrize("turns", [-1000, -3, -1, 1, 2, 7, 1000])
@pytest.mark.parametrize("bit", [-1, 0, 1])
def test_wrapped_angles_are_within_a_turn(turns, bit):
    angle = 2.0 * math.pi * turns
    angle += bit * math.ulp(angle)
    d = started("plain", layout=1).derived
    x = record_type(fields.STATE)()
    x.q = x.theta1 = angle
    wrap_drive_angle(d, x)
    wrap_input_angle(x)
    assert 0.0 <= x.q <= 2.0 * math.pi
    assert 0.0 <= x.theta1 <= 2.0 * math.pi
    for rest, count in ((x.q, x.drive_turns), (x.theta1, x.input_turns)):
        assert abs(Fraction(rest) + round(count) * 2 * PI - Fraction(angle)) <= math.ulp(2.0 * math.pi)


def assert_both_are_close(x):
    with mpmath.workprec(200):
        exact = mpmath.sin(x), mpmath.cos(x)
        for actual, expected in zip(sine_cosine(x), exact, strict=True):
            # Near a zero the error of the reduced angle is 1e-21 of the removed quadrants.
            assert abs(actual - expected) <= 1.5 * ULP * abs(expected) + 1e-30 * abs(x) + 5e-324


@given(st.floats(-2.0 * MAX_ANGLE, 2.0 * MAX_ANGLE), st.integers(-600000, 600000), st.floats(-1e-3, 1e-3))
def test_sine_and_cosine_have_at_most_1_5_ulp_near_their_zeros(x, n, offset):
    assert_both_are_close(x)
    assert_both_are_close(n * math.pi / 2.0 + offset)


def test_sine_and_cosine_have_at_most_1_5_ulp():
    for n in range(-100, 101):
        assert_both_are_close(0.0707 * n)


# --- inertia as a function of the drive angle ---


@pytest.mark.parametrize("satellites", [1, 2, 3])
@pytest.mark.parametrize("z17", [34, 20, 13])
@pytest.mark.parametrize("layout", [0, 1])
def test_highest_harmonic_is_the_highest_there_is(layout, z17, satellites):
    d = started("plain", z17=z17, z6=20, layout=layout, a=0.7, b=1.3, satellites=satellites).derived
    turns = np.arange(256) / 256
    spectrum = np.abs(np.fft.rfft([reduced_inertia(d, d.period * turn) for turn in turns], axis=0)).max(
        axis=1
    )
    highest = np.flatnonzero(spectrum > 1e-9 * spectrum.max())[-1]
    assert d.harmonic == pytest.approx(highest / d.period_turns)


@given(distance=st.floats(1e-12, 1e-4))
def test_inertia_near_the_rolling_point_keeps_its_digits(distance):
    d = started("plain").derived
    curvature = 2.0 * d.mass * d.s**2 * d.spin_square
    g = reduced_inertia(d, distance)[4]
    assert g == pytest.approx(0.5 * curvature * distance**2, rel=1e-13 + 10.0 * distance**2)
