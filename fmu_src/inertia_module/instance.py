"""One instance of an FMU 2.0 for co-simulation, by names: set, advance, read, save, restore."""

from __future__ import annotations

import contextlib
import functools
import math
import shutil
from collections.abc import Callable, Mapping, Sequence
from ctypes import c_char_p, c_double, c_int, c_void_p
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from .logs import callbacks_of


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


def read_description(path: Path) -> Any:
    """The description of an FMU file, as fmpy reads it.

    Raises:
        DriveError: there is no such file, or it is no FMU.
    """
    from fmpy import read_model_description

    if not path.is_file():
        raise DriveError(f"{path} is refused: no such file; allowed is an FMU")
    try:
        return read_model_description(str(path))
    except Exception as error:
        raise DriveError(f"{path} is refused: it is no FMU ({error})") from error


class Kept(NamedTuple):
    """A state kept by an instance, and its time, s."""

    state: c_void_p
    time: float


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
        from fmpy import extract
        from fmpy.fmi2 import FMU2Slave

        description = read_description(self.path)
        try:
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
            self._instance.instantiate(callbacks=callbacks_of(self), loggingOn=True)
        except Exception as error:
            reasons = "; ".join(self.messages) or str(error)
            raise DriveError(f"{self.path} cannot be instantiated: {reasons}") from error
        return self._instance

    def hear(self, status: int, message: str) -> None:
        """Take a log message of the FMU; status as in FMI 2.0."""
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

    def _references(self, names: Sequence[str]) -> Any:
        from fmpy.fmi2 import fmi2ValueReference

        return (fmi2ValueReference * len(names))(*(self._variable(name).valueReference for name in names))

    def set_rates(self, **rates: float) -> None:
        """Give inputs a rate over the coming step, per second (native FMUs; see docs/fmu.md).

        Raises:
            DriveError: an unknown name, no input, or an FMU that takes no derivatives of inputs.
        """
        count = len(rates)
        orders, values = (c_int * count)(*[1] * count), (c_double * count)(*rates.values())
        call = self._instance.fmi2SetRealInputDerivatives
        arguments = self._instance.component, self._references(tuple(rates)), count, orders, values
        self._guard("setRealInputDerivatives", functools.partial(call, *arguments))

    def rates(self, names: Sequence[str]) -> tuple[float, ...]:
        """Rates of outputs at the end of the last step, per second (native FMUs; see docs/fmu.md).

        Raises:
            DriveError: an unknown name, no output, or an FMU that gives no derivatives of outputs.
        """
        count = len(names)
        orders, values = (c_int * count)(*[1] * count), (c_double * count)()
        call = self._instance.fmi2GetRealOutputDerivatives
        arguments = self._instance.component, self._references(names), count, orders, values
        self._guard("getRealOutputDerivatives", functools.partial(call, *arguments))
        return tuple(values)

    def jacobian(self, outputs: Sequence[str], inputs: Sequence[str]) -> NDArray[np.float64]:
        """How outputs after the last step change with the inputs over it (native FMUs; see docs/fmu.md).

        Returns:
            Shape (outputs, inputs), units of the output over those of the input.

        Raises:
            DriveError: an unknown name, or an FMU that gives no directional derivatives.
        """
        unknowns = list(self._references(outputs))
        columns: list[list[float]] = []
        for known in self._references(inputs):
            call = functools.partial(self._instance.getDirectionalDerivative, unknowns, [known], [1.0])
            self._guard("getDirectionalDerivative", lambda call=call: columns.append(call()))  # type: ignore[misc]
        return np.array(columns, dtype=np.float64).reshape(len(inputs), len(outputs)).T

    def keep(self) -> Kept:
        """Keep the state to go back to; cheaper than save, and good for this instance only."""
        return Kept(self._instance.getFMUstate(), self.time)

    def go_back(self, kept: Kept) -> None:
        """Take over a state of keep, and its time."""
        self._guard("setFMUstate", lambda: self._instance.setFMUstate(kept.state))
        self.time = kept.time

    def forget(self, kept: Kept) -> None:
        """Free a state of keep; closing the instance frees all."""
        self._instance.freeFMUstate(kept.state)

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
