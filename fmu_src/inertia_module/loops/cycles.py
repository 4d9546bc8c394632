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
class Cycle:
    """A driving cycle: vehicle speed, linear between breakpoints.

    Attributes:
        name: as scenes call it. operations: one after the other, from standstill: how long each takes, s, and
            the speed that is reached at its end, km/h as published.
    """

    name: str
    operations: tuple[tuple[float, float], ...]

    @property
    def time(self) -> NDArray[np.float64]:
        """Breakpoints, s, one more than operations."""
        return np.concatenate([[0.0], np.cumsum([duration for duration, _ in self.operations])])

    @property
    def speed(self) -> NDArray[np.float64]:
        """Speeds at the breakpoints, m/s."""
        published = [0.0, *(speed for _, speed in self.operations)]
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


# UN Regulation No. 83 (Directive 70/220/EEC), type I test, part one, table 1. An inertia module has no gears:
# the gear-changing operations are driven at constant speed, and the clutch that is to be disengaged is the
# output freewheel, which opens by itself. The way is 1.018 km so; the regulation gives 1.013 km and a mean
# speed of 19 km/h (18.8 km/h here).
ELEMENTARY_URBAN_CYCLE = Cycle(
    name="ECE R15",
    operations=(
        # idling, acceleration, steady speed, deceleration, and the last of it with the clutch disengaged
        *((11.0, 0.0), (4.0, 15.0), (8.0, 15.0), (2.0, 10.0), (3.0, 0.0)),
        # with a change of gears on the way up
        *((21.0, 0.0), (5.0, 15.0), (2.0, 15.0), (5.0, 32.0), (24.0, 32.0), (8.0, 10.0), (3.0, 0.0)),
        # with two, and one on the way down from a second steady speed; idling at the end
        *((21.0, 0.0), (5.0, 15.0), (2.0, 15.0), (9.0, 35.0), (2.0, 35.0), (8.0, 50.0), (12.0, 50.0)),
        *((8.0, 35.0), (13.0, 35.0), (2.0, 35.0), (7.0, 10.0), (3.0, 0.0), (7.0, 0.0)),
    ),
)

CYCLES = {ELEMENTARY_URBAN_CYCLE.name: ELEMENTARY_URBAN_CYCLE}
