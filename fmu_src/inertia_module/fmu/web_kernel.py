"""The kernel in WebAssembly, for pages. It imports nothing: sin, exp and so on of the C library are in it."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from ..common.files import cache_folder, content_hash, sources, write_atomically
from ..compiling import objects
from ..compiling.ir import tool_versions
from ..compiling.kernels import ENTRIES
from ..contract.models import Model
from .linking import run_tool

# for machine code and for the linker; any browser since 2021 knows what a "generic" processor may
TRIPLE, PROCESSOR, LINKED_FOR = "wasm32-unknown-wasi", "generic", "wasm32-wasi"
# bytes; the deepest calls of the kernel take some kilobytes
STACK = 1 << 18

Progress = Callable[[str], None]


class WebKernel(NamedTuple):
    """A kernel to build: its name, and its model."""

    identifier: str
    model: Model

    @property
    def file_name(self) -> str:
        """Name of its file."""
        return f"{self.identifier}.wasm"


def web_kernel(kernel: WebKernel, progress: Progress = lambda stage: None) -> bytes:
    """The kernel as a module of WebAssembly, from the cache if it was built before.

    It exports its entry (see kernel.entry), its memory, and __heap_base: where free memory begins.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    made_from = objects.made_from() | tool_versions("ziglang")
    made_from |= sources("fmu/web_kernel.py", "fmu/linking.py")
    path = cache_folder() / f"{kernel.identifier}-{content_hash(made_from)[:16]}.wasm"
    if not path.exists():
        progress(f"compiling {kernel.identifier} for browsers")
        write_atomically(path, _link(kernel.model))
    return path.read_bytes()


def _link(model: Model) -> bytes:
    machine, label = objects.target_machine(TRIPLE, PROCESSOR)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "kernel.o").write_bytes(objects.object_file(model.entry, machine, label))
        exported = [f"-Wl,--export={symbol}" for symbol in (ENTRIES[model.entry].symbol, "__heap_base")]
        given = ["-target", LINKED_FOR, "-mexec-model=reactor", "-s", *exported, f"-Wl,-z,stack-size={STACK}"]
        run_tool("cc", [*given, "-o", "kernel.wasm", "kernel.o"], folder)
        return (folder / "kernel.wasm").read_bytes()
