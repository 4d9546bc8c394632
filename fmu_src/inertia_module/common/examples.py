"""The example scenes that come along with the package, by name."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from .errors import Refused, must_be
from .files import PACKAGE_FOLDER

# in a wheel they are in the package, in a clone beside it
FOLDERS = (PACKAGE_FOLDER / "examples", PACKAGE_FOLDER.parent.parent / "examples")


@cache
def examples() -> dict[str, Path]:
    """The scene files of the examples, those of the papers too, by name."""
    folder = next((folder for folder in FOLDERS if folder.is_dir()), None)
    files = [] if folder is None else [*folder.glob("*.toml"), *folder.glob("papers/*.toml")]
    return {path.stem: path for path in sorted(files, key=lambda path: path.stem)}


def example(name: str) -> Path:
    """The scene file of an example.

    Raises:
        Refused: there is none of this name; which there are.
    """
    found = examples().get(name)
    if found is None:
        raise Refused(must_be("the example", "one of " + ", ".join(examples()), name))
    return found
