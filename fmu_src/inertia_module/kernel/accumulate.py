"""Compensated sums and wrapped angles: nothing is lost over billions of steps or turns."""

import math

from .derive import TWO_PI, TWO_PI_LOW
from .slots import *


def add(x, slot, value):
    """Add value to x[slot]; what rounding loses is kept in x[slot + 1] (Neumaier's sum)."""
    value += x[slot + 1]
    old = x[slot]
    new = old + value
    shift = new - old
    x[slot + 1] = (old - (new - shift)) + (value - shift)
    x[slot] = new


def later(time, low, passed):
    """Time and what rounding has kept from it, the time passed later. Returns (time, low)."""
    passed += low
    new = time + passed
    return new, passed - (new - time)


def assign(x, slot, value):
    """Set x[slot] exactly."""
    x[slot] = value
    x[slot + 1] = 0.0


def wrap(x, slot, period, period_low):
    """Bring the angle x[slot] into [0, period), period in two doubles. Returns the periods taken off."""
    angle = x[slot]
    rest = angle % period if angle >= 0.0 else -(-angle % period)  # of the sign of angle: exact
    periods = math.floor((angle - rest) / period + 0.5)
    low = x[slot + 1] - periods * period_low
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
    x[slot] = rest
    x[slot + 1] = low
    return periods


def wrap_drive_angle(d, x):
    """Keep q within [0, period); the whole turns taken off are counted in revolutions."""
    if not 0.0 <= x[X_Q] < d[D_PERIOD]:
        x[X_DRIVE_TURNS] += d[D_PERIOD_TURNS] * wrap(x, X_Q, d[D_PERIOD], d[D_PERIOD_LOW])


def wrap_input_angle(x):
    """Keep theta1 within [0, 2 pi); whole turns are counted."""
    if not 0.0 <= x[X_THETA1] < TWO_PI:
        x[X_INPUT_TURNS] += wrap(x, X_THETA1, TWO_PI, TWO_PI_LOW)
