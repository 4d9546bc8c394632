"""Accuracy and run time of a scene at its fidelity levels.

Runs are compared with the finest level by averages over time windows, not by instantaneous values. A
closed loop controls speeds and torques but not the phase of the pulses, which drifts between two runs.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.files import cached, sources
from ..common.terminal import Progress
from ..driveline import ClosedLoop
from ..driveline.closed_loop import PLANT_INPUTS
from ..fmi.results import TIME
from ..fmi.simulate import Result
from ..interface.variables import COMPUTED
from ..kernel.codes import AVERAGED
from ..model import Module
from ..scene import Scene
from ..scene.run import initial_values
from .levels import NOT_MODELLED, Level, at_level, candidates, reference_level
from .rows import Row, attempt, read_rows, write_rows
from .timing import kernel_time

Array = NDArray[np.float64]

# energies, whose errors are relative to the input energy because they can be small or zero
_ENERGIES = ("energy_in", "energy_out", "energy_stored", "energy_lost", "energy_residual")


def run_in_process(scene: Scene, progress: Progress | None = None) -> Result:
    """Run a scene in memory and record all variables of the module and all signals of the loop.

    Args:
        scene: Scene with a named fidelity.
        progress: Function called with the completed fraction of the run, 0 to 1.

    Raises:
        ParameterError: The module rejects a value or a step.
    """
    loop = ClosedLoop(_start_module(scene), scene.surroundings, COMPUTED, scene.signal_units)
    return loop.run(scene.run.stop_time, progress)


def _start_module(scene: Scene) -> Module:
    values, inputs = initial_values(scene)
    return Module().start(**values, **inputs)


def kernel_time_of(scene: Scene, record: Result) -> float:
    """Measure the kernel time of a scene, s per simulated second.

    Args:
        scene: Scene with a named fidelity.
        record: Record of the scene, from run_in_process.
    """
    plant = _start_module(scene)
    # Signals of a row are constant over the step after it, other inputs over the run.
    inputs = [record[name] if name in record else np.full(len(record), plant[name]) for name in PLANT_INPUTS]
    steps = np.transpose(inputs)[:-1].tolist()
    return kernel_time(plant, plant.save(), steps, scene.run.communication_step) / scene.run.stop_time


def _features(record: Result, name: str, window: float) -> list[Array]:
    """Return window means of an output and, if it pulses, window RMS values.

    The first row is excluded because no step precedes it. Rows after the last whole window belong to this
    window.
    """
    values = record[name][1:]
    rows = max(round(window / float(record.time[1] - record.time[0])), 1)
    edges = np.arange(max(values.size // rows, 1)) * rows

    def means(values: Array) -> Array:
        return np.asarray(np.add.reduceat(values, edges) / np.diff(np.append(edges, values.size)))

    return [means(values), np.sqrt(means(values**2))] if name in NOT_MODELLED[AVERAGED] else [means(values)]


def window_errors(record: Result, exact: Result, window: float, fidelity: int) -> Mapping[str, float]:
    """Return the relative error of each recorded output; NaN if the fidelity does not model it.

    The error is the maximum difference of window averages. It is relative to the maximum magnitude of the
    output in the reference, or to the maximum input energy for energies.

    Args:
        record: Record of the run.
        exact: Reference record over the same time.
        window: Length of the windows, s.
        fidelity: Number of the fidelity of the run.
    """
    energy_scale = float(np.abs(exact["energy_in"]).max())
    # Evaluations measure cost, not accuracy.
    errors = {"rhs_evaluations": 0.0} | dict.fromkeys(NOT_MODELLED[fidelity], math.nan)
    for name in exact.names:
        if name == TIME or name in errors:
            continue
        pairs = zip(_features(record, name, window), _features(exact, name, window), strict=True)
        difference = max(float(np.abs(actual - expected).max()) for actual, expected in pairs)
        scale = energy_scale if name in _ENERGIES else float(np.abs(exact[name]).max())
        errors[name] = 0.0 if difference == 0.0 else difference / scale if scale > 0.0 else math.inf
    return {name: errors[name] for name in exact.names if name != TIME}


def measure_scene(
    scene: Scene,
    levels: Sequence[Level],
    progress: Progress | None = None,
) -> list[Row]:
    """Run a scene at levels, and compare the runs with the finest level.

    Args:
        scene: The scene.
        levels: Levels to measure.
        progress: Function called with the completed fraction, 0 to 1.

    Returns:
        A row per level, also for failed runs.

    Raises:
        ParameterError: The run at the finest level fails.
    """

    def progress_of(number: int) -> Progress:
        """Return the progress function of a run; the reference is run 0."""
        report = progress or (lambda fraction: None)
        return lambda fraction: report((number + fraction) / (1 + len(levels)))

    reference = run_in_process(at_level(scene, reference_level(scene)), progress_of(0))

    def measure(number: int, level: Level) -> dict[str, Any]:
        scene_at_level = at_level(scene, level)
        record = run_in_process(scene_at_level, progress_of(number))
        last = record.last()
        return {
            "errors": window_errors(record, reference, scene.accuracy.window, level.fidelity),
            "wall_time": kernel_time_of(scene_at_level, record),
            "evaluations": last["rhs_evaluations"],
            "switches": math.nan if level.fidelity == AVERAGED else last["contact_switches"],
        }

    return [
        attempt(Row.of_level(level, scene.run.communication_step), partial(measure, number, level))
        for number, level in enumerate(levels, 1)
    ]


def dependencies(scene: Scene) -> dict[str, bytes]:
    """Return everything that the measurements of a scene depend on: the simulated system and the code.

    Args:
        scene: The scene.
    """
    settings = {"mechanism": {"fidelity", "method", "max_step"}, "accuracy": {"tolerance", "error"}}
    others: dict[str, Any] = {"title": True, "description": True, "run": {"outputs"}}
    content = scene.model_dump_json(exclude_none=True, exclude=settings | others)
    return sources("kernel/**/*.py", "driveline/*.py", "fidelity/*.py") | {"scene": content.encode()}


def trial_rows(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Return the rows of the candidates for a scene, from the cache if nothing has changed.

    Args:
        scene: The scene.
        progress: Function called with the completed fraction, 0 to 1.
    """

    def measure() -> bytes:
        rows = measure_scene(scene, candidates(scene), progress=progress)
        with tempfile.TemporaryDirectory() as folder:
            return write_rows(Path(folder) / "trials.csv", rows).read_bytes()

    return read_rows(cached("trials.csv", dependencies(scene), measure))
