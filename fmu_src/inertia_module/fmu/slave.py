"""The Python slave: FMI calls as pythonfmu passes them on, over one model in memory.

Nothing may be raised out of a callback: pythonfmu turns it into fmi2Fatal and corrupts memory. What
is refused is logged: the library in front (front/front.c) answers a call by the worst status logged in it.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable
from typing import Any, ClassVar

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from ..common.errors import Refused, must_be
from ..contract.variables import BOOLEAN, INPUT, PARAMETER, REAL, Variable
from ..kernel import codes
from ..memory import NO_STATE, ModelInstance, Module

INSTANTIATED = "instantiated"
INITIALIZING = "in initialization mode"
STEPPING = "initialized"
REFUSED = "in error since initialization"
TERMINATED = "terminated"

_PHASES = (INSTANTIATED, INITIALIZING, STEPPING, REFUSED, TERMINATED)
# bytes in front of the state of the model: phase, tolerance and stop time
HEAD_SIZE = 17
# a step may end past the stop time by this share of it, or of a second, as in shell/stepping.c
NEAR_STOP = 1e-5
_UNKNOWN = Variable("unknown", "", "", "", kind="")


class PythonSlave(Fmi2Slave):  # type: ignore[misc]
    """A model behind the FMI 2.0 interface of pythonfmu; subclasses say which."""

    instance_type: ClassVar[type[ModelInstance]]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._instance = self.instance_type("auto")
        self._variables = self._instance.model.variables
        self._phase = INSTANTIATED
        self._tolerance: float | None = None
        self._stop_time = math.inf
        # in initialization mode: whether the outputs follow from the values set
        self._calculated = False
        # value reference -> numbers of its record, and place there
        self._places: list[tuple[Any, int]] = [
            (self._instance.record(one.name).numbers, self._instance.model.place(one.name))
            for one in self._variables
        ]
        self._reals = {
            reference: place
            for reference, place in enumerate(self._places)
            if self._variables[reference].kind == REAL
        }

    def _say(self, message: str, status: Fmi2Status) -> None:
        # the text is used as a printf format
        self.log(message.replace("%", "%%"), status)

    def _out_of_order(self, call: str, allowed: str) -> None:
        self._say(f"{call} must come {allowed}, the instance is {self._phase}", Fmi2Status.error)

    def _refuse(self, message: str) -> None:
        """Log a refusal and refuse every step from now on."""
        self._phase = REFUSED
        self._say(message, Fmi2Status.error)

    def _guarded(self, action: Callable[[], None]) -> None:
        """Run an action; whatever goes wrong becomes a refusal."""
        try:
            action()
        except Refused as error:
            self._refuse(str(error))
        except Exception as error:
            self._refuse(f"internal error: {type(error).__name__}: {error}")

    # -- initialisation ------------------------------------------------------------------------------

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Take over the stop time and the tolerance: it wins over the parameter, where the model has one."""
        if self._phase != INSTANTIATED:
            self._out_of_order("setupExperiment", "before enterInitializationMode")
            return
        if stop_time is not None and not stop_time >= start_time:
            self._say(
                must_be("stop time", f"at least the start time {start_time:.16g} s", stop_time),
                Fmi2Status.error,
            )
            return
        self._tolerance = tolerance
        self._stop_time = math.inf if stop_time is None else stop_time

    def enter_initialization_mode(self) -> None:
        """Load the kernel; say so when that will take a while."""
        if self._phase != INSTANTIATED:
            self._out_of_order("enterInitializationMode", "right after instantiation or reset")
            return
        self._phase = INITIALIZING

        def load() -> None:
            self._instance.load_kernel()
            self._say(f"the kernel is {self._instance.kernel}", Fmi2Status.ok)

        self._guarded(load)

    def exit_initialization_mode(self) -> None:
        """Check the parameters, alone and together, and take the initial state."""
        if self._phase != INITIALIZING:
            self._out_of_order("exitInitializationMode", "after enterInitializationMode")
            return
        self._phase = STEPPING
        self._guarded(self._start)
        if self._phase is STEPPING:
            self._guarded(self._warn)

    def _warn(self) -> None:
        for message in self._instance.warnings():
            self._say(message, Fmi2Status.warning)

    def _start(self) -> None:
        tolerance = self._instance.model.by_name.get("tolerance")
        if self._tolerance is not None and tolerance is not None:
            self._instance.parameters.tolerance = self._tolerance
        self._instance.start()

    def _calculate(self) -> None:
        """In initialization mode: let the outputs follow from the values set so far."""
        self._calculated = True
        try:
            self._start()
        except Exception as error:
            self._say(str(error), Fmi2Status.discard)

    def terminate(self) -> None:
        """Outputs stay readable, steps and inputs are refused."""
        if self._phase is STEPPING:
            self._phase = TERMINATED
        else:
            self._out_of_order("terminate", "after exitInitializationMode")

    # -- stepping ------------------------------------------------------------------------------------

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance by step_size, s; False (fmi2Discard) leaves the state as it was."""
        try:
            if self._phase is not STEPPING:
                self._out_of_order("doStep", "after exitInitializationMode")
                return False
            stop = self._stop_time
            if current_time + step_size > stop + NEAR_STOP * max(1.0, abs(stop)):
                step = f"{step_size:.16g} s from {current_time:.16g} s"
                message = f"a step must end at the stop time {stop:.16g} s at the latest, is one of {step}"
                self._say(message, Fmi2Status.error)
                return False
            instance = self._instance
            status = instance.call(codes.STEP, step_size) if math.isfinite(current_time) else codes.BAD_STEP
            if status == codes.OK:
                return True
            if status == codes.BAD_STEP and not math.isfinite(current_time):
                message = must_be("communication point", "a finite number of seconds", current_time)
            else:
                message = instance.explain(status, step_size)
            self._say(message, Fmi2Status.discard)
        except Exception as error:
            self._refuse(f"internal error: {type(error).__name__}: {error}")
        return False

    # -- values --------------------------------------------------------------------------------------

    def _variable(self, reference: int) -> Variable:
        return self._variables[reference] if 0 <= reference < len(self._variables) else _UNKNOWN

    def _get(self, references: list[int], kinds: tuple[str, ...], missing: float) -> list[float]:
        if self._phase is INITIALIZING and not self._calculated:
            self._calculate()
        values = []
        for reference in references:
            variable = self._variable(reference)
            if variable.kind in kinds:
                place, slot = self._places[reference]
                values.append(place[slot])
            else:
                self._say(_no_reference(reference, kinds[0]), Fmi2Status.error)
                values.append(missing)
        return values

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values of Real variables (NaN for a reference that is none)."""
        reals = self._reals
        if self._phase is INITIALIZING and not self._calculated:
            self._calculate()
        try:
            return [place[slot] for place, slot in [reals[reference] for reference in vrs]]
        except KeyError:
            return self._get(vrs, (REAL,), math.nan)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Values of Integer and Enumeration variables (0 for a reference that is none)."""
        return [_int32(value) for value in self._get(vrs, ("Integer", "Enumeration"), 0.0)]

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Values of Boolean variables (False for a reference that is none)."""
        return [value != 0.0 for value in self._get(vrs, (BOOLEAN,), 0.0)]

    def get_string(self, vrs: list[int]) -> list[str]:
        """There are no String variables."""
        self._get(vrs, ("String",), 0.0)
        return [""] * len(vrs)

    def _why_not_set(self, variable: Variable, reference: int, kinds: tuple[str, ...]) -> str:
        if variable.kind not in kinds:
            return _no_reference(reference, kinds[0])
        if variable.causality not in (INPUT, PARAMETER):
            return f"a variable that is set must be an input or a parameter, {variable.name} is calculated"
        if self._phase in (INSTANTIATED, INITIALIZING):
            return ""  # values are checked at the end of initialization
        call = f"setting {variable.name}"
        if variable.causality == PARAMETER and not variable.is_tunable:
            return f"{call} must come before the end of initialization, the instance is {self._phase}"
        if self._phase is not STEPPING:
            return f"{call} must come before terminate, the instance is {self._phase}"
        return ""

    def _set(self, references: list[int], values: list[Any], kinds: tuple[str, ...]) -> None:
        """Set all of the values or, if one cannot be set, none."""

        def assign() -> None:
            numbers = {}
            for reference, value in zip(references, values, strict=True):
                variable = self._variable(reference)
                message = self._why_not_set(variable, reference, kinds)
                if message:
                    self._say(message, Fmi2Status.error)
                    return
                numbers[variable.name] = value
            if self._phase is INITIALIZING:
                self._calculated = self._instance.started = False
            try:
                self._instance.assign(numbers)
            except Refused as refused:
                self._say(str(refused), Fmi2Status.discard)

        self._guarded(assign)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set Real inputs and parameters: checked where they are used, tuned parameters here."""
        self._set(vrs, values, (REAL,))

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set Integer and Enumeration parameters."""
        self._set(vrs, values, ("Integer", "Enumeration"))

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set Boolean parameters."""
        self._set(vrs, [1.0 if value else 0.0 for value in values], (BOOLEAN,))

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """There are no String variables."""
        self._set(vrs, values, ("String",))

    # -- state ---------------------------------------------------------------------------------------

    def _get_fmu_state(self) -> bytes:
        tolerance = math.nan if self._tolerance is None else self._tolerance
        head = bytes([_PHASES.index(self._phase)]) + array("d", [tolerance, self._stop_time]).tobytes()
        return head + self._instance.save()

    def _set_fmu_state(self, state: bytes) -> None:
        try:
            if len(state) < HEAD_SIZE or state[0] >= len(_PHASES):
                raise Refused(NO_STATE)
            phase = _PHASES[state[0]]
            self._instance.restore(state[HEAD_SIZE:], must_be_started=phase in (STEPPING, TERMINATED))
        except Exception as error:
            self._say(str(error) if isinstance(error, Refused) else f"{NO_STATE}: {error}", Fmi2Status.error)
            return
        tolerance, self._stop_time = array("d", state[1:HEAD_SIZE])
        self._tolerance = None if math.isnan(tolerance) else tolerance
        self._phase, self._calculated = phase, False

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        return state


class InertiaModulePy(PythonSlave):
    """The inertia module; the name of the class is the model identifier."""

    instance_type = Module


# while the files are there: later instances in the process share this code, when its own folder may be gone
_SOURCE_HASH = Module.model.source_hash


def _no_reference(reference: int, kind: str) -> str:
    return (
        f"a value reference must be that of a variable of type {kind} in modelDescription.xml, is {reference}"
    )


def _int32(value: float) -> int:
    """Limit to a 32-bit integer a parameter that has not been checked yet."""
    return int(max(-(2.0**31), min(2.0**31 - 1.0, value))) if math.isfinite(value) else 0
