"""Models in memory: named values over the arrays of the kernel. The FMUs are shells of them."""

from __future__ import annotations

import ctypes
import os
import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from typing import Any, ClassVar, Self

from .common.errors import Refused, must_be, unknown
from .compiling import CompilationUnavailable
from .compiling import load as compiled
from .contract.models import DRIVEN_SHAFT, INERTIA_MODULE, RECORD_OF, Model
from .contract.records import record_type
from .contract.variables import INPUT, MAP_KEY, OUTPUT, PARAMETER, Variable
from .kernel import codes

NO_STATE = "the state must be saved by this build (it is damaged or from another build)"
# maps of fidelity averaged kept for the process: instances alike share the work of the first
MOST_MAPS = 64
# what the kernel's build_map writes and is to find again
_OF_MAP = ("map_ready", "map_key", "map_lock", "map_inertia", "map_evaluations", "forward", "backward")


@lru_cache(MOST_MAPS)
def _map_of(key: tuple[float, ...]) -> list[Any]:
    """Constants with the map of parameters, those of MAP_KEY: none yet, or one record, to be replaced."""
    return []


def choose_kernel(kernel: str, model: Model = INERTIA_MODULE) -> tuple[ctypes.CDLL | None, str]:
    """Choose the library of the compiled kernel, or None for the plain one, and why.

    Args:
        kernel: "compiled", "plain", or "auto": what the environment variable INERTIA_MODULE_KERNEL
            says, else compiled where there is such a kernel.
        model: whose.

    Raises:
        CompilationUnavailable: "compiled" was asked for and there is none.
        Refused: kernel is none of these.
    """
    if kernel == "auto":
        kernel = os.environ.get("INERTIA_MODULE_KERNEL", "auto")
    if kernel not in ("auto", "compiled", "plain"):
        raise Refused(must_be("kernel", "auto, compiled or plain", repr(kernel)))
    if kernel == "plain":
        return None, "plain Python, as requested"
    try:
        return compiled.load(model), "compiled"
    except CompilationUnavailable as error:
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
    """The records of the kernel with the start values of a model: to be copied."""
    records = tuple(record_type(fields)() for fields in model.records)
    for variable in model.with_causality(INPUT, PARAMETER):
        setattr(records[RECORD_OF[variable.causality]], variable.name, float(variable.start or 0.0))
    return records


def _copy(target: Any, source: Any) -> None:
    """Copy a record into another of the same fields."""
    ctypes.memmove(ctypes.addressof(target), ctypes.addressof(source), ctypes.sizeof(source))


class Run(ctypes.Structure):
    """Many steps in one call: struct run of fmu/shell/instance.h, and with its end that of compiling/entry.c.

    Args: as of Plant.take_steps, with addresses of what says which inputs and outputs they are.
    """

    _fields_: ClassVar[Any] = (
        *(("time", ctypes.c_double), ("steps", ctypes.c_size_t), ("lengths", ctypes.c_void_p)),
        *(("input_count", ctypes.c_size_t), ("inputs", ctypes.c_void_p), ("set", ctypes.c_void_p)),
        *(("output_count", ctypes.c_size_t), ("outputs", ctypes.c_void_p), ("read", ctypes.c_void_p)),
        *(("row_size", ctypes.c_size_t), ("operation", ctypes.c_int64), ("records", ctypes.c_void_p * 6)),
        *(("rates", ctypes.c_void_p), ("rate_count", ctypes.c_size_t)),
    )

    def __init__(self, lengths: Any, inputs: int, given: Any, outputs: int, rows: Any) -> None:
        super().__init__(0.0, len(lengths), lengths.ctypes.data)
        self.input_count, self.inputs, self.set = given.shape[1], inputs, given.ctypes.data
        self.output_count, self.outputs, self.read = rows.shape[1], outputs, rows.ctypes.data
        self.row_size = rows.strides[0] // rows.itemsize


class Plant(ABC):
    """A plant, stepped and read by names: an FMU, a model in memory, or one of these with more around it."""

    @abstractmethod
    def set(self, **values: float) -> None:
        """Set inputs."""

    @abstractmethod
    def advance(self, step: float) -> None:
        """Advance by a communication step, s."""

    @abstractmethod
    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Read values."""

    def take_steps(
        self, lengths: Any, inputs: Sequence[str], given: Any, outputs: Sequence[str], rows: Any
    ) -> None:
        """Take many steps: one by one, unless a kind of plant has one call for them, with the same bits.

        Args:
            lengths: of the steps, s, shape (steps,). inputs: names. given: values, shape (steps, inputs).
            outputs: names. rows: for values at the start and after each step, shape (steps + 1, outputs).
                Each array, and each of the rows, lies in one piece.

        Raises:
            Refused: an unknown name, a value or a step; the plant is as it was before that step.
        """
        rows[0] = self.read(outputs)
        for row, length, values in zip(rows[1:], lengths.tolist(), given.tolist(), strict=True):
            self.set(**dict(zip(inputs, values, strict=True)))
            self.advance(length)
            row[:] = self.read(outputs)


class ModelInstance(Plant):
    """A model in memory: set parameters and inputs, start, step, read.

    Args:
        kernel: see choose_kernel.

    Attributes:
        kernel: which kernel runs, and why; chosen at the start.
        started: whether start has been called with good parameters.

    Raises:
        Refused: by its methods, which then change nothing: an unknown name, a value out of its range, alone
            or with others, a parameter that is fixed after the start, a call before it, a bad step.
    """

    model: ClassVar[Model]

    def __init__(self, kernel: str = "auto") -> None:
        self._wanted = kernel
        self._compiled: ctypes.CDLL | None = None
        self.kernel = ""
        self._records = tuple(type(record).from_buffer_copy(record) for record in _at_start(self.model))
        self.parameters, self.derived, self.inputs, self.state, self.outputs, _ = self._records
        self._addresses = tuple(ctypes.addressof(record) for record in self._records)
        self.started = False

    def load_kernel(self) -> None:
        """Load the kernel (and compile it, the first time ever) now instead of at the start."""
        if not self.kernel:
            self._compiled, self.kernel = choose_kernel(self._wanted, self.model)

    def call(self, operation: int, step_size: float) -> int:
        """Call the kernel (an operation of kernel.codes) and return its status."""
        if self._compiled is not None:
            return int(self._compiled.inertia_module_kernel(operation, *self._addresses, step_size))
        return self.model.call(operation, *self._records, step_size)

    @classmethod
    def settable(cls, name: str) -> Variable:
        """Return the parameter or input of this name; raise Refused if there is none."""
        variable = cls.model.by_name.get(name)
        if variable is None or variable.causality not in (INPUT, PARAMETER):
            names = (one.name for one in cls.model.with_causality(INPUT, PARAMETER))
            raise Refused(unknown("parameter or input", name, names))
        return variable

    def set(self, **values: float | str) -> None:
        """Set parameters (after start only tunable ones) and inputs by name; all or, on an error, none.

        Args:
            values: numbers, strings with a unit, names of items of enumerations.
        """
        numbers = {}
        for name, value in values.items():
            variable = self.settable(name)
            if variable.causality == PARAMETER and self.started and not variable.is_tunable:
                raise Refused(f"{name} is not tunable and must be set before start() (got {value})")
            numbers[name] = variable.number(value)
        self.assign(numbers)

    def assign(self, numbers: Mapping[str, float]) -> None:
        """Set parameters and inputs; what follows from parameters tuned after start is derived anew."""
        changed = [name for name, number in numbers.items() if self.started and number != self[name]]
        tuned = [name for name in changed if self.record(name) is self.parameters]
        for name in tuned:
            self.model.by_name[name].number(numbers[name])
        before = {name: self[name] for name in numbers}
        self._write(numbers)
        status = self.call(codes.TUNE, 0.0) if tuned else codes.OK
        if status != codes.OK:
            reason = self.explain(status, 0.0)
            self._write(before)
            self.call(codes.CHECK, 0.0)
            raise Refused(reason)

    def _write(self, numbers: Mapping[str, float]) -> None:
        for name, number in numbers.items():
            setattr(self.record(name), name, number)

    def record(self, name: str) -> Any:
        """The record that holds a variable."""
        return self._records[RECORD_OF[self.model.by_name[name].causality]]

    def set_rates(self, **rates: float) -> None:
        """Give inputs a constant rate over the coming step, per second: they start it from their values."""
        inputs = [variable.name for variable in self.model.with_causality(INPUT)]
        for name in rates:
            if name not in inputs:
                raise Refused(unknown("input", name, inputs))
        for name, rate in rates.items():
            setattr(self.inputs, f"{name}_rate", rate)
            setattr(self.inputs, f"{name}_rate_given", 1.0)

    def rates(self) -> dict[str, float]:
        """Rates of the outputs now, per second, inputs going on as they do; a step mean has rate 0."""
        if not self.started:
            raise Refused("call start() before rates()")
        copy = type(self)("plain" if self._compiled is None else "compiled")
        copy.restore(self.save())
        self._check(copy.call(codes.RATES, 0.0), 0.0)
        return {variable.name: copy[variable.name] for variable in self.model.with_causality(OUTPUT)}

    def start(self, **values: float | str) -> Self:
        """Set values, check the parameters alone and together, and take the initial state."""
        self._prepare(values)
        self._begin()
        self.started = True
        return self

    def _begin(self) -> None:
        self._check(self.call(codes.START, 0.0), 0.0)

    def _prepare(self, values: Mapping[str, float | str]) -> None:
        self.set(**values)
        refused = self.model.refused(self.parameters)
        if refused:
            raise Refused("; ".join(refused))
        self.load_kernel()

    def advance(self, step_size: float) -> None:
        """Advance by a communication step, s."""
        if not self.started:
            raise Refused("call start() before advance()")
        self._check(self.call(codes.STEP, step_size), step_size)
        # rates of inputs, and whether they are given, come after the inputs
        rates = len(self.inputs.numbers) // 3
        self.inputs.numbers[rates:] = (0.0,) * (2 * rates)

    def take_steps(
        self, lengths: Any, inputs: Sequence[str], given: Any, outputs: Sequence[str], rows: Any
    ) -> None:
        """Take steps, in one call of a compiled kernel: see Plant."""
        ends = {one.name: one.ends for one in self.model.with_causality(INPUT)}
        within = ends.keys() >= set(inputs) and all(
            ((ends[name][0] <= values) & (values <= ends[name][1])).all()
            for name, values in zip(inputs, given.T, strict=True)
        )
        if self._compiled is None or not self.started or not within:
            super().take_steps(lengths, inputs, given, outputs, rows)
            return
        places = [(ctypes.c_void_p * len(names))(*map(self._address, names)) for names in (inputs, outputs)]
        set_at, read_at = map(ctypes.addressof, places)
        asked = Run(lengths, set_at, given, read_at, rows)
        asked.operation, asked.records = codes.STEP, self._addresses
        number = len(self.model.records[2]) // 3  # rates of inputs come after them
        asked.rates, asked.rate_count = self._addresses[2] + 8 * number, 2 * number
        status = self._compiled.inertia_module_kernel_run(ctypes.addressof(asked))
        if status != codes.OK:
            raise Refused(self.explain(status, float(lengths[asked.steps])))

    def _address(self, name: str) -> int:
        record = RECORD_OF[self.model.by_name[name].causality]
        return int(self._addresses[record]) + 8 * self.model.place(name)

    def _check(self, status: int, step_size: float) -> None:
        if status != codes.OK:
            raise Refused(self.explain(status, step_size))

    def warnings(self) -> list[str]:
        """Return a sentence for each warning on accepted parameters."""
        found = self.call(codes.WARN, 0.0) if self.model.warnings else 0
        return [self._filled(text, 0.0) for number, text in self.model.warnings.items() if found & number]

    def explain(self, status: int, step_size: float) -> str:
        """Sentence for a status of the kernel, not OK, after a communication step, s."""
        return self._filled(self.model.messages[status], step_size)

    def _filled(self, text: str, step_size: float) -> str:
        """A sentence with the values in their places."""
        values = {"step": f"{step_size:.16g}"}
        for record, names in ((self.parameters, self.model.records[0]), (self.inputs, self.model.records[2])):
            values |= {name: f"{getattr(record, name):.16g}" for name in names}
        return text.format_map(values)

    def __getitem__(self, name: str) -> float:
        """Value of any variable by its name."""
        value: float = getattr(self.record(name), name)
        return value

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values of variables by name."""
        return tuple([self[name] for name in names])

    def save(self) -> bytes:
        """Serialise the state bit for bit: kind of model, started or not, build, records."""
        return self._head(self.started) + b"".join(bytes(record) for record in self._records[:5])

    def _head(self, started: bool) -> bytes:
        return f"{self.model.name}{int(started)}{self.model.source_hash}".encode()

    def restore(self, saved: bytes, must_be_started: bool = False) -> None:
        """Take over a state of save; refused is what is none, is damaged or of another build.

        Args:
            saved: the state. must_be_started: refuse one that was saved before the start.
        """
        start = len(self._head(False))
        size = start + sum(ctypes.sizeof(record) for record in self._records[:5])
        if len(saved) != size:
            raise Refused(
                f"the state must be saved by this build, with {size} bytes (got {len(saved)} bytes)"
            )
        started = saved.startswith(self._head(True))
        if not started and not saved.startswith(self._head(False)):
            raise Refused(NO_STATE)
        parts = {}
        for name, record in zip("pduxy", self._records, strict=False):
            parts[name] = type(record).from_buffer_copy(saved, start)
            start += ctypes.sizeof(record)
        if must_be_started and not started:
            raise Refused("the state must be saved after the start")
        # a number used as an index or a choice must be one
        sound = all(bound.accepts(parts[bound.record].numbers[bound.place]) for bound in self.model.bounds)
        if not sound or (started and self.model.refused(parts["p"])):
            raise Refused(NO_STATE)
        self.load_kernel()
        if started:
            parts["d"] = self._derived_anew(parts["p"], parts["d"])
        self.started = started
        for record, part in zip(self._records, parts.values(), strict=False):
            _copy(record, part)

    def _derived_anew(self, parameters: Any, derived: Any) -> Any:
        """The constants of a saved state, calculated from its parameters: the kernel counts by them."""
        trial = type(self)("plain" if self._compiled is None else "compiled")
        trial.load_kernel()
        _copy(trial.parameters, parameters)
        _copy(trial.derived, derived)
        if trial.call(codes.CHECK, 0.0) != codes.OK:
            raise Refused(NO_STATE)
        return trial.derived

    def snapshot(self) -> dict[str, Any]:
        """All variables by name."""
        return {name: self[name] for name in self.model.by_name}


class Module(ModelInstance):
    """An inertia module; kernel: see choose_kernel."""

    model = INERTIA_MODULE

    def check(self, **values: float | str) -> None:
        """Set values and check the parameters, alone and together, without starting."""
        self._prepare(values)
        self._check(self.call(codes.CHECK, 0.0), 0.0)

    def _begin(self) -> None:
        """Start with the map of fidelity averaged that another instance has made, if there is one."""
        if self.parameters.fidelity != codes.AVERAGED:
            super()._begin()
            return
        kept = _map_of(tuple(getattr(self.parameters, name) for name in MAP_KEY))
        for known in kept[:]:
            for name in _OF_MAP:
                setattr(self.derived, name, getattr(known, name))
        super()._begin()
        kept[:] = [type(self.derived).from_buffer_copy(self.derived)]


class DrivenShaft(ModelInstance):
    """The elastic output alone: hub of given speed, shaft, driven mass; kernel: see choose_kernel."""

    model = DRIVEN_SHAFT
