"""Commands that run a scene: run, view, report."""

from __future__ import annotations

import json
import shlex
import webbrowser
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import inertia_module

from ..common.errors import must_be
from ..common.files import OUTPUT_FOLDER, writable_folder, write_atomically
from ..common.terminal import progress_bar, terminal
from .answer import Answer, command, indented
from .figure_files import FORMATS, FigureFormat, FigurePanel, figure_path, write_picture
from .options import (
    FIDELITIES,
    File,
    FmuToRun,
    Keys,
    OutputFolder,
    SceneFile,
    Text,
    Texts,
    check_choice,
    enumeration,
    option,
    quantity_of,
    values_of,
)

if TYPE_CHECKING:
    from ..fidelity.choice import Choice
    from ..scene import Scene, SceneResult, ShaftScene

# minimum width of the summary on a narrow terminal, characters
MIN_WIDTH = 40


@command
def run(
    scene: SceneFile,
    output: OutputFolder = None,
    fidelity: Annotated[
        Text, enumeration("Fidelity level; auto selects the fastest level that meets --error.", FIDELITIES)
    ] = None,
    error: Annotated[
        Text, option("Maximum error of the outputs for fidelity auto, e.g. 1%.", "ERROR")
    ] = None,
    fmu: FmuToRun = None,
    view: Annotated[bool, option("Also write the viewer to page.html (see view).", None, "--view")] = False,
    all_metrics: Annotated[
        bool, option("Print every metric, with six digits in SI units.", None, "--all")
    ] = False,
    keys: Keys = None,
    file_format: FigureFormat = FORMATS[0],
    panel: FigurePanel = None,
) -> Answer:
    """Run a scene and write its table, summary and plot.

    Prints warnings and a summary in the units of the scene. Writes table.csv, summary.json (all metrics) and
    plot.png. Default output folder: out/SCENE.
    """
    from ..interface.variables import COMPUTED
    from ..scene import Scene
    from ..scene.reading import display_units
    from ..viewer.html import html_file, template

    check_choice("fidelity", fidelity, FIDELITIES)
    folder = writable_folder(output or OUTPUT_FOLDER / scene.stem)
    path = figure_path(folder, "plot", file_format)
    if view:
        template()
    loaded, choice = _read_scene(scene, keys, fidelity, error, view)
    result, _ = _run_scene(loaded, fmu, COMPUTED if view else ())
    page = html_file(result.scene, result) if view and isinstance(result.scene, Scene) else None
    choice_data = {} if choice is None else {"fidelity_choice": choice.as_dict()}
    data = {"scene": str(scene), **result.as_dict(), **choice_data}
    files = {
        "table": result.table.to_csv(folder / "table.csv"),
        "summary": write_atomically(folder / "summary.json", f"{json.dumps(data, indent=2)}\n".encode()),
        "plot": write_picture(path, inertia_module.scene_figure(result), panel),
    }
    if page is not None:
        files["page"] = write_atomically(folder / "page.html", page)

    choice_lines = [] if choice is None else [line for text in choice.lines() for line in indented(text)]
    if all_metrics:
        return Answer(data, [(loaded.title, result.lines()), *choice_lines], files, warnings=result.warnings)
    summary_part = partial(_print_summary, result, display_units(scene, values_of(keys)))
    return Answer(data, [summary_part, *choice_lines], files)


def _print_summary(result: SceneResult, units: Mapping[str, str]) -> None:
    """Print the summary of a run, with its warnings in colour on a terminal.

    Args:
        result: Result of the run.
        units: Display units, by unit of a metric.
    """
    from ..scene.summary_text import WIDTH, summary

    console = terminal()
    text = summary(result, units, max(min(WIDTH, console.width), MIN_WIDTH))
    for lines, style in ((text.title, "bold"), (text.warnings, "red"), (text.body, None)):
        for line in lines:
            console.print(line, style=style, soft_wrap=True)


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
    from ..fmu.builder import current_fmu
    from ..scene import ShaftScene, run_shaft_scene

    path = fmu or current_fmu("DrivenShaft" if isinstance(scene, ShaftScene) else "InertiaModule")
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
    from ..fidelity.choice import choose
    from ..scene import Scene, load_any_scene

    loaded = load_any_scene(scene, values_of(keys))
    if not isinstance(loaded, Scene):
        if view or fidelity is not None or error is not None:
            raise ValueError("--fidelity, --error and --view require a scene of the module")
        return loaded, None
    allowed = quantity_of("--error", error, "1", maximum=1.0, above=0.0)
    if fidelity is not None or (allowed is not None and loaded.chooses_fidelity):
        loaded = loaded.with_fidelity(fidelity or "auto", allowed)
    if not loaded.chooses_fidelity:
        if allowed is not None:
            raise ValueError(f"--error = {error} requires fidelity auto")
        return loaded, None
    with progress_bar("measuring the fidelity levels") as progress:
        return choose(loaded, progress)


@command
def view(
    scene: SceneFile,
    output: Annotated[
        File, option("Output file (default: out/SCENE/page.html).", "FILE.html", "--output", "-o")
    ] = None,
    open_browser: Annotated[bool, option("Open the file in the browser.", None, "--open")] = False,
    fmu: FmuToRun = None,
    keys: Keys = None,
) -> Answer:
    """Write the interactive 3-D viewer of a scene (one HTML file).

    The viewer contains the kernel and runs in a browser. Scenes with a controller, or with a load that
    depends on the motion, are simulated first and replayed.
    """
    from ..interface.variables import COMPUTED
    from ..scene import Scene
    from ..viewer.html import checked_path, html_file, is_exact, template

    path = checked_path(output or OUTPUT_FOLDER / scene.stem / "page.html", "--output")
    template()
    loaded, _ = _read_scene(scene, keys)
    if not isinstance(loaded, Scene):
        raise ValueError(must_be(scene.name, "a scene of the module", "a driven shaft"))
    outcome = None
    if not is_exact(loaded):
        outcome, _ = _run_scene(loaded, fmu, COMPUTED)
    answer = _write_html(scene, "page", path, html_file(loaded, outcome), outcome.warnings if outcome else ())
    if open_browser:
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
    from ..report.html_report import RECORDED, report_file
    from ..viewer.html import checked_path

    path = checked_path(output or OUTPUT_FOLDER / scene.stem / "report.html", "--output")
    loaded, choice = _read_scene(scene, keys)
    choice_lines = choice.lines() if choice else []
    result, fmu_path = _run_scene(loaded, fmu, RECORDED)
    options = {"--set": keys or [], "--fmu": [str(fmu)] if fmu else [], "-o": [str(output)] if output else []}
    words = [word for name, values in options.items() for value in values for word in (name, value)]
    line = shlex.join(["inertia-module", "report", str(scene), *words])
    with progress_bar(f"report of {scene.name}") as progress:
        content = report_file(scene, values_of(keys), result, fmu_path, line, choice_lines, progress)
    return _write_html(scene, "report", path, content, result.warnings)
