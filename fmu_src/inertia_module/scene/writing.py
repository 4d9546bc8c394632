"""Scenes as text: what read_scene reads back as the same scene."""

from __future__ import annotations

from typing import Any

from ..common.extras import library
from ..contract.variables import BY_NAME
from .schema import Scene


def scene_text(scene: Scene) -> str:
    """The TOML text of a scene, all quantities in SI units.

    Raises:
        NotInstalled: the extra jobs is not.
    """
    tables = {**scene.tables, "mechanism": _named(scene.tables.get("mechanism", {}))}
    written: str = library("tomli_w", "jobs", "tomli-w").dumps(tables)
    return written


def _named(mechanism: dict[str, Any]) -> dict[str, Any]:
    """Parameters with the names of the items of enumerations in place of their numbers."""
    named = dict(mechanism)
    for name, value in mechanism.items():
        items = BY_NAME[name].items or {}
        named[name] = next((item for item, number in items.items() if number == value), value)
    return named
