"""Machine code of a kernel for any processor and system, from its LLVM IR, and shared libraries of it.

The C compiler comes with the package ziglang and makes code for every platform on any of them.

Run: python -m inertia_module.compiling.linking InertiaModule, to have the machine code of a model made ahead
for an FMU of this platform.
"""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..common.files import cache_folder, kept, sources
from ..contract.models import MODELS, Model
from . import CompilationUnavailable, ir
from .targets import WIN_ARM, Target, here

# command of the C compiler
COMPILER = (sys.executable, "-m", "ziglang")
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
FLAGS = ("-std=c99", "-O2", "-g0", "-fvisibility=hidden", "-fno-sanitize=all", "-fno-ident")
# a function whose arrays are written beyond their ends aborts; Windows brings no functions for that along
STACK_PROTECTOR = "-fstack-protector-strong"
# functions of Windows' own C runtime, part of Windows 10 and later, that the shell needs
RUNTIME = (
    *("calloc", "free", "memchr", "memcmp", "memcpy", "memmove", "memset", "strchr", "strcmp", "strcpy"),
    *("strlen", "strncmp", "strncpy", "strstr", "strtol", "__stdio_common_vsprintf", "fmax", "fmin"),
)


def compile_ir(model: Model, target: Target) -> bytes:
    """Object file of a kernel for a target, with the entry as its only visible function."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    # Code finds all by its distance from itself, within 2 GB. llvmlite's own choice writes whole addresses
    # into the code: the loader of macOS lets no one do that.
    machine = llvm.Target.from_triple(target.triple).create_target_machine(
        cpu=target.processor, opt=3, reloc="pic", codemodel="small"
    )
    module = llvm.parse_assembly(ir.llvm_text(model))
    module.triple = machine.triple
    module.data_layout = str(machine.target_data)
    # no other library may put its own in its place
    module.get_function(model.symbol).visibility = "hidden"
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.slp_vectorization = True  # sines of two angles, sums of four quantities at once: the same bits
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


def made_from(model: Model) -> dict[str, bytes]:
    """All that machine code depends on besides the platform, and what links it."""
    return ir.made_from(model) | sources("compiling/linking.py")


def object_file(model: Model, target: Target) -> bytes:
    """Object file of a kernel for a target, kept in the cache."""
    depends_on = made_from(model) | {"platform": f"{target.triple}-{target.processor}".encode()}
    return kept(f"{model.name}.o", depends_on, lambda: compile_ir(model, target)).read_bytes()


def run_tool(tool: str, arguments: Sequence[str], folder: Path) -> None:
    """Run the C compiler, or another tool that comes with it, in a folder."""
    environment = os.environ | {
        "ZIG_GLOBAL_CACHE_DIR": str(cache_folder() / "zig"),
        "ZIG_LOCAL_CACHE_DIR": str(folder / "zig"),
    }
    command = [*COMPILER, tool, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise CompilationUnavailable(f"{tool} failed: {done.stderr.strip()[-2000:]}")


def import_library(target: Target, folder: Path, library: str, names: Sequence[str]) -> str:
    """Make in a folder what links with functions of a library of Windows; the name of its file."""
    stem = library.removesuffix(".dll")
    (folder / f"{stem}.def").write_text("\n".join([f"LIBRARY {library}", "EXPORTS", *names, ""]))
    machine = "arm64" if target.folder == WIN_ARM.folder else "i386:x86-64"
    run_tool("dlltool", ["-m", machine, "-d", f"{stem}.def", "-l", f"{stem}.imports.a"], folder)
    return f"{stem}.imports.a"


def windows_arguments(target: Target, folder: Path) -> list[str]:
    """For Windows: no start-up code, its headers, and the functions that Windows itself brings along.

    Without them the compiler would first build the whole of its C library for Windows: some minutes.
    """
    compiler = Path(str(importlib.import_module("ziglang").__file__)).parent
    headers = compiler / "lib" / "libc" / "include" / "any-windows-any"
    # of the mathematics what the kernel names, and what ** and % are
    kernel = b"".join(sources("kernel/**/*.py").values()).decode()
    mathematics = {"pow", "fmod", *re.findall(r"\bmath\.(\w+)", kernel)}
    runtime = import_library(target, folder, "ucrtbase.dll", [*RUNTIME, *sorted(mathematics)])
    return ["-nostdlib", "-mno-stack-arg-probe", "-isystem", str(headers), runtime]


def link(
    target: Target,
    file: str,
    content: Mapping[str, bytes],
    *flags: str,
    imports: Mapping[str, Sequence[str]] | None = None,
) -> bytes:
    """A shared library for a target, or a module of WebAssembly.

    Args:
        target: for which platform. file: its name. content: C files, headers, objects, resources by name.
        flags: more of them for the compiler. imports: on Windows, functions it needs, by library of Windows.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, written in content.items():
            (folder / path).write_bytes(written)
        kind, own = ["-shared", STACK_PROTECTOR], [*target.libraries]
        if target.system == "windows":
            kind, own = ["-shared"], windows_arguments(target, folder)
            own += [import_library(target, folder, dll, names) for dll, names in (imports or {}).items()]
        elif target.system == "wasi":
            kind = ["-mexec-model=reactor"]
        linked = sorted(path for path in content if path.endswith((".c", ".o", ".rc")))
        given = ["-target", target.compiler, *FLAGS, *WARNINGS, *flags, *kind, "-s", "-o", file]
        run_tool("cc", [*given, *linked, *own], folder)
        return (folder / file).read_bytes()


def with_kernel(model: Model, target: Target, file: str, content: dict[str, bytes], *flags: str) -> bytes:
    """A shared library that offers the kernel of a model and has it in it, for link."""
    entry = {Path(path).name: text for path, text in sources("compiling/*.[ch]").items()}
    own = entry | {"kernel.o": object_file(model, target)}
    return link(target, file, own | content, f"-DKERNEL={model.symbol}", *flags)


def kernel_library(model: Model) -> Path:
    """The shared library of a kernel alone, in the cache: machine code as an FMU of this platform has it."""
    target = here()
    made = (
        made_from(model) | ir.tool_versions("ziglang") | sources("compiling/*.[ch]", "compiling/targets.py")
    )
    name = f"{model.name}-kernel-{target.label}{target.suffix}"
    return kept(name, made, lambda: with_kernel(model, target, f"{model.name}{target.suffix}", {}))


if __name__ == "__main__":
    object_file(MODELS[sys.argv[1]], here())
