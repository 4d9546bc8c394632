"""Commands around FMU files: build them, check any, export systems of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..common.files import BUILD_FOLDER
from .shared import Answer, Keys, OutputFolder, SceneFile, command, folder_for, load_scene, show_table


@command
def build(context: typer.Context, output: OutputFolder = None) -> Answer:
    """Build the FMUs and the kernel for pages.

    Each is whole or not there (in build/ without -o). Exit code 1 if one is skipped.
    """
    from rich.text import Text

    from ..common.terminal import terminal
    from ..fmu.builder import build as build_fmus

    with terminal().status("building") as status:

        def stage(text: str) -> None:
            status.update(Text(text))
            if not context.params["as_json"]:
                typer.echo(text)

        built = build_fmus(output or BUILD_FOLDER, stage)
    fmus = [str(path) for path in built.paths if path.suffix == ".fmu"]
    kernels = [str(path) for path in built.paths if path.suffix != ".fmu"]

    def show() -> None:
        for path in built.paths:
            typer.echo(f"built {path} ({path.stat().st_size / 1024:.0f} kB)")
        for what, reason in built.skipped.items():
            typer.echo(f"skipped {what}: {reason}", err=True)

    told = {"fmus": fmus, "kernels": kernels, "skipped": built.skipped}
    return Answer(told, show, failed=bool(built.skipped))


@command
def check(fmu: Annotated[Path, typer.Argument(metavar="FILE.fmu", help="Any FMU file.")]) -> Answer:
    """Validate an FMU file with fmpy, then step it.

    That is over its default experiment. FMI 2.0 or 3.0; an FMU with event mode is stepped once without
    and once with it.
    """
    from ..harness.check import check_fmu

    report = check_fmu(fmu)

    def show() -> None:
        show_table(str(fmu), report.facts)
        for warning in report.warnings:
            typer.echo(f"warning: {warning}", err=True)
        for problem in report.problems:
            typer.echo(f"problem: {problem}")
        typer.echo("no problems found" if not report.problems else f"{len(report.problems)} problems found")

    found = {"facts": report.facts, "problems": report.problems, "warnings": report.warnings}
    told = {"fmu": str(fmu), **found, "outputs": report.outputs}
    return Answer(told, show, failed=bool(report.problems))


@command
def export(scene: SceneFile, output: OutputFolder = None, keys: Keys = None) -> Answer:
    """Export the mechanism of a scene: SSP, OSP, container FMU.

    They are in out/export/SCENE without -o. An elastic mechanism becomes two FMUs, the rigid module and
    its shaft. Drive, load and controller stay here: their values at the start go along, as inputs of the
    module and its shaft.
    """
    from ..export.writing import export as write
    from ..scene.run import scene_plan

    folder = folder_for(output, "export", scene.stem)
    paths = write(scene_plan(load_scene(scene, keys)), folder, lambda stage: typer.echo(stage, err=True))

    def show() -> None:
        for path in paths:
            typer.echo(f"wrote {path} ({path.stat().st_size / 1024:.0f} kB)")

    return Answer({"files": [str(path) for path in paths]}, show)
