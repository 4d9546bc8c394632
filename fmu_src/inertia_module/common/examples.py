"""The examples in the package by name: scenes, design specifications, the tutorial."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path

from .errors import ParameterError, unknown
from .files import PACKAGE_FOLDER

# folder of the examples: in a wheel within the package, in a clone next to it
FOLDERS = (PACKAGE_FOLDER / "examples", PACKAGE_FOLDER.parent.parent / "examples")
KINDS = ("*.toml", "papers/*.toml", "*.ipynb", "*.py", "control/*.py", "studies/*.py")
# files that belong to another example
PARTS = (
    *("averaged_module.py", "frequency_response.py"),
    *("speed_control_margins.py", "speed_control_report.py"),
)


@cache
def examples() -> dict[str, Path]:
    """Return the files of all examples by name; a file whose stem is in use has its ending in its name."""
    folder = next((folder for folder in FOLDERS if folder.is_dir()), None)
    paths: dict[str, Path] = {}
    for path in [] if folder is None else (path for kind in KINDS for path in sorted(folder.glob(kind))):
        if path.name not in PARTS:
            paths[path.name if path.stem in paths else path.stem] = path
    return dict(sorted(paths.items()))


def example(name: str) -> Path:
    """Return the path of an example file.

    Args:
        name: name of the example, such as "planar" or "tutorial", or name of its file.

    Raises:
        ParameterError: there is no such example.
    """
    files = {file.name: file for file in examples().values()}
    path = examples().get(name) or files.get(name)
    if path is None:
        raise ParameterError(unknown("example", name, examples()))
    return path


def title_of(path: Path) -> str:
    """Return the title of an example: of a scene, of a notebook, or the first line of a program.

    Args:
        path: path of the example.
    """
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".toml":
        return str(tomllib.loads(text)["title"])
    pattern = r'"# (.+?)(?:\\n)?"' if path.suffix == ".ipynb" else r'"""(.+?)(?:"""|\n)'
    match = re.search(pattern, text)
    return match[1] if match else ""


def companion_files(source: Path) -> list[Path]:
    """Return the files that an example needs: the measurement of the same name, and imported programs.

    Args:
        source: path of the example; all its files are in the same folder.
    """
    paths = [source.with_suffix(".csv")]
    if source.suffix == ".py":
        names = re.findall(r"^ *from (\w+) import", source.read_text(encoding="utf-8"), re.MULTILINE)
        paths += [source.with_name(f"{name}.py") for name in names]
    return [path for path in paths if path.is_file()]
