"""The kernel in WebAssembly, for pages. It imports nothing: sin, exp and so on of the C library are in it."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import NamedTuple

from ..common.files import content_hash, kept, sources
from ..compiling.ir import tool_versions
from ..compiling.linking import made_from, object_file, run_tool
from ..compiling.targets import Target
from ..contract.models import Model
from .linking import Progress

# any browser since 2021 knows what a "generic" processor may
BROWSERS = Target("", "wasm32-unknown-wasi", "generic", "wasm32-wasi")
# bytes, of which the deepest calls of the kernel take 800
STACK = 1 << 16
# bytes: two hundred instances at once
MEMORY = 1 << 24


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
    depends_on = tool_versions("ziglang") | made_from(kernel.model) | sources("fmu/web_kernel.py")

    def linked() -> bytes:
        progress(f"compiling {kernel.identifier} for browsers")
        return link(kernel.model)

    return kept(f"{kernel.identifier}-{content_hash(depends_on)[:16]}.wasm", linked).read_bytes()


def link(model: Model) -> bytes:
    """The kernel of a model as a module of WebAssembly.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "kernel.o").write_bytes(object_file(model, BROWSERS))
        exported = [f"-Wl,--export={symbol}" for symbol in (model.symbol, "__heap_base")]
        given = ["-target", BROWSERS.compiler, "-mexec-model=reactor", "-s", *exported]
        given += [f"-Wl,-z,stack-size={STACK}", f"-Wl,--max-memory={MEMORY}"]
        run_tool("cc", [*given, "-o", "kernel.wasm", "kernel.o"], folder)
        return (folder / "kernel.wasm").read_bytes()
