"""Simulation of a scene: an FMU in closed loop with drive, load and controller."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..common.deprecated import renamed_arguments
from ..common.errors import InertiaModuleError, SceneError
from ..common.terminal import Progress
from ..driveline import ClosedLoop, initial_inputs
from ..fmi.instance import RestartedFmu
from ..fmi.simulate import Fmu, Result
from .freewheel_loads import freewheel_duty, impact_warnings
from .keys import scene_time_warnings
from .loads import VehicleLoad
from .quantity import Quantity
from .reading import as_scene
from .result import SceneResult
from .schema import Scene
from .summary_metrics import SUMMARY_VARIABLES, input_speed, summarise
from .vehicle_metrics import TRACTIVE_FORCE, cycle_remarks, grip_metrics, times_to


def initial_values(scene: Scene) -> tuple[dict[str, float], dict[str, float]]:
    """Return parameters (with tolerance) and initial inputs of the FMU for a scene, SI, by name.

    Args:
        scene: The scene.

    Raises:
        SceneError: The fidelity of the scene is 'auto'.
    """
    if scene.chooses_fidelity:
        raise SceneError(
            "mechanism.fidelity must be a named level (got 'auto'). Choose one with fidelity.choice.choose."
        )
    values = scene.parameters()
    if scene.accuracy.tolerance is not None:
        values["tolerance"] = scene.accuracy.tolerance
    omega1 = scene.drive.start_speed
    measured = {"omega_out": values.get("omega_out_start", 0.0), "input_speed": omega1 or 0.0}
    inputs = initial_inputs(scene.surroundings, measured)
    return values, inputs if omega1 is None else {**inputs, "omega1": omega1}


@renamed_arguments(fmu_path="fmu")
def run_scene(
    scene: Scene | Path | str,
    fmu: Path | str | None = None,
    progress: Progress | None = None,
    also: Iterable[str] = (),
) -> SceneResult:
    """Run a scene with an FMU of the module.

    Args:
        scene: Scene, or path of its file.
        fmu: InertiaModule.fmu, or another FMU with the same variables; None for current_fmu().
        progress: Function called with the completed fraction of the run, 0 to 1.
        also: Names of more outputs and local variables of the FMU to record.

    Raises:
        FmuError: The FMU cannot be loaded, or rejects a value or a step.
        SceneError: The scene is invalid, or its fidelity is 'auto'.
    """
    scene = as_scene(scene)
    values, inputs = initial_values(scene)
    with Fmu(fmu, values, inputs, stop_time=scene.run.stop_time) as instance:
        result = _run_with(instance, scene, progress, also)
    return replace(result, remarks={**result.remarks, **above_stall(result, scene.parameters())})


def above_stall(record: Result, parameters: dict[str, float]) -> dict[str, str]:
    """Return a note if the load is above the stall torque and the shaft rests in the last tenth of the run.

    Args:
        record: Record of the run.
        parameters: Parameters of the module, SI, by name.
    """
    end = slice(-max(len(record) // 10, 1), None)
    speed, load = (float(np.mean(values[end])) for values in (input_speed(record), record["load_torque"]))
    has_brake = "brake_torque" in record and record["brake_torque"][end].any()
    revolutions = abs(speed) * float(np.ptp(record.time)) / math.tau
    if has_brake or revolutions < 1.0 or record["omega_out"][end].min() > 1e-6 * abs(speed):
        return {}
    from ..analysis.steady_state import SteadyMachine  # imports scipy

    try:
        stall = SteadyMachine(parameters).at(speed, 0.0).output_torque
    except InertiaModuleError:  # stall requires both freewheels
        return {}
    above = f"exceeds the stall torque of {stall:.4g} N.m at {speed:.4g} rad/s ({load:.4g} N.m)"
    return {"load_torque": above} if load > stall else {}


class SceneRunner(RestartedFmu):
    """Instance of an FMU with states that runs several scenes; a context manager.

    A run costs a tenth of a run with a new instance. Metrics are bitwise identical to run_scene. Warnings of
    the FMU can be missing, and the note of above_stall is always missing.
    """

    def run(self, scene: Scene) -> SceneResult:
        """Run a scene.

        Args:
            scene: The scene.

        Raises:
            FmuError: The FMU rejects a value or a step.
            SceneError: The fidelity of the scene is 'auto'.
        """
        return _run_with(self.started(scene), scene)

    def started(self, scene: Scene) -> Fmu:
        """Return the instance, restarted with the initial values of a scene.

        Args:
            scene: The scene.

        Raises:
            FmuError: The FMU rejects a value.
            SceneError: The fidelity of the scene is 'auto'.
        """
        values, inputs = initial_values(scene)
        self.restart({**values, **inputs})
        return self


def _run_with(
    fmu: Fmu, scene: Scene, progress: Progress | None = None, also: Iterable[str] = ()
) -> SceneResult:
    """Run a scene with a started FMU."""
    loop = ClosedLoop(
        fmu, scene.surroundings, [*scene.run.outputs, *SUMMARY_VARIABLES, *also], scene.signal_units
    )
    start = time.perf_counter()
    record = loop.run(scene.run.stop_time, progress)
    wall_time = time.perf_counter() - start
    speeds = getattr(scene.load, "times_to", ())
    times, remarks = times_to(record, speeds) if speeds else ({}, {})
    if scene.cycle is not None:
        remarks |= cycle_remarks(record, scene.cycle)
    duty, notes = freewheel_duty(record, scene.parameters(), scene.freewheels.of("stiffness"))
    limits = {name: limit for name, limit in scene.freewheels.limits().items() if name in duty}
    if isinstance(scene.load, VehicleLoad) and scene.load.grip is not None:
        numbers, slipping = grip_metrics(record, scene.load)
        duty, notes, limits = duty | numbers, notes | slipping, limits | {TRACTIVE_FORCE: scene.load.grip}
    quantities = summarise(record, scene.cycle, wall_time, times | duty)
    return SceneResult(
        record.columns,
        record.units,
        scene=scene,
        quantities=quantities,
        remarks=remarks | notes,
        limits=limits,
        warnings=(
            *fmu.warnings,
            *_limit_warnings(duty, limits),
            *impact_warnings(scene, duty),
            *scene_time_warnings(scene, scene.run.stop_time),
        ),
    )


def _limit_warnings(metrics: Mapping[str, Quantity], limits: Mapping[str, float]) -> Iterator[str]:
    """Yield a warning for each metric that exceeds its limit."""
    for name, limit in limits.items():
        value, unit = metrics[name]
        if value > limit:
            yield f"{name.replace('_', ' ')} exceeds its limit of {limit:.6g} {unit}: {value:.6g} {unit}"
