"""Connection of loads, controllers and sources to one system, the environment of an FMU, and its evaluation.

control.interconnect makes the system. During a run its laws are called directly, because python-control takes
ten times as long for a step of a connected system.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..common.errors import must_be
from .sources import Sources

if TYPE_CHECKING:
    import control as ct

    from .discrete_system import Law

__all__ = ["connect"]

Environment: TypeAlias = "Sources | ct.InputOutputSystem"


def connect(systems: Sequence[Environment]) -> Environment:
    """Connect systems by the names of their signals to one system, the environment of the FMU.

    Each input is connected to the output with the same name. Inputs without such an output are outputs of the
    FMU. The systems may be loads, controllers and sources of this package and any discrete-time systems of
    python-control, such as control.tf, control.ss or control.nlsys with names for inputs and outputs.

    Args:
        systems: Systems with equal steps and different names.

    Returns:
        A control.InterconnectedSystem whose outputs are all outputs of the systems; Sources if all systems
        are Sources.

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
    # A step of None or True in python-control means that the step of the other systems applies.
    if len({system.dt for system in systems if not (system.dt is None or system.dt is True)}) > 1:
        steps = ", ".join(f"{system.name} {_step_text(system.dt)}" for system in systems)
        raise ValueError(must_be("steps of the systems", "equal", steps))
    sources = [system for system in systems if isinstance(system, Sources)]
    if len(sources) == len(systems):
        signals = {name: signal for source in sources for name, signal in source.signals.items()}
        return Sources(signals, systems[0].dt)
    import control as ct

    labels = [label for system in systems for label in system.input_labels]
    return ct.interconnect(
        [system.system() if isinstance(system, Sources) else system for system in systems],
        inputs=[label for label in dict.fromkeys(labels) if label not in origin],
        outlist=[f"{name}.{label}" for label, name in origin.items()],
        outputs=list(origin),
        name="surroundings",
    )


def _step_text(step: float | bool | None) -> str:
    return "any step" if step is None or step is True else f"{step:g} s" if step else "continuous time"


# --- evaluation ---


def law_of(system: Environment) -> Law:
    """Return a function of time, s, states and inputs that returns outputs and next states of a system.

    The results are equal to python-control to the bit, except for the sign of zeros. The laws of this package
    are called directly, also within a connected system.

    Args:
        system: The system.
    """
    if isinstance(system, Sources):
        return system.law
    import control as ct

    from .discrete_system import DiscreteSystem

    if isinstance(system, DiscreteSystem):
        return system.law
    if isinstance(system, ct.InterconnectedSystem):
        wiring = _wiring_of(system)
        if wiring is not None:
            return _connected_law(system, wiring)
    return lambda time, x, u: (system.output(time, x, u), system.dynamics(time, x, u))


class _Wiring(NamedTuple):
    """Connections of an interconnected system, as places in the list of its inputs and all outputs inside.

    Attributes:
        inputs: Place of the signal at each input of the connected systems.
        outputs: Place of the signal at each output of the interconnected system.
    """

    inputs: list[int]
    outputs: list[int]


def _wiring_of(system: ct.InterconnectedSystem) -> _Wiring | None:
    """Return the connections of an interconnected system; None if one of them is a sum or has a gain."""
    inputs = _places(np.hstack([system.input_map, system.connect_map]))
    # The columns of output_map are the outputs of the connected systems, then their inputs.
    n_outputs = system.connect_map.shape[1]
    from_outputs = np.hstack([np.zeros((system.noutputs, system.ninputs)), system.output_map[:, :n_outputs]])
    outputs = None if system.output_map[:, n_outputs:].any() else _places(from_outputs)
    return None if inputs is None or outputs is None else _Wiring(inputs, outputs)


def _places(gains: NDArray[np.float64]) -> list[int] | None:
    """Return the column of the only entry, 1, in each row of a matrix; None if a row has other entries."""
    if not (np.count_nonzero(gains, axis=1) == 1).all() or not (gains.sum(axis=1) == 1.0).all():
        return None
    places: list[int] = gains.argmax(axis=1).tolist()
    return places


def _connected_law(system: ct.InterconnectedSystem, wiring: _Wiring) -> Law:
    """Return the law of an interconnected system, by fixed-point iteration as in python-control.

    The systems are evaluated in a fixed order until no input changes.

    Args:
        system: The interconnected system.
        wiring: Its connections.

    Raises:
        ValueError: At run time, if the systems have an algebraic loop.
    """
    parts, first_input, first_output, first_state = [], 0, system.ninputs, 0
    for part in system.syslist:
        end_input, end_output = first_input + part.ninputs, first_output + part.noutputs
        end_state = first_state + part.nstates
        inputs = wiring.inputs[first_input:end_input]
        parts.append((law_of(part), inputs, slice(first_output, end_output), slice(first_state, end_state)))
        first_input, first_output, first_state = end_input, end_output, end_state
    # Systems without inputs come first, so the others use their outputs in the first pass.
    order = sorted(enumerate(parts), key=lambda part: bool(part[1][1]))
    zeros, places = [0.0] * (first_output - system.ninputs), wiring.outputs

    def law(time: float, x: Sequence[float], u: Sequence[float]) -> tuple[list[float], list[float]]:
        values, next_states = [*u, *zeros], [0.0] * first_state
        last_inputs: list[list[float] | None] = [None] * len(parts)
        for _ in range(len(parts) + 1):
            is_converged = True
            for number, (part_law, inputs, outputs, states) in order:
                part_inputs = [values[place] for place in inputs]
                if part_inputs != last_inputs[number]:
                    last_inputs[number], is_converged = part_inputs, False
                    values[outputs], next_states[states] = part_law(time, x[states], part_inputs)
            if is_converged:
                return [values[place] for place in places], next_states
        raise ValueError(f"algebraic loop among {', '.join(system.output_labels)}")

    return law
