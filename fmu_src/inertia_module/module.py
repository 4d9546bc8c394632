"""Models in memory: named values over the arrays of the kernel. The FMUs are shells of them."""

from __future__ import annotations

import ctypes
import os
import struct
from collections.abc import Callable
from typing import Any, ClassVar, Self

from . import compiled, maps
from .entries import MODULE, CompilationUnavailable, source_hash
from .kernel import codes
from .model import DRIVEN_SHAFT, INERTIA_MODULE, Model
from .records import record_type
from .variables import INPUT, OUTPUT, PARAMETER, default_parameters, refusal, refused_parameters


class Refused(ValueError):
    """Bad parameters, inputs or steps: the message names them and what is allowed. Nothing has changed."""


def choose_kernel(kernel: str, name: str = MODULE) -> tuple[Callable[..., int] | None, str]:
    """The compiled entry, or None for the plain kernel, and a word on why.

    Args:
        kernel: "compiled", "plain", or "auto": what the environment variable INERTIA_MODULE_KERNEL
            says, else compiled where there is such a kernel.
        name: which of entries.ENTRIES.

    Raises:
        CompilationUnavailable: "compiled" was asked for and cannot be had.
        Refused: another word.
    """
    if kernel == "auto":
        kernel = os.environ.get("INERTIA_MODULE_KERNEL", "auto")
    if kernel == "plain":
        return None, "plain Python, as asked for"
    if kernel == "compiled":
        return compiled.load(name), "compiled"
    if kernel != "auto":
        raise Refused(f"kernel = {kernel!r} is refused: allowed is auto, compiled or plain")
    try:
        return compiled.load(name), "compiled"
    except CompilationUnavailable as error:
        return None, f"plain Python, for there is no compiled one ({error})"


class ModelInstance:
    """A model in memory: set parameters and inputs, start, step, read.

    Args:
        kernel: see choose_kernel.

    Attributes:
        kernel: which kernel runs, and why; chosen at the start.
        started: whether start has been called with good parameters.
    """

    model: ClassVar[Model]

    def __init__(self, kernel: str = "auto") -> None:
        self._wanted = kernel
        self._entry: Callable[..., int] | None = None
        self.kernel = ""
        self._records = tuple(record_type(fields)() for fields in self.model.records)
        self.parameters, self.derived, self.inputs, self.state, self.outputs, _ = self._records
        for name, value in default_parameters(self.model.variables).items():
            setattr(self.parameters, name, value)
        self._addresses = tuple(ctypes.addressof(record) for record in self._records)
        self.started = False

    def load_kernel(self) -> None:
        """Load the kernel (and compile it, the first time ever) now instead of at the start."""
        if not self.kernel:
            self._entry, self.kernel = choose_kernel(self._wanted, self.model.entry)

    def call(self, operation: int, step_size: float) -> int:
        """Call the kernel (an operation of kernel.codes) and return its status."""
        if self._entry is not None:
            return self._entry(operation, *self._addresses, step_size)
        return self.model.call(operation, *self._records, step_size)

    def set(self, **values: float) -> None:
        """Set parameters (before start) and inputs by name; all of them or, on an error, none.

        Raises:
            Refused: an unknown name, a value out of its range, or a parameter after start.
        """
        places = []
        known = self.model.by_name
        for name, value in values.items():
            variable = known.get(name)
            if variable is None or variable.causality not in (INPUT, PARAMETER):
                settable = ", ".join(v.name for v in known.values() if v.causality in (INPUT, PARAMETER))
                raise Refused(f"{name} is refused: no such parameter or input; allowed are {settable}")
            if variable.causality == PARAMETER and self.started:
                raise Refused(
                    f"{name} = {value} is refused: parameters are fixed once the module has started"
                )
            if not variable.accepts(float(value)):
                raise Refused(refusal(variable, float(value)))
            places.append(
                (self.inputs if variable.causality == INPUT else self.parameters, name, float(value))
            )
        for record, name, value in places:
            setattr(record, name, value)

    def set_rates(self, **rates: float) -> None:
        """Give inputs a constant rate over the coming step, per second: they start it from their values.

        Raises:
            Refused: an unknown input; no rate is set.
        """
        inputs = [variable.name for variable in self.model.with_causality(INPUT)]
        for name in rates:
            if name not in inputs:
                raise Refused(f"the rate of {name} is refused: allowed are those of {', '.join(inputs)}")
        for name, rate in rates.items():
            setattr(self.inputs, f"{name}_rate", rate)
            setattr(self.inputs, f"{name}_rate_given", 1.0)

    def _forget_rates(self) -> None:
        for variable in self.model.with_causality(INPUT):
            setattr(self.inputs, f"{variable.name}_rate", 0.0)
            setattr(self.inputs, f"{variable.name}_rate_given", 0.0)

    def rates(self) -> dict[str, float]:
        """Rates of the outputs now, per second, inputs going on as they do; a step mean has rate 0.

        Raises:
            Refused: the instance has not been started, or a step from here is refused.
        """
        if not self.started:
            raise Refused("rates are refused: the module has not been started")
        copy = type(self)("plain" if self._entry is None else "compiled")
        copy.restore(self.save())
        self._check(copy.call(codes.RATES, 0.0), 0.0)
        return {variable.name: copy[variable.name] for variable in self.model.with_causality(OUTPUT)}

    def start(self, **values: float) -> Self:
        """Set values, check the parameters alone and together, and take the initial state.

        Raises:
            Refused: with one line for each thing that is wrong.
        """
        self._prepare(values)
        self._begin()
        self.started = True
        return self

    def _begin(self) -> None:
        self._check(self.call(codes.START, 0.0), 0.0)

    def _prepare(self, values: dict[str, float]) -> None:
        self.set(**values)
        refused = refused_parameters(
            {name: self[name] for name in self.model.records[0]}, self.model.variables
        )
        if refused:
            raise Refused("; ".join(refused))
        self.load_kernel()

    def advance(self, step_size: float) -> None:
        """Advance by a communication step, s.

        Raises:
            Refused: bad inputs or step, or work without end; the state is as it was.
        """
        if not self.started:
            raise Refused("a step is refused: the module has not been started")
        self._check(self.call(codes.STEP, step_size), step_size)
        self._forget_rates()

    def _check(self, status: int, step_size: float) -> None:
        if status != codes.OK:
            raise Refused(self.model.explain(status, self.parameters, self.inputs, step_size))

    def __getitem__(self, name: str) -> float:
        """Value of any variable by its name."""
        variable = self.model.by_name[name]
        if variable.causality == INPUT:
            record = self.inputs
        elif variable.causality == PARAMETER:
            record = self.parameters
        else:
            record = self.outputs
        value: float = getattr(record, name)
        return value

    @property
    def _magic(self) -> bytes:
        return self.model.name.encode()

    def save(self) -> bytes:
        """Everything that makes up the state, bit for bit."""
        head = self._magic + struct.pack("<?", self.started) + source_hash().encode()
        return head + b"".join(bytes(record) for record in self._records[:5])

    def restore(self, saved: bytes) -> None:
        """Take over a state of save.

        Raises:
            Refused: it is not one, or of another build; nothing is changed.
        """
        head = len(self._magic) + 1
        start = head + len(source_hash())
        size = start + sum(ctypes.sizeof(record) for record in self._records[:5])
        if len(saved) != size or saved[: len(self._magic)] != self._magic:
            raise Refused(
                f"a state of {len(saved)} bytes is refused: allowed is one saved by this build ({size} bytes)"
            )
        if saved[head:start] != source_hash().encode():
            raise Refused("a state of another build is refused: allowed is one saved by this build")
        self.load_kernel()
        self.started = bool(saved[len(self._magic)])
        for record in self._records[:5]:
            ctypes.memmove(ctypes.addressof(record), saved[start:], ctypes.sizeof(record))
            start += ctypes.sizeof(record)

    def snapshot(self) -> dict[str, Any]:
        """All variables by name."""
        return {name: self[name] for name in self.model.by_name}


class Module(ModelInstance):
    """An inertia module."""

    model = INERTIA_MODULE

    def check(self, **values: float) -> None:
        """Set values and check the parameters, alone and together, without starting.

        Raises:
            Refused: as start.
        """
        self._prepare(values)
        self._check(self.call(codes.CHECK, 0.0), 0.0)

    def _begin(self) -> None:
        """Start with the map of fidelity averaged that another instance has made, if there is one."""
        averaged = self.parameters.fidelity == codes.AVERAGED
        if averaged:
            maps.recall(self.parameters, self.derived)
        super()._begin()
        if averaged:
            maps.keep(self.parameters, self.derived)


class DrivenShaft(ModelInstance):
    """The elastic output alone: hub of given speed, shaft, driven mass."""

    model = DRIVEN_SHAFT
