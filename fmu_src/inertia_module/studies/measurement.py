"""Measurement: columns over time with their noise, and the readings of the same sensors in a simulated scene.

The loop keeps its communication step, because controllers sample at it. The FMU stops within a step at each
measured time. Its outputs are read there, because interpolation would smooth the jumps at the freewheels.
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
from ..common.errors import InertiaModuleError, ParameterError, must_be, unknown
from ..common.time_range import likely_cause
from ..common.units import factor_between
from ..driveline import ClosedLoop
from ..driveline.closed_loop import PLANT_INPUTS, SIGNAL_UNITS
from ..fmi.simulate import Result
from ..interface.variables import BY_NAME, COMPUTED
from ..scene import Scene
from ..scene.run import SceneRunner
from .axes import Free

# suffix of the column with the standard deviations of another column
NOISE = "_noise"
MEAN, PEAK = "_mean", "_peak"
# outputs that can be compared; torque_ripple cannot, because it does not follow from the parts of a step
READABLE = [name for name in COMPUTED if name != "torque_ripple"]
# number of ticks, the resolution of times, per communication step
TICKS = 10_000_000
# keys of a sensor: measured = gain * computed(time - shift) + offset
OFFSET, GAIN, SHIFT = "offset", "gain", "shift"
# shift of all columns
CLOCK = f"{SHIFT}.time"
# maximum shift, as a fraction of the measured time
MAX_SHIFT = 0.1
# standard deviations beyond which a statistic is not by chance
N_DEVIATIONS = 4.0
# maximum lag-1 autocorrelation of the noise of a sensor
SENSOR_AUTOCORRELATION = 0.2
# maximum relative difference between a gain and the factor of another unit
UNIT_RTOL = 0.15
# units of logger files besides SI
UNITS = ("rpm", "deg/s", "rev/s", "km/h", "deg", "rev", "mm", "kN", "kNm", "kJ", "kW")

Array = NDArray[np.float64]


def autocorrelation(residuals: Array) -> float:
    """Return the lag-1 autocorrelation about the mean; 0 if the residuals are constant."""
    centred = residuals - residuals.mean()
    return float(np.sum(centred[1:] * centred[:-1]) / np.sum(centred**2)) if np.ptp(residuals) else 0.0


@dataclass(frozen=True, eq=False)
class Measurement(ByContent):
    """Measurement of a rig.

    Attributes:
        table: compared columns over time, SI.
        headings: unit of each column in the file.
        noise: standard deviations of the columns whose noise is specified, shape (rows,) each.
        counted: True for the compared values, shape (rows, columns). The first value of a mean is not
            compared, because the start of its interval is unknown. A mean or peak over no time is not
            compared either.
        unused: columns of a file that the scene does not compute.
    """

    table: Result
    headings: dict[str, str]
    noise: dict[str, Array]
    counted: NDArray[np.bool_]
    unused: tuple[str, ...] = ()

    @property
    def columns(self) -> list[str]:
        """Names of the compared columns."""
        return self.table.names[1:]

    @property
    def values(self) -> Array:
        """Measured values, shape (rows, columns)."""
        return np.column_stack([self.table[name] for name in self.columns])

    @property
    def estimated(self) -> NDArray[np.bool_]:
        """True for the columns whose noise is estimated from their residuals, shape (columns,)."""
        return np.array([name not in self.noise for name in self.columns])

    @property
    def number(self) -> int:
        """Number of compared values."""
        return int(self.counted.sum())

    @property
    def max_autocorrelation(self) -> float:
        """Maximum lag-1 autocorrelation of residuals that are not systematic."""
        return max(SENSOR_AUTOCORRELATION, N_DEVIATIONS / math.sqrt(len(self.table)))

    @functools.cached_property
    def sensors(self) -> dict[str, Free]:
        """Keys of offset, gain and shift of each sensor, and of the clock, by name."""
        times = self.table.time
        lengths = np.diff(np.unique(times))
        row = float(np.median(lengths)) if lengths.size else 1e-3
        max_shift = max(MAX_SHIFT * float(np.ptp(times)), row)
        rows = [(CLOCK, "s", 0.0, row, max_shift)]
        for name in self.columns:
            size = float(np.std(self.table[name])) or 1.0
            rows.append((f"{OFFSET}.{name}", self.table.units[name], 0.0, size, math.inf))
            rows.append((f"{GAIN}.{name}", "", 1.0, 1.0, math.inf))
            rows.append((f"{SHIFT}.{name}", "s", 0.0, row, max_shift))
        return {
            name: Free(name, unit, ideal - reach, ideal + reach, start=ideal, nominal=ideal, size=size)
            for name, unit, ideal, size, reach in rows
        }

    def unit_hint(self, column: str, gain: float) -> str:
        """Return a clause if a gain, measured over computed values, suggests another unit, else ""."""
        heading, ratios = self.headings[column], dict[str, float]()
        for other in (self.table.units[column], *UNITS):
            with contextlib.suppress(ValueError):  # unit of another quantity
                ratios[other] = factor_between(heading, other)
        errors = [(abs(gain / ratio - 1.0), other) for other, ratio in ratios.items() if ratio != 1.0]
        error, unit = min(errors, default=(UNIT_RTOL, ""))
        return f"its numbers are in {unit}, not in {heading}" if error < UNIT_RTOL else ""


def measurement(measured: Result | Path | str, scene: Scene, columns: Sequence[str] = ()) -> Measurement:
    """Read and check a measurement.

    Two rows of the same time are two readings at that time. A column of a file that the scene does not
    compute may have any name, unit and content.

    Args:
        measured: table, or CSV file with a heading row and units in brackets if they are not SI.
        scene: scene that computes the columns.
        columns: names of the compared columns; by default all except the inputs of the module.

    Raises:
        TableError: the file is no table over time, or a unit is of another quantity.
        ParameterError: the scene does not compute a column, the time is outside the run, or a standard
            deviation is not above 0.
    """
    table = measured if isinstance(measured, Result) else Result.from_csv(measured)
    compared, unused = _compared(table, scene, columns)
    noisy = [name for name in compared if f"{name}{NOISE}" in _names(table)]
    times, stop_time = table.time, scene.run.stop_time
    if times[0] < 0.0 or times[-1] > stop_time * (1.0 + 1e-9):
        run = f"within the run of the scene, 0 to {stop_time:g} s"
        span = f"{times[0]:.12g} to {times[-1]:.12g} s"
        raise ParameterError(f"{must_be('time', run, span)}: {likely_cause(float(times[0]))}")
    units = SIGNAL_UNITS | scene.signal_units | {name: variable.unit for name, variable in BY_NAME.items()}
    si_units = {name: units.get(name, "") or "1" for name in compared}
    si_units |= {f"{name}{NOISE}": si_units[name] for name in noisy}
    columns_read = {"time": times, **{name: table[name] for name in si_units}}
    si = Result(columns_read, table.units, table.origin).converted(si_units)
    noise = {name: si[f"{name}{NOISE}"] for name in noisy}
    for name, deviation in noise.items():
        if deviation.min() <= 0.0:
            row = int(np.argmin(deviation))
            place = f"{si.origin.path} line {si.origin.lines[row]}: " if si.origin else ""
            raise ParameterError(must_be(f"{place}{name}{NOISE}", "above 0", f"{deviation[row]:g}"))
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
    computed_names = [*READABLE, *(name for name in scene.surroundings.output_labels if name not in READABLE)]
    names = _names(table)
    values = [name for name in names if not (name.endswith(NOISE) or name in PLANT_INPUTS)]
    compared = [*columns] or [name for name in values if name in computed_names or table.origin is None]
    for name in compared if compared else values:
        if name not in computed_names:
            raise ParameterError(unknown("output of the scene", name, computed_names))
    if not compared:
        raise ParameterError(must_be("at least one column", "computed by the scene", ", ".join(table.names)))
    for name in names:
        value = name.removesuffix(NOISE)
        if value not in (name, *names) and (table.origin is None or value in computed_names):
            raise ParameterError(f"column {name} requires a column {value}")
    return compared, [name for name in values if name not in computed_names]


class Rig(SceneRunner):
    """Runs of a scene whose outputs are read at the times of a measurement, also within communication steps.

    Attributes:
        scene: scene without values of free keys.
        data: the measurement.
        runs: number of runs so far.
        rejection: reason of the last rejected run, or "".
    """

    def __init__(self, scene: Scene, data: Measurement, fmu: Path) -> None:
        super().__init__(fmu)
        self.scene, self.data, self.runs, self.rejection = scene, data, 0, ""
        signals = scene.surroundings.output_labels
        self._read = tuple(name for name in data.columns if name not in signals)

    def computed(self, values: Mapping[str, float]) -> Array:
        """Return the readings of the sensors, SI, shape (rows, columns); NaN if the run is rejected.

        Args:
            values: values of keys of the scene and of sensors, SI, by name.
        """

        def of_sensors(kind: str, ideal: float) -> Array:
            return np.array([values.get(f"{kind}.{name}", ideal) for name in self.data.columns])

        keys = {name: value for name, value in values.items() if name not in self.data.sensors}
        shifts = of_sensors(SHIFT, 0.0) + values.get(CLOCK, 0.0)
        times = np.maximum(self.data.table.time[:, None] - shifts, 0.0)
        self.runs += 1
        try:
            ideal = self._columns(self.scene.with_keys(keys), times)
        except InertiaModuleError as error:
            self.rejection = str(error)
            return np.full(times.shape, np.nan)
        return of_sensors(GAIN, 1.0) * ideal + of_sensors(OFFSET, 0.0)

    def _columns(self, scene: Scene, times: Array) -> Array:
        """Return the columns of a scene, each at its times, s, shape (rows, columns)."""
        step = scene.run.communication_step
        ticks = np.rint(times * (TICKS / step)).astype(np.int64)
        is_within_step = ticks % TICKS != 0
        if is_within_step.any() and scene.parameters().get("input_hold"):
            allowed = f"a multiple of run.communication_step = {step:g} s"
            time = f"{times[is_within_step][0]:g} s"
            raise ParameterError(must_be("with mechanism.input_hold = 'linear' each time", allowed, time))
        points = TICKS * np.arange(max(-(-int(ticks.max()) // TICKS), 1) + 1)
        stops = np.union1d(ticks, points)
        self._stops, self._points, self._steps_taken = (
            stops * (step / TICKS),
            np.searchsorted(stops, points),
            0,
        )
        self._rows = np.empty((stops.size, len(self._read)))
        loop = ClosedLoop(self.started(scene), scene.surroundings, (), scene.signal_units)
        record = loop.run(step * (points.size - 1))
        columns = np.empty(times.shape)
        for n, name in enumerate(self.data.columns):
            if name in self._read:
                columns[:, n] = self._column(name, np.searchsorted(stops, ticks[:, n]))
            else:
                columns[:, n] = np.interp(times[:, n], record.time, record[name])
        return columns

    def take_steps(
        self, lengths: Array, inputs: Sequence[str], input_rows: Array, outputs: Sequence[str], rows: Array
    ) -> None:
        """Take communication steps that stop at each time of the measurement; for the arguments see Plant."""
        points = self._points[self._steps_taken : self._steps_taken + lengths.size + 1]
        self._steps_taken += lengths.size
        part, names = slice(points[0], points[-1] + 1), (*outputs, *self._read)
        stops, values = self._stops[part], np.empty((points[-1] + 1 - points[0], len(names)))
        constant = np.repeat(input_rows, np.diff(points), axis=0)
        super().take_steps(np.diff(stops), inputs, constant, names, values)
        rows[:] = values[points - points[0], : len(outputs)]
        self._rows[part] = values[:, len(outputs) :]

    def _column(self, name: str, at: NDArray[np.int64]) -> Array:
        """Return the values of an output at stops; a mean or peak covers the time since the previous stop."""
        values = self._rows[:, self._read.index(name)]
        ends, order = np.unique(at, return_inverse=True)
        column = values[ends]
        if name.endswith(MEAN):
            works = np.cumsum(values * np.diff(self._stops, prepend=0.0))[ends]
            lengths = np.diff(self._stops[ends], prepend=0.0)
            # a mean at the start has no interval
            np.divide(np.diff(works, prepend=0.0), lengths, out=column, where=lengths > 0.0)
        elif name.endswith(PEAK):
            column = np.maximum.reduceat(values[: ends[-1] + 1], np.append(0, ends[:-1] + 1))
        return column[order]
