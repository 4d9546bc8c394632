"""Tables of a scene by their keys: with some changed, checked as a scene, refused in one line."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from ..common.errors import Refused, did_you_mean, must_be
from .parts import measured_speed

Model = TypeVar("Model", bound=BaseModel)
MECHANISM = "mechanism."
# what must be, where pydantic says it in another way
_ALLOWED = {
    "model_type": "a table",
    "model_attributes_type": "a table",
    "list_type": "a list",
    "too_short": "a list of at least one",
    "string_type": "a string",
}


class SceneError(Refused):
    """A scene that cannot be run: one line that names the key, the value and what is allowed."""


def _models(annotation: Any) -> list[type[BaseModel]]:
    """Models within a type: the members of a union, the type itself."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models(part)]


def _kind(model: type[BaseModel]) -> str:
    field = model.model_fields.get("kind")
    return str(get_args(field.annotation)[0]) if field is not None else ""


def _walk(scene: type[BaseModel], location: tuple[Any, ...]) -> tuple[list[str], list[type[BaseModel]]]:
    """Keys of a location, without the kinds pydantic puts between them, and the models it leads to."""
    keys: list[str] = []
    models = [scene]
    for part in location:
        chosen = [model for model in models if len(models) > 1 and _kind(model) == part]
        if chosen:
            models = chosen
            continue
        keys.append(str(part))
        fields = [model.model_fields[part] for model in models if part in model.model_fields]
        models = [model for field in fields for model in _models(field.annotation)]
    return keys, models


def _no_such_key(scene: type[BaseModel], location: tuple[Any, ...], value: Any) -> str:
    """Line for a key that no model has."""
    parents, models = _walk(scene, location[:-1])
    known = list(dict.fromkeys(name for model in models for name in model.model_fields))
    key = ".".join([*parents, str(location[-1])])
    others = [model for model in _walk(scene, location[:-2])[1] if location[-1] in model.model_fields]
    if len(models) == 1 and others and location[-2] == _kind(models[0]):
        table, kinds = ".".join(parents), " or ".join(repr(_kind(model)) for model in others)
        return (
            f"{key} = {value!r} must not be given with {table}.kind = {location[-2]!r}, it belongs to kind"
            f" {kinds} {did_you_mean(location[-1], known)}"
        )
    return f"{key} = {value!r}: there is no such key {did_you_mean(location[-1], known)}"


def one_line(scene: type[BaseModel], failure: ValidationError) -> str:
    """The first thing that is wrong, and how many more there are.

    Args:
        scene: the model that was validated. failure: what pydantic found.
    """
    # an unknown key before others: what is missing may only be misspelt
    errors = sorted(failure.errors(), key=lambda error: error["type"] != "extra_forbidden")
    line = _line(scene, errors[0])
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    return " ".join(line.split()) + more


def _line(scene: type[BaseModel], error: Any) -> str:
    """Line for one error of pydantic."""
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    keys, models = _walk(scene, error["loc"])
    key = ".".join(keys) or "scene"
    if kind == "extra_forbidden":
        return _no_such_key(scene, error["loc"], value)
    if kind == "missing":
        return f"{key} must be given, is missing"
    if kind == "union_tag_not_found":
        kinds = ", ".join(repr(_kind(model)) for model in models)
        return f"{key}.kind must be one of {kinds}, is missing"
    if kind == "union_tag_invalid":
        return must_be(f"{key}.kind", f"one of {context['expected_tags']}", repr(context["tag"]))
    if kind == "value_error":
        reason = context["error"]
        if isinstance(reason, SceneError):
            return str(reason)
        return f"{key}: {reason}" if isinstance(value, dict) else f"{key} {reason}"
    allowed = _ALLOWED.get(kind) or context.get("expected") or error["msg"].removeprefix("Input should be ")
    return must_be(key, allowed, repr(value))


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
