"""The error of the package, of which all others are kinds, and the sentence it says."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

Value = TypeVar("Value")

# of names that are told where none is like the one given
LISTED = 12


class Refused(ValueError):
    """Refusal: the message names the value and what is allowed. Nothing has changed."""


def sentence_of(error: BaseException) -> str:
    """Return the message of an error in one line; of an error of the system with the name of its file."""
    text = str(error)
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if isinstance(error, MemoryError):
        text = f"there is not enough memory: {text}" if text else "there is not enough memory"
    return " ".join(text.split())


def must_be(name: str, allowed: str, value: float | str) -> str:
    """Return the message for a bad value or its text: "tolerance must be between 0 and 1 (got 7)"."""
    return f"{name} must be {allowed} (got {value if isinstance(value, str) else format(value, '.16g')})"


def listed(names: Iterable[str]) -> str:
    """Return the first names, and the number of the others."""
    every = list(names)
    more = f" and {len(every) - LISTED} more" if len(every) > LISTED else ""
    return f"{', '.join(every[:LISTED])}{more}"


def did_you_mean(name: Any, known: Iterable[str]) -> str:
    """Suggest, in brackets, names for one that is not known: the nearest ones, or else which there are."""
    names, given = list(dict.fromkeys(known)), str(name).lower()
    near = sorted((one for one in names if given in one.lower()), key=len)[:3] if given else []
    near = near or difflib.get_close_matches(given, names, n=1)
    if near:
        *others, last = near
        return f"(did you mean {' or '.join([', '.join(others), last] if others else [last])}?)"
    return f"(there are {listed(names)})" if names else "(there are none)"


class UnknownName(Refused, KeyError):
    """A name that is not there."""

    __str__ = Exception.__str__  # that of KeyError puts quotes around the sentence


class Named(dict[str, Value]):
    """Values by name, which tell a name that is not there, and why one that might be there is missing.

    What they are is such as "a number of the summary".
    """

    def __init__(
        self, values: Mapping[str, Value], what: str, missing: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(values)
        self.what, self.missing = what, missing or {}

    def __missing__(self, name: str) -> Value:
        reason = self.missing.get(name) or f"must be {self.what} {did_you_mean(name, self)}"
        raise UnknownName(f"{name} {reason}")


class FmuError(Refused):
    """The FMU cannot be loaded, or refused parameters, inputs or a step: its own message."""
