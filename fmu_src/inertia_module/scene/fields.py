"""Fields of the tables of a scene: quantities in SI units within a range, alone, in lists and in columns."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationInfo, model_validator
from pydantic.fields import FieldInfo

from ..common.errors import did_you_mean
from ..common.units import allowed_number, to_si
from ..contract.variable import LARGEST_SPEED, LARGEST_TORQUE
from ..harness.results import TableError, read_columns
from ..loops import Table


def checked(
    value: Any,
    unit: str,
    minimum: float | None = None,
    maximum: float | None = None,
    above: float | None = None,
) -> float:
    """Convert a quantity to SI and check its range.

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
        unit: that it comes in, "1" or "" for none.
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


Time = Annotated[float, quantity("s", 0.0)]
Duration = Annotated[float, quantity("s", above=0.0)]
Times = Annotated[list[float], quantities("s")]
AngularSpeed = Annotated[float, quantity("rad/s", -LARGEST_SPEED, LARGEST_SPEED)]
Torque = Annotated[float, quantity("N.m", -LARGEST_TORQUE, LARGEST_TORQUE)]


class Strict(BaseModel):
    """Base of all tables of a scene: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Tabulated(Strict):
    """A quantity in columns, in the scene itself or in a CSV file with a heading row.

    The two fields of a table that are lists are the columns: first the points, then the values.

    Attributes:
        file: path from the folder of the scene.
    """

    file: str | None = None

    @classmethod
    def columns(cls, _: Any = None) -> dict[str, str]:
        """Units in SI, where the heading of a file gives none, of points and values, by name.

        The argument is the context of the validation.
        """
        lists = {name: field for name, field in cls.model_fields.items() if field.annotation == list[float]}
        return {name: unit_of(field) or "1" for name, field in lists.items()}

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Fill the columns from the file."""
        if not isinstance(data, dict) or "file" not in data:
            return data
        context = info.context or {}
        asked = cls.columns(context)
        if asked.keys() & data.keys():
            points, values = asked
            raise ValueError(f"give either 'file' or '{points}' and '{values}', not both")
        try:
            columns, units = read_columns(context.get("folder", Path()) / str(data["file"]))
        except TableError as error:
            raise ValueError(str(error)) from None
        filled = dict(data)
        for name, default in asked.items():
            if name not in columns:
                raise ValueError(f"{data['file']} must have a column {name} {did_you_mean(name, columns)}")
            unit = units.get(name, default)
            try:
                filled[name] = [checked(f"{value!r} {unit}", default) for value in columns[name]]
            except ValueError as error:
                raise ValueError(f"{name} of {data['file']} {error}") from None
        return filled

    @model_validator(mode="after")
    def _check(self) -> Tabulated:
        try:
            self.signal()
        except ValueError as error:
            raise ValueError(f"{', '.join(self.columns())}: {error}") from None
        return self

    def signal(self) -> Table:
        """The quantity over time, s, or distance, m; linear in between, held at the ends."""
        return Table(*(getattr(self, name) for name in self.columns()))


def one_signal(name: str, constant: float | None, over_time: Tabulated | None) -> float | Table:
    """Choose what is given of a constant and a table over time, two keys of which one must be there.

    Raises:
        ValueError: both are given, or neither.
    """
    if constant is not None and over_time is None:
        return constant
    if over_time is not None and constant is None:
        return over_time.signal()
    given = "neither is" if constant is None else "both are"
    raise ValueError(f"one of {name} and {name}_over_time must be given, {given}")
