"""Commands for FMU files: build, check, export."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

import inertia_module

from ..common.files import BUILD_FOLDER, OUTPUT_FOLDER, writable_folder
from ..common.terminal import progress_bar
from .answer import Answer, OutputPart, command
from .messages import print_to_stderr
from .options import Keys, OutputFolder, SceneFile, option, quantity_of, values_of


@command
def build(output: OutputFolder = None) -> Answer:
    """Build the FMUs and the WebAssembly kernel for the viewer.

    Files are written atomically (default folder: build/). Exits with code 1 if any file was skipped.
    """
    from ..fmu.builder import build as build_fmus

    result = build_fmus(output or BUILD_FOLDER, print_to_stderr)
    fmus = [str(path) for path in result.paths if path.suffix == ".fmu"]
    kernels = [str(path) for path in result.paths if path.suffix != ".fmu"]

    for name, reason in result.skipped.items():
        print_to_stderr(f"skipped {name}: {reason}")
    lines = [_line("built", path) for path in result.paths]
    data = {"fmus": fmus, "kernels": kernels, "skipped": result.skipped}
    return Answer(data, lines, failed=bool(result.skipped))


@command
def check(
    fmu: Annotated[Path, typer.Argument(metavar="FILE.fmu", help="Any FMU file.")],
    timeout: Annotated[
        str, option("Time limit of the process that runs the FMU, e.g. '5 min'.", "TIME")
    ] = "60 s",
) -> Answer:
    """Validate an FMU, simulate it and check its reference results.

    FMUs that support event mode are also simulated in event mode. The reference results inside the FMU
    follow FMI-LS-REF. The FMU runs in its own process with limits on time and memory. This is not a sandbox.
    """
    from ..fmi.check import check_fmu

    limit = quantity_of("--timeout", timeout, "s", above=0.0)
    with progress_bar(f"check of {fmu.name}") as progress:
        report = check_fmu(fmu, limit or 0.0, progress)
    rows = {
        f"{reference.experiment}: {reference.variable}": str(reference) for reference in report.references
    }
    parts: list[OutputPart] = [(str(fmu), report.facts)]
    parts += [("deviation from reference results", rows)] if rows else []
    parts += [f"problem: {problem}" for problem in report.problems]
    parts.append(f"{len(report.problems) or 'no'} problems found")
    data = {"fmu": str(fmu), **asdict(report)}
    return Answer(data, parts, failed=bool(report.problems), warnings=report.warnings)


@command
def export(scene: SceneFile, output: OutputFolder = None, keys: Keys = None) -> Answer:
    """Export the mechanism of a scene as SSP, OSP and container FMU.

    An elastic mechanism becomes two FMUs: the rigid module and its shaft. Drive, load and controller are
    not exported; their start values become start values of the inputs. Default output folder:
    out/export/SCENE.
    """
    from ..export.systems import export as write
    from ..scene.export_plan import scene_plan

    folder = writable_folder(output or OUTPUT_FOLDER / "export" / scene.stem)
    paths = write(scene_plan(inertia_module.load_scene(scene, values_of(keys))), folder, print_to_stderr)

    lines = [_line("wrote", path) for path in paths]
    return Answer({"files": [str(path) for path in paths]}, lines)


def _line(verb: str, path: Path) -> str:
    """Return a line about a written file: verb, path and size."""
    return f"{verb} {path} ({path.stat().st_size / 1024:.0f} kB)"
