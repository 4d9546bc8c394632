"""One instance of an FMU, 2.0 or 3.0, for co-simulation, by names: set, advance, read, save, restore."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterable, Mapping, Sequence
from ctypes import addressof, byref, c_uint, c_void_p
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FmuError, Refused, cannot_read, must_be, unknown
from ..common.files import read_file
from ..common.terminal import Progress
from ..common.units import BOOLEANS, allowed_number, number_of, with_reason
from ..memory import Plant, Run

__all__ = ["Fmu", "FmuError", "Plant", "RestartedFmu", "run"]

Array = NDArray[np.float64]

# function of the native FMUs that takes many steps in one call
RUN = "inertiaModuleRun"
# statuses of the standards: of a warning, above which are errors, and of a step that is not taken; of FMI 2.0
# the question whether it ends the simulation
WARNING, DISCARD = 1, 2
TERMINATED = 3
# largest FMU file that workers run, bytes
MAX_FMU_SIZE = 1_000_000_000
# types of values that are no numbers
NOT_NUMBERS = ("String", "Binary", "Clock")
# ctypes cuts off what is more, silently
LARGEST_INTEGER = 2.0**31 - 1.0

# a run begins with a call of so many steps; others take about so long, s: progress and Ctrl-C come in between
FIRST_STEPS = 8
CALL_TIME = 0.1
# of a run that only reads
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
    """Run a started plant with inputs by name, shape (steps,) each; all else as of Plant.take_steps."""
    table = np.reshape([*inputs.values()], (len(inputs), lengths.size))
    lengths, given = np.ascontiguousarray(lengths), np.ascontiguousarray(table.T)
    done, number = 0, FIRST_STEPS
    while done < lengths.size:
        end, begun = min(done + number, lengths.size), time.perf_counter()
        plant.take_steps(lengths[done:end], tuple(inputs), given[done:end], outputs, rows[done : end + 1])
        number = 2 * number if time.perf_counter() - begun < CALL_TIME else max(number // 2, 1)
        done = end
        if progress is not None:
            progress(done / lengths.size)


def as_names(names: str | Sequence[str]) -> tuple[str, ...]:
    """Names as a tuple; a single one may be given as a string."""
    if isinstance(names, str):
        return (names,)
    if isinstance(names, Iterable):
        return tuple(names)
    raise Refused(must_be("names", "a string or a list of strings", repr(names)))


def fmu_file(path: Path | str | None) -> Path:
    """The path of an FMU file; without one that of the module, as it comes with the package or is built."""
    if path is not None:
        return Path(path)
    from ..fmu.builder import current_fmu

    return current_fmu()


def fmu_content(path: Path | str | None) -> bytes:
    """The content of an FMU file, or of that of the module: see fmu_file."""
    return read_file(fmu_file(path), MAX_FMU_SIZE)


def read_description(path: Path, validate: bool = True) -> Any:
    """Read the description of an FMU file by fmpy; types of variables by their names in FMI 2.0.

    Args:
        path: of the file.
        validate: reject a description that violates the standard.

    Raises:
        FmuError: there is no FMU, or its description is rejected.
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
    of_fmi_2 = {name: type_2 for type_2, name in TYPES_3.items()}
    for variable in description.modelVariables:
        variable.type = of_fmi_2.get(variable.type, variable.type)
    return description


def is_number(variable: Any) -> bool:
    """Return True if a variable of fmpy is a single number: no text, no clock, no array."""
    return variable.type not in NOT_NUMBERS and not variable.dimensions


def _number_for(variable: Any, value: Any) -> float:
    """Convert a value, a quantity or the name of an item to the number to set; the FMU checks its range."""
    if variable.type == "Real" and isinstance(value, float):
        return value
    unit, items, largest = variable.unit or "1", None, LARGEST_INTEGER
    if variable.type == "Boolean":
        items, largest = BOOLEANS, 1.0
    elif variable.type != "Real" and getattr(variable.declaredType, "items", None):
        items = {item.name: float(item.value) for item in variable.declaredType.items}
    if variable.type == "Real":
        allowed = allowed_number(unit)
    else:
        allowed = f"one of {', '.join(items)}" if items else "a 32-bit integer"
    try:
        number = number_of(value, unit, items)
    except ValueError as error:
        message = must_be(variable.name, allowed, repr(value))
        raise FmuError(with_reason(message, error, value, items)) from None
    if variable.type != "Real" and not (number.is_integer() and abs(number) <= largest):
        raise FmuError(must_be(variable.name, allowed, repr(value)))
    return number


class Log:
    """Messages of an instance, oldest first: all of them, and of these the warnings and the errors."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self.warnings: list[str] = []
        self.errors: list[str] = []

    def take(self, environment: int | None, status: int, category: bytes, message: bytes) -> None:
        """Take a message, as the log callback of FMI 3.0."""
        text = message.decode("utf-8", "replace")
        self.messages.append(text)
        if status >= WARNING:
            (self.warnings if status == WARNING else self.errors).append(text)


class Ended(FmuError):
    """The FMU itself ends the simulation: in the step from the time of its instance on."""


class Kept:
    """A state kept by an instance of an FMU, and its times, s; freed with the last reference to it."""

    def __init__(self, fmu: Fmu, state: c_void_p) -> None:
        self.fmu, self.state, self.time, self.epoch = fmu, state, fmu.time, fmu._epoch

    def __del__(self) -> None:
        if self.fmu._instance is not None:
            self.fmu._instance.freeFMUstate(self.state)


class Fmu(Plant, Closing):
    """One co-simulation instance of an FMU, 2.0 or 3.0, initialised and ready to step; a context manager.

    Those of FMI 3.0 run without event mode and early return.

    Args:
        path: the .fmu file; without one that of the module, as it comes with the package or is built.
        parameters: start values by name: numbers, strings with a unit ("90 deg"), enumerations by number
            or item name.
        inputs: inputs by name, set before the end of initialisation (so no jump at the start).
        tolerance: relative tolerance of the experiment, or None.
        start_time: of the experiment, s.
        stop_time: of the experiment, s, or None.

    Attributes:
        time: the communication point reached, s.
        messages: what the FMU logged, oldest first. warnings: those of them that are warnings.
        variables: fmpy's, by name. units: unit of each variable that has one.

    Raises:
        FmuError: the file is not such an FMU, a name is unknown, or a value is invalid. All methods raise it
            for unknown names, for calls that the FMU rejects or does not support, and after close.
    """

    def __init__(
        self,
        path: Path | str | None = None,
        parameters: Mapping[str, float | bool | str] | None = None,
        inputs: Mapping[str, float | str] | None = None,
        tolerance: float | None = None,
        start_time: float = 0.0,
        stop_time: float | None = None,
    ) -> None:
        self.path = fmu_file(path)
        self.time = start_time
        self._epoch = 0.0  # time, s, at which the clock of the instance is at 0
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
        """Prepare what a kind of instance needs before the end of its initialisation."""

    def close(self) -> None:
        """Terminate and free the instance."""
        if self._instance is not None and getattr(self._instance, "component", None):
            with contextlib.suppress(Exception):
                self._instance.terminate()
            self._instance.freeInstance()
        self._instance = None

    def _call(self, function: str, *arguments: Any) -> Any:
        """Call a function of fmpy's instance; a failing status or an error it logs becomes a FmuError."""
        if self._instance is None:
            raise FmuError(f"{self.path.name} is closed: {function} requires an open instance")
        errors = self._log.errors
        errors.clear()
        try:
            found = getattr(self._instance, function)(*arguments)
        except Exception as error:
            raise FmuError("; ".join(errors) or f"{function}: {error}") from error
        if errors:
            raise FmuError("; ".join(errors))
        return found

    def set_logging(self, on: bool, *categories: str) -> None:
        """Switch log categories on or off; all of them if none is named."""
        self._call("setDebugLogging", on, categories)

    # --- values ---

    def _variable(self, name: str) -> Any:
        """Return the variable of this name; raise FmuError if there is none, or if it is no single number."""
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
        """Address of a C array of the value references of these names, kept."""
        key = tuple(names)
        if key not in self._arrays:
            self._arrays[key] = (c_uint * len(key))(*self._references(key))
        return addressof(self._arrays[key])

    def set(self, /, **values: float | bool | str) -> None:
        """Set inputs and tunable parameters by name to values: numbers, strings with a unit; all or none."""
        calls: dict[str, dict[int, float]] = {}
        for variable, value in [(self._variable(name), value) for name, value in values.items()]:
            number = {"Real": float, "Boolean": bool}.get(variable.type, int)(_number_for(variable, value))
            calls.setdefault(variable.type, {})[variable.valueReference] = number
        for kind, numbers in calls.items():
            self._call(f"set{kind}", list(numbers), list(numbers.values()))

    def read(self, names: str | Sequence[str]) -> tuple[float, ...]:
        """Read values by names, or one alone, of any type, as floats."""
        key = as_names(names)
        if key not in self._readers:
            row = np.empty((1, len(key)))
            self._readers[key] = row, Run(NO_STEPS, 0, NO_INPUTS, self._address(key), row)
        row, reading = self._readers[key]
        if getattr(self._instance, RUN, None) is not None:
            self._call(RUN, self._instance.component, byref(reading))
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
        """Advance by a communication step, s.

        Raises:
            FmuError: the FMU rejects the step and keeps its state.
            Ended: the FMU ends the simulation.
        """
        try:
            self._call("doStep", self.time - self._epoch, step)
        except FmuError as error:
            if self._has_ended(error.__cause__):
                raise Ended(f"{self.path.name} ends the simulation at {self.time:.9g} s") from error
            raise FmuError(f"at time {self.time:.9g} s: {error}") from error
        self.time += step

    def _has_ended(self, failure: BaseException | None) -> bool:
        """Tell whether the failure of a step means that the FMU ends the simulation."""
        with contextlib.suppress(Exception):
            return getattr(failure, "status", None) == DISCARD and self._instance.getBooleanStatus(TERMINATED)
        return False

    def take_steps(
        self, lengths: Array, inputs: Sequence[str], given: Array, outputs: Sequence[str], rows: Array
    ) -> None:
        """Take steps of given lengths and inputs for rows of outputs, in one call where the FMU has one."""
        if getattr(self._instance, RUN, None) is None:
            super().take_steps(lengths, inputs, given, outputs, rows)
            return
        asked = Run(lengths, self._address(inputs), given, self._address(outputs), rows)
        asked.time = self.time - self._epoch
        try:
            self._call(RUN, self._instance.component, byref(asked))
        except FmuError as error:
            raise FmuError(f"at time {asked.time + self._epoch:.9g} s: {error}") from error
        finally:
            self.time = asked.time + self._epoch

    def set_rates(self, **rates: float) -> None:
        """Give inputs rates over the coming step, by name, per second (native FMUs; see docs/fmu.md)."""
        orders, values = [1] * len(rates), list(rates.values())
        self._call("setRealInputDerivatives", self._references(tuple(rates)), orders, values)

    def rates(self, names: str | Sequence[str]) -> tuple[float, ...]:
        """Rates of outputs by names, or one alone, after the last step, per second (see docs/fmu.md)."""
        references = self._references(names)
        return tuple(self._call("getRealOutputDerivatives", references, [1] * len(references)))

    def jacobian(self, outputs: str | Sequence[str], inputs: str | Sequence[str]) -> NDArray[np.float64]:
        """Derivatives of outputs after the last step by inputs over it (native FMUs; see docs/fmu.md).

        Args:
            outputs: names, or one alone.
            inputs: likewise; tunable parameters, too.

        Returns:
            Shape (outputs, inputs), units of the output over those of the input.
        """
        unknowns, knowns = self._references(outputs), self._references(inputs)
        columns = [self._call("getDirectionalDerivative", unknowns, [known], [1.0]) for known in knowns]
        return np.array(columns, dtype=np.float64).reshape(len(knowns), len(unknowns)).T

    # --- states ---

    def get_state(self) -> Kept:
        """Keep the state to go back to; cheaper than save, and good for this instance only."""
        return Kept(self, self._call("getFMUstate"))

    def set_state(self, kept: Kept) -> None:
        """Take over a kept state of get_state, and its time."""
        # some FMUs crash on a state that is not theirs
        if not isinstance(kept, Kept) or kept.fmu is not self:
            raise FmuError("a state must be from get_state of this instance")
        self._call("setFMUstate", kept.state)
        self.time, self._epoch = kept.time, kept.epoch

    def save(self) -> bytes:
        """Serialise the whole state of the instance."""
        kept = self.get_state()
        return bytes(self._call("serializeFMUstate", kept.state))

    def restore(self, saved: bytes, time: float | None = None) -> None:
        """Take over a saved state, at the time, s, that it belongs to; None leaves that as it is."""
        if not isinstance(saved, bytes):
            raise FmuError(must_be("a state", "the bytes of save()", type(saved).__name__))
        before = self.get_state()
        try:
            after = Kept(self, self._call("deSerializeFMUstate", saved))
            self._call("setFMUstate", after.state)
        except FmuError:
            # otherwise the Python FMU would reject all further steps
            self._call("setFMUstate", before.state)
            raise
        if time is not None:
            self.time, self._epoch = time, 0.0


class RestartedFmu(Fmu):
    """Instance that can be restarted from initialisation with other start values.

    It goes back to a state kept in initialisation mode, after everything that follows from the parameters
    (the map of fidelity averaged) has been found: without the cost of a new instance.
    """

    def _before_start(self) -> None:
        # a value read here makes the native FMU derive its constants, for the state that is kept
        outputs = (v.name for v in self.variables.values() if v.causality == "output" and is_number(v))
        self.read([*outputs][:1])
        self._blank = self.get_state()

    def restart(self, values: Mapping[str, float], time: float = 0.0) -> None:
        """Start the instance again.

        Args:
            values: parameters and inputs by name; all others are those of the first start.
            time: time that the restart belongs to, s, for messages; the instance itself begins at 0.
        """
        self.messages.clear()  # a run restarts every step: only what concerns this start is kept
        self.set_state(self._blank)
        self._epoch = time - self.time
        self.time = time
        self.set(**values)
        self._call("exitInitializationMode")
