"""Free keys of a fit: keys of a scene that are numbers, with a range or without."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..common.errors import Refused
from ..contract.variable import REAL
from ..contract.variables import BY_NAME
from ..scene import Scene
from ..scene.keys import MECHANISM
from .axes import Axis, axis, by_key, unit_of_key

Range = str | tuple[float, float] | None


@dataclass(frozen=True)
class Free:
    """One key, as a variable u that is near 1: its value is origin + span (u - 1).

    Attributes:
        name: of the key, by dots. range: that it is held to, or None. start: of the variable.
        origin, span: the low end and the width of the range; without one both are the value in the scene.
        low, high: limits of the variable. unit: of the key, "" for none.
    """

    name: str
    range: Axis | None
    origin: float
    span: float
    start: float
    low: float
    high: float
    unit: str

    @property
    def identifier(self) -> str:
        """The name as one word."""
        return self.name.replace(".", "_")

    def value(self, variable: float) -> float:
        """The value, SI."""
        return self.origin + self.span * (variable - 1.0)

    def spread(self, share: float) -> float:
        """The variable at a share (0 to 1) of the range; at the start where there is none."""
        if self.range is None:
            return self.start
        return 1.0 + (float(self.range.at(share)) - self.origin) / self.span


def free_keys(free: Sequence[str] | Mapping[str, Range], scene: Scene) -> list[Free]:
    """The free keys of a fit.

    Args:
        free: "NAME" or "NAME=LOW:HIGH" each (or log:LOW:HIGH, whose starts are even in the logarithm), or by
            name such a range, (low, high) or None. scene: whose values they begin at.

    Raises:
        Refused: nothing is free, a key twice, or one that is not a number or has no such range.
    """
    return [_free(name, given, scene) for name, given in by_key(free, "free", "imbalance_mass=0.5:2")]


def _free(name: str, given: Range, scene: Scene) -> Free:
    variable = BY_NAME.get(name.removeprefix(MECHANISM))
    value = _value(name, scene)
    if (variable is not None and variable.kind != REAL) or isinstance(value, str | list | dict):
        raise Refused(
            f"{name} must be a number that changes by small steps to be free: sweep takes the others"
        )
    if given is not None:
        return _ranged(name, given, value, scene)
    if not value:
        # which says so if there is no such key
        scene.with_keys({name: 1.0})
        raise Refused(
            f"{name} must have a range, {name}=LOW:HIGH: the scene has {value or 'no value'} to begin at"
        )
    limits = (-math.inf, math.inf)
    if variable is not None:
        limits = _or(variable.minimum, -math.inf), _or(variable.maximum, math.inf)
    low, high = sorted(limit / value for limit in limits)
    return Free(name, None, value, value, 1.0, low, high, unit_of_key(name, scene))


def _ranged(name: str, given: str | tuple[float, float], value: float | None, scene: Scene) -> Free:
    text = given if isinstance(given, str) else ":".join(map(repr, given))
    if ":" not in text:
        raise Refused(f"{name} must be free within LOW:HIGH, is given {text!r}")
    found = axis(name, text, scene)
    if found.number:
        raise Refused(f"{name} must be free within LOW:HIGH, without a number of points, is given {text!r}")
    span = found.high - found.low
    inside = value is not None and found.low <= value <= found.high
    start = 1.0 + (value - found.low) / span if inside and value is not None else 1.5
    return Free(name, found, found.low, span, start, 1.0, 2.0, unit_of_key(name, scene))


def _or(limit: float | None, otherwise: float) -> float:
    return otherwise if limit is None else limit


def _value(name: str, scene: Scene) -> Any:
    """The value of a key, or its default; None where there is none."""
    value: Any = scene.tables
    for part in name.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    if value is None and name.startswith(MECHANISM):
        variable = BY_NAME.get(name.removeprefix(MECHANISM))
        value = None if variable is None else variable.start
    return value
