"""Closed loop of an FMU and its environment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..common.errors import must_be
from ..common.terminal import Progress
from ..fmi.instance import as_names, run
from ..fmi.simulate import Plant, Result, whole_steps
from ..interface.variables import BY_NAME
from .connection import Environment, law_of
from .sources import Sources

__all__ = ["ClosedLoop", "initial_inputs"]

PLANT_INPUTS = ("omega1", "load_torque", "drive_torque")

# units of the signals of loads and controllers
SIGNAL_UNITS = {"vehicle_speed": "m/s", "distance": "m", "brake_force": "N", "load_speed": "rad/s"}
SIGNAL_UNITS |= dict.fromkeys(("drag_torque", "slope_torque", "rolling_torque", "brake_torque"), "N.m")


def initial_inputs(
    surroundings: Environment, measured: Mapping[str, float] | None = None
) -> dict[str, float]:
    """Return the inputs of the FMU at time 0, to set before the end of its initialisation.

    Args:
        surroundings: Environment of the FMU, from connect.
        measured: Initial outputs of the FMU that are not 0, by name.
    """
    outputs = measured or {}
    inputs = [outputs.get(label, 0.0) for label in surroundings.input_labels]
    values, _ = law_of(surroundings)(0.0, [0.0] * surroundings.nstates, inputs)
    signals = dict(zip(surroundings.output_labels, values, strict=True))
    return {name: float(signals[name]) for name in PLANT_INPUTS if name in signals}


class ClosedLoop:
    """Simulation of an FMU and its environment, with the step of the environment.

    Each step is a Gauss-Seidel iteration: read the FMU, advance the environment to this time, evaluate the
    outputs of the environment, set the inputs of the FMU, advance the FMU. The environment advances after the
    FMU over the same step. An undamped elastic coupling is therefore stable up to a natural frequency of 2 /
    step (see Load.check_step).

    Args:
        plant: An initialised FMU.
        surroundings: Environment of the FMU, from connect.
        outputs: Variables of the FMU to record in addition to the signals of the environment.
        units: Units of signals, by name, in addition to SIGNAL_UNITS.

    Raises:
        ValueError: No signal of the environment is an input of the FMU.
    """

    def __init__(
        self,
        plant: Plant,
        surroundings: Environment,
        outputs: str | Sequence[str] = (),
        units: Mapping[str, str] | None = None,
    ) -> None:
        self.plant = plant
        self.surroundings = surroundings
        self.step = float(surroundings.dt)
        signals: list[str] = surroundings.output_labels
        self._n_measured = len(surroundings.input_labels)
        self._outputs = [name for name in dict.fromkeys(as_names(outputs)) if name not in signals]
        self._plant_inputs = [(name, signals.index(name)) for name in PLANT_INPUTS if name in signals]
        if not self._plant_inputs:
            inputs = ", ".join(PLANT_INPUTS)
            raise ValueError(
                f"no output drives an input of the FMU ({inputs}); outputs: {', '.join(signals)}"
            )
        self.names = ("time", *self._outputs, *signals)
        self._units = {**SIGNAL_UNITS, **(units or {})}

    def run(self, stop_time: float, progress: Progress | None = None, substeps: int = 1) -> Result:
        """Simulate to the stop time and return a table with one row per communication point.

        Args:
            stop_time: Stop time, s.
            progress: Function called with the completed fraction of the run, 0 to 1.
            substeps: Steps of the FMU, and rows, per step of the environment. The environment is evaluated
                at the start of its step; an environment of sources alone is evaluated in each row.

        Raises:
            ValueError: The stop time is not a multiple of the step.
            FmuError: The FMU rejects a value or a step.
        """
        number, first = whole_steps(stop_time, self.step), 1 + len(self._outputs)
        if not number:
            allowed = f"a positive multiple of the communication step {self.step:g} s"
            raise ValueError(must_be("stop_time", allowed, f"{stop_time:g} s"))
        rows = np.empty((number * substeps + 1, len(self.names)))
        length = self.step / substeps
        rows[:, 0] = np.arange(len(rows)) * length
        if isinstance(self.surroundings, Sources):
            signals = rows[:, first:] = self.surroundings.table(rows[:, 0])
            inputs = {name: signals[:-1, index] for name, index in self._plant_inputs}
            lengths = np.full(len(rows) - 1, length)
            run(self.plant, lengths, inputs, self._outputs, rows[:, 1:first], progress)
        else:
            self._run_loop(rows, first, substeps, progress)
        units = self._units | {name: BY_NAME[name].unit for name in self.names if name in BY_NAME}
        return Result.from_rows(self.names, rows, {name: units.get(name, "") for name in self.names[1:]})

    def _run_loop(
        self, rows: NDArray[np.float64], first: int, substeps: int, progress: Progress | None
    ) -> None:
        """Simulate with an environment that depends on the FMU, and fill rows.

        Args:
            rows: Rows, shape (n, columns), with times in column 0.
            first: First column of the signals of the environment.
            substeps: Steps of the FMU per step of the environment.
            progress: Function called with the completed fraction of the run, 0 to 1.
        """
        number, systems = (len(rows) - 1) // substeps, self.surroundings
        law, has_states = law_of(systems), systems.nstates > 0
        report_every = max(number // 200, 1)
        read_names = [*systems.input_labels, *self._outputs]
        input_names = tuple(name for name, _ in self._plant_inputs)
        lengths = np.full(substeps, self.step / substeps)
        inputs = np.empty((substeps, len(input_names)))
        values = np.empty((substeps + 1, len(read_names)))
        values[-1] = self.plant.read(read_names)
        state: Sequence[float] = [0.0] * systems.nstates
        for n, time in enumerate(rows[::substeps, 0].tolist()):
            measured = values[-1, : self._n_measured].tolist()
            if n > 0 and has_states:
                _, state = law(time, state, measured)
            signals, _ = law(time, state, measured)
            begin = n * substeps
            rows[begin, 1:first] = values[-1, self._n_measured :]
            rows[begin : begin + substeps, first:] = signals
            if progress is not None and (n % report_every == 0 or n == number):
                progress(n / number)
            if n < number:
                inputs[:] = [signals[index] for _, index in self._plant_inputs]
                self.plant.take_steps(lengths, input_names, inputs, read_names, values)
                rows[begin + 1 : begin + substeps, 1:first] = values[1:-1, self._n_measured :]
