"""Scene files: TOML, checked, and written; of a module or, with a table [shaft], of a driven shaft alone."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from ..common.errors import Refused, cannot_read
from ..common.extras import library
from ..common.files import read_text
from .keys import SLASHES, Keys, Model, SceneError, changed, keys_of, validated
from .schema import Scene
from .shaft import ShaftScene


def _tables(text: str) -> dict[str, Any]:
    """Return the tables of a scene file, not checked; raise SceneError if the text is not TOML."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        said = " ".join(str(error).split())
        place = re.search(r"line (\d+)", said)
        line = text.split("\n")[int(place[1]) - 1] if place else ""
        comma = re.search(r"=\s*[-+]?\d+,\d", line)
        cause = ". Use a decimal point and no commas in numbers." if comma else ""
        if "\\" in line and re.search("Unescaped|hex", said):
            cause = f". In double quotes a backslash starts an escape sequence. {SLASHES}"
        raise SceneError(f"invalid TOML: {said}{cause}") from None


def load_scene(path: Path | str, keys: Keys = None) -> Scene:
    """Read and check a scene file.

    Args:
        path: of the TOML file. keys: values instead of the file's, by dotted key, such as
            {"mechanism.imbalance_mass": "2 kg"}, or texts such as "imbalance_mass=2 kg".

    Raises:
        SceneError: in one line, the file, the key, the value and what is allowed.
    """
    return load_tables(path, keys, lambda tables: Scene)


def load_tables(path: Path | str, keys: Keys, kind: Callable[[dict[str, Any]], type[Model]]) -> Model:
    """Read and check a scene file of a kind that its tables tell; all else as of load_scene."""
    path = Path(path)
    try:
        text = read_text(path)
    except OSError as error:
        raise SceneError(cannot_read(path, error)) from None
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise SceneError(cannot_read(path, f"line {line} is not UTF-8")) from None
    try:
        tables = _tables(text)
        for name, value in keys_of(keys).items():
            tables = changed(tables, name.split("."), value)
        return validated(kind(tables), tables, path.parent)
    except Refused as error:
        raise SceneError(f"{path.name}: {error}") from None


def speed_unit(path: Path | str, keys: Keys = None) -> str:
    """Return the unit of speeds of link 1 for people: rpm if the scene file gives a speed in it, else rad/s.

    Args:
        path: of a scene file that load_scene accepts.
        keys: as of load_scene.
    """
    values = [*_strings(_tables(Path(path).read_text(encoding="utf-8"))), *map(str, keys_of(keys).values())]
    return "rpm" if any(re.search(r"[\d\s](rpm|1/min)$", value.strip()) for value in values) else "rad/s"


def _strings(tables: Any) -> Iterator[str]:
    """Yield all strings of nested tables and lists."""
    if isinstance(tables, str):
        yield tables
    elif isinstance(tables, dict | list):
        for value in tables.values() if isinstance(tables, dict) else tables:
            yield from _strings(value)


def load_any_scene(path: Path | str, keys: Keys = None) -> Scene | ShaftScene:
    """Read and check a scene file, of a module or of a driven shaft alone; all else as of load_scene."""

    def kind(tables: dict[str, Any]) -> type[Scene | ShaftScene]:
        return ShaftScene if "shaft" in tables else Scene

    return load_tables(path, keys, kind)


def scene_text(scene: Scene) -> str:
    """Write a scene as TOML: keys that differ from their defaults, quantities in SI with their units.

    load_scene reads it back as the same scene. It takes the extra jobs.
    """
    tables = scene.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    written: str = library("tomli_w", "jobs").dumps(tables, multiline_strings=True)
    return written
