"""Compensated sums and wrapped angles: nothing is lost over billions of steps or turns."""

import math

TWO_PI = 6.283185307179586
TWO_PI_LOW = 2.4492935982947064e-16


def add(value, low, change):
    """Compensated sum of Neumaier: value + low + change as (value, low), low being what rounding lost."""
    change += low
    new = value + change
    shift = new - value
    return new, (value - (new - shift)) + (change - shift)


def add_loss(x, cause, lost):
    """Add what a cause (equations.losses) has taken, J."""
    x.lost[cause], x.lost_low[cause] = add(x.lost[cause], x.lost_low[cause], lost)
    x.step_lost += lost


def total(numbers):
    """Sum of an array."""
    found = 0.0
    for n in range(len(numbers)):
        found += numbers[n]
    return found


def clear(numbers):
    """Fill an array with zeros."""
    for n in range(len(numbers)):
        numbers[n] = 0.0


def copy(target, source):
    """Fill an array with the numbers of another, at least as long."""
    for n in range(len(target)):
        target[n] = source[n]


def wrap(angle, angle_low, period, period_low):
    """Bring an angle in two doubles into [0, period), period in two doubles.

    Returns:
        (angle, its low part, periods taken off).
    """
    rest = angle % period if angle >= 0.0 else -(-angle % period)  # of the sign of angle: exact
    periods = math.floor((angle - rest) / period + 0.5)
    low = angle_low - periods * period_low
    if rest < 0.0:
        turned = rest + period
        low += rest - (turned - period) + period_low
        rest = turned
        periods -= 1.0
    if rest >= period:
        rest -= period
        low -= period_low
        periods += 1.0
    # what low has gathered belongs to the angle, unless that takes it below zero by rounding
    total = rest + low
    if total >= 0.0:
        low -= total - rest
        rest = total
    return rest, low, periods


def wrap_drive_angle(d, x):
    """Keep q within [0, period); the whole turns taken off are counted in revolutions."""
    if not 0.0 <= x.q < d.period:
        x.q, x.q_low, periods = wrap(x.q, x.q_low, d.period, d.period_low)
        x.drive_turns += d.period_turns * periods


def wrap_input_angle(x):
    """Keep theta1 within [0, 2 pi); whole turns are counted."""
    if not 0.0 <= x.theta1 < TWO_PI:
        x.theta1, x.theta1_low, periods = wrap(x.theta1, x.theta1_low, TWO_PI, TWO_PI_LOW)
        x.input_turns += periods


def turn_output(x):
    """Add the angle of the step to that of the output shaft, in [0, 2 pi); whole turns are counted."""
    x.output_angle, x.output_angle_low = add(x.output_angle, x.output_angle_low, x.turned3)
    if not 0.0 <= x.output_angle < TWO_PI:
        x.output_angle, x.output_angle_low, turns = wrap(
            x.output_angle, x.output_angle_low, TWO_PI, TWO_PI_LOW
        )
        x.output_turns += turns
