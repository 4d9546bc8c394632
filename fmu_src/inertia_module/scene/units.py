"""Validators of the quantities of a scene: within a range, in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, get_args

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo

from ..common.units import allowed_number, to_si


def checked(
    value: Any,
    unit: str,
    minimum: float | None = None,
    maximum: float | None = None,
    above: float | None = None,
) -> float:
    """A quantity in SI within a range.

    Raises:
        ValueError: what the value must be and what it is, to be said after its name.
    """
    sentence = f"must be {allowed_number(unit, minimum, maximum, above)}, is {value!r}"
    try:
        number = to_si(value, unit)
    except ValueError as error:
        raise ValueError(f"{sentence}: {error}") from None
    if (
        (minimum is not None and number < minimum)
        or (maximum is not None and number > maximum)
        or (above is not None and number <= above)
    ):
        raise ValueError(sentence)
    return number


@dataclass(frozen=True, slots=True)
class InUnit(BeforeValidator):
    """Pydantic validator of a quantity.

    Attributes:
        unit: that it comes in, "" for none.
    """

    unit: str = ""


def unit_of(field: FieldInfo) -> str:
    """Unit of the quantity that a field of a table holds, "" for none."""
    waiting = [*field.metadata, field.annotation]
    while waiting:
        one = waiting.pop()
        if isinstance(one, InUnit):
            return "" if one.unit == "1" else one.unit
        waiting += get_args(one)
    return ""


def quantity(
    unit: str, minimum: float | None = None, maximum: float | None = None, above: float | None = None
) -> InUnit:
    """Pydantic validator of a quantity in a unit within a range."""
    return InUnit(lambda value: checked(value, unit, minimum, maximum, above), unit=unit)


def quantities(unit: str, minimum: float | None = None, maximum: float | None = None) -> InUnit:
    """Pydantic validator of a list of quantities in a unit within a range."""

    def check(value: Any) -> list[float]:
        if not isinstance(value, list) or not value:
            raise ValueError(
                f"must be a list of at least one number in {unit}, or strings with a unit, is {value!r}"
            )
        return [checked(item, unit, minimum, maximum) for item in value]

    return InUnit(check, unit=unit)
