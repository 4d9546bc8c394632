"""Command that draws torque converter charts: chart."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import inertia_module

from ..common.errors import must_be
from ..common.files import OUTPUT_FOLDER, writable_folder
from ..common.terminal import progress_bar
from ..common.units import printed_unit, split_quantity
from .answer import Answer, OutputPart, command, file_lines
from .figure_files import FORMATS, FigureFormat, FigurePanel, figure_path, write_picture
from .options import Keys, OutputFolder, Text, option, speed_of, speed_text, values_of

if TYPE_CHECKING:
    from ..analysis.converter_chart import TorqueConverterChart
    from ..analysis.steady_state import Array
    from ..scene import Scene


@command
def chart(
    scenes: Annotated[list[Path], typer.Argument(metavar="SCENE.toml...", help="Scenes to compare.")],
    output: OutputFolder = None,
    speed: Annotated[
        Text,
        option("Input speed of the chart and of the torque converter tables, e.g. '3000 rpm'.", "SPEED"),
    ] = None,
    with_map: Annotated[
        bool,
        option(
            "Also write torque converter tables, and maps over speed ratio and input speed.",
            None,
            "--map",
        ),
    ] = False,
    keys: Keys = None,
    file_format: FigureFormat = FORMATS[0],
    panel: FigurePanel = None,
) -> Answer:
    """Draw the torque converter charts of one or more scenes.

    Writes one CSV file per scene and one figure. With losses, a chart applies to one input speed (--speed).
    The figure then also shows the efficiency over speed ratio and input speed. Default output folder:
    out/chart.
    """
    from ..analysis.converter_chart import NOMINAL_SPEED

    folder = writable_folder(output or OUTPUT_FOLDER / "chart")
    path = figure_path(folder, "chart", file_format)
    names = [scene.stem for scene in scenes]
    if len(set(names)) < len(names):
        raise ValueError(must_be("file names of the scenes", "different", ", ".join(names)))
    omega1 = None if speed is None else speed_of(speed)
    unit = (split_quantity(speed)[1] if speed else "") or "rad/s"
    reference_speed = omega1 or NOMINAL_SPEED
    loaded = {scene.stem: inertia_module.load_scene(scene, values_of(keys)) for scene in scenes}
    make = partial(inertia_module.torque_converter_chart, omega1=reference_speed, engagements=True)
    charts = {name: make(scene.parameters()) for name, scene in loaded.items()}
    warnings = [] if omega1 is None else list(_drive_warnings(loaded, charts, omega1))

    files, parts, maps = list[Path](), list[OutputPart](), dict[str, dict[str, Any]]()
    data: dict[str, Any] = {"omega1": omega1, "charts": {}, "units": {}}
    for name, result in charts.items():
        files.append(result.save(folder / f"{name}.csv"))
        tables, chart_map = _write_tables(
            loaded[name], result, folder / name, reference_speed, unit, with_map, omega1 is not None
        )
        files += tables
        maps |= {name: chart_map} if chart_map and not result.lossless else {}
        numbers = result.summary(omega1, loaded[name].freewheels.of("indexing_frequency"))
        units = result.units(omega1)
        data["charts"][name], data["units"][name] = numbers, units
        title = name if result.lossless else f"{name}, losses at {speed_text(reference_speed)}"
        title = f"{name} at {speed_text(omega1)}" if omega1 is not None else title
        rows = {key: f"{value:.6g} {printed_unit(units[key])}".rstrip() for key, value in numbers.items()}
        parts.append((title, {key.replace("_", " "): text for key, text in rows.items()}))
    allowed = {name: _allowed_engagements(scene, reference_speed) for name, scene in loaded.items()}
    figure = inertia_module.chart_figure(
        charts, maps, unit, {name: limit for name, limit in allowed.items() if limit is not None}, omega1
    )
    files.append(write_picture(path, figure, panel))

    if with_map:
        parts.append(f"maps up to {speed_text(reference_speed)}, the reference speed of the converter tables")
    return Answer(
        {**data, "files": [str(file) for file in files], "warnings": warnings},
        [*parts, *file_lines(files)],
        warnings=warnings,
    )


def _drive_warnings(
    scenes: Mapping[str, Scene], charts: Mapping[str, TorqueConverterChart], omega1: float
) -> Iterator[str]:
    """Yield a warning for each chart that requires more torque than the drive of its scene provides.

    Args:
        scenes: Scenes by name.
        charts: Charts by name of the scene.
        omega1: Input speed of the charts, rad/s.
    """
    for name, scene in scenes.items():
        limit = scene.drive_torque_limit(omega1)
        excess = None if limit is None else charts[name].beyond_drive(omega1, limit)
        if excess:
            yield f"{name}: {excess}"


def _allowed_engagements(scene: Scene, omega1: float) -> float | None:
    """Return the allowed number of engagements per revolution of link 1; None without a limit.

    Args:
        scene: The scene.
        omega1: Input speed, rad/s.
    """
    limits = scene.freewheels.of("indexing_frequency").values()
    return min(limits) * math.tau / abs(omega1) if limits else None


def _write_tables(
    scene: Scene,
    chart: TorqueConverterChart,
    stem: Path,
    omega1: float,
    unit: str,
    with_map: bool,
    has_speed: bool,
) -> tuple[list[Path], dict[str, Array] | None]:
    """Write the map and the torque converter table of a scene.

    Args:
        scene: The scene.
        chart: Chart of the scene.
        stem: Path of the files without their endings.
        omega1: Maximum speed of the map and speed of the table, rad/s.
        unit: Unit of the speeds in the map.
        with_map: True to write all columns of the map, and the table.
        has_speed: True to write the table.

    Returns:
        Paths of the files, and the map; None without losses, unless it is written.
    """
    from ..analysis.chart_files import converter_table, save_converter, save_map, steady_map
    from ..analysis.steady_state import SteadyMachine

    machine, files, chart_map = SteadyMachine(scene.parameters()), list[Path](), None
    if with_map or not chart.lossless:
        with progress_bar(f"map of {stem.name}") as progress:
            chart_map = steady_map(machine, omega1, progress)
        files += save_map(chart_map, stem.with_name(f"{stem.name}_map"), unit, with_map)
    if with_map or has_speed:
        table = converter_table(machine, chart, omega1)
        files += save_converter(table, omega1, stem.with_name(f"{stem.name}_converter"))
    return files, chart_map
