"""Quantities as people write them: a number in SI units, or a string with a unit."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

from .errors import hint, suggestion, unknown

Dimension = dict[str, int]

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
# factor of a unit: a symbol or a unit in brackets, and its exponent
_FACTOR = re.compile(r"(\(.*\)|[A-Za-z%‰°]+|1)(?:\^?(-?\d+))?$")

BOOLEANS: Mapping[str, float] = {"false": 0.0, "true": 1.0}

_SPEED = {"m": 1, "s": -1}
_FORCE = {"kg": 1, "m": 1, "s": -2}
_ENERGY = {"kg": 1, "m": 2, "s": -2}
_POWER = {"kg": 1, "m": 2, "s": -3}
_POUND, _FOOT, _GRAVITY = 0.45359237, 0.3048, 9.80665
_POUND_FORCE = _POUND * _GRAVITY

# factor to SI and exponents of kg, m, s, rad for each symbol
_SYMBOLS: dict[str, tuple[float, Dimension]] = {
    "1": (1.0, {}),
    "%": (0.01, {}),
    "‰": (0.001, {}),
    "rad": (1.0, {"rad": 1}),
    "mrad": (1e-3, {"rad": 1}),
    "deg": (math.pi / 180.0, {"rad": 1}),
    "°": (math.pi / 180.0, {"rad": 1}),
    "arcmin": (math.pi / 10800.0, {"rad": 1}),
    "rev": (2.0 * math.pi, {"rad": 1}),
    "r": (2.0 * math.pi, {"rad": 1}),
    "U": (2.0 * math.pi, {"rad": 1}),
    "rpm": (math.pi / 30.0, {"rad": 1, "s": -1}),
    "RPM": (math.pi / 30.0, {"rad": 1, "s": -1}),
    "Umin": (math.pi / 30.0, {"rad": 1, "s": -1}),
    "m": (1.0, {"m": 1}),
    "um": (1e-6, {"m": 1}),
    "mm": (1e-3, {"m": 1}),
    "cm": (1e-2, {"m": 1}),
    "dm": (1e-1, {"m": 1}),
    "km": (1e3, {"m": 1}),
    "in": (_FOOT / 12.0, {"m": 1}),
    "ft": (_FOOT, {"m": 1}),
    "mi": (5280.0 * _FOOT, {"m": 1}),
    "kmh": (1.0 / 3.6, _SPEED),
    "kph": (1.0 / 3.6, _SPEED),
    "mph": (5280.0 * _FOOT / 3600.0, _SPEED),
    "s": (1.0, {"s": 1}),
    "sec": (1.0, {"s": 1}),
    "Hz": (1.0, {"s": -1}),
    "kHz": (1e3, {"s": -1}),
    "ms": (1e-3, {"s": 1}),
    "us": (1e-6, {"s": 1}),
    "ns": (1e-9, {"s": 1}),
    "min": (60.0, {"s": 1}),
    "h": (3600.0, {"s": 1}),
    "kg": (1.0, {"kg": 1}),
    "g": (1e-3, {"kg": 1}),
    "mg": (1e-6, {"kg": 1}),
    "t": (1e3, {"kg": 1}),
    "lb": (_POUND, {"kg": 1}),
    "slug": (_POUND_FORCE / _FOOT, {"kg": 1}),
    "N": (1.0, _FORCE),
    "mN": (1e-3, _FORCE),
    "kN": (1e3, _FORCE),
    "lbf": (_POUND_FORCE, _FORCE),
    "kgf": (_GRAVITY, _FORCE),
    "kp": (_GRAVITY, _FORCE),
    "Nm": (1.0, _ENERGY),
    "J": (1.0, _ENERGY),
    "kJ": (1e3, _ENERGY),
    "MJ": (1e6, _ENERGY),
    "Wh": (3600.0, _ENERGY),
    "kWh": (3.6e6, _ENERGY),
    "W": (1.0, _POWER),
    "kW": (1e3, _POWER),
    "MW": (1e6, _POWER),
    "PS": (75.0 * _GRAVITY, _POWER),
    "hp": (550.0 * _POUND_FORCE * _FOOT, _POWER),
    "kNm": (1e3, _ENERGY),
}

# products that are written without a sign between their factors
_PRODUCTS: dict[str, str] = {
    "Nmm": "N.mm",
    "Ncm": "N.cm",
    "mNm": "mN.m",
    "Nms": "N.m.s",
    "Umin-1": "rpm",
    "Ws": "W.s",
    "kgm2": "kg.m2",
    "kgcm2": "kg.cm2",
    "kgmm2": "kg.mm2",
    "gm2": "g.m2",
    "gcm2": "g.cm2",
    "gmm2": "g.mm2",
    "ftlb": "ft.lbf",
    "lbft": "lbf.ft",
    "inlb": "in.lbf",
    "lbin": "lbf.in",
    "lbfft": "lbf.ft",
    "lbfin": "lbf.in",
}

# units by kind of quantity, the SI unit first; quantities.md has this table
KINDS: dict[str, tuple[str, ...]] = {
    "pure number": ("1", "%", "‰"),
    "time": ("s", "ms", "us", "µs", "ns", "min", "h", "sec"),
    "angle": ("rad", "deg", "°", "arcmin", "mrad", "rev", "r", "U"),
    "rotational speed": (
        *("rad/s", "rpm", "RPM", "1/min", "min-1", "min⁻¹", "U/min", "Umin", "r/min", "rev/min", "rev/s"),
        *("deg/s", "°/s"),
    ),
    "rotational acceleration": ("rad/s2", "rad/s²", "rpm/s", "1/min/s", "rev/s2", "deg/s2"),
    "frequency": ("Hz", "kHz", "1/s", "s-1", "s⁻¹", "1/min"),
    "length": ("m", "mm", "cm", "dm", "km", "um", "µm", "in", "ft", "mi"),
    "speed": ("m/s", "km/h", "kmh", "kph", "mph", "mm/s", "ft/s"),
    "acceleration": ("m/s2", "m/s²", "mm/s2", "ft/s2"),
    "area": ("m2", "m²", "cm2", "mm2", "ft2", "in2"),
    "mass": ("kg", "g", "mg", "t", "lb", "slug"),
    "density": ("kg/m3", "kg/m³", "kg/dm3", "g/cm3", "lb/ft3"),
    "moment of inertia": (
        *("kg.m2", "kg·m²", "kgm2", "kg.cm2", "kgcm2", "kgmm2", "gm2", "gcm2", "gmm2"),
        *("lb.ft2", "lb.in2", "slug.ft2"),
    ),
    "force": ("N", "kN", "mN", "lbf", "kgf", "kp"),
    "torque": (
        *("N.m", "N·m", "Nm", "kNm", "Ncm", "Nmm", "mNm", "kgf.m"),
        *("lbf.ft", "lb.ft", "ft.lb", "lbft", "lbfft", "ftlb", "lbf.in", "lb.in", "in.lb", "lbin", "lbfin"),
        "inlb",
    ),
    "stiffness": ("N.m/rad", "Nm/rad", "kNm/rad", "Nm/deg", "Nm/°", "lbf.ft/rad", "lbf.in/deg"),
    "damping": ("N.m.s/rad", "Nms/rad", "Nm/(rad/s)", "Nm/rpm", "Nm/(1/min)", "Nms/deg", "lbf.ft.s/rad"),
    "linear damping": ("N.s/m", "kg/s"),
    "energy": ("J", "kJ", "MJ", "Ws", "Wh", "kWh"),
    "power": ("W", "kW", "MW", "PS", "hp"),
}

# variants of the signs in units
_SIGNS = str.maketrans("·⋅∙•×*−µμº∕÷", "......-uu°//")
_RAISED = str.maketrans("⁻⁺⁰¹²³⁴⁵⁶⁷⁸⁹", "-+0123456789")
# revolutions per minute, alone or after a bracket or a slash
_PER_MINUTE = re.compile(r"(?<![\w.^])(?:1?/min|min\^?-1)(?![\w^])")


def _plain(text: str) -> str:
    """Return a unit with "." for products, "-" for minus and digits for exponents."""
    raised = re.sub(r"[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+", lambda digits: f"^{digits[0].translate(_RAISED)}", text)
    typed = raised.strip().replace("**", "^").translate(_SIGNS)
    # a hyphen between letters is a product: N-m, ft-lb
    joined = re.sub(r"(?<=[A-Za-z])-(?=[A-Za-z])", ".", typed)
    return re.sub(r"[.\s]+", ".", re.sub(r"\s*([/()^])\s*", r"\1", joined))


def _parse_factor(part: str) -> tuple[float, Dimension, int]:
    """Split one factor of a unit, such as m2: factor to SI and dimension without its exponent; exponent."""
    product = _PRODUCTS.get(part.replace("^", ""))
    if product is not None:
        return (*parse_unit(product), 1)
    match = _FACTOR.match(part)
    if match is not None and match[1].startswith("("):
        return (*parse_unit(match[1][1:-1]), int(match[2] or 1))
    if match is None or match[1] not in _SYMBOLS:
        raise ValueError(f"unknown unit {part!r}")
    return (*_SYMBOLS[match[1]], int(match[2] or 1))


def parse_unit(text: str) -> tuple[float, Dimension]:
    """Return the factor to SI and the exponents of kg, m, s, rad of a unit.

    All factors after a slash divide, up to the end of the unit or of the brackets.

    Args:
        text: the unit, such as N.m.s/rad, kg m², Nm/(rad/s) or km/h.

    Raises:
        ValueError: the unit is unknown.
    """
    factor = 1.0
    dimension: Counter[str] = Counter()
    plain = _plain(text)
    # a slash or a point within brackets belongs to the inner unit, so it does not split
    groups = re.split(r"/(?![^(]*\))", "1" if plain in ("", "-") else re.sub("^/", "1/", plain))
    for place, group in enumerate(groups):
        sign = 1 if place == 0 else -1
        for part in re.split(r"\.(?![^(]*\))", group):
            base, exponents, exponent = _parse_factor(part)
            factor *= base ** (sign * exponent)
            for name, power in exponents.items():
                dimension[name] += sign * exponent * power
    return factor, {name: power for name, power in dimension.items() if power}


def has_mass(unit: str) -> bool:
    """Return True if a quantity scales with mass, as an inertia or a torque does.

    Args:
        unit: unit of the quantity, or "" for a pure number.
    """
    return "kg" in parse_unit(unit or "1")[1]


def _unit_readings(unit: str) -> Iterator[str]:
    """Yield a unit as written, then as engineers may mean it: 1/min as rpm, lb as lbf."""
    plain = _plain(unit)
    yield plain
    if _PER_MINUTE.search(plain):
        yield _PER_MINUTE.sub("rpm", plain)
    if re.search(r"\blb\b", plain):
        yield re.sub(r"\blb\b", "lbf", plain)


def units_like(unit: str) -> tuple[str, ...]:
    """Return the units of the same kind; the unit alone if its kind is not in KINDS.

    Args:
        unit: a unit.

    Raises:
        ValueError: the unit is unknown.
    """
    dimension = parse_unit(unit)[1]
    alike = [units for units in KINDS.values() if parse_unit(units[0])[1] == dimension]
    return next((units for units in alike if unit in units), alike[0] if alike else (unit,))


@lru_cache(256)
def factor_between(unit: str, target: str) -> float:
    """Return the factor that converts numbers from a unit to another unit.

    A unit with a different dimension is read as engineers use it: 1/min is rpm for a rotational speed, lb.ft
    is lbf.ft for a torque.

    Args:
        unit: unit as written.
        target: unit of the result.

    Raises:
        ValueError: a unit is unknown, or the dimensions differ.
    """
    if unit == target:
        return 1.0
    to, needed = parse_unit(target)
    try:
        for reading in _unit_readings(unit):
            factor, dimension = parse_unit(reading)
            if dimension == needed:
                return factor / to
    except ValueError as error:
        raise ValueError(f"{error}{suggestion(unit, units_like(target))}") from None
    raise ValueError(f"incompatible unit {unit!r}; available: {', '.join(units_like(target))}")


def printed_unit(unit: str) -> str:
    """Return a unit in typographic form, such as N·m or rad/s².

    Args:
        unit: the unit, such as N.m or rad/s2.
    """
    return re.sub(r"(?<=[a-z])2(?![0-9])", "²", unit).replace(".", "·")


def split_quantity(text: str) -> tuple[float, str]:
    """Return the number and the unit ("" if there is none) of a string such as '1000 rpm'.

    Args:
        text: the string.

    Raises:
        ValueError: the string is not a number with a unit.
    """
    match = _NUMBER.match(text)
    if match is None:
        raise ValueError("not a number with a unit")
    if re.search(r"\d,\d", text):
        raise ValueError("use a decimal point and no commas")
    return float(match[1]), match[2]


def allowed_number(
    unit: str, minimum: float | None = None, maximum: float | None = None, above: float | None = None
) -> str:
    """Return the allowed range of a number, as it follows "must be".

    Args:
        unit: unit of the number and of the limits.
        minimum: minimum, or None.
        maximum: maximum, or None.
        above: exclusive lower limit, or None.
    """
    limits = (("above", above), ("at least", minimum), ("at most", maximum))
    bounds = " and ".join(f"{bound} {limit:g}" for bound, limit in limits if limit is not None)
    number = f"a number {'of ' if bounds and above is None else ''}{bounds}".rstrip()
    if unit == "1":
        return number
    example = "2" if above is None and minimum is None else f"{max(above or 0.0, minimum or 0.0, 2.0):g}"
    return f"{number} in {unit}, or a string with a unit such as '{example} {unit}'"


def number_of(value: Any, unit: str = "1", items: Mapping[str, float] | None = None) -> float:
    """Convert a value to the number of a variable; the range of the variable is not checked.

    Args:
        value: a number, a string with a unit of the same dimension, or the name of an item.
        unit: SI unit of the variable.
        items: numbers by name, for an enumeration or a Boolean.

    Raises:
        ValueError: the value has another type, or is not finite.
    """
    factor = 1.0
    if isinstance(value, str) and items is not None:
        if value not in items:
            raise ValueError(unknown("item", value, items))
        value = items[value]
    elif isinstance(value, str):
        value, own = split_quantity(value)
        factor = factor_between(own or unit, unit)
    elif isinstance(value, bool) and items is not BOOLEANS:
        raise ValueError("not a number")
    try:
        number = float(value) * factor
    except (TypeError, ValueError):
        raise ValueError("not a number") from None
    if not math.isfinite(number):
        raise ValueError("not finite")
    return number


def with_reason(message: str, error: ValueError, value: Any, items: Mapping[str, float] | None = None) -> str:
    """Append the reason of an error to a message; for an unknown item append only a suggestion.

    Args:
        message: "NAME must be ALLOWED (got VALUE)", where ALLOWED contains the items.
        error: error of number_of.
        value: the invalid value.
        items: numbers by name, for an enumeration or a Boolean.
    """
    if items is not None and isinstance(value, str):
        return f"{message}{hint(value, items)}"
    return f"{message}: {error}"
