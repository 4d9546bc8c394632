"""Commands for the engineer's jobs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ..jobs.spectra import Line

from .shared import (
    FmuToRun,
    Json,
    Keys,
    OutputFolder,
    app,
    current_fmu,
    folder_for,
    one_line_errors,
    quantity_of,
    show_table,
)


@app.command()
def orders(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")],
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
    as_json: Json = False,
) -> None:
    """Find the orders of torques, speeds and forces of a scene.

    Runs it and leaves orders.csv, waterfall.csv (over the run), summary.json and orders.png in a folder
    (out/orders/SCENE without -o).
    """
    from .. import jobs
    from ..figures.jobs import order_figure
    from ..harness.results import write_figure
    from ..harness.simulate import progress_bar
    from ..jobs.spectra import BASES
    from ..scene import load_scene
    from ..scene.keys import keys_of

    with one_line_errors():
        folder = folder_for(output, "orders", scene.stem)
        read = load_scene(scene, keys_of(keys))
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
    if as_json:
        listed = {name: str(file) for name, file in files.items()}
        typer.echo(json.dumps({"scene": str(scene), **found.as_dict(), "files": listed}))
        return
    typer.echo(f"{read.title}: largest orders, cycles a {BASES[of]}")
    for name, lines in found.largest().items():
        unit = found.units[name]
        rows = {
            _orders_of(line): f"{line.amplitude:.4g} {unit}, most at {line.speed:.4g} rad/s:"
            f" {line.greatest:.4g} {unit}"
            for line in lines
        }
        show_table(name.replace("_", " "), rows or {"no order": "it does not swing"})
    if found.bends:
        typer.echo("lines bend with the speed ratio: those of the pulses are straight with --of pulses")
    for name, file in files.items():
        typer.echo(f"{name}: {file}")


def _orders_of(line: Line) -> str:
    """The order of a line, or those between which it bends."""
    return f"order {line.order:.4g}" if line.low == line.high else f"order {line.low:.4g} to {line.high:.4g}"


@app.command()
def fit(
    measured: Annotated[
        Path, typer.Argument(metavar="MEASURED.csv", help="Table over time, units in its headings.")
    ],
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")],
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
    as_json: Json = False,
) -> None:
    """Find the values of a scene's keys that fit a measurement.

    Tells how sure they are. Leaves fitted.toml (a scene), residuals.csv, fit.json and fit.png in a folder
    (out/SCENE_fit without -o).
    """
    from .. import jobs
    from ..figures.jobs import fit_figure
    from ..harness.results import write_figure
    from ..harness.simulate import progress_bar
    from ..scene import load_scene
    from ..scene.keys import keys_of

    with one_line_errors():
        folder = folder_for(output, f"{scene.stem}_fit")
        with progress_bar(f"fit to {measured.name}") as progress:
            found = jobs.fit(
                measured,
                load_scene(scene, keys_of(keys)),
                free or [],
                columns=columns or [],
                starts=starts,
                seed=seed,
                output=folder,
                fmu=fmu or current_fmu(),
                progress=progress,
            )
        files = {
            **found.files,
            "picture": write_figure(folder / "fit.png", fit_figure(found)),
        }
    listed = {name: str(file) for name, file in files.items()}
    if as_json:
        typer.echo(
            json.dumps({"measured": str(measured), "scene": str(scene), **found.as_dict(), "files": listed})
        )
        return
    show_table(f"{found.scene.title}: fitted, 95 % intervals", found.lines())
    for warning in found.warnings:
        typer.echo(f"warning: {warning}")
    for name, file in listed.items():
        typer.echo(f"{name}: {file}")
