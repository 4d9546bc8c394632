"""One instance of an FMU 2.0 for co-simulation, by names: set, advance, read, save, restore."""

from __future__ import annotations

import contextlib
import functools
import math
import shutil
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from ctypes import byref, c_char_p, c_double
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Self


class DriveError(RuntimeError):
    """The FMU cannot be loaded, or refused parameters, inputs or a step: its own message."""


class Plant(Protocol):
    """What a loop needs of an instance: Fmu has it."""

    def set(self, **values: float) -> None:
        """Set inputs by name."""

    def advance(self, step: float) -> None:
        """Advance by a communication step, s."""

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values by name."""


# instances by the environment their callbacks carry, and who hears the messages of all others
_listeners: weakref.WeakValueDictionary[int, Fmu] = weakref.WeakValueDictionary()
_others: list[list[str]] = []


def _dispatch(environment: int | None, instance: bytes, status: int, category: bytes, message: bytes) -> None:
    """Pass a log message on to the instance it is for; others are printed, as fmpy does."""
    from fmpy.fmi1 import printLogMessage

    listener = _listeners.get(environment or 0)
    if listener is not None:
        listener._log(status, message.decode("utf-8", "replace"))
    elif _others and status > 0:
        _others[-1].append(message.decode("utf-8", "replace"))
    elif not _others:
        printLogMessage(environment, instance, status, category, message)


@functools.cache
def _dispatcher() -> Any:
    from fmpy.fmi2 import fmi2CallbackLoggerTYPE

    return fmi2CallbackLoggerTYPE(_dispatch)


def _logger() -> Any:
    """The log callback of all instances, made anew the one that fmpy's proxy passes messages to.

    The proxy, which formats the messages, knows one callback a process: whoever came last.
    """
    from fmpy.fmi2 import fmi2CallbackFunctions
    from fmpy.logging import addLoggerProxy

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = _dispatcher()
    addLoggerProxy(byref(callbacks))
    return callbacks.logger


def _callbacks(listener: Fmu) -> Any:
    """Callbacks of one instance, with its own environment."""
    from fmpy.fmi1 import calloc, free
    from fmpy.fmi2 import (
        fmi2CallbackAllocateMemoryTYPE,
        fmi2CallbackFreeMemoryTYPE,
        fmi2CallbackFunctions,
    )

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = _logger()
    callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    callbacks.componentEnvironment = id(listener)
    _listeners[id(listener)] = listener
    return callbacks


@contextlib.contextmanager
def messages_of_others() -> Iterator[list[str]]:
    """Collect warnings and errors of instances that fmpy makes itself."""
    _logger()
    messages: list[str] = []
    _others.append(messages)
    try:
        yield messages
    finally:
        _others.remove(messages)


class Fmu:
    """One co-simulation instance of an FMU 2.0, initialised and ready to step; a context manager.

    Args:
        path: the .fmu file.
        parameters: start values by name; enumerations by number or item name.
        inputs: inputs by name, set before the end of initialisation (so no jump at the start).
        tolerance: relative tolerance for setupExperiment, or None.
        start_time, stop_time: of the experiment, s.

    Attributes:
        time: the communication point reached, s.
        messages: what the FMU logged, oldest first.
        units: unit of each variable that has one.

    Raises:
        DriveError: the file is no such FMU, a name is unknown, or a value is refused.
    """

    def __init__(
        self,
        path: Path | str,
        parameters: Mapping[str, float | bool | str] | None = None,
        inputs: Mapping[str, float] | None = None,
        tolerance: float | None = None,
        start_time: float = 0.0,
        stop_time: float | None = None,
    ) -> None:
        self.path = Path(path)
        self.time = start_time
        self.messages: list[str] = []
        self._errors: list[str] = []
        self._readers: dict[tuple[str, ...], tuple[Any, Any, int]] = {}
        self._folder: str | None = None
        self._instance: Any = None
        try:
            instance = self._load()
            setup = functools.partial(instance.setupExperiment, tolerance, start_time, stop_time)
            self._guard("setupExperiment", setup)
            self._assign(parameters or {})
            self._assign(inputs or {})
            self._guard("enterInitializationMode", instance.enterInitializationMode)
            self._guard("exitInitializationMode", instance.exitInitializationMode)
        except BaseException:
            self.close()
            raise

    def _load(self) -> Any:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave

        if not self.path.is_file():
            raise DriveError(f"{self.path} is refused: no such file; allowed is an FMU")
        try:
            description = read_model_description(str(self.path))
            self._folder = extract(str(self.path))
        except Exception as error:
            raise DriveError(f"{self.path} is refused: it is no FMU ({error})") from error
        if description.fmiVersion != "2.0" or description.coSimulation is None:
            raise DriveError(f"{self.path} is refused: allowed is an FMU for co-simulation of FMI 2.0")
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.units = {name: variable.unit for name, variable in self.variables.items() if variable.unit}
        self._instance = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self._folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=self.path.stem,
        )
        try:
            self._instance.instantiate(callbacks=_callbacks(self), loggingOn=True)
        except Exception as error:
            reasons = "; ".join(self.messages) or str(error)
            raise DriveError(f"{self.path} cannot be instantiated: {reasons}") from error
        return self._instance

    def _log(self, status: int, message: str) -> None:
        self.messages.append(message)
        if status > 0:
            self._errors.append(message)

    def _guard(self, name: str, call: Callable[[], Any]) -> None:
        """Call the FMU; an error status or an error message of its own becomes a DriveError."""
        self._errors.clear()
        try:
            call()
        except Exception as error:
            raise DriveError("; ".join(self._errors) or f"{name}: {error}") from error
        if self._errors:
            raise DriveError("; ".join(self._errors))

    def _variable(self, name: str) -> Any:
        variable = self.variables.get(name)
        if variable is None:
            known = ", ".join(self.variables)
            raise DriveError(f"{name} is refused: {self.path.name} has no such variable; it has {known}")
        return variable

    def _assign(self, values: Mapping[str, float | bool | str]) -> None:
        for name, value in values.items():
            variable = self._variable(name)
            reference = [variable.valueReference]
            if variable.type == "Real":
                self._guard(name, functools.partial(self._instance.setReal, reference, [float(value)]))
            elif variable.type == "Boolean":
                self._guard(name, functools.partial(self._instance.setBoolean, reference, [bool(value)]))
            else:
                number = _whole_number(variable, value)
                self._guard(name, functools.partial(self._instance.setInteger, reference, [number]))

    def set(self, **values: float) -> None:
        """Set inputs by name.

        Raises:
            DriveError: an unknown name, or a variable that cannot be set now.
        """
        self._assign(values)

    def advance(self, step: float) -> None:
        """Advance by a communication step, s.

        Raises:
            DriveError: the FMU refused the step; its state is as it was.
        """
        self._errors.clear()
        try:
            self._instance.doStep(currentCommunicationPoint=self.time, communicationStepSize=step)
        except Exception as error:
            reason = "; ".join(self._errors) or str(error)
            raise DriveError(f"at time {self.time:.9g} s: {reason}") from error
        self.time += step

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values by name, of any type, as floats.

        Raises:
            DriveError: an unknown name.
        """
        key = tuple(names)
        if key not in self._readers:
            self._readers[key] = self._reader(key)
        references, values, count = self._readers[key]
        if references is None:
            return tuple(self._read_one(name) for name in key)
        self._instance.fmi2GetReal(self._instance.component, references, count, values)
        return tuple(values)

    def _reader(self, names: tuple[str, ...]) -> tuple[Any, Any, int]:
        from fmpy.fmi2 import fmi2ValueReference

        variables = [self._variable(name) for name in names]
        if any(variable.type != "Real" for variable in variables):
            return None, None, 0
        references = (fmi2ValueReference * len(names))(*(variable.valueReference for variable in variables))
        return references, (c_double * len(names))(), len(names)

    def _read_one(self, name: str) -> float:
        variable = self._variable(name)
        reference = [variable.valueReference]
        if variable.type == "Real":
            return float(self._instance.getReal(reference)[0])
        if variable.type == "Boolean":
            return float(self._instance.getBoolean(reference)[0])
        return float(self._instance.getInteger(reference)[0])

    def __getitem__(self, name: str) -> float:
        return self.read((name,))[0]

    def set_logging(self, on: bool, *categories: str) -> None:
        """Switch log categories on or off; all of them if none is named.

        Raises:
            DriveError: an unknown category.
        """
        names = (c_char_p * len(categories))(*(category.encode() for category in categories))
        call = functools.partial(self._instance.fmi2SetDebugLogging, self._instance.component, int(on))
        self._guard("setDebugLogging", lambda: call(len(categories), names))

    def save(self) -> bytes:
        """The whole state of the instance, serialised."""
        state = self._instance.getFMUstate()
        try:
            return bytes(self._instance.serializeFMUstate(state))
        finally:
            self._instance.freeFMUstate(state)

    def restore(self, saved: bytes, time: float | None = None) -> None:
        """Take over a state of save; time, s, is the communication point it belongs to."""
        state = self._instance.deSerializeFMUstate(saved)
        try:
            self._guard("setFMUstate", lambda: self._instance.setFMUstate(state))
        finally:
            self._instance.freeFMUstate(state)
        if time is not None:
            self.time = time

    def close(self) -> None:
        """Terminate and free the instance and remove what was unpacked."""
        if self._instance is not None and getattr(self._instance, "component", None):
            with contextlib.suppress(Exception):
                self._instance.terminate()
            self._instance.freeInstance()
        self._instance = None
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _whole_number(variable: Any, value: float | bool | str) -> int:
    """Number for an Integer or Enumeration variable; an item of an enumeration may be named."""
    items = {item.name: int(item.value) for item in (getattr(variable.declaredType, "items", None) or [])}
    if isinstance(value, str):
        if value not in items:
            allowed = ", ".join(items) or "whole numbers"
            raise DriveError(f"{variable.name} = {value!r} is refused: allowed are {allowed}")
        return items[value]
    if not math.isfinite(value) or value != int(value):
        raise DriveError(f"{variable.name} = {value} is refused: allowed are whole numbers")
    return int(value)
