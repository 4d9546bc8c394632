"""Builds all FMUs and the kernel for pages, each of them whole or not at all; a wheel brings them along."""

from __future__ import annotations

import zipfile
from collections.abc import Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from ..common.files import BUILD_FOLDER, ready_made, writable_folder, write_atomically
from ..compiling import CompilationUnavailable
from ..compiling.ir import is_cached, llvm_text
from ..compiling.targets import TARGETS, Target, here
from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from .archive import DESCRIPTION
from .linking import Progress
from .native_fmu import NativeFmu, library_path, native_fmu
from .native_fmu import guid as native_guid
from .python_fmu import PythonFmu, python_fmu
from .python_fmu import guid as python_guid
from .web_kernel import WebKernel, web_kernel

MODULE_FMU = NativeFmu("InertiaModule", INERTIA_MODULE, "module")
SHAFT_FMU = NativeFmu("DrivenShaft", DRIVEN_SHAFT, "driven_shaft")
MODULE3_FMU = NativeFmu("InertiaModule3", INERTIA_MODULE, "module", 3)
SHAFT3_FMU = NativeFmu("DrivenShaft3", DRIVEN_SHAFT, "driven_shaft", 3)
PYTHON_FMU = PythonFmu("InertiaModulePy", INERTIA_MODULE, "module", MODULE_FMU)
FMUS: tuple[NativeFmu | PythonFmu, ...] = (MODULE_FMU, MODULE3_FMU, PYTHON_FMU, SHAFT_FMU, SHAFT3_FMU)
WEB_KERNEL = WebKernel("InertiaModule", INERTIA_MODULE)


class Built(NamedTuple):
    """Files of a build: paths of the FMUs, then of the kernel; what was skipped, with the reason."""

    paths: list[Path]
    skipped: dict[str, str]


def content_of(
    what: NativeFmu | PythonFmu | WebKernel,
    progress: Progress = lambda stage: None,
    targets: Sequence[Target] = TARGETS,
) -> tuple[bytes, dict[str, str]]:
    """The content of a file, from the wheel or built here, and what was skipped, with the reason.

    Args:
        what: the file. progress: told each stage as it begins. targets: platforms of a native FMU.

    Raises:
        CompilationUnavailable: it is compiled, and there is no target at all it could be compiled for.
    """
    ready = ready_made(what.file_name)
    if ready is not None:
        return ready.read_bytes(), {}
    if isinstance(what, WebKernel):
        return web_kernel(what, progress), {}
    if isinstance(what, PythonFmu):
        return python_fmu(what, progress)
    _translate([what.model], progress)
    return native_fmu(what, progress, targets)


def is_current(path: Path, fmu: NativeFmu | PythonFmu, targets: Sequence[Target] = TARGETS) -> bool:
    """Tell whether a file is the FMU as it would be built now: of the same GUID, for these platforms."""
    try:
        with zipfile.ZipFile(path) as packed:
            root = ElementTree.fromstring(packed.read(DESCRIPTION))
            found = root.get("guid") or root.get("instantiationToken")
            names = packed.namelist()
        if isinstance(fmu, PythonFmu):
            return found == python_guid(fmu)
        return found == native_guid(fmu) and all(library_path(fmu, target) in names for target in targets)
    except (OSError, KeyError, zipfile.BadZipFile, ElementTree.ParseError, CompilationUnavailable):
        return False


def _translate(models: Collection[Model], progress: Progress) -> None:
    """Translate kernels where that is still to do, side by side: translators are processes of their own."""
    missing = [model for model in models if not is_cached(model)]
    if missing:
        progress("translating the kernels for compilation, once: about a minute")
        with ThreadPoolExecutor(len(missing)) as pool:
            list(pool.map(llvm_text, missing))


def build(
    folder: Path,
    progress: Progress = lambda stage: None,
    files: Sequence[NativeFmu | PythonFmu | WebKernel] = (*FMUS, WEB_KERNEL),
    targets: Sequence[Target] = TARGETS,
) -> Built:
    """Build FMUs and the kernel for pages into a folder, each of them whole or not at all.

    Args:
        folder: where to; made if it is not there. progress: told each stage as it begins.
        files: what to build. targets: platforms of the native FMUs.

    Raises:
        OSError: the folder cannot be written.
    """
    built = Built([], {})
    writable_folder(folder)
    if ready_made(MODULE_FMU.file_name) is None:
        with suppress(CompilationUnavailable):  # each FMU will say what is missing or fails
            _translate({fmu.model for fmu in files if isinstance(fmu, NativeFmu)}, progress)
    for what in files:
        progress(f"building {what.file_name}")
        try:
            content, skipped = content_of(what, progress, targets)
        except CompilationUnavailable as reason:
            built.skipped[what.file_name] = str(reason)
            continue
        built.skipped.update(skipped)
        write_atomically(folder / what.file_name, content)
        built.paths.append(folder / what.file_name)
    return built


def current_fmu(
    fmu: NativeFmu = MODULE_FMU, folder: Path = BUILD_FOLDER, progress: Progress = lambda stage: None
) -> Path:
    """A native FMU: the wheel's, or in a clone that of a folder, built here where it is not current.

    It is built for this platform alone: that takes a sixth of the time of all.

    Args:
        fmu: a native one of FMUS. folder, progress: as for build.

    Raises:
        RuntimeError: it cannot be compiled here; why. OSError: the folder cannot be written.
    """
    path = ready_made(fmu.file_name) or folder / fmu.file_name
    if path.parent != folder:
        return path
    try:
        targets = [target for target in TARGETS if target.folder == here().folder]
    except CompilationUnavailable as reason:
        raise RuntimeError(f"{path.name} cannot be built: {reason}") from None
    if not is_current(path, fmu, targets):
        progress(f"{path.name} is built for this platform alone; 'inertia-module build' does for all")
        skipped = build(folder, progress, [fmu], targets).skipped
        if skipped:
            raise RuntimeError(f"{path.name} cannot be built: {next(iter(skipped.values()))}")
    return path
