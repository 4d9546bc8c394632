"""The errors of the package and their messages.

    InertiaModuleError
    ├── ParameterError
    │   ├── TableError (csv_table)
    │   └── UnknownNameError
    ├── SceneError
    ├── FmuError
    │   └── SimulationTerminated
    ├── MissingDependencyError
    └── CompilationError (compiling)

Forms: "NAME must be ALLOWED (got VALUE)", "unknown KIND 'NAME'; did you mean 'OTHER'?" and
"cannot read FILE: REASON". A remedy follows in a separate sentence.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from .deprecated import renamed_names

Value = TypeVar("Value")

# number of available names that a message lists
LISTED = 12


class InertiaModuleError(Exception):
    """Base class of the errors of the package; the message is one line, and nothing has changed."""


class ParameterError(InertiaModuleError, ValueError):
    """Invalid value, name, table or call: the message contains the value and the allowed range."""


class SceneError(InertiaModuleError, ValueError):
    """Invalid scene; the message is one line with the key, the value and the allowed range.

    Args:
        message: the message.
        key: dotted key whose value is invalid alone; "" if the error is a contradiction between keys.
    """

    def __init__(self, message: str, key: str = "") -> None:
        super().__init__(message)
        self.key = key


class FmuError(InertiaModuleError, ValueError):
    """The FMU cannot be loaded, or rejects parameters, inputs or a step; with the message of the FMU."""


class SimulationTerminated(FmuError):  # noqa: N818 - the name of FMI
    """The FMU ends the simulation; the time of its instance is the start of the last step."""


class MissingDependencyError(InertiaModuleError, RuntimeError):
    """A library of an extra is not installed; the message contains its name and the command to install it."""


def sentence_of(error: BaseException) -> str:
    """Return the message of an error in one line; a system error includes the name of its file.

    Args:
        error: the error.
    """
    text = str(error)
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if isinstance(error, MemoryError):
        text = f"out of memory: {text}" if text else "out of memory"
    return " ".join(text.split()) or type(error).__name__


def must_be(name: str, allowed: str, value: float | str) -> str:
    """Return the message for an invalid value: "tolerance must be between 0 and 1 (got 7)".

    Args:
        name: name of the value.
        allowed: allowed values, as they follow "must be".
        value: the invalid number, or its text.
    """
    return f"{name} must be {allowed} (got {value if isinstance(value, str) else format(value, '.16g')})"


def listed(names: Iterable[str]) -> str:
    """Return a text with the first LISTED names and the number of the others.

    Args:
        names: all names.
    """
    every = list(names)
    more = f" and {len(every) - LISTED} more" if len(every) > LISTED else ""
    return f"{', '.join(every[:LISTED])}{more}"


def alternatives(words: Sequence[str]) -> str:
    """Return a text with words as alternatives: "a", "a or b", "a, b or c".

    Args:
        words: at least one word.
    """
    *others, last = words
    return " or ".join([", ".join(others), last] if others else [last])


def _nearest(name: Any, names: Sequence[str]) -> list[str]:
    """Return up to three names that contain a name; otherwise the name that is similar to it."""
    text = str(name).lower()
    longer = sorted((other for other in names if text in other.lower()), key=len)[:3] if text else []
    return longer or difflib.get_close_matches(text, names, n=1)


def hint(name: Any, names: Iterable[str]) -> str:
    """Return the end of a message with similar names: "; did you mean 'omega1'?"; "" if none is similar.

    Args:
        name: the unknown name.
        names: valid names.
    """
    similar = _nearest(name, list(dict.fromkeys(names)))
    return f"; did you mean {alternatives([repr(other) for other in similar])}?" if similar else ""


def suggestion(name: Any, names: Iterable[str]) -> str:
    """Return the end of a message with similar names, otherwise with the first names: "; available: a, b".

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
        path: path of the file.
        reason: noun phrase, clause or error; from a system error only its text is used.
    """
    text = (isinstance(reason, OSError) and reason.strerror) or " ".join(str(reason).split())
    is_word = text[1:2].islower()
    return f"cannot read {path}: {text[:1].lower() + text[1:] if is_word else text}"


class UnknownNameError(ParameterError, KeyError):
    """Unknown name of a value; also a KeyError, because the values are in a dictionary."""

    __str__ = Exception.__str__  # KeyError would put quotes around the message


class Named(dict[str, Value]):
    """Values by name; the error for a missing name suggests other names, or contains the reason.

    Args:
        values: values by name.
        kind: noun for the names, such as "metric".
        missing: reasons by name, for values that exist in some runs only.

    Attributes:
        kind: noun for the names.
        missing: reasons by name.
    """

    def __init__(
        self, values: Mapping[str, Value], kind: str, missing: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(values)
        self.kind, self.missing = kind, missing or {}

    def __missing__(self, name: str) -> Value:
        reason = self.missing.get(name)
        raise UnknownNameError(f"{name}: {reason}" if reason else unknown(self.kind, name, self))


__getattr__ = renamed_names(__name__, Refused="InertiaModuleError", UnknownName="UnknownNameError")
