"""Records of doubles in memory, made from the lists of fields of the kernel (see kernel.fields).

The plain kernel accesses them as ctypes unions; the compiled kernel accesses the same memory.
"""

from __future__ import annotations

import ctypes
import functools
import operator
from typing import Any

# a field: a name; a name and a length; a name and fields, optionally with a number of records
Field = Any


def _member(field: Field) -> tuple[str, Any]:
    """Return the name and the ctypes type of a field."""
    if isinstance(field, str):
        return field, ctypes.c_double
    name, kind, *count = field
    if isinstance(kind, int):
        return name, ctypes.c_double * kind
    inner = record_type(kind)
    return name, inner * count[0] if count else inner


def _text(record: ctypes.Union) -> str:
    """Return a text with the fields of a record that are not 0, one per line."""
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
    """Return the type of a record with these fields; `numbers` contains all its doubles in a row.

    A record has no other attributes: a misspelt field raises AttributeError.

    Args:
        fields: list of fields.
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
    """Return a record in which each double is equal to its index."""
    record = record_type(fields)()
    record.numbers[:] = range(len(record.numbers))
    return record


def size(fields: tuple[Field, ...]) -> int:
    """Return the number of doubles in a record.

    Args:
        fields: list of fields.
    """
    return len(_counted(fields).numbers)


def place(fields: tuple[Field, ...], name: str) -> int:
    """Return the place of a field in a record, doubles.

    Args:
        fields: list of fields of the record.
        name: name of the field; "forward.count" is a field of an inner record.

    Raises:
        AttributeError: there is no such field.
    """
    return int(operator.attrgetter(name)(_counted(fields)))
