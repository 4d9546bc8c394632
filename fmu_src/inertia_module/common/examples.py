"""The examples that come along with the package, by name: scenes, specifications of designs, the tutorial."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from .errors import Refused, did_you_mean
from .files import PACKAGE_FOLDER

# in a wheel they are in the package, in a clone beside it
FOLDERS = (PACKAGE_FOLDER / "examples", PACKAGE_FOLDER.parent.parent / "examples")
KINDS = ("*.toml", "papers/*.toml", "*.ipynb")


@cache
def examples() -> dict[str, Path]:
    """The files of the examples, those of the papers too, by name."""
    folder = next((folder for folder in FOLDERS if folder.is_dir()), None)
    files = [] if folder is None else [path for kind in KINDS for path in folder.glob(kind)]
    return {path.stem: path for path in sorted(files, key=lambda path: path.stem)}


def example(name: str) -> Path:
    """The file of an example.

    Args:
        name: such as "planar", or "tutorial".

    Raises:
        Refused: there is none of this name; which there are.
    """
    found = examples().get(name)
    if found is None:
        raise Refused(f"the example must be one that there is, is {name} {did_you_mean(name, examples())}")
    return found
