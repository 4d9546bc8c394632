"""Validators of the quantities of a scene: within a range, in SI units."""

from __future__ import annotations

from typing import Any

from pydantic import BeforeValidator

from ..units import in_words, to_si


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
