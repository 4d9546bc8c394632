"""The native FMUs: a description, and a shared library for each platform that can be compiled for."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from ..common.files import cache_folder, content_hash, sources, write_atomically
from ..compiling import objects
from ..compiling.ir import tool_versions
from ..compiling.kernels import CompilationUnavailable
from ..contract.models import Model
from .archive import DESCRIPTION, archive, generation_date, guid_of
from .description import NATIVE_CAPABILITIES, model_description
from .documentation import index_page
from .linking import compiler, header_folder, join_for_mac, link
from .tables import generated
from .targets import TARGETS, Target

Progress = Callable[[str], None]


class NativeFmu(NamedTuple):
    """A native FMU to build: its model identifier, its model, and its picture."""

    identifier: str
    model: Model
    picture: str

    @property
    def file_name(self) -> str:
        """Name of its file."""
        return f"{self.identifier}.fmu"


class Libraries(NamedTuple):
    """Shared libraries by their path in the FMU, and the targets skipped, with the reason."""

    files: dict[str, bytes]
    skipped: dict[str, str]


def guid(fmu: NativeFmu) -> str:
    """Hash of all that the FMU is made from: its sources and the versions of the tools.

    Raises:
        CompilationUnavailable: the tools are not installed.
    """
    compiler()
    made_from = objects.made_from() | sources("fmu/*.py", "fmu/shell/*") | tool_versions("ziglang")
    made_from |= {path.name: path.read_bytes() for path in header_folder().glob("fmi2*.h")}
    made_from |= papers(fmu.model, fmu.picture)
    made_from |= {name: text.encode() for name, text in generated(fmu.model, "").items()}
    made_from["description"] = model_description(fmu.model, fmu.identifier, "", "", NATIVE_CAPABILITIES)
    return guid_of(made_from)


def papers(model: Model, picture: str) -> dict[str, bytes]:
    """Documentation and picture, by path in an FMU."""
    return {
        "documentation/index.html": index_page(model).encode(),
        "model.png": (Path(__file__).parent / picture).read_bytes(),
    }


def library_path(fmu: NativeFmu, target: Target) -> str:
    """Where the FMU keeps its shared library for a target."""
    return f"binaries/{target.folder}/{fmu.identifier}{target.suffix}"


def library(fmu: NativeFmu, target: Target, progress: Progress = lambda stage: None) -> bytes:
    """The shared library for one target, from the cache if it was built before.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    made_for = guid(fmu)
    label = content_hash({made_for: target.label.encode()})[:16]
    path = cache_folder() / f"{fmu.identifier}-{target.label}-{label}{target.suffix}"
    if not path.exists():
        progress(f"compiling {fmu.identifier} for {target.label}")
        write_atomically(path, link(fmu.model, fmu.identifier, made_for, target))
    return path.read_bytes()


def libraries(fmu: NativeFmu, progress: Progress = lambda stage: None) -> Libraries:
    """The shared libraries for all targets that can be compiled for."""
    found: dict[str, list[tuple[str, bytes]]] = {}
    skipped = {}
    for target in TARGETS:
        try:
            content = library(fmu, target, progress)
        except CompilationUnavailable as reason:
            skipped[f"{fmu.identifier} for {target.label}"] = str(reason)
            continue
        found.setdefault(library_path(fmu, target), []).append((target.triple, content))
    files = {path: same[0][1] if len(same) == 1 else join_for_mac(same) for path, same in found.items()}
    return Libraries(files, skipped)


def native_fmu(fmu: NativeFmu, progress: Progress = lambda stage: None) -> tuple[bytes, dict[str, str]]:
    """The content of an FMU's file, and the targets skipped, with the reason.

    Raises:
        CompilationUnavailable: there is no target at all it could be compiled for.
    """
    files, skipped = libraries(fmu, progress)
    if not files:
        raise CompilationUnavailable(next(iter(skipped.values())))
    description = model_description(
        fmu.model, fmu.identifier, guid(fmu), generation_date(), NATIVE_CAPABILITIES
    )
    return archive(files | papers(fmu.model, fmu.picture) | {DESCRIPTION: description}), skipped
