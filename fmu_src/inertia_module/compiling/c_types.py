"""Types of the kernel's language and their declarations in C."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

# scalar types; each can represent all values of the types before it
BOOL, INT, DOUBLE = SCALARS = ("bool", "int64_t", "double")
VOID = "void"


@dataclass(frozen=True, eq=False)
class Record:
    """A record of doubles: a struct, passed by its address.

    Attributes:
        name: name of the struct.
        fields: type of each field by name.
        size: number of doubles.
    """

    name: str
    fields: Mapping[str, Type]
    size: int


class Array(NamedTuple):
    """Elements in a row, passed by their address.

    Attributes:
        element: type of an element.
        length: number of elements.
        is_constant: True for a table of constants.
    """

    element: str | Record
    length: int
    is_constant: bool = False


class TupleType(NamedTuple):
    """A tuple: a struct with members item0, item1 ..., passed by value."""

    items: tuple[Type, ...]


# a type; None until the translator has determined it
Type = str | Record | Array | TupleType | None


def common_type(first: Type, second: Type) -> Type:
    """Return the type that can represent the values of both types.

    Args:
        first: a type.
        second: a type.

    Raises:
        TypeError: there is no such type.
    """
    if first is None or second is None or first == second:
        return second if first is None else first
    if isinstance(first, str) and isinstance(second, str) and VOID not in (first, second):
        return SCALARS[max(SCALARS.index(first), SCALARS.index(second), SCALARS.index(INT))]
    raise TypeError(f"no type holds the values of both {type_name(first)} and {type_name(second)}")


def type_name(kind: Type) -> str:
    """Return the name of a type; for a tuple, the name of its struct.

    Args:
        kind: the type.
    """
    if isinstance(kind, TupleType) and set(kind.items) == {DOUBLE}:
        return f"doubles_{len(kind.items)}"
    if isinstance(kind, TupleType):
        return "_".join(["tuple", *(type_name(item).removesuffix("_t") for item in kind.items)])
    if isinstance(kind, Array):
        return f"{type_name(kind.element)}[{kind.length}]"
    return kind.name if isinstance(kind, Record) else str(kind)


def declaration(kind: Type, name: str) -> str:
    """Return the declaration of a variable, an argument or a function.

    Args:
        kind: its type.
        name: its name.
    """
    if isinstance(kind, Record):
        return f"struct {kind.name} *{name}"
    if isinstance(kind, Array):
        element = f"struct {kind.element.name}" if isinstance(kind.element, Record) else kind.element
        return f"{'const ' if kind.is_constant else ''}{element} *{name}"
    return f"{type_name(kind)} {name}"


def member_declaration(kind: Type, name: str) -> str:
    """Return the declaration of a member of a struct, which contains its records and arrays.

    Args:
        kind: its type.
        name: its name.
    """
    if isinstance(kind, Array):
        return f"{member_declaration(kind.element, name)}[{kind.length}]"
    return f"struct {kind.name} {name}" if isinstance(kind, Record) else f"{type_name(kind)} {name}"
