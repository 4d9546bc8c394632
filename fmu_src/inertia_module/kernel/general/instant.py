"""The instant at which links that stick together part: where friction holds just no more.

What is left of friction has kinks, where a torque changes its sign, that a fit over the step rounds off.
"""

from ..solvers.dormand_prince import END
from .guards import SLIP, value_and_rate
from .stages import evaluate_inside

LOOKS = 50


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
