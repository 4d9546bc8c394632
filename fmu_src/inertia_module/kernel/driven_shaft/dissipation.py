"""Integrals of the squared slip and the squared speed over a step: what damping and friction turn to heat.

Found from the motion itself and not from the balance of energy, so that the residual of the energy audit
tests the step. Short or damped motion: Gauss quadrature with twelve nodes on intervals over which no mode
changes by more than exp(3), until it has died away (at most 14 intervals a mode, whatever the step):
exact to rounding, the rule is of order 24. Swinging motion: closed form, for any number of swings.
"""

import math

from ..accumulate import later
from .propagator import SHORT, responses
from .responses import NODES, is_short

# a mode that has faded by exp(-42) is gone: 6e-19
GONE = 42.0
# swings of less than this part of the natural frequency have died away before they matter
SLOW_SWING = 0.25

# of Gauss's rule, for the nodes of kept_responses
WEIGHTS = (
    0.2491470458134028,
    0.2334925365383548,
    0.2031674267230659,
    0.1600783285433462,
    0.1069393259953184,
    0.0471753363865118,
)


def squares_from(w, slope, impulse, one, two):
    """Squared slip and squared speed of the driven mass from the answers at some time of the step."""
    slip = w.slip * slope + w.slip_pull * impulse + w.slip_ramp * one
    kept = w.omega4 * slope
    fresh = w.fresh_rate * impulse
    pulled = w.fresh_pull * one
    changed = w.speed_rate * impulse
    drawn = w.speed_pull * one
    ramped = w.speed_ramp * two
    # of two equal forms the one that rounds off less
    if abs(kept) + abs(fresh) + abs(pulled) < abs(w.omega4) + abs(changed) + abs(drawn):
        speed = kept + fresh + pulled + ramped
    else:
        speed = w.omega4 + (changed + drawn + ramped)
    return slip * slip, speed * speed


def squares_at(d, w, t):
    """Squared slip and squared speed of the driven mass at t from the beginning of the step."""
    _, slope, impulse, one, two, _, _ = responses(d.rate, d.square, d.swing, d.slow, d.fast, t)
    return squares_from(w, slope, impulse, one, two)


def gauss_over_step(d, w, h):
    """Integrals of both squares over a short step, from the answers kept."""
    slips = 0.0
    speeds = 0.0
    for n in range(12):
        place = 4 * n
        slip, speed = squares_from(
            w, d.nodes[place], d.nodes[place + 1], d.nodes[place + 2], d.nodes[place + 3]
        )
        slips += WEIGHTS[n // 2] * slip
        speeds += WEIGHTS[n // 2] * speed
    return 0.5 * h * slips, 0.5 * h * speeds


def gauss(d, w, begin, length):
    """Integrals of both squares over an interval of the step."""
    slips = 0.0
    speeds = 0.0
    middle = begin + 0.5 * length
    for n in range(6):
        for side in range(2):
            shift = 0.5 * length * NODES[n]
            slip, speed = squares_at(d, w, middle - shift if side == 0 else middle + shift)
            slips += WEIGHTS[n] * slip
            speeds += WEIGHTS[n] * speed
    return 0.5 * length * slips, 0.5 * length * speeds


def by_intervals(d, w, h):
    """Both integrals over the step, interval by interval: first the fast mode fades, then the slow one."""
    slips = 0.0
    slips_low = 0.0
    speeds = 0.0
    speeds_low = 0.0
    begin = 0.0
    fast = d.fast
    slow = d.slow
    while begin < h:
        length = h - begin
        if begin * fast < GONE:
            length = min(length, SHORT / fast)
        elif begin * slow < GONE:
            length = min(length, SHORT / slow)
        slip, speed = gauss(d, w, begin, length)
        slips, slips_low = later(slips, slips_low, slip)
        speeds, speeds_low = later(speeds, speeds_low, speed)
        begin = h if length >= h - begin else begin + length
    return slips, speeds


def swing_square(steady, ramp, real, imaginary, d, h):
    """Integral over h of the square of steady + ramp t + Re((real + i imaginary) exp(lambda t)).

    lambda = -d.slow + i d.swing, both sums of its powers over h in closed form; for d.fast h above SHORT.
    """
    slow = d.slow
    swing = d.swing
    magnitude = d.square
    fading = math.exp(-slow * h)
    end_real = fading * math.cos(swing * h)
    end_imaginary = fading * math.sin(swing * h)
    # integral of exp(lambda t): (exp(lambda h) - 1) / lambda
    first_real = (-slow * (end_real - 1.0) + swing * end_imaginary) / magnitude
    first_imaginary = (-slow * end_imaginary - swing * (end_real - 1.0)) / magnitude
    # integral of t exp(lambda t): (h exp(lambda h) - the one before) / lambda
    rest_real = h * end_real - first_real
    rest_imaginary = h * end_imaginary - first_imaginary
    second_real = (-slow * rest_real + swing * rest_imaginary) / magnitude
    second_imaginary = (-slow * rest_imaginary - swing * rest_real) / magnitude
    # the square of Re(z) is half of |z|^2 + Re(z^2); exp(2 lambda h) - 1 is (e - 1)(e + 1)
    total = h
    if slow > 0.0:
        total = -math.expm1(-2.0 * slow * h) / (2.0 * slow)
    square_real = (end_real - 1.0) * (end_real + 1.0) - end_imaginary * end_imaginary
    square_imaginary = 2.0 * end_real * end_imaginary
    double_real = 0.5 * (-slow * square_real + swing * square_imaginary) / magnitude
    double_imaginary = 0.5 * (-slow * square_imaginary - swing * square_real) / magnitude
    product_real = real * real - imaginary * imaginary
    product_imaginary = 2.0 * real * imaginary
    wave = 0.5 * (
        (real * real + imaginary * imaginary) * total
        + product_real * double_real
        - product_imaginary * double_imaginary
    )
    cross = steady * (real * first_real - imaginary * first_imaginary) + ramp * (
        real * second_real - imaginary * second_imaginary
    )
    return h * (steady * steady + ramp * h * (steady + ramp * h / 3.0)) + 2.0 * cross + wave


def by_swings(d, w, hub, slope, h):
    """Both integrals over a step of many swings: the slip is a steady part and a swing about it."""
    steady = w.slip_ramp / d.square
    real = w.slip - steady
    imaginary = (d.slow * (real + 2.0 * steady) - w.slip_pull) / d.swing
    slips = swing_square(steady, 0.0, real, imaginary, d, h)
    return slips, swing_square(hub - steady, slope, -real, -imaginary, d, h)


def squares(d, w, hub, slope, h):
    """Integrals over the step of the squared slip and of the squared speed of the driven mass.

    Args:
        d: derived constants, with the answers to this step kept. w: workspace, the motion over the step.
        hub, slope: speed of the hub at the beginning, rad/s, and its rate, rad/s^2. h: step, s.

    Returns:
        (slips, speeds), rad^2/s each.
    """
    if is_short(d, h):
        return gauss_over_step(d, w, h)
    if d.swing > SLOW_SWING * d.fast:
        return by_swings(d, w, hub, slope, h)
    return by_intervals(d, w, h)
