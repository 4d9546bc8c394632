"""Machine code of a kernel for any processor and system, from its LLVM IR."""

from __future__ import annotations

import importlib
from typing import Any

from ..common.files import cache_folder, content_hash, sources, write_atomically
from . import ir
from .kernels import ENTRIES, CompilationUnavailable, Entry


def binding() -> Any:
    """The binding of llvmlite.

    Raises:
        CompilationUnavailable: llvmlite is not installed.
    """
    try:
        found: Any = importlib.import_module("llvmlite.binding")
    except ImportError as error:
        raise CompilationUnavailable(f"{error}; it comes with the extra inertia-module[fast]") from None
    return found


def host_machine() -> tuple[Any, str]:
    """Target machine of this processor, and a label of it."""
    llvm = binding()
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    name, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple()
    return _machine(target, name, features), f"{target.triple}-{name}-{features}"


def target_machine(triple: str, processor: str) -> tuple[Any, str]:
    """Target machine of a platform, and a label: by LLVM triple and the least of its processors."""
    llvm = binding()
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple(triple)
    return _machine(target, processor, ""), f"{triple}-{processor}"


def _machine(target: Any, processor: str, features: str) -> Any:
    # Code finds all by its distance from itself, within 2 GB. llvmlite's own choice writes whole addresses
    # into the code: the loader of macOS lets no one do that.
    return target.create_target_machine(
        cpu=processor, features=features, opt=3, reloc="pic", codemodel="small"
    )


def compile_ir(text: str, which: Entry, machine: Any) -> bytes:
    """Object file with the entry as its only visible function."""
    llvm = binding()
    module = llvm.parse_assembly(text)
    module.triple = machine.triple
    module.data_layout = str(machine.target_data)
    module.get_function(which.symbol).visibility = "hidden"  # no other library may put its own in its place
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


def made_from() -> dict[str, bytes]:
    """All that machine code depends on besides the platform.

    Raises:
        CompilationUnavailable: a tool is not installed.
    """
    return ir.made_from() | sources("compiling/objects.py")


def object_file(name: str, machine: Any, label: str) -> bytes:
    """Object file of an entry, kept in the cache.

    Args:
        name: one of ENTRIES. machine: target machine. label: what the machine is, for the cache.

    Raises:
        CompilationUnavailable: numba or llvmlite is not installed, or fails.
    """
    digest = content_hash(made_from() | {"platform": label.encode()})[:16]
    path = cache_folder() / f"{name}-{digest}.o"
    if not path.exists():
        write_atomically(path, compile_ir(ir.llvm_text(name), ENTRIES[name], machine))
    return path.read_bytes()
