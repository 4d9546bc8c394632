"""The loop: sources, controllers and loads, connected by the names of their signals, around an FMU."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import must_be
from ..common.terminal import Progress
from ..contract.variables import BY_NAME
from ..harness.fmu import as_names, run
from ..harness.simulate import Plant, Result, whole_steps
from .sources import Sampled, Sources

__all__ = ["ClosedLoop", "connect", "initial_inputs"]

PLANT_INPUTS = ("omega1", "load_torque", "drive_torque")

# units of the signals that sources, controllers and loads bring along
SIGNAL_UNITS = {"vehicle_speed": "m/s", "distance": "m", "brake_force": "N", "load_speed": "rad/s"}
SIGNAL_UNITS |= dict.fromkeys(("drag_torque", "slope_torque", "rolling_torque", "brake_torque"), "N.m")


def connect(systems: Sequence[Any]) -> Any:
    """Connect systems by the names of their signals to the one system around the FMU.

    An input of one is driven by the output of the same name of another; inputs that none drives are
    outputs of the FMU. Systems of python-control go in as well; control.interconnect then connects all.

    Args:
        systems: loads, controllers, sources and discrete-time python-control systems of one step, each with a
            name of its own.

    Returns:
        A system whose outputs are all outputs of the systems: Sampled, of sources alone Sources, with one of
        python-control among them a control.InterconnectedSystem.

    Raises:
        ValueError: two systems give the same signal, or their steps differ.
    """
    origin: dict[str, str] = {}
    for system in systems:
        for label in system.output_labels:
            if label in origin:
                both = f"{origin[label]} and {system.name}"
                raise ValueError(must_be(label, "the output of one system only", both))
            origin[label] = system.name
    given, labels = list(origin), [label for system in systems for label in system.input_labels]
    wanted = [label for label in dict.fromkeys(labels) if label not in origin]
    if not all(isinstance(system, Sampled) for system in systems):
        import control as ct

        return ct.interconnect(
            [system.to_control() if isinstance(system, Sampled) else system for system in systems],
            inputs=wanted,
            outlist=[f"{name}.{label}" for label, name in origin.items()],
            outputs=given,
            name="surroundings",
        )
    if len({system.dt for system in systems}) > 1:
        steps = ", ".join(f"{system.name} {system.dt:g} s" for system in systems)
        raise ValueError(must_be("steps of the systems", "equal", steps))
    if all(isinstance(system, Sources) for system in systems):
        signals = {name: signal for system in systems for name, signal in system.signals.items()}
        return Sources(signals, systems[0].dt)
    return _surroundings(systems, wanted, given)


def _surroundings(systems: Sequence[Sampled], wanted: Sequence[str], given: Sequence[str]) -> Sampled:
    """Connect systems, from signals wanted to those given, by laws evaluated until no input changes."""
    places = {label: place for place, label in enumerate([*wanted, *given])}
    parts, outputs_from, states_from = [], len(wanted), 0
    for system in systems:
        outputs_to, states_to = outputs_from + len(system.output_labels), states_from + system.nstates
        inputs = [places[label] for label in system.input_labels]
        parts.append((system.law, inputs, slice(outputs_from, outputs_to), slice(states_from, states_to)))
        outputs_from, states_from = outputs_to, states_to
    # what nothing drives first: the others then have it at once
    numbered = sorted(enumerate(parts), key=lambda part: bool(part[1][1]))

    def law(time: float, x: Any, u: Any) -> tuple[list[float], list[float]]:
        values, following = [*u, *[0.0] * len(given)], [0.0] * states_from
        seen: list[list[float] | None] = [None] * len(parts)
        for _ in range(len(parts) + 1):
            settled = True
            for number, (part, inputs, outputs, states) in numbered:
                now = [values[place] for place in inputs]
                if now != seen[number]:
                    seen[number], settled = now, False
                    values[outputs], following[states] = part(time, x[states], now)
            if settled:
                return values[len(wanted) :], following
        raise ValueError(f"algebraic loop among {', '.join(given)}")

    names = [f"{system.name}_{label}" for system in systems for label in system.state_labels]
    return Sampled("surroundings", systems[0].dt, wanted, given, law, names)


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
            inputs = ", ".join(PLANT_INPUTS)
            raise ValueError(
                f"no output drives an input of the FMU ({inputs}); outputs: {', '.join(signals)}"
            )
        self.names = ("time", *self._outputs, *signals)
        self._units = {**SIGNAL_UNITS, **(units or {})}

    def run(self, stop_time: float, progress: Progress | None = None, substeps: int = 1) -> Result:
        """Step to the stop time and return a row a communication point as a named table.

        Args:
            stop_time: s.
            progress: called with the share of the run that is done, 0 to 1.
            substeps: steps of the FMU, and rows, in a step of the surroundings, which are evaluated at its
                begin. Sources alone are evaluated in each row.

        Raises:
            ValueError: the stop time is not a whole number of steps.
            FmuError: the FMU rejects a value or a step.
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
            self._close(rows, first, substeps, progress)
        known = self._units | {name: BY_NAME[name].unit for name in self.names if name in BY_NAME}
        return Result.from_rows(self.names, rows, {name: known.get(name, "") for name in self.names[1:]})

    def _close(self, rows: NDArray[np.float64], first: int, substeps: int, progress: Progress | None) -> None:
        """Fill rows whose times are given; columns from first on are the signals of the surroundings."""
        number, systems = (len(rows) - 1) // substeps, self.surroundings
        report_every = max(number // 200, 1)
        names, driven = [*systems.input_labels, *self._outputs], tuple(name for name, _ in self._driven)
        lengths = np.full(substeps, self.step / substeps)
        given, ends = np.empty((substeps, len(driven))), np.empty((substeps + 1, len(names)))
        ends[-1] = self.plant.read(names)
        state: Any = [0.0] * systems.nstates
        for n, time in enumerate(rows[::substeps, 0].tolist()):
            measured = ends[-1, : self._measured].tolist()
            if n > 0 and systems.nstates:
                state = systems.dynamics(time, state, measured)
            signals = systems.output(time, state, measured)
            begin = n * substeps
            rows[begin, 1:first] = ends[-1, self._measured :]
            rows[begin : begin + substeps, first:] = signals
            if progress is not None and (n % report_every == 0 or n == number):
                progress(n / number)
            if n < number:
                given[:] = [signals[index] for _, index in self._driven]
                self.plant.take_steps(lengths, driven, given, names, ends)
                rows[begin + 1 : begin + substeps, 1:first] = ends[1:-1, self._measured :]
