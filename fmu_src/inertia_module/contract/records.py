"""Records of doubles in memory, made from the lists of fields of the kernel (see kernel.fields).

The plain kernel works on them as ctypes unions, the compiled one on the same memory.
"""

from __future__ import annotations

import ctypes
import functools
import operator
from typing import Any, ClassVar

# a field: a name; a name and a length; a name, fields and maybe a number of records
Field = Any


def _member(field: Field) -> tuple[str, Any]:
    if isinstance(field, str):
        return field, ctypes.c_double
    name, kind, *count = field
    if isinstance(kind, int):
        return name, ctypes.c_double * kind
    inner = record_type(kind)
    return name, inner * count[0] if count else inner


@functools.cache
def record_type(fields: tuple[Field, ...]) -> type[ctypes.Union]:
    """A record with these fields, each one or more doubles, and all its doubles in a row as `numbers`."""
    inner = type("Fields", (ctypes.Structure,), {"_fields_": [_member(field) for field in fields]})
    numbers = ctypes.c_double * (ctypes.sizeof(inner) // 8)
    return type(
        "Record",
        (ctypes.Union,),
        {"_anonymous_": ("fields",), "_fields_": [("fields", inner), ("numbers", numbers)]},
    )


@functools.cache
def _counted(fields: tuple[Field, ...]) -> Any:
    """A record in which each double is its own place."""
    record = record_type(fields)()
    record.numbers[:] = range(len(record.numbers))
    return record


def size(fields: tuple[Field, ...]) -> int:
    """Doubles in a record."""
    return len(_counted(fields).numbers)


def place(fields: tuple[Field, ...], name: str) -> int:
    """Where in a record a field begins, in doubles; "forward.count" is a field of a record within.

    Raises:
        AttributeError: there is no such field.
    """
    return int(operator.attrgetter(name)(_counted(fields)))


class Run(ctypes.Structure):
    """A run, many steps in one call: struct run of the FMUs (fmu/shell/instance.h).

    Args:
        lengths: of the steps, s, shape (steps,). inputs, outputs: addresses of what says which they are.
        given: values of the inputs for each step, shape (steps, inputs). rows: for the outputs before the
            first and after each step, shape (steps + 1, outputs). All these arrays lie in one piece, but rows
            may have others in between.

    Attributes:
        time: s, for an FMU that of the step at hand. steps: to take, then those taken.
    """

    _fields_: ClassVar[Any] = (
        *(("time", ctypes.c_double), ("steps", ctypes.c_size_t), ("lengths", ctypes.c_void_p)),
        *(("input_count", ctypes.c_size_t), ("inputs", ctypes.c_void_p), ("set", ctypes.c_void_p)),
        *(("output_count", ctypes.c_size_t), ("outputs", ctypes.c_void_p), ("read", ctypes.c_void_p)),
        ("row_size", ctypes.c_size_t),
    )

    def __init__(self, time: float, lengths: Any, inputs: int, given: Any, outputs: int, rows: Any) -> None:
        super().__init__(time, len(lengths), lengths.ctypes.data)
        self.input_count, self.inputs, self.set = given.shape[1], inputs, given.ctypes.data
        self.output_count, self.outputs, self.read = rows.shape[1], outputs, rows.ctypes.data
        self.row_size = rows.strides[0] // rows.itemsize


class KernelRun(Run):
    """A run of a kernel: struct kernel_run of compiling/entry.c.

    Attributes:
        operation: that takes a step. records: addresses of p, d, u, x, y and w. rates: address of what holds
            for one step, and is 0 then. rate_count: doubles of it.
    """

    _fields_: ClassVar[Any] = (
        *(("operation", ctypes.c_int64), ("records", ctypes.c_void_p * 6)),
        *(("rates", ctypes.c_void_p), ("rate_count", ctypes.c_size_t)),
    )
