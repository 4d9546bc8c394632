"""The command ``inertia-module``: build the FMUs, run a scene, check an FMU."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

BUILD_FOLDER = Path("build")
OUTPUT_FOLDER = Path("out")

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
            paths = build_fmus(folder)
            typer.echo(json.dumps({"fmus": [str(path) for path in paths]}))
            return
        console = Console(soft_wrap=True, highlight=False)
        with console.status("building") as status:

            def stage(text: str) -> None:
                status.update(text)
                console.print(text)

            paths = build_fmus(folder, stage)
        for path in paths:
            console.print(f"built {path} ({path.stat().st_size / 1024:.0f} kB)")


def current_fmu() -> Path:
    """The Python FMU in build/, built anew if it is missing or of another state of the package."""
    from .fmu.builder import IDENTIFIER, is_current
    from .fmu.builder import build as build_fmus

    path = BUILD_FOLDER / f"{IDENTIFIER}.fmu"
    if not is_current(path):
        build_fmus(BUILD_FOLDER, lambda stage: typer.echo(stage, err=True))
    return path


@app.command()
def run(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file.")],
    output: OutputFolder = None,
    fmu: Annotated[
        Path | None, typer.Option(metavar="FILE.fmu", help="FMU to run (build/InertiaModulePy.fmu).")
    ] = None,
    as_json: Json = False,
) -> None:
    """Run a scene: leaves table.csv, summary.json and plot.png in a folder (out/SCENE without -o)."""
    from .drive import progress_bar
    from .figures import scene_figure
    from .results import write_figure, write_text
    from .scene import load_scene, run_scene

    with one_line_errors():
        read = load_scene(scene)
        path = fmu or current_fmu()
        with progress_bar(read.title) as progress:
            result = run_scene(read, path, progress)
        folder = output or OUTPUT_FOLDER / scene.stem
        files = {
            "table": result.table.to_csv(folder / "table.csv"),
            "summary": write_text(folder / "summary.json", json.dumps(result.summary, indent=2) + "\n"),
            "plot": write_figure(folder / "plot.png", scene_figure(result)),
        }
    if as_json:
        listed = {name: str(file) for name, file in files.items()}
        typer.echo(json.dumps({"scene": str(scene), "summary": result.summary, "files": listed}))
        return
    rows = {
        name.replace("_", " "): f"{value:.6g} {result.units[name]}".rstrip()
        for name, value in result.summary.items()
    }
    show_table(read.title, rows)
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


def main() -> None:
    """Entry of the console script."""
    sys.exit(app())
