"""The Python FMU: the slave behind pythonfmu's loader, the description comes from the model.

The script and the bundled package carry a hash of their content in their names, so that two
different builds of the FMU live in one process; the GUID is a hash of all the FMU is made from.
"""

from __future__ import annotations

import importlib.metadata
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import pythonfmu

from ..common.files import content_hash, sources
from ..compiling.load import SHIPPED
from ..compiling.targets import LINUX64, WIN64, Target
from ..compiling.tools import tool_versions
from ..contract.models import Model
from .archive import DESCRIPTION, archive, generation_date, guid_of
from .description import model_description
from .linking import link_front
from .native_fmu import Build, NativeFmu, accompanying_files, library

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

    def guid(self) -> str:
        """Hash of all that the FMU is made from: the package it brings along, and what packs it."""
        kernels, fronts = libraries(self, Build())
        return _guid(self, bundled_files() | kernels | fronts)

    def content(self, build: Build) -> bytes:
        """The content of its file."""
        kernels, fronts = libraries(self, build)
        package = bundled_files() | kernels
        guid = _guid(self, package | fronts)
        described = _description(self, guid, generation_date())
        content = _packed(self, package, fronts) | _accompanying_files(self)
        # for the library in front, which compares it with the GUID of the host
        return archive(content | {DESCRIPTION: described, "resources/guid.txt": guid.encode()})


# the loader of pythonfmu 0.7 runs this script at every instantiation and then drops a reference to its
# globals that it does not own: without one to spare, the second instance finds an empty module
SCRIPT = """import ctypes

ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

from {package}.fmu.slave import {identifier}
"""


# where FMI 2.0 looks for what an FMU takes of the machine
DEPENDENCIES = "documentation/externalDependencies.txt"
NEEDED = """The host process must load the 64-bit library of Python 3.11 or later.
No Python packages are necessary.
On Linux the FMU requires glibc 2.32 or later and libstdc++ of GCC 12 or later.
The native FMU of this model has no such requirements.
"""


def bundled_files() -> dict[str, bytes]:
    """Path within the package and content of every source file that goes into the FMU."""
    return sources(*BUNDLED)


def libraries(fmu: PythonFmu, build: Build) -> tuple[dict[str, bytes], dict[str, bytes]]:
    """Libraries with the compiled kernel, by path in the package; in front of pythonfmu's, in the FMU."""

    def compiled(target: Target) -> bytes:
        return library(fmu.native, fmu.native.guid(), target, build.progress)

    kernels, fronts = {}, {}
    for target in PLATFORMS:
        what = f"{fmu.identifier} for {target.label}"
        kernel = build.attempt(f"compiled kernel in {what}", compiled, target)
        front = build.attempt(
            f"wrapper library of {what} (see docs/fmu.md)", link_front, target, f"{BEHIND}{target.suffix}"
        )
        if kernel is not None:
            kernels[f"{SHIPPED.name}/{target.folder}{target.suffix}"] = kernel
        if front is not None:
            fronts[f"binaries/{target.folder}/{fmu.identifier}{target.suffix}"] = front
    return kernels, fronts


def _packed(fmu: PythonFmu, package: dict[str, bytes], in_front: dict[str, bytes]) -> dict[str, bytes]:
    """Files where pythonfmu's loader looks for them: the script by its name, package and libraries."""
    folder, label = Path(pythonfmu.__file__).parent, content_hash(package)[:12]
    script, name = f"{fmu.identifier}_{label}", f"inertia_module_{label}"
    resources = {
        **{f"{name}/{path}": content for path, content in package.items()},
        **{f"pythonfmu/{path.name}": path.read_bytes() for path in folder.glob("*.py")},
        f"{script}.py": SCRIPT.format(package=name, identifier=fmu.identifier).encode(),
        "slavemodule.txt": script.encode(),
    }
    files = in_front | {f"resources/{path}": content for path, content in resources.items()}
    for path in (folder / "resources" / "binaries").glob("*/*pythonfmu-export.*"):
        place = f"binaries/{path.parent.name}/{fmu.identifier}{path.suffix}"
        files[place.replace(fmu.identifier, BEHIND) if place in in_front else place] = path.read_bytes()
    return files


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
