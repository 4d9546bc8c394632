"""Keys of a scene by dots: axes of a sweep with the points sampled of them, free keys of a fit."""

from __future__ import annotations

import itertools
import math
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from ..common.errors import Refused, must_be, unknown
from ..common.units import number_of, parse_unit, split_quantity
from ..contract.variables import BY_NAME, INTEGER, REAL
from ..scene import Scene, SceneError
from ..scene.keys import MECHANISM, full_name, unit_of

# values by key of the scene: numbers in SI units, or names
Point = dict[str, float | str]
# of a free key
Range = str | tuple[float, float] | None
LARGEST_GRID = 10_000_000
_RANGE = re.compile(r"(log:)?([^:]+):([^:]+?)(?::\s*(\d+)\s*)?")
# prior value and its standard deviation
_PRIOR = re.compile(r"(.+?)\s*(?:\+-|\+/-|±)(.+)")


@dataclass(frozen=True)
class Axis:
    """One key that is varied, its name by dots: over a range in SI, or over a list of values.

    The number of points in a grid is 0 if none is given; they are even in the range or in its logarithm.
    """

    name: str
    unit: str = ""
    low: float = math.nan
    high: float = math.nan
    number: int = 0
    logarithmic: bool = False
    values: tuple[float | str, ...] = ()

    @property
    def whole(self) -> bool:
        """Tell whether it is a number that must be whole, such as that of teeth."""
        variable = BY_NAME.get(self.name.removeprefix(MECHANISM))
        return variable is not None and variable.kind == INTEGER

    def at(self, share: float) -> float | str:
        """The value at a share (0 to 1) of the range or of the list."""
        if self.values:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        if self.whole:
            return self.low + min(math.floor(share * (self.high - self.low + 1.0)), self.high - self.low)
        if self.logarithmic:
            return float(self.low ** (1.0 - share) * self.high**share)
        return self.low + share * (self.high - self.low)

    def grid(self) -> list[float | str]:
        """The values of a grid, if their number is given."""
        if self.values:
            return list(self.values)
        if not self.number:
            given = f"{self.low:g}:{self.high:g} {self.unit}".rstrip()
            raise Refused(must_be(self.name, "FROM:TO:COUNT for a grid", given))
        spaced = np.geomspace if self.logarithmic else np.linspace
        found = [float(value) for value in spaced(self.low, self.high, self.number)]
        return list(dict.fromkeys(round(value) * 1.0 for value in found)) if self.whole else list(found)


def _unit_and_value(name: str, scene: Scene) -> tuple[str, Any]:
    """Unit, "" for none, and value of a key of a scene; None where the scene does not give it."""
    *tables, key = name.split(".")
    table: Any = scene
    for part in tables:
        table = getattr(table, part, None)
    fields = getattr(type(table), "model_fields", {})
    return (unit_of(fields[key]), getattr(table, key)) if key in fields else ("", None)


def _value(scene: Scene, name: str, given: Any) -> float | str:
    """Value of a key, in SI units or a name; one that it cannot have, whatever the others are, is refused."""
    value = given.strip() if isinstance(given, str) else float(given)
    try:
        scene.with_keys({name: value})
    except SceneError as error:
        # other errors may vanish with other values of other keys
        if f"{error.key}.".startswith(f"{name}."):
            raise
    if isinstance(value, float):
        return value
    try:
        number, unit = split_quantity(value)
    except ValueError:
        return str(value)
    return number * parse_unit(unit or "1")[0]


def _range(name: str, unit: str, given: str, value: Callable[[str], float | str]) -> Axis:
    """The range FROM:TO or FROM:TO:COUNT, "log:" before it or not, of a key; value: reads one of its ends."""
    demand = must_be(name, "FROM:TO:COUNT, log:FROM:TO:COUNT or A,B,C", repr(given))
    parts = _RANGE.fullmatch(given)
    if parts is None:
        raise Refused(demand)
    low, high = map(value, parts.group(2, 3))
    if isinstance(low, str) or isinstance(high, str):
        raise Refused(demand)
    if not low < high:
        raise Refused(must_be(name, "a range from a lower to a higher value", f"{low:g}:{high:g}"))
    if parts[1] and low <= 0.0:
        raise Refused(must_be(f"the lower end of {name}", "above 0 for logarithmic spacing", f"{low:g}"))
    if parts[4] and int(parts[4]) < 2:
        raise Refused(must_be(f"the number of points of {name}", "at least 2", parts[4]))
    return Axis(name, unit, low, high, int(parts[4] or 0), bool(parts[1]))


def _by_key(given: Sequence[str] | Mapping[str, Any], what: str, example: str) -> list[tuple[str, Any]]:
    """Keys by dots, each once, with what is given for them, None for nothing; what: is done to the keys."""
    pairs: list[tuple[str, Any]] = []
    for item in given.items() if isinstance(given, Mapping) else given:
        name, equals, text = item.partition("=") if isinstance(item, str) else (item[0], "=", item[1])
        pairs.append((full_name(name.strip()), text if equals else None))
    if not pairs:
        raise Refused(f"at least one key must be {what}, for example {example}")
    for name, times in Counter(name for name, _ in pairs).items():
        if times > 1:
            raise Refused(f"{name} is {what} {times} times; list it once")
    return pairs


def axes_of(vary: Sequence[str] | Mapping[str, Any], scene: Scene) -> list[Axis]:
    """The axes of a sweep of a scene.

    Args:
        vary: "NAME=RANGE" each, or ranges by name: "FROM:TO:COUNT", "FROM:TO", "log:FROM:TO:COUNT" or
            "A,B,C", each with units if wanted, or a list of values.
    """
    found = []
    for name, given in _by_key(vary, "varied", "imbalance_mass=0.5:2:7"):
        if not given:
            raise Refused(f"{name} has no range; use {name}=FROM:TO:COUNT or {name}=A,B,C")
        (unit, _), value = _unit_and_value(name, scene), partial(_value, scene, name)
        if isinstance(given, str) and ":" in given:
            found.append(_range(name, unit, given, value))
        else:
            values = map(value, given.split(",") if isinstance(given, str) else given)
            found.append(Axis(name, unit, values=tuple(dict.fromkeys(values))))
    return found


def grid(axes: Sequence[Axis]) -> list[Point]:
    """Combine all values, the last axis fastest; at most LARGEST_GRID points."""
    values = [one.grid() for one in axes]
    total = math.prod(map(len, values))
    if total > LARGEST_GRID:
        raise Refused(must_be("the number of points of a grid", f"at most {LARGEST_GRID}", str(total)))
    names = [one.name for one in axes]
    return [dict(zip(names, row, strict=True)) for row in itertools.product(*values)]


def of_shares(axes: Sequence[Axis], shares: NDArray[np.float64]) -> list[Point]:
    """Points of shares (0 to 1), shape (points, axes)."""
    return [{one.name: one.at(u) for one, u in zip(axes, row, strict=True)} for row in shares.tolist()]


def shares_sampled(number: int, sample: str, seed: int) -> NDArray[np.float64]:
    """Shares (0 to 1) of a number of ranges, shape (points, number); same seed, same points.

    Args:
        sample: "latin:COUNT" (Latin hypercube) or "sobol:COUNT" (Sobol's sequence, scrambled).
    """
    from scipy.stats import qmc

    samplers = {"latin": qmc.LatinHypercube, "sobol": qmc.Sobol}
    kind, _, count = sample.partition(":")
    if kind not in samplers or not count.isdigit() or int(count) < 1:
        raise Refused(must_be("sample", "latin:COUNT or sobol:COUNT, such as latin:200", repr(sample)))
    shares: NDArray[np.float64] = samplers[kind](number, rng=seed).random(int(count))
    return shares


@dataclass(frozen=True, kw_only=True)
class Free(Axis):
    """A free key of a fit.

    Attributes:
        start: value at which a search starts, SI.
        nominal: value in the scene, SI; NaN if there is none.
        size: scale of the key, SI: the width of its range, or else the size of its start.
        has_range: whether a range is specified.
        physical: limits of the key without the range, SI.
        deviation: standard deviation of the prior value, which is the start, SI; infinite without a prior
            value, 0 for an exact one.
    """

    start: float
    nominal: float
    size: float
    has_range: bool = False
    physical: tuple[float, float] = (-math.inf, math.inf)
    deviation: float = math.inf

    def at(self, share: float) -> float | str:
        """Return the value at a share (0 to 1) of the range, or the start if there is no range."""
        return super().at(share) if self.has_range else self.start

    @property
    def range_remark(self) -> str:
        """A warning if the range does not contain the value in the scene, else ""."""
        if not self.has_range or math.isnan(self.nominal) or self.low <= self.nominal <= self.high:
            return ""
        allowed = f"{self.low:g} to {self.high:g} {self.unit}".rstrip()
        return f"{self.name}: the range {allowed} does not contain the value in the scene, {self.nominal:g}"


def free_keys(
    free: Sequence[str] | Mapping[str, Range], scene: Scene, sensors: Mapping[str, Free] | None = None
) -> list[Free]:
    """Return the free keys of a fit.

    Args:
        free: "NAME", "NAME=LOW:HIGH", "NAME=log:LOW:HIGH" (starts are even in the logarithm) or, with prior
            knowledge, "NAME=VALUE +- DEVIATION" each; or such a text, (low, high) or None by name.
        scene: its values are starts.
        sensors: keys of the sensors, by name.
    """
    keys, others = [], sensors or {}
    kinds = {name.partition(".")[0] for name in others}
    for name, text in _by_key(free, "free", "imbalance_mass=0.5:2"):
        if name in others:
            key = others[name]
            keys.append(_free(key, text, partial(_number, name, key.unit)))
        elif name.partition(".")[0] in kinds:
            raise Refused(unknown("sensor parameter", name, others))
        else:
            key, read = key_of_scene(name, scene), partial(_value, scene, name)
            if text is None and not abs(key.start) > 0.0:
                scene.with_keys({name: 1.0})  # which says so if there is no such key
                raise Refused(
                    f"{name} requires a range, {name}=LOW:HIGH, because the scene has no start value other"
                    " than 0"
                )
            keys.append(_free(key, text, read))
    return keys


def key_of_scene(name: str, scene: Scene) -> Free:
    """Return a key of a scene without a range; it starts at its value there, NaN for none."""
    variable = BY_NAME.get(name.removeprefix(MECHANISM))
    unit, value = _unit_and_value(name, scene)
    if value is None and variable is not None:
        value = variable.start
    if (variable is not None and variable.kind != REAL) or isinstance(value, str | list | BaseModel):
        raise Refused(f"{name} must be a continuous number to be free; vary other keys with sweep")
    low, high = (-math.inf, math.inf) if variable is None else variable.ends
    nominal = math.nan if value is None else float(value)
    return Free(
        name, unit, low, high, start=nominal, nominal=nominal, size=abs(nominal), physical=(low, high)
    )


def _free(key: Free, limits: Range, read: Callable[[str], float | str]) -> Free:
    """Return a key with its range or its prior value.

    Args:
        key: without a range.
        limits: range or prior value, None for neither.
        read: reads a value of the key, in SI.
    """
    if limits is None:
        return key
    name, text = key.name, limits if isinstance(limits, str) else ":".join(map(repr, limits))
    prior = _PRIOR.fullmatch(text)
    if prior is not None:
        mean, deviation = float(read(prior[1])), _number(name, key.unit, prior[2])
        if deviation < 0.0:
            raise Refused(must_be(f"the deviation of {name}", "at least 0", prior[2].strip()))
        return replace(key, start=mean, size=10.0 * deviation or 1.0, deviation=deviation)
    if ":" not in text:
        raise Refused(must_be(name, "LOW:HIGH or VALUE +- DEVIATION", repr(text)))
    axis = _range(name, key.unit, text, read)
    if axis.number:
        raise Refused(must_be(name, "LOW:HIGH without a number of points", repr(text)))
    # False if the scene has no value
    inside = axis.low <= key.start <= axis.high
    start = key.start if inside else 0.5 * (axis.low + axis.high)
    return Free(
        **vars(axis),
        start=start,
        nominal=key.nominal,
        size=axis.high - axis.low,
        has_range=True,
        physical=key.physical,
    )


def _number(name: str, unit: str, text: str) -> float:
    """A quantity in SI units."""
    try:
        return number_of(text, unit or "1")
    except ValueError as error:
        demand = must_be(name, f"a number in {unit or '1'}", repr(text.strip()))
        raise Refused(f"{demand}: {error}") from None
