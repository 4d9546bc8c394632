"""The C compiler, and the versions of the tools that determine the machine code."""

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
from . import CompilationError

# command of ziglang; the name of a tool follows: cc, dlltool
ZIG = (sys.executable, "-m", "ziglang")
# environment variable with the command of a C compiler for this platform, instead of ziglang
CHOSEN = "INERTIA_MODULE_CC"


def tool_versions(*packages: str) -> dict[str, bytes]:
    """Return the versions of packages by name.

    Args:
        packages: names of the packages.

    Raises:
        CompilationError: a package is not installed.
    """
    versions = {}
    for package in packages:
        try:
            versions[package] = importlib.metadata.version(package).encode()
        except importlib.metadata.PackageNotFoundError:
            raise CompilationError(
                f"{package} is not installed. Run pip install 'inertia-module[fast]'."
            ) from None
    return versions


class Compiler(NamedTuple):
    """A C compiler.

    Attributes:
        command: the command.
        version: texts by name that identify the compiler and its version.
        is_zig: True for ziglang, which compiles for every platform.
    """

    command: tuple[str, ...]
    version: dict[str, bytes]
    is_zig: bool


def compiler() -> Compiler:
    """Return the C compiler: the command in the environment variable INERTIA_MODULE_CC, or ziglang.

    Raises:
        CompilationError: the compiler is not installed.
    """
    chosen = os.environ.get(CHOSEN)
    if chosen:
        return _chosen_compiler(chosen)
    return Compiler((*ZIG, "cc"), tool_versions("ziglang"), is_zig=True)


@functools.cache
def _chosen_compiler(chosen: str) -> Compiler:
    """Return the compiler for a command in INERTIA_MODULE_CC."""
    command = tuple(shlex.split(chosen))
    if shutil.which(command[0]) is None:
        raise CompilationError(f"{CHOSEN} must be the command of a C compiler (got {chosen!r})")
    process = subprocess.run([*command, "--version"], capture_output=True, check=False)
    return Compiler(command, {"compiler": chosen.encode(), "version": process.stdout}, is_zig=False)


def run_tool(command: Sequence[str], folder: Path) -> None:
    """Run a compiler, or another tool, in a folder.

    Args:
        command: the command with its arguments.
        folder: working directory of the tool.

    Raises:
        CompilationError: the tool fails; the message contains the end of its output.
    """
    environment = os.environ | {
        "ZIG_GLOBAL_CACHE_DIR": str(cache_folder() / "zig"),
        "ZIG_LOCAL_CACHE_DIR": str(folder / "zig"),
    }
    process = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    if process.returncode != 0:
        raise CompilationError(f"{shlex.join(command[:4])} failed: {process.stderr.strip()[-2000:]}")
