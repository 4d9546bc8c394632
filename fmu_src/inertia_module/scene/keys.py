"""Tables of a scene by their keys: with some changed, and checked as a scene."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from .controllers import measured_speed
from .errors import SceneError, one_line

Model = TypeVar("Model", bound=BaseModel)
MECHANISM = "mechanism."


def full_name(name: str) -> str:
    """A key by dots; those of the mechanism may go without their table."""
    return name if "." in name else f"{MECHANISM}{name}"


def keys_of(given: Iterable[str] | None) -> dict[str, Any]:
    """Values by key, named by dots, of texts such as "imbalance_mass=2 kg" or "load.kind=shaft".

    Args:
        given: KEY=VALUE each; the value as in a scene file, where a string needs no quotes; or None.

    Raises:
        SceneError: a text is not of this form.
    """
    found = {}
    for text in given or ():
        name, _, value = (part.strip() for part in text.partition("="))
        if not (name and value):
            raise SceneError(f"what is set must be given as KEY=VALUE, is {text!r}")
        try:
            found[full_name(name)] = tomllib.loads(f"value = {value}")["value"]
        except tomllib.TOMLDecodeError:
            found[full_name(name)] = value
    return found


def without_files(data: dict[str, Any]) -> dict[str, Any]:
    """Tables without the names of the CSV files whose columns they hold."""
    return {
        name: without_files(value) if isinstance(value, dict) else value
        for name, value in data.items()
        if name != "file"
    }


def changed(tables: dict[str, Any], path: Sequence[str], value: Any) -> dict[str, Any]:
    """Tables with one key changed, in copies; None takes it away."""
    head, *rest = path
    if rest:
        table = tables.get(head)
        value = changed(table if isinstance(table, dict) else {}, rest, value)
    others = {name: kept for name, kept in tables.items() if name != head}
    return others if value is None else {**others, head: value}


def validated(
    model: type[Model], tables: dict[str, Any], folder: Path = Path(), before: Model | None = None
) -> Model:
    """Tables as a scene of a kind.

    Args:
        model: Scene, or another kind. tables: as read from TOML, or Scene.tables; some may be checked ones.
        folder: where paths of CSV files in them start. before: the scene that these are tables of, changed.

    Raises:
        SceneError: in one line, the key, the value and what is allowed.
    """
    load = tables.get("load")
    kind = load.get("kind") if isinstance(load, dict) else getattr(load, "kind", None)
    context = {"folder": folder, "measured": measured_speed(kind), "before": before}
    try:
        return model.model_validate(tables, context=context)
    except ValidationError as failure:
        raise SceneError(one_line(model, failure)) from None
