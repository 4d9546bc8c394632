"""Build the wheel: files besides the package, and the README with links that work outside the repository."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

# build results: FMUs, and the WebAssembly kernel of the viewer
BUILT = (
    *("InertiaModule.fmu", "InertiaModule3.fmu", "InertiaModulePy.fmu"),
    *("DrivenShaft.fmu", "DrivenShaft3.fmu", "InertiaModule.wasm"),
)
LINK = re.compile(r"(?<!!)\[([^]]+)\]\((?!https?:|#)([^)]+)\)")
# image, with a caption in italics below
PICTURE = re.compile(r"!\[([^]]*)\]\((?!https?:)([^)]+)\)\n\n(\*[^*]+\*\n\n)?")


def readme_elsewhere(text: str, repository: str, version: str) -> str:
    """Return the README for a page outside the repository, such as PyPI.

    Args:
        text: the README in Markdown, with links and pictures relative to the root folder.
        repository: address of the repository; if empty, links become plain text and pictures are left out.
        version: version, whose tag the addresses contain.
    """
    if not repository:
        return LINK.sub(r"\1", PICTURE.sub("", text))
    text = PICTURE.sub(
        lambda match: match[0].replace(f"]({match[2]})", f"]({repository}/raw/v{version}/{match[2]})"), text
    )
    return LINK.sub(rf"[\1]({repository}/blob/v{version}/\2)", text)


class Readme(MetadataHookInterface):  # type: ignore[misc]
    """Sets the README of the metadata; `repository` in pyproject.toml is its address, if it has one."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add the README."""
        root, repository = Path(self.root), self.config.get("repository", "").rstrip("/")
        source = (root / "fmu_src/inertia_module/__init__.py").read_text(encoding="utf-8")
        version = re.search(r'^__version__ = "(.+)"', source, re.M)[1]  # type: ignore[index]
        text = readme_elsewhere((root / "README.md").read_text(encoding="utf-8"), repository, version)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}


class ReadyMade(BuildHookInterface):  # type: ignore[misc]
    """Adds the build results to the wheel of an sdist, which then needs no compiler; all files are required.

    A wheel of a clone does not contain build/, whose files may be outdated. Commands build FMUs when needed.
    """

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the files with their places in the package."""
        if version == "editable":
            return
        root = Path(self.root)
        build_data["force_include"][str(root / "examples")] = "inertia_module/examples"
        if not (root / "PKG-INFO").is_file():  # only an sdist has this file
            return
        ready = {root / "build" / name: f"inertia_module/ready/{name}" for name in BUILT}
        needed = [*ready, root / "fmu_src/inertia_module/viewer/template.html"]
        missing = [str(path.relative_to(root)) for path in needed if not path.is_file()]
        if missing:
            raise FileNotFoundError(f"missing files of the wheel: {', '.join(missing)}. Run make dist.")
        build_data["force_include"] |= {str(path): place for path, place in ready.items()}
