"""The native FMUs: a description, and a shared library for each platform that can be compiled for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from ..common.files import content_hash, kept, sources
from ..compiling import objects
from ..compiling.ir import tool_versions
from ..compiling.kernels import CompilationUnavailable
from ..compiling.linking import compiler
from ..compiling.targets import TARGETS, Target
from ..contract.models import Model
from . import description3
from .archive import DESCRIPTION, archive, generation_date, guid_of
from .description import NATIVE_CAPABILITIES, model_description
from .index_page import MECHANISM, index_page
from .linking import Progress, header_folder, join_for_mac, link
from .tables import generated
from .terminals import FLANGE, terminals


class NativeFmu(NamedTuple):
    """A native FMU to build: model identifier, model, name of its pictures, version of FMI, 2 or 3."""

    identifier: str
    model: Model
    picture: str
    fmi: int = 2

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
    made_from = objects.made_from() | tool_versions("ziglang")
    made_from |= sources("fmu/*.py", "fmu/shell/*", "compiling/*.c")
    made_from |= sources("compiling/linking.py", "compiling/targets.py")
    made_from |= {path.name: path.read_bytes() for path in header_folder().glob(f"fmi{fmu.fmi}*.h")}
    made_from |= papers(fmu.model, fmu.picture, fmu.fmi)
    made_from |= {name: text.encode() for name, text in generated(fmu.model, "", fmu.fmi).items()}
    made_from["description"] = description(fmu, "", "")
    return guid_of(made_from)


def description(fmu: NativeFmu, guid: str, date: str) -> bytes:
    """The XML of modelDescription.xml in the version of FMI."""
    if fmu.fmi == 2:
        return model_description(fmu.model, fmu.identifier, guid, date, NATIVE_CAPABILITIES)
    return description3.model_description(fmu.model, fmu.identifier, guid, date)


def papers(model: Model, picture: str, fmi: int, **licences: str) -> dict[str, bytes]:
    """Documentation, licences, icon and, with FMI 3.0, terminals, by path in an FMU.

    Args:
        model: what they are of. picture: name of its pictures. fmi: version, 2 or 3.
        licences: texts of those of others, by name.
    """
    texts = {"license": sources("LICENSE")["LICENSE"].decode()} | licences
    files = {
        "documentation/index.html": index_page(model, texts).encode(),
        f"documentation/{MECHANISM}": _picture(f"{picture}_named.png"),
        **{f"documentation/licenses/{name}.txt": text.encode() for name, text in texts.items()},
    }
    if fmi == 2:
        return files | {"model.png": _picture(f"{picture}.png")}
    files["terminalsAndIcons/terminalsAndIcons.xml"] = terminals(model)
    for name, drawn in (("icon", picture), (FLANGE, FLANGE)):
        files |= {
            f"terminalsAndIcons/{name}.{ending}": _picture(f"{drawn}.{ending}") for ending in ("png", "svg")
        }
    return files


def _picture(name: str) -> bytes:
    """A picture as docs/make_icons.py has drawn it."""
    return (Path(__file__).parent / "pictures" / name).read_bytes()


def library_path(fmu: NativeFmu, target: Target) -> str:
    """Where the FMU keeps its shared library for a target."""
    folder = target.folder if fmu.fmi == 2 else target.platform
    return f"binaries/{folder}/{fmu.identifier}{target.suffix}"


def library(fmu: NativeFmu, target: Target, progress: Progress = lambda stage: None) -> bytes:
    """The shared library for one target, from the cache if it was built before.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    made_for = guid(fmu)
    label = content_hash({made_for: target.label.encode()})[:16]

    def linked() -> bytes:
        progress(f"compiling {fmu.identifier} for {target.label}")
        return link(fmu.model, fmu.identifier, made_for, target, fmu.fmi)

    return kept(f"{fmu.identifier}-{target.label}-{label}{target.suffix}", linked).read_bytes()


def libraries(
    fmu: NativeFmu, progress: Progress = lambda stage: None, targets: Sequence[Target] = TARGETS
) -> Libraries:
    """The shared libraries for those of some targets that can be compiled for."""
    found: dict[str, list[tuple[str, bytes]]] = {}
    skipped = {}
    for target in targets:
        try:
            content = library(fmu, target, progress)
        except CompilationUnavailable as reason:
            skipped[f"{fmu.identifier} for {target.label}"] = str(reason)
            continue
        found.setdefault(library_path(fmu, target), []).append((target.triple, content))
    files = {path: same[0][1] if len(same) == 1 else join_for_mac(same) for path, same in found.items()}
    return Libraries(files, skipped)


def native_fmu(
    fmu: NativeFmu, progress: Progress = lambda stage: None, targets: Sequence[Target] = TARGETS
) -> tuple[bytes, dict[str, str]]:
    """The content of an FMU's file for some targets, and those skipped, with the reason.

    Raises:
        CompilationUnavailable: there is no target at all it could be compiled for.
    """
    files, skipped = libraries(fmu, progress, targets)
    if not files:
        raise CompilationUnavailable(next(iter(skipped.values())))
    described = description(fmu, guid(fmu), generation_date())
    return archive(files | papers(fmu.model, fmu.picture, fmu.fmi) | {DESCRIPTION: described}), skipped
