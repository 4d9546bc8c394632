"""The kernels that can be called: what each is called, and the sizes of its arrays."""

from __future__ import annotations

import ctypes
import functools
import types
from typing import NamedTuple

from ..common.files import content_hash, sources
from ..kernel import fields
from ..kernel.driven_shaft import fields as driven_shaft_fields
from .records import Field, size

# operation, addresses of p, d, u, x, y and w, communication step
SIGNATURE = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, *[ctypes.c_void_p] * 6, ctypes.c_double)
# the lists of fields of p, d, u, x, y and w
RECORDS = ("PARAMETERS", "CONSTANTS", "INPUTS", "STATE", "OUTPUTS", "WORKSPACE")


class CompilationUnavailable(RuntimeError):
    """There is no compiled kernel here, and what it takes to make one is not installed or fails."""


class Entry(NamedTuple):
    """A kernel that can be called: the module of its call, and that of the fields of its records."""

    module: str
    fields: types.ModuleType

    @property
    def records(self) -> tuple[tuple[Field, ...], ...]:
        """Fields of the records p, d, u, x, y and w."""
        return tuple(getattr(self.fields, name) for name in RECORDS)

    @property
    def sizes(self) -> tuple[int, ...]:
        """Doubles in p, d, u, x, y and w."""
        return tuple(size(record) for record in self.records)

    @property
    def symbol(self) -> str:
        """Name of the function in machine code."""
        return f"inertia_module_{self.module.replace('.', '_')}"


MODULE = "module"
DRIVEN_SHAFT = "driven_shaft"
ENTRIES = {MODULE: Entry("entry", fields), DRIVEN_SHAFT: Entry("driven_shaft.entry", driven_shaft_fields)}


@functools.cache
def source_hash() -> str:
    """Hash of the kernel's source files: by it a saved state knows its build."""
    return content_hash(sources("kernel/**/*.py"))[:16]
