"""Read, check and write scene files (TOML).

A file with a table [shaft] describes a driven shaft alone, any other file an inertia module.
"""

from __future__ import annotations

import contextlib
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path
from typing import Any

from ..common.errors import InertiaModuleError, SceneError, cannot_read
from ..common.extras import library
from ..common.files import read_text
from ..common.units import factor_between, split_quantity
from .keys import SLASHES, Keys, Model, by_dotted_key, validated, with_value
from .schema import Scene
from .shaft import ShaftScene


def _tables(text: str, keys: Keys | None) -> dict[str, Any]:
    """Return the unchecked tables of a scene file with the values of keys.

    Raises:
        SceneError: The text is not valid TOML.
    """
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = " ".join(str(error).split())
        place = re.search(r"line (\d+)", message)
        line = text.split("\n")[int(place[1]) - 1] if place else ""
        comma = re.search(r"=\s*[-+]?\d+,\d", line)
        cause = ". Use a decimal point and no commas in numbers." if comma else ""
        if "\\" in line and re.search("Unescaped|hex", message):
            cause = f". In double quotes a backslash starts an escape sequence. {SLASHES}"
        raise SceneError(f"invalid TOML: {message}{cause}") from None
    for name, value in by_dotted_key(keys).items():
        tables = with_value(tables, name.split("."), value)
    return tables


def load_scene(path: Path | str, keys: Keys | None = None) -> Scene:
    """Read and check a scene file.

    Args:
        path: Path of the TOML file.
        keys: Values that replace values of the file, by dotted key or by the name of a parameter of the
            mechanism, such as {"imbalance_mass": "2 kg", "load.torque": 8}.

    Raises:
        SceneError: The file or a value is invalid; the message names file, key, value and allowed range.
    """
    return load_model(path, keys, lambda tables: Scene)


def load_model(
    path: Path | str, keys: Keys | None, model_for: Callable[[dict[str, Any]], type[Model]]
) -> Model:
    """Read and check a scene file whose model depends on its tables.

    Args:
        path: Path of the TOML file.
        keys: Values that replace values of the file, as in load_scene.
        model_for: Function that returns the model to check the tables with.

    Raises:
        SceneError: As in load_scene.
    """
    path = Path(path)
    try:
        text = read_text(path)
    except OSError as error:
        raise SceneError(cannot_read(path, error)) from None
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise SceneError(cannot_read(path, f"line {line} is not UTF-8")) from None
    try:
        tables = _tables(text, keys)
        return validated(model_for(tables), tables, path.parent)
    except InertiaModuleError as error:
        raise SceneError(f"{path.name}: {error}") from None


def as_scene(scene: Scene | Path | str) -> Scene:
    """Return a scene, read from its file if necessary.

    Args:
        scene: Scene, or path of its file.

    Raises:
        SceneError: As in load_scene.
    """
    return scene if isinstance(scene, Scene) else load_scene(scene)


# tables of a scene whose units the summary uses, and the quantities by their default unit
_OPERATION = ("drive", "load", "controller", "freewheels")
_QUANTITIES = ("rad/s", "N.m", "km/h")


def display_units(path: Path | str, keys: Keys | None = None) -> dict[str, str]:
    """Return the most frequent unit of rotational speeds, torques and speeds in the operation of a scene.

    Args:
        path: Path of a scene file that load_scene accepts.
        keys: Values that replace values of the file, as in load_scene.

    Returns:
        Units by SI unit (speeds of vehicles: by km/h), without quantities that have no unit in the scene.
    """
    tables = _tables(read_text(Path(path)), keys)
    units = Counter[tuple[str, str]]()
    for text, quantity in product(_strings([tables.get(name) for name in _OPERATION]), _QUANTITIES):
        with contextlib.suppress(ValueError):  # another text, or the unit of another quantity
            unit = split_quantity(text)[1]
            factor_between(unit, quantity)
            units[quantity, unit] += 1
    return {quantity: unit for (quantity, unit), _ in reversed(units.most_common())}


def _strings(tables: Any) -> Iterator[str]:
    """Yield all strings of nested tables and lists."""
    if isinstance(tables, str):
        yield tables
    elif isinstance(tables, dict | list):
        for value in tables.values() if isinstance(tables, dict) else tables:
            yield from _strings(value)


def load_any_scene(path: Path | str, keys: Keys | None = None) -> Scene | ShaftScene:
    """Read and check a scene file of a module or of a driven shaft alone.

    Args:
        path: Path of the TOML file.
        keys: Values that replace values of the file, as in load_scene.

    Returns:
        A ShaftScene if the file has a table [shaft], else a Scene.

    Raises:
        SceneError: As in load_scene.
    """

    def model_for(tables: dict[str, Any]) -> type[Scene | ShaftScene]:
        return ShaftScene if "shaft" in tables else Scene

    return load_model(path, keys, model_for)


def scene_text(scene: Scene) -> str:
    """Return a scene as TOML: the keys that differ from their defaults, in SI with their units.

    load_scene reads the text as the same scene. The function requires the extra ``studies``.

    Args:
        scene: The scene.
    """
    tables = scene.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    text: str = library("tomli_w", "studies").dumps(tables, multiline_strings=True)
    return text
