"""The kernel in WebAssembly for the viewer, with the functions of the C library; it imports nothing."""

from __future__ import annotations

from typing import NamedTuple

from ..common.files import cached, sources
from ..compiling.c_compiler import dependencies, link, object_file
from ..compiling.targets import BROWSERS
from ..interface.models import Model
from .native_fmu import Build

# bytes; sufficient for two hundred instances at the same time
MEMORY = 1 << 24


class WebKernel(NamedTuple):
    """A kernel to build.

    Attributes:
        identifier: name of the kernel.
        model: the model.
    """

    identifier: str
    model: Model

    @property
    def file_name(self) -> str:
        """Name of the file."""
        return f"{self.identifier}.wasm"

    def content(self, build: Build) -> bytes:
        """Return the kernel as a WebAssembly module; the cache stores it.

        The module exports its entry (see kernel.entry), its memory, and __heap_base, the start of the free
        memory.

        Args:
            build: the build.
        """
        depends_on = dependencies(self.model) | sources("fmu/web_kernel.py")

        def linked() -> bytes:
            build.progress(f"compiling {self.identifier} for browsers")
            exported = [f"-Wl,--export={symbol}" for symbol in (self.model.symbol, "__heap_base")]
            kernel = {"kernel.o": object_file(self.model, BROWSERS)}
            return link(BROWSERS, "kernel.wasm", kernel, *exported, f"-Wl,--max-memory={MEMORY}")

        return cached(self.file_name, depends_on, linked).read_bytes()
