"""The Python FMU: pythonfmu packs the slave, the description comes from the model.

The script and the bundled package carry a hash of their content in their names, so that two
different builds of the FMU live in one process; the GUID is a hash of all the FMU is made from.
"""

from __future__ import annotations

import importlib.metadata
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from pythonfmu import FmuBuilder

from ..common.files import content_hash, sources
from ..compiling import CompilationUnavailable
from ..compiling.ir import tool_versions
from ..compiling.load import SHIPPED
from ..compiling.targets import LINUX64, WIN64
from ..contract.models import Model
from .archive import DESCRIPTION, archive, generation_date, guid_of
from .description import model_description
from .linking import Progress, link_front
from .native_fmu import NativeFmu, accompanying_files, library
from .native_fmu import guid as native_guid

BUNDLED = (
    "__init__.py",
    *("common/__init__.py", "common/errors.py", "common/files.py", "common/units.py"),
    *("compiling/__init__.py", "compiling/load.py", "compiling/targets.py"),
    "contract/*.py",
    *("fmu/__init__.py", "fmu/slave.py"),
    "kernel/**/*.py",
    "memory.py",
)

# pythonfmu's library beside our own, which has the name a host looks for
BEHIND = "pythonfmu-export"
# the platforms that pythonfmu has libraries for
PLATFORMS = (LINUX64, WIN64)


class PythonFmu(NamedTuple):
    """A Python FMU to build: its model identifier (a class of slave.py), its model, its pictures by name.

    Attributes:
        native: the native FMU whose libraries it brings along, for the compiled kernel in them.
    """

    identifier: str
    model: Model
    picture: str
    native: NativeFmu

    @property
    def file_name(self) -> str:
        """Name of its file."""
        return f"{self.identifier}.fmu"


# the loader of pythonfmu 0.7 runs this script at every instantiation and then drops a reference to its
# globals that it does not own: without one to spare, the second instance finds an empty module
SCRIPT = """import ctypes

ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

from {package}.fmu.slave import {identifier}
"""


# where FMI 2.0 looks for what an FMU takes of the machine
DEPENDENCIES = "documentation/externalDependencies.txt"
NEEDED = """The process of the host must have the library of Python 3.11 or later in it, 64 bit; no packages.
On Linux it takes glibc 2.32 or later, and libstdc++ of GCC 12 or later.
The native FMU of this model needs nothing.
"""


def bundled_files() -> dict[str, bytes]:
    """Path within the package and content of every source file that goes into the FMU."""
    return sources(*BUNDLED)


def shipped_libraries(fmu: PythonFmu, progress: Progress) -> tuple[dict[str, bytes], dict[str, str]]:
    """Libraries with the compiled kernel, by path within the package, and those skipped, with the reason."""
    files, skipped = {}, {}
    for target in PLATFORMS:
        path = f"{SHIPPED.name}/{target.folder}{target.suffix}"
        try:
            files[path] = library(fmu.native, native_guid(fmu.native), target, progress)
        except CompilationUnavailable as reason:
            skipped[f"compiled kernel in {fmu.identifier} for {target.label}"] = str(reason)
    return files, skipped


def fronts(fmu: PythonFmu) -> tuple[dict[str, bytes], dict[str, str]]:
    """Our libraries in front of pythonfmu's, by path in the FMU, and those skipped, with the reason."""
    files, skipped = {}, {}
    for target in PLATFORMS:
        path = f"binaries/{target.folder}/{fmu.identifier}{target.suffix}"
        try:
            files[path] = link_front(target, f"{BEHIND}{target.suffix}")
        except CompilationUnavailable as reason:
            skipped[f"front of {fmu.identifier} for {target.label} (see docs/fmu.md)"] = str(reason)
    return files, skipped


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
        with zipfile.ZipFile(packed) as packed_archive:
            return {name: packed_archive.read(name) for name in packed_archive.namelist()}


def _accompanying_files(fmu: PythonFmu) -> dict[str, bytes]:
    """Documentation, picture and the licences of this package and of pythonfmu, by path in the FMU."""
    of_pythonfmu = next(
        path for path in importlib.metadata.files("pythonfmu") or () if path.name == "LICENSE"
    )
    own = accompanying_files(fmu.model, fmu.picture, 2, pythonfmu=of_pythonfmu.read_text())
    return own | {DEPENDENCIES: NEEDED.encode()}


def _description(fmu: PythonFmu, guid: str, date: str) -> bytes:
    return model_description(fmu.model, fmu.identifier, guid, date, python=True)


def _guid(fmu: PythonFmu, files: Mapping[str, bytes]) -> str:
    made_from = (
        dict(files) | _accompanying_files(fmu) | sources("fmu/python_fmu.py") | tool_versions("pythonfmu")
    )
    made_from["description"] = _description(fmu, "", "")
    return guid_of(made_from)


def guid(fmu: PythonFmu) -> str:
    """Hash of all that the FMU is made from: the package it brings along, and what packs it."""
    return _guid(fmu, bundled_files() | shipped_libraries(fmu, lambda stage: None)[0] | fronts(fmu)[0])


def python_fmu(fmu: PythonFmu, progress: Progress = lambda stage: None) -> tuple[bytes, dict[str, str]]:
    """The content of an FMU's file, and what was left out of it, with the reason."""
    shipped, skipped = shipped_libraries(fmu, progress)
    package = bundled_files() | shipped
    in_front, without = fronts(fmu)
    made_for = _guid(fmu, package | in_front)
    description = _description(fmu, made_for, generation_date())
    content = _pack(fmu.identifier, package, content_hash(package)[:12]) | _accompanying_files(fmu)
    for path, front in in_front.items():
        content[path.replace(fmu.identifier, BEHIND)] = content[path]
        content[path] = front
    return archive(content | {DESCRIPTION: description}), skipped | without
