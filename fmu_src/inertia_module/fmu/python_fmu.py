"""The Python FMU: pythonfmu's loader runs the Python slave; the model description is made from the model.

The names of the script and the bundled package contain a hash of their content, so that one process can use
two builds of the FMU. The GUID is a hash of all sources of the FMU.
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
from ..interface.models import Model
from .archive import DESCRIPTION, archive, generation_date, guid_of
from .description import model_description
from .linking import link_front
from .native_fmu import Build, NativeFmu, accompanying_files, library

BUNDLED = (
    "__init__.py",
    *("common/__init__.py", "common/deprecated.py", "common/errors.py", "common/files.py", "common/units.py"),
    *("compiling/__init__.py", "compiling/load.py", "compiling/targets.py"),
    "interface/*.py",
    *("fmu/__init__.py", "fmu/slave.py"),
    "kernel/**/*.py",
    "model.py",
)

# name of pythonfmu's library; the front library has the name that an importer loads
ORIGINAL_LIBRARY = "pythonfmu-export"
# platforms of pythonfmu's libraries
PLATFORMS = (LINUX64, WIN64)


class PythonFmu(NamedTuple):
    """A Python FMU to build.

    Attributes:
        identifier: model identifier, the name of a class of slave.py.
        model: the model.
        picture: name of the pictures.
        native: native FMU, whose libraries with the compiled kernel are included.
    """

    identifier: str
    model: Model
    picture: str
    native: NativeFmu

    @property
    def file_name(self) -> str:
        """Name of the file."""
        return f"{self.identifier}.fmu"

    def guid(self) -> str:
        """Return the GUID, a hash of the bundled package and of the code that packs it."""
        kernels, fronts = libraries(self, Build())
        return _guid(self, bundled_files() | kernels | fronts)

    def content(self, build: Build) -> bytes:
        """Return the content of the file.

        Args:
            build: the build; libraries without a compiler are skipped.
        """
        kernels, fronts = libraries(self, build)
        package = bundled_files() | kernels
        guid = _guid(self, package | fronts)
        described = _description(self, guid, generation_date())
        content = _packed(self, package, fronts) | _accompanying_files(self)
        # the front library compares the GUID of the importer with this file
        return archive(content | {DESCRIPTION: described, "resources/guid.txt": guid.encode()})


# The loader of pythonfmu 0.7 runs this script at every instantiation and then releases a reference to its
# globals that it does not own. The additional reference prevents an empty module in the second instance.
SCRIPT = """import ctypes

ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

from {package}.fmu.slave import {identifier}
"""


# path in FMI 2.0 of the requirements of an FMU
DEPENDENCIES = "documentation/externalDependencies.txt"
NEEDED = """The host process must load the 64-bit library of Python 3.11 or later.
No Python packages are necessary.
On Linux the FMU requires glibc 2.32 or later and libstdc++ of GCC 12 or later.
The native FMU of this model has no such requirements.
"""


def bundled_files() -> dict[str, bytes]:
    """Return the contents of the package's source files in the FMU, by path within the package."""
    return sources(*BUNDLED)


def libraries(fmu: PythonFmu, build: Build) -> tuple[dict[str, bytes], dict[str, bytes]]:
    """Return the libraries with the compiled kernel, and the front libraries.

    Args:
        fmu: the FMU.
        build: the build; libraries without a compiler are skipped.

    Returns:
        Libraries with the kernel by path in the package; front libraries by path in the FMU.
    """

    def compiled(target: Target) -> bytes:
        return library(fmu.native, fmu.native.guid(), target, build.progress)

    kernels, fronts = {}, {}
    for target in PLATFORMS:
        what = f"{fmu.identifier} for {target.label}"
        kernel = build.attempt(f"compiled kernel in {what}", compiled, target)
        front = build.attempt(
            f"wrapper library of {what} (see docs/reference/fmu.md)",
            link_front,
            target,
            f"{ORIGINAL_LIBRARY}{target.suffix}",
        )
        if kernel is not None:
            kernels[f"{SHIPPED.name}/{target.folder}{target.suffix}"] = kernel
        if front is not None:
            fronts[f"binaries/{target.folder}/{fmu.identifier}{target.suffix}"] = front
    return kernels, fronts


def _packed(fmu: PythonFmu, package: dict[str, bytes], fronts: dict[str, bytes]) -> dict[str, bytes]:
    """Return the files for pythonfmu's loader by path in the FMU: script, package and libraries."""
    folder, label = Path(pythonfmu.__file__).parent, content_hash(package)[:12]
    script, name = f"{fmu.identifier}_{label}", f"inertia_module_{label}"
    resources = {
        **{f"{name}/{path}": content for path, content in package.items()},
        **{f"pythonfmu/{path.name}": path.read_bytes() for path in folder.glob("*.py")},
        f"{script}.py": SCRIPT.format(package=name, identifier=fmu.identifier).encode(),
        "slavemodule.txt": script.encode(),
    }
    files = fronts | {f"resources/{path}": content for path, content in resources.items()}
    for path in (folder / "resources" / "binaries").glob("*/*pythonfmu-export.*"):
        place = f"binaries/{path.parent.name}/{fmu.identifier}{path.suffix}"
        files[place.replace(fmu.identifier, ORIGINAL_LIBRARY) if place in fronts else place] = (
            path.read_bytes()
        )
    return files


def _accompanying_files(fmu: PythonFmu) -> dict[str, bytes]:
    """Return documentation, picture and licences (this package, pythonfmu) by path in the FMU."""
    of_pythonfmu = next(
        path for path in importlib.metadata.files("pythonfmu") or () if path.name == "LICENSE"
    )
    own = accompanying_files(fmu.model, fmu.picture, 2, pythonfmu=of_pythonfmu.read_text())
    return own | {DEPENDENCIES: NEEDED.encode()}


def _description(fmu: PythonFmu, guid: str, date: str) -> bytes:
    return model_description(fmu.model, fmu.identifier, guid, date, python=True)


def _guid(fmu: PythonFmu, files: Mapping[str, bytes]) -> str:
    hashed_parts = (
        dict(files) | _accompanying_files(fmu) | sources("fmu/python_fmu.py") | tool_versions("pythonfmu")
    )
    hashed_parts["description"] = _description(fmu, "", "")
    return guid_of(hashed_parts)
