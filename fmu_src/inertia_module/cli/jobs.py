"""Commands for the engineer's jobs: find orders, fit to a measurement, compute many designs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import inertia_module

from .shared import (
    Answer,
    FmuToRun,
    Keys,
    OutputFolder,
    SceneFile,
    command,
    current_fmu,
    folder_for,
    load_scene,
    progress_bar,
    quantity_of,
    show_table,
    write_figure,
)

Scheduler = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="Dask scheduler to use: tcp://host:8786."),
]
Workers = Annotated[
    int | None, typer.Option(min=1, metavar="N", help="Processes on this machine (one for each core).")
]


@command
def orders(
    scene: SceneFile,
    output: OutputFolder = None,
    of: Annotated[str, typer.Option(help="Orders of link1, cycles a turn of it, or of pulses.")] = "link1",
    signals: Annotated[
        list[str] | None,
        typer.Option("--signal", metavar="NAME", help="Output to look at; may be repeated."),
    ] = None,
    highest: Annotated[float | None, typer.Option(metavar="ORDER", help="Highest order.")] = None,
    turns: Annotated[
        float | None, typer.Option(help="Turns of link 1 (or pulses) in a window: 1 / resolution.")
    ] = None,
    begin: Annotated[
        str, typer.Option("--from", metavar="TIME", help="Begin of what is looked at: '2 s'.")
    ] = "0",
    end: Annotated[str | None, typer.Option("--to", metavar="TIME", help="Its end.")] = None,
    fmu: FmuToRun = None,
    keys: Keys = None,
) -> Answer:
    """Find the orders of torques, speeds and forces of a scene.

    Runs it and leaves orders.csv, waterfall.csv (over the run), summary.json and orders.png in a folder
    (out/orders/SCENE without -o).
    """
    from .. import jobs
    from ..figures.jobs import order_figure
    from ..jobs.orders import BASES

    folder = folder_for(output, "orders", scene.stem)
    read = load_scene(scene, keys)
    first = quantity_of("--from", begin, "s")
    last = None if end is None else quantity_of("--to", end, "s")
    path = fmu or current_fmu()
    with progress_bar(read.title) as progress:
        found = jobs.orders(
            read,
            path,
            of=of,
            signals=signals,
            highest=highest,
            turns=turns,
            begin=first,
            end=last,
            progress=progress,
        )
    files = found.write(folder)
    files["picture"] = write_figure(folder / "orders.png", order_figure(found, read.title))

    def show() -> None:
        typer.echo(f"{read.title}: largest orders, cycles a {BASES[of]}")
        for name, lines in found.largest().items():
            unit = found.units[name]
            rows = {
                f"order {line.order:.4g}"
                if line.low == line.high
                else f"order {line.low:.4g} to {line.high:.4g}": f"{line.amplitude:.4g} {unit}, most at"
                f" {line.speed:.4g} rad/s: {line.greatest:.4g} {unit}"
                for line in lines
            }
            show_table(name.replace("_", " "), rows or {"no order": "it does not swing"})
        if found.bends:
            typer.echo("lines bend with the speed ratio: those of the pulses are straight with --of pulses")

    return Answer({"scene": str(scene), **found.as_dict()}, show, files)


@command
def fit(
    measured: Annotated[
        Path, typer.Argument(metavar="MEASURED.csv", help="Table over time, units in its headings.")
    ],
    scene: SceneFile,
    free: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME[=LOW:HIGH]", help="Key of the scene that is to be found; repeat."),
    ] = None,
    columns: Annotated[
        list[str] | None,
        typer.Option("--column", metavar="NAME", help="Column to compare (all that are outputs); repeat."),
    ] = None,
    starts: Annotated[int, typer.Option(help="Points of the ranges to begin at.")] = 16,
    seed: Annotated[int, typer.Option(help="Of these points: same seed, same result.")] = 0,
    output: OutputFolder = None,
    fmu: FmuToRun = None,
    keys: Keys = None,
) -> Answer:
    """Find the values of a scene's keys that fit a measurement.

    Tells how sure they are. Leaves fitted.toml (a scene), residuals.csv, fit.json and fit.png in a folder
    (out/SCENE_fit without -o).
    """
    from .. import jobs

    folder = folder_for(output, f"{scene.stem}_fit")
    with progress_bar(f"fit to {measured.name}") as progress:
        found = jobs.fit(
            measured,
            load_scene(scene, keys),
            free or [],
            columns=columns or [],
            starts=starts,
            seed=seed,
            output=folder,
            fmu=fmu or current_fmu(),
            progress=progress,
        )
    files = {**found.files, "picture": write_figure(folder / "fit.png", inertia_module.fit_figure(found))}

    def show() -> None:
        show_table(f"{found.scene.title}: fitted, 95 % intervals", found.lines())
        for warning in found.warnings:
            typer.echo(f"warning: {warning}")

    return Answer({"measured": str(measured), "scene": str(scene), **found.as_dict()}, show, files)


@command
def sweep(
    scene: SceneFile,
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
) -> Answer:
    """Run a scene over values of its keys.

    Leaves sweep.parquet, sweep.csv and plot.png in a folder (out/SCENE_sweep without -o). What is done is
    in journal.jsonl of the folder and is not done again.
    """
    from .. import jobs
    from ..figures.jobs import sweep_figure

    folder = folder_for(output, f"{scene.stem}_sweep")
    with progress_bar(f"sweep of {scene.name}") as progress:
        found = jobs.sweep(
            load_scene(scene, keys),
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

    def show() -> None:
        show_table(f"sweep of {scene.name}", {name: str(number) for name, number in numbers.items()})
        if found.refused:
            typer.echo(f"refused first: {found.refused[0].point}: {found.refused[0].refused}")
        for name, number in found.unreached.items():
            typer.echo(f"{name}: not reached in {number} of {len(found.rows)} runs")

    return Answer({"scene": str(scene), **numbers, "unreached": found.unreached}, show, files)


@command
def design(
    spec: Annotated[Path, typer.Argument(metavar="SPEC.toml", help="Scene with [free] and [figures].")],
    output: OutputFolder = None,
    keys: Keys = None,
    fmu: FmuToRun = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> Answer:
    """Search the best designs within the limits of a specification.

    Leaves pareto.csv, checked.csv (and .parquet), plot.png and each checked design as a scene, design_1.toml
    and so on, in a folder (out/SPEC_design without -o).
    """
    from .. import jobs
    from ..jobs.spec import read_spec
    from ..scene.keys import keys_of

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
    files = {**found.files, "plot": write_figure(folder / "plot.png", inertia_module.design_figure(found))}
    files |= {one.file.stem.replace("_", " "): one.file for one in found.finalists}

    def show() -> None:
        for one in found.finalists:
            show_table(one.file.stem.replace("_", " "), found.lines(one))
        typer.echo(found.verdict())

    numbers = {"designs": len(found.rows), "new": found.new, "chosen": len(found.chosen)}
    return Answer({"spec": str(spec), **numbers, "verdict": found.verdict()}, show, files)
