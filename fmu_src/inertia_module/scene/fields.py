"""Fields of the tables of a scene: quantities in SI units within a range, alone, in lists and in columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationInfo, model_validator
from pydantic.fields import FieldInfo

from ..common.errors import did_you_mean
from ..common.units import allowed_number, number_of, to_si
from ..contract.variables import LARGEST_SPEED, LARGEST_TORQUE, Variable
from ..harness.results import TableError, read_columns
from ..loops.sources import Signal, Table

FIDELITY = "fidelity"
# the fidelity is to be chosen from measurements
AUTO = "auto"


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


def _in_range(variable: Variable) -> InUnit:
    """Pydantic validator of a value of a variable: a number in SI, one with a unit, the name of an item."""

    def check(value: Any) -> float | str:
        if variable.name == FIDELITY and value == AUTO:
            return AUTO
        also = f", or {AUTO}" if variable.name == FIDELITY else ""
        sentence = f"must be {variable.allowed}{also}, is {value!r}"
        try:
            number = number_of(value, variable.unit or "1", variable.items)
        except ValueError as error:
            raise ValueError(f"{sentence}: {error}") from None
        if not variable.accepts(number):
            raise ValueError(sentence)
        return number

    return InUnit(check, unit=variable.unit)


def fields_of(variables: Sequence[Variable]) -> Any:
    """Fields of a table for variables, as of pydantic.create_model: each may be given."""
    number: Any = float | None
    types = {variable.name: number for variable in variables}
    if FIDELITY in types:
        types[FIDELITY] = number | Literal["auto"]
    return {one.name: (Annotated[types[one.name], _in_range(one)], None) for one in variables}


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


class ConstantOrTable(Strict):
    """A quantity that is constant or over time: two keys of which one must be there.

    Attributes:
        SIGNAL: its name; that of the table ends with _over_time.
    """

    SIGNAL: ClassVar[str]

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        self.one_signal()
        return self

    def one_signal(self) -> Signal:
        """The quantity, constant or over time, in SI."""
        constant, over_time = getattr(self, self.SIGNAL), getattr(self, f"{self.SIGNAL}_over_time")
        if (constant is None) == (over_time is None):
            given = "neither is" if constant is None else "both are"
            raise ValueError(f"one of {self.SIGNAL} and {self.SIGNAL}_over_time must be given, {given}")
        signal: Signal = constant if over_time is None else over_time.signal()
        return signal
