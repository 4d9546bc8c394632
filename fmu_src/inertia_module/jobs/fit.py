"""Fit: values of a scene's keys at which it computes what was measured, and how well the data tell them.

Least squares by lmfit (Newville et al., doi:10.5281/zenodo.11813), trust-region reflective, weighted by the
noise of each column.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..common.errors import Refused
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER
from ..harness.fmu import fmu_file
from ..harness.results import write_text
from ..harness.simulate import Progress, Result
from ..scene import Scene
from ..scene.reading import scene_text
from .axes import Free, Range, free_keys, shares_sampled
from .evaluation import read
from .measurement import Array, Measurement, Observer, measurement

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
# of the intervals
CONFIDENCE = 0.95
# an end that is not there after so many steps, each twice the one before, is none
MOST_STEPS = 12
# of an interval, so much is an end uncertain
EXACT = 1e-2
# correlations from here on are warned of
CORRELATED = 0.95
# so near to an end of its range, of the range, a value is at it
AT_END = 1e-4
# residuals whose autocorrelation at lag 1 is as much as this are not the noise of a sensor
AUTOCORRELATED = 0.2
# standard deviations of chance that a warning keeps from
CHANCE = 4.0
NO_INFLUENCE = "has no influence on what was measured, stays where it was"
NOT_IDENTIFIABLE = "not identifiable from the data: the interval is {}"


@dataclass(frozen=True)
class Fitted:
    """A free key.

    Attributes:
        name: by dots. value, error: the value and its standard error, SI. interval: of 95 %; what is not
            known of error and interval is infinite. unit: "" for none. doubt: what is wrong with it, or "".
    """

    name: str
    value: float
    error: float
    interval: tuple[float, float]
    unit: str
    doubt: str = ""

    @property
    def text(self) -> str:
        """Value, interval and what is wrong with it, in a line."""
        low, high = self.interval
        if not math.isfinite(high - low):
            return f"{self.value:.6g} {self.unit}, {self.doubt}"
        doubt = f", {self.doubt}" if self.doubt else ""
        return f"{self.value:.6g} {self.unit}, from {low:.6g} to {high:.6g}{doubt}"


@dataclass(frozen=True)
class FitResult:
    """Result of a fit.

    Attributes:
        scene: with the values found. parameters: the free keys. correlations: by pairs of them.
        measurement: what was fitted. computed: by the fitted scene, at the same times.
        noise: standard deviation by column, RMS. estimated: columns whose noise was found from the residuals.
        chi_squared: of the residuals over noise, over degrees of freedom. same_end: how many searches ended
            at the best, of how many. runs: of the scene. warnings: sentences. files: written, by kind.
    """

    scene: Scene
    parameters: list[Fitted]
    correlations: dict[tuple[str, str], float]
    measurement: Measurement
    computed: Result
    noise: dict[str, float]
    estimated: list[str]
    chi_squared: float
    same_end: tuple[int, int]
    runs: int
    warnings: list[str] = field(default_factory=list)
    files: dict[str, Path] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Fitted:
        """A free key, by dots or, of the mechanism, by its bare name."""
        return next(one for one in self.parameters if name in (one.name, one.name.rpartition(".")[2]))

    def as_dict(self) -> dict[str, Any]:
        """For machines; what is not known is null."""
        return {
            "parameters": {
                one.name: {
                    "value": one.value,
                    "unit": one.unit,
                    "standard_error": one.error if math.isfinite(one.error) else None,
                    "interval": [end if math.isfinite(end) else None for end in one.interval],
                    "doubt": one.doubt,
                }
                for one in self.parameters
            },
            "correlations": [[*pair, number] for pair, number in self.correlations.items()],
            "noise": {
                name: {
                    "value": value,
                    "unit": self.measurement.table.units[name],
                    "estimated": name in self.estimated,
                }
                for name, value in self.noise.items()
            },
            "chi_squared": self.chi_squared,
            "values": int(self.measurement.counted.sum()),
            "searches_that_agree": list(self.same_end),
            "runs": self.runs,
            "warnings": self.warnings,
        }

    def lines(self) -> dict[str, str]:
        """Give the lines of the printed table, by heading."""
        correlated = {
            f"correlation of {a} and {b}": f"{number:.3f}" for (a, b), number in self.correlations.items()
        }
        units = self.measurement.table.units
        source = {name: ", from the residuals" if name in self.estimated else "" for name in units}
        noise = {
            f"noise of {name}": f"{value:.4g} {units[name]}{source[name]}"
            for name, value in self.noise.items()
        }
        values = {one.name: one.text for one in self.parameters}
        agree = "{} of {}".format(*self.same_end)
        return {**values, **correlated, **noise, "searches that end there": agree, "runs": str(self.runs)}

    def table(self) -> Result:
        """Measured, computed and residual (computed less measured) of each column over time."""
        columns, units, measured = {"time": self.computed.time}, {"time": "s"}, self.measurement.table
        for name in self.measurement.columns:
            values = measured[name], self.computed[name], self.computed[name] - measured[name]
            for kind, found in zip(("measured", "computed", "residual"), values, strict=True):
                columns[f"{name}_{kind}"], units[f"{name}_{kind}"] = found, measured.units[name]
        return Result(columns, units)

    def write(self, folder: Path) -> dict[str, Path]:
        """Write fitted.toml, residuals.csv and fit.json, each whole or not at all."""
        return {
            "scene": write_text(folder / "fitted.toml", scene_text(self.scene)),
            "residuals": self.table().to_csv(folder / "residuals.csv"),
            "fit": write_text(folder / "fit.json", json.dumps(self.as_dict(), indent=2) + "\n"),
        }


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
        found = search.run(starts, seed)
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

    def run(self, starts: int, seed: int) -> FitResult:
        """Look at points, search from the best of them, then find the noise."""
        begun = map(self._count_stage, self._starts(starts, seed))
        ends = sorted(map(self._minimise, begun), key=lambda end: float(end.chisqr))
        best, held = self._weighted(ends[0])
        computed = self.computed(self._variables(best))
        parameters, names = _parameters(self.keys, best, self._intervals(best, held)), self.data.columns
        result = FitResult(
            scene=self.scene.with_keys({one.name: one.value for one in parameters}),
            parameters=parameters,
            correlations=_correlations(self.keys, best),
            measurement=self.data,
            computed=Result({"time": self.data.table.time, **dict(zip(names, computed.T, strict=True))}),
            noise=dict(zip(names, np.sqrt(np.mean(self.sigma**2, axis=0)).tolist(), strict=True)),
            estimated=[name for name in names if name not in self.data.noise],
            chi_squared=float(best.redchi),
            same_end=(sum(bool(end.chisqr <= (1.0 + SAME) * ends[0].chisqr) for end in ends), len(ends)),
            runs=self.runs,
        )
        return dataclasses.replace(result, warnings=_warnings(result, bool(best.success)))

    def _variables(self, end: Any) -> list[float]:
        return [float(end.params[key.identifier].value) for key in self.keys]

    def _starts(self, starts: int, seed: int) -> list[list[float]]:
        """Points at which searches begin: of those looked at the best."""
        points = [[key.start for key in self.keys]]
        if starts and any(key.range for key in self.keys):
            for shares in shares_sampled(len(self.keys), f"latin:{starts}", seed).tolist():
                points.append([key.spread(share) for key, share in zip(self.keys, shares, strict=True)])
        self.stages = len(points) + min(SEARCHED, len(points)) + PASSES + len(self.keys)
        costs = np.array([np.sum(self.residuals(point) ** 2) for point in map(self._count_stage, points)])
        if not np.isfinite(costs).any():
            raise Refused(f"the scene must take values of what is free, refuses all tried: {self.refused}")
        return [points[n] for n in np.argsort(costs)[:SEARCHED] if np.isfinite(costs[n])]

    def _count_stage(self, point: list[float]) -> list[float]:
        """Pass a point on, its stage counted as done."""
        self.done += 1
        self.progress(self.done / self.stages)
        return point

    def _minimise(
        self, start: list[float], held: Sequence[str] = (), steps: Any = STEP, slopes: str = "2-point"
    ) -> Any:
        """Search from a start; the MinimizerResult of lmfit.

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
            self._estimate_noise(start, len(best.var_names))
            if n:
                # the search before had these weights, nearly
                changes = zip(best.var_names, np.sqrt(_squares(best)), strict=True)
                held += [name for name, change in changes if change < NOTHING]
            if len(held) == len(self.keys):
                raise Refused(
                    f"something free must have an influence on {', '.join(self.data.columns)}, none has of"
                    f" {', '.join(key.name for key in self.keys)}"
                )
            start = [
                key.start if key.identifier in held else u for key, u in zip(self.keys, start, strict=True)
            ]
            steps = _steps(best)[[name not in held for name in best.var_names]]
            best = self._minimise(self._count_stage(start), held, steps, "3-point")
        return best, held

    def _estimate_noise(self, variables: list[float], free: int) -> None:
        """Take the noise of each column where it is not known from its residuals."""
        differences = np.where(self.data.counted, self.computed(variables) - self.data.values, 0.0)
        number = self.data.counted.sum(axis=0)
        share = 1.0 - free / self.data.counted.sum()
        found = np.sqrt(np.sum(differences**2, axis=0) / (number * share))
        for place, name in enumerate(self.data.columns):
            if name not in self.data.noise and found[place] > 0.0:
                self.sigma[:, place] = found[place]

    def _intervals(self, best: Any, held: Sequence[str]) -> dict[str, tuple[float, float]]:
        """Interval of each variable that is not held."""
        start, found = self._variables(best), {}
        steps = dict(zip(best.var_names, _steps(best), strict=True))
        for place, key in enumerate(self.keys):
            if key.identifier in held:
                continue
            others = [step for name, step in steps.items() if name != key.identifier]

            def least(u: float, place: int = place, others: Sequence[float] = others) -> float:
                point = [*start[:place], u, *start[place + 1 :]]
                if not others:
                    return float(np.sum(self.residuals(point) ** 2))
                end = self._minimise(point, [*held, self.keys[place].identifier], others, "3-point")
                return float(end.chisqr)

            step, within = steps[key.identifier], (key.low, key.high)
            found[key.identifier] = _interval(least, best.chisqr, start[place], step, best.nfree, within)
            self._count_stage(start)
        return found


def _squares(end: Any) -> Array:
    """Sum of the squares of the residuals' slopes along each variable."""
    squares: Array = np.sum(np.asarray(end.jac) ** 2, axis=0)
    return squares


def _steps(end: Any) -> Array:
    """Standard error of each variable, the others held, as far as it is a step for differences."""
    changes = np.sqrt(_squares(end) / (end.redchi or 1.0))
    steps: Array = np.clip(1.0 / np.maximum(changes, 1.0 / LARGEST_STEP), SMALLEST_STEP, None)
    return steps


def _interval(
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


def _parameters(
    keys: Sequence[Free], best: Any, intervals: Mapping[str, tuple[float, float]]
) -> list[Fitted]:
    """Free keys as they were found.

    Args:
        best: MinimizerResult of lmfit. intervals: of each variable that has an influence, by identifier.
    """
    found = []
    for key in keys:
        one = best.params[key.identifier]
        value, error, interval = key.value(one.value), math.inf, (-math.inf, math.inf)
        doubt = NO_INFLUENCE
        if key.identifier in intervals:
            low, high = sorted(map(key.value, intervals[key.identifier]))
            interval = low, high
            error = math.inf if one.stderr is None else abs(key.span) * float(one.stderr)
            doubt = _doubt(key, one.value, high - low)
        found.append(Fitted(key.name, value, error, interval, key.unit, doubt))
    return found


def _doubt(key: Free, variable: float, width: float) -> str:
    """Say what is wrong with a value; width: of its interval, SI."""
    if key.range is None:
        wide = width > 2.0 * abs(key.value(variable))
        return NOT_IDENTIFIABLE.format("wider than twice the value") if wide else ""
    if width >= (1.0 - AT_END) * abs(key.span):
        return NOT_IDENTIFIABLE.format("as wide as its range")
    return "is at the end of its range" if min(variable - 1.0, 2.0 - variable) < AT_END else ""


def _correlations(keys: Sequence[Free], best: Any) -> dict[tuple[str, str], float]:
    """Correlation of each pair of free keys whose errors are known."""
    found = {}
    for n, first in enumerate(keys):
        known = best.params[first.identifier].correl or {}
        for second in keys[n + 1 :]:
            if second.identifier in known:
                # a key that falls as its variable rises
                sign = math.copysign(1.0, first.span * second.span)
                found[first.name, second.name] = sign * float(known[second.identifier])
    return found


def _warnings(result: FitResult, ended: bool) -> list[str]:
    """Warn of what the user has to know, in sentences.

    Args:
        ended: whether the last search came to an end.
    """
    found = [f"{one.name}: {one.doubt}" for one in result.parameters if one.doubt]
    for (first, second), number in result.correlations.items():
        if abs(number) > CORRELATED:
            found.append(
                f"{first} and {second} are correlated by {number:.3f}: the data tell both together, not each"
            )
    if not ended:
        found.append("the search was broken off: too many runs")
    same, all_searches = result.same_end
    if all_searches > 1 and same == 1:
        found.append(
            f"only 1 of {all_searches} searches ended at the best: more starts may find a better one"
        )
    number = result.measurement.counted.sum()
    if not result.estimated and result.chi_squared > 1.0 + CHANCE * math.sqrt(2.0 / number):
        found.append(
            f"chi-squared is {result.chi_squared:.3g}: the residuals are larger than the noise,"
            " the scene lacks something"
        )
    table = result.table()
    for name in result.measurement.columns:
        lag_one = _lag_one(table[f"{name}_residual"])
        if lag_one > max(AUTOCORRELATED, CHANCE / math.sqrt(len(table))):
            found.append(
                f"residuals of {name} are autocorrelated (lag-1 {lag_one:.2f}): the model has a systematic"
                " error, and the intervals are too narrow"
            )
    return found


def _lag_one(residual: Any) -> float:
    """Correlation of each residual with the next; 0 where there is nothing to tell."""
    if residual.size < 3 or not np.ptp(residual):
        return 0.0
    centred = residual - residual.mean()
    return float(np.sum(centred[1:] * centred[:-1]) / np.sum(centred**2))
