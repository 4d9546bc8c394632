"""Profile likelihood: intervals of free keys by re-fits of the others.

The profile of a key is the least chi-squared over all other free keys. The interval ends where it exceeds its
minimum by the squared quantile of Student's t: Bates and Watts, Nonlinear Regression Analysis and Its
Applications (1988), section 6.1. A profile that stays below this limit up to the end of the range shows that
the key is not identifiable: Raue et al., Bioinformatics 25 (2009) 1923.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..common.errors import Refused
from .axes import Free
from .least_squares import Array, Optimum

# re-fits per end of an interval; relative accuracy of the root of the change of chi-squared there
MAX_REFITS, PROFILE_RTOL = 8, 0.03
# a profile of a key without a range ends at its value and so many of its sizes
N_SIZES = 3.0
# largest extrapolation of the secant method; root, in quantiles, from which bisection replaces it
MAX_EXTRAPOLATION, MAX_ROOT = 4.0, 3.0
# distance from an end of its range, of the size of a key, at which a key is at this end
END_RTOL = 1e-4


class End(NamedTuple):
    """One end of a profile-likelihood interval.

    Attributes:
        value: of the key, SI.
        open: whether the end of a range, of this or another key, stops the profile below its limit.
        optimum: point with the least chi-squared of all re-fits, shape (keys,), and its chi-squared.
    """

    value: float
    open: bool
    optimum: tuple[float, Array]


def limits(key: Free, value: float) -> tuple[float, float]:
    """Return the ends of the profile of a key: its range or N_SIZES around its value, SI."""
    if key.has_range:
        return key.low, key.high
    reach = N_SIZES * max(key.size, abs(value))
    return max(key.low, value - reach), min(key.high, value + reach)


def profile_end(optimum: Optimum, number: int, side: int) -> End:
    """Find one end of the interval of a key.

    The root of the change of chi-squared is nearly linear in the key, so the secant method needs two or three
    re-fits. Far outside, bisection replaces it. After MAX_REFITS the outer end of the bracket is returned.

    Args:
        optimum: with the noise by which chi-squared is measured.
        number: place of the key.
        side: -1 for the lower, 1 for the upper end.
    """
    problem, centre, least = optimum.problem, float(optimum.point[number]), optimum.chi_squared
    limit, quantile = limits(problem.keys[number], centre)[side > 0], optimum.t_quantile
    # direction along which the other keys follow
    follow = optimum.without_key(number, centre).compensation(optimum.jacobian[:, number])
    direction = np.insert(follow, number, 1.0)
    best, inside, outside = (
        (least, optimum.point),
        (centre, 0.0, optimum.point),
        (math.nan, math.inf, optimum.point),
    )
    value = centre + side * quantile * float(optimum.deviations[number])
    for _ in range(MAX_REFITS):
        value = min(value, limit) if side > 0 else max(value, limit)
        guess = inside[2] + direction * (value - inside[0])
        chi_squared, point = _refit(optimum, number, value, guess)
        best = min(best, (chi_squared, point), key=lambda pair: pair[0])
        root = math.sqrt(max(chi_squared - least, 0.0))
        if root <= quantile:
            inside = value, root, point
        else:
            outside = value, root, point
        if (value == limit and root <= quantile) or abs(root - quantile) < PROFILE_RTOL * quantile:
            return End(value, _is_stopped(optimum, point), best)
        value = _next(inside[:2], outside[:2], centre, quantile)
    # without a limit so far, or with another key at the end of its range just outside
    last = inside if math.isnan(outside[0]) else outside
    return End(last[0], last is inside or _is_stopped(optimum, last[2]), best)


def _is_stopped(optimum: Optimum, point: Array) -> bool:
    """Return True if a key is at an end of its profile that is no physical limit."""
    for key, value, centre in zip(optimum.problem.keys, point, optimum.point, strict=True):
        for end, physical in zip(limits(key, float(centre)), key.physical, strict=True):
            if end != physical and abs(value - end) <= END_RTOL * key.size:
                return True
    return False


def _next(inside: tuple[float, float], outside: tuple[float, float], centre: float, quantile: float) -> float:
    """Return the next value of the key by the secant method."""
    if math.isnan(outside[0]):
        value, root = inside
        return centre + (value - centre) * min(quantile / max(root, 1e-9) * 1.02, MAX_EXTRAPOLATION)
    is_near = outside[1] < MAX_ROOT * quantile
    share = (quantile - inside[1]) / (outside[1] - inside[1]) if is_near else 0.5
    return inside[0] + share * (outside[0] - inside[0])


def _refit(optimum: Optimum, number: int, value: float, guess: Array) -> tuple[float, Array]:
    """Return the least chi-squared with a key fixed, infinite if the scene rejects it, and its point."""
    problem = optimum.problem.without_key(number, value)
    start, others = np.delete(guess, number), problem.keys
    # prior knowledge of the fixed key is a residual too
    key = optimum.problem.keys[number]
    prior = ((value - key.start) / key.deviation) ** 2
    if not others:
        residuals = problem.residuals(start)
        chi_squared, rest = float(residuals @ residuals), start
    else:
        try:
            refit = problem.minimise(start, np.delete(optimum.steps, number), refit=True)
        except Refused:
            return math.inf, guess
        chi_squared, rest = refit.chi_squared, refit.point
    if not math.isfinite(chi_squared):
        return math.inf, guess
    return chi_squared + prior, np.insert(rest, number, value)
