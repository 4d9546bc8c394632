"""The loop: sources, controllers and loads, connected by the names of their signals, around an FMU."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ..common.terminal import Progress
from ..contract.variables import BY_NAME
from ..harness.fmu import as_names, run
from ..harness.simulate import Plant, Result, whole_steps
from .sources import Signal, Sources

__all__ = ["ClosedLoop", "connect", "initial_inputs"]

PLANT_INPUTS = ("omega1", "load_torque", "drive_torque")
_PROGRESS_CALLS = 200

# units of the signals that sources, controllers and loads bring along
SIGNAL_UNITS = {
    "vehicle_speed": "m/s",
    "distance": "m",
    "drag_torque": "N.m",
    "slope_torque": "N.m",
    "rolling_torque": "N.m",
    "brake_torque": "N.m",
    "brake_force": "N",
    "load_speed": "rad/s",
}


def connect(systems: Sequence[Any]) -> Any:
    """Connect systems by the names of their signals to the one system around the FMU.

    An input of one is driven by the output of the same name of another; inputs that none drives are
    outputs of the FMU. What depends on what is found out by control.interconnect.

    Args:
        systems: discrete-time python-control systems and sources of one step, each with a name of its own.

    Returns:
        A control.InterconnectedSystem, of sources alone Sources; its outputs are all outputs of the systems.

    Raises:
        ValueError: two systems give the same signal.
    """
    origin: dict[str, str] = {}
    for system in systems:
        for label in system.output_labels:
            if label in origin:
                raise ValueError(
                    f"{label} must be given by one system, is given by {origin[label]} and by {system.name}"
                )
            origin[label] = system.name
    if all(isinstance(system, Sources) for system in systems) and len({system.dt for system in systems}) == 1:
        signals: dict[str, Signal] = {}
        for system in systems:
            signals |= system.signals
        return Sources(signals, systems[0].dt)
    import control as ct

    wanted = {label: None for system in systems for label in system.input_labels if label not in origin}
    return ct.interconnect(
        [system.to_control() if isinstance(system, Sources) else system for system in systems],
        inputs=list(wanted),
        outlist=[f"{name}.{label}" for label, name in origin.items()],
        outputs=list(origin),
        name="surroundings",
    )


def initial_inputs(surroundings: Any, measured: Mapping[str, float] | None = None) -> dict[str, float]:
    """Inputs that the surroundings give the FMU at time 0: to be set before the end of its initialisation.

    Args:
        surroundings: of connect. measured: outputs of the FMU at the start that are not 0.
    """
    known = measured or {}
    given = np.array([known.get(label, 0.0) for label in surroundings.input_labels])
    values = surroundings.output(0.0, np.zeros(surroundings.nstates), given)
    signals = dict(zip(surroundings.output_labels, values, strict=True))
    return {name: float(signals[name]) for name in PLANT_INPUTS if name in signals}


class ClosedLoop:
    """An FMU and the systems around it, stepped together at the step of these systems.

    Order in a step (Gauss-Seidel): read the FMU, let the systems follow to this time with what was
    read, take their outputs, set the inputs of the FMU, advance it. So the FMU goes first and its
    surroundings follow over the same step, which keeps an undamped elastic coupling stable up to a
    natural frequency of 2 / step (see Load.check_step).

    Args:
        plant: a started FMU. surroundings: of connect.
        outputs: variables of the FMU to record besides the signals of the surroundings.
        units: of signals with names of your own.

    Raises:
        ValueError: the surroundings give no input of the FMU.
    """

    def __init__(
        self,
        plant: Plant,
        surroundings: Any,
        outputs: str | Sequence[str] = (),
        units: Mapping[str, str] | None = None,
    ) -> None:
        self.plant = plant
        self.surroundings = surroundings
        self.step = float(surroundings.dt)
        signals: list[str] = surroundings.output_labels
        self._measured = len(surroundings.input_labels)
        self._outputs = [name for name in dict.fromkeys(as_names(outputs)) if name not in signals]
        self._driven = [(name, signals.index(name)) for name in PLANT_INPUTS if name in signals]
        if not self._driven:
            raise ValueError(
                f"surroundings must give at least one of {', '.join(PLANT_INPUTS)}, give {', '.join(signals)}"
            )
        self.names = ("time", *self._outputs, *signals)
        self._units = {**SIGNAL_UNITS, **(units or {})}

    def rows(self, stop_time: float, progress: Progress | None = None) -> Iterator[tuple[float, ...]]:
        """Step to the stop time, s; give a row with the values of names at each communication point.

        Args:
            stop_time: s. progress: told how much of the run is done (0 to 1).

        Raises:
            ValueError: the stop time is not a whole number of steps.
            FmuError: the FMU refuses a value or a step.
        """
        number = self._steps(stop_time)
        report_every = max(number // _PROGRESS_CALLS, 1)
        names = [*self.surroundings.input_labels, *self._outputs]
        state = np.zeros(self.surroundings.nstates)
        for n in range(number + 1):
            time = n * self.step
            values = self.plant.read(names)
            measured = np.array(values[: self._measured])
            if n > 0 and state.size:
                state = self.surroundings.dynamics(time, state, measured)
            signals = self.surroundings.output(time, state, measured).tolist()
            if progress is not None and (n % report_every == 0 or n == number):
                progress(n / number)
            yield (time, *values[self._measured :], *signals)
            if n < number:
                self.plant.set(**{name: signals[index] for name, index in self._driven})
                self.plant.advance(self.step)

    def _steps(self, stop_time: float) -> int:
        number = whole_steps(stop_time, self.step)
        if not number:
            raise ValueError(
                f"stop_time must be a whole number of communication steps of {self.step:g} s, and at least"
                f" one, is {stop_time:g} s"
            )
        return number

    def run(self, stop_time: float, progress: Progress | None = None) -> Result:
        """Step to the stop time, s, and return the rows as a named table. Raises as rows does."""
        if isinstance(self.surroundings, Sources):
            number, first = self._steps(stop_time), 1 + len(self._outputs)
            rows = np.empty((number + 1, len(self.names)))
            rows[:, 0] = np.arange(number + 1) * self.step
            signals = rows[:, first:] = self.surroundings.table(rows[:, 0])
            inputs = {name: signals[:-1, index] for name, index in self._driven}
            run(self.plant, np.full(number, self.step), inputs, self._outputs, rows[:, 1:first], progress)
        else:
            rows = np.array(list(self.rows(stop_time, progress)))
        known = self._units | {name: BY_NAME[name].unit for name in self.names if name in BY_NAME}
        return Result.from_rows(self.names, rows, {name: known.get(name, "") for name in self.names[1:]})
