"""Records of doubles in memory, made from the lists of fields of the kernel (see kernel.fields).

The plain kernel works on them as ctypes unions, the compiled one on the same memory.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Sequence
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


def size(fields: tuple[Field, ...]) -> int:
    """Doubles in a record."""
    return ctypes.sizeof(record_type(fields)) // 8


def place(fields: Sequence[Field], name: str) -> int:
    """Where in a record the field of this name begins, in doubles; "forward.count" is a field of a record
    within.

    Raises:
        KeyError: there is no such field.
    """
    at = 0
    first, _, inner = name.partition(".")
    for field in fields:
        found, kind = _member(field)
        if found == first:
            return at + place(field[1], inner) if inner else at
        at += ctypes.sizeof(kind) // 8
    raise KeyError(name)
