"""The native FMUs: a model description, and a shared library for each available platform."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from .. import __version__
from ..common.files import cached, sources
from ..compiling import CompilationError
from ..compiling.c_compiler import dependencies, kernel_source, with_kernel
from ..compiling.targets import TARGETS, Target
from ..interface.models import Model
from .archive import DESCRIPTION, TEMPLATES, archive, generation_date, guid_of, render, render_xml
from .component import FOLDER, MANIFEST, PLATFORM, component
from .description import FLANGE, model_description, terminals
from .documentation import MECHANISM, index_page
from .linking import Progress, header_folder, join_for_mac, shell_files, version_file
from .tables import generated

Content = TypeVar("Content")
# name of the source file
SOURCE = "all.c"
# path of the metadata in SSP Traceability
METADATA = "extra/org.ssp-standard.ssp-traceability.srmd/resourceMetaData.srmd"


@dataclass
class Build:
    """State of a build.

    Attributes:
        progress: function that is called at the beginning of each stage, with its description.
        targets: platforms of the native FMUs.
        paths: paths of the written files.
        skipped: reasons by description of the skipped part.
    """

    progress: Progress = lambda stage: None
    targets: Sequence[Target] = TARGETS
    paths: list[Path] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)

    def attempt(self, part: str, make: Callable[..., Content], *arguments: Any) -> Content | None:
        """Return the result of a function; if it cannot compile, add the reason to skipped and return None.

        Args:
            part: description of the part that the function makes.
            make: the function.
            arguments: its arguments.
        """
        try:
            return make(*arguments)
        except CompilationError as reason:
            self.skipped[part] = str(reason)
            return None


class NativeFmu(NamedTuple):
    """A native FMU to build.

    Attributes:
        identifier: model identifier.
        model: the model.
        picture: name of the pictures.
        fmi: version of FMI, 2 or 3.
    """

    identifier: str
    model: Model
    picture: str
    fmi: int = 2

    @property
    def file_name(self) -> str:
        """Name of the file."""
        return f"{self.identifier}.fmu"

    def library_path(self, target: Target) -> str:
        """Return the path of the shared library for a target within the FMU.

        Args:
            target: the platform.
        """
        folder = target.folder if self.fmi == 2 else target.platform
        return f"binaries/{folder}/{self.identifier}{target.suffix}"

    def guid(self) -> str:
        """Return the GUID, a hash of all sources of the FMU and of the versions of the tools."""
        hashed_parts = dependencies(self.model)
        hashed_parts |= sources("fmu/*.py", "fmu/shell/*", "fmu/wasm/*", "fmu/templates/*")
        hashed_parts |= {path.name: path.read_bytes() for path in header_folder().glob(f"fmi{self.fmi}*.h")}
        hashed_parts |= accompanying_files(self.model, self.picture, self.fmi)
        hashed_parts |= {name: text.encode() for name, text in generated(self.model, "", self.fmi).items()}
        hashed_parts["description"] = model_description(self.model, self.identifier, "", "", self.fmi)
        return guid_of(hashed_parts)

    def content(self, build: Build) -> bytes:
        """Return the content of the file.

        Args:
            build: the build; platforms without a compiler are skipped.

        Raises:
            CompilationError: the FMU cannot be compiled for any platform.
        """
        guid = self.guid()

        def compiled_for(target: Target) -> bytes | None:
            what = f"{self.identifier} for {target.label}"
            return build.attempt(what, library, self, guid, target, build.progress)

        # threads suffice, because the compiler is a separate process
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            libraries = list(pool.map(compiled_for, build.targets))
        parts: dict[str, list[tuple[str, bytes]]] = {}
        for target, content in zip(build.targets, libraries, strict=True):
            if content is not None:
                parts.setdefault(self.library_path(target), []).append((target.label.split("-")[0], content))
        if not parts:
            raise CompilationError(build.skipped[f"{self.identifier} for {build.targets[0].label}"])
        files = {path: same[0][1] if len(same) == 1 else join_for_mac(same) for path, same in parts.items()}
        if len(build.targets) == len(TARGETS):  # for all platforms: sources and WebAssembly for other ones
            for what, make in (("in C", source_files), (f"for {PLATFORM}", component_files)):
                added = build.attempt(f"{self.identifier} {what}", make, self, guid, build.progress)
                files |= added or {}
        of_standard = {"fmi-ls-wasm": (FOLDER / "LICENSE.txt").read_text()} if MANIFEST in files else {}
        files |= accompanying_files(self.model, self.picture, self.fmi, **of_standard)
        description = self.identifier, guid, generation_date(), self.fmi
        sources = [SOURCE] if f"sources/{SOURCE}" in files else []
        described = model_description(self.model, *description, sources=sources)
        return archive(files | {DESCRIPTION: described})


def accompanying_files(model: Model, picture: str, fmi: int, **licences: str) -> dict[str, bytes]:
    """Return the files of an FMU without code by path, such as documentation, licences and metadata.

    Args:
        model: the model.
        picture: name of the pictures.
        fmi: version of FMI, 2 or 3.
        licences: texts of third-party licences by name.
    """
    texts = {"license": sources("LICENSE")["LICENSE"].decode()} | licences
    files = {
        "documentation/index.html": index_page(model, texts).encode(),
        f"documentation/{MECHANISM}": _picture(f"{picture}_named.png"),
        **{f"documentation/licenses/{name}.txt": text.encode() for name, text in texts.items()},
        METADATA: render_xml(TEMPLATES / "resourceMetaData.srmd", {"model": model, "version": __version__}),
    }
    references_folder = f"fmu/references/{model.name}/"
    files |= {
        path.removeprefix(references_folder): content
        for path, content in sources(f"{references_folder}**/*").items()
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
    """Return a picture drawn by docs/make_icons.py."""
    return (Path(__file__).parent / "pictures" / name).read_bytes()


def expanded(name: str, files: Mapping[str, bytes], inserted: set[str]) -> Iterator[str]:
    """Yield the lines of a C file with its includes inserted, each once.

    Args:
        name: name of the file.
        files: contents by name; includes of other files stay unchanged.
        inserted: names of the inserted files; extended by this function.
    """
    inserted.add(name)
    for line in files[name].decode().splitlines():
        include = re.fullmatch(r'#include "(.*)"', line)
        if include is None or include[1] not in files:
            yield line
        elif include[1] not in inserted:
            yield from expanded(include[1], files, inserted)


def source_files(fmu: NativeFmu, guid: str, progress: Progress) -> dict[str, bytes]:
    """Return the FMU in C99, by path in the FMU, for processors without a binary.

    The source is one file, so that the compiler exports only the functions of FMI.

    Args:
        fmu: the FMU.
        guid: GUID of the FMU.
        progress: not used; all functions of a build have this argument.
    """
    files = {"kernel.c": kernel_source(fmu.model)} | shell_files(fmu.model, guid, fmu.fmi)
    included = [name for name in files if name.endswith(".c")]
    files[SOURCE] = render(TEMPLATES / SOURCE, {"model": fmu.model, "files": included}).encode()
    made = {SOURCE: "\n".join([*expanded(SOURCE, files, set()), ""]).encode()}
    if fmu.fmi == 3:
        values = {"identifier": fmu.identifier, "source": SOURCE}
        made["buildDescription.xml"] = render_xml(TEMPLATES / "buildDescription.xml", values)
    return {f"sources/{name}": content for name, content in made.items()}


def component_files(fmu: NativeFmu, guid: str, progress: Progress) -> dict[str, bytes]:
    """Return the WebAssembly component and its manifest by path in the FMU; empty for FMI 2.0.

    Args:
        fmu: the FMU.
        guid: GUID of the FMU.
        progress: function that is called at the beginning of the compilation.
    """
    if fmu.fmi == 2:
        return {}

    def compiled() -> bytes:
        progress(f"compiling {fmu.identifier} for {PLATFORM}")
        return component(fmu.model, guid)

    content = cached(f"{fmu.identifier}-{PLATFORM}.wasm", {"guid": guid.encode()}, compiled).read_bytes()
    manifest = (FOLDER / "manifest.xml").read_bytes()
    return {f"binaries/{PLATFORM}/{fmu.identifier}.wasm": content, MANIFEST: manifest}


def library(fmu: NativeFmu, guid: str, target: Target, progress: Progress) -> bytes:
    """Return the shared library for a target; the cache stores it.

    Args:
        fmu: the FMU.
        guid: GUID of the FMU.
        target: the platform.
        progress: function that is called at the beginning of the compilation.
    """
    file = f"{fmu.identifier}{target.suffix}"

    def linked() -> bytes:
        progress(f"compiling {fmu.identifier} for {target.label}")
        content = shell_files(fmu.model, guid, fmu.fmi) | version_file(target, file, fmu.model.title)
        return with_kernel(fmu.model, target, file, content, "-isystem", str(header_folder()))

    name = f"{fmu.identifier}-{target.label}{target.suffix}"
    return cached(name, {"guid": guid.encode()}, linked).read_bytes()
