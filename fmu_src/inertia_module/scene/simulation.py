"""Simulation of a scene or of an FMU with one function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import overload

from numpy.typing import ArrayLike

from ..common.deprecated import renamed_arguments
from ..common.errors import ParameterError
from ..common.terminal import Progress
from ..fmi.instance import as_names
from ..fmi.results import Result
from ..fmi.simulate import simulate_fmu
from .reading import load_any_scene
from .result import SceneResult
from .run import run_scene
from .schema import Scene
from .shaft import ShaftScene
from .shaft_run import run_shaft_scene


@overload
def simulate(
    model: Scene | ShaftScene,
    inputs: None = None,
    stop_time: float | None = None,
    step: float | None = None,
    outputs: str | Sequence[str] | None = None,
    parameters: Mapping[str, float | bool | str] | None = None,
    tolerance: float | None = None,
    progress: Progress | None = None,
    fmu: Path | str | None = None,
) -> SceneResult: ...


@overload
def simulate(
    model: Path | str,
    inputs: Result | Mapping[str, ArrayLike] | Path | str | None = None,
    stop_time: float | None = None,
    step: float | None = None,
    outputs: str | Sequence[str] | None = None,
    parameters: Mapping[str, float | bool | str] | None = None,
    tolerance: float | None = None,
    progress: Progress | None = None,
    fmu: Path | str | None = None,
) -> Result: ...


@renamed_arguments(path="model")
def simulate(
    model: Scene | ShaftScene | Path | str,
    inputs: Result | Mapping[str, ArrayLike] | Path | str | None = None,
    stop_time: float | None = None,
    step: float | None = None,
    outputs: str | Sequence[str] | None = None,
    parameters: Mapping[str, float | bool | str] | None = None,
    tolerance: float | None = None,
    progress: Progress | None = None,
    fmu: Path | str | None = None,
) -> Result:
    """Simulate a scene, or an FMU with a table of inputs.

    Examples:
        simulate("planar.toml")
        simulate(current_fmu(), {"omega1": 100.0, "load_torque": 8.0}, stop_time=1.0, step=1e-3)

    Args:
        model: scene, path of a scene file (.toml), or path of an FMU (.fmu).
        inputs: inputs of an FMU by name: constants, or arrays with an array time; or a Result, or the path of
            a CSV file. They are interpolated linearly between rows and constant outside; two rows with the
            same time are a step. Columns in other units (`omega1 [rpm]`) are converted. Columns of computed
            variables are measured values, which the result contains as `NAME_measured`. A scene contains its
            own inputs.
        stop_time: stop time, s; the run starts at 0. Required for an FMU; replaces the value of a scene.
        step: communication step, s. Required for an FMU; replaces the value of a scene.
        outputs: names of variables to record, or a single name; None for the outputs of the scene, or for all
            outputs of the FMU.
        parameters: start values of parameters by name: numbers, strings with a unit ("90 deg"), enumerations
            by item name. They replace the values of a scene.
        tolerance: relative tolerance of the integration; None for the value of the scene or FMU.
        progress: function that receives the completed share, 0 to 1; by default runs of an FMU over two
            seconds show a progress bar.
        fmu: FMU that computes a scene; None for current_fmu().

    Returns:
        Table of time, inputs and outputs, shape (steps + 1,) each; of a scene also its summary (SceneResult).

    Raises:
        SceneError: the scene is invalid.
        FmuError: the FMU cannot be loaded, or rejects a value or a step.
        ParameterError: an argument is missing or invalid.
    """
    if model is None or (isinstance(model, Path | str) and Path(model).suffix.lower() != ".toml"):
        if inputs is None or stop_time is None or step is None:
            raise ParameterError("inputs, stop_time and step are required with an FMU")
        if fmu is not None:
            raise ParameterError("fmu is allowed only with a scene; the first argument is already an FMU")
        return simulate_fmu(model, inputs, stop_time, step, outputs, parameters, tolerance, progress)
    if inputs is not None:
        raise ParameterError("inputs are allowed only with an FMU; a scene contains its drive and its load")
    scene = load_any_scene(model) if isinstance(model, Path | str) else model
    run = {
        "run.stop_time": stop_time,
        "run.communication_step": step,
        "run.outputs": None if outputs is None else list(as_names(outputs)),
        "accuracy.tolerance": tolerance,
    }
    keys: dict[str, object] = {name: value for name, value in run.items() if value is not None}
    table = "shaft" if isinstance(scene, ShaftScene) else "mechanism"
    keys |= {f"{table}.{name}": value for name, value in (parameters or {}).items()}
    if isinstance(scene, ShaftScene):
        return run_shaft_scene(scene.with_keys(keys), fmu, progress)
    return run_scene(scene.with_keys(keys), fmu, progress)
