"""Running a scene: the FMU and what the scene has around it, to a table and a summary."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

from ..bridge.restarted import RestartedFmu
from ..contract.variable import LOCAL, OUTPUT
from ..contract.variables import with_causality
from ..harness.simulate import Fmu, Progress, Result
from ..loops import ClosedLoop, initial_inputs
from .drives import TORQUE_DRIVES
from .errors import SceneError
from .schema import Scene
from .summary import SUMMARISED, Quantity, summarise


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What a scene gave.

    Attributes:
        record: everything recorded: outputs wanted, outputs summarised, signals of the loop.
        summary: the numbers by name. units: of these numbers, "" for counts and ratios.
        warnings: that the FMU logged.
    """

    record: Result
    quantities: dict[str, Quantity] = field(repr=False)
    warnings: tuple[str, ...] = ()

    @property
    def summary(self) -> dict[str, float]:
        """Numbers of the run by name."""
        return {name: quantity.value for name, quantity in self.quantities.items()}

    @property
    def units(self) -> dict[str, str]:
        """Units of the numbers of the summary, "" for counts and ratios."""
        return {name: quantity.unit for name, quantity in self.quantities.items()}


@dataclass(frozen=True, kw_only=True)
class SceneResult(Outcome):
    """What a scene of the module gave.

    Attributes:
        scene: as it was run.
    """

    scene: Scene

    @property
    def table(self) -> Result:
        """The outputs the scene wants and the signals of its loop, at each communication point."""
        unwanted = {variable.name for variable in with_causality(OUTPUT, LOCAL)} - set(self.scene.run.outputs)
        return self.record.without(unwanted)


def start_of(scene: Scene) -> tuple[Any, dict[str, float], dict[str, float]]:
    """What a scene starts from: its surroundings, connected; parameters and inputs of the FMU by name."""
    values = scene.parameters()
    surroundings = scene.surroundings
    speeds = {"omega_out": values.get("omega_out_start", 0.0)}
    if not isinstance(scene.drive, TORQUE_DRIVES):
        return surroundings, values, initial_inputs(surroundings, speeds)
    omega1 = scene.drive.start_speed
    inputs = initial_inputs(surroundings, {**speeds, "input_speed": omega1})
    return surroundings, values, {**inputs, "omega1": omega1}


def run_scene(
    scene: Scene, fmu_path: Path | str, progress: Progress | None = None, also: Iterable[str] = ()
) -> SceneResult:
    """Run a scene with an FMU of the module.

    Args:
        scene: of load_scene. fmu_path: InertiaModule.fmu, or another with its contract.
        progress: told how much of the run is done (0 to 1).
        also: outputs and locals of the FMU to record besides those that the scene wants.

    Raises:
        FmuError: the FMU cannot be loaded, or refuses a value or a step.
        SceneError: its fidelity is still to be chosen.
    """
    _check_fidelity(scene)
    surroundings, values, inputs = start_of(scene)
    tolerance, stop_time = scene.accuracy.tolerance, scene.run.stop_time
    with Fmu(fmu_path, values, inputs, tolerance, stop_time=stop_time) as fmu:
        return _run_on(fmu, scene, surroundings, progress, also)


class SceneRunner:
    """Runs one scene after the other with one instance of an FMU; a context manager.

    That costs a tenth of what an instance for each run does. The results are those of run_scene, bit for
    bit; but not its warnings.

    Args:
        fmu_path: as in run_scene; an FMU with states.

    Raises:
        FmuError: the FMU cannot be loaded.
    """

    def __init__(self, fmu_path: Path | str) -> None:
        self._fmu = RestartedFmu(fmu_path)

    def run(self, scene: Scene) -> SceneResult:
        """Run a scene; raises as run_scene."""
        return _run_on(self.started(scene), scene, scene.surroundings)

    def started(self, scene: Scene) -> Fmu:
        """The instance at the start of a scene; raises as run_scene."""
        _check_fidelity(scene)
        _, values, inputs = start_of(scene)
        tolerance = scene.accuracy.tolerance
        given = {} if tolerance is None else {"tolerance": tolerance}
        self._fmu.restart({**values, **inputs, **given})
        return self._fmu

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self._fmu.close()


def _check_fidelity(scene: Scene) -> None:
    if scene.chooses_fidelity:
        raise SceneError("mechanism.fidelity must be chosen first (studies.trials.choose), is 'auto'")


def _run_on(
    fmu: Fmu, scene: Scene, surroundings: Any, progress: Progress | None = None, also: Iterable[str] = ()
) -> SceneResult:
    """Run a scene with a started FMU."""
    loop = ClosedLoop(fmu, surroundings, [*scene.run.outputs, *SUMMARISED, *also], scene.signal_units)
    began = time.perf_counter()
    record = loop.run(scene.run.stop_time, progress)
    wall_time = time.perf_counter() - began
    measured = scene.measured if scene.controller is not None else None
    times_to = getattr(scene.load, "times_to", ())
    summary = summarise(record, measured, scene.cycle, wall_time, times_to)
    return SceneResult(scene=scene, record=record, quantities=summary, warnings=tuple(fmu.warnings))
