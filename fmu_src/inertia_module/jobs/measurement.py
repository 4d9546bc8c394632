"""Measurements: columns over time with their noise, and a scene read at the same times, as sensors show it.

The loop keeps its communication step, for controllers sample at it. The FMU stops within a step at each time
and is read there: nothing is interpolated that jumps with the freewheels. A mean or peak over a step is that
since the time before, the first since the start.
"""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.equality import ByContent
from ..common.errors import Refused, did_you_mean, must_be
from ..common.time_range import likely_cause
from ..common.units import factor_between
from ..contract.variables import BY_NAME, COMPUTED
from ..harness.simulate import Result
from ..loops import ClosedLoop
from ..loops.closed_loop import PLANT_INPUTS, SIGNAL_UNITS
from ..scene import Scene
from ..scene.run import SceneRunner
from .axes import Free

# a column of this ending has the standard deviation of the noise of another, row by row
NOISE = "_noise"
MEAN, PEAK = "_mean", "_peak"
# of the FMU; the ripple is that of one step and no sum or peak of its parts
READABLE = [name for name in COMPUTED if name != "torque_ripple"]
# a communication step has so many: what is within one is at one time
TICKS = 10_000_000
# what a sensor may have: measured is gain times computed, which is shift earlier, and offset
OFFSET, GAIN, SHIFT = "offset", "gain", "shift"
# of the clock, which all columns share
CLOCK = f"{SHIFT}.time"
# of the time measured
MOST_LATE = 0.1
# standard deviations of chance that a warning keeps from; autocorrelation that is no longer a sensor's noise
CHANCE, AUTOCORRELATED = 4.0, 0.2
# so near, of the factor, a gain is that of another unit
NEAR_UNIT = 0.02
# that columns come in, beside those of SI
UNITS = ("rpm", "deg/s", "rev/s", "km/h", "deg", "rev", "mm", "kN", "kNm", "kJ", "kW")

Array = NDArray[np.float64]


def lag_one(residuals: Array) -> float:
    """Autocorrelation from row to row about the mean; 0 of what does not change."""
    centred = residuals - residuals.mean()
    return float(np.sum(centred[1:] * centred[:-1]) / np.sum(centred**2)) if np.ptp(residuals) else 0.0


@dataclass(frozen=True, eq=False)
class Measurement(ByContent):
    """Measurement of a rig.

    Attributes:
        table: over time, s, the columns that are compared, SI. headings: the unit that each came in.
        noise: standard deviations by column, for those whose noise is known, shape (rows,).
        counted: whether a value is compared, shape (rows, columns). Not compared are the first value of a
            mean, because its start is unknown, and a mean or peak over no time.
        unused: columns of a file that the scene does not compute.
    """

    table: Result
    headings: dict[str, str]
    noise: dict[str, Array]
    counted: NDArray[np.bool_]
    unused: tuple[str, ...] = ()

    @property
    def columns(self) -> list[str]:
        """Names of what is compared."""
        return self.table.names[1:]

    @property
    def values(self) -> Array:
        """Measured values, shape (rows, columns)."""
        return np.column_stack([self.table[name] for name in self.columns])

    @property
    def estimated(self) -> NDArray[np.bool_]:
        """Columns whose noise is found from their residuals, shape (columns,)."""
        return np.array([name not in self.noise for name in self.columns])

    @property
    def number(self) -> int:
        """How many values are compared."""
        return int(self.counted.sum())

    @property
    def chance(self) -> float:
        """Autocorrelation at lag 1 that the noise of a sensor may have."""
        return max(AUTOCORRELATED, CHANCE / math.sqrt(len(self.table)))

    @functools.cached_property
    def sensors(self) -> dict[str, Free]:
        """Free keys of what its sensors may have, by name; see OFFSET and CLOCK."""
        times = self.table.time
        lengths = np.diff(np.unique(times))
        row = float(np.median(lengths)) if lengths.size else 1e-3
        late = max(MOST_LATE * float(np.ptp(times)), row)
        found = [(CLOCK, "s", 0.0, row, late)]
        for name in self.columns:
            size = float(np.std(self.table[name])) or 1.0
            found.append((f"{OFFSET}.{name}", self.table.units[name], 0.0, size, math.inf))
            found.append((f"{GAIN}.{name}", "", 1.0, 1.0, math.inf))
            found.append((f"{SHIFT}.{name}", "s", 0.0, row, late))
        return {
            name: Free(name, unit, usual - most, usual + most, start=usual, size=size)
            for name, unit, usual, size, most in found
        }

    def unit_by(self, column: str, gain: float, near: float = NEAR_UNIT) -> str:
        """Say of a gain of a column that its numbers are in another unit, where that is as near as this."""
        heading, ratios = self.headings[column], dict[str, float]()
        for other in (self.table.units[column], *UNITS):
            with contextlib.suppress(ValueError):  # it is of another kind
                ratios[other] = factor_between(heading, other)
        found = [(abs(gain / ratio - 1.0), other) for other, ratio in ratios.items() if ratio != 1.0]
        off, unit = min(found, default=(near, ""))
        return f"its numbers are in {unit}, not in {heading}" if off < near else ""


def measurement(measured: Result | Path | str, scene: Scene, columns: Sequence[str] = ()) -> Measurement:
    """Read a measurement and look at it.

    Two rows of the same time are two readings at that time. A column of a file that the scene does not
    compute may have any name, unit and content.

    Args:
        measured: a table, or a CSV file with a heading row, units in brackets where they are not SI.
        scene: scene that computes the columns.
        columns: names of the columns that are compared; by default all but the inputs of the module, which
            the scene gives.

    Raises:
        TableError: it is no table over time, a column that is compared is not numbers, or a unit is of
            another kind.
        Refused: the scene has no such column, the time is outside the run, a noise is not above 0.
    """
    table = measured if isinstance(measured, Result) else Result.from_csv(measured)
    compared, unused = _compared(table, scene, columns)
    noisy = [name for name in compared if f"{name}{NOISE}" in _names(table)]
    times, stop_time = table.time, scene.run.stop_time
    if times[0] < 0.0 or times[-1] > stop_time * (1.0 + 1e-9):
        run = f"within the run of the scene, 0 to {stop_time:g} s"
        span = f"{times[0]:.12g} to {times[-1]:.12g} s"
        raise Refused(f"{must_be('time', run, span)}: {likely_cause(float(times[0]))}")
    units = SIGNAL_UNITS | scene.signal_units | {name: one.unit for name, one in BY_NAME.items()}
    si_units = {name: units.get(name, "") or "1" for name in compared}
    si_units |= {f"{name}{NOISE}": si_units[name] for name in noisy}
    columns_read = {"time": times, **{name: table[name] for name in si_units}}
    si = Result(columns_read, table.units, table.origin).converted(si_units)
    noise = {name: si[f"{name}{NOISE}"] for name in noisy}
    for name, deviation in noise.items():
        if deviation.min() <= 0.0:
            row = int(np.argmin(deviation))
            raise Refused(must_be(f"{si.place(row)}{name}{NOISE}", "above 0", f"{deviation[row]:g}"))
    counted = np.ones((len(table), len(compared)), dtype=bool)
    counted[0, [name.endswith(MEAN) for name in compared]] = False
    of_steps = np.array([name.endswith((MEAN, PEAK)) for name in compared])
    counted[1:][np.diff(times) == 0.0] &= ~of_steps
    headings = {name: table.units.get(name, "") or si_units[name] for name in compared}
    return Measurement(
        si.without({f"{name}{NOISE}" for name in noisy}), headings, noise, counted, tuple(unused)
    )


def _names(table: Result) -> list[str]:
    """Return the names of all columns of a table but the time, also of those that are not numbers."""
    return [*table.names[1:], *(table.origin.unread if table.origin else ())]


def _compared(table: Result, scene: Scene, columns: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the columns of a measurement that are compared, and those that the scene does not compute."""
    known = [*READABLE, *(name for name in scene.surroundings.output_labels if name not in READABLE)]
    names = _names(table)
    values = [name for name in names if not (name.endswith(NOISE) or name in PLANT_INPUTS)]
    compared = [*columns] or [name for name in values if name in known or table.origin is None]
    for name in compared if compared else values:
        if name not in known:
            raise Refused(f"column {name} must be computed by the scene {did_you_mean(name, known)}")
    if not compared:
        raise Refused(must_be("at least one column", "computed by the scene", ", ".join(table.names)))
    for name in names:
        value = name.removesuffix(NOISE)
        if value not in (name, *names) and (table.origin is None or value in known):
            raise Refused(f"column {name} requires a column {value}")
    return compared, [name for name in values if name not in known]


class Rig(SceneRunner):
    """A scene as the sensors of a measurement see it: an FMU that stops at their times within its steps.

    Attributes:
        runs: of the scene so far. refused: why the scene refused values the last time, or "".
    """

    def __init__(self, scene: Scene, data: Measurement, fmu_path: Path) -> None:
        super().__init__(fmu_path)
        self.scene, self.data, self.runs, self.refused = scene, data, 0, ""
        signals = scene.surroundings.output_labels
        self._read = tuple(name for name in data.columns if name not in signals)

    def computed(self, values: Mapping[str, float]) -> Array:
        """Columns for values by key, SI, shape (rows, columns); NaN where the scene refuses them."""

        def of_sensors(kind: str, usual: float) -> Array:
            return np.array([values.get(f"{kind}.{name}", usual) for name in self.data.columns])

        keys = {name: value for name, value in values.items() if name not in self.data.sensors}
        late = of_sensors(SHIFT, 0.0) + values.get(CLOCK, 0.0)
        times = np.maximum(self.data.table.time[:, None] - late, 0.0)
        self.runs += 1
        try:
            seen = self._seen(self.scene.with_keys(keys), times)
        except Refused as error:
            self.refused = str(error)
            return np.full(times.shape, np.nan)
        return of_sensors(GAIN, 1.0) * seen + of_sensors(OFFSET, 0.0)

    def _seen(self, scene: Scene, times: Array) -> Array:
        """Columns of a scene, each at its times, s, shape (rows, columns)."""
        step = scene.run.communication_step
        ticks = np.rint(times * (TICKS / step)).astype(np.int64)
        off = ticks % TICKS != 0
        if off.any() and scene.parameters().get("input_hold"):
            allowed = f"a multiple of run.communication_step = {step:g} s"
            time = f"{times[off][0]:g} s"
            raise Refused(must_be("with mechanism.input_hold = 'linear' each time", allowed, time))
        points = TICKS * np.arange(max(-(-int(ticks.max()) // TICKS), 1) + 1)
        stops = np.union1d(ticks, points)
        self._stops, self._points, self._taken = stops * (step / TICKS), np.searchsorted(stops, points), 0
        self._rows = np.empty((stops.size, len(self._read)))
        loop = ClosedLoop(self.started(scene), scene.surroundings, (), scene.signal_units)
        record = loop.run(step * (points.size - 1))
        found = np.empty(times.shape)
        for n, name in enumerate(self.data.columns):
            if name in self._read:
                found[:, n] = self._column(name, np.searchsorted(stops, ticks[:, n]))
            else:
                found[:, n] = np.interp(times[:, n], record.time, record[name])
        return found

    def take_steps(
        self, lengths: Array, inputs: Sequence[str], given: Array, outputs: Sequence[str], rows: Array
    ) -> None:
        """Take steps by way of the stops within them: see Plant."""
        points = self._points[self._taken : self._taken + lengths.size + 1]
        self._taken += lengths.size
        part, names = slice(points[0], points[-1] + 1), (*outputs, *self._read)
        stops, found = self._stops[part], np.empty((points[-1] + 1 - points[0], len(names)))
        held = np.repeat(given, np.diff(points), axis=0)
        super().take_steps(np.diff(stops), inputs, held, names, found)
        rows[:] = found[points - points[0], : len(outputs)]
        self._rows[part] = found[:, len(outputs) :]

    def _column(self, name: str, at: NDArray[np.int64]) -> Array:
        """Values at some stops; means and peaks are those since the one before, the first since the start."""
        values = self._rows[:, self._read.index(name)]
        ends, order = np.unique(at, return_inverse=True)
        found = values[ends]
        if name.endswith(MEAN):
            works = np.cumsum(values * np.diff(self._stops, prepend=0.0))[ends]
            lengths = np.diff(self._stops[ends], prepend=0.0)
            # at the start it is that of no step
            np.divide(np.diff(works, prepend=0.0), lengths, out=found, where=lengths > 0.0)
        elif name.endswith(PEAK):
            found = np.maximum.reduceat(values[: ends[-1] + 1], np.append(0, ends[:-1] + 1))
        return found[order]
