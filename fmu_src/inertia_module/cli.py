"""Command line ``inertia-module``: scenes, engineering tasks, FMUs.

All commands have errors in one line, the option --json, output files and an exit code. Libraries and modules
of the package are imported when a command runs, so that help starts fast.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import inspect
import json
import logging
import math
import os
import re
import shlex
import signal
import sys
import tomllib
import webbrowser
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import inertia_module

from .common.errors import must_be, sentence_of
from .common.files import BUILD_FOLDER, OUTPUT_FOLDER, writable_folder, write_atomically, write_figure
from .common.terminal import progress_bar, terminal
from .common.units import factor_between, number_of, split_quantity

if TYPE_CHECKING:
    from .fidelity.choice import Choice
    from .scene import Scene, SceneResult, ShaftScene

# types of option values; None without the option
Text = str | None
Texts = list[str] | None
File = Path | None


def option(text: str, metavar: str | None = None, *names: str, **more: Any) -> Any:
    """Declare an option of a command.

    Args:
        text: Help text.
        metavar: Placeholder of the value; None for a flag.
        names: Names of the option if they differ from the parameter.
        more: More arguments of typer.Option.
    """
    return typer.Option(*names, metavar=metavar, help=text, **more)


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file (TOML).")]
OutputFolder = Annotated[File, option("Output folder (created if missing).", "DIR", "--output", "-o")]
FmuToRun = Annotated[File, option("FMU to use instead of the bundled one.", "FILE.fmu")]
Keys = Annotated[
    Texts,
    option("Override a scene value, e.g. load.torque='8 N.m'; may be repeated.", "KEY=VALUE", "--set"),
]
Json = Annotated[bool, option("Print the result as JSON.", None, "--json")]
Scheduler = Annotated[Text, option("Address of a Dask scheduler, e.g. tcp://host:8786.", "ADDRESS")]
Workers = Annotated[
    int | None, option("Number of local worker processes (default: one per core).", "N", min=1)
]


def aside(text: str) -> None:
    """Print a line to the error output; a closed or full error output is ignored.

    Args:
        text: The line.
    """
    with contextlib.suppress(OSError):
        typer.echo(text, err=True)


class LogOfStages(logging.Handler):
    """Handler that prints the log of the package: the stages of a build during a command."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a message to the error output.

        Args:
            record: The message.
        """
        aside(record.getMessage())


LOG = logging.getLogger("inertia_module")
LOG.addHandler(LogOfStages())
LOG.setLevel(logging.INFO)


# part of the output: a line, a title with values by heading, or a function that prints
Shown = str | tuple[str, dict[str, str]] | Callable[[], None]


@dataclass
class Answer:
    """Outcome of a command.

    Attributes:
        data: Result for --json.
        output: Printed parts, in this order.
        files: Written files by name, printed last; also in the result for --json.
        failed: True for exit code 1.
        warnings: Warnings, printed to the error output.
    """

    data: dict[str, Any]
    output: Sequence[Shown] = ()
    files: Mapping[str, Path] = field(default_factory=dict)
    failed: bool = False
    warnings: Sequence[str] = ()


# commands with a journal of results
CONTINUED = ("sweep", "design")


def command(work: Callable[..., Answer]) -> Callable[..., None]:
    """Turn a function into a command: add --json, errors in one line and the exit code.

    Args:
        work: Function of the options that returns the outcome.
    """

    @functools.wraps(work)
    def run(as_json: bool, **options: Any) -> None:
        try:
            answer = work(**options)
        except (ValueError, RuntimeError, OSError, MemoryError) as error:
            aside(f"error: {sentence_of(error)}")
            raise typer.Exit(1) from error
        except KeyboardInterrupt:
            aside("stopped; the same command continues" if work.__name__ in CONTINUED else "stopped")
            raise typer.Exit(128 + signal.SIGINT) from None
        try:
            present(answer, as_json)
        except OSError as error:
            error.filename = STANDARD_OUTPUT
            aside(f"error: {sentence_of(error)}")
            raise typer.Exit(1) from error
        if answer.failed:
            raise typer.Exit(1)

    as_json = inspect.Parameter("as_json", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Json)
    signature = inspect.signature(work, eval_str=True)
    run.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=[*signature.parameters.values(), as_json]
    )
    run.__annotations__ = {**work.__annotations__, "as_json": Json}
    return run


def present(answer: Answer, as_json: bool) -> None:
    """Print the outcome of a command.

    Args:
        answer: The outcome.
        as_json: True to print one JSON object instead of text.
    """
    file_names = {name: str(file) for name, file in answer.files.items()}
    if as_json:
        typer.echo(json.dumps(answer.data | ({"files": file_names} if file_names else {})))
        return
    for warning in answer.warnings:
        aside(f"warning: {warning}")
    for part in answer.output:
        show(part)
    for name, file in file_names.items():
        typer.echo(f"{name}: {file}")


def show(part: Shown) -> None:
    """Print one part of the output.

    Args:
        part: The part.
    """
    if isinstance(part, str):
        typer.echo(part)
    elif isinstance(part, tuple):
        from rich.table import Table

        title, rows = part
        table = Table(title=title, title_justify="left", show_header=False)
        for heading, value in rows.items():
            table.add_row(heading, value)
        terminal().print(table)
    else:
        part()


def quantity_of(option: str, text: str | None, unit: str, **limits: float) -> float | None:
    """Convert the value of an option, such as "2 s", to SI and check its range.

    Args:
        option: Name of the option in messages.
        text: Value; None without the option.
        unit: SI unit, "1" for none.
        limits: Limits, as in scene.keys.checked.

    Raises:
        ValueError: The value is not allowed.
    """
    from .scene.keys import checked

    try:
        return None if text is None else checked(text, unit, **limits)
    except ValueError as error:
        raise ValueError(f"{option} {error}") from None


def speed_of(text: str) -> float:
    """Convert the option --speed, such as "3000 rpm", to rad/s; negative for backward rotation.

    Args:
        text: Value of the option.

    Raises:
        ValueError: The value is no speed, is 0, or exceeds the maximum.
    """
    from .interface.variables import LARGEST_SPEED

    allowed = f"non-zero and at most {LARGEST_SPEED:g} rad/s, e.g. '3000 rpm'"
    message = must_be("--speed", allowed, repr(text))
    try:
        omega1 = number_of(text, "rad/s")
    except ValueError as error:
        raise ValueError(f"{message}: {error}") from None
    if not 0.0 < abs(omega1) <= LARGEST_SPEED:
        raise ValueError(message)
    if not split_quantity(text)[1]:
        aside(f"warning: --speed {text} has no unit; rad/s is used: {speed_text(omega1)}")
    return omega1


def speed_text(omega1: float) -> str:
    """Return a speed as text, in rad/s and rpm.

    Args:
        omega1: Speed, rad/s.
    """
    return f"{omega1:.5g} rad/s ({omega1 / factor_between('rpm', 'rad/s'):.5g} rpm)"


# --- FMU files ---


@command
def build(output: OutputFolder = None) -> Answer:
    """Build the FMUs and the WebAssembly kernel for the viewer.

    Files are written atomically (default folder: build/). Exits with code 1 if any file was skipped.
    """
    from .fmu.builder import build as build_fmus

    result = build_fmus(output or BUILD_FOLDER, aside)
    fmus = [str(path) for path in result.paths if path.suffix == ".fmu"]
    kernels = [str(path) for path in result.paths if path.suffix != ".fmu"]

    for name, reason in result.skipped.items():
        aside(f"skipped {name}: {reason}")
    lines = [f"built {path} ({path.stat().st_size / 1024:.0f} kB)" for path in result.paths]
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
    from .fmi.check import check_fmu

    limit = quantity_of("--timeout", timeout, "s", above=0.0)
    with progress_bar(f"check of {fmu.name}") as progress:
        report = check_fmu(fmu, limit or 0.0, progress)
    rows = {
        f"{reference.experiment}: {reference.variable}": str(reference) for reference in report.references
    }
    parts: list[Shown] = [(str(fmu), report.facts)]
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
    from .export.systems import export as write
    from .scene.run import scene_plan

    folder = writable_folder(output or OUTPUT_FOLDER / "export" / scene.stem)
    paths = write(scene_plan(inertia_module.load_scene(scene, keys)), folder, aside)

    lines = [f"wrote {path} ({path.stat().st_size / 1024:.0f} kB)" for path in paths]
    return Answer({"files": [str(path) for path in paths]}, lines)


# --- scenes ---


@command
def new(
    name: Annotated[str, typer.Argument(help="Example to copy: planar, planar.py, urban, tutorial, ...")],
    output: Annotated[File, option("Output file (default: NAME.toml).", "FILE", "--output", "-o")] = None,
) -> Answer:
    """Copy an example to a new file.

    Also copies its data files and helper scripts.
    """
    from .common.examples import belonging

    source = inertia_module.example(name)
    path = output or Path(source.name)
    copies = {path: source}
    for part in belonging(source):
        has_same_name = part.stem == source.stem
        copies[path.with_suffix(part.suffix) if has_same_name else path.with_name(part.name)] = part
    for copy in copies:
        if copy.exists():
            raise ValueError(f"{copy} already exists. Choose another name with -o.")
    for copy, original in copies.items():
        write_atomically(copy, original.read_bytes())

    lines = [*(f"created: {copy}" for copy in copies), "Next steps:"]
    lines += [f"  {line}" for line in _commands(source, path)]
    return Answer({"files": [str(copy) for copy in copies]}, lines)


def _commands(source: Path, path: Path) -> list[str]:
    """Return the commands to run after an example has been copied, in order."""
    text = source.read_text(encoding="utf-8")
    if source.suffix == ".ipynb":
        return ["pip install 'inertia-module[studies,notebook]' jupyterlab", f"jupyter lab {path}"]
    if source.suffix == ".py":
        return [*re.findall(r"Run `(.+?)` first", text), f"python {path}"]
    if match := re.match("# (inertia-module .*)", text):
        return [match[1].replace(f"{source.stem}.", f"{path.with_suffix('')}.")]
    return [f"inertia-module {'design' if 'free' in tomllib.loads(text) else 'run'} {path}"]


@command
def run(
    scene: SceneFile,
    output: OutputFolder = None,
    fidelity: Annotated[
        Text,
        option("Fidelity level: kinematic, averaged, rigid, elastic, or auto (chosen by --error).", "LEVEL"),
    ] = None,
    error: Annotated[
        Text, option("Maximum error of the outputs for fidelity auto, e.g. 1%.", "ERROR")
    ] = None,
    fmu: FmuToRun = None,
    view: Annotated[bool, option("Also write the viewer to page.html (see view).", None, "--view")] = False,
    keys: Keys = None,
) -> Answer:
    """Run a scene and write its table, summary and plot.

    Writes table.csv, summary.json and plot.png. Default output folder: out/SCENE.
    """
    from .interface.variables import COMPUTED
    from .viewer.html import html_file, template

    folder = writable_folder(output or OUTPUT_FOLDER / scene.stem)
    if view:
        template()
    read, choice = _read_scene(scene, keys, fidelity, error, view)
    result, _ = _run_scene(read, fmu, COMPUTED if view else ())
    page = html_file(result.scene, result) if view else None
    choice_data = {} if choice is None else {"fidelity_choice": choice.as_dict()}
    data = {"scene": str(scene), **result.as_dict(), **choice_data}
    files = {
        "table": result.table.to_csv(folder / "table.csv"),
        "summary": write_atomically(folder / "summary.json", f"{json.dumps(data, indent=2)}\n".encode()),
        "plot": write_figure(folder / "plot.png", inertia_module.scene_figure(result)),
    }
    if page is not None:
        files["page"] = write_atomically(folder / "page.html", page)

    parts: list[Shown] = [(read.title, result.lines()), *([] if choice is None else choice.lines())]
    return Answer(data, parts, files, warnings=result.warnings)


def _run_scene(
    scene: Scene | ShaftScene, fmu: Path | None, also: Sequence[str] = ()
) -> tuple[SceneResult, Path]:
    """Run a scene of a module or a driven shaft.

    Args:
        scene: The scene.
        fmu: FMU file; None for the FMU of the package.
        also: More variables to record, for a module.

    Returns:
        The result and the path of the FMU.
    """
    from .fmu.builder import MODULE_FMU, SHAFT_FMU, current_fmu
    from .scene import ShaftScene, run_shaft_scene

    path = fmu or current_fmu(SHAFT_FMU if isinstance(scene, ShaftScene) else MODULE_FMU)
    with progress_bar(scene.title) as progress:
        if isinstance(scene, ShaftScene):
            return run_shaft_scene(scene, path, progress), path
        return inertia_module.run_scene(scene, path, progress, also), path


def _read_scene(
    scene: Path, keys: Texts, fidelity: Text = None, error: Text = None, view: bool = False
) -> tuple[Scene | ShaftScene, Choice | None]:
    """Read a scene and apply the options of the fidelity.

    Args:
        scene: Scene file.
        keys: Values that replace values of the file, KEY=VALUE each.
        fidelity: Value of --fidelity.
        error: Value of --error.
        view: Value of --view.

    Returns:
        The scene, and the choice of the fidelity if it was 'auto'.

    Raises:
        ValueError: An option is invalid for the scene.
    """
    from .fidelity.choice import choose
    from .scene import Scene, load_any_scene

    read = load_any_scene(scene, keys)
    if not isinstance(read, Scene):
        if view or fidelity is not None or error is not None:
            raise ValueError("--fidelity, --error and --view require a scene of the module")
        return read, None
    allowed = quantity_of("--error", error, "1", maximum=1.0, above=0.0)
    if fidelity is not None or (allowed is not None and read.chooses_fidelity):
        read = read.with_fidelity(fidelity or "auto", allowed)
    if not read.chooses_fidelity:
        if allowed is not None:
            raise ValueError(f"--error = {error} requires fidelity auto")
        return read, None
    with progress_bar("measuring the fidelity levels") as progress:
        return choose(read, progress)


@command
def view(
    scene: SceneFile,
    output: Annotated[
        File, option("Output file (default: out/SCENE/page.html).", "FILE.html", "--output", "-o")
    ] = None,
    show: Annotated[bool, option("Open the file in the browser.", None, "--open")] = False,
    fmu: FmuToRun = None,
    keys: Keys = None,
) -> Answer:
    """Write the interactive 3-D viewer of a scene (one HTML file).

    The viewer contains the kernel and runs in a browser. Scenes with a controller, or with a load that
    depends on the motion, are simulated first and replayed.
    """
    from .interface.variables import COMPUTED
    from .scene import Scene
    from .viewer.html import checked_path, html_file, is_exact, template

    path = checked_path(output or OUTPUT_FOLDER / scene.stem / "page.html", "--output")
    template()
    read, _ = _read_scene(scene, keys)
    if not isinstance(read, Scene):
        raise ValueError(must_be(scene.name, "a scene of the module", "a driven shaft"))
    outcome = None
    if not is_exact(read):
        outcome, _ = _run_scene(read, fmu, COMPUTED)
    answer = _write_html(scene, "page", path, html_file(read, outcome), outcome.warnings if outcome else ())
    if show:
        webbrowser.open(path.absolute().as_uri())
    return answer


def _write_html(scene: Path, kind: str, path: Path, content: bytes, warnings: Sequence[str]) -> Answer:
    """Write an HTML file of a scene and return the outcome of the command.

    Args:
        scene: Scene file.
        kind: Kind of the file, "page" or "report".
        path: Path of the file.
        content: Content of the file.
        warnings: Warnings of the run.
    """
    write_atomically(path, content)
    data = {"scene": str(scene), kind: str(path), "bytes": len(content), "warnings": list(warnings)}
    return Answer(data, [f"{kind}: {path} ({len(content) / 1e6:.1f} MB)"], warnings=warnings)


@command
def report(
    scene: SceneFile,
    output: Annotated[
        File, option("Output file (default: out/SCENE/report.html).", "FILE.html", "--output", "-o")
    ] = None,
    fmu: FmuToRun = None,
    keys: Keys = None,
) -> Answer:
    """Run a scene and write a printable HTML report.

    The report contains the inputs, the mechanism, its parameters and their sources, curves, torque converter
    chart, orders, loads, losses, freewheel loads and all warnings. It also contains the command that
    reproduces it.
    """
    from .report.html_report import RECORDED, report_file
    from .viewer.html import checked_path

    path = checked_path(output or OUTPUT_FOLDER / scene.stem / "report.html", "--output")
    read, choice = _read_scene(scene, keys)
    choice_lines = choice.lines() if choice else []
    result, fmu_path = _run_scene(read, fmu, RECORDED)
    options = {"--set": keys or [], "--fmu": [str(fmu)] if fmu else [], "-o": [str(output)] if output else []}
    words = [word for name, values in options.items() for value in values for word in (name, value)]
    line = shlex.join(["inertia-module", "report", str(scene), *words])
    with progress_bar(f"report of {scene.name}") as progress:
        content = report_file(scene, keys or [], result, fmu_path, line, choice_lines, progress)
    return _write_html(scene, "report", path, content, result.warnings)


@command
def tradeoff(
    scene: SceneFile,
    output: OutputFolder = None,
    recommend: Annotated[
        Text, option("Recommend the cheapest level that meets this error, e.g. 1%.", "ERROR")
    ] = None,
    keys: Keys = None,
) -> Answer:
    """Compare accuracy and run time of the fidelity levels.

    Runs a scene at the levels that fidelity auto selects from. Writes
    tradeoff.csv and tradeoff.png. Default output folder: out/tradeoff.
    """
    from .fidelity import choice as levels
    from .fidelity.level_table import print_levels
    from .fidelity.measure import trial_rows
    from .fidelity.rows import failure_lines, write_rows
    from .plots.fidelity import work_precision

    with progress_bar("comparing the fidelity levels") as progress:
        folder = writable_folder(output or OUTPUT_FOLDER / "tradeoff")
        allowed = quantity_of("--recommend", recommend, "1", maximum=1.0, above=0.0)
        read = inertia_module.load_scene(scene, keys)
        title, names = read.title, read.run.outputs
        rows = trial_rows(read, progress)
        choice = levels.recommend(rows, allowed, names) if allowed else None
        files = {"rows": write_rows(folder / "tradeoff.csv", rows)}
        figure = work_precision(rows, names, title)
        files["picture"] = write_figure(folder / "tradeoff.png", figure)

    parts: list[Shown] = [partial(print_levels, title, rows, names, allowed or 0.01)]
    parts += failure_lines(rows)
    parts += [] if choice is None else choice.lines()
    data: dict[str, Any] = {"title": title, "rows": [row.as_dict() for row in rows]}
    return Answer(data | ({} if choice is None else {"recommendation": choice.as_dict()}), parts, files)


@command
def chart(
    scenes: Annotated[list[Path], typer.Argument(metavar="SCENE.toml...", help="Scenes to compare.")],
    output: OutputFolder = None,
    speed: Annotated[
        Text,
        option("Input speed of the chart and of the torque converter tables, e.g. '3000 rpm'.", "SPEED"),
    ] = None,
    mapped: Annotated[
        bool,
        option(
            "Also write torque converter tables, and maps over speed ratio and input speed.",
            None,
            "--map",
        ),
    ] = False,
    keys: Keys = None,
) -> Answer:
    """Draw the torque converter charts of one or more scenes.

    Writes one CSV file per scene and one figure. With losses, a chart applies to one input speed (--speed).
    The figure then also shows the efficiency over speed ratio and input speed. Default output folder:
    out/chart.
    """
    from .analysis import converter_chart as steady

    folder = writable_folder(output or OUTPUT_FOLDER / "chart")
    names = [scene.stem for scene in scenes]
    if len(set(names)) < len(names):
        raise ValueError(must_be("file names of the scenes", "different", ", ".join(names)))
    omega1 = None if speed is None else speed_of(speed)
    reference_speed, unit = (
        omega1 or steady.NOMINAL_SPEED,
        (split_quantity(speed)[1] if speed else "") or "rad/s",
    )
    read = {scene.stem: inertia_module.load_scene(scene, keys) for scene in scenes}
    make = partial(inertia_module.torque_converter_chart, omega1=reference_speed, engagements=True)
    charts = {name: make(scene.parameters()) for name, scene in read.items()}
    with_losses = [name for name, result in charts.items() if not result.lossless]
    files, parts, maps, allowed = list[Path](), list[Shown](), {}, {}
    limits_of_drives = {name: scene.drive_torque_limit(reference_speed) for name, scene in read.items()}
    drive_warnings = [
        f"{name}: {beyond}"
        for name, limit in limits_of_drives.items()
        if omega1 is not None
        and limit is not None
        and (beyond := charts[name].beyond_drive(reference_speed, limit))
    ]
    data: dict[str, Any] = {"omega1": omega1, "charts": {}, "units": {}}
    for name, result in charts.items():
        machine = steady.SteadyMachine(read[name].parameters())
        files.append(result.save(folder / f"{name}.csv"))
        if mapped or name in with_losses:
            with progress_bar(f"map of {name}") as progress:
                maps[name] = steady.steady_map(machine, reference_speed, progress)
            files += steady.save_map(maps[name], folder / f"{name}_map", unit, mapped)
        if mapped or omega1 is not None:
            table = steady.converter_table(machine, result, reference_speed)
            files += steady.save_converter(table, reference_speed, folder / f"{name}_converter")
        limits = read[name].freewheels.of("indexing_frequency")
        if limits:
            allowed[name] = min(limits.values()) * math.tau / abs(reference_speed)
        numbers, units = result.summary(omega1, limits), result.units(omega1)
        data["charts"][name], data["units"][name] = numbers, units
        title = f"{name}, losses at {speed_text(reference_speed)}" if name in with_losses else name
        title = f"{name} at {speed_text(omega1)}" if omega1 is not None else title
        rows = {key: f"{value:.6g} {units[key]}".rstrip() for key, value in numbers.items()}
        parts.append((title, {key.replace("_", " "): text for key, text in rows.items()}))
    loss_maps = {name: maps[name] for name in with_losses}
    figure = inertia_module.chart_figure(charts, loss_maps, unit, allowed, omega1)
    files.append(write_figure(folder / "chart.png", figure))

    if mapped:
        parts.append(f"maps up to {speed_text(reference_speed)}, the reference speed of the converter tables")
    file_names = [str(file) for file in files]
    return Answer(
        {**data, "files": file_names, "warnings": drive_warnings},
        [*parts, *file_names],
        warnings=drive_warnings,
    )


# --- engineering tasks ---


@command
def orders(
    scene: SceneFile,
    output: OutputFolder = None,
    of: Annotated[
        str, option("Reference angle: link1 (carrier) or drive_angle (pinion shaft).", "ANGLE")
    ] = "link1",
    signals: Annotated[Texts, option("Output to analyse; may be repeated.", "NAME", "--signal")] = None,
    highest: Annotated[float | None, option("Maximum order.", "ORDER")] = None,
    turns: Annotated[
        float | None, option("Window length in revolutions (order resolution = 1/N).", "N")
    ] = None,
    begin: Annotated[
        Text,
        option(
            "Start of the analysed interval, e.g. '2 s' (default: link 1 begins to rotate).", "TIME", "--from"
        ),
    ] = None,
    end: Annotated[
        Text, option("End of the analysed interval (default: end of the run).", "TIME", "--to")
    ] = None,
    hz: Annotated[bool, option("Print and plot frequencies in Hz and speeds in rpm.", None, "--hz")] = False,
    mat: Annotated[bool, option("Also write complex amplitudes to orders.mat.", None, "--mat")] = False,
    uff: Annotated[
        bool, option("Also write complex amplitudes to orders.uff (data set 58).", None, "--uff")
    ] = False,
    fmu: FmuToRun = None,
    keys: Keys = None,
) -> Answer:
    """Run an order analysis of a scene.

    Analyses torques, speeds and forces. Writes orders.csv, waterfall.csv (spectra over the run),
    summary.json and orders.png. Default output folder: out/orders/SCENE.
    """
    from .common.extras import library
    from .plots.studies import order_figure
    from .scene.reading import speed_unit
    from .studies.order_analysis import BASES

    folder = writable_folder(output or OUTPUT_FOLDER / "orders" / scene.stem)
    if uff:
        library("pyuff", "studies")  # before the run
    first, last = quantity_of("--from", begin, "s"), quantity_of("--to", end, "s")
    read = inertia_module.load_scene(scene, keys)
    with progress_bar(read.title) as progress:
        result = inertia_module.orders(
            read,
            fmu,
            of=of,
            signals=signals,
            highest=highest,
            turns=turns,
            begin=first,
            end=last,
            progress=progress,
        )
    unit, files = speed_unit(scene, keys), result.write(folder)
    files |= {"mat": result.write_mat(folder / "orders.mat")} if mat else {}
    files |= {"uff": result.write_uff(folder / "orders.uff")} if uff else {}
    files["picture"] = write_figure(folder / "orders.png", order_figure(result, read.title, hz, unit))

    parts: list[Shown] = [f"{read.title}: largest orders, cycles per {BASES[of]}"]
    if result.step < read.run.communication_step * (1.0 - 1e-9):
        steps = f"{result.step * 1e3:.3g} ms instead of {read.run.communication_step * 1e3:.3g} ms"
        parts.append(f"recorded in steps of {steps}, for orders up to {result.highest:.4g} without aliases")
    for name, lines in result.lines(hz=hz, speed_unit=unit).items():
        constant = {"no order": f"0 {result.units[name]}, constant"}
        parts.append((name.replace("_", " "), lines or constant))
    return Answer({"scene": str(scene), **result.as_dict()}, parts, files)


@command
def fit(
    measured: Annotated[
        Path, typer.Argument(metavar="MEASURED.csv", help="Measured data over time, units in the headings.")
    ],
    scene: SceneFile,
    free: Annotated[
        Texts,
        option(
            "Free parameter; may be repeated. NAME is a key of the scene in dot notation, a parameter of the"
            " mechanism, a sensor error (offset.COLUMN, gain.COLUMN, shift.COLUMN) or shift.time. RANGE is"
            " LOW:HIGH, log:LOW:HIGH or 'VALUE +- DEVIATION' (default: start at the value in the scene).",
            "NAME[=RANGE]",
        ),
    ] = None,
    columns: Annotated[
        Texts,
        option(
            "Column of MEASURED.csv to compare (default: all that the scene computes); may be repeated.",
            "NAME",
            "--column",
        ),
    ] = None,
    starts: Annotated[
        int,
        option(
            "Number of points in the ranges that are compared with the values of the scene. The best three"
            " points start a search.",
            "N",
        ),
    ] = 16,
    seed: Annotated[
        int, option("Random seed of the starting points; the same seed gives the same result.", "N")
    ] = 0,
    output: OutputFolder = None,
    fmu: FmuToRun = None,
    keys: Keys = None,
) -> Answer:
    """Fit scene parameters to measured data.

    Prints the fitted values with their 95 % intervals, parameters that the data do not identify, and
    causes that would explain the residuals. Writes fitted.toml (a scene), residuals.csv, fit.json and
    fit.png. Default output folder: out/SCENE_fit.

    RANGE is one of:

    LOW:HIGH, the range of the search, with starting points even in the value, e.g. 0.5:2 or '10 g:1 kg'.

    log:LOW:HIGH, the same range, with starting points even in the logarithm, for values that can differ by
    factors of ten, e.g. log:1e-4:1e-1; LOW must be greater than 0.

    'VALUE +- DEVIATION', a known value and its standard deviation, e.g. '0.5 +- 0.005'. A deviation of 0
    declares the value exact.

    Without RANGE the search starts from the value in the scene and has no limits except the physical ones.
    """
    folder = writable_folder(output or OUTPUT_FOLDER / f"{scene.stem}_fit")
    with progress_bar(f"fit to {measured.name}") as progress:
        result = inertia_module.fit(
            measured,
            inertia_module.load_scene(scene, keys),
            free or [],
            columns=columns or [],
            starts=starts,
            seed=seed,
            output=folder,
            fmu=fmu,
            progress=progress,
        )
    files = {**result.files, "picture": write_figure(folder / "fit.png", inertia_module.fit_figure(result))}

    parts: list[Shown] = [
        (f"{result.scene.title}: fitted values with 95 % intervals", result.lines()),
        ("fixed parameters, released one at a time", result.candidate_lines()),
    ]
    parts += [f"warning: {warning}" for warning in result.warnings]
    return Answer({"measured": str(measured), "scene": str(scene), **result.as_dict()}, parts, files)


@command
def sweep(
    scene: SceneFile,
    vary: Annotated[
        Texts,
        option(
            "Key and its values: FROM:TO:COUNT, log:FROM:TO:COUNT or A,B,C; may be repeated.", "NAME=RANGE"
        ),
    ] = None,
    sample: Annotated[
        Text, option("Samples instead of a grid, e.g. latin:200 or sobol:256.", "KIND:COUNT")
    ] = None,
    sensitivity: Annotated[
        int | None, option("Sobol indices from N * (number of keys + 2) runs; N must be a power of 2.", "N")
    ] = None,
    figure: Annotated[Texts, option("Summary metric to plot; may be repeated.", "NAME")] = None,
    seed: Annotated[int, option("Random seed of the samples.", "N")] = 0,
    output: OutputFolder = None,
    keys: Keys = None,
    fmu: FmuToRun = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> Answer:
    """Run a parameter sweep.

    Writes sweep.parquet, sweep.csv and plot.png. Completed runs are stored in journal.jsonl and reused.
    Default output folder: out/SCENE_sweep.
    """
    from .plots.studies import sweep_figure

    folder = writable_folder(output or OUTPUT_FOLDER / f"{scene.stem}_sweep")
    with progress_bar(f"sweep of {scene.name}") as progress:
        result = inertia_module.sweep(
            inertia_module.load_scene(scene, keys),
            vary or [],
            sample=sample,
            sensitivity=sensitivity,
            seed=seed,
            output=folder,
            fmu=fmu,
            scheduler=scheduler,
            workers=workers,
            progress=progress,
        )
    files = {**result.files, "plot": write_figure(folder / "plot.png", sweep_figure(result, figure or ()))}
    numbers = {"rows": len(result.rows), "new": result.new, "refused": len(result.refused)}

    runs = len(result.rows)
    counts = {"runs": f"{runs} ({result.new} new)", "failed": str(len(result.refused))}
    parts: list[Shown] = [(f"sweep of {scene.name}", counts)]
    parts += [f"first failure: {row.point}: {row.refused}" for row in result.refused[:1]]
    parts += [f"{name}: not reached in {count} of {runs} runs" for name, count in result.unreached.items()]
    return Answer({"scene": str(scene), **numbers, "unreached": result.unreached}, parts, files)


@command
def design(
    spec: Annotated[
        Path,
        typer.Argument(metavar="SPEC.toml", help="Specification: a scene with tables [free] and [figures]."),
    ],
    output: OutputFolder = None,
    keys: Keys = None,
    fmu: FmuToRun = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> Answer:
    """Optimise a design under constraints.

    Writes pareto.csv, checked.csv (and .parquet), plot.png and each verified design as a scene
    (design_1.toml, ...). Default output folder: out/SPEC_design.
    """
    from .studies.design_search import read_spec

    folder = writable_folder(output or OUTPUT_FOLDER / f"{spec.stem}_design")
    with progress_bar(f"design of {spec.name}") as progress:
        result = inertia_module.design(
            read_spec(spec, keys),
            output=folder,
            fmu=fmu,
            scheduler=scheduler,
            workers=workers,
            progress=progress,
        )
    files = {**result.files, "plot": write_figure(folder / "plot.png", inertia_module.design_figure(result))}
    files |= {finalist.file.stem.replace("_", " "): finalist.file for finalist in result.finalists}

    parts: list[Shown] = [
        (finalist.file.stem.replace("_", " "), result.lines(finalist)) for finalist in result.finalists
    ]
    parts.append(result.verdict())
    numbers = {"designs": len(result.rows), "new": result.new, "chosen": len(result.chosen)}
    return Answer({"spec": str(spec), **numbers, "verdict": result.verdict()}, parts, files)


# --- the program ---

app = typer.Typer(
    context_settings={"help_option_names": ["-h", "--help"]},
    no_args_is_help=True,
    rich_markup_mode=None,  # Rich markup would remove "[free]" from the help
    pretty_exceptions_enable=False,
)
# commands in the order of work, each with an example
EXAMPLES = {
    new: "new planar",
    run: "run planar.toml --set imbalance_mass='1 kg'",
    view: "view planar.toml --open",
    report: "report planar.toml -o planar.html",
    chart: "chart planar.toml reference.toml --speed '3000 rpm'",
    orders: "orders orders.toml --highest 8",
    sweep: "sweep planar.toml --vary imbalance_mass=0.5:2:7",
    design: "design design_car.toml",
    fit: "fit fit_rig.csv fit_rig.toml --free imbalance_mass=0.5:2",
    tradeoff: "tradeoff planar.toml --recommend 1%",
    export: "export planar.toml",
    check: "check InertiaModule.fmu --timeout '5 min'",
    build: "build -o build",
}
for work, example in EXAMPLES.items():
    app.command(epilog=f"\b\nExample:\n  inertia-module {example}")(work)


def _print_version(is_requested: bool) -> None:
    if is_requested:
        typer.echo(f"inertia-module {inertia_module.__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, option("Print the version.", None, "--version", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """Inertia module: an inertial torque transformer as an FMI 2.0 or 3.0 co-simulation FMU."""


STANDARD_OUTPUT = "standard output"


def replace_closed_streams() -> None:
    """Replace each closed standard stream by a stream to the null device.

    Otherwise the next opened file would get its descriptor. Writing to the standard output then fails; text
    for the error output is discarded.
    """
    readable, writable = os.O_RDONLY, os.O_WRONLY
    streams = (("stdin", readable, "r"), ("stdout", readable, "w"), ("stderr", writable, "w"))
    for name, flags, mode in streams:
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, flags), mode, encoding="utf-8"))


def main() -> None:
    """Run the command line (entry point of the console script).

    The process ends without the destructors of its libraries, because the destructor of pythonfmu 0.7 uses
    freed memory and can abort a successful run.
    """
    for name in ("SIGTERM", "SIGHUP"):  # exit normally, so that temporary files are removed
        kind = getattr(signal, name, None)  # None on Windows; nohup ignores SIGHUP
        if kind is not None and signal.getsignal(kind) is not signal.SIG_IGN:
            signal.signal(kind, lambda number, _: sys.exit(128 + number))
    replace_closed_streams()
    code: object = 0
    try:
        app()
    except SystemExit as leave:
        code = leave.code
    except KeyboardInterrupt:
        aside("stopped")
        code = 128 + signal.SIGINT
    except OSError as error:  # of the help, which is printed before any command runs
        error.filename = STANDARD_OUTPUT
        aside(f"error: {sentence_of(error)}")
        code = 1
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError):
            stream.flush()
    os._exit(code if isinstance(code, int) else int(code is not None))
