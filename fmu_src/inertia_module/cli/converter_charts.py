"""Command that draws torque converter charts: chart."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

import inertia_module

from ..common.errors import must_be
from ..common.files import OUTPUT_FOLDER, writable_folder, write_figure
from ..common.terminal import progress_bar
from ..common.units import split_quantity
from .answer import Answer, Shown, command
from .options import Keys, OutputFolder, Text, option, speed_of, speed_text


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
    from ..analysis import converter_chart as steady

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
