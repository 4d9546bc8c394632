"""Least squares over free keys of a scene: where chi-squared is least, and how far off a key may be.

By SciPy's trust-region reflective search, over variables that are near 1 (axes.Free), weighted by the noise
of each column.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import Refused
from .axes import Free
from .measurement import Rig

# noise that is not known is found anew so often
PASSES = 3
# step of differences, of a range or a start value; later the standard error, the others held, within
# these: where freewheels switch from one row to the next slopes change over less, and would
# make intervals too narrow
STEP, SMALLEST_STEP, LARGEST_STEP = 1e-3, 1e-5, 0.05
# chi-squared and shares that change less end a search, and one for an end of an interval
ENOUGH, ROUGHLY = 1e-7, 1e-4
MOST_ITERATIONS = 100
# what all of a range changes, of the noise, without influence
NOTHING = 1e-2
CONFIDENCE = 0.95
# an end that is not there after so many steps, each twice the one before, is none
MOST_STEPS = 12
# the first of them, in standard errors
FARTHER = 2.2
# excess where the scene refuses a value
REFUSED = 1e6
# of an interval, so much is an end uncertain
EXACT = 1e-2

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Problem:
    """Which keys are free, and what weighs how much.

    Attributes:
        rig: what is fitted. keys: those that are free; a point is an array of their variables, shape (keys,).
        sigma: noise of each value, shape (rows, columns). known: keys of which something is known before.
        fixed: values of keys that stay, SI, by name.
    """

    rig: Rig
    keys: tuple[Free, ...]
    sigma: Array
    known: tuple[Free, ...] = ()
    fixed: dict[str, float] = field(default_factory=dict)

    @property
    def limits(self) -> tuple[Array, Array]:
        """Least and greatest variables."""
        low, high = np.reshape([key.limits for key in self.keys], (-1, 2)).T
        return low, high

    def values(self, point: Array) -> dict[str, float]:
        """Values at a point, SI, by name."""
        return self.fixed | {key.name: key.value(u) for key, u in zip(self.keys, point.tolist(), strict=True)}

    def _off(self, values: dict[str, float]) -> Array:
        """Computed less measured for values; 0 of what does not count."""
        data = self.rig.data
        return np.where(data.counted, self.rig.computed(values) - data.values, 0.0)

    def residuals(self, point: Array) -> Array:
        """Differences over noise, those that count, flat; behind them those from what was known before."""
        values = self.values(point)
        before = [(values[key.name] - key.start) / key.deviation for key in self.known]
        return np.append((self._off(values) / self.sigma)[self.rig.data.counted], before)

    def with_key(self, key: Free) -> Problem:
        """The problem with one more key free, which is the last."""
        return replace(self, keys=(*self.keys, key))

    def holding(self, values: dict[str, float]) -> Problem:
        """The problem with some of its keys fixed at values, SI."""
        keys = tuple(key for key in self.keys if key.name not in values)
        return replace(self, keys=keys, fixed=self.fixed | values)

    def with_noise_of(self, point: Array) -> Problem:
        """The problem with the noise of each column, where it is not known, from the residuals at a point."""
        data = self.rig.data
        share = data.counted.sum(axis=0) * (1.0 - point.size / data.number)
        found = np.sqrt(np.sum(self._off(self.values(point)) ** 2, axis=0) / share)
        return replace(self, sigma=np.where(data.estimated & (found > 0.0), found, self.sigma))

    def solve(
        self,
        start: Array,
        steps: ArrayLike = STEP,
        slopes: str = "2-point",
        enough: float = ENOUGH,
        exact: bool = False,
    ) -> End:
        """Search from a point.

        Args:
            start: a point. steps: of the differences, one or one a variable. slopes: by differences to one
                side or, "3-point", to both. enough: see ENOUGH. exact: for what all has an influence.

        Raises:
            Refused: the scene refuses the point, or so much about it that there are no slopes.
        """
        from scipy.optimize import least_squares

        if not self.keys:
            return End(self, start, self.residuals(start), np.empty((0, 0)), True)
        try:
            end = least_squares(
                self.residuals,
                np.clip(start, *self.limits),
                bounds=self.limits,
                jac=slopes,
                diff_step=steps,
                x_scale="jac",
                # lsmr soon ends where something has no influence, but takes no single variable
                tr_solver="exact" if exact or start.size == 1 else "lsmr",
                ftol=enough,
                xtol=enough,
                max_nfev=MOST_ITERATIONS,
            )
        except ValueError as error:
            said = self.rig.refused or error
            raise Refused(f"ranges must be such that the scene takes them: {said}") from error
        return End(self, end.x, end.fun, end.jac, bool(end.success))

    def weighed(self, end: End, begun: Callable[[End], End]) -> End:
        """An end with weights by the noise; what has no influence is put back to its start and held.

        Args:
            end: of a search with other weights. begun: passes on what a search begins from.
        """
        for n in range(PASSES):
            problem, told = begun(end).problem.with_noise_of(end.point), np.ones(end.point.size, dtype=bool)
            if n:
                # the search before had these weights, nearly
                told = end.changes >= NOTHING
            idle = {key.name: key.start for key, one in zip(problem.keys, told, strict=True) if not one}
            if not told.any():
                columns, names = self.rig.data.columns, [key.name for key in self.keys]
                raise Refused(
                    f"something free must have an influence on {', '.join(columns)}, none has of"
                    f" {', '.join(names)}"
                )
            end = problem.holding(idle).solve(end.point[told], end.steps[told], "3-point")
        return end


@dataclass(frozen=True)
class End:
    """Where a search ended.

    Attributes:
        problem: that was solved. point: shape (keys,). residuals: over noise, shape (residuals,). slopes: of
            them along each variable, shape (residuals, keys). ended: whether the search came to an end.
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
    def changes(self) -> Array:
        """How far each variable moves the residuals, of their noise."""
        return np.asarray(np.linalg.norm(self.slopes, axis=0))

    @property
    def steps(self) -> Array:
        """Standard error of each variable, the others held, as far as it is a step for differences."""
        changes = self.changes / math.sqrt(self.chi_squared / self.freedom or 1.0)
        return np.clip(1.0 / np.maximum(changes, 1.0 / LARGEST_STEP), SMALLEST_STEP, None)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the variables, infinite where they cannot be told."""
        try:
            found = np.linalg.inv(self.slopes.T @ self.slopes)
        except np.linalg.LinAlgError:
            found = np.full((self.point.size, self.point.size), math.inf)
        scale = self.chi_squared / self.freedom if self.problem.rig.data.estimated.any() else 1.0
        return np.asarray(found * scale)

    @property
    def errors(self) -> dict[str, float]:
        """Standard error of each key, SI, by name; infinite where it cannot be told."""
        squares = np.diag(self.covariance)
        deviations = np.sqrt(np.where(squares > 0.0, squares, math.inf)).tolist()
        return {k.name: abs(k.span) * one for k, one in zip(self.problem.keys, deviations, strict=True)}

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlation of each pair of keys whose errors are known, by their names."""
        spans, errors = np.array([key.span for key in self.problem.keys]), self.errors
        spread, pairs = self.covariance * np.outer(spans, spans), itertools.combinations(enumerate(errors), 2)
        return {
            (first, second): float(spread[n, m]) / (errors[first] * errors[second])
            for (n, first), (m, second) in pairs
            if math.isfinite(errors[first] * errors[second])
        }

    def interval(self, name: str) -> tuple[float, float]:
        """Interval of a key: all other values found anew, chi-squared has grown by what the F-test allows.

        Returns:
            Both ends, SI; an end of its range, or infinite, where there is none.
        """
        from scipy.stats import f

        problem = self.problem
        place = next(n for n, key in enumerate(problem.keys) if key.name == name)
        key, others = problem.keys[place], np.arange(self.point.size) != place
        allowed = math.sqrt(float(f.ppf(CONFIDENCE, 1, self.freedom)) * self.chi_squared / self.freedom)
        spread = self.covariance[:, place]
        along = np.nan_to_num(spread[others] / spread[place], posinf=0.0, neginf=0.0)

        def excess(u: float) -> float:
            """Root of what chi-squared has grown by at a value, over what is allowed: nearly a line."""
            held = problem.holding({name: key.value(u)})
            start = np.clip(self.point[others] + along * (u - self.point[place]), *held.limits)
            if not np.isfinite(held.residuals(start)).all():
                return REFUSED
            least = held.solve(start, self.steps[others], "3-point", ROUGHLY).chi_squared
            return math.sqrt(max(least - self.chi_squared, 0.0)) - allowed

        low, high = key.limits
        inside, step = float(self.point[place]), FARTHER * self.errors[name] / abs(key.span)
        if not math.isfinite(step):
            step = float(self.steps[place])
        ends = _end(excess, inside, -step, low), _end(excess, inside, step, high)
        least, greatest = sorted(map(key.value, ends))
        return least, greatest


def _end(excess: Callable[[float], float], inside: float, step: float, limit: float) -> float:
    """Find where the excess changes its sign, on the side of the step."""
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
