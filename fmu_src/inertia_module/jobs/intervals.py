"""Interval of one fitted value: where chi-squared, all other values fitted anew, is what the F-test allows.

As lmfit's conf_interval, which takes neither a single variable nor steps of differences of one's own.
"""

from __future__ import annotations

import math
from collections.abc import Callable

# of the intervals
CONFIDENCE = 0.95
# an end that is not there after so many steps, each twice the one before, is none
MOST_STEPS = 12
# of an interval, so much is an end uncertain
EXACT = 1e-2


def interval(
    chi_squared: Callable[[float], float],
    best: float,
    variable: float,
    step: float,
    degrees: int,
    within: tuple[float, float],
) -> tuple[float, float]:
    """Both ends of the interval; an end of the range, or infinite, where chi-squared stays below.

    Args:
        chi_squared: the least for a value of the variable. best: that of the fit, at this variable.
        step: the first one out, about a standard error. degrees: of freedom of the fit.
        within: range of the variable.
    """
    from scipy.stats import f

    allowed = best * (1.0 + float(f.ppf(CONFIDENCE, 1, degrees)) / degrees)
    low, high = (
        _end(lambda u: chi_squared(u) - allowed, variable, side * step, end)
        for side, end in zip((-1.0, 1.0), within, strict=True)
    )
    return low, high


def _end(excess: Callable[[float], float], inside: float, step: float, limit: float) -> float:
    """Where the excess changes its sign, on the side of the step."""
    from scipy.optimize import root_scalar

    start = inside
    for _ in range(MOST_STEPS):
        outside = min(start + step, limit) if step > 0.0 else max(start + step, limit)
        if excess(outside) > 0.0:
            found = root_scalar(excess, bracket=(inside, outside), method="brenth", xtol=EXACT * abs(step))
            return float(found.root)
        if outside == limit:
            return limit
        inside, step = outside, 2.0 * step
    return math.copysign(math.inf, step)
