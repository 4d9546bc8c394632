"""Order analysis of a scene: amplitudes of torques, speeds and forces over cycles per revolution.

The scene is run, and its record over time is resampled in equal steps of the angle of link 1 or of the pinion
shaft. A run-up then has the same lines as a steady speed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..common.deprecated import renamed_arguments
from ..common.errors import ParameterError, must_be
from ..common.terminal import Progress
from ..driveline import ClosedLoop
from ..driveline.sources import Sources
from ..fmi.simulate import Fmu, Result
from ..interface.variables import BY_NAME
from ..kernel.codes import AVERAGED, DRIVE_SPEED
from ..model import Module
from ..scene import Scene
from ..scene.run import initial_values
from .evaluation import scene_and_name
from .order_lines import ALIASED_HARMONIC, ROUNDING, Array
from .order_result import BASES, DRIVE, LINK1, Orders
from .order_spectra import POINTS_PER_CYCLE, rounding, spectra

# angle within a revolution, and number of revolutions, of link 1 and of the pinion shaft
ANGLES = ("input_angle", "input_turns", "drive_angle", "drive_turns")
# components of the force of unbalanced mass 0 on its bearing, and the accelerations that cause them
BEARING = {f"satellite_force_{axis}": f"imbalance_acceleration_{axis}" for axis in "xyz"}
# default signals
SIGNALS = (
    *("input_torque", "output_torque", "input_speed", "omega_out"),
    *("shaking_force_x", "shaking_force_y", "shaking_force_z", *BEARING),
)
# harmonics of the pulses up to the default maximum order
HARMONICS = 5.0
# maximum number of communication points of a run for orders
MAX_ROWS = 2_000_000


@renamed_arguments(fmu_path="fmu")
def orders(
    scene: Scene | Path | str,
    fmu: Path | str | None = None,
    *,
    of: str = LINK1,
    signals: Sequence[str] | None = None,
    highest: float | None = None,
    turns: float | None = None,
    begin: float | None = None,
    end: float | None = None,
    progress: Progress | None = None,
    record: Result | None = None,
) -> Orders:
    """Run a scene and analyse the orders of its signals.

    Args:
        scene: Scene, or path of its file.
        fmu: FMU of the module; None for current_fmu().
        of: Reference angle, "link1" or "drive_angle" (pinion shaft).
        signals: Names of outputs, local variables, signals of the loop, or names in BEARING; None for the
            signals in SIGNALS that are not constant.
        highest: Maximum order; None for HARMONICS harmonics of the pulses. If the communication step of the
            scene is too long for it, the module runs with shorter steps; drive, load and controller keep the
            step of the scene.
        turns: Revolutions in a window, as in spectra.
        begin: Start of the analysed interval, s; None for the first motion.
        end: End of the analysed interval, s; None for the end of the run.
        progress: Function called with the completed fraction of the run, 0 to 1.
        record: Record of the scene with these signals, input_speed and ANGLES, which is used if its steps are
            short enough; None to run the scene.

    Raises:
        SceneError: The scene is invalid, or has no signal of this name.
        ParameterError: Reasons of spectra, fidelity averaged (no pulses), an invalid interval, or a signal
            that the scene computes once per communication step.
    """
    if of not in BASES:
        raise ParameterError(must_be("of (reference angle)", " or ".join(BASES), repr(of)))
    scene, _ = scene_and_name(scene)
    if scene.parameters().get("fidelity") == AVERAGED:
        demand = must_be("fidelity", "kinematic, rigid or elastic for orders", "averaged")
        raise ParameterError(f"{demand}: this fidelity level has no pulses")
    last = scene.run.stop_time if end is None else end
    first = begin or 0.0
    if not 0.0 <= first < last <= scene.run.stop_time:
        limits = f"increasing and within 0 to {scene.run.stop_time:g} s"
        raise ParameterError(must_be("the time range", limits, f"{first:g} to {last:g} s"))
    selection = SIGNALS if signals is None else tuple(dict.fromkeys(signals))
    outputs = dict.fromkeys([*(BEARING.get(name, name) for name in selection), "input_speed", *ANGLES])
    scene = scene.replaced(run={"outputs": list(outputs)})
    recorder = _Recorder(scene, fmu, first, last, progress)
    record = recorder.record() if record is None else record
    first_row = recorder.first_row(record, of if begin is None else None)
    sampling = _sampling(scene, recorder.part(record, first_row), of, highest)
    substeps = recorder.substeps(sampling, selection)
    if substeps > 1:
        record = recorder.record(substeps)
        first_row = recorder.first_row(record, of if begin is None else None)
    mass = scene.parameters().get("imbalance_mass", BY_NAME["imbalance_mass"].start or 0.0)
    forces = {name: -mass * record[BEARING[name]] for name in selection if name in BEARING}
    signals_table = Result(record.columns | forces, record.units | dict.fromkeys(forces, "N"))
    table = recorder.part(signals_table, first_row)
    varying = [name for name in selection if np.ptp(table[name]) > rounding(table, name)]
    if not varying and signals is None:
        raise ParameterError(f"all signals are constant: {', '.join(selection)}")
    names = varying if signals is None else selection
    return spectra(
        table, _revolutions(table, of), names, of, sampling.highest, turns, _revolutions(table, DRIVE)
    )


class _Sampling(NamedTuple):
    """Sampling of an order analysis.

    Attributes:
        highest: Maximum order.
        step: Maximum step without aliases, s.
    """

    highest: float
    step: float


def _sampling(scene: Scene, table: Result, of: str, highest: float | None) -> _Sampling:
    """Choose the maximum order and the sampling from the fastest pulses of a run.

    The maximum order satisfies the Nyquist condition with a margin. Pulses have jumps and therefore no
    maximum harmonic, so aliases of harmonics below ALIASED_HARMONIC must stay above the maximum order.

    Args:
        scene: The scene.
        table: Record of the scene with the columns ANGLES.
        of: Reference angle, LINK1 or DRIVE.
        highest: Maximum order; None for HARMONICS harmonics of the pulses.

    Raises:
        ParameterError: The maximum order is not positive.
    """
    rate, pinion_rate = (_maximum_rate(table, base) for base in (of, DRIVE))
    module = Module("plain")
    module.check(**scene.parameters())
    d = module.derived
    # orders of the pinion shaft: 1 of a planar module; 2, s and their sum of a bevel module
    pulses = 1.0 if d.planar else 2.0 + d.s
    limit = HARMONICS * pulses * (d.k if of == LINK1 else 1.0) if highest is None else highest
    if not (math.isfinite(limit) and limit > 0.0):
        raise ParameterError(must_be("highest (maximum order)", "above 0", f"{limit:g}"))
    sampling = max(POINTS_PER_CYCLE * limit * rate, limit * rate + ALIASED_HARMONIC * pulses * pinion_rate)
    return _Sampling(limit, 1.0 / sampling if sampling > 0.0 else math.inf)


def _maximum_rate(table: Result, of: str) -> float:
    """Return the maximum number of revolutions per second between two rows."""
    return float(np.abs(np.diff(_revolutions(table, of)) / np.diff(table.time)).max())


class _Recorder(NamedTuple):
    """Runs of a scene up to the end of a time range.

    Attributes:
        scene: Scene with the outputs to record.
        fmu: FMU of the module; None for current_fmu().
        first: Start of the time range, s.
        last: End of the time range, s.
        progress: Function called with the completed fraction of a run, 0 to 1.
    """

    scene: Scene
    fmu: Path | str | None
    first: float
    last: float
    progress: Progress | None

    def record(self, substeps: int = 1) -> Result:
        """Run the scene and record its outputs.

        Args:
            substeps: Rows per communication step; drive, load and controller keep the step of the scene.
        """
        step = self.scene.run.communication_step
        stop = min(self.scene.run.stop_time, math.ceil(self.last / step - ROUNDING) * step)
        values, inputs = initial_values(self.scene)
        with Fmu(self.fmu, values, inputs, stop_time=stop) as instance:
            loop = ClosedLoop(
                instance, self.scene.surroundings, self.scene.run.outputs, self.scene.signal_units
            )
            return loop.run(stop, self.progress, substeps)

    def first_row(self, record: Result, of: str | None) -> int:
        """Return the first row of the time range.

        Args:
            record: Record of a run.
            of: Reference angle to exclude the time before it begins to rotate, or None.
        """
        low, high = np.searchsorted(record.time, (self.first - 1e-9, self.last + 1e-9))
        return int(low) + (int(np.argmax(np.diff(_revolutions(record, of)[low:high]) != 0.0)) if of else 0)

    def part(self, record: Result, first_row: int) -> Result:
        """Return the rows of the time range from a first row.

        Args:
            record: Record of a run.
            first_row: First row.
        """
        end = int(np.searchsorted(record.time, self.last + 1e-9))
        return Result({name: values[first_row:end] for name, values in record.columns.items()}, record.units)

    def substeps(self, sampling: _Sampling, names: Sequence[str]) -> int:
        """Return the number of rows per communication step for a sampling.

        Args:
            sampling: Maximum order and maximum step.
            names: Names of the analysed signals.

        Raises:
            ParameterError: The run would have too many rows, or the scene computes a signal once per step.
        """
        step = self.scene.run.communication_step
        number = math.ceil(step / sampling.step - ROUNDING)
        if number <= 1:
            return 1
        limit = MAX_ROWS * sampling.step
        if self.last > limit:
            raise ParameterError(
                f"orders up to {sampling.highest:.4g} need steps of {_step_text(sampling.step)}, more than"
                f" {MAX_ROWS:,} in {self.last:g} s; lower highest, or end the time range before {limit:.3g} s"
            )
        surroundings, parameters = self.scene.surroundings, self.scene.parameters()
        if isinstance(surroundings, Sources):
            return number
        once_per_step = [name for name in names if name in surroundings.output_labels]
        if parameters.get("input_hold", 0.0) and parameters.get("drive", DRIVE_SPEED) == DRIVE_SPEED:
            once_per_step.append("omega1 with mechanism.input_hold = linear")
        if once_per_step:
            raise ParameterError(
                f"orders up to {sampling.highest:.4g} need run.communication_step ="
                f" {_step_text(0.9 * sampling.step)} or less (got {step:g} s): the scene computes"
                f" {', '.join(once_per_step)} once per communication step"
            )
        return number


def _step_text(step: float) -> str:
    """Return a step as text, rounded down to two digits."""
    digits = 10.0 ** (math.floor(math.log10(step)) - 1)
    return f"{math.floor(step / digits) * digits * 1e3:.3g} ms"


def _revolutions(table: Result, of: str) -> Array:
    """Return the revolutions of a reference angle up to each row, positive in its direction of rotation."""
    angle, count = ANGLES[:2] if of == LINK1 else ANGLES[2:]
    revolutions = table[angle] / math.tau + table[count]
    return math.copysign(1.0, revolutions[-1] - revolutions[0]) * revolutions
