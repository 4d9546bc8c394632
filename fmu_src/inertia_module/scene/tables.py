"""Common base of the tables of a scene, and quantities in columns: inline or in a CSV file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, ValidationInfo, model_validator

from ..common.errors import did_you_mean
from ..contract.variable import LARGEST_SPEED
from ..harness.results import TableError, read_columns
from ..loops import Table
from .units import checked, quantities, quantity

Time = Annotated[float, quantity("s", 0.0)]
Duration = Annotated[float, quantity("s", above=0.0)]
Times = Annotated[list[float], quantities("s")]
AngularSpeed = Annotated[float, quantity("rad/s", -LARGEST_SPEED, LARGEST_SPEED)]


class Strict(BaseModel):
    """Base of all tables of a scene: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Tabulated(Strict):
    """A quantity in columns, in the scene itself or in a CSV file with a heading row.

    Attributes:
        POINTS, VALUES: names of the columns. UNITS: of both, where the heading gives none.
        file: path from the folder of the scene.
    """

    POINTS: ClassVar[str] = "time"
    VALUES: ClassVar[str]
    UNITS: ClassVar[tuple[str, str]]

    file: str | None = None

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Fill the columns from the file."""
        if not isinstance(data, dict) or "file" not in data:
            return data
        if {cls.POINTS, cls.VALUES} & data.keys():
            raise ValueError(f"give either 'file' or '{cls.POINTS}' and '{cls.VALUES}', not both")
        context = info.context or {}
        try:
            columns, units = read_columns(context.get("folder", Path()) / str(data["file"]))
        except TableError as error:
            raise ValueError(str(error)) from None
        filled = dict(data)
        for name, default in zip((cls.POINTS, cls.VALUES), cls.units(context), strict=True):
            if name not in columns:
                raise ValueError(f"{data['file']} must have a column {name} {did_you_mean(name, columns)}")
            unit = units.get(name, default)
            try:
                filled[name] = [checked(f"{value!r} {unit}", default) for value in columns[name]]
            except ValueError as error:
                raise ValueError(f"{name} of {data['file']} {error}") from None
        return filled

    @classmethod
    def units(cls, _: Any) -> tuple[str, str]:
        """Units of points and values in SI; the argument is the context of the validation."""
        return cls.UNITS

    @model_validator(mode="after")
    def _check(self) -> Tabulated:
        try:
            self.signal()
        except ValueError as error:
            raise ValueError(f"{self.POINTS}, {self.VALUES}: {error}") from None
        return self

    def signal(self) -> Table:
        """The quantity over time, s, or distance, m; linear in between, held at the ends."""
        return Table(getattr(self, self.POINTS), getattr(self, self.VALUES))


def one_signal(name: str, constant: float | None, over_time: Tabulated | None) -> float | Table:
    """A quantity that is either constant or given over time, by two keys of which one must be there.

    Raises:
        ValueError: both are given, or neither.
    """
    if constant is not None and over_time is None:
        return constant
    if over_time is not None and constant is None:
        return over_time.signal()
    given = "neither is" if constant is None else "both are"
    raise ValueError(f"one of {name} and {name}_over_time must be given, {given}")
