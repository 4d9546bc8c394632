"""An FMU as a discrete-time system of python-control, pure in its state.

A communication step is the update of the system. Outputs hold the values at the end of the last step, so
there is no direct feedthrough. Step means belong to the step that has been taken and do not follow from
where the motion is now: they are part of the state. There are two states.

**motion.** A few named numbers: what the motion is (`omega_out`; for fidelity rigid `drive_angle`,
`omega2` and `omega_out`; for DrivenShaft `omega_out` and `twist`), the speed the input was left at
(a new one is a jump, and a jump is an impulse), and the outputs of the last step. Every update starts the FMU
anew from these, through its start parameters: nothing outside of them can matter. A module driven by torque
has `input_speed` among its motion in the place of the speed the input was left at. It is the state for
find_operating_point and linearize. Against stepping on, a restart loses what rounding was carried along and
the step size of the integration: results agree within the tolerance, not to the bit.

**whole.** The serialised state of the FMU, some 3200 numbers. Exact to the bit and good for every FMU,
fidelity `elastic` (which has no start parameters for its twist) and `input_hold` linear, but it can only be
passed on: no part of it can be changed, so it cannot be linearised.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import control as ct
import numpy as np
from numpy.typing import NDArray

from ..common.errors import must_be
from ..harness.fmu import Closing, Fmu, RestartedFmu, as_names
from .motion import check_inputs, check_outputs, motion_of, start_name
from .packing import bytes_of, numbers_of

Array = NDArray[np.float64]
StateKind = Literal["motion", "whole"]

# inputs whose jumps act impulsively
_SPEEDS = ("omega1", "hub_speed")


class _Motion:
    """Steps from the motion, by a fresh start each."""

    def __init__(self, fmu: RestartedFmu, step: float, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.fmu, self._step, self._inputs = fmu, step, tuple(inputs)
        self._motion = motion_of(fmu)
        check_outputs(outputs, self._motion)
        self._held = tuple(name for name in inputs if name in _SPEEDS)
        self._read = (*self._motion, *(name for name in outputs if name not in self._motion))
        self._start_names = tuple(start_name(name) for name in self._motion)
        carried = self._read[len(self._motion) :]
        self.names = [*self._motion, *(f"{name}_held" for name in self._held), *carried]
        places = [self.names.index(name) for name in outputs]
        self._places = np.array(places, dtype=np.intp)
        self.start = self._state(fmu.read(self._held))

    def _state(self, held: Sequence[float]) -> Array:
        values = self.fmu.read(self._read)
        split = len(self._motion)
        return np.array([*values[:split], *held, *values[split:]])

    def update(self, x: Array, u: Array) -> Array:
        """State after a step."""
        given = dict(zip(self._inputs, u.tolist(), strict=True))
        motion = dict(zip(self._start_names, x.tolist(), strict=False))
        held = dict(zip(self._held, x[len(self._motion) :].tolist(), strict=False))
        self.fmu.restart({**motion, **given, **held})
        self.fmu.set(**{name: given[name] for name in held})
        self.fmu.advance(self._step)
        return self._state([given[name] for name in held])

    def output(self, x: Array) -> Array:
        """Outputs of a state."""
        return x[self._places]


class _Whole:
    """Steps on from serialised states. The FMU stays at the state it gave last, so a run restores none."""

    def __init__(self, fmu: Fmu, step: float, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.fmu, self._step, self._inputs, self._outputs = fmu, step, tuple(inputs), tuple(outputs)
        fmu.read(self._outputs)
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

    def update(self, x: Array, u: Array) -> Array:
        """State after a step."""
        self._go_to(x)
        self._at = None  # until the step has been taken
        self.fmu.set(**dict(zip(self._inputs, u.tolist(), strict=True)))
        self.fmu.advance(self._step)
        return self._saved()

    def output(self, x: Array) -> Array:
        """Outputs of a state."""
        self._go_to(x)
        return np.array(self.fmu.read(self._outputs))


class FmuSystem(Closing):
    """An FMU as a system of python-control; a context manager, which closes the FMU.

    Attributes:
        system: control.NonlinearIOSystem in discrete time. Copies of it share the FMU, which is safe: no
            result depends on what was computed before (but one thread at a time).
        start: state at the start, shape (states,): initial_state for input_output_response.
    """

    def __init__(
        self,
        fmu: Fmu,
        stepper: _Motion | _Whole,
        step: float,
        inputs: Sequence[str],
        outputs: Sequence[str],
        name: str,
    ) -> None:
        self._fmu = fmu
        self.start = stepper.start

        def update(_: float, x: Any, u: Any, __: Any) -> Any:
            return stepper.update(np.asarray(x, dtype=np.float64), np.asarray(u, dtype=np.float64))

        def output(_: float, x: Any, __: Any, ___: Any) -> Any:
            return stepper.output(np.asarray(x, dtype=np.float64))

        self.system = ct.nlsys(
            update,
            output,
            inputs=list(inputs),
            outputs=list(outputs),
            states=stepper.names,
            dt=step,
            name=name,
        )

    def close(self) -> None:
        """Free the FMU; the system cannot be stepped after that."""
        self._fmu.close()


def fmu_system(
    path: Path | str,
    parameters: Mapping[str, float | bool | str] | None = None,
    *,
    step: float,
    inputs: str | Sequence[str] = ("omega1", "load_torque"),
    outputs: str | Sequence[str] = ("omega_out", "input_torque_mean", "output_torque_mean"),
    start: Mapping[str, float] | None = None,
    tolerance: float | None = None,
    state: StateKind = "motion",
    name: str | None = None,
) -> FmuSystem:
    """An FMU as a discrete-time NonlinearIOSystem: same state and input, same result, whatever came before.

    Finite differences of linearize (eps) have to be larger than the tolerance of the FMU: with a tolerance of
    1e-10 an eps of 1e-3 is good.

    Args:
        path: the .fmu file.
        parameters: by name, enumerations by number or item name; `..._start` values make the start of the
            system.
        step: communication step and sampling time, s.
        inputs: inputs of the FMU that are inputs of the system; others stay at their start values. With the
            parameter drive = torque drive_torque takes the place of omega1, which is only the start then.
        outputs: variables of the FMU that are outputs of the system.
        start: values of inputs at the start.
        tolerance: relative tolerance, or None for that of the parameters.
        state: "motion" or "whole": what the state is, see the head of this module.
        name: of the system; that of the file by default.

    Returns:
        The system, its start, and what closes it.

    Raises:
        FmuError: the FMU, a name or a value is refused, or the FMU has no such state.
        ValueError: step is not positive, or state is neither of the two.
    """
    if not (math.isfinite(step) and step > 0.0):
        raise ValueError(must_be("step", "a positive number of seconds", step))
    if state not in ("motion", "whole"):
        raise ValueError(must_be("state", "'motion' or 'whole'", repr(state)))
    inputs, outputs = as_names(inputs), as_names(outputs)
    kind = RestartedFmu if state == "motion" else Fmu
    fmu = kind(path, parameters, start, tolerance)
    try:
        check_inputs(fmu, inputs)
        stepper: _Motion | _Whole
        if isinstance(fmu, RestartedFmu):
            stepper = _Motion(fmu, step, inputs, outputs)
        else:
            stepper = _Whole(fmu, step, inputs, outputs)
        return FmuSystem(fmu, stepper, step, inputs, outputs, name or fmu.path.stem)
    except BaseException:
        fmu.close()
        raise
