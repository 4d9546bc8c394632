"""Types and checks of the keys of a scene: quantities in SI within a range, columns and tables."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import core_schema

from ..common.csv_table import CsvTable, TableError
from ..common.deprecated import warn_renamed
from ..common.equality import hash_of
from ..common.errors import InertiaModuleError, SceneError, hint, must_be, suggestion
from ..common.time_range import time_warnings
from ..common.units import allowed_number, number_of, with_reason
from ..driveline.sources import Signal, Table
from ..interface.variables import INTEGER, LARGEST_SPEED, LARGEST_TORQUE, Variable

# --- quantities, alone, in lists and in columns ---

# remedy in messages about Windows paths in TOML
SLASHES = "Write / instead of \\, or put the path in single quotes."
# value of fidelity for which the package chooses a level by measurements
AUTO = "auto"


def _must_be(allowed: str, value: Any) -> str:
    """Return the message for an invalid value, without the name of its key."""
    return must_be("", allowed, repr(value)).lstrip()


def checked(
    value: Any,
    unit: str,
    minimum: float | None = None,
    maximum: float | None = None,
    above: float | None = None,
) -> float:
    """Convert a quantity to SI and check its range.

    Args:
        value: Number in the unit, or text with a unit of the same dimension.
        unit: SI unit, "1" for none.
        minimum: Minimum, in the unit.
        maximum: Maximum, in the unit.
        above: Exclusive lower limit, in the unit.

    Raises:
        ValueError: The value is not allowed; the message lacks the name of the key.
    """
    message = _must_be(allowed_number(unit, minimum, maximum, above), value)
    try:
        number = number_of(value, unit)
    except ValueError as error:
        raise ValueError(f"{message}: {error}") from None
    low, high = -math.inf if minimum is None else minimum, math.inf if maximum is None else maximum
    if not low <= number <= high or (above is not None and number <= above):
        raise ValueError(message)
    return number


@dataclass(frozen=True)
class InUnit:
    """Pydantic validator of a quantity, which JSON contains as text with its unit.

    Attributes:
        check: Function that converts a value to SI or raises ValueError.
        unit: SI unit, "1" for none.
        variable: Variable of the FMU that the quantity is a value of, or None.
    """

    check: Callable[[Any], Any]
    unit: str
    variable: Variable | None = None

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        serializer = core_schema.plain_serializer_function_ser_schema(self.written, when_used="json")
        return core_schema.no_info_before_validator_function(
            self.check, handler(source), serialization=serializer
        )

    def written(self, value: Any) -> Any:
        """Return a value as in a scene file: items by name, integers without a decimal point.

        Args:
            value: Value in SI.
        """
        if self.variable is not None:
            items = {number: item for item, number in (self.variable.items or {}).items()}
            value = items.get(value, int(value) if self.variable.kind == INTEGER else value)
        unit = self.unit.removeprefix("1")
        return f"{value!r} {unit}".replace(".0 ", " ") if unit and isinstance(value, float) else value


def unit_of(field: FieldInfo) -> str:
    """Return the unit of the quantity in a field of a table, "" for none.

    Args:
        field: Field of a pydantic model.
    """
    parts = [*field.metadata, field.annotation]
    while parts:
        part = parts.pop()
        if isinstance(part, InUnit):
            return "" if part.unit == "1" else part.unit
        parts += get_args(part)
    return ""


def quantity(
    unit: str, minimum: float | None = None, maximum: float | None = None, above: float | None = None
) -> InUnit:
    """Make a pydantic validator of a quantity within a range.

    Args:
        unit: SI unit, "1" for none.
        minimum: Minimum, in the unit.
        maximum: Maximum, in the unit.
        above: Exclusive lower limit, in the unit.
    """
    return InUnit(lambda value: checked(value, unit, minimum, maximum, above), unit)


Duration = Annotated[float, quantity("s", above=0.0)]
Times = list[Annotated[float, quantity("s")]]
AngularSpeed = Annotated[float, quantity("rad/s", -LARGEST_SPEED, LARGEST_SPEED)]
Torque = Annotated[float, quantity("N.m", -LARGEST_TORQUE, LARGEST_TORQUE)]


def in_range(variable: Variable) -> InUnit:
    """Make a pydantic validator of a value of a variable.

    It accepts a number in SI, text with a unit, and the name of an item of an enumeration.

    Args:
        variable: Variable of the FMU.
    """

    def check(value: Any) -> float | str:
        if variable.name == "fidelity" and value == AUTO:
            return AUTO
        alternative = f", or {AUTO}" if variable.name == "fidelity" else ""
        message = _must_be(f"{variable.allowed}{alternative}", value)
        try:
            number = number_of(value, variable.unit or "1", variable.items)
        except ValueError as error:
            raise ValueError(with_reason(message, error, value, variable.items)) from None
        if not variable.accepts(number):
            raise ValueError(message)
        return number

    return InUnit(check, variable.unit, variable)


def fields_of(variables: Sequence[Variable]) -> Any:
    """Return optional fields for variables, as arguments of pydantic.create_model.

    Args:
        variables: Variables of the FMU.
    """
    number: Any = float | None
    types = {variable.name: number for variable in variables}
    if "fidelity" in types:
        types["fidelity"] = number | Literal["auto"]
    return {row.name: (Annotated[types[row.name], in_range(row)], None) for row in variables}


class Strict(BaseModel):
    """Base of all tables of a scene; rejects unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    def __hash__(self) -> int:
        return hash_of({name: getattr(self, name) for name in type(self).model_fields})


class Cell(str):
    """Quantity from a CSV file: text with its unit.

    Attributes:
        table: Table of the file.
        row: Row of the quantity in the table, from 0.
    """

    table: CsvTable
    row: int

    @classmethod
    def cells(cls, table: CsvTable, name: str, numbers: Sequence[float]) -> list[Self]:
        """Return the numbers of a column as texts, in the unit of its heading or else in SI.

        Args:
            table: Table of the file.
            name: Name of the column.
            numbers: Numbers of the column, one per row.
        """
        unit, cells = table.units.get(name, ""), []
        for row, number in enumerate(numbers):
            cell = cls(f"{number!r} {unit}")
            cell.table, cell.row = table, row
            cells.append(cell)
        return cells


# Control characters, which Python and TOML write with a backslash. No path contains them.
_ESCAPED = re.compile(r"[\x00-\x1f]")


def _path_of(file: str, folder: Path) -> Path:
    """Return the path of a file of a scene; raise ValueError if backslashes became control characters."""
    if _ESCAPED.search(file):
        demand = must_be("file", "a path", repr(file))
        raise ValueError(f"{demand}. In double quotes a backslash starts an escape sequence. {SLASHES}")
    return folder / file


class Tabulated(Strict):
    """Base of a quantity in two columns, in the scene itself or in a CSV file with a heading row.

    The two list fields of a subclass are the columns: first the points, then the values.

    Attributes:
        file: Path of the CSV file, relative to the folder of the scene; None for columns in the scene.
    """

    file: str | None = Field(default=None, exclude=True)

    @classmethod
    def columns(cls) -> list[str]:
        """Return the names of the columns: points, values."""
        return [name for name, field in cls.model_fields.items() if get_origin(field.annotation) is list]

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Fill the columns from the file."""
        if not isinstance(data, dict) or "file" not in data:
            return data
        points, values = columns = cls.columns()
        if not data.keys().isdisjoint(columns):
            raise ValueError(f"only one of file and ({points}, {values}) is allowed (got both)")
        try:
            path = _path_of(str(data["file"]), (info.context or {}).get("folder", Path()))
            table = CsvTable(path, columns)
            numbers = {points: table.points(points), values: table.numbers(values)}
        except TableError as error:
            raise ValueError(str(error)) from None
        return data | {name: Cell.cells(table, name, numbers[name].tolist()) for name in columns}

    @model_validator(mode="after")
    def _check(self) -> Tabulated:
        try:
            self.signal()
        except ValueError as error:
            raise ValueError(f"{', '.join(self.columns())}: {error}") from None
        return self

    def signal(self) -> Table:
        """Return the quantity over its points: linear between them, constant beyond the ends."""
        return Table(*(getattr(self, name) for name in self.columns()))


class ConstantOrTable(Strict):
    """Base of a quantity that is a constant (key SIGNAL) or a table (key SIGNAL with _over_time).

    Attributes:
        SIGNAL: Name of the quantity.
    """

    SIGNAL: ClassVar[str]

    @model_validator(mode="after")
    def _check_signal(self) -> Self:
        self.one_signal()
        return self

    def one_signal(self) -> Signal:
        """Return the quantity in SI, constant or over time, s.

        Raises:
            ValueError: Both keys are present, or none.
        """
        constant, over_time = getattr(self, self.SIGNAL), getattr(self, f"{self.SIGNAL}_over_time")
        if (constant is None) == (over_time is None):
            present = "none" if constant is None else "both"
            raise ValueError(f"one of {self.SIGNAL} and {self.SIGNAL}_over_time is required (got {present})")
        signal: Signal = constant if over_time is None else over_time.signal()
        return signal


def tables_over_time(table: BaseModel, name: str = "") -> Iterator[tuple[str, Tabulated]]:
    """Yield all tables with columns over time, within a table of a scene or the scene, by dotted key.

    Args:
        table: Table of a scene.
        name: Dotted key of the table; "" for the scene.
    """
    if isinstance(table, Tabulated) and table.columns()[0] == "time":
        yield name, table
    for key in table.model_fields_set:
        value = getattr(table, key, None)
        if isinstance(value, BaseModel):
            yield from tables_over_time(value, f"{name}.{key}".lstrip("."))


def scene_time_warnings(scene: BaseModel, stop_time: float) -> list[str]:
    """Return warnings about tables whose times probably do not match the run.

    Args:
        scene: The scene.
        stop_time: End of the run, s.

    Raises:
        TableError: A table has no time within the run.
    """
    return [
        text
        for key, table in tables_over_time(scene)
        for text in time_warnings(
            f"{key} ({table.file})" if table.file else key,
            table.signal().points,
            [table.signal().values],
            stop_time,
        )
    ]


# --- tables by their keys ---

Model = TypeVar("Model", bound=BaseModel)
MECHANISM = "mechanism."
# allowed values by error type of pydantic, if its own message differs in style
_ALLOWED = {
    "model_type": "a table",
    "model_attributes_type": "a table",
    "list_type": "a list",
    "too_short": "a list with at least one element",
    "string_type": "a string",
}


def _models(annotation: Any) -> list[type[BaseModel]]:
    """Return the models within a type: the type itself, or the members of a union."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models(part)]


def _kind(model: type[BaseModel]) -> str:
    """Return the value of the key kind of a model, "" without this key."""
    field = model.model_fields.get("kind")
    return str(get_args(field.annotation)[0]) if field is not None else ""


def _keys_and_models(
    scene: type[BaseModel], location: tuple[Any, ...]
) -> tuple[list[str], list[type[BaseModel]]]:
    """Return the keys of a location of pydantic, without the kinds it inserts, and the models there."""
    keys: list[str] = []
    models = [scene]
    for part in location:
        members = [model for model in models if len(models) > 1 and _kind(model) == part]
        if members:
            models = members
            continue
        keys.append(str(part))
        fields = [model.model_fields[part] for model in models if part in model.model_fields]
        models = [model for field in fields for model in _models(field.annotation)]
    return keys, models


def _unknown_key_message(scene: type[BaseModel], location: tuple[Any, ...], value: Any) -> str:
    """Return the message for a key that no model contains."""
    parents, models = _keys_and_models(scene, location[:-1])
    names = list(dict.fromkeys(name for model in models for name in model.model_fields))
    key = ".".join([*parents, str(location[-1])])
    others = [
        model for model in _keys_and_models(scene, location[:-2])[1] if location[-1] in model.model_fields
    ]
    if len(models) == 1 and others and location[-2] == _kind(models[0]):
        table, kinds = ".".join(parents), " or ".join(repr(_kind(model)) for model in others)
        return (
            f"{key} = {value!r} is not allowed with {table}.kind = {location[-2]!r}, only with kind"
            f" {kinds}{hint(location[-1], names)}"
        )
    return f"unknown key {key!r}{suggestion(location[-1], names)}"


def _is_combination(error: Any) -> bool:
    """Return True if an error of pydantic is a contradiction between several keys."""
    return error["type"] == "value_error" and isinstance(error["ctx"]["error"], InertiaModuleError)


def _message(scene: type[BaseModel], error: Any) -> str:
    """Return the message for one error of pydantic."""
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    keys, models = _keys_and_models(scene, error["loc"])
    key = ".".join(keys) or "scene"
    if kind == "extra_forbidden":
        return _unknown_key_message(scene, error["loc"], value)
    if kind == "missing":
        return f"missing key {key!r}"
    if kind == "union_tag_not_found":
        kinds = ", ".join(repr(_kind(model)) for model in models)
        return f"missing key '{key}.kind'. It must be one of {kinds}."
    if kind == "union_tag_invalid":
        message = must_be(f"{key}.kind", f"one of {context['expected_tags']}", repr(context["tag"]))
        return f"{message}{hint(context['tag'], map(_kind, models))}"
    if kind == "value_error":
        reason = context["error"]
        if _is_combination(error):
            return str(reason)
        if isinstance(value, Cell):
            return f"{value.table.place(value.row)}: {'.'.join(keys[:-1])} {reason}"
        return f"{key}: {reason}" if isinstance(value, dict) else f"{key} {reason}"
    allowed = _ALLOWED.get(kind) or context.get("expected") or error["msg"].removeprefix("Input should be ")
    return must_be(key, allowed, repr(value))


# tables and texts of a scene, shaft or specification; "drive" is also a parameter of the mechanism
_TABLES = (
    "title",
    "description",
    "mechanism",
    "shaft",
    "load",
    "controller",
    "freewheels",
    "accuracy",
    "run",
    "free",
    "metrics",
    "search",
)


def full_key(name: str) -> str:
    """Return the full dotted key, with the prefix ``mechanism.`` if the name has no dot and is no table.

    Args:
        name: Dotted key, name of a parameter of the mechanism, or name of a table.
    """
    return name if "." in name or name in _TABLES else f"{MECHANISM}{name}"


# values by dotted key, or by the name of a parameter of the mechanism
Keys = Mapping[str, object]


def by_dotted_key(keys: Keys | Iterable[str] | None) -> dict[str, object]:
    """Return values by dotted key.

    Args:
        keys: Values by key or by the name of a parameter of the mechanism. Texts KEY=VALUE are deprecated.
    """
    if keys is not None and not isinstance(keys, Mapping):
        warn_renamed("a list of texts KEY=VALUE", "a mapping from keys to values")
        keys = keys_from_options(keys)
    values = keys or {}
    is_table = isinstance(values.get("drive"), Mapping | BaseModel)
    return {name if name == "drive" and is_table else full_key(name): values[name] for name in values}


def keys_from_options(texts: Iterable[str] | None) -> dict[str, object]:
    """Return values by dotted key from the options --set of the command line.

    Args:
        texts: Texts KEY=VALUE with values as in a scene file; strings need no quotes.

    Raises:
        SceneError: A text is not of the form KEY=VALUE.
    """
    values: dict[str, object] = {}
    for text in texts or ():
        name, _, value = (part.strip() for part in text.partition("="))
        if not (name and value):
            raise SceneError(f"expected KEY=VALUE (got {text!r})")
        try:
            values[full_key(name)] = tomllib.loads(f"value = {value}")["value"]
        except tomllib.TOMLDecodeError:
            values[full_key(name)] = value
    return values


def with_value(tables: dict[str, Any], path: Sequence[str], value: Any) -> dict[str, Any]:
    """Return a copy of nested tables with one value changed.

    Args:
        tables: The nested tables.
        path: Parts of the dotted key.
        value: New value; None removes the key.
    """
    head, *rest = path
    if rest:
        table = tables.get(head)
        value = with_value(table if isinstance(table, dict) else {}, rest, value)
    others = {name: part for name, part in tables.items() if name != head}
    return others if value is None else {**others, head: value}


def validated(model: type[Model], tables: dict[str, Any], folder: Path = Path()) -> Model:
    """Check nested tables and return them as a scene.

    Args:
        model: Model of the scene.
        tables: Tables as read from TOML, or Scene.tables; valid models may replace tables.
        folder: Folder of the scene file; paths of CSV files are relative to it.

    Raises:
        SceneError: A value is invalid; the message is one line with key, value and allowed range.
    """
    load = tables.get("load")
    kind = load.get("kind") if isinstance(load, dict) else getattr(load, "kind", None)
    try:
        return model.model_validate(tables, context={"folder": folder, "vehicle": kind == "vehicle"})
    except ValidationError as failure:
        # Unknown keys come first, because a missing key may only be misspelt.
        first, *others = sorted(failure.errors(), key=lambda error: error["type"] != "extra_forbidden")
        more = f" (and {len(others)} more)" if others else ""
        key = "" if _is_combination(first) else ".".join(_keys_and_models(model, first["loc"])[0])
        raise SceneError(" ".join(_message(model, first).split()) + more, key) from None
