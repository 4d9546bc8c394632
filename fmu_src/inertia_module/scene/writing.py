"""Scenes as text: what read_scene reads back as the same scene."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from ..common.extras import library
from ..contract.variable import INTEGER
from ..contract.variables import BY_NAME
from .mechanism import Mechanism
from .schema import Scene
from .units import unit_of


def scene_text(scene: Scene) -> str:
    """The TOML text of a scene: keys that differ from their defaults, quantities in SI with their units.

    Raises:
        NotInstalled: the extra jobs is not.
    """
    written: str = library("tomli_w", "jobs", "tomli-w").dumps(_table(scene), multiline_strings=True)
    return written


def _table(table: BaseModel) -> dict[str, Any]:
    """The keys of a table; columns of CSV files stand in it."""
    written = {}
    for name, field in type(table).model_fields.items():
        value = getattr(table, name)
        if value is None or name == "file" or value == field.get_default(call_default_factory=True):
            continue
        written[name] = _item(name, value) if isinstance(table, Mechanism) else _value(value, unit_of(field))
    return written


def _value(value: Any, unit: str) -> Any:
    """A value of a key; a quantity with its unit, digit for digit."""
    if isinstance(value, BaseModel):
        return _table(value)
    if isinstance(value, list):
        return [_value(one, unit) for one in value]
    return f"{value!r} {unit}".replace(".0 ", " ") if unit and isinstance(value, float) else value


def _item(name: str, value: Any) -> Any:
    """A parameter: an item of an enumeration by its name, a whole number as one."""
    variable = BY_NAME[name]
    item = next((item for item, number in (variable.items or {}).items() if number == value), None)
    if item is not None:
        return item
    return int(value) if variable.kind == INTEGER else _value(value, variable.unit.removeprefix("1"))
