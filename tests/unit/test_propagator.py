"""The exact propagator against many digits, in every damping regime and where the regimes meet."""

import math

import mpmath
import pytest

from inertia_module.kernel.driven_shaft.propagator import characteristic, responses

NAMES = ("step", "slope", "impulse", "one", "two", "three", "four")
DAMPING = [0.0, 1e-9, 0.3, 0.99, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 1.01, 5.0, 1e4, 1e12]
LENGTHS = [1e-12, 1e-3, 0.7, 0.75, 2.9, 3.1, 11.0, 40.0, 300.0]


def exact(rate, square, t):
    """All responses from the characteristic numbers, at many digits."""
    with mpmath.workdps(400):
        rate, square, t = (mpmath.mpf(value) for value in (rate, square, t))
        root = mpmath.sqrt(mpmath.mpc(rate * rate / 4 - square))
        if root == 0:
            root = mpmath.mpf(10) ** -60
        numbers = (-rate / 2 + root, -rate / 2 - root)

        def integral(n):
            parts = [
                (mpmath.exp(z * t) - sum((z * t) ** j / mpmath.factorial(j) for j in range(n))) / z**n
                for z in numbers
            ]
            return ((parts[0] - parts[1]) / (numbers[0] - numbers[1])).real

        ends = [z * mpmath.exp(z * t) for z in numbers]
        slope = ((ends[0] - ends[1]) / (numbers[0] - numbers[1])).real
        return [slope + rate * integral(0), slope, *(integral(n) for n in range(5))]


@pytest.mark.parametrize("natural", [1e-9, 1.0, 8.0, 1e13])
@pytest.mark.parametrize("damping", DAMPING)
@pytest.mark.parametrize("length", LENGTHS)
def test_every_response_is_exact_to_rounding(natural, damping, length):
    rate, square = 2.0 * damping * natural, natural * natural
    swing, slow, fast = characteristic(rate, square)
    for t in (length / natural, length / fast):
        found = responses(rate, square, swing, slow, fast, t)
        expected = exact(rate, square, t)
        # a swing is known to rounding of its phase and of what it started from
        phase = 1.0 + (fast * t if swing > 0.0 else slow * t)
        faded = math.exp(-slow * t) if swing > 0.0 else 0.0
        reach = min(t, 1.0 / swing if swing > 0.0 else t)
        amplitudes = (faded * (1 + slow * reach), faded * (1 + slow * reach), faded * reach, 0, 0, 0, 0)
        for name, value, right, amplitude in zip(NAMES, found, expected, amplitudes, strict=True):
            size = abs(right)
            if name == "slope":
                size += mpmath.exp(-fast * t) + slow * abs(expected[2])
            assert abs(value - right) <= 4e-15 * phase * (size + amplitude) + 1e-290, (name, t)


def test_nothing_jumps_where_one_form_takes_over_from_another():
    for damping in DAMPING[:-2]:
        rate, square = 2.0 * damping, 1.0
        swing, slow, fast = characteristic(rate, square)
        for edge in (3.0 / fast, 1.0 / slow) if damping > 1.0 else (3.0 / fast,):
            below, above = (
                responses(rate, square, swing, slow, fast, edge * (1.0 + shift)) for shift in (-1e-14, 1e-14)
            )
            for one, other in zip(below, above, strict=True):
                assert one == pytest.approx(other, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("rate, square, t", [(2e24, 1e-18, 1e6), (0.0, 1e27, 1e6), (2e24, 1e27, 1e-9)])
def test_the_farthest_corners_stay_finite(rate, square, t):
    found = responses(rate, square, *characteristic(rate, square), t)
    assert all(math.isfinite(value) for value in found)
