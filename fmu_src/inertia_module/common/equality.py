"""Equality and hash of results that hold arrays, dictionaries and lists."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def is_equal(one: Any, other: Any) -> bool:
    """Return True if two values have equal content; NaN equals NaN."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.array_equal(one, other, equal_nan=True)
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(is_equal(value, other[key]) for key, value in one.items())
    if isinstance(one, list | tuple) and type(one) is type(other):
        return len(one) == len(other) and all(map(is_equal, one, other))
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return False
    return bool(one == other) or (_is_nan(one) and _is_nan(other))


def hash_of(value: Any) -> int:
    """Return a hash that is the same for all values that is_equal finds equal."""
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
        """Values of the fields by name, without the cached properties."""
        return {one.name: getattr(self, one.name) for one in dataclasses.fields(self)}  # type: ignore[arg-type]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and is_equal(self._content(), other._content())

    def __hash__(self) -> int:
        return hash_of(self._content())
