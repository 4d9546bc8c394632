"""Driving cycles of regulations: vehicle speed over time, and the tolerance of the driver."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmi.results import read_columns

KILOMETRE_PER_HOUR = 1.0 / 3.6
MILE_PER_HOUR = 0.44704

# UN Regulation No. 83 (Annex 4a), UN GTR No. 15 (Annex 6) and 40 CFR 86.115 have the same rule. The speed may
# differ by two units of the schedule from its speeds within one second before and after.
TOLERANCE_UNITS = 2.0
TIME_TOLERANCE = 1.0  # s

SCHEDULES = Path(__file__).with_name("schedules")


@dataclass(frozen=True, eq=False)
class Cycle:
    """Driving cycle: vehicle speed over time, linear between breakpoints and constant beyond them.

    Attributes:
        name: Name in messages and figures.
        time: Breakpoints, s, shape (n,), in ascending order; two equal breakpoints are a step.
        speed: Speed at the breakpoints, m/s, shape (n,).
        speed_tolerance: Allowed deviation of the speed, m/s.
        source: Regulation that publishes the values.
    """

    name: str
    time: NDArray[np.float64]
    speed: NDArray[np.float64]
    speed_tolerance: float = TOLERANCE_UNITS * KILOMETRE_PER_HOUR
    source: str = ""

    @property
    def duration(self) -> float:
        """Return the end of the cycle, s."""
        return float(self.time[-1])

    def speed_at(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the speed at times.

        Args:
            time: Times, s, any shape.

        Returns:
            Speed, m/s, of the same shape.
        """
        return np.interp(np.asarray(time, dtype=np.float64), self.time, self.speed)

    def tolerance_band(self, time: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the minimum and maximum speed within the tolerance.

        The extremes of a piecewise linear function are at the ends of the time window or at breakpoints
        within it.

        Args:
            time: Times, s, shape (n,).

        Returns:
            Minimum and maximum, m/s, shape (n,) each.
        """
        times = np.asarray(time, dtype=np.float64)
        begin, end = times - TIME_TOLERANCE, times + TIME_TOLERANCE
        ends = self.speed_at(begin), self.speed_at(end)
        first, last = self.time.searchsorted(begin, "left"), self.time.searchsorted(end, "right")
        # reduceat evaluates half-open ranges [first, last). Every second result is between two windows.
        pairs, values = np.column_stack([first, last]).ravel(), np.append(self.speed, self.speed[-1])
        is_empty = first == last
        lowest, highest = (
            extreme(extreme(*ends), np.where(is_empty, ends[0], extreme.reduceat(values, pairs)[::2]))
            for extreme in (np.minimum, np.maximum)
        )
        return np.maximum(lowest - self.speed_tolerance, 0.0), highest + self.speed_tolerance


def read_schedule(name: str, file: str, source: str) -> Cycle:
    """Read a published cycle.

    Args:
        name: Name of the cycle in scenes.
        file: CSV file in SCHEDULES with the published columns time [s] and speed [km/h] or [mph].
        source: Regulation that publishes the values.
    """
    columns, units = read_columns(SCHEDULES / file)
    unit = {"km/h": KILOMETRE_PER_HOUR, "mph": MILE_PER_HOUR}[units["speed"]]
    speed = np.array(columns["speed"]) * unit
    return Cycle(name, np.array(columns["time"]), speed, TOLERANCE_UNITS * unit, source)


# ECE R15 and NEDC contain the gear changes at constant speed that their tables prescribe for manual
# gearboxes. An inertia module has no gears, and its output freewheel opens when the tables disengage the
# clutch. ECE R15 is therefore 1.018 km long; the regulation states 1.013 km and a mean speed of 19 km/h.
ELEMENTARY_URBAN_CYCLE = read_schedule(
    "ECE R15", "ece_r15.csv", "UN Regulation No. 83, Annex 4a, Table 1 (elementary urban cycle)"
)
NEDC = read_schedule(
    "NEDC", "nedc.csv", "UN Regulation No. 83, Annex 4a, Tables 1 (four times) and 2 (extra-urban cycle)"
)
WLTC_3B = read_schedule(
    "WLTC 3b",
    "wltc_3b.csv",
    "UN GTR No. 15 and UN Regulation No. 154, class 3b: Low3, Medium3b, High3b, Extra High3",
)
FTP_75 = read_schedule(
    "FTP-75",
    "ftp_75.csv",
    "40 CFR Part 86, Appendix I(a): UDDS, then its first 505 s, without the stop of 600 s in between",
)

CYCLES = {cycle.name: cycle for cycle in (ELEMENTARY_URBAN_CYCLE, NEDC, WLTC_3B, FTP_75)}
