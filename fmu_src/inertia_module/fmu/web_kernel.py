"""The kernel in WebAssembly, for pages. It imports nothing: sin, exp and so on of the C library are in it."""

from __future__ import annotations

from typing import NamedTuple

from ..common.files import kept, sources
from ..compiling.c_compiler import dependencies, link, object_file
from ..compiling.targets import BROWSERS
from ..contract.models import Model
from .native_fmu import Build

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

    def content(self, build: Build) -> bytes:
        """The kernel as a module of WebAssembly, from the cache if it was built before.

        It exports its entry (see kernel.entry), its memory, and __heap_base: where free memory begins.
        """
        depends_on = dependencies(self.model) | sources("fmu/web_kernel.py")

        def linked() -> bytes:
            build.progress(f"compiling {self.identifier} for browsers")
            exported = [f"-Wl,--export={symbol}" for symbol in (self.model.symbol, "__heap_base")]
            kernel = {"kernel.o": object_file(self.model, BROWSERS)}
            return link(BROWSERS, "kernel.wasm", kernel, *exported, f"-Wl,--max-memory={MEMORY}")

        return kept(self.file_name, depends_on, linked).read_bytes()
