"""Compatibility information for importers: the FMUs with inputs and reference results.

The folders follow the FMI cross-check: fmus/FMI version/cs/platform/tool/version/model.
"""

from __future__ import annotations

from pathlib import Path

from fmpy.cross_check.validate_vendor_repo import validate_test_fmu

from inertia_module import __version__
from inertia_module.common.files import write_atomically
from inertia_module.fmu.archive import render
from inertia_module.fmu.builder import FMUS, content_of
from inertia_module.fmu.linking import Progress
from inertia_module.fmu.native_fmu import Build

from .reference.experiments import (
    EXPERIMENT_TOLERANCE,
    LS_REF_FOLDER,
    STEP,
    STOP,
    experiments,
    package_folder,
)

README = Path(__file__).parent / "reference" / "templates" / "compatibility.txt"
OPTIONS = f"StartTime, 0.0\nStopTime, {STOP}\nStepSize, {STEP}\nRelTol, {EXPERIMENT_TOLERANCE}\n"


def write_tree(folder: Path, progress: Progress) -> tuple[list[Path], list[str]]:
    """Write each FMU with the first experiment of its model, which uses start values.

    Args:
        folder: Output folder.
        progress: Function called with messages of the build.

    Returns:
        Paths of the files, and problems that FMPy reports.

    Raises:
        CompilationError: The compiler is not available.
        RuntimeError: An FMU cannot be built for all platforms.
    """
    paths, problems = list[Path](), list[str]()
    for fmu in FMUS:
        build = Build(progress)
        content = content_of(fmu, build)
        if build.skipped:
            raise RuntimeError(
                "; ".join(f"{platform}: {reason}" for platform, reason in build.skipped.items())
            )
        name, fmi = fmu.identifier, getattr(fmu, "fmi", 2)
        experiment = experiments(fmu.model)[0]
        references = package_folder(fmu.model) / LS_REF_FOLDER
        files = {
            f"{name}.fmu": content,
            **{
                f"{name}_{kind}.csv": (references / f"{experiment.name}_{kind}.csv").read_bytes()
                for kind in ("in", "ref")
            },
            f"{name}_ref.opt": OPTIONS.encode(),
            "readme.txt": render(
                README, {"name": name, "fmi": fmi, "fmu": fmu, "experiment": experiment}
            ).encode(),
        }
        target = folder / "fmus" / f"{fmi}.0" / "cs" / "linux64" / "inertia-module" / __version__ / name
        for file, text in files.items():
            write_atomically(target / file, text)
            paths.append(target / file)
        problems += validate_test_fmu(str(target))
    return paths, problems
