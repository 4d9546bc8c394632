"""Dotted keys of a scene: axes of a sweep with their sample points, and free keys of a fit."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from ..common.deprecated import warn_renamed
from ..common.errors import ParameterError, SceneError, must_be, unknown
from ..common.units import number_of, parse_unit, split_quantity
from ..interface.variables import BY_NAME, INTEGER, REAL
from ..scene import Scene
from ..scene.keys import MECHANISM, full_key, unit_of

# values by key of the scene: numbers in SI, or names
Point = dict[str, float | str]
# range or prior value of a key as a text, its ends, or its values
Range = str | Sequence[float | str] | None
Ranges = Mapping[str, Range]
MAX_GRID = 10_000_000
_RANGE = re.compile(r"(log:)?([^:]+):([^:]+?)(?::\s*(\d+)\s*)?")
# prior value and its standard deviation
_PRIOR = re.compile(r"(.+?)\s*(?:\+-|\+/-|±)(.+)")


@dataclass(frozen=True)
class Axis:
    """Varied key: a range or a list of values.

    Attributes:
        name: Dotted key.
        unit: SI unit; "" for none.
        low: Lower end of the range, SI.
        high: Upper end of the range, SI.
        number: Number of points in a grid; 0 without a grid.
        logarithmic: True if points are equally spaced in the logarithm.
        values: List of values; empty for a range.
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
        """Return True if the key is an integer, such as a number of teeth."""
        variable = BY_NAME.get(self.name.removeprefix(MECHANISM))
        return variable is not None and variable.kind == INTEGER

    def at(self, share: float) -> float | str:
        """Return the value at a fraction of the range or list.

        Args:
            share: Fraction, 0 to 1.
        """
        if self.values:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        if self.whole:
            return self.low + min(math.floor(share * (self.high - self.low + 1.0)), self.high - self.low)
        if self.logarithmic:
            return float(self.low ** (1.0 - share) * self.high**share)
        return self.low + share * (self.high - self.low)

    def grid(self) -> list[float | str]:
        """Return the values of a grid.

        Raises:
            ParameterError: The range has no number of points.
        """
        if self.values:
            return list(self.values)
        if not self.number:
            text = f"{self.low:g}:{self.high:g} {self.unit}".rstrip()
            raise ParameterError(must_be(self.name, "FROM:TO:COUNT for a grid", text))
        space = np.geomspace if self.logarithmic else np.linspace
        values = [float(value) for value in space(self.low, self.high, self.number)]
        return list(dict.fromkeys(round(value) * 1.0 for value in values)) if self.whole else list(values)


def _unit_and_value(name: str, scene: Scene) -> tuple[str, Any]:
    """Return the unit ("" for none) and the value of a key of a scene (None if the scene has no value)."""
    *tables, key = name.split(".")
    table: Any = scene
    for part in tables:
        table = getattr(table, part, None)
    fields = getattr(type(table), "model_fields", {})
    return (unit_of(fields[key]), getattr(table, key)) if key in fields else ("", None)


def _value(scene: Scene, name: str, text: Any) -> float | str:
    """Return the value of a key in SI, or a name; reject a value that is invalid with any other values."""
    value = text.strip() if isinstance(text, str) else float(text)
    try:
        scene.with_keys({name: value})
    except SceneError as error:
        # Other errors can disappear with other values of other keys.
        if f"{error.key}.".startswith(f"{name}."):
            raise
    if isinstance(value, float):
        return value
    try:
        number, unit = split_quantity(value)
    except ValueError:
        return str(value)
    return number * parse_unit(unit or "1")[0]


def _range(name: str, unit: str, text: str, value: Callable[[str], float | str]) -> Axis:
    """Parse the range of a key: FROM:TO or FROM:TO:COUNT, optionally with the prefix "log:".

    Args:
        name: Dotted key.
        unit: Unit of the key.
        text: The range.
        value: Function that converts one end of the range to SI.

    Raises:
        ParameterError: The range is invalid.
    """
    demand = must_be(name, "FROM:TO:COUNT, log:FROM:TO:COUNT or A,B,C", repr(text))
    parts = _RANGE.fullmatch(text)
    if parts is None:
        raise ParameterError(demand)
    low, high = map(value, parts.group(2, 3))
    if isinstance(low, str) or isinstance(high, str):
        raise ParameterError(demand)
    if not low < high:
        raise ParameterError(must_be(name, "a range from a lower to a higher value", f"{low:g}:{high:g}"))
    if parts[1] and low <= 0.0:
        raise ParameterError(
            must_be(f"the lower end of {name}", "above 0 for logarithmic spacing", f"{low:g}")
        )
    if parts[4] and int(parts[4]) < 2:
        raise ParameterError(must_be(f"the number of points of {name}", "at least 2", parts[4]))
    return Axis(name, unit, low, high, int(parts[4] or 0), bool(parts[1]))


def ranges_from_options(texts: Iterable[str]) -> dict[str, str]:
    """Return ranges by name, "" without a range, from the options of the command line.

    Args:
        texts: Texts NAME or NAME=RANGE.

    Raises:
        ParameterError: A name is present twice.
    """
    ranges: dict[str, str] = {}
    for text in texts:
        name, _, range_ = text.partition("=")
        if name.strip() in ranges:
            raise ParameterError(f"{name.strip()} is present twice; list it once")
        ranges[name.strip()] = range_
    return ranges


def _by_key(ranges: Ranges | Iterable[str], use: str, example: str) -> dict[str, Range]:
    """Return ranges by full dotted key.

    Args:
        ranges: Ranges by name. Texts NAME or NAME=RANGE are deprecated.
        use: Use of the keys, for messages.
        example: Example, for messages.

    Raises:
        ParameterError: There is no key, or a key is present twice.
    """
    if not isinstance(ranges, Mapping):
        warn_renamed("a list of texts NAME=RANGE", "a mapping from names to ranges")
        ranges = ranges_from_options(ranges)
    if not ranges:
        raise ParameterError(f"at least one key must be {use}, for example {example}")
    by_key: dict[str, Range] = {}
    for name, range_ in ranges.items():
        if full_key(name) in by_key:
            raise ParameterError(f"{full_key(name)} is {use} twice; list it once")
        by_key[full_key(name)] = range_ or None
    return by_key


def axes_of(vary: Ranges, scene: Scene) -> list[Axis]:
    """Return the axes of a sweep of a scene.

    Args:
        vary: Ranges by name. A range is "FROM:TO:COUNT", "FROM:TO", "log:FROM:TO:COUNT" or "A,B,C", with
            optional units, or a list of values.
        scene: The scene.

    Raises:
        ParameterError: A key or a range is invalid.
    """
    axes = []
    for name, range_ in _by_key(vary, "varied", "imbalance_mass=0.5:2:7").items():
        if not range_:
            raise ParameterError(f"{name} has no range; use {name}=FROM:TO:COUNT or {name}=A,B,C")
        (unit, _), value = _unit_and_value(name, scene), partial(_value, scene, name)
        if isinstance(range_, str) and ":" in range_:
            axes.append(_range(name, unit, range_, value))
        else:
            values = map(value, range_.split(",") if isinstance(range_, str) else range_)
            axes.append(Axis(name, unit, values=tuple(dict.fromkeys(values))))
    return axes


def grid(axes: Sequence[Axis]) -> list[Point]:
    """Return all combinations of the values of axes; the last axis varies fastest.

    Args:
        axes: The axes.

    Raises:
        ParameterError: An axis has no number of points, or the grid has more than MAX_GRID points.
    """
    values = [axis.grid() for axis in axes]
    total = math.prod(map(len, values))
    if total > MAX_GRID:
        raise ParameterError(must_be("the number of points of a grid", f"at most {MAX_GRID}", str(total)))
    names = [axis.name for axis in axes]
    return [dict(zip(names, row, strict=True)) for row in itertools.product(*values)]


def points_at(axes: Sequence[Axis], shares: NDArray[np.float64]) -> list[Point]:
    """Return the points at fractions of the axes.

    Args:
        axes: The axes.
        shares: Fractions, 0 to 1, shape (points, axes).
    """
    return [{axis.name: axis.at(u) for axis, u in zip(axes, row, strict=True)} for row in shares.tolist()]


def sample_shares(number: int, sample: str, seed: int) -> NDArray[np.float64]:
    """Sample fractions of ranges, shape (points, number); equal seeds produce equal points.

    Args:
        number: Number of ranges.
        sample: "latin:COUNT" (Latin hypercube) or "sobol:COUNT" (scrambled Sobol sequence).
        seed: Random seed.

    Raises:
        ParameterError: sample is invalid.
    """
    from scipy.stats import qmc

    samplers = {"latin": qmc.LatinHypercube, "sobol": qmc.Sobol}
    kind, _, count = sample.partition(":")
    if kind not in samplers or not count.isdigit() or int(count) < 1:
        raise ParameterError(must_be("sample", "latin:COUNT or sobol:COUNT, such as latin:200", repr(sample)))
    shares: NDArray[np.float64] = samplers[kind](number, rng=seed).random(int(count))
    return shares


@dataclass(frozen=True, kw_only=True)
class Free(Axis):
    """Free key of a fit.

    Attributes:
        start: Value at which a search starts, SI.
        nominal: Value in the scene, SI; NaN if the scene has no value.
        size: Scale of the key, SI: the width of its range, otherwise the magnitude of its start.
        has_range: True if a range is specified.
        physical: Limits of the key without the range, SI.
        deviation: Standard deviation of the prior value (the start), SI; infinite without a prior value, 0
            for an exact prior value.
    """

    start: float
    nominal: float
    size: float
    has_range: bool = False
    physical: tuple[float, float] = (-math.inf, math.inf)
    deviation: float = math.inf

    def at(self, share: float) -> float | str:
        """Return the value at a fraction of the range, or the start without a range.

        Args:
            share: Fraction, 0 to 1.
        """
        return super().at(share) if self.has_range else self.start

    @property
    def range_remark(self) -> str:
        """Return a warning if the range does not contain the value in the scene, else ""."""
        if not self.has_range or math.isnan(self.nominal) or self.low <= self.nominal <= self.high:
            return ""
        allowed = f"{self.low:g} to {self.high:g} {self.unit}".rstrip()
        return f"{self.name}: the range {allowed} does not contain the value in the scene, {self.nominal:g}"


def free_keys(free: Ranges, scene: Scene, sensors: Mapping[str, Free] | None = None) -> list[Free]:
    """Return the free keys of a fit.

    Args:
        free: Ranges by name: "LOW:HIGH" or (low, high), "log:LOW:HIGH" (starts are equally spaced in the
            logarithm), "VALUE +- DEVIATION" (prior value), or None.
        scene: Scene with the start values.
        sensors: Keys of the sensors, by name.

    Raises:
        ParameterError: A key or a range is invalid.
    """
    keys, others = [], sensors or {}
    kinds = {name.partition(".")[0] for name in others}
    for name, text in _by_key(free, "free", "imbalance_mass=0.5:2").items():
        if name in others:
            key = others[name]
            keys.append(_with_range(key, text, partial(_number, name, key.unit)))
        elif name.partition(".")[0] in kinds:
            raise ParameterError(unknown("sensor parameter", name, others))
        else:
            key, read = key_of_scene(name, scene), partial(_value, scene, name)
            if text is None and not abs(key.start) > 0.0:
                scene.with_keys({name: 1.0})  # raises SceneError for an unknown key
                raise ParameterError(
                    f"{name} requires a range, {name}=LOW:HIGH, because the scene has no start value other"
                    " than 0"
                )
            keys.append(_with_range(key, text, read))
    return keys


def key_of_scene(name: str, scene: Scene) -> Free:
    """Return a key of a scene without a range; its start is its value in the scene, NaN without a value.

    Args:
        name: Dotted key.
        scene: The scene.

    Raises:
        ParameterError: The key is not a continuous number.
    """
    variable = BY_NAME.get(name.removeprefix(MECHANISM))
    unit, value = _unit_and_value(name, scene)
    if value is None and variable is not None:
        value = variable.start
    if (variable is not None and variable.kind != REAL) or isinstance(value, str | list | BaseModel):
        raise ParameterError(f"{name} must be a continuous number to be free; vary other keys with sweep")
    low, high = (-math.inf, math.inf) if variable is None else variable.ends
    nominal = math.nan if value is None else float(value)
    return Free(
        name, unit, low, high, start=nominal, nominal=nominal, size=abs(nominal), physical=(low, high)
    )


def _with_range(key: Free, limits: Range, read: Callable[[str], float | str]) -> Free:
    """Return a key with its range or its prior value.

    Args:
        key: Key without a range.
        limits: Range or prior value; None for neither.
        read: Function that converts a value of the key to SI.

    Raises:
        ParameterError: The range or prior value is invalid.
    """
    if limits is None:
        return key
    name, text = key.name, limits if isinstance(limits, str) else ":".join(map(repr, limits))
    prior = _PRIOR.fullmatch(text)
    if prior is not None:
        mean, deviation = float(read(prior[1])), _number(name, key.unit, prior[2])
        if deviation < 0.0:
            raise ParameterError(must_be(f"the deviation of {name}", "at least 0", prior[2].strip()))
        return replace(key, start=mean, size=10.0 * deviation or 1.0, deviation=deviation)
    if ":" not in text:
        raise ParameterError(must_be(name, "LOW:HIGH or VALUE +- DEVIATION", repr(text)))
    axis = _range(name, key.unit, text, read)
    if axis.number:
        raise ParameterError(must_be(name, "LOW:HIGH without a number of points", repr(text)))
    # A key without a value in the scene (NaN) is outside.
    is_inside = axis.low <= key.start <= axis.high
    start = key.start if is_inside else 0.5 * (axis.low + axis.high)
    return Free(
        **vars(axis),
        start=start,
        nominal=key.nominal,
        size=axis.high - axis.low,
        has_range=True,
        physical=key.physical,
    )


def _number(name: str, unit: str, text: str) -> float:
    """Return a quantity in SI; reject a text that is no number in the unit."""
    try:
        return number_of(text, unit or "1")
    except ValueError as error:
        demand = must_be(name, f"a number in {unit or '1'}", repr(text.strip()))
        raise ParameterError(f"{demand}: {error}") from None
