"""Fit: values of a scene's keys at which it computes what was measured, and how well the data tell them.

A measurement is columns over time that a scene computes, in SI, with their noise where it is known. The scene
is run and read at the times of a measurement, which need not be communication points. The loop keeps its
communication step, which is part of what is simulated: controllers sample at it. The FMU stops within a step
at each time and is read there, so that nothing is interpolated that jumps with the freewheels. A mean or peak
over a step is that since the time before, the first since the start.

Least squares by lmfit (Newville et al., doi:10.5281/zenodo.11813), trust-region reflective, weighted by the
noise of each column.
"""

from __future__ import annotations

import copy
import dataclasses
import functools
import itertools
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..common.errors import Refused, did_you_mean
from ..common.extras import library
from ..common.files import OUTPUT_FOLDER, write_text
from ..common.terminal import Progress
from ..contract.variables import BY_NAME, COMPUTED
from ..harness.fmu import fmu_file, run
from ..harness.simulate import Plant, Result
from ..loops import ClosedLoop
from ..loops.closed_loop import PLANT_INPUTS, SIGNAL_UNITS
from ..scene import Scene
from ..scene.reading import scene_text
from ..scene.run import SceneRunner
from .axes import Free, Point, Range, free_keys, of_shares, shares_sampled
from .evaluation import read
from .suspects import (
    AS_GOOD,
    CLOCK,
    FALSE_ALARM,
    GAIN,
    OFFSET,
    SHIFT,
    Leftover,
    Suspect,
    lag_one,
    sensor_keys,
    suspected,
    wrong_unit,
)

# --- measurements ---

# a column of this ending has the standard deviation of the noise of another, row by row
NOISE = "_noise"
MEAN, PEAK = "_mean", "_peak"
# of the FMU; the ripple is that of one step and no sum or peak of its parts
READABLE = [name for name in COMPUTED if name != "torque_ripple"]
# times as near to a communication point, of a step, are taken there
NEAR = 1e-6

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Measurement:
    """Measurement of a rig.

    Attributes:
        table: over time, s, the columns that are compared, SI. noise: standard deviations by column, for
            those whose noise is known, shape (rows,). counted: whether a value is compared, shape
            (rows, columns): the first of a mean over steps is not, since when it is a mean is not known.
    """

    table: Result
    noise: dict[str, Array]
    counted: NDArray[np.bool_]

    @property
    def columns(self) -> list[str]:
        """Names of what is compared."""
        return self.table.names[1:]

    @property
    def values(self) -> Array:
        """Measured values, shape (rows, columns)."""
        return np.column_stack([self.table[name] for name in self.columns])


def measurement(measured: Result | Path | str, scene: Scene, columns: Sequence[str] = ()) -> Measurement:
    """Read a measurement and look at it.

    Args:
        measured: a table, or a CSV file with a heading row, units in brackets where they are not SI.
        scene: that computes the columns. columns: those that are compared; by default all but the inputs of
            the module, which the scene gives.

    Raises:
        TableError: it is no table over time, or a unit is of another kind.
        Refused: the scene has no such column, the time does not grow or is outside the run, a noise is not
            above 0.
    """
    table = measured if isinstance(measured, Result) else Result.from_csv(measured)
    known = [*READABLE, *(name for name in scene.surroundings.output_labels if name not in READABLE)]
    noises = {name for name in table.names[1:] if name.endswith(NOISE)}
    given = columns or [name for name in table.names[1:] if name not in {*noises, *PLANT_INPUTS}]
    for name in given:
        if name not in known:
            raise Refused(f"column {name} must be computed by the scene {did_you_mean(name, known)}")
    if not given:
        raise Refused(f"columns must include one that the scene computes, are {', '.join(table.names)}")
    for name in noises:
        if name.removesuffix(NOISE) not in table:
            raise Refused(f"column {name} must belong to a column {name.removesuffix(NOISE)}, there is none")
    times, stop_time = table.time, scene.run.stop_time
    if (np.diff(times) <= 0.0).any():
        row = int(np.argmax(np.diff(times) <= 0.0)) + 1
        raise Refused(
            f"time must grow from row to row, is {times[row]:g} s in row {row} as in the one before"
        )
    if times[0] < 0.0 or times[-1] > stop_time * (1.0 + 1e-9):
        raise Refused(
            f"time must be within the run of the scene, 0 to {stop_time:g} s,"
            f" is {times[0]:g} to {times[-1]:g} s"
        )
    units = SIGNAL_UNITS | scene.signal_units | {name: one.unit for name, one in BY_NAME.items()}
    noisy = [name for name in given if f"{name}{NOISE}" in noises]
    kept = {name: units.get(name, "") or "1" for name in given}
    kept |= {f"{name}{NOISE}": kept[name] for name in noisy}
    si = Result({"time": table.time, **{name: table[name] for name in kept}}, table.units).converted(kept)
    noise = {name: si[f"{name}{NOISE}"] for name in noisy}
    for name, deviation in noise.items():
        if deviation.min() <= 0.0:
            raise Refused(f"{name}{NOISE} must be above 0, is {deviation.min():g}")
    counted = np.ones((len(table), len(given)), dtype=bool)
    counted[0, [name.endswith(MEAN) for name in given]] = False
    return Measurement(si.without({f"{name}{NOISE}" for name in noisy}), noise, counted)


class Stopped:
    """A plant of loops.ClosedLoop that stops within its steps to be read.

    Args:
        plant: a started FMU. names: what is read. times: s, rising. near: s, up to which a time is at a
            communication point.
    """

    def __init__(self, plant: Plant, names: Sequence[str], times: Array, near: float) -> None:
        self._plant, self._names, self._times, self._near = plant, tuple(names), times, near
        # where it has stopped, s, and the values of names there
        self._stops, self._rows = [0.0], [np.array(plant.read(self._names))]

    def set(self, **values: float) -> None:
        """Set inputs by name."""
        self._plant.set(**values)

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values by name."""
        return self._plant.read(names)

    def advance(self, step: float) -> None:
        """Advance by a communication step, s, by way of the times within it."""
        self.take_steps(np.array([step]), (), np.empty((1, 0)), (), np.empty((2, 0)))

    def take_steps(
        self, lengths: Array, inputs: Sequence[str], given: Array, outputs: Sequence[str], rows: Array
    ) -> bool:
        """Take steps by way of the times within them; arguments as of Fmu.take_steps. It always can."""
        now = self._stops[-1]
        points = np.cumsum([now, *lengths])
        first = np.searchsorted(self._times, points[:-1] + self._near, "right")
        after = np.searchsorted(self._times, points[1:] - self._near)
        parts = [[*self._times[i:k], end] for i, k, end in zip(first, after, points[1:], strict=True)]
        stops, number = np.concatenate(parts), [len(part) for part in parts]
        held = dict(zip(inputs, np.repeat(given, number, axis=0).T, strict=True))
        found = np.empty((stops.size + 1, len(outputs) + len(self._names)))
        run(self._plant, np.diff(stops, prepend=now), held, (*outputs, *self._names), found)
        rows[:] = found[np.cumsum([0, *number]), : len(outputs)]
        self._stops.extend(stops.tolist())
        self._rows.extend(found[1:, len(outputs) :])
        return True

    def values(self, name: str, times: Array) -> Array:
        """Values of a name at times, which it has passed, shape (times,); see the head on means and peaks."""
        stops, values = np.array(self._stops), np.array(self._rows)[:, self._names.index(name)]
        ends, places = np.unique(np.searchsorted(stops, times - self._near), return_inverse=True)
        last, found = int(ends[-1]) + 1, values[ends]
        # what a time stands for begins behind the one before; the start stands for itself
        begins = np.append(min(1, ends[0]), ends[:-1] + 1)
        if name.endswith(MEAN):
            lengths, whole = (
                np.diff(stops, prepend=-1.0),
                np.diff(stops[ends], prepend=0.0 if ends[0] else -1.0),
            )
            found = np.add.reduceat(values[:last] * lengths[:last], begins) / whole
        elif name.endswith(PEAK):
            found = np.maximum.reduceat(values[:last], begins)
        return found[places]


class Observer(SceneRunner):
    """Runs scenes that differ in numbers and gives their signals at the times of a measurement.

    Args:
        fmu_path: the FMU of the module. names: of its variables and of signals of the loop; the latter are
            known at the communication points and taken linear in between. times: s, rising, from 0.

    Raises:
        FmuError: the FMU cannot be loaded.
    """

    def __init__(self, fmu_path: Path | str, names: Sequence[str], times: Array) -> None:
        super().__init__(fmu_path)
        self._names, self._times = list(names), times

    def __call__(self, scene: Scene, shifts: Sequence[float] | None = None) -> Array:
        """Values at the times, shape (times, names).

        Args:
            scene: that is run. shifts: s, by which each name is read earlier, at the start at the earliest.

        Raises:
            FmuError: the FMU refuses a value or a step.
            Refused: a time is within a step over which the speed of link 1 is extrapolated.
        """
        step = scene.run.communication_step
        near, late = NEAR * step, np.zeros(len(self._names)) if shifts is None else np.array(shifts)
        at = dict(zip(self._names, np.maximum(self._times - late[:, None], 0.0), strict=True))
        times = np.unique(list(at.values()))
        times = times[np.diff(times, prepend=-1.0) > near]
        off = np.abs(times / step - np.round(times / step)) > NEAR
        if off.any() and scene.parameters().get("input_hold"):
            raise Refused(
                "with mechanism.input_hold = 'linear' time must be a whole number of run.communication_step ="
                f" {step:g} s, is {times[off][0]:g} s"
            )
        signals = scene.surroundings.output_labels
        read = [name for name in self._names if name not in signals]
        plant = Stopped(self.started(scene), read, times, near)
        loop = ClosedLoop(plant, scene.surroundings, (), scene.signal_units)
        record = loop.run(step * max(math.ceil(times[-1] / step - NEAR), 1))
        values = [
            np.interp(at[name], record.time, record[name])
            if name in signals
            else plant.values(name, at[name])
            for name in self._names
        ]
        return np.column_stack(values)


# --- fits ---

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
# suspects that explain something, that are shown
SHOWN = 6
# scene and measurement differ by so much of a factor of units
NEARLY = 0.25
# of the intervals, and of normal noise in standard errors
CONFIDENCE, WITHIN = 0.95, 1.96
# an end that is not there after so many steps, each twice the one before, is none
MOST_STEPS = 12
# excess of chi-squared where the scene refuses a value
REFUSED = 1e12
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
# change of the residuals, the noise being 1 of each, at which a suspect is freed, and that is none; tries
CHANGE, NO_CHANGE, TRIES = 5.0, 0.5, 5
# longest step of it, in sizes of the suspect
LONGEST = 1e5
# evidence from which on a suspect is fitted in full, and passes over the noise then
WORTH, AGAIN = 10.0, 3
# runs whose values are kept: offsets and gains need none of their own
KEPT = 8
NOT_IDENTIFIABLE = "not identifiable from the data: the interval is {}"

# values of variables by identifier
Variables = dict[str, float]
Stage = TypeVar("Stage")


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
        value = f"{self.value:.6g} {self.unit}".rstrip()
        if not math.isfinite(high - low):
            return f"{value}, {self.doubt}"
        doubt = f", {self.doubt}" if self.doubt else ""
        return f"{value}, from {low:.6g} to {high:.6g}{doubt}"


@dataclass(frozen=True)
class FitResult:
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
    def warnings(self) -> list[str]:
        """Warnings of what the user has to know, in sentences."""
        found = [f"{one.name}: {one.doubt}" for one in self.parameters if one.doubt]
        for (first, second), number in self.correlations.items():
            if abs(number) > CORRELATED:
                found.append(
                    f"{first} and {second} are correlated by {number:.3f}: the data tell both together, not"
                    " each"
                )
        if not self.ended:
            found.append("the search was broken off: too many runs")
        same, all_searches = self.same_end
        if all_searches > 1 and same == 1:
            found.append(
                f"only 1 of {all_searches} searches ended at the best: more starts may find a better one"
            )
        chance = CHANCE * math.sqrt(2.0 / self.measurement.counted.sum())
        if not self.estimated and self.chi_squared > 1.0 + chance:
            found.append(
                f"chi-squared is {self.chi_squared:.3g}: the residuals are larger than the noise,"
                " the scene lacks something"
            )
        table, related = self.table(), False
        for name in self.measurement.columns:
            following = lag_one(table[f"{name}_residual"])
            if following > self._by_chance:
                related = True
                found.append(
                    f"residuals of {name} are autocorrelated (lag-1 {following:.2f}): the model has a"
                    " systematic error, and the intervals are too narrow"
                )
        # of a gain that says so it is told below
        alone = any(one.name.startswith(GAIN) and wrong_unit(one.value, one.of_unit) for one in self.causes)
        return [*(self.units_doubted if related and not alone else ()), *found, *self._verdict()]

    @property
    def causes(self) -> list[Suspect]:
        """Suspects of which one explains the residuals, as well as the first; none where it may be chance."""
        from scipy.stats import chi2

        least = float(chi2.isf(FALSE_ALARM / max(len(self.suspects), 1), 1))
        best = max((one.evidence for one in self.suspects), default=0.0)
        return [one for one in self.suspects if one.evidence > max(best - AS_GOOD, least)]

    def _verdict(self) -> list[str]:
        """The sentence on what would explain the residuals."""
        if not self.causes:
            return []
        first, *others = self.causes
        before, after = first.chi_squared
        whole = "" if first.autocorrelation <= self._by_chance else " in part"
        answers = ", ".join(
            f"{name} would be {value:.5g}, not {self[name].value:.5g}"
            for name, (value, _) in first.answers.items()
        )
        also = f", as would {' or '.join(one.cause for one in others)}: the data do not tell which"
        return [
            f"{first.cause} would explain the residuals{whole} (chi squared {before:,.0f} -> {after:,.0f}, of"
            f" {int(self.measurement.counted.sum())} values): {answers}{also if others else ''}; mend it or"
            f" fit again with --free {first.freed}"
        ]

    def reach(self, name: str) -> tuple[tuple[float, str], tuple[float, str]]:
        """Interval of a free key with any one suspect free too.

        Returns:
            Both ends, each with the name of the suspect that sets it, or "" for none.
        """
        ends = [(*self[name].interval, "")]
        for one in self.suspects:
            value, error = one.answers.get(self[name].name, (0.0, math.inf))
            if math.isfinite(one.error) and math.isfinite(error):
                ends.append((value - WITHIN * error, value + WITHIN * error, one.name))
        least, greatest = min(ends), max(ends, key=lambda end: end[1])
        return (least[0], least[2]), (greatest[1], greatest[2])

    def suspicions(self) -> dict[str, str]:
        """Give lines, by name, on the suspects that explain something, or else on those answers rest on."""
        ends = {}
        if not self.causes:
            ends = {one.name: self.reach(one.name) for one in self.parameters if math.isfinite(one.error)}
        setting = {by for both in ends.values() for _, by in both}
        explaining = [one.name for one in self.suspects if one.evidence > AS_GOOD][:SHOWN]
        lines = {one.name: one.told for one in self.suspects if one.name in {*explaining, *setting}}
        for name, ((low, by), (high, other)) in ends.items():
            source = " and ".join(dict.fromkeys(filter(None, (by, other)))) or "none of them"
            lines[f"{name}, any one of all free"] = f"from {low:.6g} to {high:.6g} ({source})"
        together = [one.name for one in self.suspects if not math.isfinite(one.error)]
        return lines | ({"told only with what is free": ", ".join(together)} if together else {})

    @property
    def _by_chance(self) -> float:
        """Autocorrelation that the noise of a sensor may have."""
        return max(AUTOCORRELATED, CHANCE / math.sqrt(len(self.computed)))

    def as_dict(self) -> dict[str, Any]:
        """Give the result for machines: what is not known is None."""
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
            "suspects": [one.as_dict() for one in self.suspects],
            "causes": [one.name for one in self.causes],
            "values": int(self.measurement.counted.sum()),
            "searches_that_agree": list(self.same_end),
            "runs": self.runs,
            "warnings": self.warnings,
        }

    def lines(self) -> dict[str, str]:
        """Give the lines of the printed table, by heading."""
        found = {one.name: one.text for one in self.parameters}
        for (first, second), number in self.correlations.items():
            found[f"correlation of {first} and {second}"] = f"{number:.3f}"
        for name, value in self.noise.items():
            source = ", from the residuals" if name in self.estimated else ""
            found[f"noise of {name}"] = f"{value:.4g} {self.measurement.table.units[name]}{source}"
        freedom = int(self.measurement.counted.sum()) - len(self.parameters)
        judged = " (the noise is from the residuals, so it judges nothing)" if self.estimated else ""
        found["chi squared"] = f"{self.chi_squared * freedom:.4g} of {freedom} degrees of freedom{judged}"
        agree = "{} of {}".format(*self.same_end)
        return {**found, "searches that end there": agree, "runs": str(self.runs)}

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
            of all columns) of a sensor.
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
    for name in ("lmfit", "tomli_w"):
        library(name, "jobs")
    base, title = read(scene)
    data = measurement(measured, base, columns)
    keys = free_keys(free, base, sensor_keys(data.table))
    if int(data.counted.sum()) <= len(keys):
        raise Refused(
            f"there must be more measured values than free keys, {len(keys)}, are {int(data.counted.sum())}"
        )
    if starts < 0:
        raise Refused(f"starts must be at least 0, is {starts}")
    search = _Search(base, keys, data, fmu_file(fmu), progress or (lambda share: None))
    with search.observer:
        doubted = search.units_doubted()
        try:
            found = search.run(starts, seed)
        except Refused as error:
            raise Refused("; ".join([str(error), *doubted])) from error
    folder = OUTPUT_FOLDER / f"{title}_fit" if output is None else Path(output)
    found = dataclasses.replace(found, units_doubted=doubted)
    return dataclasses.replace(found, files=found.write(folder))


class _Search:
    """The search of one fit, over the variables of what is free, by their identifiers."""

    def __init__(
        self, scene: Scene, keys: list[Free], data: Measurement, fmu: Path, progress: Progress
    ) -> None:
        self.scene, self.data, self.progress = scene, data, progress
        self.keys = {key.identifier: key for key in keys}
        self.sensors = sensor_keys(data.table)
        self.observer = Observer(fmu, data.columns, data.table.time)
        self.runs, self.refused, self.done, self.stages = 0, "", 0, 1
        values = data.values
        spread = np.where(np.ptp(values, axis=0) > 0.0, values.std(axis=0), 1.0)
        self.sigma: Array = np.broadcast_to(spread, values.shape).copy()
        for place, name in enumerate(data.columns):
            if name in data.noise:
                self.sigma[:, place] = data.noise[name]
        self._observed = functools.lru_cache(KEPT)(self._observe)

    def _observe(self, point: tuple[tuple[str, float], ...], shifts: tuple[float, ...]) -> Array:
        """Columns that the scene computes with keys, earlier by shifts, s; NaN where it refuses them."""
        self.runs += 1
        try:
            return self.observer(self.scene.with_keys(dict(point)), shifts)
        except Refused as error:
            self.refused = str(error)
            return np.full(self.data.values.shape, np.nan)

    def computed(self, variables: Variables) -> Array:
        """Columns as sensors show them, shape (rows, columns); NaN where the scene refuses the values."""
        values = {key.name: key.value(variables[name]) for name, key in self.keys.items()}
        point = tuple(one for one in values.items() if one[0] not in self.sensors)
        columns, all_late = self.data.columns, values.get(CLOCK, 0.0)
        shifts = tuple(all_late + values.get(f"{SHIFT}.{name}", 0.0) for name in columns)
        gains, offsets = (
            [values.get(f"{kind}.{name}", usual) for name in columns]
            for kind, usual in ((GAIN, 1.0), (OFFSET, 0.0))
        )
        return self._observed(point, shifts) * gains + offsets

    def residuals(self, variables: Variables) -> Array:
        """Differences over noise, those that count, flat; behind them those from what was known before."""
        differences = (self.computed(variables) - self.data.values) / self.sigma
        known = [
            (key.value(variables[name]) - key.start) / key.deviation
            for name, key in self.keys.items()
            if math.isfinite(key.deviation)
        ]
        return np.append(differences[self.data.counted], known)

    def units_doubted(self) -> list[str]:
        """Tell of columns that are as far from what the scene computes as it is as another unit is."""
        computed = self.computed({name: key.variable(key.start) for name, key in self.keys.items()})
        squares = np.maximum(np.sum(computed**2, axis=0), 1e-300)
        gains = np.sum(self.data.values * computed, axis=0) / squares
        found = []
        for name, gain in zip(self.data.columns, gains, strict=True):
            unit = wrong_unit(gain, self.data.table.units.get(name, ""), NEARLY)
            if unit:
                found.append(f"{name} is {gain:.3g} times what the scene computes as it is: perhaps {unit}")
        return found

    def run(self, starts: int, seed: int) -> FitResult:
        """Look at points, search from the best of them, then find the noise."""
        begun = map(self._count_stage, self._starts(starts, seed))
        ends = sorted(map(self._minimise, begun), key=lambda end: float(end.chisqr))
        best = self._weighted(ends[0])
        computed, names = self.computed(_variables(best)), self.data.columns
        intervals = {name: self._interval(best, name) for name in best.var_names}
        parameters = [_fitted(key, best.params[name], intervals.get(name)) for name, key in self.keys.items()]
        found = {one.name: one.value for one in parameters if one.name not in self.sensors}
        return FitResult(
            scene=self.scene.with_keys(found),
            parameters=parameters,
            correlations=_correlations(list(self.keys.values()), best),
            measurement=self.data,
            computed=Result({"time": self.data.table.time, **dict(zip(names, computed.T, strict=True))}),
            noise=dict(zip(names, np.sqrt(np.mean(self.sigma**2, axis=0)).tolist(), strict=True)),
            estimated=[name for name in names if name not in self.data.noise],
            chi_squared=float(best.redchi),
            suspects=self._suspects(best, found),
            units_doubted=[],
            same_end=(sum(bool(end.chisqr <= (1.0 + SAME) * ends[0].chisqr) for end in ends), len(ends)),
            runs=self.runs,
            ended=bool(best.success),
        )

    def _suspects(self, best: Any, point: Mapping[str, float]) -> list[Suspect]:
        """Suspects, freed in turn, what explains the most first; what changes nothing is none.

        Args:
            best: end of the search. point: its values of the scene's keys.
        """
        tried = []
        known = best.residual.size - int(self.data.counted.sum())
        place = np.append(np.nonzero(self.data.counted)[1], np.full(known, -1))
        estimated = [name not in self.data.noise for name in self.data.columns]
        left = Leftover(best.residual, place, estimated)
        for key in map(self._count_stage, self._suspected(self.scene.with_keys(point))):
            slopes = self._with(key)._valley(best, key)
            if slopes is not None:
                tried.append(self._suspect(left, best, key, *slopes))
        tried.sort(key=lambda one: -one.evidence)
        return tried

    def _suspect(self, left: Leftover, best: Any, key: Free, slope: Array, along: Array) -> Suspect:
        """A suspect freed, and fitted in full where it matters; slope, along: as of _valley."""
        names, keys = [*best.var_names, key.identifier], {**self.keys, key.identifier: key}
        low, high = key.limits
        slopes, turn = np.column_stack([best.jac, slope]), np.eye(len(names))
        turn[:-1, -1] = along
        changes, spread, rest = left.solved(slopes, (low - 1.0, high - 1.0))
        begun = [*(best.params[name].value for name in best.var_names), 1.0]
        at = dict(zip(names, begun + turn @ changes, strict=True))
        deviation = dict(zip(names, np.sqrt(np.diag(turn @ spread @ turn.T)), strict=True))
        evidence, confirmed = left.evidence(rest), False
        if not slope.any():
            deviation[key.identifier] = math.inf
        if evidence > WORTH and changes[-1]:
            # near 1, as variables are to be
            nearer = dataclasses.replace(key, span=key.span * changes[-1])
            other = self._with(nearer)
            other.sigma = self.sigma * left.scatter(rest)
            try:
                end = other._again(best, at | {key.identifier: 2.0})
            except Refused:
                # on its way it meets values that the scene refuses: it stays as near as is known
                pass
            else:
                at, keys[key.identifier], confirmed = _variables(end), nearer, True
                deviation = {name: float(end.params[name].stderr or math.inf) for name in names}
                rest = self._with(nearer).residuals(at)
                evidence = left.evidence(rest)
        values = {
            keys[name].name: (keys[name].value(at[name]), float(abs(keys[name].span) * deviation[name]))
            for name in names
        }
        value, error = values.pop(key.name)
        scatter = left.scatter(rest)
        return Suspect(
            name=key.name,
            value=value,
            error=error,
            usual=key.start,
            unit=key.unit,
            of_unit=self.data.table.units.get(key.name.partition(".")[2], ""),
            evidence=evidence,
            chi_squared=(left.chi_squared(left.values, scatter), left.chi_squared(rest, scatter)),
            answers=values,
            autocorrelation=max(lag_one(rest[left.place == n]) for n in range(len(self.data.columns))),
            confirmed=confirmed,
        )

    def _again(self, best: Any, at: Variables) -> Any:
        """Search again with one more key free, from values by name; its noise found anew."""
        held = [name for name in self.keys if name not in at]
        start = {**_variables(best), **at}
        for name, key in self.keys.items():
            start[name] = float(np.clip(start[name], *key.limits))
        for _ in range(AGAIN):
            end = self._minimise(start, held)
            start = _variables(end)
            self._estimate_noise(start, len(end.var_names))
        return end

    def _suspected(self, scene: Scene) -> list[Free]:
        """Suspects by the values that a scene has."""
        return suspected(scene, self.sensors, [key.name for key in self.keys.values()])

    def _with(self, key: Free) -> _Search:
        """The search with one more key free, and weights of its own."""
        other = copy.copy(self)
        other.keys, other.sigma = {**self.keys, key.identifier: key}, self.sigma.copy()
        return other

    def _valley(self, best: Any, key: Free) -> tuple[Array, Array] | None:
        """Slopes along a suspect while the others give way to it; None where it changes nothing.

        A step that is as long as the data allow counts what a tangent does not: where the others make up for
        nearly all of it, the little that is left is not of the curvature alone.

        Returns:
            (slopes of the residuals, shape (residuals,), 0 where the others make up for all of it; those of
            the others, shape (variables of best,)).
        """
        start, (low, high) = np.array([best.params[name].value for name in best.var_names]), key.limits
        along, back, found = np.zeros(start.size), -np.linalg.pinv(best.jac), None
        step, longer = 1.0 if high > 1.0 else -1.0, 1e3
        for _ in range(TRIES):
            step = float(np.clip(step, max(low - 1.0, -LONGEST), min(high - 1.0, LONGEST)))
            at = dict(zip(best.var_names, start + step * along, strict=True))
            change = self.residuals({**_variables(best), **at, key.identifier: 1.0 + step}) - best.residual
            if not np.isfinite(change).all():
                # what the scene refuses, it may take nearer
                step *= 0.1
                continue
            first, found = found is None, (step, change, along)
            more = back @ change / step
            size = float(np.linalg.norm(change + step * best.jac @ more))
            if not first and 0.5 * CHANGE < size < 2.0 * CHANGE:
                break
            along = along + more
            step *= float(np.clip(CHANGE / max(size, 1e-12), 1e-3, longer))
            longer = 10.0
        if found is None:
            return None
        step, change, along = found
        if np.linalg.norm(change - step * best.jac @ along) < NO_CHANGE:
            return None
        return change / step * (np.linalg.norm(change) > NO_CHANGE), along

    def _starts(self, starts: int, seed: int) -> list[Variables]:
        """Points at which searches begin: of those looked at the best."""
        keys = list(self.keys.values())
        places: list[Point] = [{key.name: key.start for key in keys}]
        if starts and any(key.held for key in keys):
            places += of_shares(keys, shares_sampled(len(keys), f"latin:{starts}", seed))
        points = [{key.identifier: key.variable(float(at[key.name])) for key in keys} for at in places]
        self.stages = len(points) + min(SEARCHED, len(points)) + PASSES + len(self.keys)
        self.stages += len(self._suspected(self.scene))
        costs = np.array([np.sum(self.residuals(point) ** 2) for point in map(self._count_stage, points)])
        if not np.isfinite(costs).any():
            raise Refused(f"the scene must take values of what is free, refuses all tried: {self.refused}")
        return [points[n] for n in np.argsort(costs)[:SEARCHED] if np.isfinite(costs[n])]

    def _count_stage(self, begun: Stage) -> Stage:
        """Pass on what a stage begins with, the stage counted as done."""
        self.done += 1
        self.progress(self.done / self.stages)
        return begun

    def _minimise(
        self,
        start: Variables,
        held: Sequence[str] = (),
        steps: Any = STEP,
        slopes: str = "2-point",
        enough: float = ENOUGH,
    ) -> Any:
        """Search from a start; the MinimizerResult of lmfit.

        Args:
            held: identifiers of what stays where it is. steps: of the differences, one or one a variable.
            slopes: by differences to one side or, "3-point", to both. enough: see ENOUGH.
        """
        import lmfit

        variables = lmfit.Parameters()
        for name, key in self.keys.items():
            low, high = key.limits
            variables.add(name, start[name], vary=name not in held, min=low, max=high)

        def residuals(given: Any) -> Array:
            return self.residuals(given.valuesdict())

        # lsmr soon ends where something has no influence, but takes no single variable
        solver = "lsmr" if len(self.keys) - len(held) > 1 else "exact"
        known = len(self.data.noise) == len(self.data.columns)
        minimizer = lmfit.Minimizer(
            residuals, variables, scale_covar=not known, nan_policy="propagate", max_nfev=MOST_RUNS
        )
        try:
            end = minimizer.least_squares(
                jac=slopes, diff_step=steps, x_scale="jac", tr_solver=solver, ftol=enough, xtol=enough
            )
        except ValueError as error:
            raise Refused(
                f"ranges must be such that the scene takes them: {self.refused or error}"
            ) from error
        if not hasattr(end, "jac"):
            # broken off it leaves no slopes: a last step gives them
            end = self._minimise(_variables(end), held, steps, slopes, enough=0.5)
            end.success = False
        return end

    def _weighted(self, best: Any) -> Any:
        """The end with weights by the noise; what has no influence is put back to its start and held."""
        held: list[str] = []
        for n in range(PASSES):
            start = _variables(best)
            self._estimate_noise(start, len(best.var_names))
            if n:
                # the search before had these weights, nearly
                changes = zip(best.var_names, np.sqrt(_squares(best)), strict=True)
                held += [name for name, change in changes if change < NOTHING]
            if len(held) == len(self.keys):
                raise Refused(
                    f"something free must have an influence on {', '.join(self.data.columns)}, none has of"
                    f" {', '.join(key.name for key in self.keys.values())}"
                )
            start |= {name: self.keys[name].variable(self.keys[name].start) for name in held}
            steps = _steps(best)[[name not in held for name in best.var_names]]
            best = self._minimise(self._count_stage(start), held, steps, "3-point")
        return best

    def _estimate_noise(self, variables: Variables, free: int) -> None:
        """Take the noise of each column where it is not known from its residuals."""
        differences = np.where(self.data.counted, self.computed(variables) - self.data.values, 0.0)
        number = self.data.counted.sum(axis=0)
        share = 1.0 - free / self.data.counted.sum()
        found = np.sqrt(np.sum(differences**2, axis=0) / (number * share))
        for place, name in enumerate(self.data.columns):
            if name not in self.data.noise and found[place] > 0.0:
                self.sigma[:, place] = found[place]

    def _interval(self, best: Any, name: str) -> tuple[float, float]:
        """Both ends of the interval of a variable; an end of its range, or infinite, where there is none."""
        from scipy.stats import f

        allowed = float(best.chisqr * (1.0 + float(f.ppf(CONFIDENCE, 1, best.nfree)) / best.nfree))
        start, steps = _variables(best), dict(zip(best.var_names, _steps(best), strict=True))
        step = steps.pop(name)
        held = [one for one in self.keys if one not in steps]

        def excess(u: float) -> float:
            """Least chi-squared for a value of the variable, over what is allowed."""
            point = {**start, name: u}
            if not np.isfinite(least := np.sum(self.residuals(point) ** 2)):
                return REFUSED
            if steps:
                least = self._minimise(point, held, list(steps.values()), "3-point").chisqr
            return float(least) - allowed

        low, high = self.keys[name].limits
        found = _end(excess, start[name], -step, low), _end(excess, start[name], step, high)
        self._count_stage(start)
        return found


def _variables(end: Any) -> Variables:
    return {name: float(one.value) for name, one in end.params.items()}


def _squares(end: Any) -> Array:
    """Sum of the squares of the residuals' slopes along each variable."""
    squares: Array = np.sum(np.asarray(end.jac) ** 2, axis=0)
    return squares


def _steps(end: Any) -> Array:
    """Standard error of each variable, the others held, as far as it is a step for differences."""
    changes = np.sqrt(_squares(end) / (end.redchi or 1.0))
    steps: Array = np.clip(1.0 / np.maximum(changes, 1.0 / LARGEST_STEP), SMALLEST_STEP, None)
    return steps


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


def _fitted(key: Free, one: Any, interval: tuple[float, float] | None) -> Fitted:
    """A free key as it was found; one: its Parameter of lmfit; interval: None without influence."""
    value, error = key.value(one.value), math.inf
    if interval is None:
        doubt = "has no influence on what was measured, stays where it was"
        return Fitted(key.name, value, error, (-math.inf, math.inf), key.unit, doubt)
    if one.stderr is not None:
        error = abs(key.span) * float(one.stderr)
    low, high = sorted(map(key.value, interval))
    doubt = ""
    if not key.held:
        if high - low > 2.0 * abs(value):
            doubt = NOT_IDENTIFIABLE.format("wider than twice the value")
    elif high - low >= (1.0 - AT_END) * abs(key.span):
        doubt = NOT_IDENTIFIABLE.format("as wide as its range")
    elif min(one.value - 1.0, 2.0 - one.value) < AT_END:
        doubt = "is at the end of its range"
    return Fitted(key.name, value, error, (low, high), key.unit, doubt)


def _correlations(keys: Sequence[Free], best: Any) -> dict[tuple[str, str], float]:
    """Correlation of each pair of free keys whose errors are known."""
    found = {}
    for first, second in itertools.combinations(keys, 2):
        known = best.params[first.identifier].correl or {}
        if second.identifier in known:
            # a key that falls as its variable rises
            sign = math.copysign(1.0, first.span * second.span)
            found[first.name, second.name] = sign * float(known[second.identifier])
    return found
