"""Shared libraries with the kernel's machine code in them.

The C compiler comes with the package ziglang and makes code for every platform on any of them.
"""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..common.files import cache_folder, content_hash, kept, sources
from .ir import tool_versions
from .kernels import ENTRIES, CompilationUnavailable
from .objects import made_from, object_file, this_processor
from .targets import Target

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
FLAGS = ("-std=c99", "-O2", "-g0", "-fvisibility=hidden", "-fno-sanitize=all", "-fno-ident")
# a function whose arrays are written beyond their ends aborts; Windows brings no functions for that along
STACK_PROTECTOR = "-fstack-protector-strong"
# functions of Windows' own C runtime, part of Windows 10 and later, that the shell needs
RUNTIME = (
    *("calloc", "free", "memchr", "memcmp", "memcpy", "memset", "strchr", "strcmp", "strcpy", "strlen"),
    *("strncmp", "strncpy", "strstr", "strtol"),
    *("__stdio_common_vsprintf", "fmax", "fmin"),
)


def compiler() -> list[str]:
    """Command of the C compiler.

    Raises:
        CompilationUnavailable: the package ziglang is not installed.
    """
    if importlib.util.find_spec("ziglang") is None:
        raise CompilationUnavailable("ziglang is not installed; it comes with the extra inertia-module[fast]")
    return [sys.executable, "-m", "ziglang"]


def run_tool(tool: str, arguments: Sequence[str], folder: Path) -> None:
    """Run the C compiler, or another tool that comes with it, in a folder.

    Raises:
        CompilationUnavailable: it is not installed or fails, with what it says.
    """
    environment = os.environ | {
        "ZIG_GLOBAL_CACHE_DIR": str(cache_folder() / "zig"),
        "ZIG_LOCAL_CACHE_DIR": str(folder / "zig"),
    }
    command = [*compiler(), tool, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise CompilationUnavailable(f"{tool} fails: {done.stderr.strip()[-2000:]}")


def mathematics() -> set[str]:
    """Functions of the C library that the kernel calls: those of math it names, and those of ** and %."""
    text = b"".join(sources("kernel/**/*.py").values()).decode()
    return {"pow", "fmod", *re.findall(r"\bmath\.(\w+)", text)}


def import_library(target: Target, folder: Path, library: str, names: Sequence[str]) -> str:
    """Make in a folder what links with functions of a library of Windows; the name of its file."""
    stem = library.removesuffix(".dll")
    (folder / f"{stem}.def").write_text("\n".join([f"LIBRARY {library}", "EXPORTS", *names, ""]))
    run_tool("dlltool", ["-m", target.import_machine, "-d", f"{stem}.def", "-l", f"{stem}.imports.a"], folder)
    return f"{stem}.imports.a"


def windows_arguments(target: Target, folder: Path) -> list[str]:
    """For Windows: no start-up code, its headers, and the functions that Windows itself brings along.

    Without them the compiler would first build the whole of its C library for Windows: some minutes.
    """
    found = importlib.util.find_spec("ziglang")
    assert found is not None  # compiler() has looked
    assert found.origin is not None
    headers = Path(found.origin).parent / "lib" / "libc" / "include" / "any-windows-any"
    runtime = import_library(target, folder, "ucrtbase.dll", [*RUNTIME, *sorted(mathematics())])
    return ["-nostdlib", "-mno-stack-arg-probe", "-isystem", str(headers), runtime]


def link(
    target: Target,
    file: str,
    content: Mapping[str, bytes],
    *flags: str,
    imports: Mapping[str, Sequence[str]] | None = None,
) -> bytes:
    """A shared library for a target.

    Args:
        target: for which platform. file: its name. content: C files, headers, objects, resources by name.
        flags: more of them for the compiler. imports: on Windows, functions it needs, by library of Windows.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, written in content.items():
            (folder / path).write_bytes(written)
        own = [STACK_PROTECTOR, *target.libraries]
        if target.import_machine:
            own = windows_arguments(target, folder)
            own += [import_library(target, folder, dll, names) for dll, names in (imports or {}).items()]
        linked = sorted(path for path in content if path.endswith((".c", ".o", ".res")))
        given = ["-target", target.compiler, *FLAGS, *WARNINGS, *flags, "-shared", "-s", "-o", file]
        run_tool("cc", [*given, *linked, *own], folder)
        return (folder / file).read_bytes()


def with_kernel(name: str, target: Target, file: str, content: dict[str, bytes], *flags: str) -> bytes:
    """A shared library that offers a kernel and has it in it, for link.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    entry = {Path(path).name: text for path, text in sources("compiling/*.c").items()}
    own = entry | {"kernel.o": object_file(name, target)}
    return link(target, file, own | content, f"-DKERNEL={ENTRIES[name].symbol}", *flags)


def kernel_library(name: str) -> Path:
    """The shared library of a kernel alone, for this processor, in the cache.

    Args:
        name: one of ENTRIES.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    target = this_processor()
    made = made_from() | tool_versions("ziglang") | {"target": repr(target).encode()}
    digest = content_hash(made | sources("compiling/*.c", "compiling/linking.py", "compiling/targets.py"))[
        :16
    ]
    file = f"{name}{target.suffix}"
    return kept(f"{name}-{digest}{target.suffix}", lambda: with_kernel(name, target, file, {}))
