"""The kernels as machine code that can be called: of an FMU, of a wheel, or compiled here once and kept."""

from __future__ import annotations

import ctypes
import functools
import zipfile
from pathlib import Path

from ..common.files import PACKAGE_FOLDER, kept, ready_made
from ..contract.models import Model
from . import CompilationUnavailable
from .targets import here

# operation, addresses of p, d, u, x, y and w, communication step; address of a memory.Run
CALLS = {"": (ctypes.c_int64, *[ctypes.c_void_p] * 6, ctypes.c_double), "_run": (ctypes.c_void_p,)}
# in a Python FMU: the libraries of its native twin, one a platform
SHIPPED = PACKAGE_FOLDER / "binaries"


def _library(model: Model) -> Path:
    """The shared library with the kernel of a model; out of the FMU of a wheel it goes to the cache."""
    if SHIPPED.is_dir():
        path = SHIPPED / f"{here().folder}{here().suffix}"
        if not path.is_file():
            there = ", ".join(sorted(found.stem for found in SHIPPED.iterdir()))
            raise CompilationUnavailable(f"this FMU has compiled kernels only for {there}")
        return path
    fmu = ready_made(f"{model.name}.fmu")
    if fmu is not None:
        with zipfile.ZipFile(fmu) as packed:
            content = packed.read(f"binaries/{here().folder}/{fmu.stem}{here().suffix}")
        return kept(fmu.stem + here().suffix, {fmu.name: content}, lambda: content)
    try:
        from .c_compiler import kernel_library
    except ImportError:
        raise CompilationUnavailable("this FMU was built without compiled kernels") from None
    return kernel_library(model)


@functools.cache
def load(model: Model) -> ctypes.CDLL:
    """A compiled kernel: the library with the functions of compiling/entry.c.

    An FMU and a wheel bring it along; in a clone the first call ever on a machine compiles in some seconds,
    later ones load from the cache.

    Raises:
        CompilationUnavailable: there is none here, and it cannot be made.
    """
    try:
        library = ctypes.CDLL(str(_library(model)))
        for ending, arguments in CALLS.items():
            function = getattr(library, f"inertia_module_kernel{ending}")
            function.argtypes, function.restype = arguments, ctypes.c_int64
        return library
    except CompilationUnavailable:
        raise
    except Exception as error:
        raise CompilationUnavailable(f"{type(error).__name__}: {error}") from error
