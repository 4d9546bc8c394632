"""The chart of a mechanism as blocks of torque converters take it: finite at stall, with a coast side.

Such a block looks up torque ratio R and capacity factor K = omega1 / sqrt(input torque) over the speed ratio
(SAE J643) and makes of them input torque = (omega1 / K)^2 and output torque = R (omega1 / K)^2. At stall a
mechanism without losses takes no power: both would be infinite. So R is limited, and the input torque to be
had from the table is then the output torque over that limit; the output torque is right everywhere.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.io import savemat

from ..common.errors import Refused
from ..common.files import write_atomically
from .chart import Array, TorqueConverterChart
from .results import write_columns
from .steady import SteadyMachine

# more than this a torque ratio is not, and the input torque not less than this share of its largest
LARGEST_TORQUE_RATIO, LEAST_SHARE = 50.0, 1e-4
# speed ratios of the coast side, over 1 or what the chart ends with above that
COAST = np.array([1.01, 1.1, 1.25, 1.5, 2.0])

_UNITS = {
    "speed_ratio": "1",
    "torque_ratio": "1",
    "capacity_factor": "rad/s/(N.m)^0.5",
    "output_torque": "N.m",
    "input_torque": "N.m",
}


@dataclass(frozen=True)
class ConverterTable:
    """A converter at an input speed; arrays of shape (n,), all finite.

    Attributes:
        omega1: speed of the input, rad/s. speed_ratio: output over input speed, rising from 0.
        torque_ratio: output over input torque, at most LARGEST_TORQUE_RATIO, negative on a braked shaft.
        capacity_factor: omega1 / sqrt(input torque), rad/s/(N m)^0.5.
        output_torque, input_torque: mean torques of the mechanism itself, N m.
    """

    omega1: float
    speed_ratio: Array
    torque_ratio: Array
    capacity_factor: Array
    output_torque: Array
    input_torque: Array

    def save(self, path: Path) -> Path:
        """Write as CSV, whole or not at all."""
        units = {name: unit for name, unit in _UNITS.items() if unit != "1"}
        return write_columns(path, {name: getattr(self, name) for name in _UNITS}, units)

    def save_mat(self, path: Path) -> Path:
        """Write as MAT file (version 5), whole or not at all: a struct converter, with units."""
        fields = {name: getattr(self, name) for name in _UNITS}
        stream = io.BytesIO()
        content = {"converter": {"omega1": self.omega1, **fields, "units": {"omega1": "rad/s", **_UNITS}}}
        savemat(stream, content, oned_as="column")
        write_atomically(path, stream.getvalue())
        return path


def converter_table(
    parameters: Mapping[str, float | str], chart: TorqueConverterChart, omega1: float, kernel: str = "auto"
) -> ConverterTable:
    """The converter table of a mechanism.

    Args:
        parameters, kernel: as in torque_converter_chart. chart: of these at this speed.
        omega1: speed of the input, rad/s, not 0.

    Raises:
        Refused: no torque is passed at any ratio.
    """
    machine = SteadyMachine(parameters, kernel)
    ratios = COAST * max(1.0, chart.end_ratio)
    coast = np.zeros((ratios.size, 2))
    if not machine.ideal:
        coast = np.array([machine.coasting(omega1, ratio) for ratio in ratios])
    square = omega1 * omega1
    passed = np.concatenate([square * chart.output_torque, coast[:, 0]])
    taken = np.concatenate([square * chart.input_torque, coast[:, 1]])
    greatest = float(taken.max())
    if not greatest > 0.0:
        raise Refused(f"a mechanism must pass torque for a converter table, passes none at {omega1:g} rad/s")
    given = np.maximum(taken, np.maximum(passed / LARGEST_TORQUE_RATIO, LEAST_SHARE * greatest))
    return ConverterTable(
        omega1,
        np.concatenate([chart.speed_ratio, ratios]),
        passed / given,
        abs(omega1) / np.sqrt(given),
        passed,
        taken,
    )
