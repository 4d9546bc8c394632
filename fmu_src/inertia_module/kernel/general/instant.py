"""The instant at which a guard falls that has kinks: a fit over the step rounds them off.

What is left of the friction that holds links 1 and 2 has them where a torque changes its sign, the least of
the torques of several satellites where another becomes the least.
"""

from ..solvers.dormand_prince import END
from .guards import SPIN, value_and_rate
from .stages import evaluate_inside

LOOKS = 50


def fall_at(d, x, w, which, zero, sigma):
    """The part of the step in hand, its inside known, at which this guard falls.

    Args:
        zero: the guard is called zero below it, N m.
        sigma: the part by the fit, which holds where the guard is above zero at the end or not at first.

    Returns:
        (part of the step, whether the guard falls there).
    """
    values = w.watched[which].value
    low, high = 0.0, 1.0
    # a satellite whose torque has just changed its sign may miss zero by rounding
    value_low, value_high = max(values[0], zero) if which == SPIN else values[0], values[END]
    # Illinois: a secant that never leaves the bracket
    for _ in range(LOOKS):
        evaluate_inside(d, x, w, sigma)
        value, _ = value_and_rate(d, x, d.machine, which)
        if abs(value) <= zero:
            break
        if value < 0.0:
            high, value_high, value_low = sigma, value, 0.5 * value_low
        else:
            low, value_low, value_high = sigma, value, 0.5 * value_high
        if not value_low > 0.0 > value_high:
            return sigma, value < 0.0
        sigma = high - value_high * (high - low) / (value_high - value_low)
    return sigma, True
