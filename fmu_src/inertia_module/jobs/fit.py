"""Fit: values of keys of a scene for which it computes a measurement, with intervals and candidate causes.

Least squares from several starts (least_squares), intervals by profile likelihood (profile_likelihood) and
F-tests of released parameters (candidates).
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from pydantic_core import to_jsonable_python

from ..common.equality import ByContent
from ..common.errors import Refused, listed, must_be
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER, write_text
from ..common.terminal import Progress
from ..common.units import has_mass
from ..harness.fmu import fmu_file
from ..harness.simulate import Result
from ..scene import Scene
from ..scene.reading import scene_text
from .axes import Free, Point, Range, free_keys, of_shares, shares_sampled
from .candidates import (
    SIGNIFICANCE,
    Candidate,
    candidate_keys,
    causes,
    plausible,
    release_candidates,
    widest_ends,
)
from .evaluation import read
from .least_squares import Optimum, Problem
from .measurement import N_DEVIATIONS, Measurement, Rig, autocorrelation, measurement
from .profile_likelihood import END_RTOL, End, profile_end

# best start points from which a search begins
N_SEARCHES = 3
# change of the residuals along the whole size of a key, in noise, that is no influence
MIN_INFLUENCE = 1e-2
# values of a column that are necessary to estimate its noise, besides one per free key
N_FREE_VALUES = 2
# decrease of chi-squared in a profile after which the search is repeated from there, and repetitions
NEW_OPTIMUM, MAX_RESTARTS = 1.0, 2
# models whose profile is computed for an end of an interval
MAX_PROFILES = 3
# components of the weakest direction that are named; correlations from which there is a warning
MIN_COMPONENT, MAX_CORRELATION = 0.1, 0.95
# factor by which the scale of all masses and torques is tested, and the change in noise that is none
SCALE_FACTOR, MAX_SCALE_CHANGE = 1.1, 1.0
# relative accuracy of the gain by which the whole scene suggests another unit
UNIT_RTOL = 0.25

Interval = tuple[float, float]


@dataclass(frozen=True)
class Fitted:
    """A fitted key.

    Attributes:
        name: dotted name.
        value: estimate, SI.
        error: its standard error in the linear model, SI; infinite without influence.
        interval: 95 % interval by profile likelihood, with each plausible candidate released in turn, SI.
        interval_if_exact: 95 % interval by profile likelihood if everything else is exact, SI.
        unit: of these, "" for none.
        released: candidates whose release sets the ends of the interval.
        is_excluded: whether a candidate explains the residuals, so that the value does not apply.
        doubt: a remark on the estimate, or "".
    """

    name: str
    value: float
    error: float
    interval: Interval
    interval_if_exact: Interval
    unit: str
    released: tuple[str, ...] = ()
    is_excluded: bool = False
    doubt: str = ""

    @property
    def text(self) -> str:
        """Value, interval, released candidates and doubt, in a line."""
        value, (low, high) = f"{self.value:.6g} {self.unit}".rstrip(), self.interval
        doubt = f"; {self.doubt}" if self.doubt else ""
        released = f" with {' or '.join(self.released)} released" if self.released else ""
        if not math.isfinite(high - low):
            return f"{value}{doubt}"
        if self.is_excluded:
            return f"{f'from {low:.6g} to {high:.6g} {self.unit}'.rstrip()}{released}{doubt}"
        return f"{value}, from {low:.6g} to {high:.6g}{released}{doubt}"


@dataclass(frozen=True, eq=False)
class FitResult(ByContent):
    """Result of a fit.

    Attributes:
        scene: with the fitted values.
        parameters: fitted keys.
        correlations: by pairs of names.
        measurement: the data.
        computed: columns of the fitted scene at the measured times, SI.
        noise: standard deviation of each column, SI, RMS.
        estimated: columns whose noise is estimated from the residuals.
        chi_squared: reduced chi-squared.
        candidates: fixed parameters and sensor errors, released in turn; the most significant first.
        inseparable: candidates that the data cannot separate from the fitted keys, taken as exact.
        scale: fixed parameters that set the scale of all masses and torques.
        remarks: warnings on units, ranges, scale and combinations.
        searches: number that converged to the optimum, and number of all.
        runs: of the scene.
        converged: whether the last search converged.
        files: written files, by kind.
    """

    scene: Scene
    parameters: list[Fitted]
    correlations: dict[tuple[str, str], float]
    measurement: Measurement
    computed: Result
    noise: dict[str, float]
    estimated: list[str]
    chi_squared: float
    candidates: list[Candidate]
    inseparable: list[str]
    scale: list[str]
    remarks: list[str]
    searches: tuple[int, int]
    runs: int
    converged: bool
    files: dict[str, Path] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Fitted:
        """Return a fitted key by its dotted name or, of the mechanism, by its bare name."""
        return next(one for one in self.parameters if name in (one.name, one.name.rpartition(".")[2]))

    @property
    def causes(self) -> list[Candidate]:
        """Candidates that explain the residuals equally well; none if that may be chance."""
        return causes(self.candidates)

    @property
    def warnings(self) -> list[str]:
        """Warnings, in sentences."""
        lines = [*self.remarks, *(f"{one.name}: {one.doubt}" for one in self.parameters if one.doubt)]
        if self.measurement.unused:
            unused = listed(self.measurement.unused)
            lines.append(f"columns that the scene does not compute are not compared: {unused}")
        doubtful = {one.name for one in self.parameters if one.doubt}
        lines += [
            f"{first} and {second} have a correlation of {number:.3f}: the data determine only a"
            " combination of them"
            for (first, second), number in self.correlations.items()
            if abs(number) > MAX_CORRELATION and not {first, second} <= doubtful
        ]
        if not self.converged:
            lines.append("the search did not converge within the maximum number of iterations")
        agreeing, searches = self.searches
        if searches > 1 and agreeing == 1:
            lines.append(
                f"only 1 of {searches} searches converged to this optimum: more starts may find a"
                " better optimum"
            )
        if not self.estimated and self.chi_squared > 1.0 + N_DEVIATIONS * math.sqrt(
            2.0 / self.measurement.number
        ):
            lines.append(
                f"reduced chi-squared is {self.chi_squared:.3g}: the residuals are larger than the specified"
                " noise, so the scene does not explain the data"
            )
        table = self.table()
        for name in self.measurement.columns:
            number = autocorrelation(table[f"{name}_residual"])
            if number > self.measurement.max_autocorrelation:
                lines.append(
                    f"residuals of {name} are autocorrelated (lag-1 {number:.2f}): the model has a"
                    " systematic error"
                )
        return [*lines, *self._cause()]

    def _cause(self) -> list[str]:
        """Return the sentence on the causes."""
        if not self.causes:
            return []
        first, *others = self.causes
        before, after = first.chi_squared
        values = ", ".join(
            f"{name} would be {value:.5g} instead of {self[name].value:.5g}"
            for name, value in first.values.items()
        )
        p_value = f"p = {first.p_value:.1g}" if first.p_value > 1e-15 else "p < 1e-15"
        tied = "".join(f" or {one.cause}" for one in others)
        equally = " equally well" if others else ""
        rest = " in part; autocorrelated residuals remain" if first.is_systematic else ""
        return [
            f"{first.cause}{tied} would explain the residuals{equally}{rest} (chi-squared {before:,.0f} →"
            f" {after:,.0f}, {p_value}): {values}; correct the cause or fit again with --free {first.option}"
        ]

    def candidate_lines(self) -> dict[str, str]:
        """Return a line for each significant candidate and each that sets an end of an interval, by name."""
        setting = {name for one in self.parameters for name in one.released}
        shown = [one for one in self.candidates if one.name in setting or one.p_value < SIGNIFICANCE]
        lines = {one.name: one.text for one in shown[:8]}
        if self.inseparable:
            lines["not separately identifiable"] = f"{', '.join(self.inseparable)}, taken as exact"
        if len(self.scale) > 1:
            lines["scale of masses and torques"] = f"{', '.join(self.scale)}, taken as exact"
        return lines

    def as_dict(self) -> dict[str, Any]:
        """Return the result for machines; None is unknown."""
        units = self.measurement.table.units
        candidates = [
            {one.name: getattr(candidate, one.name) for one in dataclasses.fields(candidate)[:-1]}
            for candidate in self.candidates
        ]
        content: dict[str, Any] = to_jsonable_python(
            {
                "parameters": {one.name: one for one in self.parameters},
                "correlations": [[*pair, number] for pair, number in self.correlations.items()],
                "noise": {
                    name: {"value": value, "unit": units[name], "estimated": name in self.estimated}
                    for name, value in self.noise.items()
                },
                "chi_squared": self.chi_squared,
                "candidates": candidates,
                "causes": [one.name for one in self.causes],
                "inseparable": self.inseparable,
                "scale": self.scale,
                "values": self.measurement.number,
                "searches_that_agree": self.searches,
                "runs": self.runs,
                "warnings": self.warnings,
            },
            inf_nan_mode="null",
        )
        return content

    def lines(self) -> dict[str, str]:
        """Return the lines of the printed table, by heading."""
        lines = {}
        for one in self.parameters:
            lines[one.name], (low, high) = one.text, one.interval_if_exact
            if math.isfinite(high - low):
                excluded = f" around {one.value:.6g}; excluded by the data" if one.is_excluded else ""
                lines[f"{one.name}, if everything else is exact"] = f"from {low:.6g} to {high:.6g}{excluded}"
        for (first, second), number in self.correlations.items():
            lines[f"correlation of {first} and {second}"] = f"{number:.3f}"
        for name, value in self.noise.items():
            source = ", estimated from the residuals" if name in self.estimated else ""
            lines[f"noise of {name}"] = f"{value:.4g} {self.measurement.table.units[name]}{source}"
        freedom = self.measurement.number - len(self.parameters)
        untested = "; no test of the model, because the noise is estimated" if self.estimated else ""
        lines["chi-squared"] = f"{self.chi_squared * freedom:.4g} for {freedom} degrees of freedom{untested}"
        lines["searches converged to this optimum"] = "{} of {}".format(*self.searches)
        return {**lines, "runs": str(self.runs)}

    def table(self) -> Result:
        """Return measured, computed and residual (computed - measured) of each column over time, SI."""
        columns, units, measured = {"time": self.computed.time}, {"time": "s"}, self.measurement.table
        for name in self.measurement.columns:
            values = measured[name], self.computed[name], self.computed[name] - measured[name]
            for kind, column in zip(("measured", "computed", "residual"), values, strict=True):
                columns[f"{name}_{kind}"], units[f"{name}_{kind}"] = column, measured.units[name]
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
    """Fit keys of a scene to a measurement; write the fitted scene, the residuals and the numbers.

    Args:
        measured: table, or CSV file; see measurement.
        scene: scene, or its file.
        free: "NAME", "NAME=LOW:HIGH" or, with prior knowledge, "NAME=VALUE +- DEVIATION" each; or the text
            after the sign (or None) by name. NAME is a key of the scene by dots, a parameter of the
            mechanism, or "offset.COLUMN", "gain.COLUMN" or "shift.COLUMN" (s, positive if late) of a sensor;
            "shift.time" is for all columns. A DEVIATION of 0 declares the value exact.
        columns: names of the compared columns; by default all that the scene computes.
        starts: points of the ranges (Latin hypercube) that are compared besides the values of the scene. The
            best N_SEARCHES of them start a search.
        seed: of these points; the same seed gives the same result.
        output: folder, by default out/SCENE_fit.
        fmu: FMU file, by default the current one.
        progress: called with the share that is done.

    Raises:
        Refused: scene, measurement or free keys are invalid, the measurement has too few values, no free key
            has an influence, or the scene rejects all values; in one sentence.
        NotInstalled: the extra jobs is not installed.
    """
    library("tomli_w", "jobs")
    base, title = read(scene)
    data = measurement(measured, base, columns)
    listed = free_keys(free, base, data.sensors)
    keys = [key for key in listed if key.deviation]
    exact = {key.name: key.start for key in listed if not key.deviation}
    if not keys:
        raise Refused("at least one key must be free; a deviation of 0 fixes a key")
    _check_number(data, len(keys))
    if starts < 0:
        raise Refused(must_be("starts", "at least 0", str(starts)))
    if seed < 0:
        raise Refused(must_be("seed", "at least 0", str(seed)))
    with Rig(base, data, fmu_file(fmu)) as rig:
        remarks = _unit_remarks(rig, exact)
        try:
            result = _run(rig, listed, starts, seed, progress or (lambda share: None), remarks)
        except Refused as error:
            raise Refused("; ".join([str(error), *remarks])) from error
    folder = OUTPUT_FOLDER / f"{title}_fit" if output is None else Path(output)
    return dataclasses.replace(result, files=result.write(folder))


def _check_number(data: Measurement, keys: int) -> None:
    """Reject a measurement with too few values for a number of free keys and the noise of its columns."""
    least = keys + N_FREE_VALUES
    for name, number in zip(data.columns, data.counted.sum(axis=0).tolist(), strict=True):
        if name not in data.noise and number < least:
            allowed = f"at least {least} ({keys} free parameters, {N_FREE_VALUES} for the noise)"
            raise Refused(must_be(f"the number of measured values of {name}", allowed, str(number)))
    if data.number <= keys:
        allowed = f"greater than {keys}, the number of free parameters"
        raise Refused(must_be("the number of measured values", allowed, str(data.number)))


def _unit_remarks(rig: Rig, exact: Mapping[str, float]) -> list[str]:
    """Return warnings on columns whose ratio to the scene, as it is, is the factor of another unit."""
    computed, data = rig.computed(exact), rig.data
    gains = np.sum(data.values * computed, axis=0) / np.maximum(np.sum(computed**2, axis=0), 1e-300)
    return [
        f"{name} is {gain:.3g} times the value that the unfitted scene computes; possible cause: {unit}"
        for name, gain in zip(data.columns, gains, strict=True)
        if (unit := data.unit_hint(name, gain, UNIT_RTOL))
    ]


def _search(problem: Problem, starts: int, seed: int, progress: Progress) -> list[Optimum]:
    """Search from the best of the start points; the best optimum first."""
    keys = problem.keys
    places: list[Point] = [{key.name: key.start for key in keys}]
    if starts and any(key.has_range for key in keys):
        places += of_shares(keys, shares_sampled(len(keys), f"latin:{starts}", seed))
    points = np.array([[place[key.name] for key in keys] for place in places], dtype=float)
    chi_squared = []
    for n, point in enumerate(points):
        progress(0.1 * n / len(points))
        chi_squared.append(float(np.sum(problem.residuals(point) ** 2)))
    best = [points[n] for n in np.argsort(chi_squared)[:N_SEARCHES] if math.isfinite(chi_squared[n])]
    if not best:
        raise Refused(f"the scene rejects all start values of the free parameters: {problem.rig.rejection}")
    optima = []
    for n, point in enumerate(best, 1):
        progress(0.1 + 0.2 * n / len(best))
        optima.append(problem.minimise(point))
    return sorted(optima, key=lambda optimum: optimum.chi_squared)


def _influential(optimum: Optimum) -> Optimum:
    """Return the optimum with keys without influence fixed at their starts."""
    keys = optimum.problem.keys
    changes = np.linalg.norm(optimum.jacobian, axis=0) * optimum.problem.sizes / optimum.noise_ratios.max()
    if not (changes >= MIN_INFLUENCE).any():
        raise Refused(
            f"no free parameter ({', '.join(key.name for key in keys)}) has an influence on"
            f" {', '.join(optimum.problem.rig.data.columns)}"
        )
    for number in np.flatnonzero(changes < MIN_INFLUENCE)[::-1]:
        optimum = optimum.without_key(int(number), keys[number].start)
    return optimum


def _profiles(optimum: Optimum, progress: Progress) -> tuple[Optimum, list[tuple[End, End]]]:
    """Find the profile ends of all keys; a profile that finds a better optimum repeats the search there."""
    for _ in range(MAX_RESTARTS + 1):
        ends = []
        for number in range(optimum.point.size):
            progress(0.3 + 0.2 * number / optimum.point.size)
            ends.append((profile_end(optimum, number, -1), profile_end(optimum, number, 1)))
        least, point = min((end.optimum for pair in ends for end in pair), key=lambda pair: pair[0])
        if least > optimum.chi_squared - NEW_OPTIMUM:
            break
        optimum = optimum.problem.minimise(point, optimum.steps).with_estimated_noise()
    return optimum, ends


def _scale(optimum: Optimum, fixed: Mapping[str, float]) -> tuple[list[str], list[str]]:
    """Find the fixed parameters that set the scale of masses and torques.

    A common factor of all quantities with kg in their unit is a null direction of the Jacobian if only motion
    is measured. One run with the factor confirms it.

    Args:
        optimum: of the fit.
        fixed: values of fixed parameters with kg in their unit and with an influence, SI, by name.

    Returns:
        Names of these parameters, and warnings.
    """
    keys = optimum.problem.keys
    free = [key.name for key in keys if has_mass(key.unit)]
    factors = np.where([key.name in free for key in keys], SCALE_FACTOR, 1.0)
    scaled = optimum.problem.fixed | {name: SCALE_FACTOR * value for name, value in fixed.items()}
    problem = dataclasses.replace(optimum.problem, fixed=scaled)
    change = np.linalg.norm(problem.residuals(factors * optimum.point) - optimum.residuals)
    if not free or not change < MAX_SCALE_CHANGE:
        return [], []
    ratios = f"only ratios of {', '.join(free)} are identifiable:"
    if not fixed:
        return [], [f"{ratios} a common factor changes nothing, because no mass, inertia or torque is fixed"]
    alone = [f"{ratios} the result scales with {name}, which is taken as exact" for name in fixed]
    return list(fixed), alone if len(fixed) == 1 else []


def _weakest(optimum: Optimum, ends: Sequence[tuple[End, End]]) -> list[str]:
    """Return a warning on the weakest direction of the Jacobian if re-fits along it meet no limit."""
    singular, direction = optimum.weakest_direction()
    along = np.flatnonzero(np.abs(direction) > MIN_COMPONENT).tolist()
    if len(along) < 2 or not any(end.open for n in along for end in ends[n]):
        return []
    names = ", ".join(optimum.problem.keys[n].name for n in along)
    return [
        f"only a combination of {names} is identifiable: along the weakest direction of the scaled Jacobian"
        f" (singular value {singular:.2g}) re-fits meet no limit"
    ]


def _run(
    rig: Rig, listed: Sequence[Free], starts: int, seed: int, progress: Progress, remarks: list[str]
) -> FitResult:
    """Search the optimum, then profiles, candidates and scale."""
    data, names = rig.data, rig.data.columns
    keys = tuple(key for key in listed if key.deviation)
    exact = {key.name: key.start for key in listed if not key.deviation}
    scatter = np.where(np.ptp(data.values, axis=0) > 0.0, data.values.std(axis=0), 1.0)
    noise = [
        data.noise.get(name, np.full(len(data.table), one)) for name, one in zip(names, scatter, strict=True)
    ]
    optima = _search(Problem(rig, keys, np.column_stack(noise), exact), starts, seed, progress)
    best, ends = _profiles(_influential(optima[0]).with_estimated_noise(), progress)
    values = best.problem.values(best.point)
    scene = rig.scene.with_keys({name: value for name, value in values.items() if name not in data.sensors})
    start = np.array([key.start for key in best.problem.keys])
    candidates = release_candidates(
        best, candidate_keys(scene, data, values), start, lambda share: progress(0.5 + 0.4 * share)
    )
    fixed = {one.name: one.nominal for one in candidates if one.nominal and has_mass(one.unit)}
    fixed |= {key.name: key.start for key in listed if key.name in exact and key.start and has_mass(key.unit)}
    scale, scale_remarks = _scale(best, fixed)
    # the remaining remarks on units concern columns that no cause explains
    if not best.is_systematic or any(one.other_unit and not one.is_systematic for one in causes(candidates)):
        remarks = []
    fitted = {key.name: _fitted(best, n, ends[n], candidates) for n, key in enumerate(best.problem.keys)}
    is_open = any(end.open for pair in ends for end in pair)
    return FitResult(
        scene=scene,
        parameters=[fitted.get(key.name) or _without_influence(key) for key in keys],
        correlations=best.correlations,
        measurement=data,
        computed=Result({"time": data.table.time, **dict(zip(names, rig.computed(values).T, strict=True))}),
        noise=dict(zip(names, np.sqrt(np.mean(best.problem.noise**2, axis=0)).tolist(), strict=True)),
        estimated=[name for name in names if name not in data.noise],
        chi_squared=best.chi_squared / best.freedom,
        candidates=[one for one in candidates if one.is_separable],
        inseparable=[one.name for one in candidates if not one.is_separable and not is_open],
        scale=scale,
        remarks=[
            *remarks,
            *(key.range_remark for key in keys if key.range_remark),
            *_weakest(best, ends),
            *scale_remarks,
        ],
        searches=(sum(one.chi_squared <= 1.01 * optima[0].chi_squared for one in optima), len(optima)),
        runs=rig.runs,
        converged=best.converged,
    )


def _fitted(best: Optimum, number: int, ends: tuple[End, End], candidates: Sequence[Candidate]) -> Fitted:
    """Return a fitted key with its intervals."""
    key, value = best.problem.keys[number], float(best.point[number])
    named = causes(candidates)
    is_systematic = named[0].is_systematic if named else best.is_systematic
    is_explained = bool(named) and not is_systematic
    exact, envelope = (ends[0].value, ends[1].value), [(end.value, "", end.open) for end in ends]
    if is_explained or not any(end.open for end in ends):
        models = [one for one in plausible(candidates) if one.is_separable]
        inner = (math.inf, -math.inf) if is_explained else exact
        envelope = [_envelope(number, side, inner[side > 0], models) for side in (-1, 1)]
    opens = [end.open for end in ends]
    if is_explained and not any(opens):
        opens = [is_open for *_, is_open in envelope]
    doubts = [_doubt(key, value, opens)]
    if is_systematic:
        doubts.append("the residuals are systematic: no interval is reliable until their cause is known")
    return Fitted(
        name=key.name,
        value=value,
        error=float(best.deviations[number]),
        interval=(envelope[0][0], envelope[1][0]),
        interval_if_exact=exact,
        unit=key.unit,
        released=tuple(dict.fromkeys(name for _, name, _ in envelope if name)),
        is_excluded=is_explained,
        doubt="; ".join(doubt for doubt in doubts if doubt),
    )


def _envelope(number: int, side: int, exact: float, models: Sequence[Candidate]) -> tuple[float, str, bool]:
    """Return the outermost end of the profiles of several models, its candidate, and whether it is open.

    Discrete profiling: Dauncey, Kenzie, Wardle and Davies, Journal of Instrumentation 10 (2015) P04015. The
    linear model selects the models whose profile is computed.

    Args:
        number: place of the key.
        side: -1 for the lower, 1 for the upper end.
        exact: end without a released candidate; infinite, on the other side, if the data exclude that model.
        models: plausible candidates.
    """
    linear = [(side * widest_ends(one.optimum, number)[side > 0], one) for one in models]
    outermost, name, is_open = side * exact, "", False
    for estimate, model in sorted(linear, key=lambda pair: -pair[0])[:MAX_PROFILES]:
        if estimate > outermost:
            end = profile_end(model.optimum, number, side)
            if side * end.value > outermost:
                outermost, name, is_open = side * end.value, model.name, end.open
    return side * outermost, name, is_open


def _doubt(key: Free, value: float, is_open: Sequence[bool]) -> str:
    """Return a remark on a key that is not identifiable or at the end of its range, or ""."""
    lower, upper = is_open
    if lower and upper:
        return "not identifiable from the data: the profile likelihood has no limit within the ranges"
    if (lower or upper) and key.has_range and min(value - key.low, key.high - value) < END_RTOL * key.size:
        return "is at the end of its range"
    if lower or upper:
        side = "lower" if lower else "upper"
        return f"not identifiable from the data: they set no {side} limit within the ranges"
    return ""


def _without_influence(key: Free) -> Fitted:
    """Return a key without influence."""
    unbounded = (-math.inf, math.inf)
    doubt = "has no influence on the measured columns and keeps its start value"
    return Fitted(key.name, key.start, math.inf, unbounded, unbounded, key.unit, doubt=doubt)
