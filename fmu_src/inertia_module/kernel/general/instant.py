"""The instant at which links that stick together part: where friction holds just no more.

What is left of friction has kinks, where a torque changes its sign, that a fit over the step rounds off.
"""

from ..tableau import END
from .guards import SLIP, general_guard, value_and_rate
from .stages import evaluate_inside

LOOKS = 50
SECANTS = 8


def part_at(d, x, w, zero, sigma):
    """The part of the step in hand, its inside known, at which links 1 and 2 part.

    Args:
        zero: what is left of the friction is called zero below it, N m.
        sigma: the part by the fit, which holds where friction is left at the end, or none at the beginning.
    """
    values = w.watched[SLIP].value
    low, high = 0.0, 1.0
    value_low, value_high = values[0], values[END]
    # Illinois: a secant that never leaves the bracket
    for _ in range(LOOKS):
        evaluate_inside(d, x, w, sigma)
        value, _ = value_and_rate(d, x, d.machine, SLIP)
        if abs(value) <= zero:
            break
        if value < 0.0:
            high, value_high, value_low = sigma, value, 0.5 * value_low
        else:
            low, value_low, value_high = sigma, value, 0.5 * value_high
        if not value_low > 0.0 > value_high:
            break
        sigma = high - value_high * (high - low) / (value_high - value_low)
    return sigma


def pass_at(d, x, w, which, zero, sigma):
    """The part of the step in hand, its inside known, at which a torque passes zero, by the equations.

    Args:
        which: guard. zero: torque below which it counts as zero, N m. sigma: the part by the fit.
    """
    before = value_before = 0.0
    _, slope = general_guard(x, w, which, sigma)
    for look in range(SECANTS):
        evaluate_inside(d, x, w, sigma)
        value, _ = value_and_rate(d, x, d.machine, which)
        if -4.0 * zero <= value < -zero:
            break
        if look > 0 and value != value_before:
            slope = (value - value_before) / (sigma - before)
        before, value_before = sigma, value
        there = sigma - (value + 2.0 * zero) / slope if slope < 0.0 else sigma
        if not 0.0 < there <= 1.0 or there == sigma:
            break
        sigma = there
    return sigma
