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


def wrap_drive_angle(d, x):
    """Keep q within [0, period); the whole turns taken off are counted in revolutions."""
    periods = math.floor(x[X_Q] / d[D_PERIOD])
    if periods != 0.0:
        assign(x, X_Q, (x[X_Q] - periods * d[D_PERIOD]) + (x[X_Q_LOW] - periods * d[D_PERIOD_LOW]))
        x[X_DRIVE_TURNS] += periods * d[D_PERIOD_TURNS]


def wrap_input_angle(x):
    """Keep theta1 within [0, 2 pi); whole turns are counted."""
    turns = math.floor(x[X_THETA1] / TWO_PI)
    if turns != 0.0:
        assign(x, X_THETA1, (x[X_THETA1] - turns * TWO_PI) + (x[X_THETA1_LOW] - turns * TWO_PI_LOW))
        x[X_INPUT_TURNS] += turns
