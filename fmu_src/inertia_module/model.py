"""Models in memory: access by name to the records of the kernel. The FMUs wrap the same kernel."""

from __future__ import annotations

import ctypes
import os
import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, Self

from .common.errors import ParameterError, must_be, unknown
from .compiling import CompilationError
from .compiling import load as compiled
from .interface.models import DRIVEN_SHAFT, INERTIA_MODULE, RECORD_OF, Model
from .interface.records import record_type
from .interface.variables import INPUT, MAP_KEY, OUTPUT, PARAMETER, Variable
from .kernel import codes

if TYPE_CHECKING:  # the Python FMU runs without NumPy
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

INVALID_STATE = "the state must be saved by this build (it is damaged or from another build)"
# maximum number of stored maps of fidelity averaged: equal instances share the map of the first one
MAX_MAPS = 64
# constants that build_map of the kernel writes and reuses
_MAP_FIELDS = ("map_ready", "map_key", "map_lock", "map_evaluations", "forward", "backward")


@lru_cache(MAX_MAPS)
def _map_of(key: tuple[float, ...]) -> list[Any]:
    """Return the list that stores the map of fidelity averaged: it is empty or contains one record.

    Args:
        key: values of the parameters MAP_KEY.
    """
    return []


def choose_kernel(kernel: str, model: Model = INERTIA_MODULE) -> tuple[ctypes.CDLL | None, str]:
    """Choose between the compiled kernel and plain Python.

    Args:
        kernel: "compiled", "plain" or "auto". With "auto" the environment variable INERTIA_MODULE_KERNEL
            decides; without it the kernel is compiled if that is possible.
        model: model of the kernel.

    Returns:
        Library of the compiled kernel, or None for plain Python; and a text with the reason.

    Raises:
        CompilationError: kernel is "compiled", and no compiled kernel is available.
        ParameterError: kernel has another value.
    """
    if kernel == "auto":
        kernel = os.environ.get("INERTIA_MODULE_KERNEL", "auto")
    if kernel not in ("auto", "compiled", "plain"):
        raise ParameterError(must_be("kernel", "auto, compiled or plain", repr(kernel)))
    if kernel == "plain":
        return None, "plain Python, as requested"
    try:
        return compiled.load(model), "compiled"
    except CompilationError as error:
        if kernel == "compiled":
            raise
        warnings.warn(
            f"the kernel runs as plain Python, 100 times slower. No compiled kernel is available: {error}",
            RuntimeWarning,
            stacklevel=4,
        )
        return None, f"plain Python (no compiled kernel is available: {error})"


@cache
def _at_start(model: Model) -> tuple[Any, ...]:
    """Return the records of the kernel with the start values of a model; instances copy them."""
    records = tuple(record_type(fields)() for fields in model.records)
    for variable in model.with_causality(INPUT, PARAMETER):
        setattr(records[RECORD_OF[variable.causality]], variable.name, float(variable.start or 0.0))
    return records


def _copy(target: Any, source: Any) -> None:
    """Copy a record to a record with the same fields."""
    ctypes.memmove(ctypes.addressof(target), ctypes.addressof(source), ctypes.sizeof(source))


class Run(ctypes.Structure):
    """Many steps in one call: struct run of fmu/shell/instance.h, and the longer one of compiling/entry.c.

    Args:
        lengths: lengths of the steps, s, shape (steps,).
        inputs: address of a C array that identifies the inputs: value references, or addresses of doubles.
        input_rows: values of the inputs, shape (steps, inputs).
        outputs: address of a C array that identifies the outputs, like inputs.
        rows: array for the outputs at the start and after each step, shape (steps + 1, outputs).
    """

    _fields_: ClassVar[Any] = (
        *(("time", ctypes.c_double), ("steps", ctypes.c_size_t), ("lengths", ctypes.c_void_p)),
        *(("input_count", ctypes.c_size_t), ("inputs", ctypes.c_void_p), ("set", ctypes.c_void_p)),
        *(("output_count", ctypes.c_size_t), ("outputs", ctypes.c_void_p), ("read", ctypes.c_void_p)),
        *(("row_size", ctypes.c_size_t), ("operation", ctypes.c_int64), ("records", ctypes.c_void_p * 6)),
        *(("rates", ctypes.c_void_p), ("rate_count", ctypes.c_size_t)),
    )

    def __init__(self, lengths: Array, inputs: int, input_rows: Array, outputs: int, rows: Array) -> None:
        super().__init__(0.0, len(lengths), lengths.ctypes.data)
        self.input_count, self.inputs, self.set = input_rows.shape[1], inputs, input_rows.ctypes.data
        self.output_count, self.outputs, self.read = rows.shape[1], outputs, rows.ctypes.data
        self.row_size = rows.strides[0] // rows.itemsize


class Plant(ABC):
    """Interface of a plant with access by name: an FMU, a model in memory, or a wrapper of one."""

    @abstractmethod
    def set(self, **values: float) -> None:
        """Set inputs.

        Args:
            values: numbers by name.
        """

    @abstractmethod
    def advance(self, step: float) -> None:
        """Advance by a communication step.

        Args:
            step: length of the step, s.
        """

    @abstractmethod
    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Return values by name.

        Args:
            names: names of variables.
        """

    def take_steps(
        self, lengths: Array, inputs: Sequence[str], input_rows: Array, outputs: Sequence[str], rows: Array
    ) -> None:
        """Take many steps.

        Some plants have one call for many steps; its results are bitwise identical. All arrays must be
        contiguous; for rows it is sufficient that each row is contiguous.

        Args:
            lengths: lengths of the steps, s, shape (steps,).
            inputs: names of the inputs.
            input_rows: values of the inputs, shape (steps, inputs).
            outputs: names of the outputs.
            rows: array for the outputs at the start and after each step, shape (steps + 1, outputs).

        Raises:
            ParameterError: a name is unknown, or a value or a step is invalid; the plant keeps the state
                before this step.
        """
        rows[0] = self.read(outputs)
        for row, length, values in zip(rows[1:], lengths.tolist(), input_rows.tolist(), strict=True):
            self.set(**dict(zip(inputs, values, strict=True)))
            self.advance(length)
            row[:] = self.read(outputs)


class ModelInstance(Plant):
    """A model in memory: set parameters and inputs, start, step, read.

    Args:
        kernel: "compiled", "plain" or "auto" (see choose_kernel).

    Attributes:
        kernel: kernel in use, with the reason; chosen at the start.
        started: True after start with valid parameters.
        parameters: record p.
        derived: record d, the constants.
        inputs: record u.
        state: record x.
        outputs: record y.

    Raises:
        ParameterError: raised by the methods, which then change nothing. A name is unknown; a value is out
            of range, alone or in combination; a fixed parameter is set after the start; a call requires the
            start; a step is invalid.
    """

    model: ClassVar[Model]

    def __init__(self, kernel: str = "auto") -> None:
        self._kernel_choice = kernel
        self._compiled: ctypes.CDLL | None = None
        self.kernel = ""
        self._records = tuple(type(record).from_buffer_copy(record) for record in _at_start(self.model))
        self.parameters, self.derived, self.inputs, self.state, self.outputs, _ = self._records
        self._addresses = tuple(ctypes.addressof(record) for record in self._records)
        self.started = False

    def __repr__(self) -> str:
        return f"{type(self).__name__}({'started' if self.started else 'not started'})"

    def load_kernel(self) -> None:
        """Load the kernel now instead of at the start; compile it if the cache does not contain it."""
        if not self.kernel:
            self._compiled, self.kernel = choose_kernel(self._kernel_choice, self.model)

    def call(self, operation: int, step_size: float) -> int:
        """Call the kernel and return its status.

        Args:
            operation: operation of kernel.codes.
            step_size: communication step, s; only steps use it.
        """
        if self._compiled is not None:
            return int(self._compiled.inertia_module_kernel(operation, *self._addresses, step_size))
        return self.model.call(operation, *self._records, step_size)

    @classmethod
    def settable(cls, name: str) -> Variable:
        """Return a parameter or an input.

        Args:
            name: name of the variable.

        Raises:
            ParameterError: there is no such parameter or input.
        """
        variable = cls.model.by_name.get(name)
        if variable is None or variable.causality not in (INPUT, PARAMETER):
            names = (other.name for other in cls.model.with_causality(INPUT, PARAMETER))
            raise ParameterError(unknown("parameter or input", name, names))
        return variable

    def set(self, **values: float | str) -> None:
        """Set parameters (after start only tunable ones) and inputs by name; after an error none is set.

        Args:
            values: numbers, strings with a unit, or names of items of enumerations.
        """
        numbers = {}
        for name, value in values.items():
            variable = self.settable(name)
            if variable.causality == PARAMETER and self.started and not variable.is_tunable:
                raise ParameterError(f"{name} is not tunable and must be set before start() (got {value})")
            numbers[name] = variable.number(value)
        self.assign(numbers)

    def assign(self, numbers: Mapping[str, float]) -> None:
        """Set parameters and inputs; parameters tuned after the start update the constants.

        Args:
            numbers: numbers in the units of the variables, by name.

        Raises:
            ParameterError: a tuned parameter is out of range, alone or in combination; nothing changes.
        """
        changed = [name for name, number in numbers.items() if self.started and number != self[name]]
        tuned = [name for name in changed if self.record(name) is self.parameters]
        for name in tuned:
            self.model.by_name[name].number(numbers[name])
        before = {name: self[name] for name in numbers}
        self._write(numbers)
        status = self.call(codes.UPDATE_PARAMETERS, 0.0) if tuned else codes.OK
        if status != codes.OK:
            reason = self.explain(status, 0.0)
            self._write(before)
            self.call(codes.CHECK, 0.0)
            raise ParameterError(reason)

    def _write(self, numbers: Mapping[str, float]) -> None:
        for name, number in numbers.items():
            setattr(self.record(name), name, number)

    def record(self, name: str) -> ctypes.Union:
        """Return the record of a variable.

        Args:
            name: name of the variable.
        """
        record: ctypes.Union = self._records[RECORD_OF[self.model.by_name[name].causality]]
        return record

    def set_rates(self, **rates: float) -> None:
        """Set constant rates of inputs for the next step, which starts at their present values.

        Args:
            rates: rates by name, in units of the inputs per second.
        """
        inputs = [variable.name for variable in self.model.with_causality(INPUT)]
        for name in rates:
            if name not in inputs:
                raise ParameterError(unknown("input", name, inputs))
        for name, rate in rates.items():
            setattr(self.inputs, f"{name}_rate", rate)
            setattr(self.inputs, f"{name}_has_rate", 1.0)

    def rates(self) -> dict[str, float]:
        """Return the present rates of the outputs by name, per second; a step mean has rate 0.

        The inputs continue as in the last step.
        """
        if not self.started:
            raise ParameterError("call start() before rates()")
        copy = type(self)("plain" if self._compiled is None else "compiled")
        copy.restore(self.save())
        self._check(copy.call(codes.OUTPUT_DERIVATIVES, 0.0), 0.0)
        return {variable.name: copy[variable.name] for variable in self.model.with_causality(OUTPUT)}

    def start(self, **values: float | str) -> Self:
        """Set values, check the parameters alone and in combination, and compute the initial state.

        Args:
            values: parameters and inputs by name: numbers, strings with a unit, names of items.

        Returns:
            This instance.
        """
        self._prepare(values)
        self._begin()
        self.started = True
        return self

    def _begin(self) -> None:
        self._check(self.call(codes.START, 0.0), 0.0)

    def _prepare(self, values: Mapping[str, float | str]) -> None:
        self.set(**values)
        problems = self.model.range_errors(self.parameters)
        if problems:
            raise ParameterError("; ".join(problems))
        self.load_kernel()

    def advance(self, step_size: float) -> None:
        """Advance by a communication step.

        Args:
            step_size: length of the step, s.
        """
        if not self.started:
            raise ParameterError("call start() before advance()")
        self._check(self.call(codes.STEP, step_size), step_size)
        # the record of the inputs contains their values, then the rates and the flags "rate is given"
        rates = len(self.inputs.numbers) // 3
        self.inputs.numbers[rates:] = (0.0,) * (2 * rates)

    def take_steps(
        self, lengths: Array, inputs: Sequence[str], input_rows: Array, outputs: Sequence[str], rows: Array
    ) -> None:
        """Take many steps; a compiled kernel takes them in one call.

        Late outputs that no row contains are computed once, after the last step.

        Args:
            lengths: lengths of the steps, s, shape (steps,).
            inputs: names of the inputs.
            input_rows: values of the inputs, shape (steps, inputs).
            outputs: names of the outputs.
            rows: array for the outputs at the start and after each step, shape (steps + 1, outputs).
        """
        ends = {variable.name: variable.ends for variable in self.model.with_causality(INPUT)}
        inputs_in_range = ends.keys() >= set(inputs) and all(
            ((ends[name][0] <= values) & (values <= ends[name][1])).all()
            for name, values in zip(inputs, input_rows.T, strict=True)
        )
        if self._compiled is None or not self.started or not inputs_in_range:
            super().take_steps(lengths, inputs, input_rows, outputs, rows)
            return
        places = [(ctypes.c_void_p * len(names))(*map(self._address, names)) for names in (inputs, outputs)]
        set_at, read_at = map(ctypes.addressof, places)
        request = Run(lengths, set_at, input_rows, read_at, rows)
        is_late = any(self.model.by_name[name].late for name in outputs)
        request.operation = codes.STEP if is_late else codes.STEP_ONLY
        request.records = self._addresses
        number = len(self.model.records[2]) // 3  # the record contains values, then rates and flags
        request.rates, request.rate_count = self._addresses[2] + 8 * number, 2 * number
        status = self._compiled.inertia_module_kernel_run(ctypes.addressof(request))
        if request.steps > 0 and not is_late:
            self.call(codes.OUTPUTS, 0.0)
        if status != codes.OK:
            raise ParameterError(self.explain(status, float(lengths[request.steps])))

    def _address(self, name: str) -> int:
        record = RECORD_OF[self.model.by_name[name].causality]
        return int(self._addresses[record]) + 8 * self.model.place(name)

    def _check(self, status: int, step_size: float) -> None:
        if status != codes.OK:
            raise ParameterError(self.explain(status, step_size))

    def warnings(self) -> list[str]:
        """Return a sentence for each warning about accepted parameters."""
        mask = self.call(codes.WARN, 0.0) if self.model.warnings else 0
        return [self._with_values(text, 0.0) for bit, text in self.model.warnings.items() if mask & bit]

    def explain(self, status: int, step_size: float) -> str:
        """Return the message for a status of the kernel.

        Args:
            status: status of kernel.codes except OK.
            step_size: communication step, s.
        """
        return self._with_values(self.model.messages[status], step_size)

    def _with_values(self, text: str, step_size: float) -> str:
        """Return a message with the values inserted."""
        values = {"step": f"{step_size:.16g}"}
        for record, names in ((self.parameters, self.model.records[0]), (self.inputs, self.model.records[2])):
            values |= {name: f"{getattr(record, name):.16g}" for name in names}
        return text.format_map(values)

    def __getitem__(self, name: str) -> float:
        """Return the value of a variable.

        Args:
            name: name of the variable.
        """
        value: float = getattr(self.record(name), name)
        return value

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Return the values of variables.

        Args:
            names: names of the variables.
        """
        return tuple([self[name] for name in names])

    def save(self) -> bytes:
        """Return the bit-exact state: name of the model, a digit for started, hash of the build, records."""
        return self._header(self.started) + b"".join(bytes(record) for record in self._records[:5])

    def _header(self, started: bool) -> bytes:
        return f"{self.model.name}{int(started)}{self.model.source_hash}".encode()

    def restore(self, saved: bytes, must_be_started: bool = False) -> None:
        """Restore a state that save has returned.

        Args:
            saved: the state.
            must_be_started: True to reject a state that was saved before the start.

        Raises:
            ParameterError: the state is not from this build, is damaged, or was saved before the start.
        """
        start = len(self._header(False))
        size = start + sum(ctypes.sizeof(record) for record in self._records[:5])
        if len(saved) != size:
            raise ParameterError(
                f"the state must be saved by this build, with {size} bytes (got {len(saved)} bytes)"
            )
        started = saved.startswith(self._header(True))
        if not started and not saved.startswith(self._header(False)):
            raise ParameterError(INVALID_STATE)
        parts = {}
        for name, record in zip("pduxy", self._records, strict=False):
            parts[name] = type(record).from_buffer_copy(saved, start)
            start += ctypes.sizeof(record)
        if must_be_started and not started:
            raise ParameterError("the state must be saved after the start")
        # an index or a choice out of its range would crash the kernel
        is_valid = all(bound.accepts(parts[bound.record].numbers[bound.place]) for bound in self.model.bounds)
        if not is_valid or (started and self.model.range_errors(parts["p"])):
            raise ParameterError(INVALID_STATE)
        self.load_kernel()
        if started:
            parts["d"] = self._recalculated(parts["p"], parts["d"])
        self.started = started
        for record, part in zip(self._records, parts.values(), strict=False):
            _copy(record, part)

    def _recalculated(self, parameters: Any, derived: Any) -> Any:
        """Return the constants of a saved state, recalculated from its parameters.

        The kernel relies on them, so the saved ones are not trusted.
        """
        copy = type(self)("plain" if self._compiled is None else "compiled")
        copy.load_kernel()
        _copy(copy.parameters, parameters)
        _copy(copy.derived, derived)
        if copy.call(codes.CHECK, 0.0) != codes.OK:
            raise ParameterError(INVALID_STATE)
        return copy.derived

    def snapshot(self) -> dict[str, float]:
        """Return the values of all variables by name."""
        return {name: self[name] for name in self.model.by_name}


class Module(ModelInstance):
    """An inertia module in memory.

    Args:
        kernel: "compiled", "plain" or "auto" (see choose_kernel).
    """

    model = INERTIA_MODULE

    def check(self, **values: float | str) -> None:
        """Set values and check the parameters, alone and in combination, without starting.

        Args:
            values: parameters and inputs by name: numbers, strings with a unit, names of items.

        Raises:
            ParameterError: a name is unknown, or a value is out of range, alone or in combination.
        """
        self._prepare(values)
        self._check(self.call(codes.CHECK, 0.0), 0.0)

    def _begin(self) -> None:
        """Start with the stored map of fidelity averaged, if another instance has computed it."""
        if self.parameters.fidelity != codes.AVERAGED:
            super()._begin()
            return
        stored = _map_of(tuple(getattr(self.parameters, name) for name in MAP_KEY))
        for constants in stored[:]:
            for name in _MAP_FIELDS:
                setattr(self.derived, name, getattr(constants, name))
        super()._begin()
        stored[:] = [type(self.derived).from_buffer_copy(self.derived)]

    def start_steady(self, period: float, **values: float | str) -> Self:
        """Start in the periodic orbit with the output held at omega_out_start.

        The means and maxima of the last step then are over one period.

        Args:
            period: angle of the pinion shaft after which the motion repeats, rad.
            values: parameters and inputs by name, as in start.

        Raises:
            ParameterError: the parameters are invalid, or there is no periodic orbit.
        """
        self._prepare(values)
        self._check(self.call(codes.START_STEADY, period), period)
        self.started = True
        return self


class DrivenShaft(ModelInstance):
    """The elastic output as a separate model in memory: hub with prescribed speed, shaft, driven mass.

    Args:
        kernel: "compiled", "plain" or "auto" (see choose_kernel).
    """

    model = DRIVEN_SHAFT
