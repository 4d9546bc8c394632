"""FMU as a discrete-time system of python-control whose results depend only on state and input.

control.md describes the two kinds of state. An update of the system is a communication step. Outputs are
values at the end of the last step, so there is no direct feedthrough. The state contains step means, because
they do not follow from the motion at the end of the step.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import control as ct
import numpy as np
from numpy.typing import NDArray

from ..common.errors import must_be, unknown
from ..fmi.instance import Closing, Fmu, FmuError, RestartedFmu, as_names
from ..interface.models import DRIVEN_SHAFT, INERTIA_MODULE
from ..interface.variables import DRIVE_ANGLE, LINK1_ANGLE, SINCE_START
from ..kernel.codes import DRIVE_TORQUE, ELASTIC, RIGID

Array = NDArray[np.float64]

# state with the speed of link 1 of a torque-driven module, whose initial value is omega1
_INPUT_SPEED = "input_speed"
# bytes of a serialised state in each number
_NUMBER_BYTES = 4


# --- state: motion ---


def _is_driven_by_torque(fmu: Fmu) -> bool:
    return "drive" in fmu.variables and fmu["drive"] == DRIVE_TORQUE


def _motion_states(fmu: Fmu) -> tuple[str, ...]:
    """Return the names of the states of motion; raise FmuError if one of them has no start parameter."""
    if "input_hold" in fmu.variables and fmu["input_hold"] != 0.0:
        raise FmuError(
            "input_hold must be zero_order with state = 'motion' (got linear). Linear extrapolation depends"
            " on the last two inputs. Use state = 'whole'."
        )
    table, fidelity = DRIVEN_SHAFT.by_name, RIGID
    if "fidelity" in fmu.variables:
        table, fidelity = INERTIA_MODULE.by_name, int(fmu["fidelity"])
    if fidelity == ELASTIC:
        raise FmuError(
            "fidelity must be kinematic, averaged or rigid with state = 'motion' (got elastic). Not every"
            " speed and angle of elastic has a start parameter. Use state = 'whole'."
        )
    rows = [row for name, row in table.items() if f"{name}_start" in table]
    motion = sorted(row.name for row in rows if not any(fidelity in need.lacking for need in row.needs))
    return (*motion, _INPUT_SPEED) if _is_driven_by_torque(fmu) else tuple(motion)


def _check_outputs(names: Sequence[str], motion: Sequence[str]) -> None:
    """Raise FmuError for outputs that the states of motion do not determine."""
    for name in names:
        variable = INERTIA_MODULE.by_name.get(name) or DRIVEN_SHAFT.by_name.get(name)
        dependence = variable.follows if variable is not None else ""
        if dependence == SINCE_START:
            reason = "is a cumulative value since the start"
        elif dependence == LINK1_ANGLE or (dependence == DRIVE_ANGLE and "drive_angle" not in motion):
            reason = f"depends on {dependence}, which is not a state here ({', '.join(motion)})"
        else:
            continue
        raise FmuError(f"state must be 'whole' with output {name} (got 'motion'): the output {reason}")


class _MotionStepper:
    """Steps of state = 'motion': each step restarts the FMU from the motion, so nothing else affects it.

    Args:
        fmu: The FMU, initialised.
        step: Communication step, s.
        inputs: Names of the inputs.
        outputs: Names of the outputs.
    """

    def __init__(self, fmu: RestartedFmu, step: float, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.fmu, self._step, self._inputs = fmu, step, inputs
        self._motion = _motion_states(fmu)
        _check_outputs(outputs, self._motion)
        # Jumps of these inputs act impulsively, so the state contains their last values.
        self._held = tuple(name for name in inputs if name in ("omega1", "hub_speed"))
        self._read_names = (*self._motion, *(name for name in outputs if name not in self._motion))
        self._start_parameters = [
            "omega1" if name == _INPUT_SPEED else f"{name}_start" for name in self._motion
        ]
        held = [f"{name}_held" for name in self._held]
        self.names = [*self._motion, *held, *self._read_names[len(self._motion) :]]
        self._output_positions = np.array([self.names.index(name) for name in outputs], dtype=np.intp)
        self.start = self._state(fmu.read(self._held))

    def _state(self, held: Sequence[float]) -> Array:
        values = self.fmu.read(self._read_names)
        split = len(self._motion)
        return np.array([*values[:split], *held, *values[split:]])

    def update(self, time: float, x: Array, u: Array) -> Array:
        """Return the state after a step.

        Args:
            time: Time at the start of the step, s.
            x: State, shape (states,).
            u: Inputs, shape (inputs,).
        """
        inputs = dict(zip(self._inputs, u.tolist(), strict=True))
        motion = dict(zip(self._start_parameters, x.tolist(), strict=False))
        held = dict(zip(self._held, x[len(self._motion) :].tolist(), strict=False))
        try:
            self.fmu.restart({**motion, **inputs, **held}, time)
            self.fmu.set(**{name: inputs[name] for name in held})
        except FmuError as error:
            raise FmuError(f"at time {time:.9g} s: {error}") from error
        self.fmu.advance(self._step)
        return self._state([inputs[name] for name in held])

    def output(self, x: Array) -> Array:
        """Return the outputs, shape (outputs,).

        Args:
            x: State, shape (states,).
        """
        return x[self._output_positions]


# --- state: whole ---


def pack_bytes(data: bytes) -> Array:
    """Pack bytes as integers in doubles, shape (n,); the first number is the count of bytes.

    Integers avoid NaN, which the bytes themselves would contain if read as doubles.

    Args:
        data: The bytes.
    """
    integers = np.frombuffer(data + bytes(-len(data) % _NUMBER_BYTES), dtype="<u4")
    return np.concatenate([[float(len(data))], integers.astype(np.float64)])


def unpack_bytes(numbers: Array) -> bytes:
    """Unpack the bytes that pack_bytes packed.

    Args:
        numbers: Result of pack_bytes, shape (n,).

    Raises:
        ValueError: The numbers are no result of pack_bytes.
    """
    is_valid = (numbers >= 0.0) & (numbers < 2.0 ** (8 * _NUMBER_BYTES)) & (numbers == np.floor(numbers))
    capacity = (len(numbers) - 1) * _NUMBER_BYTES
    if not is_valid.all() or not capacity - _NUMBER_BYTES < numbers[0] <= capacity:
        place = int(np.argmin(is_valid))
        raise ValueError(
            f"a whole state must be unchanged (number {place} is {numbers[place]:.17g})."
            " States of state = 'motion' can be changed."
        )
    return numbers[1:].astype("<u4").tobytes()[: int(numbers[0])]


class _WholeStepper:
    """Steps of state = 'whole': the state is the serialised state of the FMU.

    The FMU remains in its last state, so a simulation without jumps restores no state.

    Args:
        fmu: The FMU, initialised.
        step: Communication step, s.
        inputs: Names of the inputs.
        outputs: Names of the outputs.
    """

    def __init__(self, fmu: Fmu, step: float, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.fmu, self._step, self._inputs, self._outputs = fmu, step, inputs, outputs
        fmu.read(outputs)
        self._current: Array | None = None
        self.start = self._save_state()
        self.names = ["time", *(f"state[{n}]" for n in range(self.start.size - 1))]

    def _save_state(self) -> Array:
        self._current = np.concatenate([[self.fmu.time], pack_bytes(self.fmu.save())])
        return self._current.copy()

    def _restore(self, x: Array) -> None:
        """Restore a state unless the FMU is in it; all zeros mean the initial state."""
        state = x if x.any() else self.start
        if self._current is None or not np.array_equal(state, self._current):
            self._current = None
            self.fmu.restore(unpack_bytes(state[1:]), float(state[0]))
            self._current = state.copy()

    def update(self, _: float, x: Array, u: Array) -> Array:
        """Return the state after a step.

        Args:
            _: Time, unused, because the state contains it.
            x: State, shape (states,).
            u: Inputs, shape (inputs,).
        """
        self._restore(x)
        self._current = None  # unknown until the step is complete
        self.fmu.set(**dict(zip(self._inputs, u.tolist(), strict=True)))
        self.fmu.advance(self._step)
        return self._save_state()

    def output(self, x: Array) -> Array:
        """Return the outputs, shape (outputs,).

        Args:
            x: State, shape (states,).
        """
        self._restore(x)
        return np.array(self.fmu.read(self._outputs))


# --- the system ---


class FmuSystem(Closing):
    """FMU as a system of python-control; a context manager, which closes the FMU.

    Args:
        stepper: Steps and states of the FMU, from fmu_system.
        names: Names of inputs, outputs and system for control.nlsys.

    Attributes:
        system: Discrete-time control.NonlinearIOSystem. Copies share the FMU. This is safe in one thread,
            because no result depends on earlier calls.
        start: Initial state, shape (states,): initial_state for input_output_response.
    """

    def __init__(self, stepper: _MotionStepper | _WholeStepper, **names: Any) -> None:
        self._fmu, self.start = stepper.fmu, stepper.start
        self.system = ct.nlsys(
            lambda t, x, u, _: stepper.update(
                t, np.asarray(x, dtype=np.float64), np.asarray(u, dtype=np.float64)
            ),
            lambda _, x, __, ___: stepper.output(np.asarray(x, dtype=np.float64)),
            states=stepper.names,
            **names,
        )

    def close(self) -> None:
        """Close the FMU; afterwards the system cannot be simulated."""
        self._fmu.close()


def _check_inputs(fmu: Fmu, inputs: Sequence[str]) -> None:
    """Raise FmuError for inputs that the FMU does not have, or that have no effect with its drive mode."""
    names = [name for name, variable in fmu.variables.items() if variable.causality == "input"]
    for name in inputs:
        if name not in names:
            raise FmuError(unknown("input", name, names))
    idle, required, drive = "drive_torque", "omega1", "speed"
    if _is_driven_by_torque(fmu):
        idle, required, drive = "omega1", "drive_torque", "torque"
    if idle in inputs:
        demand = must_be("an input", f"{required} with drive = {drive}", idle)
        raise FmuError(f"{demand}. {idle} has no effect after the start.")


def fmu_system(
    path: Path | str,
    parameters: Mapping[str, float | bool | str] | None = None,
    *,
    step: float,
    inputs: str | Sequence[str] = ("omega1", "load_torque"),
    outputs: str | Sequence[str] = ("omega_out", "input_torque_mean", "output_torque_mean"),
    start: Mapping[str, float] | None = None,
    tolerance: float | None = None,
    state: Literal["motion", "whole"] = "motion",
    name: str | None = None,
) -> FmuSystem:
    """Make a discrete-time NonlinearIOSystem from an FMU; results depend only on state and input.

    The finite differences of linearize (eps) must exceed the tolerance of the FMU. With a tolerance of 1e-10
    an eps of 1e-3 is suitable.

    Args:
        path: Path of the FMU file.
        parameters: Parameters by name, enumerations by number or item name. `..._start` parameters set the
            initial state of the system.
        step: Communication step and sampling time, s.
        inputs: Inputs of the FMU that are inputs of the system; others keep their start values. With the
            parameter drive = torque the input drive_torque replaces omega1, which is only the initial speed.
        outputs: Variables of the FMU that are outputs of the system.
        start: Start values of inputs by name.
        tolerance: Relative tolerance; None for the tolerance in the parameters.
        state: "motion" (states can be changed) or "whole" (bit-exact, available in every FMU).
        name: Name of the system; None for the name of the file.

    Returns:
        The system with its initial state; closing it closes the FMU.

    Raises:
        FmuError: The FMU, a name or a value is invalid, or the FMU does not support this state.
        ValueError: step is not positive, or state is invalid.
    """
    if not (math.isfinite(step) and step > 0.0):
        raise ValueError(must_be("step", "a positive number of seconds", step))
    if state not in ("motion", "whole"):
        raise ValueError(must_be("state", "'motion' or 'whole'", repr(state)))
    inputs, outputs = as_names(inputs), as_names(outputs)
    fmu_type, stepper_type = (RestartedFmu, _MotionStepper) if state == "motion" else (Fmu, _WholeStepper)
    fmu: Any = fmu_type(path, parameters, start, tolerance)
    try:
        _check_inputs(fmu, inputs)
        names = {"inputs": list(inputs), "outputs": list(outputs), "name": name or fmu.path.stem}
        return FmuSystem(stepper_type(fmu, step, inputs, outputs), dt=step, **names)
    except BaseException:
        fmu.close()
        raise
