"""Measurements: columns over time that a scene computes, in SI, with their noise where it is known.

The scene is run and read at the times of a measurement, which need not be communication points. The loop
keeps its communication step, which is part of what is simulated: controllers sample at it. The FMU stops
within a step at each time and is read there, so that nothing is interpolated that jumps with the freewheels.
A mean or peak over a step is that since the time before, the first since the start.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.errors import Refused, did_you_mean
from ..contract.variables import BY_NAME, COMPUTED
from ..harness.fmu import Closing
from ..harness.simulate import Plant, Result
from ..loops import ClosedLoop
from ..loops.closed_loop import PLANT_INPUTS, SIGNAL_UNITS
from ..scene import Scene
from ..scene.run import SceneRunner

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

    Attributes:
        rows: values of names at the times reached.
    """

    def __init__(self, plant: Plant, names: Sequence[str], times: Array, near: float) -> None:
        self._plant, self._names, self._times, self._near = plant, tuple(names), times, near
        self._means = np.array([name.endswith(MEAN) for name in names], dtype=bool)
        self._peaks = np.array([name.endswith(PEAK) for name in names], dtype=bool)
        self._over_steps = bool((self._means | self._peaks).any())
        self._sums, self._largest = np.zeros(len(names)), np.zeros(len(names))
        self._now, self._since = 0.0, 0.0
        self.rows: list[Array] = []
        self._keep_until(near)

    def set(self, **values: float) -> None:
        """Set inputs by name."""
        self._plant.set(**values)

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values by name."""
        return self._plant.read(names)

    def advance(self, step: float) -> None:
        """Advance by a communication step, s, by way of the times within it."""
        end = self._now + step
        while self._next < end - self._near:
            self._go(self._next)
            self._keep_until(self._now)
        self._go(end)
        self._keep_until(end + self._near)

    @property
    def _next(self) -> float:
        return float(self._times[len(self.rows)]) if len(self.rows) < self._times.size else math.inf

    def _go(self, time: float) -> None:
        length = time - self._now
        self._plant.advance(length)
        self._now = time
        if self._over_steps:
            values = np.array(self._plant.read(self._names))
            self._sums += length * values
            self._largest = np.maximum(self._largest, values)

    def _keep_until(self, time: float) -> None:
        while self._next <= time:
            values = np.array(self._plant.read(self._names))
            if self._over_steps and self._now > self._since:
                means = self._sums / (self._now - self._since)
                values = np.where(self._means, means, np.where(self._peaks, self._largest, values))
            self.rows.append(values)
            self._since, self._sums, self._largest = self._now, 0.0 * self._sums, 0.0 * self._largest


class Observer(Closing):
    """Runs scenes that differ in numbers and gives their signals at the times of a measurement.

    Args:
        fmu_path: the FMU of the module. names: of its variables and of signals of the loop; the latter are
            known at the communication points and taken linear in between. times: s, rising, from 0.

    Raises:
        FmuError: the FMU cannot be loaded.
    """

    def __init__(self, fmu_path: Path | str, names: Sequence[str], times: Array) -> None:
        self._runner, self._names, self._times = SceneRunner(fmu_path), list(names), times

    def __call__(self, scene: Scene) -> Array:
        """Values at the times, shape (times, names).

        Raises:
            FmuError: the FMU refuses a value or a step.
            Refused: a time is within a step over which the speed of link 1 is extrapolated.
        """
        step = scene.run.communication_step
        off = np.abs(self._times / step - np.round(self._times / step)) > NEAR
        if off.any() and scene.parameters().get("input_hold"):
            raise Refused(
                "with mechanism.input_hold = 'linear' time must be a whole number of run.communication_step ="
                f" {step:g} s, is {self._times[off][0]:g} s"
            )
        signals = scene.surroundings.output_labels
        read = [name for name in self._names if name not in signals]
        plant = Stopped(self._runner.started(scene), read, self._times, NEAR * step)
        loop = ClosedLoop(plant, scene.surroundings, (), scene.signal_units)
        record = loop.run(step * max(math.ceil(self._times[-1] / step - NEAR), 1))
        values = dict(zip(read, np.array(plant.rows).T, strict=True))
        for name in set(self._names).intersection(signals):
            values[name] = np.interp(self._times, record.time, record[name])
        return np.column_stack([values[name] for name in self._names])

    def close(self) -> None:
        """Free the instance."""
        self._runner.close()
