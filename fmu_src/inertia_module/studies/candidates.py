"""Candidate causes: fixed parameters and sensor errors that would explain the residuals of a fit.

Each candidate is released alone and the free keys are re-fitted. An F-test of the change of chi-squared gives
the p-value: Seber and Wild, Nonlinear Regression (1989), section 5.8. It is multiplied by the number of
candidates (Bonferroni). A candidate whose 2 ln L is more than 10 below the best one has essentially no
support: Burnham and Anderson, Model Selection and Multimodel Inference (2002), section 2.6.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from ..common.equality import ByContent
from ..common.errors import ParameterError
from ..common.terminal import Progress
from ..common.units import printed_unit
from ..interface.variables import PARAMETER, REAL, VARIABLES, Group
from ..scene import Scene
from ..scene.keys import MECHANISM
from .axes import Free, key_of_scene
from .least_squares import Array, Optimum
from .measurement import CLOCK, GAIN, OFFSET, SHIFT, Measurement, autocorrelation

# groups of parameters that are candidates; with a value of 0 only LOSSES and MASSES are
GROUPS = (Group.BEVEL, Group.PLANAR, Group.MASSES, Group.ELASTIC, Group.LOSSES)
ZERO_GROUPS = (Group.MASSES, Group.LOSSES)
# size of a candidate: relative to its value, or in SI units if its value is 0
RELATIVE_SIZE, ZERO_SIZE = 0.01, 1e-4
# change of the residuals along the difference step of a candidate, relative to the noise: aim and minimum
CHANGE, MIN_CHANGE = 5.0, 1e-3
# iterations for the length of the difference step
N_STEPS = 4
# maximum difference step relative to the size, for a candidate with another value than 0 and with the value 0
MAX_FACTOR, MAX_ZERO_FACTOR = 10.0, 1e3
# significance of a cause after the correction for the number of candidates
SIGNIFICANCE = 0.01
# collinearity index from which a candidate is inseparable: 1 % of its influence remains
MAX_COLLINEARITY = 100.0
# difference of 2 ln L up to which the data do not exclude a candidate
TIE = 10.0
# candidates that are re-fitted with their own Jacobian if one of them is significant
N_FULL_REFITS = 8


@dataclass(frozen=True, eq=False)
class Candidate(ByContent):
    """A candidate cause after its release.

    Attributes:
        name: name of the key.
        value: estimate, SI.
        error: standard error of the estimate, SI.
        nominal: value in the fit without the candidate, SI.
        unit: SI unit of these values, "" for none.
        chi_squared: chi-squared without and with the candidate, both for the noise of the fit with it.
        likelihood_ratio: 2 ln of the ratio of the likelihoods, for the effective number of values.
        p_value: p-value of the F-test, corrected for the number of candidates.
        values: values of the free keys with the candidate released, SI, by name.
        is_systematic: True if autocorrelated residuals remain.
        is_separable: True if the data can separate the candidate from the free keys.
        optimum: optimum with the candidate as the last key.
    """

    name: str
    value: float
    error: float
    nominal: float
    unit: str
    chi_squared: tuple[float, float]
    likelihood_ratio: float
    p_value: float
    values: dict[str, float]
    is_systematic: bool
    is_separable: bool
    optimum: Optimum = dataclasses.field(repr=False)

    @property
    def cause(self) -> str:
        """Noun phrase for the cause, with its value."""
        kind, _, column = self.name.partition(".")
        quantity = f"{self.value:.4g} {printed_unit(self.unit.removeprefix('1'))}".strip()
        if kind == OFFSET:
            return f"an offset of {quantity} in {column}"
        if kind == GAIN:
            return f"a gain of {quantity} in {column}"
        if kind == SHIFT:
            late = "late" if self.value > 0.0 else "early"
            source = "the clock of the file" if self.name == CLOCK else column
            return f"a time shift of {abs(1e3 * self.value):.3g} ms ({late}) in {source}"
        return f"{self.name} = {quantity} instead of {self.nominal:.4g}"

    @property
    def option(self) -> str:
        """Argument of --free that releases the candidate."""
        is_sensor = self.name.startswith((OFFSET, GAIN, SHIFT))
        return self.name if self.nominal or is_sensor else f"{self.name}=0:{3.0 * abs(self.value):.1g}"

    @property
    def text(self) -> str:
        """Line with the estimate, the F-test and the values of the free keys."""
        before, after = self.chi_squared
        estimate = f"{self.value:.4g} ± {self.error:.2g} {printed_unit(self.unit.removeprefix('1'))}".rstrip()
        values = "; ".join(f"{name} {value:.5g}" for name, value in self.values.items())
        return f"{estimate}, chi-squared {before:,.0f} → {after:,.0f}, p = {self.p_value:.2g}; {values}"


def candidate_keys(scene: Scene, data: Measurement, excluded: Collection[str]) -> list[Free]:
    """Return the keys of the candidates: sensors, geometry, masses, losses, numbers of drive and load.

    Args:
        scene: the fitted scene.
        data: measurement with the sensors.
        excluded: names of the free and exact keys.
    """
    keys = [key for key in data.sensors.values() if key.name != CLOCK or len(data.columns) > 1]
    for variable in VARIABLES:
        if variable.causality == PARAMETER and variable.kind == REAL and variable.group in GROUPS:
            key = key_of_scene(f"{MECHANISM}{variable.name}", scene)
            keys += [key] if key.start or variable.group in ZERO_GROUPS else []
    for part in ("drive", "load"):
        numbers = [name for name, value in getattr(scene, part) if isinstance(value, float) and value]
        keys += [key_of_scene(f"{part}.{name}", scene) for name in numbers]
    return [
        dataclasses.replace(key, size=RELATIVE_SIZE * key.size or ZERO_SIZE)
        for key in keys
        if key.name not in excluded
    ]


def released(optimum: Optimum, key: Free) -> Optimum | None:
    """Re-fit with a candidate released by Gauss-Newton steps; return None if it has no influence.

    The derivative with respect to the candidate is a difference quotient. Along its step the free keys
    compensate the candidate, and the residuals change by about CHANGE. Without the compensation, curvature
    would hide the part of the change that the free keys cannot compensate. The Jacobian stays constant (chord
    method).

    Args:
        optimum: optimum of the fit without candidates.
        key: the candidate.
    """
    problem = optimum.problem.with_key(key)
    reach = key.size * (MAX_FACTOR if key.start else MAX_ZERO_FACTOR)
    low, high = max(key.low - key.start, -reach), min(key.high - key.start, reach)
    step, along, derivative = key.size if high > 0.0 else -key.size, np.zeros(optimum.point.size), None
    for number in range(N_STEPS):
        step = min(max(step, low), high)
        change = problem.residuals(np.append(optimum.point + step * along, key.start + step))
        change -= optimum.residuals
        if not np.isfinite(change).all():
            step *= 0.1
            continue
        if np.linalg.norm(change) < MIN_CHANGE:
            break
        derivative = (change - step * optimum.jacobian @ along) / step
        compensation = optimum.compensation(change)
        along = along + compensation / step
        remainder = float(np.linalg.norm(change + optimum.jacobian @ compensation))
        if number < N_STEPS - 2:  # the last two steps are equal, so that the compensation converges
            step *= float(np.clip(CHANGE / max(remainder, 1e-12), 1.0 / MAX_ZERO_FACTOR, MAX_ZERO_FACTOR))
    if derivative is None:
        return None
    jacobian = np.column_stack([optimum.jacobian, derivative])
    return problem.minimise(np.append(optimum.point, key.start), jacobian=jacobian, refit=True)


def _sums_of_squares(optimum: Optimum) -> tuple[Array, float]:
    """Return the sum of squared residuals of each column, over its noise, and the sum of the prior values."""
    *columns, prior = (float(part @ part) for part in optimum.parts)
    units = np.where(optimum.problem.rig.data.estimated, optimum.problem.noise[0], 1.0)
    return np.maximum(columns * units**2, 1e-30), prior


def _effective_numbers(optimum: Optimum) -> Array:
    """Return the number of effectively independent rows of each column (Bartlett 1935), shape (columns,)."""
    lag_1 = np.maximum([autocorrelation(part) for part in optimum.parts[:-1]], 0.0)
    number = optimum.problem.rig.data.counted.sum(axis=0)
    return np.asarray(number * (1.0 - lag_1) / (1.0 + lag_1))


def likelihood_ratio(restricted: Optimum, full: Optimum) -> float:
    """Return 2 ln of the ratio of the likelihoods of a full and a restricted model.

    A noise that is not specified is estimated in each model. A specified noise is the minimum.

    Args:
        restricted: optimum without the additional key.
        full: optimum with it.
    """
    data = full.problem.rig.data
    (before, prior_before), (after, prior_after) = _sums_of_squares(restricted), _sums_of_squares(full)
    mean_square = after / data.counted.sum(axis=0)
    specified = (before / after - 1.0) * np.minimum(mean_square, 1.0)
    gains = np.where(data.estimated, np.log(before / after), specified)
    return float(gains @ _effective_numbers(full)) + prior_before - prior_after


def f_test(restricted: Optimum, full: Optimum) -> float:
    """Return the p-value of the F-test of one released key.

    Args:
        restricted: optimum without the key.
        full: optimum with it.
    """
    from scipy.stats import f

    number = float(_effective_numbers(full).sum())
    freedom = number - full.point.size
    # for one column, exp(2 ln L / n) is the ratio of the sums of squares
    ratio = max(likelihood_ratio(restricted, full), 0.0) / number
    return float(f.sf(freedom * math.expm1(min(ratio, 500.0)), 1, freedom)) if freedom >= 1.0 else 1.0


def causes(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the best candidate and those that the data do not exclude; none if the best is not significant.

    Args:
        candidates: the tested candidates.
    """
    best = max(candidates, key=lambda candidate: candidate.likelihood_ratio, default=None)
    if best is None or best.p_value > SIGNIFICANCE:
        return []
    return [candidate for candidate in candidates if candidate.likelihood_ratio > best.likelihood_ratio - TIE]


def release_candidates(
    optimum: Optimum, keys: Sequence[Free], start: Array, progress: Progress
) -> list[Candidate]:
    """Release candidates one at a time, test them and return them, the most significant first.

    If one is significant, the best N_FULL_REFITS are fitted in full. If residuals remain systematic, the fit
    may have ended in a local minimum. All candidates are then fitted from the start point of the fit.

    Args:
        optimum: optimum of the fit without candidates.
        keys: keys of the candidates.
        start: start point of the fit, shape (keys,).
        progress: function that receives the completed share, 0 to 1.
    """
    optima: dict[str, Optimum] = {}
    for n, key in enumerate(keys):
        progress(0.5 * n / len(keys))
        candidate = released(optimum, key)
        if candidate is not None:
            optima[key.name] = candidate

    def ranked() -> list[str]:
        return sorted(optima, key=lambda name: -likelihood_ratio(optimum, optima[name]))

    def fit(name: str, point: Array) -> None:
        with contextlib.suppress(ParameterError):
            refit = optima[name].problem.minimise(point, refit=True)
            if likelihood_ratio(optima[name], refit) >= 0.0:
                optima[name] = refit.with_estimated_noise()

    best = ranked()[:N_FULL_REFITS]
    if best and f_test(optimum, optima[best[0]]) * len(optima) < SIGNIFICANCE:
        for name in best:
            fit(name, optima[name].point)
    if optimum.is_systematic and all(optima[name].is_systematic for name in ranked()[:1]):
        for n, key in enumerate(key for key in keys if key.name in optima):
            progress(0.5 + 0.5 * n / len(optima))
            fit(key.name, np.append(start, key.start))
    return [
        _candidate(optimum, optima[name], min(f_test(optimum, optima[name]) * len(optima), 1.0))
        for name in ranked()
    ]


def collinearity(restricted: Optimum, full: Optimum) -> float:
    """Return the collinearity index of the last key of a full model with the other keys.

    The other keys compensate a change of this key, except for a fraction of 1 / index: Brun, Reichert and
    Kuensch, Water Resources Research 37 (2001) 1015.

    Args:
        restricted: optimum without the key.
        full: optimum with it.
    """
    derivative = full.jacobian[:, -1]
    remainder = derivative + restricted.jacobian @ restricted.compensation(derivative)
    return float(np.linalg.norm(derivative)) / max(float(np.linalg.norm(remainder)), 1e-300)


def _candidate(restricted: Optimum, full: Optimum, p_value: float) -> Candidate:
    """Return a candidate from the optima without and with it."""
    data, key, values = full.problem.rig.data, full.problem.keys[-1], full.problem.values(full.point)
    sums = _sums_of_squares(restricted), _sums_of_squares(full)
    noise = np.where(data.estimated, sums[1][0] / data.counted.sum(axis=0), 1.0)
    before, after = (float(np.sum(columns / noise)) + prior for columns, prior in sums)
    return Candidate(
        name=key.name,
        value=values[key.name],
        error=float(full.deviations[-1]),
        nominal=key.start,
        unit=key.unit,
        chi_squared=(before, after),
        likelihood_ratio=likelihood_ratio(restricted, full),
        p_value=p_value,
        values={key.name: values[key.name] for key in restricted.problem.keys},
        is_systematic=full.is_systematic,
        is_separable=collinearity(restricted, full) < MAX_COLLINEARITY,
        optimum=full,
    )
