"""Fit: values of a scene's keys at which it computes what was measured, and how well the data tell them.

An interval that can be signed is that with any one suspect free which the data do not exclude; the one that
holds if the scene is right in all else stands beside it.
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
from ..harness.fmu import fmu_file
from ..harness.simulate import Result
from ..scene import Scene
from ..scene.reading import scene_text
from .axes import Free, Point, Range, free_keys, of_shares, shares_sampled
from .evaluation import read
from .least_squares import End, Problem
from .measurement import CHANCE, Measurement, Rig, lag_one, measurement
from .suspects import AS_GOOD, EXCLUDED, Suspect, causes, suspected, tried

# of the points looked at, as many of the best are starts of a search
SEARCHED = 3
# share of the progress that points and searches each are
LOOKED = 0.2
# what all of a range changes, of the noise, without influence
NOTHING = 1e-2
# so near to an end of its range, of the range, a value is at it
AT_END = 1e-4

Interval = tuple[float, float]


@dataclass(frozen=True)
class Fitted:
    """A free key.

    Attributes:
        name: by dots. value, error: the value and its standard error if the scene is right in all else, SI.
        interval: of 95 %, with any one suspect free that the data do not exclude. narrow: of 95 %, if the
            scene is right in all else. What is not known of errors and intervals is infinite.
        unit: "" for none. rests_on: the suspects that set the ends of the interval.
        holds: whether the data allow all else to be as in the scene; the value is of no use if not.
        doubt: what is wrong with it, or "".
    """

    name: str
    value: float
    error: float
    interval: Interval
    narrow: Interval
    unit: str
    rests_on: tuple[str, ...] = ()
    holds: bool = True
    doubt: str = ""

    @property
    def text(self) -> str:
        """Value, interval, what that rests on and what is wrong with it, in a line."""
        value, (low, high) = f"{self.value:.6g} {self.unit}".rstrip(), self.interval
        doubt = f"; {self.doubt}" if self.doubt else ""
        released = f" with {' or '.join(self.rests_on)} released" if self.rests_on else ""
        if not math.isfinite(high - low):
            return f"{value}{doubt}"
        if not self.holds:
            interval = f"from {low:.6g} to {high:.6g} {self.unit}".rstrip()
            return f"{interval}{released}{doubt}"
        return f"{value}, from {low:.6g} to {high:.6g}{released}{doubt}"


@dataclass(frozen=True, eq=False)
class FitResult(ByContent):
    """Result of a fit.

    Attributes:
        scene: with the values found. parameters: the free keys. correlations: by pairs of them.
        measurement: what was fitted. computed: by the fitted scene, at the same times.
        noise: standard deviation by column, RMS. estimated: columns whose noise was found from the residuals.
        chi_squared: of the residuals over noise, over degrees of freedom.
        suspects: what is not free, freed in turn; what explains the most first. units_doubted: sentences
            on columns that are as far from what the scene computes as it is as another unit is.
        same_end: how many searches ended at the best, of how many. runs: of the scene. ended: whether the
            last search came to an end. files: written, by kind.
    """

    scene: Scene
    parameters: list[Fitted]
    correlations: dict[tuple[str, str], float]
    measurement: Measurement
    computed: Result
    noise: dict[str, float]
    estimated: list[str]
    chi_squared: float
    suspects: list[Suspect]
    units_doubted: list[str]
    same_end: tuple[int, int]
    runs: int
    ended: bool
    files: dict[str, Path] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Fitted:
        """A free key, by dots or, of the mechanism, by its bare name."""
        return next(one for one in self.parameters if name in (one.name, one.name.rpartition(".")[2]))

    @property
    def causes(self) -> list[Suspect]:
        """Suspects of which one explains the residuals, as well as the first; none where it may be chance."""
        return causes(self.suspects)

    @property
    def warnings(self) -> list[str]:
        """Warnings of what the user has to know, in sentences."""
        found = [f"{one.name}: {one.doubt}" for one in self.parameters if one.doubt]
        if self.measurement.unused:
            unused = listed(self.measurement.unused)
            found.append(f"columns that the scene does not compute are not compared: {unused}")
        for (first, second), number in self.correlations.items():
            if abs(number) > 0.95:
                found.append(
                    f"{first} and {second} have a correlation of {number:.3f}: the data determine only a"
                    " combination of them"
                )
        if not self.ended:
            found.append("the search did not converge within the maximum number of iterations")
        same, all_searches = self.same_end
        if all_searches > 1 and same == 1:
            found.append(
                f"only 1 of {all_searches} searches converged to this optimum: more starts may find a"
                " better optimum"
            )
        chance = CHANCE * math.sqrt(2.0 / self.measurement.number)
        if not self.estimated and self.chi_squared > 1.0 + chance:
            found.append(
                f"reduced chi-squared is {self.chi_squared:.3g}: the residuals are larger than the specified"
                " noise, so the scene does not explain the data"
            )
        table = self.table()
        following = {name: lag_one(table[f"{name}_residual"]) for name in self.measurement.columns}
        related = [
            f"residuals of {name} are autocorrelated (lag-1 {one:.2f}): the model has a systematic error"
            for name, one in following.items()
            if one > self.measurement.chance
        ]
        # of the one column in another unit the cause tells
        alone = any(one.other_unit and self._whole(one) for one in self.causes)
        doubted = self.units_doubted if related and not alone else []
        return [*doubted, *found, *related, *self._verdict()]

    def _whole(self, one: Suspect) -> bool:
        """Tell whether a suspect leaves nothing that is systematic."""
        return one.autocorrelation <= self.measurement.chance

    def _verdict(self) -> list[str]:
        """The sentence on what would explain the residuals."""
        if not self.causes:
            return []
        first, *others = self.causes
        before, after = first.chi_squared
        residuals = "the residuals" if self._whole(first) else "part of the residuals"
        answers = ", ".join(
            f"{name} would be {value:.5g} instead of {self[name].value:.5g}"
            for name, (value, _, _) in first.answers.items()
        )
        also = f"; {' or '.join(one.cause for one in others)} would explain the data equally well"
        return [
            f"{first.cause} would explain {residuals} (chi-squared {before:,.0f} → {after:,.0f},"
            f" {self.measurement.number} values): {answers}{also if others else ''}; correct the cause or"
            f" fit again with --free {first.freed}"
        ]

    def suspicions(self) -> dict[str, str]:
        """Give lines, by name, on the suspects that explain something and on those answers rest on."""
        setting = {name for one in self.parameters for name in one.rests_on}
        explaining = [one.name for one in self.suspects if one.evidence > AS_GOOD][:6]
        lines = {one.name: one.told for one in self.suspects if one.name in {*explaining, *setting}}
        together = [one.name for one in self.suspects if not math.isfinite(one.error)]
        return lines | ({"not separately identifiable": ", ".join(together)} if together else {})

    def as_dict(self) -> dict[str, Any]:
        """Give the result for machines: what is not known is None."""
        units = self.measurement.table.units
        told: dict[str, Any] = to_jsonable_python(
            {
                "parameters": {one.name: one for one in self.parameters},
                "correlations": [[*pair, number] for pair, number in self.correlations.items()],
                "noise": {
                    name: {"value": value, "unit": units[name], "estimated": name in self.estimated}
                    for name, value in self.noise.items()
                },
                "chi_squared": self.chi_squared,
                "suspects": self.suspects,
                "causes": [one.name for one in self.causes],
                "values": self.measurement.number,
                "searches_that_agree": self.same_end,
                "runs": self.runs,
                "warnings": self.warnings,
            },
            inf_nan_mode="null",
        )
        return told

    def lines(self) -> dict[str, str]:
        """Give the lines of the printed table, by heading."""
        found = {}
        for one in self.parameters:
            found[one.name], (low, high) = one.text, one.narrow
            if math.isfinite(high - low):
                excluded = "" if one.holds else f" around {one.value:.6g}; excluded by the data"
                found[f"{one.name}, if everything else is exact"] = f"from {low:.6g} to {high:.6g}{excluded}"
        for (first, second), number in self.correlations.items():
            found[f"correlation of {first} and {second}"] = f"{number:.3f}"
        for name, value in self.noise.items():
            source = ", estimated from the residuals" if name in self.estimated else ""
            found[f"noise of {name}"] = f"{value:.4g} {self.measurement.table.units[name]}{source}"
        freedom = self.measurement.number - len(self.parameters)
        judged = "; no test of the model, because the noise is estimated" if self.estimated else ""
        found["chi-squared"] = f"{self.chi_squared * freedom:.4g} for {freedom} degrees of freedom{judged}"
        agree = "{} of {}".format(*self.same_end)
        return {**found, "searches converged to this optimum": agree, "runs": str(self.runs)}

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
        free: "NAME", "NAME=LOW:HIGH" or, where so much is known of the value, "NAME=VALUE +- DEVIATION" each,
            or what follows the sign (or None) by name; NAME is a key of the scene by dots, a parameter of the
            mechanism, or "offset.COLUMN", "gain.COLUMN" or "shift.COLUMN" (s, late is above 0; "shift.time":
            of all columns) of a sensor. A DEVIATION of 0 says that it is so: it is no suspect.
        columns: those that are compared, by default all that the scene computes.
        starts: points of the ranges (Latin hypercube) that are looked at besides the scene's own values; the
            best SEARCHED of all are starts of a search.
        seed: of these points: same seed, same result.
        output: folder, by default out/SCENE_fit.
        fmu: as of sweep.
        progress: as of sweep.

    Raises:
        Refused: the scene, the measurement or what is free is not as above, nothing free has an influence, or
            the scene refuses all values tried, in one sentence.
        NotInstalled: the extra jobs is not.
    """
    library("tomli_w", "jobs")
    base, title = read(scene)
    data = measurement(measured, base, columns)
    given = free_keys(free, base, data.sensors)
    keys = [key for key in given if key.deviation]
    so = {key.name: key.start for key in given if not key.deviation}
    if not keys:
        raise Refused("at least one key must be free; a deviation of 0 fixes a key")
    if data.number <= len(keys):
        allowed = f"greater than {len(keys)}, the number of free parameters"
        raise Refused(must_be("the number of measured values", allowed, str(data.number)))
    if starts < 0:
        raise Refused(must_be("starts", "at least 0", str(starts)))
    if seed < 0:
        raise Refused(must_be("seed", "at least 0", str(seed)))
    with Rig(base, data, fmu_file(fmu)) as rig:
        doubted = _units_doubted(rig, {key.name: key.start for key in given})
        try:
            found = _run(rig, keys, so, starts, seed, progress or (lambda share: None))
        except Refused as error:
            raise Refused("; ".join([str(error), *doubted])) from error
    folder = OUTPUT_FOLDER / f"{title}_fit" if output is None else Path(output)
    found = dataclasses.replace(found, units_doubted=doubted)
    return dataclasses.replace(found, files=found.write(folder))


def _units_doubted(rig: Rig, values: dict[str, float]) -> list[str]:
    """Tell of columns that are as far from what the scene computes as it is as another unit is."""
    computed, data = rig.computed(values), rig.data
    squares = np.maximum(np.sum(computed**2, axis=0), 1e-300)
    gains = np.sum(data.values * computed, axis=0) / squares
    return [
        f"{name} is {gain:.3g} times the value that the unfitted scene computes; possible cause: {unit}"
        for name, gain in zip(data.columns, gains, strict=True)
        # the scene as it is may be off by so much
        if (unit := data.unit_by(name, gain, 0.25))
    ]


def _run(
    rig: Rig, keys: Sequence[Free], so: dict[str, float], starts: int, seed: int, progress: Progress
) -> FitResult:
    """Look at points, search from the best of them, find the noise, then suspects."""
    data, names = rig.data, rig.data.columns
    spread = np.where(np.ptp(data.values, axis=0) > 0.0, data.values.std(axis=0), 1.0)
    sigma = [
        data.noise.get(name, np.full(len(data.table), one)) for name, one in zip(names, spread, strict=True)
    ]
    problem = Problem(rig, tuple(keys), np.column_stack(sigma), so)
    places: list[Point] = [{key.name: key.start for key in keys}]
    if starts and any(key.held for key in keys):
        places += of_shares(keys, shares_sampled(len(keys), f"latin:{starts}", seed))
    points = np.array([[place[key.name] for key in keys] for place in places], dtype=float)
    costs = []
    for n, point in enumerate(points):
        progress(LOOKED * n / len(points))
        costs.append(float(np.sum(problem.residuals(point) ** 2)))
    begun = [points[n] for n in np.argsort(costs)[:SEARCHED] if math.isfinite(costs[n])]
    if not begun:
        raise Refused(f"the scene rejects all start values of the free parameters: {rig.refused}")
    ends = []
    for n, point in enumerate(begun, 1):
        progress(LOOKED + LOOKED * n / len(begun))
        ends.append(problem.solve(point))
    ends.sort(key=lambda end: end.chi_squared)
    best = _of_influence(ends[0]).settled()
    values = best.problem.values(best.point)
    scene = rig.scene.with_keys({name: value for name, value in values.items() if name not in data.sensors})
    start = np.array([key.start for key in best.problem.keys])
    # their values are those of the scene as it is
    freed = suspected(scene, data, values)
    suspects = tried(best, freed, start, lambda share: progress(2.0 * LOOKED + (1.0 - 2.0 * LOOKED) * share))
    return FitResult(
        scene=scene,
        parameters=[_fitted(key, best, suspects) for key in keys],
        correlations=best.correlations,
        measurement=data,
        computed=Result({"time": data.table.time, **dict(zip(names, rig.computed(values).T, strict=True))}),
        noise=dict(zip(names, np.sqrt(np.mean(best.problem.sigma**2, axis=0)).tolist(), strict=True)),
        estimated=[name for name in names if name not in data.noise],
        chi_squared=best.chi_squared / best.freedom,
        suspects=suspects,
        units_doubted=[],
        same_end=(sum(end.chi_squared <= 1.01 * ends[0].chi_squared for end in ends), len(ends)),
        runs=rig.runs,
        ended=best.ended,
    )


def _of_influence(end: End) -> End:
    """The end of a search with what has no influence put back to its start and held."""
    told, keys = end.changes >= NOTHING, end.problem.keys
    if not told.any():
        raise Refused(
            f"no free parameter ({', '.join(key.name for key in keys)}) has an influence on"
            f" {', '.join(end.problem.rig.data.columns)}"
        )
    free = tuple(key for key, one in zip(keys, told, strict=True) if one)
    fixed = end.problem.fixed | {key.name: key.start for key in keys if key not in free}
    problem = dataclasses.replace(end.problem, keys=free, fixed=fixed)
    return dataclasses.replace(end, problem=problem, point=end.point[told], slopes=end.slopes[:, told])


def _fitted(key: Free, best: End, suspects: Sequence[Suspect]) -> Fitted:
    """A free key as it was found."""
    value, endless = best.problem.values(best.point)[key.name], (-math.inf, math.inf)
    if key not in best.problem.keys:
        doubt = "has no influence on the measured columns and keeps its start value"
        return Fitted(key.name, value, math.inf, endless, endless, key.unit, doubt=doubt)
    narrow = best.ranges[key.name]
    width, doubts = narrow[1] - narrow[0], list[str]()
    if not key.held and width > 2.0 * abs(value):
        doubts.append("not identifiable from the data: the interval is wider than twice the value")
    elif key.held and width >= (1.0 - AT_END) * key.size:
        doubts.append("not identifiable from the data: the interval is as wide as its range")
    elif key.held and min(value - key.low, key.high - value) < AT_END * key.size:
        doubts.append("is at the end of its range")
    named = causes(suspects)
    following = named[0].autocorrelation if named else best.following
    unexplained = following > best.problem.rig.data.chance
    if unexplained:
        doubts.append("the residuals are systematic: no interval is reliable until their cause is known")
    holds = not named or unexplained
    # where a cause explains all, nothing that explains much less is possible, nor that all is as it should be
    enough = -math.inf if holds else named[0].evidence - EXCLUDED
    possible = [one for one in suspects if math.isfinite(one.error) and one.evidence > enough]
    ends = [(*narrow, "")] if holds else []
    ends += [(*one.answers[key.name][1:], one.name) for one in possible]
    least, greatest = min(ends), max(ends, key=lambda end: end[1])
    return Fitted(
        name=key.name,
        value=value,
        error=best.errors[key.name],
        interval=(least[0], greatest[1]),
        narrow=narrow,
        unit=key.unit,
        rests_on=tuple(dict.fromkeys(name for name in (least[2], greatest[2]) if name)),
        holds=holds,
        doubt="; ".join(doubts),
    )
