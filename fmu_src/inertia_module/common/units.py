"""Quantities as people write them: a number in SI units, or a string with a unit."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping
from typing import Any

Dimension = dict[str, int]

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
_FACTOR = re.compile(r"([A-Za-z%°]+|1)(?:\^?(-?\d+))?$")

BOOLEANS: Mapping[str, float] = {"false": 0.0, "true": 1.0}

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
    "Hz": (1.0, {"s": -1}),
    "ms": (1e-3, {"s": 1}),
    "min": (60.0, {"s": 1}),
    "h": (3600.0, {"s": 1}),
    "kg": (1.0, {"kg": 1}),
    "g": (1e-3, {"kg": 1}),
    "t": (1e3, {"kg": 1}),
    "N": (1.0, {"kg": 1, "m": 1, "s": -2}),
    "kN": (1e3, {"kg": 1, "m": 1, "s": -2}),
    "Nm": (1.0, {"kg": 1, "m": 2, "s": -2}),
    "J": (1.0, {"kg": 1, "m": 2, "s": -2}),
    "kJ": (1e3, {"kg": 1, "m": 2, "s": -2}),
    "W": (1.0, {"kg": 1, "m": 2, "s": -3}),
    "kNm": (1e3, {"kg": 1, "m": 2, "s": -2}),
}


def parse_unit(text: str) -> tuple[float, Dimension]:
    """Factor to SI and exponents of kg, m, s, rad of a unit such as N.m.s/rad, kg m^2 or km/h."""
    factor = 1.0
    dimension: Counter[str] = Counter()
    for place, group in enumerate(text.split("/")):
        sign = 1 if place == 0 else -1
        for part in re.split(r"[.·*\s]+", group.strip()) if group.strip(" -") else ["1"]:
            match = _FACTOR.match(part)
            if match is None or match[1] not in _SYMBOLS:
                raise ValueError(f"{part} is an unknown unit")
            exponent = sign * int(match[2] or 1)
            base, exponents = _SYMBOLS[match[1]]
            factor *= base**exponent
            for name, power in exponents.items():
                dimension[name] += exponent * power
    return factor, {name: power for name, power in dimension.items() if power}


def has_mass(unit: str) -> bool:
    """Return True if a quantity in a unit ("" for none) scales with mass, like an inertia or a torque."""
    return "kg" in parse_unit(unit or "1")[1]


def factor_between(unit: str, wanted: str) -> float:
    """Factor from a unit to the unit wanted; a ValueError where these are unknown or of two dimensions."""
    if unit == wanted:
        return 1.0
    (factor, dimension), (to, needed) = parse_unit(unit), parse_unit(wanted)
    if dimension != needed:
        raise ValueError(f"{unit} is not a unit for {'a pure number' if wanted == '1' else wanted}")
    return factor / to


def split_quantity(text: str) -> tuple[float, str]:
    """The number and the unit ("" if there is none) of a string such as '1000 rpm'; else a ValueError."""
    match = _NUMBER.match(text)
    if match is None:
        raise ValueError("it is not a number with a unit")
    if re.search(r"\d,\d", text):
        raise ValueError("a number has a decimal point and no commas")
    return float(match[1]), match[2]


def allowed_number(
    unit: str, minimum: float | None = None, maximum: float | None = None, above: float | None = None
) -> str:
    """The allowed range of a number in a unit, as it follows "must be"."""
    limits = (("above", above), ("of at least", minimum), ("of at most", maximum))
    found = " and ".join(f"{bound} {limit:g}" for bound, limit in limits if limit is not None)
    number = f"a number {found}".rstrip()
    if unit == "1":
        return number
    example = "2" if above is None and minimum is None else f"{max(above or 0.0, minimum or 0.0, 2.0):g}"
    return f"{number} in {unit}, or a string with a unit such as '{example} {unit}'"


def number_of(value: Any, unit: str = "1", items: Mapping[str, float] | None = None) -> float:
    """The number, in the SI unit given, that a variable takes for a value; it may yet be out of its range.

    Args:
        value: a number, a string with a unit of the same dimension, or the name of an item.
        unit: of the variable. items: numbers by name, where it is an enumeration or a Boolean.

    Raises:
        ValueError: it is none of these, or not finite.
    """
    factor = 1.0
    if isinstance(value, str) and items is not None:
        if value not in items:
            raise ValueError(f"there is no {value!r}")
        value = items[value]
    elif isinstance(value, str):
        value, own = split_quantity(value)
        factor = factor_between(own or unit, unit)
    elif isinstance(value, bool) and items is not BOOLEANS:
        raise ValueError("it is not a number")
    try:
        number = float(value) * factor
    except (TypeError, ValueError):
        raise ValueError("it is not a number") from None
    if not math.isfinite(number):
        raise ValueError("it is not finite")
    return number
