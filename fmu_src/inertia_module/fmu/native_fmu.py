"""The native FMUs: a description, and a shared library for each platform that can be compiled for."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from ..common.files import content_hash, kept, sources
from ..compiling import CompilationUnavailable
from ..compiling.ir import tool_versions
from ..compiling.linking import made_from as machine_code_made_from
from ..compiling.targets import TARGETS, Target
from ..contract.models import Model
from .archive import DESCRIPTION, archive, generation_date, guid_of
from .c_source import c_source
from .component import FOLDER, MANIFEST, PLATFORM, component
from .description import FLANGE, build_description, model_description, resource_metadata, terminals
from .documentation import MECHANISM, index_page
from .linking import Progress, header_folder, join_for_mac, link, shell_files
from .tables import generated

# where SSP Traceability looks for it
METADATA = "extra/org.ssp-standard.ssp-traceability.srmd/resourceMetaData.srmd"


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


def guid(fmu: NativeFmu) -> str:
    """Hash of all that the FMU is made from: its sources and the versions of the tools.

    Raises:
        CompilationUnavailable: the tools are not installed.
    """
    made_from = tool_versions("ziglang") | machine_code_made_from(fmu.model)
    made_from |= sources("fmu/*.py", "fmu/shell/*", "fmu/wasm/*", "fmu/templates/*", "compiling/*.c")
    made_from |= sources("compiling/targets.py")
    made_from |= {path.name: path.read_bytes() for path in header_folder().glob(f"fmi{fmu.fmi}*.h")}
    made_from |= accompanying_files(fmu.model, fmu.picture, fmu.fmi)
    made_from |= {name: text.encode() for name, text in generated(fmu.model, "", fmu.fmi).items()}
    made_from["description"] = model_description(fmu.model, fmu.identifier, "", "", fmu.fmi)
    return guid_of(made_from)


def accompanying_files(model: Model, picture: str, fmi: int, **licences: str) -> dict[str, bytes]:
    """Documentation, licences, icon, references, metadata and, with FMI 3.0, terminals, by path in an FMU.

    Args:
        model: what they are of. picture: name of its pictures. fmi: version, 2 or 3.
        licences: texts of those of others, by name.
    """
    texts = {"license": sources("LICENSE")["LICENSE"].decode()} | licences
    files = {
        "documentation/index.html": index_page(model, texts).encode(),
        f"documentation/{MECHANISM}": _picture(f"{picture}_named.png"),
        **{f"documentation/licenses/{name}.txt": text.encode() for name, text in texts.items()},
        METADATA: resource_metadata(model),
    }
    carried = f"fmu/references/{model.name}/"
    files |= {path.removeprefix(carried): content for path, content in sources(f"{carried}**/*").items()}
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


def source_files(fmu: NativeFmu, made_for: str, progress: Progress) -> dict[str, bytes]:
    """The FMU in C99, by path in it, for processors that it has no library for.

    Args:
        fmu: of what. made_for: its GUID. progress: told that it is translated.

    Raises:
        CompilationUnavailable: the kernel cannot be translated.
    """
    progress(f"translating {fmu.identifier} to C")
    files = shell_files(fmu.model, made_for, fmu.fmi) | {"kernel.c": c_source(fmu.model).encode()}
    if fmu.fmi == 3:
        files["buildDescription.xml"] = build_description(fmu.identifier, c_files(files))
    return {f"sources/{name}": content for name, content in files.items()}


def c_files(files: Iterable[str]) -> list[str]:
    """Names of the files to compile among those in sources/."""
    return sorted(Path(path).name for path in files if path.endswith(".c"))


def component_files(fmu: NativeFmu, made_for: str, progress: Progress) -> dict[str, bytes]:
    """The WebAssembly component of an FMU of FMI 3.0 and what goes with it, by path in it; of FMI 2.0 none.

    Args:
        fmu: of what. made_for: its GUID. progress: told that it is compiled.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    if fmu.fmi == 2:
        return {}

    def compiled() -> bytes:
        progress(f"compiling {fmu.identifier} for {PLATFORM}")
        return component(fmu.model, made_for)

    label = content_hash({made_for: PLATFORM.encode()})[:16]
    content = kept(f"{fmu.identifier}-{PLATFORM}-{label}.wasm", compiled).read_bytes()
    manifest = (FOLDER / "manifest.xml").read_bytes()
    return {f"binaries/{PLATFORM}/{fmu.identifier}.wasm": content, MANIFEST: manifest}


def library_path(fmu: NativeFmu, target: Target) -> str:
    """Path in the FMU of its shared library for a target."""
    folder = target.folder if fmu.fmi == 2 else target.platform
    return f"binaries/{folder}/{fmu.identifier}{target.suffix}"


def library(fmu: NativeFmu, made_for: str, target: Target, progress: Progress) -> bytes:
    """The shared library for one target, from the cache if it was built before.

    Args:
        fmu: it belongs to. made_for: its GUID. target: platform. progress: told if it is compiled.

    Raises:
        CompilationUnavailable: what it takes is not installed, or fails.
    """
    label = content_hash({made_for: target.label.encode()})[:16]

    def linked() -> bytes:
        progress(f"compiling {fmu.identifier} for {target.label}")
        return link(fmu.model, fmu.identifier, made_for, target, fmu.fmi)

    return kept(f"{fmu.identifier}-{target.label}-{label}{target.suffix}", linked).read_bytes()


def native_fmu(
    fmu: NativeFmu, progress: Progress = lambda stage: None, targets: Sequence[Target] = TARGETS
) -> tuple[bytes, dict[str, str]]:
    """The content of an FMU's file for those of some targets that can be compiled for.

    Returns:
        The content; the targets skipped, with the reason.

    Raises:
        CompilationUnavailable: there is no target at all it could be compiled for.
    """
    made_for = guid(fmu)

    def compiled_for(target: Target) -> bytes | CompilationUnavailable:
        try:
            return library(fmu, made_for, target, progress)
        except CompilationUnavailable as reason:
            return reason

    with ThreadPoolExecutor(os.cpu_count()) as pool:  # the compiler is a process of its own
        libraries = list(pool.map(compiled_for, targets))
    found: dict[str, list[tuple[str, bytes]]] = {}
    skipped = {}
    for target, content in zip(targets, libraries, strict=True):
        if isinstance(content, CompilationUnavailable):
            skipped[f"{fmu.identifier} for {target.label}"] = str(content)
        else:
            found.setdefault(library_path(fmu, target), []).append((target.triple, content))
    if not found:
        raise CompilationUnavailable(next(iter(skipped.values())))
    files = {path: same[0][1] if len(same) == 1 else join_for_mac(same) for path, same in found.items()}
    if len(targets) == len(TARGETS):  # for all: also for those that are not among them
        for what, make in (("in C", source_files), (f"for {PLATFORM}", component_files)):
            try:
                files |= make(fmu, made_for, progress)
            except CompilationUnavailable as reason:
                skipped[f"{fmu.identifier} {what}"] = str(reason)
    of_standard = {"fmi-ls-wasm": (FOLDER / "LICENSE.txt").read_text()} if MANIFEST in files else {}
    files |= accompanying_files(fmu.model, fmu.picture, fmu.fmi, **of_standard)
    described = model_description(
        fmu.model, fmu.identifier, made_for, generation_date(), fmu.fmi, sources=c_files(files)
    )
    return archive(files | {DESCRIPTION: described}), skipped
