"""Shared libraries of the native FMUs: the shell in C, compiled and linked with the kernel's machine code.

The C compiler comes with the package ziglang and makes code for every platform on any of them.
"""

from __future__ import annotations

import importlib.resources
import importlib.util
import os
import re
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from .. import __version__
from ..common.files import cache_folder, content_hash, sources, write_atomically
from ..compiling.ir import tool_versions
from ..compiling.kernels import ENTRIES, CompilationUnavailable
from ..compiling.objects import object_file, target_machine
from ..contract.models import Model
from .tables import generated
from .targets import Target
from .version_resource import version_resource

# what is told each stage of a build as it begins
Progress = Callable[[str], None]
SHELL_FOLDER = Path(__file__).parent / "shell"
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
# functions of kernel32.dll that the front of the Python FMU needs
WINDOWS_FUNCTIONS = (
    *("GetFileAttributesA", "GetModuleFileNameW", "GetModuleHandleExW", "GetProcAddress"),
    *("GetShortPathNameW", "LoadLibraryExW", "LoadLibraryW", "MultiByteToWideChar"),
)
# a file of macOS for several processors: magic number, and by triple the number of the processor
FAT_MAGIC = 0xCAFEBABE
FAT_PROCESSORS = {"x86_64": (0x01000007, 3), "arm64": (0x0100000C, 0)}
FAT_ALIGNMENT = 14


def header_folder() -> Path:
    """Where the headers of FMI 2.0 and 3.0 are: fmpy brings them.

    Raises:
        CompilationUnavailable: this fmpy has none.
    """
    folder = Path(str(importlib.resources.files("fmpy"))) / "c-code"
    for version in (2, 3):
        if not (folder / f"fmi{version}Functions.h").is_file():
            raise CompilationUnavailable(f"the installed fmpy brings no headers of FMI {version}.0")
    return folder


def compiler() -> list[str]:
    """Command of the C compiler.

    Raises:
        CompilationUnavailable: the package ziglang is not installed.
    """
    if importlib.util.find_spec("ziglang") is None:
        raise CompilationUnavailable("ziglang is not installed; it comes with the extra inertia-module[fast]")
    return [sys.executable, "-m", "ziglang"]


def shell_sources(fmi: int) -> list[Path]:
    """The C files of the shell for a version of FMI, 2 or 3: what both share and its own functions."""
    other = f"fmi{5 - fmi}"
    return sorted(path for path in SHELL_FOLDER.glob("*.c") if not path.name.startswith(other))


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


def version_file(folder: Path, library: str, title: str) -> str:
    """Make in a folder what tells Windows the version of a library; the name of its file.

    Args:
        folder: where to. library: name of its file. title: what it is, for people.
    """
    texts = {
        **{"FileDescription": title, "FileVersion": __version__, "InternalName": Path(library).stem},
        **{"LegalCopyright": "MIT License", "OriginalFilename": library},
        **{"ProductName": "inertia-module", "ProductVersion": __version__},
    }
    (folder / "version.res").write_bytes(version_resource(__version__, texts))
    return "version.res"


def link(model: Model, identifier: str, guid: str, target: Target, fmi: int) -> bytes:
    """The shared library of a native FMU for one target.

    Args:
        model: what it computes. identifier: model identifier. guid: of modelDescription.xml.
        target: for which platform. fmi: version of FMI, 2 or 3.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    machine, label = target_machine(target.triple, target.processor)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "kernel.o").write_bytes(object_file(model.entry, machine, label))
        for file, text in generated(model, guid, fmi).items():
            (folder / file).write_text(text)
        for path in SHELL_FOLDER.iterdir():
            (folder / path.name).write_bytes(path.read_bytes())
        library = f"{identifier}{target.suffix}"
        sources = [path.name for path in shell_sources(fmi)]
        symbol = f"-DKERNEL={ENTRIES[model.entry].symbol}"
        headers = ("-isystem", str(header_folder()))
        given = ["-target", target.compiler, *FLAGS, *WARNINGS, *headers, symbol, "-shared", "-s"]
        files = ["-o", library, "tables.c", *sources, "kernel.o"]
        own = [STACK_PROTECTOR, *target.libraries]
        if target.import_machine:
            own = [*windows_arguments(target, folder), version_file(folder, library, model.title)]
        run_tool("cc", [*given, *files, *own], folder)
        return (folder / library).read_bytes()


def link_front(target: Target, behind: str) -> bytes:
    """The library in front of pythonfmu's for one target, from the cache if it was built before.

    Args:
        target: for which platform. behind: name of pythonfmu's library, beside it.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    files = sources("fmu/front/*", "fmu/shell/windows.c")
    made_from = files | sources("__init__.py", "fmu/linking.py", "fmu/version_resource.py")
    made_from |= tool_versions("ziglang", "fmpy")
    made_from[behind] = target.label.encode()
    kept = cache_folder() / f"front-{target.label}-{content_hash(made_from)[:16]}{target.suffix}"
    if not kept.exists():
        write_atomically(kept, _compile_front(target, behind, files))
    return kept.read_bytes()


def _compile_front(target: Target, behind: str, files: Mapping[str, bytes]) -> bytes:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file_name, content in files.items():
            (folder / Path(file_name).name).write_bytes(content)
        given = ["-target", target.compiler, *FLAGS, "-std=c11", *WARNINGS, "-isystem", str(header_folder())]
        given += [f'-DPYTHONFMU="{behind}"', "-shared", "-s", "-o", f"front{target.suffix}"]
        own = [STACK_PROTECTOR, "-ldl"]
        if target.import_machine:
            own = windows_arguments(target, folder)
            own.append(import_library(target, folder, "kernel32.dll", WINDOWS_FUNCTIONS))
            own.append(version_file(folder, "front.dll", "Library in front of pythonfmu's"))
        run_tool("cc", [*given, *(path.name for path in sorted(folder.glob("*.c"))), *own], folder)
        return (folder / f"front{target.suffix}").read_bytes()


def join_for_mac(libraries: Sequence[tuple[str, bytes]]) -> bytes:
    """One file of macOS with code for several processors, from (triple, library) of each."""
    offset = 1 << FAT_ALIGNMENT
    head = struct.pack(">II", FAT_MAGIC, len(libraries))
    body = b""
    for triple, library in libraries:
        kind, subkind = FAT_PROCESSORS[triple.split("-", 1)[0]]
        head += struct.pack(">IIIII", kind, subkind, offset + len(body), len(library), FAT_ALIGNMENT)
        body += library + bytes(-len(library) % (1 << FAT_ALIGNMENT))
    return head.ljust(offset, b"\0") + body
