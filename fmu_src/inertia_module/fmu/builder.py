"""Builds all FMUs and the WebAssembly kernel of the viewer, each file atomically; a wheel includes them."""

from __future__ import annotations

import logging
import zipfile
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from ..common.deprecated import renamed_arguments
from ..common.errors import ParameterError, unknown
from ..common.files import cache_folder, ready_made, writable_folder, write_atomically
from ..compiling import CompilationError
from ..compiling.targets import TARGETS, Target, host_target
from ..interface.models import DRIVEN_SHAFT, INERTIA_MODULE
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


def content_of(file: NativeFmu | PythonFmu | WebKernel, build: Build | None = None) -> bytes:
    """Return the content of a file, from the wheel or built on this machine.

    Args:
        file: the file.
        build: the build that contains the file; None for a build of this file only.

    Raises:
        CompilationError: the file cannot be compiled for any target.
    """
    ready = ready_made(file.file_name)
    return file.content(build or Build()) if ready is None else ready.read_bytes()


def is_current(path: Path, fmu: NativeFmu | PythonFmu, targets: Sequence[Target] = TARGETS) -> bool:
    """Return True if a file is equal to the FMU that a build would give: same GUID, all platforms.

    Args:
        path: path of the file.
        fmu: the FMU.
        targets: platforms that the file must support.
    """
    try:
        with zipfile.ZipFile(path) as packed:
            root = ElementTree.fromstring(packed.read(DESCRIPTION))
            names = packed.namelist()
        needed = [fmu.library_path(target) for target in targets] if isinstance(fmu, NativeFmu) else []
        guid = root.get("guid") or root.get("instantiationToken")
        return guid == fmu.guid() and set(names) >= set(needed)
    except (OSError, KeyError, zipfile.BadZipFile, ElementTree.ParseError, CompilationError):
        return False


def build(
    folder: Path,
    progress: Progress = lambda stage: None,
    files: Sequence[NativeFmu | PythonFmu | WebKernel] = (*FMUS, WEB_KERNEL),
    targets: Sequence[Target] = TARGETS,
) -> Build:
    """Build FMUs and the WebAssembly kernel of the viewer into a folder, each file atomically.

    Args:
        folder: output folder (created if missing).
        progress: function that is called at the beginning of each stage, with its description.
        files: files to build.
        targets: platforms of the native FMUs.

    Returns:
        The build with the paths of its files, and with reasons for the skipped ones.

    Raises:
        OSError: the folder cannot be written.
    """
    result = Build(progress, targets)
    writable_folder(folder)
    for file in files:
        progress(f"building {file.file_name}")
        content = result.attempt(file.file_name, content_of, file, result)
        if content is not None:
            write_atomically(folder / file.file_name, content)
            result.paths.append(folder / file.file_name)
    return result


@renamed_arguments(fmu="name")
def current_fmu(
    name: str = MODULE_FMU.identifier, folder: Path | None = None, progress: Progress = LOG.info
) -> Path:
    """Return the path of a native FMU: from the wheel, or in a clone built from the present sources.

    The build is for this platform only, which takes a sixth of the time for all platforms.

    Args:
        name: "InertiaModule", "DrivenShaft", or one of them with a 3 for FMI 3.0, such as "DrivenShaft3".
        folder: folder of the FMU; by default a folder in the cache whose name is the GUID.
        progress: function that is called at the beginning of each stage, with its description; by default
            the description is logged.

    Raises:
        ParameterError: there is no native FMU of this name.
        CompilationError: the FMU cannot be compiled on this machine; with the reason.
        OSError: the folder cannot be written.
    """
    natives = {fmu.identifier: fmu for fmu in FMUS if isinstance(fmu, NativeFmu)}
    if name not in natives:
        raise ParameterError(unknown("FMU", name, natives))
    fmu = natives[name]
    ready = ready_made(fmu.file_name)
    if ready is not None:
        return ready
    try:
        targets = [target for target in TARGETS if target.folder == host_target().folder]
        path = (folder or cache_folder() / "fmus" / fmu.guid().strip("{}")) / fmu.file_name
    except CompilationError as reason:
        raise CompilationError(f"cannot build {fmu.file_name}: {reason}") from None
    if not is_current(path, fmu, targets):
        progress(
            f"{path.name} is built for this platform only. Run 'inertia-module build' for all platforms."
        )
        skipped = build(path.parent, progress, [fmu], targets).skipped
        if skipped:
            raise CompilationError(f"cannot build {path.name}: {next(iter(skipped.values()))}")
    return path
