"""A scene run with the module in this process, and the time the kernel takes for it."""

from __future__ import annotations

import time
from dataclasses import dataclass

from ..contract.variables import COMPUTED
from ..harness.simulate import Progress, Result
from ..loops import ClosedLoop
from ..memory import Module
from ..scene import Scene
from ..scene.run import start_of
from .timing import kernel_time


class RecordedModule(Module):
    """A module as a plant of loops.ClosedLoop, which keeps the inputs of each step.

    Attributes:
        given: (omega1, load_torque, drive_torque) of each step.
    """

    def __init__(self) -> None:
        super().__init__()
        self.given: list[tuple[float, float, float]] = []

    def advance(self, step_size: float) -> None:
        """Advance by a communication step, s."""
        self.given.append((self.inputs.omega1, self.inputs.load_torque, self.inputs.drive_torque))
        super().advance(step_size)


@dataclass(frozen=True)
class SceneRun:
    """Result of a run of a scene.

    Attributes:
        record: all variables of the module and all signals of the loop at each communication point.
        module_time, loop_time: s per simulated second, of the kernel alone and of the whole loop.
    """

    record: Result
    module_time: float
    loop_time: float


def run_in_process(scene: Scene, progress: Progress | None = None) -> SceneRun:
    """Run a scene, its fidelity being given.

    Args:
        scene: as it is to be run. progress: told how much is done (0 to 1).

    Raises:
        Refused: the module refuses its parameters, an input or a step.
    """
    surroundings, values, inputs = start_of(scene)
    if scene.accuracy.tolerance is not None:
        values["tolerance"] = scene.accuracy.tolerance
    plant = RecordedModule().start(**values, **inputs)
    begin = plant.save()
    loop = ClosedLoop(plant, surroundings, COMPUTED, scene.signal_units)
    began = time.perf_counter()
    record = loop.run(scene.run.stop_time, progress)
    loop_time = time.perf_counter() - began
    duration = scene.run.stop_time
    spent = kernel_time(plant, begin, plant.given, scene.run.communication_step)
    return SceneRun(record, spent / duration, loop_time / duration)
