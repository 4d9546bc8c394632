"""Least squares over free keys of a scene: where chi-squared is least, and how far off a key may be.

By SciPy's trust-region reflective search, weighted by the noise of each column.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.equality import ByContent
from ..common.errors import Refused
from .axes import Free
from .measurement import Rig, lag_one

# noise that is not known is found anew so often at most, and until no more than this share of it changes
PASSES, SETTLED = 3, 0.02
# step of differences, of a range or a start value; later the standard error, the others held, within these
STEP, SMALLEST_STEP, LARGEST_STEP = 1e-3, 1e-5, 0.05
# length of the slopes that tell errors, in standard errors: where freewheels switch from one row to the next
# slopes change over less, and would make intervals too narrow
REACH = 2.0
# chi-squared and shares that change less end a search
ENOUGH = 1e-7
MOST_ITERATIONS = 100
CONFIDENCE = 0.95

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Problem(ByContent):
    """Which keys are free, and what weighs how much.

    Attributes:
        rig: what is fitted. keys: those that are free; a point is an array of their values, shape (keys,).
        sigma: noise of each value, shape (rows, columns). fixed: values of keys that stay, SI, by name.
    """

    rig: Rig
    keys: tuple[Free, ...]
    sigma: Array
    fixed: dict[str, float] = field(default_factory=dict)

    @property
    def spans(self) -> Array:
        """Least and greatest values, and changes that tell, shape (3, keys)."""
        return np.array([(key.low, key.high, key.size) for key in self.keys], dtype=float).T

    def values(self, point: Array) -> dict[str, float]:
        """Values at a point, SI, by name."""
        return self.fixed | {key.name: value for key, value in zip(self.keys, point.tolist(), strict=True)}

    def residuals(self, point: Array) -> Array:
        """Computed less measured over noise, column by column, and behind them what was known before."""
        values, data = self.values(point), self.rig.data
        off = (self.rig.computed(values) - data.values) / self.sigma
        known = [key for key in self.keys if math.isfinite(key.deviation)]
        before = [(values[key.name] - key.start) / key.deviation for key in known]
        return np.append(off.T[data.counted.T], before)

    def with_key(self, key: Free) -> Problem:
        """The problem with one more key free, which is the last."""
        return replace(self, keys=(*self.keys, key))

    def solve(self, start: Array, steps: ArrayLike | None = None) -> End:
        """Search from a point, by differences over steps to both sides, in sizes, or else STEP to one."""
        from scipy.optimize import least_squares

        low, high, sizes = self.spans
        # variables that are near 1, for SciPy's steps are shares of them
        zero = np.array([key.low if key.held else key.start for key in self.keys]) - sizes

        def point(variables: Array) -> Array:
            return np.asarray(np.clip(zero + sizes * variables, low, high))

        try:
            end = least_squares(
                lambda variables: self.residuals(point(variables)),
                (np.clip(start, low, high) - zero) / sizes,
                bounds=[(limit - zero) / sizes for limit in (low, high)],
                jac="2-point" if steps is None else "3-point",
                diff_step=STEP if steps is None else steps,
                x_scale="jac",
                tr_solver="exact",
                ftol=ENOUGH,
                xtol=ENOUGH,
                max_nfev=MOST_ITERATIONS,
            )
        except ValueError as error:
            said = self.rig.refused or error
            raise Refused(f"the scene rejects values within the ranges: {said}") from error
        return End(self, point(end.x), end.fun, end.jac / sizes, bool(end.success))


@dataclass(frozen=True, eq=False)
class End(ByContent):
    """Where a search ended.

    Attributes:
        problem: that was solved. point: shape (keys,). residuals: over noise, shape (residuals,). slopes: of
            them along each key, shape (residuals, keys). ended: whether the search came to an end.
    """

    problem: Problem
    point: Array
    residuals: Array
    slopes: Array
    ended: bool

    @property
    def chi_squared(self) -> float:
        """Sum of the squares of the residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return self.residuals.size - self.point.size

    @property
    def parts(self) -> list[Array]:
        """Residuals of each column, and last those from what was known before."""
        return np.split(self.residuals, np.cumsum(self.problem.rig.data.counted.sum(axis=0)))

    @property
    def following(self) -> float:
        """Largest autocorrelation of a column."""
        return max(lag_one(part) for part in self.parts[:-1])

    @property
    def systematic(self) -> bool:
        """Tell whether residuals follow one another more than noise does by chance."""
        return self.following > self.problem.rig.data.chance

    @property
    def scatter(self) -> Array:
        """Noise of each column that is left, of what it weighs by; 1 where it is known, shape (columns,)."""
        squares = np.array([part @ part / part.size for part in self.parts[:-1]])
        left = np.sqrt(squares * self.residuals.size / self.freedom)
        return np.where(self.problem.rig.data.estimated & (left > 0.0), left, 1.0)

    @cached_property
    def weights(self) -> Array:
        """Weight of each residual by the noise that is left, shape (residuals,)."""
        return np.repeat(1.0 / np.append(self.scatter, 1.0), [part.size for part in self.parts])

    @property
    def weighed(self) -> Array:
        """The slopes, over the noise that is left."""
        return self.slopes * self.weights[:, None]

    @property
    def changes(self) -> Array:
        """How far each key, changed by its size, moves the residuals, of the noise that is left."""
        return np.asarray(np.linalg.norm(self.weighed, axis=0) * self.problem.spans[2])

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the keys, infinite where they cannot be told."""
        lengths = np.linalg.norm(self.weighed, axis=0)
        size = np.outer(lengths, lengths)
        squares = self.weighed.T @ self.weighed / np.where(size > 0.0, size, 1.0)
        try:
            return np.asarray(np.linalg.inv(squares) / size)
        except np.linalg.LinAlgError:
            return np.full(size.shape, math.inf)

    @property
    def deviations(self) -> Array:
        """Standard error of each key, infinite where it cannot be told."""
        squares = np.diag(self.covariance)
        return np.sqrt(np.where(squares > 0.0, squares, math.inf))

    @property
    def errors(self) -> dict[str, float]:
        """Standard error of each key, SI, by name; infinite where it cannot be told."""
        pairs = zip(self.problem.keys, self.deviations.tolist(), strict=True)
        return {key.name: deviation for key, deviation in pairs}

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlation of each pair of keys whose errors are known, by their names."""
        errors = self.errors
        places = {name: n for n, name in enumerate(errors) if math.isfinite(errors[name])}
        return {
            (one, other): float(self.covariance[places[one], places[other]]) / (errors[one] * errors[other])
            for one, other in itertools.combinations(places, 2)
        }

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Interval of 95 % of each key, SI, by name; all that it may be where they cannot be told.

        The limits of the last key are kept: where chi-squared is least beyond one, intervals are what that
        allows from there on.
        """
        from scipy.special import stdtrit

        keys, deviations = self.problem.keys, self.deviations
        if not np.isfinite(deviations).all():
            return {key.name: (key.low, key.high) for key in keys}
        most, last = float(stdtrit(self.freedom, 0.5 + 0.5 * CONFIDENCE)), deviations[-1]
        share = self.covariance[:, -1] / last
        # of the last one, where chi-squared is least, and its limits from there, in its standard errors
        least = -last * float(self.weighed[:, -1] @ (self.residuals * self.weights))
        low, high = ((end - self.point[-1]) / last - least for end in (keys[-1].low, keys[-1].high))
        reach = math.hypot(most, np.clip(0.0, low, high))
        # an end of the ellipse, or where it meets the limit
        held = np.clip(np.outer([-reach, reach], share / deviations), low, high)
        alone = np.sqrt(np.maximum(deviations**2 - share**2, 0.0))
        across = np.array([[-1.0], [1.0]]) * alone * np.sqrt(np.maximum(reach**2 - held**2, 0.0))
        found = {}
        for key, ends in zip(keys, (self.point + share * (least + held) + across).T.tolist(), strict=True):
            lower, upper = (min(max(end, key.low), key.high) for end in ends)
            found[key.name] = lower, upper
        return found

    def settled(self) -> End:
        """Search on with the noise that is left, until it stays, and find slopes as long as intervals."""
        end = self
        for _ in range(PASSES):
            scatter, changes = end.scatter, np.maximum(end.changes, 1.0 / LARGEST_STEP)
            problem = replace(end.problem, sigma=end.problem.sigma * scatter)
            end = problem.solve(end.point, np.maximum(1.0 / changes, SMALLEST_STEP))
            if np.allclose(scatter, 1.0, rtol=SETTLED):
                break
        return end.straightened()

    def straightened(self) -> End:
        """The end with slopes over REACH standard errors to both sides, along the axes of their ellipse."""
        if not np.isfinite(self.deviations).all():
            return self
        least, greatest, sizes = self.problem.spans
        squares, axes = np.linalg.eigh(self.covariance / np.outer(sizes, sizes))
        ways = sizes * np.minimum(REACH * np.sqrt(np.abs(squares)), LARGEST_STEP)[:, None] * axes.T
        low, high = (np.clip(self.point + side * ways, least, greatest) for side in (-1.0, 1.0))
        before, after = ([self.problem.residuals(point) for point in points] for points in (low, high))
        slopes = (np.linalg.pinv((high - low) / sizes) @ np.subtract(after, before)).T / sizes
        return replace(self, slopes=slopes) if np.isfinite(slopes).all() else self
