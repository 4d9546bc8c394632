"""Fit: values of keys for which a scene reproduces a measurement, with intervals and candidate causes.

Least squares from several starts (least_squares), intervals by profile likelihood (profile_likelihood) and
F-tests of released parameters (candidates).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..common.errors import InertiaModuleError, ParameterError, must_be
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER
from ..common.terminal import Progress
from ..common.units import has_mass
from ..fmi.instance import fmu_file
from ..fmi.simulate import Result
from ..scene import Scene
from .axes import Free, Point, free_keys, points_at, sample_shares
from .candidates import Candidate, candidate_keys, causes, release_candidates
from .evaluation import scene_and_name
from .fit_result import (
    NO_INFLUENCE,
    SYSTEMATIC,
    FitResult,
    Fitted,
    combination_remark,
    doubt,
    is_at_end,
    scale_remark,
    unit_remark,
)
from .least_squares import Optimum, Problem
from .measurement import Measurement, Rig, measurement
from .profile_likelihood import End, profile_end

# number of start points, the best ones, from which a search begins
N_SEARCHES = 3
# minimum change of the residuals, relative to their noise, by a key with influence that changes by its size
MIN_INFLUENCE = 1e-2
# minimum number of values of a column to estimate its noise, in addition to one per free key
N_FREE_VALUES = 2
# decrease of chi-squared in a profile after which the search is repeated from its point; maximum repetitions
NEW_OPTIMUM, MAX_RESTARTS = 1.0, 2
# maximum number of models whose profile is computed for an end of an interval
MAX_PROFILES = 4
# minimum component, in the weakest direction, of a key that a warning lists
MIN_COMPONENT = 0.1
# factor on all masses and torques, and the change of the residuals over their noise that counts as none
SCALE_FACTOR, MAX_SCALE_CHANGE = 1.1, 1.0


def fit(
    measured: Result | Path | str,
    scene: Scene | Path | str,
    free: Mapping[str, str | Sequence[float | str] | None],
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
        measured: table, or path of a CSV file with a row of headings, units in brackets.
        scene: scene, or path of its file.
        free: ranges by name: "LOW:HIGH", (low, high), "log:LOW:HIGH", the prior value "VALUE +- DEVIATION",
            or None for a search from the value in the scene. A name is a dotted key of the scene, a parameter
            of the mechanism, or "offset.COLUMN", "gain.COLUMN" or "shift.COLUMN" (s, positive if late) of a
            sensor; "shift.time" shifts all columns. A deviation of 0 declares the value exact.
        columns: names of the compared columns; by default all columns that the scene computes.
        starts: number of start points in the ranges (Latin hypercube), in addition to the values of the
            scene. A search begins at each of the best three.
        seed: random seed of the start points; equal seeds give equal results.
        output: output folder; None for out/SCENE_fit.
        fmu: FMU file; None for current_fmu().
        progress: function that receives the completed share, 0 to 1.

    Raises:
        ParameterError: scene, measurement or free keys are invalid, the measurement has too few values, no
            free key has an influence, or the scene rejects all values.
        MissingDependencyError: the extra ``studies`` is not installed.
    """
    library("tomli_w", "studies")
    base, title = scene_and_name(scene)
    data = measurement(measured, base, columns)
    keys = free_keys(free, base, data.sensors)
    if not any(key.deviation for key in keys):
        raise ParameterError("at least one key must be free; a deviation of 0 fixes a key")
    _check_number(data, sum(key.deviation > 0.0 for key in keys))
    for name, number in {"starts": starts, "seed": seed}.items():
        if number < 0:
            raise ParameterError(must_be(name, "at least 0", str(number)))
    with Rig(base, data, fmu_file(fmu)) as rig:
        remarks = _unit_remarks(rig, keys)
        try:
            result = _run(rig, keys, starts, seed, progress or (lambda share: None), remarks)
        except InertiaModuleError as error:
            raise ParameterError("; ".join([str(error), *remarks])) from error
    folder = OUTPUT_FOLDER / f"{title}_fit" if output is None else Path(output)
    return dataclasses.replace(result, files=result.write(folder))


def _check_number(data: Measurement, keys: int) -> None:
    """Reject a measurement with too few values for a number of free keys and the noise of its columns."""
    minimum = keys + N_FREE_VALUES
    for name, number in zip(data.columns, data.counted.sum(axis=0).tolist(), strict=True):
        if name not in data.noise and number < minimum:
            allowed = f"at least {minimum} ({keys} free parameters, {N_FREE_VALUES} for the noise)"
            raise ParameterError(must_be(f"the number of measured values of {name}", allowed, str(number)))
    if data.number <= keys:
        allowed = f"greater than {keys}, the number of free parameters"
        raise ParameterError(must_be("the number of measured values", allowed, str(data.number)))


def _exact(keys: Sequence[Free]) -> dict[str, float]:
    """Return the values of exact keys, SI, by name."""
    return {key.name: key.start for key in keys if not key.deviation}


def _unit_remarks(rig: Rig, keys: Sequence[Free]) -> list[str]:
    """Return warnings about columns whose ratio to the unfitted scene is the factor of another unit."""
    computed, data = rig.computed(_exact(keys)), rig.data
    gains = np.sum(data.values * computed, axis=0) / np.maximum(np.sum(computed**2, axis=0), 1e-300)
    hints = [(name, gain, data.unit_hint(name, gain)) for name, gain in zip(data.columns, gains, strict=True)]
    return [unit_remark(*hint) for hint in hints if hint[-1]]


def _problem(rig: Rig, keys: Sequence[Free]) -> Problem:
    """Return the problem of the free keys; a noise that is not specified is the scatter of its column."""
    data, exact = rig.data, _exact(keys)
    scatter = np.where(np.ptp(data.values, axis=0) > 0.0, data.values.std(axis=0), 1.0)
    noise = np.tile(scatter, (len(data.table), 1))
    for name, deviations in data.noise.items():
        noise[:, data.columns.index(name)] = deviations
    priors = tuple(key for key in keys if 0.0 < key.deviation < math.inf)
    return Problem(rig, tuple(key for key in keys if key.deviation), noise, exact, priors)


def _search(problem: Problem, starts: int, seed: int, progress: Progress) -> list[Optimum]:
    """Search from the best of the start points; the best optimum first."""
    keys = problem.keys
    places: list[Point] = [{key.name: key.start for key in keys}]
    if starts and any(key.has_range for key in keys):
        places += points_at(keys, sample_shares(len(keys), f"latin:{starts}", seed))
    points = np.array([list(place.values()) for place in places], dtype=float)
    chi_squared = []
    for n, point in enumerate(points):
        progress(0.1 * n / len(points))
        chi_squared.append(float(np.sum(problem.residuals(point) ** 2)))
    best = [points[n] for n in np.argsort(chi_squared)[:N_SEARCHES] if math.isfinite(chi_squared[n])]
    if not best:
        raise ParameterError(
            f"the scene rejects all start values of the free parameters: {problem.rig.rejection}"
        )
    optima = []
    for n, point in enumerate(best, 1):
        progress(0.1 + 0.2 * n / len(best))
        optima.append(problem.minimise(point))
    return sorted(optima, key=lambda optimum: optimum.chi_squared)


def _influential(optimum: Optimum) -> Optimum:
    """Return the optimum in which the keys without influence are fixed at their start values."""
    keys = optimum.problem.keys
    changes = np.linalg.norm(optimum.jacobian, axis=0) * optimum.problem.sizes / optimum.noise_ratios.max()
    if not (changes >= MIN_INFLUENCE).any():
        raise ParameterError(
            f"no free parameter ({', '.join(key.name for key in keys)}) has an influence on"
            f" {', '.join(optimum.problem.rig.data.columns)}"
        )
    for number in np.flatnonzero(changes < MIN_INFLUENCE)[::-1]:
        optimum = optimum.without_key(int(number), keys[number].start)
    return optimum


def _profiles(optimum: Optimum, progress: Progress) -> tuple[Optimum, list[tuple[End, End]]]:
    """Compute the profile ends of all keys; repeat the search from a better optimum on a profile.

    Returns:
        The optimum, and the lower and upper end of each key.
    """
    for _ in range(MAX_RESTARTS + 1):
        ends = []
        for number in range(optimum.point.size):
            progress(0.3 + 0.2 * number / optimum.point.size)
            ends.append((profile_end(optimum, number, -1), profile_end(optimum, number, 1)))
        chi_squared, point = min((end.optimum for pair in ends for end in pair), key=lambda pair: pair[0])
        if chi_squared > optimum.chi_squared - NEW_OPTIMUM:
            break
        optimum = optimum.problem.minimise(point, optimum.steps).with_estimated_noise()
    return optimum, ends


def _scale(optimum: Optimum, fixed: Mapping[str, float]) -> tuple[list[str], str]:
    """Return the fixed parameters that set the scale of masses and torques.

    A common factor of all quantities with kg in their unit is a null direction of the Jacobian if only motion
    is measured. One run with the factor confirms it.

    Args:
        optimum: optimum of the fit.
        fixed: values of fixed parameters with kg in their unit and with an influence, SI, by name.

    Returns:
        Names of these parameters, and a warning or "".
    """
    free = [key.name for key in optimum.problem.keys if has_mass(key.unit)]
    factors = np.where([key.name in free for key in optimum.problem.keys], SCALE_FACTOR, 1.0)
    scaled = optimum.problem.fixed | {name: SCALE_FACTOR * value for name, value in fixed.items()}
    problem = dataclasses.replace(optimum.problem, fixed=scaled)
    change = np.linalg.norm(problem.residuals(factors * optimum.point) - optimum.residuals)
    if not free or not change < MAX_SCALE_CHANGE:
        return [], ""
    return list(fixed), scale_remark(free, list(fixed))


def _combination(optimum: Optimum, ends: Sequence[tuple[End, End]]) -> str:
    """Return a warning about the weakest direction if profiles along it have no limit, or ""."""
    singular, directions = optimum.svd
    along = np.flatnonzero(np.abs(directions[-1]) > MIN_COMPONENT).tolist()
    if len(along) < 2 or not any(end.open for n in along for end in ends[n]):
        return ""
    return combination_remark([optimum.problem.keys[n].name for n in along], singular[-1])


def _run(
    rig: Rig, keys: Sequence[Free], starts: int, seed: int, progress: Progress, remarks: list[str]
) -> FitResult:
    """Search the optimum, then profiles, candidates and scale."""
    data, names = rig.data, rig.data.columns
    optima = _search(_problem(rig, keys), starts, seed, progress)
    best, ends = _profiles(_influential(optima[0]).with_estimated_noise(), progress)
    values = best.problem.values(best.point)
    scene = rig.scene.with_keys({name: value for name, value in values.items() if name not in data.sensors})
    start = np.array([key.start for key in best.problem.keys])
    candidates = release_candidates(
        best, candidate_keys(scene, data, values), start, lambda share: progress(0.5 + 0.4 * share)
    )
    constants = {candidate.name: (candidate.nominal, candidate.unit) for candidate in candidates}
    constants |= {key.name: (key.start, key.unit) for key in keys if not key.deviation}
    fixed = {name: value for name, (value, unit) in constants.items() if value and has_mass(unit)}
    scale, scale_warning = _scale(best, fixed)
    is_open = any(end.open for pair in ends for end in pair)
    fitted = {key.name: _fitted(best, n, ends[n], candidates) for n, key in enumerate(best.problem.keys)}
    unfitted = {
        key.name: Fitted(key.name, key.start, key.unit, doubt=NO_INFLUENCE) for key in keys if key.deviation
    }
    warnings = [key.range_remark for key in keys if key.deviation]
    warnings = [*(remarks if best.is_systematic else []), *warnings, _combination(best, ends), scale_warning]
    return FitResult(
        scene=scene,
        parameters=list((unfitted | fitted).values()),
        correlations=best.correlations,
        measurement=data,
        computed=Result({"time": data.table.time, **dict(zip(names, rig.computed(values).T, strict=True))}),
        noise=dict(zip(names, np.sqrt(np.mean(best.problem.noise**2, axis=0)).tolist(), strict=True)),
        estimated=[name for name in names if name not in data.noise],
        chi_squared=best.chi_squared / best.freedom,
        candidates=[candidate for candidate in candidates if candidate.is_separable],
        inseparable=[
            candidate.name for candidate in candidates if not candidate.is_separable and not is_open
        ],
        scale=scale,
        remarks=[warning for warning in warnings if warning],
        searches=(
            sum(optimum.chi_squared <= 1.01 * optima[0].chi_squared for optimum in optima),
            len(optima),
        ),
        runs=rig.runs,
        converged=best.converged,
    )


def _fitted(best: Optimum, number: int, ends: tuple[End, End], candidates: Sequence[Candidate]) -> Fitted:
    """Return a fitted key with its intervals.

    The first interval is the envelope of the profiles of several models (discrete profiling): Dauncey,
    Kenzie, Wardle and Davies, Journal of Instrumentation 10 (2015) P04015.
    """
    key, value, plausible_causes = best.problem.keys[number], float(best.point[number]), causes(candidates)
    is_systematic = plausible_causes[0].is_systematic if plausible_causes else best.is_systematic
    is_explained = bool(plausible_causes) and not is_systematic
    models = [model for model in (plausible_causes if is_explained else candidates) if model.is_separable]
    envelope = [("", end) for end in ends]
    is_open = [end.open for end in ends]
    if is_explained or not any(is_open):
        envelope = [_outermost(ends[side > 0], number, side, models, is_explained) for side in (-1, 1)]
    if is_explained and not is_at_end(key, value):
        is_open = [end.open for _, end in envelope]
    doubts = [doubt(key, value, is_open), SYSTEMATIC if is_systematic else ""]
    return Fitted(
        name=key.name,
        value=value,
        unit=key.unit,
        error=float(best.deviations[number]),
        interval=(envelope[0][1].value, envelope[1][1].value),
        interval_if_exact=(ends[0].value, ends[1].value),
        released=tuple(dict.fromkeys(name for name, _ in envelope if name)),
        is_excluded=is_explained,
        doubt="; ".join(text for text in doubts if text),
    )


def _outermost(
    end: End, number: int, side: int, models: Sequence[Candidate], is_excluded: bool
) -> tuple[str, End]:
    """Return the outermost end of an interval, and the candidate whose release gives it, or "".

    Args:
        end: end without a released candidate.
        number: index of the key.
        side: -1 for the lower, 1 for the upper end.
        models: candidates; the linear model selects the candidates whose profiles are computed.
        is_excluded: True if the data exclude the model without a released candidate.
    """

    def linear(model: Candidate) -> float:
        """Return the end of the interval of the linear model times side."""
        optimum = model.optimum
        return float(side * optimum.point[number] + optimum.t_quantile * optimum.deviations[number])

    ends = {} if is_excluded and models else {"": end}
    for model in sorted(models, key=linear, reverse=True)[:MAX_PROFILES]:
        if all(linear(model) > side * other.value for other in ends.values()):
            ends[model.name] = profile_end(model.optimum, number, side)
    return max(ends.items(), key=lambda item: side * item[1].value)
