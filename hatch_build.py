"""What goes into a wheel besides the package: what `make dist` has built, and the examples."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

# what is built: FMUs, and the kernel for pages
BUILT = (
    *("InertiaModule.fmu", "InertiaModule3.fmu", "InertiaModulePy.fmu"),
    *("DrivenShaft.fmu", "DrivenShaft3.fmu", "InertiaModule.wasm"),
)


class ReadyMade(BuildHookInterface):  # type: ignore[misc]
    """Puts into the wheel of an sdist what runs without a compiler: all of it, or the wheel is not made.

    Installed from a clone it builds what it needs when that is asked for: what lies in build/ may be old.
    """

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name the files, and where in the package they go."""
        if version == "editable":
            return
        root = Path(self.root)
        build_data["force_include"][str(root / "examples")] = "inertia_module/examples"
        if not (root / "PKG-INFO").is_file():  # which an sdist has
            return
        ready = {root / "build" / name: f"inertia_module/ready/{name}" for name in BUILT}
        needed = [*ready, root / "fmu_src/inertia_module/page/template.html"]
        missing = [str(path.relative_to(root)) for path in needed if not path.is_file()]
        if missing:
            raise FileNotFoundError(f"make dist builds what a wheel needs: {', '.join(missing)}")
        build_data["force_include"] |= {str(path): place for path, place in ready.items()}
