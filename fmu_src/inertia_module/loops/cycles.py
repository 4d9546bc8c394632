"""Driving cycles: speed over time as regulations prescribe it, and how closely it has to be followed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

KILOMETRE_PER_HOUR = 1.0 / 3.6

# UN Regulation No. 83, annex on the type I test: what the driver may deviate from the cycle
SPEED_TOLERANCE = 2.0 * KILOMETRE_PER_HOUR
TIME_TOLERANCE = 1.0


@dataclass(frozen=True)
class Operation:
    """One operation of a driving cycle; the speed changes linearly to the one reached at its end.

    Attributes:
        duration: s. speed: reached at the end, km/h as published. kind: in the words of the regulation.
    """

    duration: float
    speed: float
    kind: str


@dataclass(frozen=True)
class Cycle:
    """A driving cycle: vehicle speed, linear between breakpoints.

    Attributes:
        name: as scenes call it. operations: one after the other, from standstill. source: where published.
    """

    name: str
    operations: tuple[Operation, ...]
    source: str

    @property
    def time(self) -> NDArray[np.float64]:
        """Breakpoints, s, one more than operations."""
        return np.concatenate([[0.0], np.cumsum([operation.duration for operation in self.operations])])

    @property
    def speed(self) -> NDArray[np.float64]:
        """Speeds at the breakpoints, m/s."""
        published = [0.0, *(operation.speed for operation in self.operations)]
        return np.array(published) * KILOMETRE_PER_HOUR

    @property
    def duration(self) -> float:
        """Length of the cycle, s."""
        return float(self.time[-1])

    def speed_at(self, time: ArrayLike) -> NDArray[np.float64]:
        """Speed at any times, m/s; after the end the last speed is held."""
        return np.interp(np.asarray(time, dtype=np.float64), self.time, self.speed)

    def tolerance_band(self, time: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Least and greatest speed a driver may have.

        The speed tolerance is added to the least and greatest speed of the cycle within the time
        tolerance; as the cycle is linear in pieces, these are at the ends of the window or at breakpoints.

        Args:
            time: s, shape (n,).

        Returns:
            (lower, upper), m/s, each of shape (n,).
        """
        times = np.asarray(time, dtype=np.float64)
        ends = [self.speed_at(times - TIME_TOLERANCE), self.speed_at(times + TIME_TOLERANCE)]
        # rows of times and columns of breakpoints; those out of the window count as one of its ends
        inside = np.abs(times[:, None] - self.time) <= TIME_TOLERANCE
        speeds = np.column_stack([np.where(inside, self.speed, ends[0][:, None]), ends[1]])
        return np.maximum(speeds.min(axis=1) - SPEED_TOLERANCE, 0.0), speeds.max(axis=1) + SPEED_TOLERANCE


_IDLING = "idling"
_ACCELERATION = "acceleration"
_STEADY = "steady speed"
_GEAR_CHANGE = "gear-changing"
_DECELERATION = "deceleration"
_CLUTCH_OPEN = "deceleration, clutch disengaged"

# An inertia module has no gears: the gear-changing operations are driven at constant speed, and the
# clutch that is to be disengaged is the output freewheel, which opens by itself. The way is 1.018 km
# so; the regulation gives 1.013 km and a mean speed of 19 km/h (18.8 km/h here).
ELEMENTARY_URBAN_CYCLE = Cycle(
    name="ECE R15",
    source="UN Regulation No. 83 (Directive 70/220/EEC), type I test, part one, table 1",
    operations=(
        Operation(11.0, 0.0, _IDLING),
        Operation(4.0, 15.0, _ACCELERATION),
        Operation(8.0, 15.0, _STEADY),
        Operation(2.0, 10.0, _DECELERATION),
        Operation(3.0, 0.0, _CLUTCH_OPEN),
        Operation(21.0, 0.0, _IDLING),
        Operation(5.0, 15.0, _ACCELERATION),
        Operation(2.0, 15.0, _GEAR_CHANGE),
        Operation(5.0, 32.0, _ACCELERATION),
        Operation(24.0, 32.0, _STEADY),
        Operation(8.0, 10.0, _DECELERATION),
        Operation(3.0, 0.0, _CLUTCH_OPEN),
        Operation(21.0, 0.0, _IDLING),
        Operation(5.0, 15.0, _ACCELERATION),
        Operation(2.0, 15.0, _GEAR_CHANGE),
        Operation(9.0, 35.0, _ACCELERATION),
        Operation(2.0, 35.0, _GEAR_CHANGE),
        Operation(8.0, 50.0, _ACCELERATION),
        Operation(12.0, 50.0, _STEADY),
        Operation(8.0, 35.0, _DECELERATION),
        Operation(13.0, 35.0, _STEADY),
        Operation(2.0, 35.0, _GEAR_CHANGE),
        Operation(7.0, 10.0, _DECELERATION),
        Operation(3.0, 0.0, _CLUTCH_OPEN),
        Operation(7.0, 0.0, _IDLING),
    ),
)

CYCLES = {ELEMENTARY_URBAN_CYCLE.name: ELEMENTARY_URBAN_CYCLE}
