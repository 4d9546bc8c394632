"""Measurements: columns over time that a scene computes, in SI, with their noise where it is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.errors import Refused, did_you_mean
from ..contract.variables import BY_NAME
from ..harness.simulate import Result
from ..loops.closed_loop import PLANT_INPUTS, SIGNAL_UNITS
from ..scene import Scene
from .observed import MEAN, READABLE

# a column of this ending has the standard deviation of the noise of another, row by row
NOISE = "_noise"

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
        """Shape (rows, columns)."""
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
    _check_times(table.time, scene.run.stop_time)
    kept = [*given, *(f"{name}{NOISE}" for name in given if f"{name}{NOISE}" in noises)]
    units = {name: _unit(name.removesuffix(NOISE), scene) for name in kept}
    si = Result({"time": table.time, **{name: table[name] for name in kept}}, table.units).converted(units)
    for name in kept[len(given) :]:
        if si[name].min() <= 0.0:
            raise Refused(f"{name} must be above 0, is {si[name].min():g}")
    counted = np.ones((len(table), len(given)), dtype=bool)
    counted[0, [name.endswith(MEAN) for name in given]] = False
    noise = {name.removesuffix(NOISE): si[name] for name in kept[len(given) :]}
    return Measurement(si.without(set(kept[len(given) :])), noise, counted)


def _unit(name: str, scene: Scene) -> str:
    units = {**SIGNAL_UNITS, **scene.signal_units}
    return (BY_NAME[name].unit if name in BY_NAME else units.get(name, "")) or "1"


def _check_times(times: Array, stop_time: float) -> None:
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
