"""The output shaft turns against the load, or slows down by itself."""

import math

from .accumulate import add

# below it the mean of an exponential is a series
SERIES = 0.3


def slowed(z):
    """Means over 0 <= t <= 1 of exp(-z t), (1 - exp(-z)) / z, and its integral, (z - 1 + exp(-z)) / z^2."""
    if z < SERIES:
        # the first eight terms: to rounding
        first = 1.0
        second = 0.5
        term = 1.0
        for n in range(2, 10):
            term *= -z / n
            first += term
            second += term / (n + 1.0)
        return first, second
    first = -math.expm1(-z) / z
    return first, (1.0 - first) / z


def turn(x, load, angle):
    """Count an angle of the output, driven mass if elastic, and the work on the load."""
    x.turned3 += angle
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, load * angle)
