"""Commands that compute many designs: sweep and design."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from .shared import (
    FmuToRun,
    Json,
    Keys,
    OutputFolder,
    app,
    current_fmu,
    folder_for,
    one_line_errors,
    show_table,
)

Scheduler = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="Dask scheduler to use: tcp://host:8786."),
]
Workers = Annotated[
    int | None, typer.Option(min=1, metavar="N", help="Processes on this machine (one for each core).")
]


@app.command()
def sweep(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")],
    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=RANGE",
            help="FROM:TO:COUNT, log:FROM:TO:COUNT or A,B,C; repeat.",
        ),
    ] = None,
    sample: Annotated[
        str | None, typer.Option(metavar="KIND:COUNT", help="Not a grid: latin:200 or sobol:256 points.")
    ] = None,
    sensitivity: Annotated[
        int | None, typer.Option(metavar="N", help="Sobol indices from N (keys + 2) runs, N a power of 2.")
    ] = None,
    figure: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Figure of the summary to plot; repeat.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Of the samples: same seed, same points.")] = 0,
    output: OutputFolder = None,
    keys: Keys = None,
    fmu: FmuToRun = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    as_json: Json = False,
) -> None:
    """Run a scene over values of its keys.

    Leaves sweep.parquet, sweep.csv and plot.png in a folder (out/SCENE_sweep without -o). What is done is
    in journal.jsonl of the folder and is not done again.
    """
    from .. import jobs
    from ..figures.jobs import sweep_figure
    from ..harness.results import write_figure
    from ..harness.simulate import progress_bar
    from ..scene import load_scene
    from ..scene.keys import keys_of

    with one_line_errors():
        folder = folder_for(output, f"{scene.stem}_sweep")
        with progress_bar(f"sweep of {scene.name}") as progress:
            found = jobs.sweep(
                load_scene(scene, keys_of(keys)),
                vary or [],
                sample=sample,
                sensitivity=sensitivity,
                seed=seed,
                output=folder,
                fmu=fmu or current_fmu(),
                scheduler=scheduler,
                workers=workers,
                progress=progress,
            )
        files = {**found.files, "plot": write_figure(folder / "plot.png", sweep_figure(found, figure or ()))}
    numbers = {"rows": len(found.rows), "new": found.new, "refused": len(found.refused)}
    listed = {name: str(file) for name, file in files.items()}
    if as_json:
        typer.echo(
            json.dumps({"scene": str(scene), **numbers, "unreached": found.unreached, "files": listed})
        )
        return
    show_table(f"sweep of {scene.name}", {name: str(number) for name, number in numbers.items()})
    if found.refused:
        typer.echo(f"refused first: {found.refused[0].point}: {found.refused[0].refused}")
    for name, number in found.unreached.items():
        typer.echo(f"{name}: not reached in {number} of {len(found.rows)} runs")
    for name, file in listed.items():
        typer.echo(f"{name}: {file}")


@app.command()
def design(
    spec: Annotated[Path, typer.Argument(metavar="SPEC.toml", help="Scene with [free] and [figures].")],
    output: OutputFolder = None,
    keys: Keys = None,
    fmu: FmuToRun = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    as_json: Json = False,
) -> None:
    """Search the best designs within the limits of a specification.

    Leaves pareto.csv, checked.csv (and .parquet), plot.png and each checked design as a scene, design_1.toml
    and so on, in a folder (out/SPEC_design without -o).
    """
    from .. import jobs
    from ..figures.jobs import design_figure
    from ..harness.results import write_figure
    from ..harness.simulate import progress_bar
    from ..jobs.spec import read_spec
    from ..scene.keys import keys_of

    with one_line_errors():
        folder = folder_for(output, f"{spec.stem}_design")
        with progress_bar(f"design of {spec.name}") as progress:
            found = jobs.design(
                read_spec(spec, keys_of(keys)),
                output=folder,
                fmu=fmu or current_fmu(),
                scheduler=scheduler,
                workers=workers,
                progress=progress,
            )
        files = {**found.files, "plot": write_figure(folder / "plot.png", design_figure(found))}
    files |= {one.file.stem.replace("_", " "): one.file for one in found.finalists}
    listed = {name: str(file) for name, file in files.items()}
    if as_json:
        numbers = {"designs": len(found.rows), "new": found.new, "chosen": len(found.chosen)}
        typer.echo(json.dumps({"spec": str(spec), **numbers, "verdict": found.verdict(), "files": listed}))
        return
    for one in found.finalists:
        show_table(one.file.stem.replace("_", " "), found.lines(one))
    typer.echo(found.verdict())
    for name, file in listed.items():
        typer.echo(f"{name}: {file}")
