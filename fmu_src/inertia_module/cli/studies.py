"""Commands that run a scene many times or analyse it: orders, sweep, design, fit, tradeoff."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

import inertia_module

from ..common.files import OUTPUT_FOLDER, writable_folder
from ..common.terminal import progress_bar
from ..common.units import printed_unit
from .answer import Answer, OutputPart, command, indented
from .figure_files import FORMATS, FigureFormat, FigurePanel, figure_path, write_picture
from .options import (
    FmuToRun,
    Keys,
    OutputFolder,
    SceneFile,
    Scheduler,
    Text,
    Texts,
    Workers,
    check_choice,
    enumeration,
    option,
    quantity_of,
    values_of,
)

# reference angles of an order analysis, repeated here because the import of order_result slows down the help
REFERENCE_ANGLES = ("link1", "drive_angle")


@command
def orders(
    scene: SceneFile,
    output: OutputFolder = None,
    of: Annotated[
        str,
        enumeration("Reference angle: carrier (link1) or pinion shaft (drive_angle).", REFERENCE_ANGLES),
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
    fmu: FmuToRun = None,
    keys: Keys = None,
    file_format: FigureFormat = FORMATS[0],
    panel: FigurePanel = None,
) -> Answer:
    """Run an order analysis of a scene.

    Analyses torques, speeds and forces. Writes orders.csv, waterfall.csv (spectra over the run),
    summary.json and orders.png. Default output folder: out/orders/SCENE.
    """
    from ..plots.studies import order_figure
    from ..scene.reading import display_units
    from ..studies.order_result import BASES

    check_choice("reference angle", of, REFERENCE_ANGLES)
    folder = writable_folder(output or OUTPUT_FOLDER / "orders" / scene.stem)
    path = figure_path(folder, "orders", file_format)
    first, last = quantity_of("--from", begin, "s"), quantity_of("--to", end, "s")
    loaded = inertia_module.load_scene(scene, values_of(keys))
    with progress_bar(loaded.title) as progress:
        result = inertia_module.orders(
            loaded,
            fmu,
            of=of,
            signals=signals,
            highest=highest,
            turns=turns,
            begin=first,
            end=last,
            progress=progress,
        )
    unit = display_units(scene, values_of(keys)).get("rad/s", "rad/s")
    files = result.write(folder)
    files |= {"mat": result.write_mat(folder / "orders.mat")} if mat else {}
    files["picture"] = write_picture(path, order_figure(result, loaded.title, hz, unit), panel)

    parts: list[OutputPart] = [f"{loaded.title}: largest orders, cycles per {BASES[of]}"]
    if result.step < loaded.run.communication_step * (1.0 - 1e-9):
        steps = f"{result.step * 1e3:.3g} ms instead of {loaded.run.communication_step * 1e3:.3g} ms"
        parts.append(f"recorded in steps of {steps}, for orders up to {result.highest:.4g} without aliases")
    for name, lines in result.lines(hz=hz, speed_unit=unit).items():
        constant = {"no order": f"0 {printed_unit(result.units[name])}, constant"}
        parts.append((name.replace("_", " "), lines or constant))
    return Answer({"scene": str(scene), **result.as_dict()}, parts, files)


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
    metric: Annotated[Texts, option("Summary metric to plot; may be repeated.", "NAME")] = None,
    figure: Annotated[Texts, option("Former name of --metric.", "NAME", hidden=True)] = None,
    seed: Annotated[int, option("Random seed of the samples.", "N")] = 0,
    output: OutputFolder = None,
    keys: Keys = None,
    file_format: FigureFormat = FORMATS[0],
    panel: FigurePanel = None,
    fmu: FmuToRun = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> Answer:
    """Run a parameter sweep.

    Writes sweep.parquet, sweep.csv and plot.png. Completed runs are stored in journal.jsonl and reused.
    Default output folder: out/SCENE_sweep.
    """
    from ..plots.studies import sweep_figure
    from ..studies.axes import ranges_from_options

    folder = writable_folder(output or OUTPUT_FOLDER / f"{scene.stem}_sweep")
    path = figure_path(folder, "plot", file_format)
    with progress_bar(f"sweep of {scene.name}") as progress:
        result = inertia_module.sweep(
            inertia_module.load_scene(scene, values_of(keys)),
            ranges_from_options(vary or []),
            sample=sample,
            sensitivity=sensitivity,
            seed=seed,
            output=folder,
            fmu=fmu,
            scheduler=scheduler,
            workers=workers,
            progress=progress,
        )
    metrics = [*(metric or ()), *(figure or ())]
    files = {**result.files, "plot": write_picture(path, sweep_figure(result, metrics), panel)}
    numbers = {"rows": len(result.rows), "new": result.new, "refused": len(result.refused)}

    runs = len(result.rows)
    counts = {"runs": f"{runs} ({result.new} new)", "failed": str(len(result.refused))}
    parts: list[OutputPart] = [(f"sweep of {scene.name}", counts)]
    parts += [f"first failure: {row.point}: {row.refused}" for row in result.refused[:1]]
    parts += [f"{name}: not reached in {count} of {runs} runs" for name, count in result.unreached.items()]
    return Answer({"scene": str(scene), **numbers, "unreached": result.unreached}, parts, files)


@command
def design(
    spec: Annotated[
        Path,
        typer.Argument(metavar="SPEC.toml", help="Specification: a scene with tables [free] and [metrics]."),
    ],
    output: OutputFolder = None,
    keys: Keys = None,
    file_format: FigureFormat = FORMATS[0],
    panel: FigurePanel = None,
    fmu: FmuToRun = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> Answer:
    """Optimise a design under constraints.

    Writes pareto.csv, checked.csv (and .parquet), plot.png and each verified design as a scene
    (design_1.toml, ...). Default output folder: out/SPEC_design.
    """
    from ..studies.design_specification import read_spec

    folder = writable_folder(output or OUTPUT_FOLDER / f"{spec.stem}_design")
    path = figure_path(folder, "plot", file_format)
    with progress_bar(f"design of {spec.name}") as progress:
        result = inertia_module.design(
            read_spec(spec, values_of(keys)),
            output=folder,
            fmu=fmu,
            scheduler=scheduler,
            workers=workers,
            progress=progress,
        )
    files = {**result.files, "plot": write_picture(path, inertia_module.design_figure(result), panel)}
    files |= {finalist.file.stem.replace("_", " "): finalist.file for finalist in result.finalists}

    parts: list[OutputPart] = [
        (finalist.file.stem.replace("_", " "), result.lines(finalist)) for finalist in result.finalists
    ]
    parts.append(result.verdict())
    numbers = {"designs": len(result.rows), "new": result.new, "chosen": len(result.chosen)}
    return Answer({"spec": str(spec), **numbers, "verdict": result.verdict()}, parts, files)


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
    file_format: FigureFormat = FORMATS[0],
    panel: FigurePanel = None,
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
    from ..studies.axes import ranges_from_options

    folder = writable_folder(output or OUTPUT_FOLDER / f"{scene.stem}_fit")
    path = figure_path(folder, "fit", file_format)
    with progress_bar(f"fit to {measured.name}") as progress:
        result = inertia_module.fit(
            measured,
            inertia_module.load_scene(scene, values_of(keys)),
            ranges_from_options(free or []),
            columns=columns or [],
            starts=starts,
            seed=seed,
            output=folder,
            fmu=fmu,
            progress=progress,
        )
    files = {**result.files, "picture": write_picture(path, inertia_module.fit_figure(result), panel)}

    parts: list[OutputPart] = [
        (f"{result.scene.title}: fitted values with 95 % intervals", result.lines()),
        ("fixed parameters, released one at a time", result.candidate_lines()),
    ]
    parts += [f"warning: {warning}" for warning in result.warnings]
    return Answer({"measured": str(measured), "scene": str(scene), **result.as_dict()}, parts, files)


@command
def tradeoff(
    scene: SceneFile,
    output: OutputFolder = None,
    recommend: Annotated[
        Text, option("Recommend the cheapest level that meets this error, e.g. 1%.", "ERROR")
    ] = None,
    keys: Keys = None,
    file_format: FigureFormat = FORMATS[0],
    panel: FigurePanel = None,
) -> Answer:
    """Compare accuracy and run time of the fidelity levels.

    Runs a scene at the levels that fidelity auto selects from. Writes tradeoff.csv and tradeoff.png.
    Default output folder: out/tradeoff.
    """
    from ..fidelity import choice as levels
    from ..fidelity.level_table import print_levels
    from ..fidelity.measure import trial_rows
    from ..fidelity.rows import failure_lines, write_rows
    from ..plots.fidelity import work_precision

    with progress_bar("comparing the fidelity levels") as progress:
        folder = writable_folder(output or OUTPUT_FOLDER / "tradeoff")
        path = figure_path(folder, "tradeoff", file_format)
        allowed = quantity_of("--recommend", recommend, "1", maximum=1.0, above=0.0)
        loaded = inertia_module.load_scene(scene, values_of(keys))
        title, names = loaded.title, loaded.run.outputs
        rows = trial_rows(loaded, progress)
        choice = levels.recommend(rows, allowed, names) if allowed else None
        files = {"rows": write_rows(folder / "tradeoff.csv", rows)}
        figure = work_precision(rows, names, title)
        files["picture"] = write_picture(path, figure, panel)

    parts: list[OutputPart] = [partial(print_levels, title, rows, names, allowed or 0.01)]
    choice_lines = [] if choice is None else choice.lines()
    parts += [line for text in [*failure_lines(rows), *choice_lines] for line in indented(text)]
    data: dict[str, Any] = {"title": title, "rows": [row.as_dict() for row in rows]}
    return Answer(data | ({} if choice is None else {"recommendation": choice.as_dict()}), parts, files)
