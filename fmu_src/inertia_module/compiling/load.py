"""The kernels as machine code that can be called: of an FMU, of a wheel, or compiled here once and kept."""

from __future__ import annotations

import ctypes
import platform
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..common.files import PACKAGE_FOLDER, cache_folder, content_hash, ready_made, write_atomically
from .kernels import DRIVEN_SHAFT, ENTRIES, MODULE, SIGNATURE, CompilationUnavailable

# in an FMU: the libraries of its native twin, one a platform
SHIPPED = PACKAGE_FOLDER / "binaries"
SHIPPED_NAMES = {"linux": "linux64.so", "win32": "win64.dll"}
# in a wheel: the native FMU of each kernel; and by system where an FMU keeps its library, for x86-64 and ARM
NATIVE_FMUS = {MODULE: "InertiaModule", DRIVEN_SHAFT: "DrivenShaft"}
SUFFIXES = {"linux": ".so", "win32": ".dll", "darwin": ".dylib"}
FOLDERS = {
    "linux": ("linux64", "aarch64-linux"),
    "win32": ("win64", "aarch64-windows"),
    "darwin": ("darwin64", "darwin64"),
}

_loaded: dict[str, tuple[Callable[..., int], Any]] = {}


def _load_shipped(name: str) -> tuple[Callable[..., int], Any]:
    path = SHIPPED / SHIPPED_NAMES.get(sys.platform, "none")
    if sys.maxsize < 2**32 or not path.is_file():
        there = ", ".join(sorted(found.stem for found in SHIPPED.iterdir()))
        raise CompilationUnavailable(f"this FMU has compiled kernels for {there} alone")
    return _of_library(path)


def _of_library(path: Path) -> tuple[Callable[..., int], Any]:
    library = ctypes.CDLL(str(path))
    return SIGNATURE(("inertia_module_kernel", library)), library


def _load_ready(name: str, fmu: Path) -> tuple[Callable[..., int], Any]:
    """From the native FMU of a wheel, unpacked once into the cache."""
    is_arm = platform.machine().lower() in ("arm64", "aarch64")
    if sys.platform not in FOLDERS or sys.maxsize < 2**32:
        raise CompilationUnavailable(f"{fmu.name} has no library for this system ({sys.platform})")
    suffix = SUFFIXES[sys.platform]
    with zipfile.ZipFile(fmu) as packed:
        content = packed.read(f"binaries/{FOLDERS[sys.platform][is_arm]}/{fmu.stem}{suffix}")
    path = cache_folder() / f"{fmu.stem}-{content_hash({fmu.name: content})[:16]}{suffix}"
    if not path.exists():
        write_atomically(path, content)
    return _of_library(path)


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

    An FMU and a wheel bring it along; in a clone the first call ever on a machine compiles (about a minute
    for the module), later ones load from the cache.

    Args:
        name: MODULE or DRIVEN_SHAFT.

    Raises:
        CompilationUnavailable: there is none here, and it cannot be made.
    """
    if name not in _loaded:
        try:
            fmu = ready_made(f"{NATIVE_FMUS[name]}.fmu")
            if SHIPPED.is_dir():
                _loaded[name] = _load_shipped(name)
            else:
                _loaded[name] = _load_ready(name, fmu) if fmu else _load_here(name)
        except Exception as error:
            if isinstance(error, CompilationUnavailable):
                raise
            raise CompilationUnavailable(f"{type(error).__name__}: {error}") from error
    return _loaded[name][0]
