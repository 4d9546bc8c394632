"""FMU as a discrete-time system of python-control, pure in its state (docs/control.md has its two kinds).

A communication step is the update of the system. Outputs hold the values at the end of the last step, so
there is no direct feedthrough. Step means do not follow from where the motion is now, so the state has them.
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
from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE
from ..contract.variables import DRIVE_ANGLE, LINK1_ANGLE, SINCE_START
from ..harness.fmu import Closing, Fmu, FmuError, RestartedFmu, as_names
from ..kernel.codes import DRIVE_TORQUE, ELASTIC, RIGID

Array = NDArray[np.float64]

# speed of link 1 where a torque drives the module, which starts at omega1
_INPUT_SPEED = "input_speed"
# of a whole state in each number
_BYTES = 4


# --- state: motion ---


def _is_driven_by_torque(fmu: Fmu) -> bool:
    return "drive" in fmu.variables and fmu["drive"] == DRIVE_TORQUE


def _motion_of(fmu: Fmu) -> tuple[str, ...]:
    """Return the names of the motion; raise FmuError if the FMU lacks start parameters for a part of it."""
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
    started = [one for name, one in table.items() if f"{name}_start" in table]
    motion = sorted(one.name for one in started if not any(fidelity in need.lacking for need in one.needs))
    return (*motion, _INPUT_SPEED) if _is_driven_by_torque(fmu) else tuple(motion)


def _check_outputs(names: Sequence[str], motion: Sequence[str]) -> None:
    """Raise FmuError for outputs of a system that do not follow from its motion."""
    for name in names:
        variable = INERTIA_MODULE.by_name.get(name) or DRIVEN_SHAFT.by_name.get(name)
        follows = variable.follows if variable is not None else ""
        if follows == SINCE_START:
            why = "is a cumulative value since the start"
        elif follows == LINK1_ANGLE or (follows == DRIVE_ANGLE and "drive_angle" not in motion):
            why = f"depends on {follows}, which is not a state here ({', '.join(motion)})"
        else:
            continue
        raise FmuError(f"state must be 'whole' with output {name} (got 'motion'): the output {why}")


class _Motion:
    """Steps from the motion, by a fresh start each: nothing outside of it can matter."""

    def __init__(self, fmu: RestartedFmu, step: float, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.fmu, self._step, self._inputs = fmu, step, inputs
        self._motion = _motion_of(fmu)
        _check_outputs(outputs, self._motion)
        # inputs whose jumps act impulsively
        self._held = tuple(name for name in inputs if name in ("omega1", "hub_speed"))
        self._read = (*self._motion, *(name for name in outputs if name not in self._motion))
        self._start_names = ["omega1" if name == _INPUT_SPEED else f"{name}_start" for name in self._motion]
        held = [f"{name}_held" for name in self._held]
        self.names = [*self._motion, *held, *self._read[len(self._motion) :]]
        self._places = np.array([self.names.index(name) for name in outputs], dtype=np.intp)
        self.start = self._state(fmu.read(self._held))

    def _state(self, held: Sequence[float]) -> Array:
        values = self.fmu.read(self._read)
        split = len(self._motion)
        return np.array([*values[:split], *held, *values[split:]])

    def update(self, time: float, x: Array, u: Array) -> Array:
        """State after a step that begins at a time, s."""
        inputs = dict(zip(self._inputs, u.tolist(), strict=True))
        motion = dict(zip(self._start_names, x.tolist(), strict=False))
        held = dict(zip(self._held, x[len(self._motion) :].tolist(), strict=False))
        try:
            self.fmu.restart({**motion, **inputs, **held}, time)
            self.fmu.set(**{name: inputs[name] for name in held})
        except FmuError as error:
            raise FmuError(f"at time {time:.9g} s: {error}") from error
        self.fmu.advance(self._step)
        return self._state([inputs[name] for name in held])

    def output(self, x: Array) -> Array:
        """Outputs of a state."""
        return x[self._places]


# --- state: whole ---


def numbers_of(data: bytes) -> Array:
    """Pack bytes as whole numbers, shape (n,), the first their count; read as doubles they would hold NaN."""
    padded = np.frombuffer(data + bytes(-len(data) % _BYTES), dtype="<u4")
    return np.concatenate([[float(len(data))], padded.astype(np.float64)])


def bytes_of(numbers: Array) -> bytes:
    """Unpack the bytes of numbers_of; raise ValueError for numbers that it has not returned."""
    whole = (numbers >= 0.0) & (numbers < 2.0 ** (8 * _BYTES)) & (numbers == np.floor(numbers))
    count = (len(numbers) - 1) * _BYTES
    if not whole.all() or not count - _BYTES < numbers[0] <= count:
        place = int(np.argmin(whole))
        raise ValueError(
            f"a whole state must be unchanged (number {place} is {numbers[place]:.17g})."
            " States of state = 'motion' can be changed."
        )
    return numbers[1:].astype("<u4").tobytes()[: int(numbers[0])]


class _Whole:
    """Steps on from serialised states. The FMU stays at the state it gave last, so a run restores none."""

    def __init__(self, fmu: Fmu, step: float, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.fmu, self._step, self._inputs, self._outputs = fmu, step, inputs, outputs
        fmu.read(outputs)
        self._at: Array | None = None
        self.start = self._saved()
        self.names = ["time", *(f"state[{n}]" for n in range(self.start.size - 1))]

    def _saved(self) -> Array:
        self._at = np.concatenate([[self.fmu.time], numbers_of(self.fmu.save())])
        return self._at.copy()

    def _go_to(self, x: Array) -> None:
        """Take over a state; all zeros, the default of python-control, mean the start."""
        wanted = x if x.any() else self.start
        if self._at is None or not np.array_equal(wanted, self._at):
            self._at = None
            self.fmu.restore(bytes_of(wanted[1:]), float(wanted[0]))
            self._at = wanted.copy()

    def update(self, _: float, x: Array, u: Array) -> Array:
        """State after a step; its time is in the state."""
        self._go_to(x)
        self._at = None  # until the step has been taken
        self.fmu.set(**dict(zip(self._inputs, u.tolist(), strict=True)))
        self.fmu.advance(self._step)
        return self._saved()

    def output(self, x: Array) -> Array:
        """Outputs of a state."""
        self._go_to(x)
        return np.array(self.fmu.read(self._outputs))


# --- the system ---


class FmuSystem(Closing):
    """FMU as a system of python-control; a context manager, which closes the FMU.

    Attributes:
        system: control.NonlinearIOSystem in discrete time. Copies of it share the FMU, which is safe: no
            result depends on what was computed before (but one thread at a time).
        start: state at the start, shape (states,): initial_state for input_output_response.
    """

    def __init__(self, stepper: _Motion | _Whole, **names: Any) -> None:
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
        """Free the FMU; the system cannot be stepped after that."""
        self._fmu.close()


def _check_inputs(fmu: Fmu, inputs: Sequence[str]) -> None:
    """Raise FmuError for inputs that the FMU does not have, or that have no effect with its drive."""
    known = [name for name, variable in fmu.variables.items() if variable.causality == "input"]
    for name in inputs:
        if name not in known:
            raise FmuError(unknown("input", name, known))
    idle, needed, drive = "drive_torque", "omega1", "speed"
    if _is_driven_by_torque(fmu):
        idle, needed, drive = "omega1", "drive_torque", "torque"
    if idle in inputs:
        demand = must_be("an input", f"{needed} with drive = {drive}", idle)
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
    """Make an FMU a discrete-time NonlinearIOSystem: same state and input, same result, whatever came before.

    Finite differences of linearize (eps) have to be larger than the tolerance of the FMU: with a tolerance of
    1e-10 an eps of 1e-3 is good.

    Args:
        path: the .fmu file. step: communication step and sampling time, s.
        parameters: by name, enumerations by number or item name; `..._start` values make the start of the
            system.
        inputs: inputs of the FMU that are inputs of the system; others stay at their start values. With the
            parameter drive = torque drive_torque takes the place of omega1, which is only the start then.
        outputs: variables of the FMU that are outputs of the system. start: values of inputs at the start.
        tolerance: relative tolerance, or None for that of the parameters.
        state: "motion", which can be changed, or "whole", exact to the bit, which every FMU has.
        name: of the system; that of the file by default.

    Returns:
        The system, its start, and what closes it.

    Raises:
        FmuError: the FMU, a name or a value is invalid, or the FMU has no such state.
        ValueError: step is not positive, or state is neither of the two.
    """
    if not (math.isfinite(step) and step > 0.0):
        raise ValueError(must_be("step", "a positive number of seconds", step))
    if state not in ("motion", "whole"):
        raise ValueError(must_be("state", "'motion' or 'whole'", repr(state)))
    inputs, outputs = as_names(inputs), as_names(outputs)
    kind, stepper = (RestartedFmu, _Motion) if state == "motion" else (Fmu, _Whole)
    fmu: Any = kind(path, parameters, start, tolerance)
    try:
        _check_inputs(fmu, inputs)
        names = {"inputs": list(inputs), "outputs": list(outputs), "name": name or fmu.path.stem}
        return FmuSystem(stepper(fmu, step, inputs, outputs), dt=step, **names)
    except BaseException:
        fmu.close()
        raise
