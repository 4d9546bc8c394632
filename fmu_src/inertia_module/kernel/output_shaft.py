"""The output shaft turns against the load; while link 2 does not drive it (rigid) it coasts and rests."""

import math

from .accumulate import add, add_loss
from .codes import HELD_DRIVING, LINK2, OUTPUT, VISCOUS
from .shaft import rate_alone

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


def coasting(d, x, load, t):
    """Speed and acceleration of the shaft that has coasted for the time t: J3 omega3' = -load - b3 omega3."""
    rate = rate_alone(d, x, load)
    if d.b3 == 0.0:
        return x.omega3 + rate * t, rate
    z = d.b3 * t / d.J3
    mean, _ = slowed(z)
    return x.omega3 + rate * t * mean, rate * math.exp(-z)


def coasting_fourth_bound(d, x, load, h):
    """Bound of the fourth derivative of the coasting shaft's speed by the fraction of the step h."""
    z = d.b3 * h / d.J3
    return abs(rate_alone(d, x, load)) * h * z * z * z


def turn(x, load, angle):
    """Count an angle of the output, driven mass if elastic, and the work on the load."""
    x.turned3 += angle
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, load * angle)


def coast(d, x, load, h):
    """The shaft slowed by load and friction over h, with its work and loss."""
    change = -load * h / d.J3
    mean = x.omega3 + 0.5 * change
    if d.b3 != 0.0:
        first, second = slowed(d.b3 * h / d.J3)
        at_once = change - d.b3 * x.omega3 * h / d.J3
        change = at_once * first
        mean = x.omega3 + at_once * second
        lost = -d.J3 * change * (x.omega3 + 0.5 * change) - load * h * mean
        add_loss(x, VISCOUS, max(0.0, lost))
    turn(x, load, h * mean)
    x.omega3, x.omega3_low = add(x.omega3, x.omega3_low, change)


def stop(x):
    """Set the shaft at rest exactly."""
    x.omega3 = 0.0
    x.omega3_low = 0.0


def time_to_stop(d, x, load, remaining):
    """Time until the coasting shaft stops, or -1 if it does not in the time remaining."""
    if not (load > 0.0 and d.J3 * x.omega3 < (load + d.b3 * x.omega3) * remaining):
        return -1.0
    time = d.J3 * x.omega3 / load
    if d.b3 != 0.0:
        time = d.J3 / d.b3 * math.log1p(d.b3 * x.omega3 / load)
    return time if time < remaining else -1.0


def meet(d, x, which):
    """Set the speeds exactly equal where free link 2 has met the output shaft."""
    if which == LINK2:
        if x.omega3 < 0.0:
            stop(x)
    elif which == OUTPUT or x.omega3 < x.omega2:
        if d.housing != 0.0 and x.omega3 < 0.0:
            stop(x)
        x.omega2 = x.omega3
        x.omega2_low = x.omega3_low


def pass_while_held(d, x, load, h):
    """The shaft over h while link 2 is held: it rests with link 2 against the load, or coasts."""
    if x.mode == HELD_DRIVING:
        x.output_impulse += load * h
        x.output_square += load * load * h
        x.torque_peak = max(x.torque_peak, abs(load))
    else:
        coast(d, x, load, h)
