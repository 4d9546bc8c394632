"""The Python slave: FMI calls as pythonfmu passes them on, over one model in memory.

Nothing may be raised out of a callback: pythonfmu turns it into fmi2Fatal and corrupts memory. What
is refused is logged: the library in front (front/front.c) answers a call by the worst status logged in it.
"""

from __future__ import annotations

import functools
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


class Told(Refused):
    """Refusal that leaves the instance as it was, with the status that the call is answered by."""

    def __init__(self, message: str, status: Fmi2Status = Fmi2Status.error) -> None:
        super().__init__(message)
        self.status = status


def guarded(callback: Callable[..., None]) -> Callable[..., bool]:
    """A callback out of which nothing is raised: tells whether all went well; else the reason is logged.

    After any other refusal than one of Told every step is refused.
    """

    @functools.wraps(callback)
    def call(slave: PythonSlave, *arguments: Any) -> bool:
        try:
            callback(slave, *arguments)
            return True
        except Told as error:
            slave.say(str(error), error.status)
        except Exception as error:
            slave.phase = REFUSED
            internal = "" if isinstance(error, Refused) else f"internal error: {type(error).__name__}: "
            slave.say(f"{internal}{error}", Fmi2Status.error)
        return False

    return call


class PythonSlave(Fmi2Slave):  # type: ignore[misc]
    """A model behind the FMI 2.0 interface of pythonfmu; subclasses say which."""

    instance_type: ClassVar[type[ModelInstance]]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._instance = self.instance_type("auto")
        self.phase = INSTANTIATED
        self._tolerance: float | None = None
        self._stop_time = math.inf
        # in initialization mode: whether the outputs follow from the values set
        self._calculated = False
        # by value reference: the variable, the numbers of its record, and its place there
        self._places: dict[int, tuple[Variable, Any, int]] = {}
        for variable in self._instance.model.variables:
            numbers, place = (
                self._instance.record(variable.name).numbers,
                self._instance.model.place(variable.name),
            )
            self._places[variable.reference] = variable, numbers, place

    def say(self, message: str, status: Fmi2Status) -> None:
        """Log a message."""
        # the text is used as a printf format
        self.log(message.replace("%", "%%"), status)

    def _require(self, phase: str, call: str, allowed: str) -> None:
        if self.phase != phase:
            raise Told(f"{call} is allowed only {allowed} (the instance is {self.phase})")

    # -- initialisation ------------------------------------------------------------------------------

    @guarded
    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Take over the stop time and the tolerance: it wins over the parameter, where the model has one."""
        self._require(INSTANTIATED, "setupExperiment", "before enterInitializationMode")
        if not math.isfinite(start_time):
            raise Told(must_be("start time", "a finite number of seconds", start_time))
        if stop_time is not None and not stop_time >= start_time:
            raise Told(must_be("stop time", f"at least the start time {start_time:.16g} s", stop_time))
        if tolerance is not None and not 0.0 < tolerance < math.inf:
            raise Told(must_be("tolerance", "a positive number", tolerance))
        self._tolerance = tolerance
        self._stop_time = math.inf if stop_time is None else stop_time

    @guarded
    def enter_initialization_mode(self) -> None:
        """Load the kernel, and say which."""
        self._require(INSTANTIATED, "enterInitializationMode", "directly after instantiation or reset")
        self.phase = INITIALIZING
        self._apply_tolerance()
        self._instance.load_kernel()
        self.say(f"the kernel is {self._instance.kernel}", Fmi2Status.ok)

    @guarded
    def exit_initialization_mode(self) -> None:
        """Check the parameters, alone and together, and take the initial state."""
        self._require(INITIALIZING, "exitInitializationMode", "after enterInitializationMode")
        self._instance.start()
        self.phase = STEPPING
        for message in self._instance.warnings():
            self.say(message, Fmi2Status.warning)

    def _apply_tolerance(self) -> None:
        """Let the tolerance of the experiment win over the parameter, if the model has one."""
        if self._tolerance is not None and "tolerance" in self._instance.model.by_name:
            self._instance.parameters.tolerance = self._tolerance

    @guarded
    def terminate(self) -> None:
        """Outputs stay readable, steps and inputs are refused."""
        self._require(STEPPING, "terminate", "after exitInitializationMode")
        self.phase = TERMINATED

    # -- stepping ------------------------------------------------------------------------------------

    @guarded
    def do_step(self, current_time: float, step_size: float) -> None:
        """Advance by step_size, s; False (fmi2Discard) leaves the state as it was."""
        self._require(STEPPING, "doStep", "after exitInitializationMode")
        stop = self._stop_time
        if not math.isfinite(current_time):
            message = must_be("communication point", "a finite number of seconds", current_time)
            raise Told(message, Fmi2Status.discard)
        if current_time + step_size > stop + NEAR_STOP * max(1.0, abs(stop)):
            step = f"{step_size:.16g} s from {current_time:.16g} s"
            raise Told(f"a step must end at or before the stop time {stop:.16g} s (got a step of {step})")
        status = self._instance.call(codes.STEP, step_size)
        if status != codes.OK:
            raise Told(self._instance.explain(status, step_size), Fmi2Status.discard)

    # -- values --------------------------------------------------------------------------------------

    def _variable(self, reference: int, kinds: tuple[str, ...]) -> Variable:
        """The variable with a value reference.

        Raises:
            Told: there is none, or its kind is another.
        """
        variable = self._places[reference][0] if reference in self._places else None
        if variable is None or variable.kind not in kinds:
            # pythonfmu passes references on as signed numbers
            number = reference % 2**32
            raise Told(
                "a value reference must belong to a variable of type"
                f" {kinds[0]} in modelDescription.xml (got {number})"
            )
        return variable

    @guarded
    def _prepare_to_read(self, references: list[int], kinds: tuple[str, ...]) -> None:
        """Check that values can be read now; in initialization mode calculate the outputs first."""
        variables = [self._variable(reference, kinds) for reference in references]
        if all(variable.causality in (INPUT, PARAMETER) for variable in variables):
            return
        if self.phase == INSTANTIATED:
            self._require("", "reading a calculated variable", "after enterInitializationMode")
        if self.phase == INITIALIZING and not self._calculated:
            try:
                self._instance.start()
            except Refused as refused:
                raise Told(str(refused), Fmi2Status.discard) from None
            self._calculated = True

    def _get(self, references: list[int], kinds: tuple[str, ...], missing: float) -> list[float]:
        if not self._prepare_to_read(references, kinds):
            return [missing] * len(references)
        return [self._places[reference][1][self._places[reference][2]] for reference in references]

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values of Real variables; NaN if one of them cannot be read."""
        return self._get(vrs, (REAL,), math.nan)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Values of Integer and Enumeration variables; 0 if one of them cannot be read."""
        return [_int32(value) for value in self._get(vrs, ("Integer", "Enumeration"), 0.0)]

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Values of Boolean variables; False if one of them cannot be read."""
        return [value != 0.0 for value in self._get(vrs, (BOOLEAN,), 0.0)]

    def _require_settable(self, variable: Variable) -> None:
        call = f"setting {variable.name}"
        if variable.causality not in (INPUT, PARAMETER):
            raise Told(f"a variable to set must be an input or a parameter ({variable.name} is calculated)")
        if self.phase in (INSTANTIATED, INITIALIZING):
            return  # values are checked at the end of initialization
        if variable.causality == PARAMETER and not variable.is_tunable:
            self._require("", call, "before the end of initialization")
        self._require(STEPPING, call, "before terminate")

    @guarded
    def _set(self, references: list[int], values: list[Any], kinds: tuple[str, ...]) -> None:
        """Set all of the values or, if one cannot be set, none."""
        numbers = {}
        for reference, value in zip(references, values, strict=True):
            variable = self._variable(reference, kinds)
            self._require_settable(variable)
            numbers[variable.name] = value
        if self.phase == INITIALIZING:
            self._calculated = self._instance.started = False
        try:
            self._instance.assign(numbers)
        except Refused as refused:
            raise Told(str(refused), Fmi2Status.discard) from None
        if self.phase == INITIALIZING:
            self._apply_tolerance()

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set Real inputs and parameters: checked where they are used, tuned parameters here."""
        self._set(vrs, values, (REAL,))

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set Integer and Enumeration parameters."""
        self._set(vrs, values, ("Integer", "Enumeration"))

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set Boolean parameters."""
        self._set(vrs, [1.0 if value else 0.0 for value in values], (BOOLEAN,))

    # -- state ---------------------------------------------------------------------------------------

    def _get_fmu_state(self) -> bytes:
        tolerance = math.nan if self._tolerance is None else self._tolerance
        head = bytes([_PHASES.index(self.phase)]) + array("d", [tolerance, self._stop_time]).tobytes()
        return head + self._instance.save()

    @guarded
    def _set_fmu_state(self, state: bytes) -> None:
        try:
            if len(state) < HEAD_SIZE or state[0] >= len(_PHASES):
                raise Refused(NO_STATE)
            phase = _PHASES[state[0]]
            self._instance.restore(state[HEAD_SIZE:], must_be_started=phase in (STEPPING, TERMINATED))
        except Exception as error:
            raise Told(str(error) if isinstance(error, Refused) else f"{NO_STATE}: {error}") from None
        tolerance, self._stop_time = array("d", state[1:HEAD_SIZE])
        self._tolerance = None if math.isnan(tolerance) else tolerance
        self.phase, self._calculated = phase, False

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


def _int32(value: float) -> int:
    """Limit to a 32-bit integer a parameter that has not been checked yet."""
    return int(max(-(2.0**31), min(2.0**31 - 1.0, value))) if math.isfinite(value) else 0
