"""Profile likelihood: the interval of a free key by re-fits of the other free keys.

The profile of a key is the minimum of chi-squared over all other free keys. The interval ends where it
exceeds its minimum by the squared quantile of Student's t: Bates and Watts, Nonlinear Regression Analysis
and Its Applications (1988), section 6.1. A profile that stays below this limit up to the end of the range
shows that the key is not identifiable: Raue et al., Bioinformatics 25 (2009) 1923.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np

from ..common.errors import InertiaModuleError
from .axes import Free
from .least_squares import Array, Optimum

# maximum number of extrapolations until the profile exceeds its limit, and their maximum factor
MAX_EXTRAPOLATIONS, MAX_FACTOR = 10, 4.0
# distance of an extrapolated value from the estimate, relative to the estimated distance of the end
MARGIN = 1.1
# maximum number of steps of Brent's method
MAX_STEPS = 8
# square root of the change of chi-squared over the quantile: its accuracy, and the maximum that is used
PROFILE_RTOL, MAX_ROOT = 0.03, 3.0
# half width of the profile of a key without a range, relative to its size
N_SIZES = 3.0
# maximum distance from an end of its range at which a key is at this end, relative to its size
END_RTOL = 1e-4


class End(NamedTuple):
    """One end of a profile-likelihood interval.

    Attributes:
        value: value of the key, SI.
        open: True if the end of a range, of this or another key, stops the profile below its limit.
        optimum: minimum of chi-squared over all re-fits, and its point, shape (keys,).
    """

    value: float
    open: bool
    optimum: tuple[float, Array]


def limits(key: Free, value: float) -> tuple[float, float]:
    """Return the ends of the profile of a key, SI: its range, or N_SIZES sizes around its value.

    Args:
        key: the key.
        value: value at the optimum, SI.
    """
    if key.has_range:
        return key.low, key.high
    reach = N_SIZES * max(key.size, abs(value))
    return max(key.low, value - reach), min(key.high, value + reach)


def profile_end(optimum: Optimum, number: int, side: int) -> End:
    """Find one end of the interval of a key.

    The square root of the change of chi-squared is nearly linear in the key. It is extrapolated until it
    exceeds the quantile. Brent's method follows. If it does not converge, the end is the outer end of its
    bracket.

    Args:
        optimum: optimum with the noise of the residuals.
        number: index of the key.
        side: -1 for the lower, 1 for the upper end.
    """
    from scipy.optimize import brentq

    problem, centre, quantile = optimum.problem, float(optimum.point[number]), optimum.t_quantile
    (low, high), inside, outside = limits(problem.keys[number], centre), centre, centre
    # direction in which the other keys compensate a change of the key
    follow = optimum.without_key(number, centre).compensation(optimum.jacobian[:, number])
    direction, refits = np.insert(follow, number, 1.0), [(optimum.chi_squared, optimum.point)]

    def nearest(value: float) -> Array:
        return min((point for _, point in refits), key=lambda point: abs(point[number] - value))

    def distance(point: Array) -> float:
        """Return the square root of chi-squared, infinite if the scene rejects the point."""
        root = float(np.linalg.norm(problem.residuals(point)))
        return root if math.isfinite(root) else math.inf

    @functools.cache
    def excess(value: float) -> float:
        """Return the square root of the change of chi-squared over the quantile, minus 1."""
        nonlocal outside
        if value == centre:
            return -1.0
        guesses = [
            np.clip(point + direction * (value - point[number]), *problem.bounds)
            for point in (optimum.point, nearest(value))
        ]
        guess = min(guesses, key=distance)
        try:
            refit = problem.without_key(number, value).minimise(
                np.delete(guess, number), np.delete(optimum.steps, number), refit=True
            )
        except InertiaModuleError:
            outside = value
            return MAX_ROOT
        refits.append((refit.chi_squared, np.insert(refit.point, number, value)))
        root = math.sqrt(max(refit.chi_squared - optimum.chi_squared, 0.0)) / quantile
        outside = value if root > 1.0 else outside
        return min(root, MAX_ROOT) - 1.0 if abs(root - 1.0) > PROFILE_RTOL else 0.0

    step = side * MARGIN * quantile * float(optimum.deviations[number])
    for _ in range(MAX_EXTRAPOLATIONS):
        value = min(max(centre + step, low), high)
        if excess(value) >= 0.0 or value in (low, high):
            break
        inside, step = value, step * min(MARGIN / max(excess(value) + 1.0, 1e-3), MAX_FACTOR)
    is_open = excess(value) < 0.0 and value not in (low, high)
    if excess(value) > 0.0:
        xtol = 1e-3 * abs(value - centre)
        value = float(brentq(excess, inside, value, xtol=xtol, maxiter=MAX_STEPS, disp=False))
        value = outside if excess(value) < 0.0 else value
    best = min(refits, key=lambda refit: refit[0])
    return End(value, is_open or _is_stopped(optimum, nearest(value)), best)


def _is_stopped(optimum: Optimum, point: Array) -> bool:
    """Return True if a key is at an end of its profile that is no physical limit."""
    return any(
        end != physical and abs(value - end) <= END_RTOL * key.size
        for key, value, centre in zip(optimum.problem.keys, point, optimum.point, strict=True)
        for end, physical in zip(limits(key, float(centre)), key.physical, strict=True)
    )
