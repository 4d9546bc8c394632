"""The examples that come along with the package, by name: scenes, specifications of designs, the tutorial."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from .errors import Refused, unknown
from .files import PACKAGE_FOLDER

# in a wheel they are in the package, in a clone beside it
FOLDERS = (PACKAGE_FOLDER / "examples", PACKAGE_FOLDER.parent.parent / "examples")
KINDS = ("*.toml", "papers/*.toml", "*.ipynb", "*.py", "studies/*.py")
# parts of another example
PARTS = ("speed_control_margins.py", "speed_control_report.py")


@cache
def examples() -> dict[str, Path]:
    """The files of the examples, those of the papers too, by name; with its ending where one is taken."""
    folder = next((folder for folder in FOLDERS if folder.is_dir()), None)
    found: dict[str, Path] = {}
    for path in [] if folder is None else (path for kind in KINDS for path in sorted(folder.glob(kind))):
        if path.name not in PARTS:
            found[path.name if path.stem in found else path.stem] = path
    return dict(sorted(found.items()))


def example(name: str) -> Path:
    """The file of an example by its name, such as "planar" or "tutorial", or by that of its file."""
    files = {path.name: path for path in examples().values()}
    found = examples().get(name) or files.get(name)
    if found is None:
        raise Refused(unknown("example", name, examples()))
    return found


def belonging(source: Path) -> list[Path]:
    """Files that an example needs: a measurement of its name, the programs beside it that it imports."""
    found = [source.with_suffix(".csv")]
    if source.suffix == ".py":
        names = re.findall(r"^ *from (\w+) import", source.read_text(encoding="utf-8"), re.MULTILINE)
        found += [source.with_name(f"{name}.py") for name in names]
    return [path for path in found if path.is_file()]
