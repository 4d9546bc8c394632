"""The command ``inertia-module``: build the FMUs, run a scene, measure the trade, check, try the extremes."""

from __future__ import annotations

import atexit
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

BUILD_FOLDER = Path("build")
OUTPUT_FOLDER = Path("out")
# columns of a wide table: a narrower console wraps its lines
TABLE_WIDTH = 160

app = typer.Typer(
    help="Inertia module: an inertial torque transformer as an FMI 2.0 co-simulation FMU.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

OutputFolder = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="DIR", help="Folder to write to; made if it is not there."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object for machines.")]


@contextmanager
def one_line_errors() -> Iterator[None]:
    """Errors a user can cause leave with one clear line and exit code 1."""
    try:
        yield
    except (ValueError, RuntimeError, OSError) as error:
        typer.echo("error: " + " ".join(str(error).split()), err=True)
        raise typer.Exit(1) from error


def show_table(title: str, rows: dict[str, str]) -> None:
    """Print headings and values as a table."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title=title, title_justify="left", show_header=False)
    for heading, value in rows.items():
        table.add_row(heading, value)
    Console(soft_wrap=True).print(table)


@app.command()
def build(output: OutputFolder = None, as_json: Json = False) -> None:
    """Build the FMUs, each whole or not at all (into build/ without -o)."""
    from rich.console import Console

    from .fmu.builder import build as build_fmus

    with one_line_errors():
        folder = output or BUILD_FOLDER
        if as_json:
            built = build_fmus(folder)
            typer.echo(json.dumps({"fmus": [str(path) for path in built.paths], "skipped": built.skipped}))
            return
        console = Console(soft_wrap=True, highlight=False)
        with console.status("building") as status:

            def stage(text: str) -> None:
                status.update(text)
                console.print(text)

            built = build_fmus(folder, stage)
        for path in built.paths:
            console.print(f"built {path} ({path.stat().st_size / 1024:.0f} kB)")
        for what, reason in built.skipped.items():
            console.print(f"skipped {what}: {reason}")


def current_fmu() -> Path:
    """The FMU of the module in build/, built anew if it is missing or of another state of the package.

    It is the native one or, where that cannot be compiled, the Python one.
    """
    from .fmu.builder import MODULE_FMU, PYTHON_FMU, is_current
    from .fmu.builder import build as build_fmus

    for fmu in (MODULE_FMU, PYTHON_FMU):
        if is_current(BUILD_FOLDER / fmu.file_name, fmu):
            return BUILD_FOLDER / fmu.file_name
    return build_fmus(BUILD_FOLDER, lambda stage: typer.echo(stage, err=True)).paths[0]


def native_fmus() -> tuple[Path, Path]:
    """The native FMUs of module and driven shaft in build/, built anew where they are not current.

    Raises:
        RuntimeError: they cannot be compiled here.
    """
    from .fmu.builder import MODULE_FMU, SHAFT_FMU, is_current
    from .fmu.builder import build as build_fmus

    module, shaft = (BUILD_FOLDER / fmu.file_name for fmu in (MODULE_FMU, SHAFT_FMU))
    if not (is_current(module, MODULE_FMU) and is_current(shaft, SHAFT_FMU)):
        skipped = build_fmus(BUILD_FOLDER, lambda stage: typer.echo(stage, err=True)).skipped
        for path in (module, shaft):
            if path.name in skipped:
                raise RuntimeError(f"{path.name} cannot be built: {skipped[path.name]}")
    return module, shaft


def share(option: str, text: str | None) -> float | None:
    """An error given on the command line, such as 0.01 or "1 %"."""
    from .scene.units import checked

    if text is None:
        return None
    try:
        return checked(text, "1", maximum=1.0, above=0.0)
    except ValueError as error:
        raise ValueError(f"{option} = {text!r} is refused: {error}") from None


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
    fmu: Annotated[
        Path | None, typer.Option(metavar="FILE.fmu", help="FMU to run (build/InertiaModule.fmu).")
    ] = None,
    as_json: Json = False,
) -> None:
    """Run a scene: leaves table.csv, summary.json and plot.png in a folder (out/SCENE without -o)."""
    from .drive import progress_bar
    from .figures import scene_figure
    from .results import write_figure, write_text
    from .scene import load_scene, run_scene
    from .studies.trials import choose

    choice = None
    with one_line_errors():
        read = load_scene(scene)
        allowed = share("--error", error)
        if fidelity is not None or (allowed is not None and read.chooses_fidelity):
            read = read.with_fidelity(fidelity or "auto", allowed)
        if allowed is not None and not read.chooses_fidelity:
            raise ValueError(f"--error = {error} is refused: allowed is that only with fidelity auto")
        if read.chooses_fidelity:
            with progress_bar("measuring the rungs") as progress:
                read, choice = choose(read, progress)
        path = fmu or current_fmu()
        with progress_bar(read.title) as progress:
            result = run_scene(read, path, progress)
        chosen = {} if choice is None else {"fidelity_choice": choice.as_dict()}
        summary = {**result.summary, **chosen}
        folder = output or OUTPUT_FOLDER / scene.stem
        files = {
            "table": result.table.to_csv(folder / "table.csv"),
            "summary": write_text(folder / "summary.json", json.dumps(summary, indent=2) + "\n"),
            "plot": write_figure(folder / "plot.png", scene_figure(result)),
        }
    if as_json:
        listed = {name: str(file) for name, file in files.items()}
        typer.echo(json.dumps({"scene": str(scene), "summary": summary, "files": listed}))
        return
    rows = {
        name.replace("_", " "): f"{value:.6g} {result.units[name]}".rstrip()
        for name, value in result.summary.items()
    }
    show_table(read.title, rows)
    for line in choice.lines() if choice is not None else ():
        typer.echo(line)
    for name, file in files.items():
        typer.echo(f"{name}: {file}")


@app.command()
def tradeoff(
    scene: Annotated[
        Path | None, typer.Argument(metavar="SCENE.toml", help="Scene file (without it: scene R1).")
    ] = None,
    output: OutputFolder = None,
    recommend: Annotated[
        str | None,
        typer.Option(metavar="ERROR", help='Recommend the cheapest rung for an error: 1e-3, "1 %".'),
    ] = None,
    wanted: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Output (of R1: error) that counts; may be repeated."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Measure error against cost: fidelity, method, tolerance or step, communication step (out/tradeoff)."""
    from rich.console import Console

    from .drive import progress_bar
    from .scene import load_scene
    from .studies import tradeoff as study
    from .studies.choice import recommend as choose_cheapest
    from .studies.peers import PEERS
    from .studies.report import rich_table

    with one_line_errors(), progress_bar("measuring the trade") as progress:
        allowed = share("--recommend", recommend)
        if scene is None:
            names = tuple(wanted or (study.R1_WANTED,))
            study.check_wanted(names)
            found = study.open_study(study.R1, "scene R1", () if allowed else PEERS, progress)
        else:
            read = load_scene(scene)
            read = read.replaced(run={"outputs": wanted}) if wanted else read
            names = tuple(read.run.outputs)
            found = (study.scene_trials if allowed else study.scene_study)(read, progress)
        choice = choose_cheapest(found.rows, allowed, names) if allowed else None
        files = study.write_study(found, output or OUTPUT_FOLDER / "tradeoff")
    if as_json:
        recommended = {} if choice is None else {"recommendation": choice.as_dict()}
        listed = {"files": {name: str(file) for name, file in files.items()}}
        typer.echo(json.dumps({**study.study_as_dict(found), **recommended, **listed}))
        return
    Console(width=TABLE_WIDTH).print(rich_table(found.title, found.rows, found.names))
    for line in study.closing_lines(found, choice):
        typer.echo(line)
    for name, file in files.items():
        typer.echo(f"{name}: {file}")


@app.command()
def papers(output: OutputFolder = None, as_json: Json = False) -> None:
    """Draw the figures of the papers as PNG and SVG, their numbers as CSV (out/papers without -o)."""
    from .drive import progress_bar
    from .paper_figures import all_figures
    from .results import write_columns, write_figure

    folder = output or OUTPUT_FOLDER / "papers"
    figures = all_figures()
    files: list[str] = []
    with one_line_errors(), progress_bar("drawing the papers", len(figures)) as progress:
        for number, (name, draw) in enumerate(figures.items(), 1):
            figure, columns = draw()
            files += [str(write_figure(folder / f"{name}.{kind}", figure)) for kind in ("png", "svg")]
            files.append(str(write_columns(folder / f"{name}.csv", columns)))
            progress(number)
    typer.echo(json.dumps({"files": files}) if as_json else "\n".join(files))


@app.command()
def chart(
    scenes: Annotated[list[Path], typer.Argument(metavar="SCENE.toml...", help="Scenes to compare.")],
    output: OutputFolder = None,
    as_json: Json = False,
) -> None:
    """Torque converter charts of mechanisms: a CSV each and one figure (out/chart without -o)."""
    from .chart import torque_converter_chart
    from .chart_figure import chart_figure
    from .results import write_figure
    from .scene import load_scene

    folder = output or OUTPUT_FOLDER / "chart"
    with one_line_errors():
        names = [scene.stem for scene in scenes]
        if len(set(names)) < len(names):
            raise ValueError(f"scenes {', '.join(names)} are refused: allowed are files of different names")
        charts = {
            name: torque_converter_chart(load_scene(scene).parameters())
            for name, scene in zip(names, scenes, strict=True)
        }
        files = [str(found.save(folder / f"{name}.csv")) for name, found in charts.items()]
        files.append(str(write_figure(folder / "chart.png", chart_figure(charts))))
    if as_json:
        summaries = {name: found.summary() for name, found in charts.items()}
        typer.echo(json.dumps({"charts": summaries, "files": files}))
        return
    for name, found in charts.items():
        show_table(name, {key.replace("_", " "): f"{value:.6g}" for key, value in found.summary().items()})
    typer.echo("\n".join(files))


@app.command()
def check(
    fmu: Annotated[Path, typer.Argument(metavar="FILE.fmu", help="Any FMU file.")],
    as_json: Json = False,
) -> None:
    """Validate an FMU file with fmpy, then step it over its default experiment."""
    from .checking import check_fmu

    with one_line_errors():
        report = check_fmu(fmu)
    if as_json:
        found = {"facts": report.facts, "problems": report.problems, "outputs": report.outputs}
        typer.echo(json.dumps({"fmu": str(fmu)} | found))
    else:
        show_table(str(fmu), report.facts)
        for problem in report.problems:
            typer.echo(f"problem: {problem}")
        typer.echo("no problems found" if not report.problems else f"{len(report.problems)} problems found")
    if report.problems:
        raise typer.Exit(1)


@app.command()
def stability(
    output: OutputFolder = None,
    as_json: Json = False,
    quick: Annotated[bool, typer.Option("--quick", help="Leave out the long runs.")] = False,
    only: Annotated[str | None, typer.Option("--only", metavar="AXIS", help="One axis of the map.")] = None,
) -> None:
    """Try the extremes and give each a verdict (out/stability without -o); exit code 1 if one is broken."""
    from .drive import progress_bar
    from .results import write_figure
    from .studies.stability import report
    from .studies.stability.figure import verdict_map
    from .studies.stability.study import chosen_cases, run_study, write_cases
    from .studies.stability.table import rows_of, write_rows

    folder = output or OUTPUT_FOLDER / "stability"
    with one_line_errors():
        chosen = chosen_cases(only, quick)
        with progress_bar("trying the extremes") as progress:
            verdicts = run_study(chosen, progress)
        rows = rows_of(verdicts)
        files = {
            "verdicts": write_rows(folder / "stability.csv", rows),
            "cases": write_cases(folder / "cases.csv", verdicts),
            "map": write_figure(folder / "stability.png", verdict_map(rows)),
        }
    if as_json:
        listed = {name: str(file) for name, file in files.items()}
        typer.echo(json.dumps({"verdicts": report.as_records(verdicts), "files": listed}))
    else:
        report.print_rows(rows)
        for name, file in files.items():
            typer.echo(f"{name}: {file}")
    if any(verdict.word == "broken" for verdict in verdicts):
        raise typer.Exit(1)


@app.command()
def coupling(
    scene: Annotated[
        Path, typer.Argument(metavar="[SCENE.toml]", help="Scene of the car in the urban cycle.")
    ] = Path("examples/urban.toml"),
    output: OutputFolder = None,
    as_json: Json = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="A corner of the map, without the long parts.")
    ] = False,
    only: Annotated[
        str | None,
        typer.Option("--only", metavar="PART", help="limits, map, adaptive, urban or shafts."),
    ] = None,
) -> None:
    """Couple an engine and a shaft to the module in every way and measure what it costs (out/coupling)."""
    from dataclasses import asdict

    from .drive import progress_bar
    from .studies.coupling.study import PARTS, Files, chosen_parts, print_rows, write_part

    folder = output or OUTPUT_FOLDER / "coupling"
    with one_line_errors():
        chosen = chosen_parts(only, quick)
        files = Files(*native_fmus(), scene)
        found = {}
        written: dict[str, str] = {}
        for name in chosen:
            with progress_bar(f"measuring: {name}") as progress:
                found[name] = PARTS[name].run(files, quick, progress)
            written.update(write_part(folder, name, found[name]))
    if as_json:
        rows = {name: [asdict(row) for row in part] for name, part in found.items()}
        typer.echo(json.dumps({"rows": rows, "files": written}))
        return
    for name, part in found.items():
        print_rows(name, part)
    for name, file in written.items():
        typer.echo(f"{name}: {file}")


def main() -> None:
    """Entry of the console script.

    A process that has loaded a Python FMU is ended without the destructors of its libraries: that of
    pythonfmu 0.7 uses memory it has freed, and now and then aborts a run that has succeeded.
    """
    try:
        app()
        code: object = 0
    except SystemExit as leave:
        code = leave.code
    if isinstance(code, str):
        sys.stderr.write(code + "\n")
        code = 1
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code if isinstance(code, int) else 0)
