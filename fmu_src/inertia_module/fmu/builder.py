"""Builds the Python FMUs: pythonfmu packs the slave, the description comes from the model.

The script and the bundled package carry a hash of their content in their names, so that two
different builds of the FMU live in one process; the GUID is a hash of everything in the archive.
"""

from __future__ import annotations

import hashlib
import io
import os
import sys
import tempfile
import zipfile
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from pythonfmu import FmuBuilder

from ..compiled import CompilationUnavailable, is_cached, load, write_atomically
from ..model import DRIVEN_SHAFT, INERTIA_MODULE, Model
from .description import model_description
from .documentation import index_page

PACKAGE_FOLDER = Path(__file__).parent.parent
BUNDLED = (
    "__init__.py",
    "compiled.py",
    "driven_shaft_messages.py",
    "driven_shaft_variables.py",
    "maps.py",
    "messages.py",
    "model.py",
    "module.py",
    "variables.py",
    "fmu/__init__.py",
    "fmu/slave.py",
    "fmu/slaves.py",
)
# the earliest time a zip archive can hold: archives of the same content are the same bytes
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)


class PythonFmu(NamedTuple):
    """An FMU to build: its model identifier (a class of slaves.py), its model, and its picture."""

    identifier: str
    model: Model
    picture: str

    @property
    def file_name(self) -> str:
        """Name of its file."""
        return f"{self.identifier}.fmu"


MODULE_FMU = PythonFmu("InertiaModulePy", INERTIA_MODULE, "model.png")
SHAFT_FMU = PythonFmu("DrivenShaft", DRIVEN_SHAFT, "driven_shaft.png")
FMUS = (MODULE_FMU, SHAFT_FMU)

# the loader of pythonfmu 0.7 runs this script at every instantiation and then drops a reference to its
# globals that it does not own: without one to spare, the second instance finds an empty module
SCRIPT = """import ctypes

ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

from {package}.fmu.slaves import {identifier}
"""

Progress = Callable[[str], None]


def bundled_files() -> dict[str, bytes]:
    """Path within the package and content of every file that goes into the FMU."""
    names = [*BUNDLED, *(f"kernel/{path.name}" for path in sorted((PACKAGE_FOLDER / "kernel").glob("*.py")))]
    return {name: (PACKAGE_FOLDER / name).read_bytes() for name in names}


def content_hash(files: dict[str, bytes]) -> str:
    """Hash over names and contents, 32 hexadecimal digits."""
    digest = hashlib.sha256()
    for name, content in sorted(files.items()):
        digest.update(name.encode() + b"\0" + len(content).to_bytes(8, "little") + content)
    return digest.hexdigest()[:32]


def generation_date() -> str:
    """Now, or SOURCE_DATE_EPOCH for reproducible builds, in UTC."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    moment = datetime.fromtimestamp(int(epoch), UTC) if epoch else datetime.now(UTC)
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def _pack(identifier: str, files: dict[str, bytes], label: str) -> dict[str, bytes]:
    """Let pythonfmu pack script and package; the archive's content by name."""
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / f"inertia_module_{label}"
        for name, content in files.items():
            path = package / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        script = Path(folder) / f"{identifier}_{label}.py"
        script.write_text(SCRIPT.format(package=package.name, identifier=identifier))
        search_path, modules = list(sys.path), set(sys.modules)
        try:
            packed = FmuBuilder.build_FMU(script, dest=Path(folder) / "out", project_files={package})
        finally:
            sys.path[:] = search_path
            for module in set(sys.modules) - modules:
                if label in module:
                    del sys.modules[module]
        with zipfile.ZipFile(packed) as archive:
            return {name: archive.read(name) for name in archive.namelist()}


def _archive(content: dict[str, bytes]) -> bytes:
    """A zip archive that depends on nothing but its content."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(content, key=lambda name: (name != "modelDescription.xml", name)):
            info = zipfile.ZipInfo(name, _ZIP_TIME)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, content[name])
    return stream.getvalue()


def _content(fmu: PythonFmu) -> tuple[dict[str, bytes], str]:
    """Everything in an FMU but its description, and the GUID, the hash of all."""
    files = bundled_files()
    content = _pack(fmu.identifier, files, content_hash(files)[:12])
    content["documentation/index.html"] = index_page(fmu.model).encode()
    content["model.png"] = (Path(__file__).parent / fmu.picture).read_bytes()
    blank = model_description(fmu.model, fmu.identifier, "", "", True)
    digits = content_hash(content | {"modelDescription.xml": blank})
    return content, "{" + "-".join(
        (digits[:8], digits[8:12], digits[12:16], digits[16:20], digits[20:])
    ) + "}"


def python_fmu(fmu: PythonFmu = MODULE_FMU) -> bytes:
    """The content of an FMU's file."""
    content, guid = _content(fmu)
    content["modelDescription.xml"] = model_description(
        fmu.model, fmu.identifier, guid, generation_date(), True
    )
    return _archive(content)


def is_current(path: Path, fmu: PythonFmu = MODULE_FMU) -> bool:
    """Whether a file is the FMU as it would be built now."""
    try:
        with zipfile.ZipFile(path) as archive:
            return _content(fmu)[1].encode() in archive.read("modelDescription.xml")
    except (OSError, KeyError, zipfile.BadZipFile):
        return False


def build(folder: Path, progress: Progress = lambda stage: None) -> list[Path]:
    """Build all FMUs into a folder, each of them whole or not at all.

    Args:
        folder: where to; made if it is not there. progress: told each stage as it begins.

    Returns:
        Paths of the FMUs, in the order of FMUS.

    Raises:
        OSError: the folder cannot be written.
    """
    paths = []
    for fmu in FMUS:
        progress(f"packing {fmu.file_name}")
        path = folder / fmu.file_name
        write_atomically(path, python_fmu(fmu))
        paths.append(path)
    if not all(is_cached(fmu.model.entry) for fmu in FMUS):
        progress("compiling the kernels for this machine, once: a minute or two")
    try:
        for fmu in FMUS:
            load(fmu.model.entry)
    except CompilationUnavailable as reason:
        progress(f"the FMUs will run the plain Python kernel here: {reason}")
    return paths
