"""The Python slave: receives the FMI calls from pythonfmu and applies them to one model in memory.

A callback must not raise: pythonfmu would return fmi2Fatal and corrupt memory. Errors are logged. The front
library (front/front.c) returns the worst status that a call has logged.
"""

from __future__ import annotations

import functools
import math
from array import array
from collections.abc import Callable
from typing import Any, ClassVar

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from ..common.errors import InertiaModuleError, ParameterError, must_be
from ..interface.variables import BOOLEAN, INPUT, PARAMETER, REAL, Variable
from ..kernel import codes
from ..model import INVALID_STATE, ModelInstance, Module

INSTANTIATED = "instantiated"
INITIALIZING = "in initialization mode"
STEPPING = "initialized"
FAILED = "in error since initialization"
TERMINATED = "terminated"

_PHASES = (INSTANTIATED, INITIALIZING, STEPPING, FAILED, TERMINATED)
# bytes before the state of the model: phase, tolerance and stop time
HEADER_SIZE = 17
# a step may exceed the stop time by this share of the stop time, or of a second, as in shell/stepping.c
STOP_TIME_RTOL = 1e-5


class RecoverableError(ParameterError):
    """Error that leaves the instance unchanged.

    Args:
        message: the message.
        status: status that the call returns.
    """

    def __init__(self, message: str, status: Fmi2Status = Fmi2Status.error) -> None:
        super().__init__(message)
        self.status = status


def guarded(callback: Callable[..., None]) -> Callable[..., bool]:
    """Return a callback that does not raise: it returns True on success, otherwise it logs the error.

    After an error other than RecoverableError every step is rejected.

    Args:
        callback: method of PythonSlave.
    """

    @functools.wraps(callback)
    def call(slave: PythonSlave, *arguments: Any) -> bool:
        try:
            callback(slave, *arguments)
            return True
        except RecoverableError as error:
            slave.log_message(str(error), error.status)
        except Exception as error:
            slave.phase = FAILED
            internal = (
                "" if isinstance(error, InertiaModuleError) else f"internal error: {type(error).__name__}: "
            )
            slave.log_message(f"{internal}{error}", Fmi2Status.error)
        return False

    return call


class PythonSlave(Fmi2Slave):  # type: ignore[misc]
    """A model with the FMI 2.0 interface of pythonfmu; subclasses define the model.

    Args:
        kwargs: arguments of Fmi2Slave.

    Attributes:
        phase: phase of the instance: INSTANTIATED, INITIALIZING, STEPPING, FAILED or TERMINATED.
    """

    instance_type: ClassVar[type[ModelInstance]]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._instance = self.instance_type("auto")
        self.phase = INSTANTIATED
        self._tolerance: float | None = None
        self._stop_time = math.inf
        # True in initialization mode if the outputs are calculated from the present values
        self._calculated = False
        # variable, numbers of its record, and its place in them, by value reference
        self._places: dict[int, tuple[Variable, Any, int]] = {}
        for variable in self._instance.model.variables:
            numbers, place = (
                self._instance.record(variable.name).numbers,
                self._instance.model.place(variable.name),
            )
            self._places[variable.reference] = variable, numbers, place

    def log_message(self, message: str, status: Fmi2Status) -> None:
        """Log a message.

        Args:
            message: the message.
            status: status of the message.
        """
        # pythonfmu uses the text as a printf format
        self.log(message.replace("%", "%%"), status)

    def _require(self, phase: str, call: str, allowed: str) -> None:
        if self.phase != phase:
            raise RecoverableError(f"{call} is allowed only {allowed} (the instance is {self.phase})")

    # -- initialisation ------------------------------------------------------------------------------

    @guarded
    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Store the stop time and the tolerance, which overrides the parameter of the model.

        Args:
            start_time: start time, s.
            stop_time: stop time, s, or None.
            tolerance: relative tolerance, or None.
        """
        self._require(INSTANTIATED, "setupExperiment", "before enterInitializationMode")
        if not math.isfinite(start_time):
            raise RecoverableError(must_be("start time", "a finite number of seconds", start_time))
        if stop_time is not None and not stop_time >= start_time:
            raise RecoverableError(
                must_be("stop time", f"at least the start time {start_time:.16g} s", stop_time)
            )
        if tolerance is not None and not 0.0 < tolerance < math.inf:
            raise RecoverableError(must_be("tolerance", "a positive number", tolerance))
        self._tolerance = tolerance
        self._stop_time = math.inf if stop_time is None else stop_time

    @guarded
    def enter_initialization_mode(self) -> None:
        """Load the kernel and log its name."""
        self._require(INSTANTIATED, "enterInitializationMode", "directly after instantiation or reset")
        self.phase = INITIALIZING
        self._apply_tolerance()
        self._instance.load_kernel()
        self.log_message(f"the kernel is {self._instance.kernel}", Fmi2Status.ok)

    @guarded
    def exit_initialization_mode(self) -> None:
        """Check the parameters, alone and in combination, and compute the initial state."""
        self._require(INITIALIZING, "exitInitializationMode", "after enterInitializationMode")
        self._instance.start()
        self.phase = STEPPING
        for message in self._instance.warnings():
            self.log_message(message, Fmi2Status.warning)

    def _apply_tolerance(self) -> None:
        """Override the parameter tolerance, if the model has one, by the tolerance of the experiment."""
        if self._tolerance is not None and "tolerance" in self._instance.model.by_name:
            self._instance.parameters.tolerance = self._tolerance

    @guarded
    def terminate(self) -> None:
        """Terminate: outputs stay readable, steps and inputs are rejected."""
        self._require(STEPPING, "terminate", "after exitInitializationMode")
        self.phase = TERMINATED

    # -- stepping ------------------------------------------------------------------------------------

    @guarded
    def do_step(self, current_time: float, step_size: float) -> None:
        """Advance by a communication step; False (fmi2Discard) means that the state is unchanged.

        Args:
            current_time: communication point, s.
            step_size: length of the step, s.
        """
        self._require(STEPPING, "doStep", "after exitInitializationMode")
        stop = self._stop_time
        if not math.isfinite(current_time):
            message = must_be("communication point", "a finite number of seconds", current_time)
            raise RecoverableError(message, Fmi2Status.discard)
        if current_time + step_size > stop + STOP_TIME_RTOL * max(1.0, abs(stop)):
            step = f"{step_size:.16g} s from {current_time:.16g} s"
            raise RecoverableError(
                f"a step must end at or before the stop time {stop:.16g} s (got a step of {step})"
            )
        status = self._instance.call(codes.STEP, step_size)
        if status != codes.OK:
            raise RecoverableError(self._instance.explain(status, step_size), Fmi2Status.discard)

    # -- values --------------------------------------------------------------------------------------

    def _variable(self, reference: int, kinds: tuple[str, ...]) -> Variable:
        """Return the variable with a value reference.

        Raises:
            RecoverableError: there is no such variable, or it has another kind.
        """
        variable = self._places[reference][0] if reference in self._places else None
        if variable is None or variable.kind not in kinds:
            # pythonfmu converts value references to signed numbers
            number = reference % 2**32
            raise RecoverableError(
                "a value reference must belong to a variable of type"
                f" {kinds[0]} in modelDescription.xml (got {number})"
            )
        return variable

    @guarded
    def _prepare_to_read(self, references: list[int], kinds: tuple[str, ...]) -> None:
        """Check that values can be read; in initialization mode calculate the outputs first."""
        variables = [self._variable(reference, kinds) for reference in references]
        if all(variable.causality in (INPUT, PARAMETER) for variable in variables):
            return
        if self.phase == INSTANTIATED:
            self._require("", "reading a calculated variable", "after enterInitializationMode")
        if self.phase == INITIALIZING and not self._calculated:
            try:
                self._instance.start()
            except InertiaModuleError as error:
                raise RecoverableError(str(error), Fmi2Status.discard) from None
            self._calculated = True

    def _get(self, references: list[int], kinds: tuple[str, ...], missing: float) -> list[float]:
        if not self._prepare_to_read(references, kinds):
            return [missing] * len(references)
        return [self._places[reference][1][self._places[reference][2]] for reference in references]

    def get_real(self, vrs: list[int]) -> list[float]:
        """Return the values of Real variables; NaN for all if a variable cannot be read.

        Args:
            vrs: value references.
        """
        return self._get(vrs, (REAL,), math.nan)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Return the values of Integer and Enumeration variables; 0 for all if a variable cannot be read.

        Args:
            vrs: value references.
        """
        return [_int32(value) for value in self._get(vrs, ("Integer", "Enumeration"), 0.0)]

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Return the values of Boolean variables; False for all if a variable cannot be read.

        Args:
            vrs: value references.
        """
        return [value != 0.0 for value in self._get(vrs, (BOOLEAN,), 0.0)]

    def _require_settable(self, variable: Variable) -> None:
        call = f"setting {variable.name}"
        if variable.causality not in (INPUT, PARAMETER):
            raise RecoverableError(
                f"a variable to set must be an input or a parameter ({variable.name} is calculated)"
            )
        if self.phase in (INSTANTIATED, INITIALIZING):
            return  # values are checked at the end of initialization
        if variable.causality == PARAMETER and not variable.is_tunable:
            self._require("", call, "before the end of initialization")
        self._require(STEPPING, call, "before terminate")

    @guarded
    def _set(self, references: list[int], values: list[Any], kinds: tuple[str, ...]) -> None:
        """Set all values; if a value is invalid, set none."""
        numbers = {}
        for reference, value in zip(references, values, strict=True):
            variable = self._variable(reference, kinds)
            self._require_settable(variable)
            numbers[variable.name] = value
        if self.phase == INITIALIZING:
            self._calculated = self._instance.started = False
        try:
            self._instance.assign(numbers)
        except InertiaModuleError as error:
            raise RecoverableError(str(error), Fmi2Status.discard) from None
        if self.phase == INITIALIZING:
            self._apply_tolerance()

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set Real inputs and parameters; only tuned parameters are checked now, other values at their use.

        Args:
            vrs: value references.
            values: values.
        """
        self._set(vrs, values, (REAL,))

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set Integer and Enumeration parameters.

        Args:
            vrs: value references.
            values: values.
        """
        self._set(vrs, values, ("Integer", "Enumeration"))

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set Boolean parameters.

        Args:
            vrs: value references.
            values: values.
        """
        self._set(vrs, [1.0 if value else 0.0 for value in values], (BOOLEAN,))

    # -- state ---------------------------------------------------------------------------------------

    def _get_fmu_state(self) -> bytes:
        tolerance = math.nan if self._tolerance is None else self._tolerance
        header = bytes([_PHASES.index(self.phase)]) + array("d", [tolerance, self._stop_time]).tobytes()
        return header + self._instance.save()

    @guarded
    def _set_fmu_state(self, state: bytes) -> None:
        try:
            if len(state) < HEADER_SIZE or state[0] >= len(_PHASES):
                raise ParameterError(INVALID_STATE)
            phase = _PHASES[state[0]]
            self._instance.restore(state[HEADER_SIZE:], must_be_started=phase in (STEPPING, TERMINATED))
        except Exception as error:
            raise RecoverableError(
                str(error) if isinstance(error, InertiaModuleError) else f"{INVALID_STATE}: {error}"
            ) from None
        tolerance, self._stop_time = array("d", state[1:HEADER_SIZE])
        self._tolerance = None if math.isnan(tolerance) else tolerance
        self.phase, self._calculated = phase, False

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        return state


class InertiaModulePy(PythonSlave):
    """The inertia module. The name of the class is the model identifier."""

    instance_type = Module


# computed at the import, because later instances use this code when its folder may be missing
_SOURCE_HASH = Module.model.source_hash


def _int32(value: float) -> int:
    """Convert a parameter that may be unchecked to a 32-bit integer, within its limits."""
    return int(max(-(2.0**31), min(2.0**31 - 1.0, value))) if math.isfinite(value) else 0
