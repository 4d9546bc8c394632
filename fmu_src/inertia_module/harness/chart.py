"""Torque converter chart of a mechanism: what it makes of the input torque over the speed ratio.

The chart of a hydrodynamic converter plots torque ratio, efficiency and capacity over the speed ratio
(SAE J643). Here everything goes with the square of the input speed as well, so one chart holds for all
speeds. The mechanism is ideal: the efficiency is 1 and the torque ratio one over the speed ratio; at
stall it passes torque and takes no power, so torque ratio and capacity factor are given above it only
(converter_table). Mechanisms differ in the torque they pass.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..kernel import codes
from ..kernel.averaged import rates as average_rates
from ..memory.instances import Module
from .results import TableError, read_columns, write_columns

Array = NDArray[np.float64]

# points between the first and the last ratio of the map, besides its knots
POINTS = 200

_UNITS = {
    "output_torque": "N.m.s2",
    "input_torque": "N.m.s2",
    "ripple": "N.m.s2",
    "peak": "N.m.s2",
    "lock_up_torque": "N.m.s2",
}
# the numbers of summary that are no torques
_RATIOS = ("least_torque_ratio", "end_ratio", "stall_peak_over_mean")


@dataclass(frozen=True)
class TorqueConverterChart:
    """Steady mean torques over the speed ratio; all torques over omega1 squared. Arrays of shape (n,).

    Attributes:
        speed_ratio: output over input speed, magnitudes, rising from 0.
        output_torque, input_torque: mean torques, N m s^2.
        efficiency: output over input power, 1.
        link2_ratio: mean speed of link 2 over the input speed.
        ripple: RMS of the output torque about its mean, N m s^2. peak: its largest value.
        lock_up_torque: what lock-up at ratio 1 can hold, N m s^2, the same in all rows;
            0 where it is not reached.
    """

    speed_ratio: Array
    output_torque: Array
    input_torque: Array
    efficiency: Array
    link2_ratio: Array
    ripple: Array
    peak: Array
    lock_up_torque: Array

    @property
    def stall_torque(self) -> float:
        """Mean output torque at rest over omega1 squared, N m s^2."""
        return float(self.output_torque[0])

    @property
    def end_ratio(self) -> float:
        """Speed ratio from which on no torque is passed, 1 with lock-up."""
        return float(self.speed_ratio[-1])

    def summary(self, omega1: float | None = None) -> dict[str, float]:
        """The numbers to compare mechanisms by.

        Args:
            omega1: speed of the input for the torques, rad/s; without it they are over omega1 squared.
        """
        numbers = {
            "stall_torque": self.stall_torque,
            "least_torque": float(self.output_torque.min()),
            "least_torque_ratio": float(self.speed_ratio[np.argmin(self.output_torque)]),
            "end_ratio": self.end_ratio,
            "lock_up_torque": float(self.lock_up_torque[0]),
            "stall_peak_over_mean": float(self.peak[0] / self.stall_torque) if self.stall_torque else 0.0,
        }
        square = 1.0 if omega1 is None else omega1 * omega1
        return {name: value if name in _RATIOS else square * value for name, value in numbers.items()}

    def units(self, omega1: float | None = None) -> dict[str, str]:
        """Units of the numbers of summary, "" for ratios."""
        torque = "N.m.s2" if omega1 is None else "N.m"
        return {name: "" if name in _RATIOS else torque for name in self.summary()}

    def converter_table(self, omega1: float) -> dict[str, Array]:
        """What models of torque converters ask for, at an input speed, by heading; shape (m,), all finite.

        The rows are those in which power is taken: without stall, and without an end at which no torque is
        passed. The capacity factor is K = omega1 / sqrt(input torque).

        Args:
            omega1: speed of the input, rad/s, not 0.
        """
        taken = self.input_torque > 0.0
        given, passed = self.input_torque[taken], self.output_torque[taken]
        return {
            "speed_ratio": self.speed_ratio[taken],
            "torque_ratio": passed / given,
            "capacity_factor [rad/s/(N.m)^0.5]": 1.0 / np.sqrt(given),
            "output_torque [N.m]": omega1 * omega1 * passed,
            "input_torque [N.m]": omega1 * omega1 * given,
        }

    def save(self, path: Path | str) -> Path:
        """Write as CSV, whole or not at all; the numbers read back are the same doubles."""
        columns = {field.name: getattr(self, field.name) for field in fields(self)}
        return write_columns(
            Path(path),
            {f"{name} [{_UNITS[name]}]" if name in _UNITS else name: v for name, v in columns.items()},
        )

    @classmethod
    def load(cls, path: Path | str) -> TorqueConverterChart:
        """Read what save has written.

        Raises:
            TableError: the file is missing, or is not such a chart.
        """
        columns, _ = read_columns(path)
        wanted = [field.name for field in fields(cls)]
        if list(columns) != wanted:
            raise TableError(f"{path} must be a chart with the columns {', '.join(wanted)}")
        return cls(*map(np.array, columns.values()))


def torque_converter_chart(
    parameters: Mapping[str, float | str], backward: bool = False, kernel: str = "auto"
) -> TorqueConverterChart:
    """The chart of a mechanism.

    Args:
        parameters: of the module by name, those that differ from the defaults; as in Module.set.
        backward: for omega1 < 0, where the drive turns the other way; the torque is another.
        kernel: as in Module.

    Raises:
        Refused: the parameters cannot be, or there is no mean torque (a freewheel is missing).
    """
    # torques at given speeds, whatever drives the module
    given = {"fidelity": float(codes.AVERAGED), "drive": float(codes.DRIVE_SPEED)}
    module = Module(kernel).start(**{**parameters, **given})
    d, x = module.derived, module.state
    side = d.backward if backward else d.forward
    knots = [side.knots[n].ratio for n in range(int(side.count))]
    ratios = np.unique(np.concatenate([knots, np.linspace(0.0, knots[-1], POINTS + 1)]))
    torque, link2, ripple, peak = np.zeros((4, ratios.size))
    for n, ratio in enumerate(ratios):
        x.omega3 = ratio
        found = average_rates.look_up(side, x, 1.0, ratio)  # type: ignore[no-untyped-call]
        torque[n], link2[n] = found[0], found[2]
        ripple[n], peak[n] = average_rates.ripple_at(side, x, side.direction)  # type: ignore[no-untyped-call]
    lock = d.map_lock if side.locks else 0.0
    one = np.ones(ratios.size)
    return TorqueConverterChart(ratios, torque, ratios * torque, one, link2, ripple, peak, lock * one)
