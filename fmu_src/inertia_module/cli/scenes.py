"""Commands around scenes: run them, measure what accuracy costs, draw their charts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .shared import (
    PAGE,
    FmuToRun,
    Json,
    Keys,
    OutputFolder,
    app,
    current_fmu,
    folder_for,
    one_line_errors,
    shaft_fmu,
    share,
    show_table,
    speed_text,
    turning,
)

if TYPE_CHECKING:
    from ..fidelity.choice import Choice
    from ..scene import Scene
    from ..scene.run import Outcome


@app.command()
def run(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")],
    output: OutputFolder = None,
    fidelity: Annotated[
        str | None,
        typer.Option(help="Instead of the scene's: kinematic, averaged, rigid, elastic, or auto to choose."),
    ] = None,
    error: Annotated[
        str | None,
        typer.Option(help='Error allowed in the outputs, such as 0.01 or "1 %", for fidelity auto.'),
    ] = None,
    fmu: FmuToRun = None,
    view: Annotated[bool, typer.Option("--view", help="Leave page.html too: see view.")] = False,
    keys: Keys = None,
    as_json: Json = False,
) -> None:
    """Run a scene: table, summary and plot.

    Leaves table.csv, summary.json and plot.png in a folder (out/SCENE without -o).
    """
    from ..common.files import write_atomically
    from ..contract.variables import COMPUTED
    from ..figures.scenes import scene_figure, shaft_figure
    from ..harness.results import write_figure, write_text
    from ..harness.simulate import progress_bar
    from ..page.html import html_file, template
    from ..scene import ShaftScene, load_any_scene, run_scene, run_shaft_scene
    from ..scene.keys import keys_of

    choice, page = None, None
    result: Outcome
    with one_line_errors():
        folder = folder_for(output, scene.stem)
        read = load_any_scene(scene, keys_of(keys))
        if isinstance(read, ShaftScene):
            if fidelity is not None or error is not None or view:
                raise ValueError("--fidelity, --error and --view must come with a scene of the module")
            path = fmu or shaft_fmu()
            with progress_bar(read.title) as progress:
                of_shaft = run_shaft_scene(read, path, progress)
            result, figure = of_shaft, shaft_figure(of_shaft)
        else:
            if view:
                template()
            read, choice = at_fidelity(read, fidelity, error)
            path = fmu or current_fmu()
            with progress_bar(read.title) as progress:
                of_module = run_scene(read, path, progress, COMPUTED if view else ())
            result, figure = of_module, scene_figure(of_module)
            page = html_file(read, of_module) if view else None
        chosen = {} if choice is None else {"fidelity_choice": choice.as_dict()}
        told = {"scene": str(scene), **result.as_dict(), **chosen}
        files = {
            "table": result.table.to_csv(folder / "table.csv"),
            "summary": write_text(folder / "summary.json", json.dumps(told, indent=2) + "\n"),
            "plot": write_figure(folder / "plot.png", figure),
        }
        if page is not None:
            files["page"] = folder / PAGE
            write_atomically(files["page"], page)
    if as_json:
        listed = {name: str(file) for name, file in files.items()}
        warned = {"warnings": list(result.warnings)}
        typer.echo(json.dumps({**told, **warned, "files": listed}))
        return
    for warning in result.warnings:
        typer.echo(f"warning: {warning}", err=True)
    show_table(read.title, result.lines())
    for line in choice.lines() if choice is not None else ():
        typer.echo(line)
    for name, file in files.items():
        typer.echo(f"{name}: {file}")


def at_fidelity(read: Scene, fidelity: str | None, error: str | None) -> tuple[Scene, Choice | None]:
    """A scene at the fidelity asked for, or at one chosen by measuring, and then why."""
    from ..fidelity.trials import choose
    from ..harness.simulate import progress_bar

    allowed = share("--error", error)
    if fidelity is not None or (allowed is not None and read.chooses_fidelity):
        read = read.with_fidelity(fidelity or "auto", allowed)
    if not read.chooses_fidelity:
        if allowed is not None:
            raise ValueError(f"--error = {error} must come with fidelity auto")
        return read, None
    with progress_bar("measuring the levels of fidelity") as progress:
        return choose(read, progress)


@app.command()
def tradeoff(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")],
    output: OutputFolder = None,
    recommend: Annotated[
        str | None,
        typer.Option(metavar="ERROR", help='Recommend the cheapest level for an error: 1e-3, "1 %".'),
    ] = None,
    wanted: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Output that counts, instead of the scene's; may be repeated."),
    ] = None,
    keys: Keys = None,
    as_json: Json = False,
) -> None:
    """Measure error against cost of a scene.

    Of each fidelity, method, tolerance or step, and communication step (out/tradeoff without -o).
    """
    from ..fidelity.choice import print_levels
    from ..fidelity.choice import recommend as choose_cheapest
    from ..fidelity.tradeoff import scene_study, scene_trials
    from ..harness.simulate import progress_bar
    from ..scene import load_scene
    from ..scene.keys import keys_of

    with one_line_errors(), progress_bar("measuring the trade") as progress:
        folder = folder_for(output, "tradeoff")
        allowed = share("--recommend", recommend)
        read = load_scene(scene, keys_of(keys))
        read = read.replaced(run={"outputs": wanted}) if wanted else read
        names = tuple(read.run.outputs)
        found = (scene_trials if allowed else scene_study)(read, progress)
        choice = choose_cheapest(found.rows, allowed, names) if allowed else None
        files = found.write(folder)
    if as_json:
        recommended = {} if choice is None else {"recommendation": choice.as_dict()}
        listed = {"files": {name: str(file) for name, file in files.items()}}
        typer.echo(json.dumps({**found.as_dict(), **recommended, **listed}))
        return
    step = (found.rows[0] if choice is None else choice.row).communication_step
    shown = [row for row in found.rows if row.communication_step == step]
    print_levels(found.title, shown, names, allowed)
    for line in found.closing_lines(choice):
        typer.echo(line)
    for name, file in files.items():
        typer.echo(f"{name}: {file}")


@app.command()
def chart(
    scenes: Annotated[list[Path], typer.Argument(metavar="SCENE.toml...", help="Scenes to compare.")],
    output: OutputFolder = None,
    speed: Annotated[
        str | None,
        typer.Option(
            metavar="SPEED",
            help="Torques at this speed, and converter tables for lookup blocks, CSV and MAT: 3000 rpm.",
        ),
    ] = None,
    keys: Keys = None,
    as_json: Json = False,
) -> None:
    """Draw torque converter charts of mechanisms.

    A CSV each and one figure (out/chart without -o). Of mechanisms with losses the charts are those of
    one input speed, and there is a map of the efficiency over speed ratio and input speed.
    """
    from ..figures.chart import chart_figure
    from ..harness.chart import NOMINAL_SPEED, converter_table, efficiency_map, torque_converter_chart
    from ..harness.results import write_figure
    from ..harness.simulate import progress_bar
    from ..scene import load_scene
    from ..scene.keys import keys_of

    with one_line_errors():
        folder = folder_for(output, "chart")
        names = [scene.stem for scene in scenes]
        if len(set(names)) < len(names):
            raise ValueError(f"scenes must be files of different names, are {', '.join(names)}")
        omega1 = None if speed is None else turning(speed)
        at = omega1 or NOMINAL_SPEED
        changes = keys_of(keys)
        mechanisms = {
            name: load_scene(scene, changes).parameters() for name, scene in zip(names, scenes, strict=True)
        }
        charts = {
            name: torque_converter_chart(values, at < 0.0, omega1=abs(at))
            for name, values in mechanisms.items()
        }
        maps = {}
        for name in (name for name, found in charts.items() if not found.lossless):
            with progress_bar(f"efficiency of {name}") as progress:
                maps[name] = efficiency_map(mechanisms[name], at, progress=progress)
        files = [str(found.save(folder / f"{name}.csv")) for name, found in charts.items()]
        files += [str(found.save(folder / f"{name}_efficiency.csv")) for name, found in maps.items()]
        if omega1 is not None:
            for name, found in charts.items():
                table = converter_table(mechanisms[name], found, omega1)
                files.append(str(table.save(folder / f"{name}_converter.csv")))
                files.append(str(table.save_mat(folder / f"{name}_converter.mat")))
        files.append(str(write_figure(folder / "chart.png", chart_figure(charts, maps))))
    summaries = {name: found.summary(omega1) for name, found in charts.items()}
    units = {name: found.units(omega1) for name, found in charts.items()}
    if as_json:
        typer.echo(json.dumps({"omega1": omega1, "charts": summaries, "units": units, "files": files}))
        return
    for name, numbers in summaries.items():
        rows = {key: f"{value:.6g} {units[name][key]}".rstrip() for key, value in numbers.items()}
        title = f"{name}, losses at {speed_text(at)}" if name in maps else name
        title = f"{name} at {speed_text(omega1)}" if omega1 is not None else title
        show_table(title, {key.replace("_", " "): text for key, text in rows.items()})
    typer.echo("\n".join(files))
