"""The errors of the package and their messages.

Forms: "NAME must be ALLOWED (got VALUE)", "unknown KIND 'NAME'; did you mean 'OTHER'?" and
"cannot read FILE: REASON". A remedy follows as a sentence of its own.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

Value = TypeVar("Value")

# number of available names that a message lists
LISTED = 12


class Refused(ValueError):
    """Invalid value, name or call: the message contains the value and the allowed range. Nothing changes."""


def sentence_of(error: BaseException) -> str:
    """Return the message of an error in one line; of an error of the system with the name of its file."""
    text = str(error)
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if isinstance(error, MemoryError):
        text = f"out of memory: {text}" if text else "out of memory"
    return " ".join(text.split())


def must_be(name: str, allowed: str, value: float | str) -> str:
    """Return the message for a bad value or its text: "tolerance must be between 0 and 1 (got 7)"."""
    return f"{name} must be {allowed} (got {value if isinstance(value, str) else format(value, '.16g')})"


def listed(names: Iterable[str]) -> str:
    """Return the first names, and the number of the others."""
    every = list(names)
    more = f" and {len(every) - LISTED} more" if len(every) > LISTED else ""
    return f"{', '.join(every[:LISTED])}{more}"


def alternatives(words: Sequence[str]) -> str:
    """Return words as alternatives: "a", "a or b", "a, b or c"."""
    *others, last = words
    return " or ".join([", ".join(others), last] if others else [last])


def _nearest(name: Any, names: Sequence[str]) -> list[str]:
    """Return up to three names that contain a name, or else the one name that is similar to it."""
    text = str(name).lower()
    longer = sorted((other for other in names if text in other.lower()), key=len)[:3] if text else []
    return longer or difflib.get_close_matches(text, names, n=1)


def hint(name: Any, names: Iterable[str]) -> str:
    """Return the similar names for the end of a message: "; did you mean 'omega1'?"; "" if none is similar.

    Args:
        name: the unknown name.
        names: valid names.
    """
    near = _nearest(name, list(dict.fromkeys(names)))
    return f"; did you mean {alternatives([repr(other) for other in near])}?" if near else ""


def suggestion(name: Any, names: Iterable[str]) -> str:
    """Return the similar names for the end of a message, or else the first names: "; available: a, b".

    Args:
        name: the unknown name.
        names: valid names.
    """
    valid = list(dict.fromkeys(names))
    return hint(name, valid) or f"; available: {listed(valid) or 'none'}"


def unknown(kind: str, name: Any, names: Iterable[str]) -> str:
    """Return the message for an unknown name: "unknown unit 'kgg'; did you mean 'kg'?".

    Args:
        kind: noun for the names, such as "unit".
        name: the unknown name.
        names: valid names; the message lists the first ones if none is similar.
    """
    return f"unknown {kind} {str(name)!r}{suggestion(name, names)}"


def cannot_read(path: Path | str, reason: BaseException | str) -> str:
    """Return the message for a file that cannot be read: "cannot read a.toml: no such file or directory".

    Args:
        path: of the file.
        reason: noun phrase or clause, or the error; of an error of the system only its text is used.
    """
    text = (isinstance(reason, OSError) and reason.strerror) or " ".join(str(reason).split())
    is_word = text[1:2].islower()
    return f"cannot read {path}: {text[:1].lower() + text[1:] if is_word else text}"


class UnknownName(Refused, KeyError):
    """Unknown name."""

    __str__ = Exception.__str__  # KeyError would put quotes around the message


class Named(dict[str, Value]):
    """Values by name; the error for a missing name suggests others, or has the reason.

    Args:
        values: by name.
        kind: noun for the names, such as "metric".
        missing: reasons by name of values that some runs have.
    """

    def __init__(
        self, values: Mapping[str, Value], kind: str, missing: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(values)
        self.kind, self.missing = kind, missing or {}

    def __missing__(self, name: str) -> Value:
        reason = self.missing.get(name)
        raise UnknownName(f"{name}: {reason}" if reason else unknown(self.kind, name, self))


class FmuError(Refused):
    """The FMU cannot be loaded, or rejects parameters, inputs or a step: its own message."""
