"""Builds all FMUs, each of them whole or not at all."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from ..common.files import writable_folder, write_atomically
from ..compiling.ir import is_cached, llvm_text
from ..compiling.kernels import CompilationUnavailable
from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE
from .archive import DESCRIPTION
from .native_fmu import NativeFmu, library_path, native_fmu
from .native_fmu import guid as native_guid
from .python_fmu import PythonFmu, python_fmu
from .python_fmu import guid as python_guid
from .targets import TARGETS

Progress = Callable[[str], None]

MODULE_FMU = NativeFmu("InertiaModule", INERTIA_MODULE, "model.png")
SHAFT_FMU = NativeFmu("DrivenShaft", DRIVEN_SHAFT, "driven_shaft.png")
PYTHON_FMU = PythonFmu("InertiaModulePy", INERTIA_MODULE, "model.png", MODULE_FMU)
FMUS: tuple[NativeFmu | PythonFmu, ...] = (MODULE_FMU, PYTHON_FMU, SHAFT_FMU)


class Built(NamedTuple):
    """What a build has left: paths of the FMUs, and what was skipped, with the reason."""

    paths: list[Path]
    skipped: dict[str, str]


def content_of(
    fmu: NativeFmu | PythonFmu, progress: Progress = lambda stage: None
) -> tuple[bytes, dict[str, str]]:
    """The content of an FMU's file, and what was skipped, with the reason.

    Raises:
        CompilationUnavailable: it is native, and there is no target at all it could be compiled for.
    """
    return native_fmu(fmu, progress) if isinstance(fmu, NativeFmu) else python_fmu(fmu, progress)


def is_current(path: Path, fmu: NativeFmu | PythonFmu) -> bool:
    """Whether a file is the FMU as it would be built now: of the same GUID, and for all platforms."""
    try:
        with zipfile.ZipFile(path) as packed:
            found = ElementTree.fromstring(packed.read(DESCRIPTION)).get("guid")
            names = packed.namelist()
        if isinstance(fmu, PythonFmu):
            return found == python_guid(fmu)
        return found == native_guid(fmu) and all(library_path(fmu, target) in names for target in TARGETS)
    except (OSError, KeyError, zipfile.BadZipFile, ElementTree.ParseError, CompilationUnavailable):
        return False


def _translate(progress: Progress) -> None:
    """Translate the kernels that have yet to be, side by side: each does so in a process of its own."""
    try:
        missing = {fmu.model.entry for fmu in FMUS if not is_cached(fmu.model.entry)}
        if missing:
            progress("translating the kernels for compilation, once: about a minute")
            with ThreadPoolExecutor(len(missing)) as pool:
                list(pool.map(llvm_text, sorted(missing)))
    except CompilationUnavailable:
        pass  # each FMU will say what is missing


def build(folder: Path, progress: Progress = lambda stage: None) -> Built:
    """Build all FMUs into a folder, each of them whole or not at all.

    Args:
        folder: where to; made if it is not there. progress: told each stage as it begins.

    Raises:
        OSError: the folder cannot be written.
    """
    built = Built([], {})
    writable_folder(folder)
    _translate(progress)
    for fmu in FMUS:
        progress(f"building {fmu.file_name}")
        try:
            content, skipped = content_of(fmu, progress)
        except CompilationUnavailable as reason:
            built.skipped[fmu.file_name] = str(reason)
            continue
        built.skipped.update(skipped)
        write_atomically(folder / fmu.file_name, content)
        built.paths.append(folder / fmu.file_name)
    return built


def current_module_fmu(folder: Path, progress: Progress = lambda stage: None) -> Path:
    """The FMU of the module in a folder, built anew if it is missing or of another state of the package.

    It is the native one or, where that cannot be compiled, the Python one.

    Args: as build.
    """
    for fmu in (MODULE_FMU, PYTHON_FMU):
        if is_current(folder / fmu.file_name, fmu):
            return folder / fmu.file_name
    return build(folder, progress).paths[0]
