"""Builds all FMUs and the WebAssembly kernel of the viewer, each file atomically; a wheel includes them."""

from __future__ import annotations

import logging
import zipfile
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from ..common.files import cache_folder, ready_made, writable_folder, write_atomically
from ..compiling import CompilationUnavailable
from ..compiling.targets import TARGETS, Target, here
from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE
from .archive import DESCRIPTION
from .linking import Progress
from .native_fmu import Build, NativeFmu
from .python_fmu import PythonFmu
from .web_kernel import WebKernel

LOG = logging.getLogger(__name__)

MODULE_FMU = NativeFmu("InertiaModule", INERTIA_MODULE, "module")
SHAFT_FMU = NativeFmu("DrivenShaft", DRIVEN_SHAFT, "driven_shaft")
MODULE3_FMU = NativeFmu("InertiaModule3", INERTIA_MODULE, "module", 3)
SHAFT3_FMU = NativeFmu("DrivenShaft3", DRIVEN_SHAFT, "driven_shaft", 3)
PYTHON_FMU = PythonFmu("InertiaModulePy", INERTIA_MODULE, "module", MODULE_FMU)
FMUS: tuple[NativeFmu | PythonFmu, ...] = (MODULE_FMU, MODULE3_FMU, PYTHON_FMU, SHAFT_FMU, SHAFT3_FMU)
WEB_KERNEL = WebKernel("InertiaModule", INERTIA_MODULE)


def content_of(what: NativeFmu | PythonFmu | WebKernel, build: Build | None = None) -> bytes:
    """The content of a file, from the wheel or built here.

    Args:
        what: the file. build: that it is part of.

    Raises:
        CompilationUnavailable: it is compiled, and there is no target at all it could be compiled for.
    """
    ready = ready_made(what.file_name)
    return what.content(build or Build()) if ready is None else ready.read_bytes()


def is_current(path: Path, fmu: NativeFmu | PythonFmu, targets: Sequence[Target] = TARGETS) -> bool:
    """Tell whether a file is the FMU as it would be built now: of the same GUID, for these platforms."""
    try:
        with zipfile.ZipFile(path) as packed:
            root = ElementTree.fromstring(packed.read(DESCRIPTION))
            names = packed.namelist()
        needed = [fmu.library_path(target) for target in targets] if isinstance(fmu, NativeFmu) else []
        found = root.get("guid") or root.get("instantiationToken")
        return found == fmu.guid() and set(names) >= set(needed)
    except (OSError, KeyError, zipfile.BadZipFile, ElementTree.ParseError, CompilationUnavailable):
        return False


def build(
    folder: Path,
    progress: Progress = lambda stage: None,
    files: Sequence[NativeFmu | PythonFmu | WebKernel] = (*FMUS, WEB_KERNEL),
    targets: Sequence[Target] = TARGETS,
) -> Build:
    """Build FMUs and the WebAssembly kernel of the viewer into a folder, each file atomically.

    Args:
        folder: where to; made if it is not there. progress: told each stage as it begins.
        files: what to build. targets: platforms of the native FMUs.

    Raises:
        OSError: the folder cannot be written.
    """
    own = Build(progress, targets)
    writable_folder(folder)
    for what in files:
        progress(f"building {what.file_name}")
        content = own.attempt(what.file_name, content_of, what, own)
        if content is not None:
            write_atomically(folder / what.file_name, content)
            own.paths.append(folder / what.file_name)
    return own


def current_fmu(
    fmu: NativeFmu = MODULE_FMU, folder: Path | None = None, progress: Progress = LOG.info
) -> Path:
    """A native FMU: the wheel's, or in a clone one built from its sources as they are now.

    It is built for this platform alone: that takes a sixth of the time of all.

    Args:
        fmu: a native one of FMUS.
        folder: where to build it; by default the cache, in a folder of its own for each content.
        progress: called with each stage as it begins; by default it is logged.

    Raises:
        RuntimeError: it cannot be compiled here; why.
        OSError: the folder cannot be written.
    """
    ready = ready_made(fmu.file_name)
    if ready is not None:
        return ready
    try:
        targets = [target for target in TARGETS if target.folder == here().folder]
        path = (folder or cache_folder() / "fmus" / fmu.guid().strip("{}")) / fmu.file_name
    except CompilationUnavailable as reason:
        raise RuntimeError(f"cannot build {fmu.file_name}: {reason}") from None
    if not is_current(path, fmu, targets):
        progress(
            f"{path.name} is built for this platform only. Run 'inertia-module build' for all platforms."
        )
        skipped = build(path.parent, progress, [fmu], targets).skipped
        if skipped:
            raise RuntimeError(f"cannot build {path.name}: {next(iter(skipped.values()))}")
    return path
