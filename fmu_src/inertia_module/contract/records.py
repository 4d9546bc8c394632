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


def _text(record: ctypes.Union) -> str:
    """Return the fields of a record that are not 0, each on a line."""
    names = [_member(field)[0] for field in type(record).fields_of]  # type: ignore[attr-defined]
    lines = []
    for name in names:
        value = getattr(record, name)
        if isinstance(value, ctypes.Array):
            is_flat = issubclass(value._type_, ctypes.c_double)
            value = list(value) if is_flat else f"<{len(value)} records>"
        if any(value) if isinstance(value, list) else value != 0.0:
            lines.append(f"    {name}={value!r},")
    return "\n".join(["Record(", *lines, ")"])


@functools.cache
def record_type(fields: tuple[Field, ...]) -> type[ctypes.Union]:
    """Return the type of a record with these fields, and all its doubles in a row as `numbers`.

    A record has no other attributes: a misspelt field raises AttributeError.
    """
    inner = type("Fields", (ctypes.Structure,), {"_fields_": [_member(field) for field in fields]})
    numbers = ctypes.c_double * (ctypes.sizeof(inner) // 8)
    members = {
        **{"_anonymous_": ("fields",), "_fields_": [("fields", inner), ("numbers", numbers)]},
        **{"__slots__": (), "__repr__": _text, "fields_of": fields},
    }
    return type("Record", (ctypes.Union,), members)


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
