"""Loads compiled kernels: from an FMU, from a wheel, or compiled on this machine and cached."""

from __future__ import annotations

import ctypes
import functools
import zipfile
from pathlib import Path

from ..common.files import PACKAGE_FOLDER, cached, ready_made
from ..interface.models import Model
from . import CompilationError
from .targets import host_target

# argument types of the functions: operation, addresses of p, d, u, x, y, w, and communication step; or
# the address of a model.Run
CALLS = {"": (ctypes.c_int64, *[ctypes.c_void_p] * 6, ctypes.c_double), "_run": (ctypes.c_void_p,)}
# folder within a Python FMU with the libraries of the native FMU, one per platform
SHIPPED = PACKAGE_FOLDER / "binaries"


def _library(model: Model) -> Path:
    """Return the path of the shared library with a kernel; a library in an FMU is copied to the cache."""
    if SHIPPED.is_dir():
        path = SHIPPED / f"{host_target().folder}{host_target().suffix}"
        if not path.is_file():
            platforms = ", ".join(sorted(file.stem for file in SHIPPED.iterdir()))
            raise CompilationError(f"this FMU has compiled kernels only for {platforms}")
        return path
    fmu = ready_made(f"{model.name}.fmu")
    if fmu is not None:
        with zipfile.ZipFile(fmu) as packed:
            content = packed.read(f"binaries/{host_target().folder}/{fmu.stem}{host_target().suffix}")
        return cached(fmu.stem + host_target().suffix, {fmu.name: content}, lambda: content)
    try:
        from .c_compiler import kernel_library
    except ImportError:
        raise CompilationError("this FMU was built without compiled kernels") from None
    return kernel_library(model)


@functools.cache
def load(model: Model) -> ctypes.CDLL:
    """Return the library of a compiled kernel with the functions of compiling/entry.c.

    An FMU and a wheel contain the library. In a clone the first call on a machine compiles it in some
    seconds; later calls load it from the cache.

    Args:
        model: model of the kernel.

    Raises:
        CompilationError: there is no library, and it cannot be compiled.
    """
    try:
        library = ctypes.CDLL(str(_library(model)))
        for ending, arguments in CALLS.items():
            function = getattr(library, f"inertia_module_kernel{ending}")
            function.argtypes, function.restype = arguments, ctypes.c_int64
        return library
    except CompilationError:
        raise
    except Exception as error:
        raise CompilationError(f"{type(error).__name__}: {error}") from error
