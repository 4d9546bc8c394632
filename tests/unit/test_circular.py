"""Sine and cosine of the kernel are as exact as the library's."""

import math

import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inertia_module.kernel.sine import LARGEST_ANGLE, sine_cosine

ULP = 2.0**-52


@given(st.floats(-2.0 * LARGEST_ANGLE, 2.0 * LARGEST_ANGLE))
def test_both_are_within_one_and_a_half_units(x):
    with mpmath.workprec(200):
        exact = mpmath.sin(x), mpmath.cos(x)
        for found, wanted in zip(sine_cosine(x), exact, strict=True):
            # close to a zero the reduced angle is known to 1e-21 of the quadrants taken off
            assert abs(found - wanted) <= 1.5 * ULP * abs(wanted) + 1e-30 * abs(x) + 5e-324


def test_both_are_within_one_and_a_half_units_all_around():
    for n in range(-100, 101):
        test_both_are_within_one_and_a_half_units.hypothesis.inner_test(0.0707 * n)


@given(st.integers(-600000, 600000), st.floats(-1e-3, 1e-3))
def test_they_are_exact_close_to_their_zeros(n, offset):
    test_both_are_within_one_and_a_half_units.hypothesis.inner_test(n * math.pi / 2.0 + offset)


@pytest.mark.parametrize("x", [math.inf, -math.inf])
def test_what_is_no_angle_is_left_to_the_library(x):
    with pytest.raises(ValueError, match=r"math domain error|expected a finite"):
        sine_cosine(x)
    assert all(math.isnan(value) for value in sine_cosine(math.nan))
