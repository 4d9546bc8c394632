"""Files of a wheel besides the package: results of `make dist`, and the examples."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

# build results: FMUs, and the WebAssembly kernel of the viewer
BUILT = (
    *("InertiaModule.fmu", "InertiaModule3.fmu", "InertiaModulePy.fmu"),
    *("DrivenShaft.fmu", "DrivenShaft3.fmu", "InertiaModule.wasm"),
)


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
