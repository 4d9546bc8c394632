"""Machine code of a kernel for any processor and system, from its LLVM IR.

Run: python -m inertia_module.compiling.objects module, to have it made ahead for an FMU of this platform.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any

from ..common.files import content_hash, kept, sources
from . import ir
from .kernels import ENTRIES, CompilationUnavailable, Entry
from .targets import Target, here


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


def this_processor() -> Target:
    """The target of this process, for all that this processor can do.

    Raises:
        CompilationUnavailable: llvmlite is not installed, or there is no such target.
    """
    llvm = binding()
    features = llvm.get_host_cpu_features().flatten()
    return here()._replace(processor=llvm.get_host_cpu_name(), features=features)


def machine_for(target: Target) -> Any:
    """LLVM's target machine: code for any place in memory."""
    llvm = binding()
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    # Code finds all by its distance from itself, within 2 GB. llvmlite's own choice writes whole addresses
    # into the code: the loader of macOS lets no one do that.
    return llvm.Target.from_triple(target.triple).create_target_machine(
        cpu=target.processor, features=target.features, opt=3, reloc="pic", codemodel="small"
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


def object_file(name: str, target: Target) -> bytes:
    """Object file of an entry, kept in the cache.

    Args:
        name: one of ENTRIES. target: for which platform.

    Raises:
        CompilationUnavailable: numba or llvmlite is not installed, or fails.
    """
    platform = f"{target.triple}-{target.processor}{target.features}"
    digest = content_hash(made_from() | {"platform": platform.encode()})[:16]

    def compiled() -> bytes:
        return compile_ir(ir.llvm_text(name), ENTRIES[name], machine_for(target))

    return kept(f"{name}-{digest}.o", compiled).read_bytes()


if __name__ == "__main__":
    object_file(sys.argv[1], here())
