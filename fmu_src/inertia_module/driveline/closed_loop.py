"""Closed loop of an FMU with sources, controllers and loads, connected by the names of their signals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import must_be
from ..common.terminal import Progress
from ..fmi.instance import as_names, run
from ..fmi.simulate import Plant, Result, whole_steps
from ..interface.variables import BY_NAME
from .sources import Sampled, Sources

__all__ = ["ClosedLoop", "connect", "initial_inputs"]

PLANT_INPUTS = ("omega1", "load_torque", "drive_torque")

# units of the signals of loads and controllers
SIGNAL_UNITS = {"vehicle_speed": "m/s", "distance": "m", "brake_force": "N", "load_speed": "rad/s"}
SIGNAL_UNITS |= dict.fromkeys(("drag_torque", "slope_torque", "rolling_torque", "brake_torque"), "N.m")


def connect(systems: Sequence[Any]) -> Any:
    """Connect systems by the names of their signals to one system, the environment of the FMU.

    Each input is connected to the output with the same name. Inputs without such an output are outputs of the
    FMU. If systems of python-control are among the systems, control.interconnect connects all.

    Args:
        systems: Loads, controllers, sources and discrete-time python-control systems with equal steps and
            different names.

    Returns:
        A system whose outputs are all outputs of the systems: Sources if all are sources, a
        control.InterconnectedSystem with systems of python-control, else Sampled.

    Raises:
        ValueError: Two systems have an output of the same name, or the steps differ.
    """
    origin: dict[str, str] = {}
    for system in systems:
        for label in system.output_labels:
            if label in origin:
                names = f"{origin[label]} and {system.name}"
                raise ValueError(must_be(label, "the output of one system only", names))
            origin[label] = system.name
    outputs, labels = list(origin), [label for system in systems for label in system.input_labels]
    inputs = [label for label in dict.fromkeys(labels) if label not in origin]
    if not all(isinstance(system, Sampled) for system in systems):
        import control as ct

        return ct.interconnect(
            [system.to_control() if isinstance(system, Sampled) else system for system in systems],
            inputs=inputs,
            outlist=[f"{name}.{label}" for label, name in origin.items()],
            outputs=outputs,
            name="surroundings",
        )
    if len({system.dt for system in systems}) > 1:
        steps = ", ".join(f"{system.name} {system.dt:g} s" for system in systems)
        raise ValueError(must_be("steps of the systems", "equal", steps))
    if all(isinstance(system, Sources) for system in systems):
        signals = {name: signal for system in systems for name, signal in system.signals.items()}
        return Sources(signals, systems[0].dt)
    return _connect_sampled(systems, inputs, outputs)


def _connect_sampled(
    systems: Sequence[Sampled], free_inputs: Sequence[str], all_outputs: Sequence[str]
) -> Sampled:
    """Connect sampled systems; their laws are evaluated until no input changes (fixed-point iteration).

    Args:
        systems: The systems.
        free_inputs: Names of the inputs without a connected output.
        all_outputs: Names of all outputs, in the order of the systems.

    Raises:
        ValueError: At run time, if the systems have an algebraic loop.
    """
    places = {label: place for place, label in enumerate([*free_inputs, *all_outputs])}
    parts, outputs_from, states_from = [], len(free_inputs), 0
    for system in systems:
        outputs_to, states_to = outputs_from + len(system.output_labels), states_from + system.nstates
        inputs = [places[label] for label in system.input_labels]
        parts.append((system.law, inputs, slice(outputs_from, outputs_to), slice(states_from, states_to)))
        outputs_from, states_from = outputs_to, states_to
    # Systems without inputs come first, so the others use their outputs in the first pass.
    order = sorted(enumerate(parts), key=lambda part: bool(part[1][1]))

    def law(time: float, x: Any, u: Any) -> tuple[list[float], list[float]]:
        values, next_states = [*u, *[0.0] * len(all_outputs)], [0.0] * states_from
        last_inputs: list[list[float] | None] = [None] * len(parts)
        for _ in range(len(parts) + 1):
            is_converged = True
            for number, (part, inputs, outputs, states) in order:
                part_inputs = [values[place] for place in inputs]
                if part_inputs != last_inputs[number]:
                    last_inputs[number], is_converged = part_inputs, False
                    values[outputs], next_states[states] = part(time, x[states], part_inputs)
            if is_converged:
                return values[len(free_inputs) :], next_states
        raise ValueError(f"algebraic loop among {', '.join(all_outputs)}")

    names = [f"{system.name}_{label}" for system in systems for label in system.state_labels]
    return Sampled("surroundings", systems[0].dt, free_inputs, all_outputs, law, names)


def initial_inputs(surroundings: Any, measured: Mapping[str, float] | None = None) -> dict[str, float]:
    """Return the inputs of the FMU at time 0, to set before the end of its initialisation.

    Args:
        surroundings: Environment of the FMU, from connect.
        measured: Initial outputs of the FMU that are not 0, by name.
    """
    outputs = measured or {}
    inputs = np.array([outputs.get(label, 0.0) for label in surroundings.input_labels])
    values = surroundings.output(0.0, np.zeros(surroundings.nstates), inputs)
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
        surroundings: Any,
        outputs: str | Sequence[str] = (),
        units: Mapping[str, str] | None = None,
    ) -> None:
        self.plant = plant
        self.surroundings = surroundings
        self.step = float(surroundings.dt)
        signals: list[str] = surroundings.output_labels
        self._n_measured = len(surroundings.input_labels)
        self._outputs = [name for name in dict.fromkeys(as_names(outputs)) if name not in signals]
        self._driven = [(name, signals.index(name)) for name in PLANT_INPUTS if name in signals]
        if not self._driven:
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
            inputs = {name: signals[:-1, index] for name, index in self._driven}
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
        report_every = max(number // 200, 1)
        names, driven = [*systems.input_labels, *self._outputs], tuple(name for name, _ in self._driven)
        lengths = np.full(substeps, self.step / substeps)
        inputs, ends = np.empty((substeps, len(driven))), np.empty((substeps + 1, len(names)))
        ends[-1] = self.plant.read(names)
        state: Any = [0.0] * systems.nstates
        for n, time in enumerate(rows[::substeps, 0].tolist()):
            measured = ends[-1, : self._n_measured].tolist()
            if n > 0 and systems.nstates:
                state = systems.dynamics(time, state, measured)
            signals = systems.output(time, state, measured)
            begin = n * substeps
            rows[begin, 1:first] = ends[-1, self._n_measured :]
            rows[begin : begin + substeps, first:] = signals
            if progress is not None and (n % report_every == 0 or n == number):
                progress(n / number)
            if n < number:
                inputs[:] = [signals[index] for _, index in self._driven]
                self.plant.take_steps(lengths, driven, inputs, names, ends)
                rows[begin + 1 : begin + substeps, 1:first] = ends[1:-1, self._n_measured :]
