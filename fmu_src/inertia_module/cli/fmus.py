"""Commands around FMU files: build them, check any, export systems of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from ..common.files import BUILD_FOLDER
from .shared import Json, Keys, OutputFolder, app, folder_for, one_line_errors, show_table


@app.command()
def build(output: OutputFolder = None, as_json: Json = False) -> None:
    """Build the FMUs and the kernel for pages.

    Each is whole or not there (in build/ without -o). Exit code 1 if one is skipped.
    """
    from rich.text import Text

    from ..common.terminal import terminal
    from ..fmu.builder import build as build_fmus

    folder = output or BUILD_FOLDER
    with one_line_errors(), terminal().status("building") as status:

        def stage(text: str) -> None:
            status.update(Text(text))
            if not as_json:
                typer.echo(text)

        built = build_fmus(folder, stage)
    if as_json:
        fmus = [str(path) for path in built.paths if path.suffix == ".fmu"]
        kernels = [str(path) for path in built.paths if path.suffix != ".fmu"]
        typer.echo(json.dumps({"fmus": fmus, "kernels": kernels, "skipped": built.skipped}))
    else:
        for path in built.paths:
            typer.echo(f"built {path} ({path.stat().st_size / 1024:.0f} kB)")
        for what, reason in built.skipped.items():
            typer.echo(f"skipped {what}: {reason}", err=True)
    if built.skipped:
        raise typer.Exit(1)


@app.command()
def check(
    fmu: Annotated[Path, typer.Argument(metavar="FILE.fmu", help="Any FMU file.")],
    as_json: Json = False,
) -> None:
    """Validate an FMU file with fmpy, then step it.

    That is over its default experiment. FMI 2.0 or 3.0; an FMU with event mode is stepped once without
    and once with it.
    """
    from ..harness.check import check_fmu

    with one_line_errors():
        report = check_fmu(fmu)
    if as_json:
        found = {"facts": report.facts, "problems": report.problems, "warnings": report.warnings}
        typer.echo(json.dumps({"fmu": str(fmu)} | found | {"outputs": report.outputs}))
    else:
        show_table(str(fmu), report.facts)
        for warning in report.warnings:
            typer.echo(f"warning: {warning}", err=True)
        for problem in report.problems:
            typer.echo(f"problem: {problem}")
        typer.echo("no problems found" if not report.problems else f"{len(report.problems)} problems found")
    if report.problems:
        raise typer.Exit(1)


@app.command()
def export(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")],
    output: OutputFolder = None,
    keys: Keys = None,
    as_json: Json = False,
) -> None:
    """Export the mechanism of a scene: SSP, OSP, container FMU.

    They are in out/export/SCENE without -o. An elastic mechanism becomes two FMUs, the rigid module and
    its shaft. Drive, load and controller stay here: their values at the start go along, as inputs of the
    module and its shaft.
    """
    from ..export.writing import export as write
    from ..scene import load_scene
    from ..scene.keys import keys_of
    from ..scene.run import scene_plan

    with one_line_errors():
        folder = folder_for(output, "export", scene.stem)
        plan = scene_plan(load_scene(scene, keys_of(keys)))
        paths = write(plan, folder, lambda stage: typer.echo(stage, err=True))
    if as_json:
        typer.echo(json.dumps({"files": [str(path) for path in paths]}))
        return
    for path in paths:
        typer.echo(f"wrote {path} ({path.stat().st_size / 1024:.0f} kB)")
