"""Fit: values of a scene's keys at which it computes what was measured, and how well the data tell them.

Least squares by lmfit (Newville et al., doi:10.5281/zenodo.11813), trust-region reflective, weighted by the
noise of each column.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..common.errors import Refused
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER
from ..harness.fmu import fmu_file
from ..harness.simulate import Progress, Result
from ..scene import Scene
from .axes import shares_sampled
from .evaluator import read
from .fitted import FitResult, correlations, doubts, fitted
from .free import Free, Range, free_keys
from .intervals import interval
from .measurement import Array, Measurement, measurement
from .observed import Observer

# of the points looked at, as many of the best are starts of a search
SEARCHED = 3
# searches that end so near, of chi-squared, ended at the same
SAME = 0.01
# noise that is not known is found anew so often
PASSES = 3
# step of differences, of a range or a start value; later the standard error, the others held, within
# these: where freewheels switch from one row to the next slopes change over less, and would
# make intervals too narrow
STEP, SMALLEST_STEP, LARGEST_STEP = 1e-3, 1e-5, 0.05
# chi-squared and shares that change less end a search
ENOUGH = 1e-7
MOST_RUNS = 500
# what all of a range changes, of the noise, without influence
NOTHING = 1e-2


def fit(
    measured: Result | Path | str,
    scene: Scene | Path | str,
    free: Sequence[str] | Mapping[str, Range],
    *,
    columns: Sequence[str] = (),
    starts: int = 16,
    seed: int = 0,
    output: Path | str | None = None,
    fmu: Path | str | None = None,
    progress: Progress | None = None,
) -> FitResult:
    """Fit keys of a scene to a measurement; leave the fitted scene, the residuals and the numbers.

    Args:
        measured: a table, or a CSV file; see measurement. scene: a scene, or its file.
        free: "NAME" or "NAME=LOW:HIGH" each, or ranges (or None) by name; NAME is a key of the scene by dots,
            or a parameter of the mechanism.
        columns: those that are compared, by default all that the scene computes.
        starts: points of the ranges (Latin hypercube) that are looked at besides the scene's own values; the
            best SEARCHED of all are starts of a search.
        seed: of these points: same seed, same result.
        output: folder, by default out/SCENE_fit.
        fmu: its file, by default that of the package (current_fmu).
        progress: told the share done.

    Raises:
        Refused: the scene, the measurement or what is free is not as above, nothing free has an influence, or
            the scene refuses all values tried, in one sentence.
        NotInstalled: the extra jobs is not.
    """
    for name in ("lmfit", "tomli_w"):
        library(name, "jobs")
    base, title = read(scene)
    keys = free_keys(free, base)
    data = measurement(measured, base, columns)
    if int(data.counted.sum()) <= len(keys):
        raise Refused(
            f"there must be more measured values than free keys, {len(keys)}, are {int(data.counted.sum())}"
        )
    if starts < 0:
        raise Refused(f"starts must be at least 0, is {starts}")
    search = _Search(base, keys, data, fmu_file(fmu), progress or (lambda share: None))
    with search.observer:
        found = search.found(starts, seed)
    folder = OUTPUT_FOLDER / f"{title}_fit" if output is None else Path(output)
    return dataclasses.replace(found, files=found.write(folder))


class _Search:
    """The search of one fit, over the variables of what is free."""

    def __init__(
        self, scene: Scene, keys: list[Free], data: Measurement, fmu: Path, progress: Progress
    ) -> None:
        self.scene, self.keys, self.data, self.progress = scene, keys, data, progress
        self.observer = Observer(fmu, data.columns, data.table.time)
        self.runs, self.refused, self.done, self.stages = 0, "", 0, 1
        values = data.values
        spread = np.where(np.ptp(values, axis=0) > 0.0, values.std(axis=0), 1.0)
        self.sigma: Array = np.broadcast_to(spread, values.shape).copy()
        for place, name in enumerate(data.columns):
            if name in data.noise:
                self.sigma[:, place] = data.noise[name]

    def computed(self, variables: Sequence[float]) -> Array:
        """Columns that the scene computes, shape (rows, columns); NaN where it refuses the values."""
        self.runs += 1
        point = {key.name: key.value(u) for key, u in zip(self.keys, variables, strict=True)}
        try:
            return self.observer(self.scene.with_keys(point))
        except Refused as error:
            self.refused = str(error)
            return np.full(self.data.values.shape, np.nan)

    def residuals(self, variables: Sequence[float]) -> Array:
        """Differences over noise, those that count, flat."""
        differences = (self.computed(variables) - self.data.values) / self.sigma
        return differences[self.data.counted]

    def found(self, starts: int, seed: int) -> FitResult:
        """Look at points, search from the best of them, then find the noise."""
        begun = map(self._told, self._begun(starts, seed))
        ends = sorted(map(self._minimised, begun), key=lambda end: float(end.chisqr))
        best, held = self._weighted(ends[0])
        computed = self.computed(self._variables(best))
        parameters, names = fitted(self.keys, best, self._intervals(best, held)), self.data.columns
        result = FitResult(
            scene=self.scene.with_keys({one.name: one.value for one in parameters}),
            parameters=parameters,
            correlations=correlations(self.keys, best),
            measurement=self.data,
            computed=Result({"time": self.data.table.time, **dict(zip(names, computed.T, strict=True))}),
            noise=dict(zip(names, np.sqrt(np.mean(self.sigma**2, axis=0)).tolist(), strict=True)),
            estimated=[name for name in names if name not in self.data.noise],
            chi_squared=float(best.redchi),
            same_end=(sum(bool(end.chisqr <= (1.0 + SAME) * ends[0].chisqr) for end in ends), len(ends)),
            runs=self.runs,
        )
        return dataclasses.replace(result, warnings=doubts(result, bool(best.success)))

    def _variables(self, end: Any) -> list[float]:
        return [float(end.params[key.identifier].value) for key in self.keys]

    def _begun(self, starts: int, seed: int) -> list[list[float]]:
        """Points at which searches begin: of those looked at the best."""
        points = [[key.start for key in self.keys]]
        if starts and any(key.range for key in self.keys):
            for shares in shares_sampled(len(self.keys), f"latin:{starts}", seed).tolist():
                points.append([key.spread(share) for key, share in zip(self.keys, shares, strict=True)])
        self.stages = len(points) + min(SEARCHED, len(points)) + PASSES + len(self.keys)
        costs = np.array([np.sum(self.residuals(point) ** 2) for point in map(self._told, points)])
        if not np.isfinite(costs).any():
            raise Refused(f"the scene must take values of what is free, refuses all tried: {self.refused}")
        return [points[n] for n in np.argsort(costs)[:SEARCHED] if np.isfinite(costs[n])]

    def _told(self, point: list[float]) -> list[float]:
        """A point, its stage told to be done."""
        self.done += 1
        self.progress(self.done / self.stages)
        return point

    def _minimised(
        self, start: list[float], held: Sequence[str] = (), steps: Any = STEP, slopes: str = "2-point"
    ) -> Any:
        """The MinimizerResult of lmfit from a start.

        Args:
            held: identifiers of what stays where it is. steps: of the differences, one or one a variable.
            slopes: by differences to one side or, "3-point", to both.
        """
        import lmfit

        variables = lmfit.Parameters()
        for key, u in zip(self.keys, start, strict=True):
            variables.add(key.identifier, u, vary=key.identifier not in held, min=key.low, max=key.high)

        def residuals(given: Any) -> Array:
            return self.residuals([given[key.identifier].value for key in self.keys])

        # lsmr soon ends where something has no influence, but takes no single variable
        solver = "lsmr" if len(self.keys) - len(held) > 1 else "exact"
        known = len(self.data.noise) == len(self.data.columns)
        minimizer = lmfit.Minimizer(
            residuals, variables, scale_covar=not known, nan_policy="propagate", max_nfev=MOST_RUNS
        )
        try:
            return minimizer.least_squares(
                jac=slopes, diff_step=steps, x_scale="jac", tr_solver=solver, ftol=ENOUGH, xtol=ENOUGH
            )
        except ValueError as error:
            raise Refused(
                f"ranges must be such that the scene takes them: {self.refused or error}"
            ) from error

    def _weighted(self, best: Any) -> tuple[Any, list[str]]:
        """The end with weights by the noise, and what has no influence, which is put back to its start."""
        held: list[str] = []
        for n in range(PASSES):
            start = self._variables(best)
            self._weigh(start, len(best.var_names))
            if n:
                # the one before has these weights, nearly
                held += self._without_influence(best)
            if len(held) == len(self.keys):
                raise Refused(
                    f"something free must have an influence on {', '.join(self.data.columns)}, none has of"
                    f" {', '.join(key.name for key in self.keys)}"
                )
            start = [
                key.start if key.identifier in held else u for key, u in zip(self.keys, start, strict=True)
            ]
            steps = self._errors(best)[[name not in held for name in best.var_names]]
            best = self._minimised(self._told(start), held, steps, "3-point")
        return best, held

    def _intervals(self, best: Any, held: Sequence[str]) -> dict[str, tuple[float, float]]:
        """Interval of each variable that is not held."""
        start, found = self._variables(best), {}
        steps = dict(zip(best.var_names, self._errors(best), strict=True))
        for place, key in enumerate(self.keys):
            if key.identifier in held:
                continue
            others = [step for name, step in steps.items() if name != key.identifier]

            def least(u: float, place: int = place, others: Sequence[float] = others) -> float:
                point = [*start[:place], u, *start[place + 1 :]]
                if not others:
                    return float(np.sum(self.residuals(point) ** 2))
                end = self._minimised(point, [*held, self.keys[place].identifier], others, "3-point")
                return float(end.chisqr)

            step, within = steps[key.identifier], (key.low, key.high)
            found[key.identifier] = interval(least, best.chisqr, start[place], step, best.nfree, within)
            self._told(start)
        return found

    @staticmethod
    def _errors(end: Any) -> Array:
        """Standard error of each variable, the others held, as far as it is a step for differences."""
        changes = np.sqrt(np.sum(np.asarray(end.jac) ** 2, axis=0) / (end.redchi or 1.0))
        steps: Array = np.clip(1.0 / np.maximum(changes, 1.0 / LARGEST_STEP), SMALLEST_STEP, None)
        return steps

    def _weigh(self, variables: list[float], free: int) -> None:
        """Take the noise of each column where it is not known from its residuals."""
        differences = np.where(self.data.counted, self.computed(variables) - self.data.values, 0.0)
        number = self.data.counted.sum(axis=0)
        share = 1.0 - free / self.data.counted.sum()
        found = np.sqrt(np.sum(differences**2, axis=0) / (number * share))
        for place, name in enumerate(self.data.columns):
            if name not in self.data.noise and found[place] > 0.0:
                self.sigma[:, place] = found[place]

    def _without_influence(self, end: Any) -> list[str]:
        """Identifiers of what changes nothing over its range, or as it doubles."""
        changes = np.sqrt(np.sum(np.asarray(end.jac) ** 2, axis=0))
        return [name for name, change in zip(end.var_names, changes, strict=True) if change < NOTHING]
