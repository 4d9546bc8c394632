"""Co-simulation instance of an FMU (2.0 or 3.0) with access by name: set, advance, read, save, restore."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterable, Mapping, Sequence
from ctypes import addressof, byref, c_uint, c_void_p
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ..common.deprecated import renamed_arguments, renamed_names
from ..common.errors import FmuError, ParameterError, SimulationTerminated, cannot_read, must_be, unknown
from ..common.terminal import Progress
from ..common.units import BOOLEANS, allowed_number, number_of, with_reason
from ..model import Plant, Run

__all__ = ["Fmu", "FmuError", "Plant", "RestartedFmu", "run"]

Array = NDArray[np.float64]

# function of the native FMUs that takes many steps in one call
RUN = "inertiaModuleRun"
# statuses of the standards; a status above a warning is an error, except a discarded step
WARNING, DISCARD = 1, 2
# status kind of FMI 2.0 for the end of the simulation
TERMINATED = 3
# types of real numbers
REALS = ("Real", "Float32", "Float64")
# types whose values are no numbers
NOT_NUMBERS = ("String", "Binary", "Clock")
# maximum of an integer; ctypes would truncate a larger one without an error
MAX_INTEGER = 2.0**31 - 1.0

# number of steps in the first call of a run
FIRST_STEPS = 8
# aim for the duration of the following calls, s; progress and Ctrl-C are handled between calls
CALL_TIME = 0.1
# arguments of a run without steps, which only reads
NO_STEPS, NO_INPUTS = np.empty(0), np.empty((0, 0))


class Closing:
    """Context manager that calls close at its end."""

    def close(self) -> None:
        """Release the resources."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self.close()


def run(
    plant: Plant,
    lengths: Array,
    inputs: Mapping[str, Array],
    outputs: Sequence[str],
    rows: Array,
    progress: Progress | None = None,
) -> None:
    """Run a started plant and record outputs.

    Args:
        plant: the plant.
        lengths: lengths of the steps, s, shape (steps,).
        inputs: values of the inputs by name, shape (steps,) each.
        outputs: names of the outputs.
        rows: array for the outputs at the start and after each step, shape (steps + 1, outputs).
        progress: function that receives the completed share, 0 to 1, or None.

    Raises:
        ParameterError: a name is unknown, or a value or a step is invalid.
    """
    table = np.reshape([*inputs.values()], (len(inputs), lengths.size))
    lengths, input_rows = np.ascontiguousarray(lengths), np.ascontiguousarray(table.T)
    names, first, number = tuple(inputs), 0, FIRST_STEPS
    while first < lengths.size:
        end, start_time = min(first + number, lengths.size), time.perf_counter()
        plant.take_steps(lengths[first:end], names, input_rows[first:end], outputs, rows[first : end + 1])
        number = 2 * number if time.perf_counter() - start_time < CALL_TIME else max(number // 2, 1)
        first = end
        if progress is not None:
            progress(first / lengths.size)


def as_names(names: str | Sequence[str]) -> tuple[str, ...]:
    """Return names as a tuple.

    Args:
        names: a list of names, or a single name as a string.

    Raises:
        ParameterError: the names are neither.
    """
    if isinstance(names, str):
        return (names,)
    if isinstance(names, Iterable):
        return tuple(names)
    raise ParameterError(must_be("names", "a string or a list of strings", repr(names)))


def fmu_file(path: Path | str | None) -> Path:
    """Return the path of an FMU file.

    Args:
        path: path of the file; None for the FMU of the module, from the wheel or built on demand.
    """
    if path is not None:
        return Path(path)
    from ..fmu.builder import current_fmu

    return current_fmu()


def fmu_content(path: Path | str | None) -> bytes:
    """Return the content of an FMU file.

    Args:
        path: path of the file; None for the FMU of the module, from the wheel or built on demand.
    """
    from .archive import read_archive

    return read_archive(fmu_file(path))


def read_description(path: Path, validate: bool = True) -> Any:
    """Read the model description of an FMU file with fmpy; types of variables have their names in FMI 2.0.

    Args:
        path: path of the file.
        validate: True to reject a description that violates the standard.

    Raises:
        FmuError: the file is no FMU, or its description is rejected.
    """
    from fmpy import read_model_description

    from ..fmu.description import TYPES_3
    from .archive import read_archive
    from .copies import unpacked

    content = read_archive(path)
    try:
        description = read_model_description(unpacked(content), validate=validate)
    except Exception as error:
        raise FmuError(cannot_read(path, error)) from error
    fmi2_types = {name: type_2 for type_2, name in TYPES_3.items()}
    for variable in description.modelVariables:
        variable.type = fmi2_types.get(variable.type, variable.type)
    return description


def is_number(variable: Any) -> bool:
    """Return True if a variable of fmpy is a single number: no text, no clock, no array.

    Args:
        variable: variable of fmpy.
    """
    return variable.type not in NOT_NUMBERS and not variable.dimensions


def items_of(variable: Any) -> Mapping[str, float] | None:
    """Return the numbers by name of a Boolean or an enumeration; None for other variables.

    Args:
        variable: variable of fmpy.
    """
    if variable.type == "Boolean":
        return BOOLEANS
    if variable.type not in REALS and getattr(variable.declaredType, "items", None):
        return {item.name: float(item.value) for item in variable.declaredType.items}
    return None


def to_number(variable: Any, value: Any) -> float:
    """Convert a value, a quantity or the name of an item to a number; the FMU checks its range.

    Args:
        variable: variable of fmpy.
        value: a number, a string with a unit, or the name of an item.

    Raises:
        FmuError: the value has another type.
    """
    is_real = variable.type in REALS
    if is_real and isinstance(value, float):
        return value
    unit, items = variable.unit or "1", items_of(variable)
    maximum = 1.0 if variable.type == "Boolean" else MAX_INTEGER
    if is_real:
        allowed = allowed_number(unit)
    else:
        allowed = f"one of {', '.join(items)}" if items else "a 32-bit integer"
    try:
        number = number_of(value, unit, items)
    except ValueError as error:
        message = must_be(variable.name, allowed, repr(value))
        raise FmuError(with_reason(message, error, value, items)) from None
    if not is_real and not (number.is_integer() and abs(number) <= maximum):
        raise FmuError(must_be(variable.name, allowed, repr(value)))
    return number


class Log:
    """Messages of an instance, oldest first.

    Attributes:
        messages: all messages.
        warnings: messages with the status warning.
        errors: messages with a more severe status.
    """

    def __init__(self) -> None:
        self.messages: list[str] = []
        self.warnings: list[str] = []
        self.errors: list[str] = []

    def take(self, environment: int | None, status: int, category: bytes, message: bytes) -> None:
        """Append a message; this method has the signature of the log callback of FMI 3.0.

        Args:
            environment: instance environment of the callback.
            status: status of the message.
            category: category of the message.
            message: the message in UTF-8.
        """
        text = message.decode("utf-8", "replace")
        self.messages.append(text)
        if status >= WARNING:
            (self.warnings if status == WARNING else self.errors).append(text)


class FmuState:
    """A state stored by an instance of an FMU; it is freed with the last reference to this object.

    Args:
        fmu: the instance.
        state: pointer of the FMU.

    Attributes:
        fmu: the instance.
        state: pointer of the FMU.
        time: communication point of the state, s.
        epoch: time at which the clock of the instance is at 0, s.
    """

    def __init__(self, fmu: Fmu, state: c_void_p) -> None:
        self.fmu, self.state, self.time, self.epoch = fmu, state, fmu.time, fmu._epoch

    def __del__(self) -> None:
        if self.fmu._instance is not None:
            self.fmu._instance.freeFMUstate(self.state)


class Fmu(Plant, Closing):
    """One co-simulation instance of an FMU (2.0 or 3.0), initialised and ready to step; a context manager.

    FMUs of FMI 3.0 run without event mode and early return.

    Args:
        fmu: path of the .fmu file; None for current_fmu().
        parameters: start values by name: numbers, strings with a unit ("90 deg"), enumerations by number
            or item name.
        inputs: inputs by name; they are set before the end of initialisation, so there is no jump at the
            start.
        tolerance: relative tolerance of the experiment, or None.
        start_time: start time of the experiment, s.
        stop_time: stop time of the experiment, s, or None.

    Attributes:
        path: path of the .fmu file.
        time: present communication point, s.
        messages: messages of the FMU, oldest first.
        warnings: messages of the FMU with the status warning.
        variables: variables of fmpy by name.
        units: units by name, for the variables that have a unit.

    Raises:
        FmuError: the file is no FMU for co-simulation, a name is unknown, or a value is invalid. All methods
            raise it for unknown names, for calls that the FMU rejects or does not support, and after close.
    """

    @renamed_arguments(path="fmu")
    def __init__(
        self,
        fmu: Path | str | None = None,
        parameters: Mapping[str, float | bool | str] | None = None,
        inputs: Mapping[str, float | str] | None = None,
        tolerance: float | None = None,
        start_time: float = 0.0,
        stop_time: float | None = None,
    ) -> None:
        self.path = fmu_file(fmu)
        self.time = start_time
        self._epoch = 0.0  # s; time at which the clock of the instance is at 0
        self._log = Log()
        self.messages, self.warnings = self._log.messages, self._log.warnings
        self._instance: Any = None
        self._readers: dict[tuple[str, ...], tuple[Array, Run]] = {}
        self._arrays: dict[tuple[str, ...], Any] = {}
        try:
            self._load()
            self._call("setupExperiment", tolerance, start_time, stop_time)
            self.set(**(parameters or {}))
            self.set(**(inputs or {}))
            self._call("enterInitializationMode")
            self._before_start()
            self._call("exitInitializationMode")
        except BaseException:
            self.close()
            raise

    def __repr__(self) -> str:
        return f"Fmu({str(self.path)!r}, time {self.time:g} s)"

    def _load(self) -> None:
        from .archive import read_archive
        from .copies import unpacked
        from .loading import instantiate

        description = read_description(self.path)
        if description.fmiVersion not in ("2.0", "3.0") or description.coSimulation is None:
            kind = f"FMI {description.fmiVersion}{'' if description.coSimulation else ', no co-simulation'}"
            raise FmuError(must_be(str(self.path), "an FMU for co-simulation of FMI 2.0 or 3.0", kind))
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.units = {name: variable.unit for name, variable in self.variables.items() if variable.unit}
        try:
            folder = unpacked(read_archive(self.path))
            self._instance = instantiate(description, folder, self.path.stem, self._log)
        except Exception as error:
            reasons = "; ".join(self.messages) or str(error)
            raise FmuError(f"{self.path} cannot be instantiated: {reasons}") from error

    def _before_start(self) -> None:
        """Hook for subclasses, called before the end of the initialisation."""

    def close(self) -> None:
        """Terminate and free the instance."""
        if self._instance is not None and getattr(self._instance, "component", None):
            with contextlib.suppress(Exception):
                self._instance.terminate()
            self._instance.freeInstance()
        self._instance = None

    def _call(self, function: str, *arguments: Any) -> Any:
        """Call a function of fmpy's instance; raise FmuError if it fails or logs an error."""
        if self._instance is None:
            raise FmuError(f"{self.path.name} is closed: {function} requires an open instance")
        errors = self._log.errors
        errors.clear()
        try:
            result = getattr(self._instance, function)(*arguments)
        except Exception as error:
            raise FmuError("; ".join(errors) or f"{function}: {error}") from error
        if errors:
            raise FmuError("; ".join(errors))
        return result

    def set_logging(self, on: bool, *categories: str) -> None:
        """Switch log categories on or off.

        Args:
            on: True to switch on.
            categories: names of the categories; without names all categories are switched.
        """
        self._call("setDebugLogging", on, categories)

    # --- values ---

    def _variable(self, name: str) -> Any:
        """Return a variable of fmpy by name; raise FmuError if it is missing, or no single number."""
        variable = self.variables.get(name)
        if variable is None:
            raise FmuError(f"{self.path.name}: {unknown('variable', name, self.variables)}")
        if not is_number(variable):
            kind = f"an array of {variable.type}" if variable.dimensions else f"a {variable.type}"
            raise FmuError(f"{self.path.name}: {must_be(name, 'a number', kind)}")
        return variable

    def _references(self, names: str | Sequence[str]) -> list[int]:
        return [self._variable(name).valueReference for name in as_names(names)]

    def _address(self, names: Sequence[str]) -> int:
        """Return the address of a C array with the value references of variables; the array is stored."""
        key = tuple(names)
        if key not in self._arrays:
            self._arrays[key] = (c_uint * len(key))(*self._references(key))
        return addressof(self._arrays[key])

    def set(self, /, **values: float | bool | str) -> None:
        """Set inputs and tunable parameters by name; an unknown name or an invalid type sets none of them.

        Args:
            values: numbers, strings with a unit, or names of items.
        """
        calls: dict[str, dict[int, float]] = {}
        for variable, value in [(self._variable(name), value) for name, value in values.items()]:
            convert = float if variable.type in REALS else {"Boolean": bool}.get(variable.type, int)
            number = convert(to_number(variable, value))
            calls.setdefault(variable.type, {})[variable.valueReference] = number
        for kind, numbers in calls.items():
            self._call(f"set{kind}", list(numbers), list(numbers.values()))

    def read(self, names: str | Sequence[str]) -> tuple[float, ...]:
        """Return the values of variables as floats.

        Args:
            names: names of variables, or a single name.
        """
        key = as_names(names)
        if key not in self._readers:
            row = np.empty((1, len(key)))
            self._readers[key] = row, Run(NO_STEPS, 0, NO_INPUTS, self._address(key), row)
        row, request = self._readers[key]
        if getattr(self._instance, RUN, None) is not None:
            self._call(RUN, self._instance.component, byref(request))
            return tuple(row[0].tolist())
        kinds: dict[str, list[int]] = {}
        for place, name in enumerate(key):
            kinds.setdefault(self.variables[name].type, []).append(place)
        for kind, places in kinds.items():
            row[0, places] = self._call(f"get{kind}", self._references([key[place] for place in places]))
        return tuple(row[0].tolist())

    def __getitem__(self, name: str) -> float:
        return self.read(name)[0]

    # --- steps ---

    def advance(self, step: float) -> None:
        """Advance by a communication step.

        Args:
            step: length of the step, s.

        Raises:
            FmuError: the FMU rejects the step; its state is unchanged.
            SimulationTerminated: the FMU ends the simulation.
        """
        try:
            self._call("doStep", self.time - self._epoch, step)
        except FmuError as error:
            if self._ends_simulation(error.__cause__):
                raise SimulationTerminated(
                    f"{self.path.name} ends the simulation at {self.time:.9g} s"
                ) from error
            raise FmuError(f"at time {self.time:.9g} s: {error}") from error
        self.time += step

    def _ends_simulation(self, failure: BaseException | None) -> bool:
        """Return True if the FMU ends the simulation with the failure of a step."""
        with contextlib.suppress(Exception):
            return getattr(failure, "status", None) == DISCARD and self._instance.getBooleanStatus(TERMINATED)
        return False

    def take_steps(
        self, lengths: Array, inputs: Sequence[str], input_rows: Array, outputs: Sequence[str], rows: Array
    ) -> None:
        """Take many steps; an FMU with the function RUN takes them in one call.

        Args:
            lengths: lengths of the steps, s, shape (steps,).
            inputs: names of the inputs.
            input_rows: values of the inputs, shape (steps, inputs).
            outputs: names of the outputs.
            rows: array for the outputs at the start and after each step, shape (steps + 1, outputs).

        Raises:
            FmuError: a name is unknown, or the FMU rejects a value or a step.
        """
        if getattr(self._instance, RUN, None) is None:
            super().take_steps(lengths, inputs, input_rows, outputs, rows)
            return
        request = Run(lengths, self._address(inputs), input_rows, self._address(outputs), rows)
        request.time = self.time - self._epoch
        try:
            self._call(RUN, self._instance.component, byref(request))
        except FmuError as error:
            raise FmuError(f"at time {request.time + self._epoch:.9g} s: {error}") from error
        finally:
            self.time = request.time + self._epoch

    def set_rates(self, **rates: float) -> None:
        """Set the rates of inputs for the next step (native FMUs; see fmu.md).

        Args:
            rates: rates by name, in units of the inputs per second.
        """
        orders, values = [1] * len(rates), list(rates.values())
        self._call("setRealInputDerivatives", self._references(tuple(rates)), orders, values)

    def rates(self, names: str | Sequence[str]) -> tuple[float, ...]:
        """Return the rates of outputs after the last step, per second (see fmu.md).

        Args:
            names: names of outputs, or a single name.
        """
        references = self._references(names)
        return tuple(self._call("getRealOutputDerivatives", references, [1] * len(references)))

    def jacobian(self, outputs: str | Sequence[str], inputs: str | Sequence[str]) -> NDArray[np.float64]:
        """Return the derivatives of outputs after the last step with respect to inputs during the step.

        This requires a native FMU (see fmu.md).

        Args:
            outputs: names of outputs, or a single name.
            inputs: names of inputs or tunable parameters, or a single name.

        Returns:
            Jacobian, shape (outputs, inputs), in the unit of the output per unit of the input.
        """
        unknowns, knowns = self._references(outputs), self._references(inputs)
        columns = [self._call("getDirectionalDerivative", unknowns, [input_], [1.0]) for input_ in knowns]
        return np.array(columns, dtype=np.float64).reshape(len(knowns), len(unknowns)).T

    # --- states ---

    def get_state(self) -> FmuState:
        """Return the present state for set_state; cheaper than save, but valid for this instance only."""
        return FmuState(self, self._call("getFMUstate"))

    def set_state(self, state: FmuState) -> None:
        """Restore a state that get_state has returned, and its time.

        Args:
            state: the state.

        Raises:
            FmuError: the state is from another instance.
        """
        # some FMUs crash if the state is from another instance
        if not isinstance(state, FmuState) or state.fmu is not self:
            raise FmuError("a state must be from get_state of this instance")
        self._call("setFMUstate", state.state)
        self.time, self._epoch = state.time, state.epoch

    def save(self) -> bytes:
        """Return the serialised state of the instance."""
        state = self.get_state()  # the reference keeps the state alive during the call
        return bytes(self._call("serializeFMUstate", state.state))

    def restore(self, saved: bytes, time: float | None = None) -> None:
        """Restore a state that save has returned.

        Args:
            saved: the state.
            time: time of the state, s; None to leave the time of the instance unchanged.

        Raises:
            FmuError: the FMU rejects the state; the instance is unchanged.
        """
        if not isinstance(saved, bytes):
            raise FmuError(must_be("a state", "the bytes of save()", type(saved).__name__))
        before = self.get_state()
        try:
            after = FmuState(self, self._call("deSerializeFMUstate", saved))
            self._call("setFMUstate", after.state)
        except FmuError:
            # a failed call changes the phase of the Python FMU: it would reject all further steps
            self._call("setFMUstate", before.state)
            raise
        if time is not None:
            self.time, self._epoch = time, 0.0


class RestartedFmu(Fmu):
    """Instance that can be restarted from initialisation with other start values.

    A restart restores a state from initialisation mode. This state contains the results of the parameters,
    such as the map of fidelity averaged. Therefore a restart is cheaper than a new instance.
    """

    def _before_start(self) -> None:
        # reading an output makes the native FMU compute its constants, so the stored state contains them
        outputs = (v.name for v in self.variables.values() if v.causality == "output" and is_number(v))
        self.read([*outputs][:1])
        self._uninitialized_state = self.get_state()

    def restart(self, values: Mapping[str, float], time: float = 0.0) -> None:
        """Restart the instance.

        Args:
            values: parameters and inputs by name; all others have the values of the first start.
            time: time of the restart, s, for messages; the clock of the instance starts at 0.
        """
        self.messages.clear()  # otherwise the messages would accumulate, because a run restarts at every step
        self.set_state(self._uninitialized_state)
        self._epoch = time - self.time
        self.time = time
        self.set(**values)
        self._call("exitInitializationMode")


__getattr__ = renamed_names(__name__, Ended="common.errors:SimulationTerminated")
