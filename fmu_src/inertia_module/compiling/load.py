"""The kernels as machine code that can be called: shipped with an FMU, or compiled here once and kept."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..common.files import PACKAGE_FOLDER
from .kernels import ENTRIES, MODULE, SIGNATURE, CompilationUnavailable

# in an FMU: the libraries of its native twin, one a platform
SHIPPED = PACKAGE_FOLDER / "binaries"
SHIPPED_NAMES = {"linux": "linux64.so", "win32": "win64.dll"}

_loaded: dict[str, tuple[Callable[..., int], Any]] = {}


def shipped_library() -> Path:
    """Where an FMU keeps the library of this platform."""
    return SHIPPED / SHIPPED_NAMES.get(sys.platform, "none")


def _load_shipped(name: str) -> tuple[Callable[..., int], Any]:
    path = shipped_library()
    if sys.maxsize < 2**32 or not path.is_file():
        there = ", ".join(sorted(found.stem for found in SHIPPED.iterdir()))
        raise CompilationUnavailable(f"this FMU has compiled kernels for {there} alone")
    library = ctypes.CDLL(str(path))
    return SIGNATURE(("inertia_module_kernel", library)), library


def _load_here(name: str) -> tuple[Callable[..., int], Any]:
    try:
        from . import objects
    except ImportError:
        raise CompilationUnavailable("this FMU was built without compiled kernels") from None
    llvm = objects.binding()
    machine, label = objects.host_machine()
    content = objects.object_file(name, machine, label)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(content))
    engine.finalize_object()
    # the engine owns the code
    return SIGNATURE(engine.get_function_address(ENTRIES[name].symbol)), engine


def load(name: str = MODULE) -> Callable[..., int]:
    """A compiled entry: entry(operation, p, d, u, x, y, w, h) with addresses of arrays of doubles.

    Outside an FMU the first call ever on a machine compiles (about a minute for the module), later
    ones load from the cache.

    Args:
        name: MODULE or DRIVEN_SHAFT.

    Raises:
        CompilationUnavailable: there is none here, and it cannot be made.
    """
    if name not in _loaded:
        try:
            _loaded[name] = _load_shipped(name) if SHIPPED.is_dir() else _load_here(name)
        except Exception as error:
            if isinstance(error, CompilationUnavailable):
                raise
            raise CompilationUnavailable(f"{type(error).__name__}: {error}") from error
    return _loaded[name][0]
