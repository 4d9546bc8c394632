"""Weighted least squares over free keys of a scene: the optimum, its Jacobian and its singular values.

SciPy's trust-region reflective method (Branch, Coleman and Li 1999) within the ranges of the keys.
Noise that is not specified is estimated from the residuals of each column, and the search is repeated with
this noise: iteratively reweighted least squares (Seber and Wild, Nonlinear Regression, 1989, section 2.8).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..common.equality import ByContent
from ..common.errors import ParameterError
from .axes import Free
from .measurement import Rig, autocorrelation

# iterations of the noise, and its relative change that ends them
MAX_NOISE_ITERATIONS, NOISE_RTOL = 3, 0.02
# difference step in a first search, and limits of later steps (one standard error); relative to the size of a
# key
SEARCH_STEP, MIN_STEP, MAX_STEP = 1e-3, 1e-5, 0.05
# relative change of chi-squared and of the keys that ends a search, and that ends a re-fit
SEARCH_RTOL, REFIT_RTOL = 1e-7, 1e-4
MAX_EVALUATIONS, MAX_REFIT_EVALUATIONS = 100, 12
# maximum distance from a bound at which a key is at the bound, relative to the size of the key
BOUND_RTOL = 1e-9
CONFIDENCE = 0.95

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Problem(ByContent):
    """Residuals as a function of the free keys.

    Attributes:
        rig: scene and measurement.
        keys: free keys; a point is an array of their values, shape (keys,).
        noise: standard deviation of each value, shape (rows, columns).
        fixed: values of other keys, SI, by name.
        priors: keys with a prior value, free or fixed.
    """

    rig: Rig
    keys: tuple[Free, ...]
    noise: Array
    fixed: dict[str, float] = field(default_factory=dict)
    priors: tuple[Free, ...] = ()

    @property
    def sizes(self) -> Array:
        """Scale of each key, shape (keys,)."""
        return np.array([key.size for key in self.keys])

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the keys, shape (keys,) each."""
        return np.array([key.low for key in self.keys]), np.array([key.high for key in self.keys])

    def values(self, point: Array) -> dict[str, float]:
        """Return the values of all keys at a point, SI, by name."""
        return self.fixed | {key.name: value for key, value in zip(self.keys, point.tolist(), strict=True)}

    def residuals(self, point: Array) -> Array:
        """Return (computed - measured) / noise, column after column, then the residuals of prior values."""
        values, data = self.values(point), self.rig.data
        scaled = (self.rig.computed(values) - data.values) / self.noise
        priors = [(values[key.name] - key.start) / key.deviation for key in self.priors]
        return np.append(scaled.T[data.counted.T], priors)

    def with_key(self, key: Free) -> Problem:
        """Return the problem with one more free key.

        Args:
            key: the key, which becomes the last one.
        """
        fixed = {name: value for name, value in self.fixed.items() if name != key.name}
        return replace(self, keys=(*self.keys, key), fixed=fixed)

    def without_key(self, number: int, value: float) -> Problem:
        """Return the problem with one of the free keys fixed at a value.

        Args:
            number: index of the key.
            value: the value, SI.
        """
        keys = self.keys[:number] + self.keys[number + 1 :]
        return replace(self, keys=keys, fixed=self.fixed | {self.keys[number].name: value})

    def minimise(
        self,
        start: Array,
        steps: Array | float = SEARCH_STEP,
        *,
        central: bool = False,
        refit: bool = False,
        jacobian: Array | None = None,
    ) -> Optimum:
        """Search the optimum from a point.

        Args:
            start: values of the keys, shape (keys,).
            steps: difference steps relative to the sizes of the keys; differences are one-sided at a bound.
            central: True for central differences, False for forward differences.
            refit: True for a few evaluations to REFIT_RTOL, from a start near the optimum.
            jacobian: constant Jacobian instead of differences (chord method), shape (residuals, keys).

        Raises:
            ParameterError: the scene rejects values within the ranges.
        """
        from scipy.optimize import least_squares

        sizes, (low, high) = self.sizes, self.bounds
        # the variables are near 2, because the difference steps of SciPy are relative to the variables
        origin = np.array([key.start for key in self.keys]) - 2.0 * sizes
        rtol = REFIT_RTOL if refit else SEARCH_RTOL

        def point(variables: Array) -> Array:
            return np.asarray(np.clip(origin + sizes * variables, low, high))

        differences = "3-point" if central else "2-point"
        try:
            if not self.keys:
                residuals = np.asarray_chkfinite(self.residuals(start))
                return Optimum(self, start, residuals, np.empty((residuals.size, 0)), True)
            result = least_squares(
                lambda variables: self.residuals(point(variables)),
                (np.clip(start, low, high) - origin) / sizes,
                bounds=((low - origin) / sizes, (high - origin) / sizes),
                jac=differences if jacobian is None else lambda variables: jacobian * sizes,
                diff_step=0.5 * np.asarray(steps),
                x_scale="jac",
                tr_solver="exact",
                ftol=rtol,
                xtol=rtol,
                max_nfev=MAX_REFIT_EVALUATIONS if refit else MAX_EVALUATIONS,
            )
        except ValueError as error:
            raise ParameterError(
                f"the scene rejects values within the ranges: {self.rig.rejection or error}"
            ) from error
        # SciPy keeps a small distance from the bounds
        best = point(result.x)
        for bound in (low, high):
            best = np.where(np.abs(best - bound) < BOUND_RTOL * sizes, bound, best)
        return Optimum(self, best, result.fun, result.jac / sizes, bool(result.success))


@dataclass(frozen=True, eq=False)
class Optimum(ByContent):
    """Optimum of a problem.

    Attributes:
        problem: residuals and keys.
        point: values of the keys, shape (keys,).
        residuals: residuals over noise, shape (residuals,).
        jacobian: Jacobian of the residuals, shape (residuals, keys).
        converged: True if the search ended within its number of evaluations.
    """

    problem: Problem
    point: Array
    residuals: Array
    jacobian: Array
    converged: bool

    @property
    def chi_squared(self) -> float:
        """Sum of the squared residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the residuals."""
        return self.residuals.size - self.point.size

    @property
    def parts(self) -> list[Array]:
        """Residuals of each column, then of the prior values."""
        return np.split(self.residuals, np.cumsum(self.problem.rig.data.counted.sum(axis=0)))

    @property
    def is_systematic(self) -> bool:
        """Return True if residuals are more autocorrelated than noise of a sensor."""
        limit = self.problem.rig.data.max_autocorrelation
        return any(autocorrelation(part) > limit for part in self.parts[:-1])

    @property
    def noise_ratios(self) -> Array:
        """Estimated over assumed noise of each column, shape (columns,); 1 for a specified noise."""
        mean_squares = np.array([part @ part / part.size for part in self.parts[:-1]])
        ratios = np.sqrt(mean_squares * self.residuals.size / self.freedom)
        return np.where(self.problem.rig.data.estimated & (ratios > 0.0), ratios, 1.0)

    @cached_property
    def svd(self) -> tuple[Array, Array]:
        """Singular values and right singular vectors of the Jacobian, with columns scaled by the sizes.

        A singular value is the change of the residuals over their noise if the keys change by their sizes
        along the vector. The last vector is the weakest direction: Brun, Reichert and Kuensch, Water
        Resources Research 37 (2001) 1015.
        """
        return np.linalg.svd(self.jacobian * self.problem.sizes, full_matrices=False)[1:]

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the keys, shape (keys, keys); huge along directions without influence."""
        singular, directions = self.svd
        scaled = directions.T / np.maximum(singular, 1e-9) * self.problem.sizes[:, None]
        return np.asarray(scaled @ scaled.T)

    @property
    def deviations(self) -> Array:
        """Standard error of each key in the linear model, shape (keys,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def steps(self) -> Array:
        """Difference steps of one standard error, relative to the sizes of the keys, shape (keys,)."""
        alone = 1.0 / np.maximum(np.linalg.norm(self.jacobian * self.problem.sizes, axis=0), 1e-9)
        return np.asarray(np.clip(alone, MIN_STEP, MAX_STEP))

    @property
    def t_quantile(self) -> float:
        """Two-sided quantile of Student's t, for intervals of CONFIDENCE."""
        from scipy.special import stdtrit

        return float(stdtrit(self.freedom, 0.5 + 0.5 * CONFIDENCE))

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlation of each pair of keys in the linear model, by their names."""
        scaled = self.covariance / np.outer(self.deviations, self.deviations)
        pairs = itertools.combinations(range(len(self.problem.keys)), 2)
        return {(self.problem.keys[a].name, self.problem.keys[b].name): float(scaled[a, b]) for a, b in pairs}

    def compensation(self, change: Array) -> Array:
        """Return the change of the keys that best compensates a change of the residuals, shape (keys,).

        Args:
            change: change of the residuals, shape (residuals,).
        """
        sizes = self.problem.sizes
        scaled = np.linalg.lstsq(self.jacobian * sizes, -change, rcond=1e-10)[0]
        return np.asarray(sizes * scaled)

    def without_key(self, number: int, value: float) -> Optimum:
        """Return the optimum with one of the keys fixed at a value.

        Args:
            number: index of the key.
            value: the value, SI.
        """
        return replace(
            self,
            problem=self.problem.without_key(number, value),
            point=np.delete(self.point, number),
            jacobian=np.delete(self.jacobian, number, axis=1),
        )

    def with_estimated_noise(self) -> Optimum:
        """Return the optimum of searches with estimated noise, repeated until the estimate is constant."""
        optimum = self
        for _ in range(MAX_NOISE_ITERATIONS):
            ratios = optimum.noise_ratios
            problem = replace(optimum.problem, noise=optimum.problem.noise * ratios)
            optimum = problem.minimise(optimum.point, optimum.steps, central=True)
            if np.allclose(ratios, 1.0, rtol=NOISE_RTOL):
                break
        return optimum
