"""Quantities as a scene file writes them: a number in SI units, or a string with a unit."""

from __future__ import annotations

import math
import re
from collections import Counter
from typing import Any

from pydantic import BeforeValidator

Dimension = dict[str, int]

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
_FACTOR = re.compile(r"([A-Za-z%°]+|1)(?:\^?(-?\d+))?$")

# symbol: factor to SI, exponents of kg, m, s, rad
_SYMBOLS: dict[str, tuple[float, Dimension]] = {
    "1": (1.0, {}),
    "%": (0.01, {}),
    "rad": (1.0, {"rad": 1}),
    "deg": (math.pi / 180.0, {"rad": 1}),
    "°": (math.pi / 180.0, {"rad": 1}),
    "rev": (2.0 * math.pi, {"rad": 1}),
    "rpm": (math.pi / 30.0, {"rad": 1, "s": -1}),
    "m": (1.0, {"m": 1}),
    "mm": (1e-3, {"m": 1}),
    "cm": (1e-2, {"m": 1}),
    "km": (1e3, {"m": 1}),
    "s": (1.0, {"s": 1}),
    "ms": (1e-3, {"s": 1}),
    "min": (60.0, {"s": 1}),
    "h": (3600.0, {"s": 1}),
    "kg": (1.0, {"kg": 1}),
    "g": (1e-3, {"kg": 1}),
    "t": (1e3, {"kg": 1}),
    "N": (1.0, {"kg": 1, "m": 1, "s": -2}),
    "kN": (1e3, {"kg": 1, "m": 1, "s": -2}),
    "Nm": (1.0, {"kg": 1, "m": 2, "s": -2}),
    "kNm": (1e3, {"kg": 1, "m": 2, "s": -2}),
}


def parse_unit(text: str) -> tuple[float, Dimension]:
    """Factor to SI and exponents of kg, m, s, rad of a unit such as N.m.s/rad, kg m^2 or km/h.

    Raises:
        ValueError: a symbol is unknown.
    """
    factor = 1.0
    dimension: Counter[str] = Counter()
    for place, group in enumerate(text.split("/")):
        sign = 1 if place == 0 else -1
        for part in re.split(r"[.·*\s]+", group.strip()) if group.strip() else ["1"]:
            match = _FACTOR.match(part)
            if match is None or match[1] not in _SYMBOLS:
                raise ValueError(f"{part} is no unit known here")
            exponent = sign * int(match[2] or 1)
            base, exponents = _SYMBOLS[match[1]]
            factor *= base**exponent
            for name, power in exponents.items():
                dimension[name] += exponent * power
    return factor, {name: power for name, power in dimension.items() if power}


def in_words(unit: str, minimum: float | None, maximum: float | None, above: float | None) -> str:
    """The allowed range in words."""
    limits = []
    if above is not None:
        limits.append(f"above {above:g}")
    if minimum is not None:
        limits.append(f"from {minimum:g}")
    if maximum is not None:
        limits.append(f"to {maximum:g}")
    words = " ".join(["a number", *limits])
    if unit == "1":
        return words
    example = "2" if above is None and minimum is None else f"{max(above or 0.0, minimum or 0.0, 2.0):g}"
    return f"{words} in {unit}, or a string with a unit such as '{example} {unit}'"


def to_si(value: Any, unit: str) -> float:
    """A quantity in the SI unit given.

    Args:
        value: number, or string with a unit of the same dimension. unit: such as rad/s.

    Raises:
        ValueError: it is neither, or of another dimension, or not finite.
    """
    if isinstance(value, str):
        match = _NUMBER.match(value)
        if match is None:
            raise ValueError("it is no number with a unit")
        factor, dimension = parse_unit(match[2]) if match[2] else parse_unit(unit)
        if dimension != parse_unit(unit)[1]:
            raise ValueError(f"{match[2]} is not a unit for {'a pure number' if unit == '1' else unit}")
        number = float(match[1]) * factor
    elif isinstance(value, int | float) and not isinstance(value, bool):
        number = float(value)
    else:
        raise ValueError("it is no quantity")
    if not math.isfinite(number):
        raise ValueError("it is not finite")
    return number


def checked(
    value: Any,
    unit: str,
    minimum: float | None = None,
    maximum: float | None = None,
    above: float | None = None,
) -> float:
    """A quantity in SI within a range.

    Raises:
        ValueError: what is wrong, and what is allowed.
    """
    allowed = in_words(unit, minimum, maximum, above)
    try:
        number = to_si(value, unit)
    except ValueError as error:
        raise ValueError(f"{error}; allowed is {allowed}") from None
    if (
        (minimum is not None and number < minimum)
        or (maximum is not None and number > maximum)
        or (above is not None and number <= above)
    ):
        raise ValueError(f"allowed is {allowed}")
    return number


def quantity(
    unit: str, minimum: float | None = None, maximum: float | None = None, above: float | None = None
) -> BeforeValidator:
    """Pydantic validator of a quantity in a unit within a range."""
    return BeforeValidator(lambda value: checked(value, unit, minimum, maximum, above))


def quantities(unit: str) -> BeforeValidator:
    """Pydantic validator of a list of quantities in a unit; one that is a number is left to the next."""

    def check(value: Any) -> list[float]:
        if not isinstance(value, list) or not value:
            raise ValueError(f"allowed is a list of at least one number in {unit}, or strings with a unit")
        return [checked(item, unit) for item in value]

    return BeforeValidator(check)
