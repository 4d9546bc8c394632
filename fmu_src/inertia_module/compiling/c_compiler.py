"""Machine code of a kernel: object files and shared libraries for every platform, compiled from C."""

from __future__ import annotations

import functools
import importlib
import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..common.files import cached, sources
from ..interface.models import Model
from . import CompilationError
from .targets import WIN_ARM, Target, host_target
from .tools import ZIG, compiler, run_tool
from .translate import translate

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic")
FLAGS = ("-std=c99", "-O2", "-g0", "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno")
# flags of zig; the threshold inlines the functions that each evaluation of the equations of motion calls
ZIG_FLAGS = ("-Werror", "-fno-sanitize=all", "-fno-ident", "-mllvm", "-inline-threshold=500")
# aborts a function that writes beyond the end of an array; Windows has no runtime functions for this flag
STACK_PROTECTOR = "-fstack-protector-strong"
# required functions of the C runtime that is part of Windows 10 and later
RUNTIME = (
    *("calloc", "free", "memchr", "memcmp", "memcpy", "memmove", "memset", "strchr", "strcmp", "strcpy"),
    *("strlen", "strncmp", "strncpy", "strstr", "strtol", "__stdio_common_vsprintf", "fmax", "fmin"),
)


@functools.cache
def kernel_source(model: Model) -> bytes:
    """Return the kernel of a model in C.

    Args:
        model: model of the kernel.
    """
    return translate(model).encode()


def dependencies(model: Model) -> dict[str, bytes]:
    """Return contents by name that determine the machine code of a kernel, in addition to the platform.

    Args:
        model: model of the kernel.
    """
    return (
        model.source
        | sources("compiling/*.py", "compiling/*.[ch]", "interface/records.py")
        | compiler().version
    )


def run_compiler(target: Target, arguments: Sequence[str], folder: Path) -> None:
    """Run the C compiler for a target.

    Args:
        target: the platform.
        arguments: files, flags and the output.
        folder: folder in which the compiler runs, with the files.

    Raises:
        CompilationError: the compiler fails, or cannot compile for this platform.
    """
    tool = compiler()
    if tool.is_zig:
        platform = ("-target", target.compiler, f"-mcpu={target.processor}")
        run_tool([*tool.command, *platform, *FLAGS, *ZIG_FLAGS, *WARNINGS, *arguments], folder)
    elif target == host_target():
        run_tool([*tool.command, *FLAGS, *WARNINGS, *arguments], folder)
    else:
        raise CompilationError(f"{tool.command[0]} compiles only for {host_target().label}; use ziglang")


def object_file(model: Model, target: Target) -> bytes:
    """Return the object file of a kernel; the cache stores it.

    Args:
        model: model of the kernel; its entry is the only visible symbol.
        target: the platform.
    """

    def compiled() -> bytes:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "kernel.c").write_bytes(kernel_source(model))
            (folder / "kernel.h").write_bytes(sources("compiling/kernel.h")["compiling/kernel.h"])
            flags = windows_headers() if target.system == "windows" else ["-fPIC"]
            arguments = [f"-DKERNEL={model.symbol}", *flags, "-c", "kernel.c", "-o", "kernel.o"]
            run_compiler(target, arguments, folder)
            return (folder / "kernel.o").read_bytes()

    depends_on = dependencies(model) | {"platform": f"{target.compiler}-{target.processor}".encode()}
    return cached(f"{model.name}.o", depends_on, compiled).read_bytes()


def import_library(target: Target, folder: Path, library: str, names: Sequence[str]) -> str:
    """Write the import library of a Windows DLL and return the name of its file.

    Args:
        target: the platform.
        folder: folder of the import library.
        library: name of the DLL.
        names: names of the functions.
    """
    stem = library.removesuffix(".dll")
    (folder / f"{stem}.def").write_text("\n".join([f"LIBRARY {library}", "EXPORTS", *names, ""]))
    machine = "arm64" if target.folder == WIN_ARM.folder else "i386:x86-64"
    run_tool([*ZIG, "dlltool", "-m", machine, "-d", f"{stem}.def", "-l", f"{stem}.imports.a"], folder)
    return f"{stem}.imports.a"


def windows_headers() -> list[str]:
    """Return the compiler flags for the headers of Windows.

    Without these flags the compiler would first build its complete C library for Windows, for some minutes.
    """
    zig = Path(str(importlib.import_module("ziglang").__file__)).parent
    headers = zig / "lib" / "libc" / "include" / "any-windows-any"
    # Windows has no sincos, but LLVM would replace sin and cos by it
    flags = ("-nostdlib", "-mno-stack-arg-probe", "-fno-builtin-sin", "-fno-builtin-cos")
    return [*flags, "-isystem", str(headers)]


def windows_runtime(target: Target, folder: Path) -> str:
    """Write the import library of the C runtime of Windows and return the name of its file.

    Args:
        target: the platform.
        folder: folder of the import library.
    """
    # the mathematical functions are those in the source of the kernel, and pow and fmod for ** and %
    kernel = b"".join(sources("kernel/**/*.py").values()).decode()
    mathematics = {"pow", "fmod", *re.findall(r"\bmath\.(\w+)", kernel)}
    return import_library(target, folder, "ucrtbase.dll", [*RUNTIME, *sorted(mathematics)])


def link(
    target: Target,
    file: str,
    content: Mapping[str, bytes],
    *flags: str,
    imports: Mapping[str, Sequence[str]] | None = None,
) -> bytes:
    """Return a shared library for a target, or a module of WebAssembly.

    Args:
        target: the platform.
        file: name of the library.
        content: C files, headers, objects and resources by name.
        flags: additional flags of the compiler.
        imports: required functions by Windows DLL; ignored on other platforms.

    Raises:
        CompilationError: the compiler fails, or cannot compile for this platform.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, text in content.items():
            (folder / path).write_bytes(text)
        kind, libraries = ["-shared", "-fPIC", STACK_PROTECTOR], [*target.libraries]
        if target.system == "windows":
            kind, libraries = ["-shared"], [*windows_headers(), windows_runtime(target, folder)]
            libraries += [
                import_library(target, folder, dll, names) for dll, names in (imports or {}).items()
            ]
        elif target.system == "wasi":
            kind = ["-mexec-model=reactor"]
        linked = sorted(path for path in content if path.endswith((".c", ".o", ".rc")))
        run_compiler(target, [*flags, *kind, "-s", "-o", file, *linked, *libraries], folder)
        return (folder / file).read_bytes()


def with_kernel(model: Model, target: Target, file: str, content: dict[str, bytes], *flags: str) -> bytes:
    """Return a shared library that contains and exports the kernel of a model.

    Args:
        model: the model.
        target: the platform.
        file: name of the library.
        content: additional files by name (see link).
        flags: additional flags of the compiler.
    """
    entry = {Path(path).name: text for path, text in sources("compiling/*.[ch]").items()}
    files = entry | {"kernel.o": object_file(model, target)}
    return link(target, file, files | content, f"-DKERNEL={model.symbol}", *flags)


def kernel_library(model: Model) -> Path:
    """Return the path in the cache of a shared library with a kernel only, for this platform.

    Args:
        model: model of the kernel.
    """
    target = host_target()
    name = f"{model.name}-kernel-{target.label}{target.suffix}"
    return cached(
        name, dependencies(model), lambda: with_kernel(model, target, f"{model.name}{target.suffix}", {})
    )
