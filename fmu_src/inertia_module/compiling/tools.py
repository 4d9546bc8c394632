"""The C compiler that makes machine code, and versions of the tools that the code depends on."""

from __future__ import annotations

import functools
import importlib.metadata
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from ..common.files import cache_folder
from . import CompilationUnavailable

# command of ziglang, before the name of a tool: cc, dlltool
ZIG = (sys.executable, "-m", "ziglang")
# environment variable with the command of a C compiler for this platform, instead of ziglang
CHOSEN = "INERTIA_MODULE_CC"


def tool_versions(*packages: str) -> dict[str, bytes]:
    """Return the versions of packages by name.

    Raises:
        CompilationUnavailable: one of them is not installed.
    """
    versions = {}
    for package in packages:
        try:
            versions[package] = importlib.metadata.version(package).encode()
        except importlib.metadata.PackageNotFoundError:
            raise CompilationUnavailable(
                f"{package} is not installed. Run pip install 'inertia-module[fast]'."
            ) from None
    return versions


class Compiler(NamedTuple):
    """A C compiler.

    Attributes:
        command: its command.
        version: all that its machine code depends on, by name.
        is_zig: True for ziglang, which compiles for every platform.
    """

    command: tuple[str, ...]
    version: dict[str, bytes]
    is_zig: bool


def compiler() -> Compiler:
    """Return the C compiler: ziglang, or the one that INERTIA_MODULE_CC names.

    Raises:
        CompilationUnavailable: it is not installed.
    """
    chosen = os.environ.get(CHOSEN)
    if chosen:
        return _chosen_compiler(chosen)
    return Compiler((*ZIG, "cc"), tool_versions("ziglang"), is_zig=True)


@functools.cache
def _chosen_compiler(chosen: str) -> Compiler:
    """Return the compiler with a command."""
    command = tuple(shlex.split(chosen))
    if shutil.which(command[0]) is None:
        raise CompilationUnavailable(f"{CHOSEN} must be the command of a C compiler (got {chosen!r})")
    done = subprocess.run([*command, "--version"], capture_output=True, check=False)
    return Compiler(command, {"compiler": chosen.encode(), "version": done.stdout}, is_zig=False)


def run_tool(command: Sequence[str], folder: Path) -> None:
    """Run a compiler, or another tool, in a folder.

    Args:
        command: the command with its arguments.
        folder: the folder.

    Raises:
        CompilationUnavailable: it fails, with the end of its messages.
    """
    environment = os.environ | {
        "ZIG_GLOBAL_CACHE_DIR": str(cache_folder() / "zig"),
        "ZIG_LOCAL_CACHE_DIR": str(folder / "zig"),
    }
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise CompilationUnavailable(f"{shlex.join(command[:4])} failed: {done.stderr.strip()[-2000:]}")
