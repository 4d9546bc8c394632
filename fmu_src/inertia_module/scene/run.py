"""Running a scene: the FMU and what the scene has around it, to a table and a summary."""

from __future__ import annotations

import base64
import math
import time
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import __version__
from ..common.errors import Named, Refused
from ..common.terminal import Progress
from ..contract.variables import LOCAL, OUTPUT
from ..harness.fmu import Closing, RestartedFmu
from ..harness.results import html_table
from ..harness.simulate import Fmu, Result
from ..kernel.codes import ELASTIC
from ..loops import ClosedLoop, initial_inputs
from .keys import SceneError
from .schema import Scene
from .summary import SUMMARISED, Quantity, input_speed, summarise, unreached

if TYPE_CHECKING:
    from ..export.systems import Plan

# of the speed of link 1: below it the output shaft rests
RESTING = 1e-6


@dataclass(frozen=True, kw_only=True)
class SceneResult:
    """Result of a scene, of a module or of a driven shaft alone.

    Attributes:
        scene: as it was run. record: everything recorded: outputs wanted, outputs summarised, signals of the
            loop. quantities, summary, units: numbers by name; units are "" for counts and ratios.
        remarks: what the numbers leave out, by name: a speed not reached, a load above stall.
        warnings: that the FMU logged.
    """

    scene: Any
    record: Result
    quantities: dict[str, Quantity] = field(repr=False)
    remarks: dict[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    @property
    def table(self) -> Result:
        """Wanted outputs and the signals of the loop, at each communication point."""
        computed = {one.name for one in self.scene.VARIABLES.values() if one.causality in (OUTPUT, LOCAL)}
        return self.record.without(computed - set(self.scene.run.outputs))

    @property
    def summary(self) -> dict[str, float]:
        """Numbers of the run by name."""
        values = {name: quantity.value for name, quantity in self.quantities.items()}
        return Named(values, "a number of the summary", self.remarks)

    @property
    def units(self) -> dict[str, str]:
        """Units of the numbers of the summary, "" for counts and ratios."""
        return {name: quantity.unit for name, quantity in self.quantities.items()}

    def as_dict(self) -> dict[str, Any]:
        """Version, title of the scene, its parameters, the summary, and units of all numbers, for JSON."""
        parameters = self.scene.parameters()
        of_parameters = {name: self.scene.VARIABLES[name].unit for name in parameters}
        return {
            "inertia_module": __version__,
            "title": self.scene.title,
            "parameters": parameters,
            "summary": self.summary,
            "units": of_parameters | self.units,
            "remarks": self.remarks,
        }

    def lines(self) -> dict[str, str]:
        """The summary and the remarks, as text by name."""
        numbers = {name: f"{value:.6g} {unit}".rstrip() for name, (value, unit) in self.quantities.items()}
        return {name.replace("_", " "): text for name, text in (numbers | self.remarks).items()}

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self.record[name]

    def __contains__(self, name: object) -> bool:
        return name in self.record

    def to_csv(self, path: Path | str) -> Path:
        """Write the table: see Result.to_csv."""
        return self.table.to_csv(path)

    def to_pandas(self) -> Any:
        """The table as a pandas DataFrame: see Result.to_pandas."""
        return self.table.to_pandas()

    def plot(self, *names: str) -> Any:
        """A matplotlib Figure of the table over time: see Result.plot."""
        return self.table.plot(*names)

    def _repr_png_(self) -> bytes:
        return self.table._repr_png_()

    def _repr_html_(self) -> str:
        """Show the plot and the summary in a notebook."""
        picture = base64.b64encode(self._repr_png_()).decode()
        return f'<img src="data:image/png;base64,{picture}">' + html_table(
            (self.scene.title, ""), self.lines().items()
        )


def start_of(scene: Scene) -> tuple[Any, dict[str, float], dict[str, float]]:
    """Start of a scene: its surroundings, connected; parameters, with the tolerance, and inputs of the FMU.

    Raises:
        SceneError: its fidelity is still to be chosen.
    """
    if scene.chooses_fidelity:
        raise SceneError("mechanism.fidelity must be chosen first (fidelity.trials.choose), is 'auto'")
    values, surroundings = scene.parameters(), scene.surroundings
    if scene.accuracy.tolerance is not None:
        values["tolerance"] = scene.accuracy.tolerance
    speeds = {"omega_out": values.get("omega_out_start", 0.0)}
    omega1 = scene.drive.start_speed
    if omega1 is None:
        return surroundings, values, initial_inputs(surroundings, speeds)
    inputs = initial_inputs(surroundings, {**speeds, "input_speed": omega1})
    return surroundings, values, {**inputs, "omega1": omega1}


def scene_plan(scene: Scene) -> Plan:
    """Plan the export of a scene: the FMUs of its mechanism with the values at its start.

    Raises:
        SceneError: its fidelity is still to be chosen, or its freewheels wind up.
    """
    from ..export.systems import make_plan  # brings the builder of FMUs along

    if scene.chooses_fidelity:
        raise SceneError("mechanism.fidelity must be a fidelity by name for an export, is 'auto'")
    surroundings, values, inputs = start_of(scene)
    for name in ("housing_stiffness", "freewheel_stiffness"):
        if values.get("fidelity") == ELASTIC and values.get(name, 0.0) > 0.0:
            raise SceneError(
                f"mechanism.{name} must be 0 for an export, is {values[name]:g}: an elastic mechanism becomes"
                " a rigid module and a shaft, and neither has freewheels that wind up"
            )
    step = float(surroundings.dt)
    return make_plan(scene.title, values, inputs, step, scene.run.stop_time)


def run_scene(
    scene: Scene,
    fmu_path: Path | str | None = None,
    progress: Progress | None = None,
    also: Iterable[str] = (),
) -> SceneResult:
    """Run a scene with an FMU of the module.

    Args:
        scene: of load_scene.
        fmu_path: InertiaModule.fmu, or another with its contract; None for that of the package (current_fmu).
        progress: told how much of the run is done (0 to 1).
        also: outputs and locals of the FMU to record besides those that the scene wants.

    Raises:
        FmuError: the FMU cannot be loaded, or refuses a value or a step.
        SceneError: its fidelity is still to be chosen.
    """
    surroundings, values, inputs = start_of(scene)
    with Fmu(fmu_path, values, inputs, stop_time=scene.run.stop_time) as fmu:
        found = _run_on(fmu, scene, surroundings, progress, also)
    return replace(found, remarks={**found.remarks, **above_stall(found.record, scene.parameters())})


def above_stall(record: Result, parameters: dict[str, float]) -> dict[str, str]:
    """Remark on a load that the machine cannot turn: the shaft rests in the last tenth of the run."""
    end = slice(-max(len(record) // 10, 1), None)
    speed, load = (float(np.mean(values[end])) for values in (input_speed(record), record["load_torque"]))
    braked = "brake_torque" in record and record["brake_torque"][end].any()
    turns = abs(speed) * float(np.ptp(record.time)) / math.tau
    if braked or turns < 1.0 or record["omega_out"][end].min() > RESTING * abs(speed):
        return {}
    from ..harness.chart import SteadyMachine  # brings scipy along

    try:
        stall = SteadyMachine(parameters).at(speed, 0.0).output_torque
    except Refused:  # without both freewheels there is no stall
        return {}
    above = f"is above stall: {load:.4g} N.m, the mechanism gives {stall:.4g} N.m at {speed:.4g} rad/s"
    return {"load_torque": above} if load > stall else {}


class SceneRunner(Closing):
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
        _, values, inputs = start_of(scene)
        self._fmu.restart({**values, **inputs})
        return self._fmu

    def close(self) -> None:
        """Free the instance."""
        self._fmu.close()


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
    return SceneResult(
        scene=scene,
        record=record,
        quantities=summary,
        remarks=unreached(record, summary, times_to),
        warnings=tuple(fmu.warnings),
    )
