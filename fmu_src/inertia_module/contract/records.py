"""Records of doubles in memory, made from the lists of fields of the kernel (see kernel.fields).

The plain kernel works on them as ctypes unions, the compiled one on the same memory.
"""

from __future__ import annotations

import ctypes
import functools
import operator
from typing import Any

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
