"""The native FMUs: a description, and a shared library for each platform that can be compiled for."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from .. import __version__
from ..common.files import kept, sources
from ..compiling import CompilationUnavailable
from ..compiling.c_compiler import dependencies, kernel_source, with_kernel
from ..compiling.targets import TARGETS, Target
from ..contract.models import Model
from .archive import DESCRIPTION, TEMPLATES, archive, filled, filled_xml, generation_date, guid_of
from .component import FOLDER, MANIFEST, PLATFORM, component
from .description import FLANGE, model_description, terminals
from .documentation import MECHANISM, index_page
from .linking import Progress, header_folder, join_for_mac, shell_files, version_file
from .tables import generated

Content = TypeVar("Content")
# name of the source file
SOURCE = "all.c"
# where SSP Traceability looks for it
METADATA = "extra/org.ssp-standard.ssp-traceability.srmd/resourceMetaData.srmd"


@dataclass
class Build:
    """A build under way.

    Attributes:
        progress: told each stage as it begins. targets: platforms of the native FMUs.
        paths: files that are written. skipped: what is left out, with the reason.
    """

    progress: Progress = lambda stage: None
    targets: Sequence[Target] = TARGETS
    paths: list[Path] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)

    def attempt(self, what: str, make: Callable[..., Content], *arguments: Any) -> Content | None:
        """Make a content; None where it cannot be compiled, and it is skipped."""
        try:
            return make(*arguments)
        except CompilationUnavailable as reason:
            self.skipped[what] = str(reason)
            return None


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

    def library_path(self, target: Target) -> str:
        """Path in the FMU of its shared library for a target."""
        folder = target.folder if self.fmi == 2 else target.platform
        return f"binaries/{folder}/{self.identifier}{target.suffix}"

    def guid(self) -> str:
        """Hash of all that the FMU is made from: its sources and the versions of the tools."""
        made_from = dependencies(self.model)
        made_from |= sources("fmu/*.py", "fmu/shell/*", "fmu/wasm/*", "fmu/templates/*")
        made_from |= {path.name: path.read_bytes() for path in header_folder().glob(f"fmi{self.fmi}*.h")}
        made_from |= accompanying_files(self.model, self.picture, self.fmi)
        made_from |= {name: text.encode() for name, text in generated(self.model, "", self.fmi).items()}
        made_from["description"] = model_description(self.model, self.identifier, "", "", self.fmi)
        return guid_of(made_from)

    def content(self, build: Build) -> bytes:
        """The content of its file for those of the platforms that can be compiled for."""
        made_for = self.guid()

        def compiled_for(target: Target) -> bytes | None:
            what = f"{self.identifier} for {target.label}"
            return build.attempt(what, library, self, made_for, target, build.progress)

        with ThreadPoolExecutor(os.cpu_count()) as pool:  # the compiler is a process of its own
            libraries = list(pool.map(compiled_for, build.targets))
        found: dict[str, list[tuple[str, bytes]]] = {}
        for target, content in zip(build.targets, libraries, strict=True):
            if content is not None:
                found.setdefault(self.library_path(target), []).append((target.label.split("-")[0], content))
        if not found:
            raise CompilationUnavailable(build.skipped[f"{self.identifier} for {build.targets[0].label}"])
        files = {path: same[0][1] if len(same) == 1 else join_for_mac(same) for path, same in found.items()}
        if len(build.targets) == len(TARGETS):  # for all: also for those that are not among them
            for what, make in (("in C", source_files), (f"for {PLATFORM}", component_files)):
                added = build.attempt(f"{self.identifier} {what}", make, self, made_for, build.progress)
                files |= added or {}
        of_standard = {"fmi-ls-wasm": (FOLDER / "LICENSE.txt").read_text()} if MANIFEST in files else {}
        files |= accompanying_files(self.model, self.picture, self.fmi, **of_standard)
        description = self.identifier, made_for, generation_date(), self.fmi
        sources = [SOURCE] if f"sources/{SOURCE}" in files else []
        described = model_description(self.model, *description, sources=sources)
        return archive(files | {DESCRIPTION: described})


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
        METADATA: filled_xml(TEMPLATES / "resourceMetaData.srmd", {"model": model, "version": __version__}),
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


def expanded(name: str, files: Mapping[str, bytes], seen: set[str]) -> Iterator[str]:
    """Lines of a C file with the files that it includes in it, each once.

    Args:
        name: name of the file.
        files: contents by name; other includes stay as they are.
        seen: names of the files that are in it already.
    """
    seen.add(name)
    for line in files[name].decode().splitlines():
        include = re.fullmatch(r'#include "(.*)"', line)
        if include is None or include[1] not in files:
            yield line
        elif include[1] not in seen:
            yield from expanded(include[1], files, seen)


def source_files(fmu: NativeFmu, made_for: str, progress: Progress) -> dict[str, bytes]:
    """The FMU in C99, by path in it, for processors that it has no library for.

    It is one file, so that a compiler makes all but the functions of FMI invisible to the host.

    Args:
        fmu: the FMU.
        made_for: its GUID.
        progress: called with the stage.
    """
    files = {"kernel.c": kernel_source(fmu.model)} | shell_files(fmu.model, made_for, fmu.fmi)
    included = [name for name in files if name.endswith(".c")]
    files[SOURCE] = filled(TEMPLATES / SOURCE, {"model": fmu.model, "files": included}).encode()
    made = {SOURCE: "\n".join([*expanded(SOURCE, files, set()), ""]).encode()}
    if fmu.fmi == 3:
        values = {"identifier": fmu.identifier, "source": SOURCE}
        made["buildDescription.xml"] = filled_xml(TEMPLATES / "buildDescription.xml", values)
    return {f"sources/{name}": content for name, content in made.items()}


def component_files(fmu: NativeFmu, made_for: str, progress: Progress) -> dict[str, bytes]:
    """The component of an FMU of FMI 3.0 and what goes with it, by path in it; of FMI 2.0 none."""
    if fmu.fmi == 2:
        return {}

    def compiled() -> bytes:
        progress(f"compiling {fmu.identifier} for {PLATFORM}")
        return component(fmu.model, made_for)

    content = kept(f"{fmu.identifier}-{PLATFORM}.wasm", {"guid": made_for.encode()}, compiled).read_bytes()
    manifest = (FOLDER / "manifest.xml").read_bytes()
    return {f"binaries/{PLATFORM}/{fmu.identifier}.wasm": content, MANIFEST: manifest}


def library(fmu: NativeFmu, made_for: str, target: Target, progress: Progress) -> bytes:
    """The shared library for one target, from the cache if it was built before; made_for: the GUID."""
    file = f"{fmu.identifier}{target.suffix}"

    def linked() -> bytes:
        progress(f"compiling {fmu.identifier} for {target.label}")
        content = shell_files(fmu.model, made_for, fmu.fmi) | version_file(target, file, fmu.model.title)
        return with_kernel(fmu.model, target, file, content, "-isystem", str(header_folder()))

    name = f"{fmu.identifier}-{target.label}{target.suffix}"
    return kept(name, {"guid": made_for.encode()}, linked).read_bytes()
