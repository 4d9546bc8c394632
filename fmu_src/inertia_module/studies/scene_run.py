"""A scene run with the module in this process, and the time the kernel takes for it."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..contract.variables import LOCAL, OUTPUT, with_causality
from ..harness.simulate import Progress, Result
from ..loops import ClosedLoop
from ..memory.instances import Module
from ..scene import Scene
from ..scene.run import start_of
from .timing import kernel_time

READABLE = tuple(variable.name for variable in with_causality(OUTPUT, LOCAL))


class ModulePlant:
    """The module as a plant of loops.ClosedLoop; keeps the inputs of each step.

    Args:
        parameters, inputs: by name.

    Raises:
        Refused: parameters, inputs or a step are bad.
    """

    def __init__(self, parameters: Mapping[str, float], inputs: Mapping[str, float]) -> None:
        self.module = Module("auto").start(**{**parameters, **inputs})
        self._begin = self.module.save()
        self._given: list[tuple[float, float, float]] = []
        self._step = 0.0

    def set(self, **values: float) -> None:
        """Set inputs by name."""
        self.module.set(**values)

    def advance(self, step: float) -> None:
        """Advance by a communication step, s."""
        held = self.module.inputs
        self._given.append((held.omega1, held.load_torque, held.drive_torque))
        self._step = step
        self.module.advance(step)

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values by name."""
        return tuple([self.module[name] for name in names])

    def kernel_time(self) -> float:
        """Time of the kernel for the same steps with the same inputs, s, median of repeats."""
        return kernel_time(self.module, self._begin, self._given, self._step)


@dataclass(frozen=True)
class SceneRun:
    """What a run of a scene gave.

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
    plant = ModulePlant(values, inputs)
    loop = ClosedLoop(plant, surroundings, READABLE, scene.signal_units)
    began = time.perf_counter()
    record = loop.run(scene.run.stop_time, progress)
    loop_time = time.perf_counter() - began
    duration = scene.run.stop_time
    return SceneRun(record, plant.kernel_time() / duration, loop_time / duration)
