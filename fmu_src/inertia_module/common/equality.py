"""Equality and hash of results that hold arrays, dictionaries and lists."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def is_equal(first: Any, second: Any) -> bool:
    """Return True if two values have equal content; NaN equals NaN.

    Args:
        first: a value of any type.
        second: a value of any type.
    """
    if isinstance(first, np.ndarray) and isinstance(second, np.ndarray):
        return np.array_equal(first, second, equal_nan=True)
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        return first.keys() == second.keys() and all(is_equal(first[key], second[key]) for key in first)
    if isinstance(first, list | tuple) and type(first) is type(second):
        return len(first) == len(second) and all(map(is_equal, first, second))
    if isinstance(first, np.ndarray) or isinstance(second, np.ndarray):
        return False
    return bool(first == second) or (_is_nan(first) and _is_nan(second))


def hash_of(value: Any) -> int:
    """Return the hash of a value by content: equal values (is_equal) have the same hash.

    Args:
        value: a value of any type.
    """
    if isinstance(value, np.ndarray):
        return hash(value.shape)
    if isinstance(value, Mapping):
        return hash(frozenset((key, hash_of(member)) for key, member in value.items()))
    if isinstance(value, list | tuple):
        return hash(tuple(map(hash_of, value)))
    return 0 if _is_nan(value) else hash(value)


def _is_nan(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


class ByContent:
    """Base of dataclasses (with eq=False) that are equal if all their fields have equal content."""

    def _content(self) -> dict[str, Any]:
        """Return the values of the compared fields by name, without the cached properties."""
        fields = dataclasses.fields(self)  # type: ignore[arg-type]
        return {field.name: getattr(self, field.name) for field in fields if field.compare}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and is_equal(self._content(), other._content())

    def __hash__(self) -> int:
        return hash_of(self._content())
