"""Measurements: columns over time with their noise, and a scene read at the same times, as sensors show it.

A measurement is columns over time that a scene computes, in SI, with their noise where it is known. The scene
is run and read at the times of a measurement, which need not be communication points. The loop keeps its
communication step, which is part of what is simulated: controllers sample at it. The FMU stops within a step
at each time and is read there, so that nothing is interpolated that jumps with the freewheels. A mean or peak
over a step is that since the time before, the first since the start.
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

from ..common.errors import Refused, did_you_mean
from ..common.units import factor_between
from ..contract.variables import BY_NAME, COMPUTED
from ..harness.fmu import run
from ..harness.simulate import Plant, Result
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
# times as near to a communication point, of a step, are taken there
NEAR = 1e-6
# what a sensor may have: measured is gain times computed, which is shift earlier, and offset
OFFSET, GAIN, SHIFT = "offset", "gain", "shift"
# of the clock, which all columns share
CLOCK = f"{SHIFT}.time"
# of the time measured
MOST_LATE = 0.1
# so near, of the factor, a gain is that of another unit
NEAR_UNIT = 0.02
# that columns come in, beside those of SI
UNITS = ("rpm", "deg/s", "rev/s", "km/h", "deg", "rev", "mm", "kN", "kNm", "kJ", "kW")
# runs whose values are kept: offsets and gains need none of their own
KEPT = 8

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Measurement:
    """Measurement of a rig.

    Attributes:
        table: over time, s, the columns that are compared, SI. headings: the unit that each came in.
        noise: standard deviations by column, for those whose noise is known, shape (rows,).
        counted: whether a value is compared, shape (rows, columns): the first of a mean over steps is not,
            since when it is a mean is not known.
    """

    table: Result
    headings: dict[str, str]
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

    @property
    def estimated(self) -> NDArray[np.bool_]:
        """Columns whose noise is found from their residuals, shape (columns,)."""
        return np.array([name not in self.noise for name in self.columns])

    @property
    def number(self) -> int:
        """How many values are compared."""
        return int(self.counted.sum())

    @functools.cached_property
    def sensors(self) -> dict[str, Free]:
        """Free keys of what its sensors may have, by name; see OFFSET and CLOCK."""
        times = self.table.time
        row = float(np.median(np.diff(times))) if times.size > 1 else 1e-3
        late = max(MOST_LATE * float(np.ptp(times)), row)

        def sensor(name: str, unit: str, usual: float, size: float, most: float = math.inf) -> Free:
            return Free(name, unit, usual - most, usual + most, start=usual, origin=usual, span=size)

        found = [sensor(CLOCK, "s", 0.0, row, late)]
        for name in self.columns:
            found += [
                sensor(
                    f"{OFFSET}.{name}", self.table.units[name], 0.0, float(np.std(self.table[name])) or 1.0
                ),
                sensor(f"{GAIN}.{name}", "", 1.0, 1.0),
                sensor(f"{SHIFT}.{name}", "s", 0.0, row, late),
            ]
        return {one.name: one for one in found}

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
    headings = {name: table.units.get(name, "") or kept[name] for name in given}
    return Measurement(si.without({f"{name}{NOISE}" for name in noisy}), headings, noise, counted)


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


class Rig(Observer):
    """A scene as the sensors of a measurement see it.

    Args:
        scene: what stands in the rig. data: the measurement. fmu_path: the FMU of the module.

    Attributes:
        runs: of the scene so far. refused: why the scene refused values the last time, or "".
    """

    def __init__(self, scene: Scene, data: Measurement, fmu_path: Path) -> None:
        super().__init__(fmu_path, data.columns, data.table.time)
        self.scene, self.data, self.runs, self.refused = scene, data, 0, ""
        self._observed = functools.lru_cache(KEPT)(self._observe)

    def _observe(self, point: tuple[tuple[str, float], ...], shifts: tuple[float, ...]) -> Array:
        """Columns that the scene computes with keys, earlier by shifts, s; NaN where it refuses them."""
        self.runs += 1
        try:
            return self(self.scene.with_keys(dict(point)), shifts)
        except Refused as error:
            self.refused = str(error)
            return np.full(self.data.values.shape, np.nan)

    def computed(self, values: Mapping[str, float]) -> Array:
        """Columns for values by key, SI, shape (rows, columns); NaN where the scene refuses them."""

        def of_sensor(kind: str, usual: float) -> list[float]:
            return [values.get(f"{kind}.{name}", usual) for name in self.data.columns]

        point = tuple((name, value) for name, value in values.items() if name not in self.data.sensors)
        late = values.get(CLOCK, 0.0)
        shifts = tuple(late + shift for shift in of_sensor(SHIFT, 0.0))
        return self._observed(point, shifts) * of_sensor(GAIN, 1.0) + of_sensor(OFFSET, 0.0)
