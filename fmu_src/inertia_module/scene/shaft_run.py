"""Simulation of a scene of a driven shaft alone."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..common.deprecated import renamed_arguments
from ..common.terminal import Progress
from ..driveline.sources import evaluate
from ..fmi.simulate import communication_points, simulate_fmu
from ..fmu.builder import current_fmu
from .keys import scene_time_warnings
from .quantity import Quantity
from .result import SceneResult
from .shaft import READABLE, ShaftScene
from .summary_metrics import energy


@renamed_arguments(fmu_path="fmu")
def run_shaft_scene(
    scene: ShaftScene, fmu: Path | str | None = None, progress: Progress | None = None
) -> SceneResult:
    """Run a scene with an FMU of the driven shaft.

    Args:
        scene: The scene.
        fmu: DrivenShaft.fmu, or another FMU with the same variables; None for current_fmu("DrivenShaft").
        progress: Function called with the completed fraction of the run, 0 to 1.

    Raises:
        FmuError: The FMU cannot be loaded, or rejects a value or a step.
    """
    path = current_fmu("DrivenShaft") if fmu is None else fmu
    times = communication_points(scene.run.stop_time, scene.run.communication_step)
    torque = scene.load.one_signal()
    inputs: dict[str, ArrayLike] = {
        "time": times,
        "hub_speed": scene.drive.signal()(times),
        "load_torque": [evaluate(torque, moment) for moment in times],
    }
    run, values, start = scene.run, scene.parameters(), time.perf_counter()
    record = simulate_fmu(
        path, inputs, run.stop_time, run.communication_step, READABLE, values, progress=progress
    )
    wall_time, duration = time.perf_counter() - start, float(record.time[-1])
    names = ("omega_out", "driven_acceleration", "shaft_torque", "twist")
    peaks = {name: float(np.abs(record[name]).max()) for name in names}
    quantities = {
        "simulated_time": Quantity(duration, "s"),
        **{f"{name}_peak": Quantity(peak, record.units[name]) for name, peak in peaks.items()},
        **energy(record),
        "wall_time": Quantity(wall_time, "s"),
        "real_time_factor": Quantity(duration / wall_time, ""),
    }
    warnings = tuple(scene_time_warnings(scene, run.stop_time))
    return SceneResult(record.columns, record.units, scene=scene, quantities=quantities, warnings=warnings)
