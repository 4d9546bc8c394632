"""Report of a scene as one HTML file, to send or to print.

The first page contains checks, main numbers, one figure and the conditions. The sections after it contain the
results of the commands run, chart and orders, and the command that repeats the report. A section that is not
available for the scene contains the reason.
"""

from __future__ import annotations

import base64
import hashlib
import math
import platform
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import date
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from .. import __version__
from ..analysis.converter_chart import compute_chart
from ..common.errors import InertiaModuleError, ParameterError
from ..common.files import MAX_TEXT_SIZE, picture_of, read_file
from ..common.terminal import Progress
from ..common.units import printed_unit
from ..fmi.instance import read_description
from ..fmu.archive import render_xml
from ..interface.variables import LOST_TO, PARAMETER, Group, with_causality
from ..kernel.codes import ELASTIC
from ..plots.mechanism import mechanism_figure
from ..plots.panels import TITLE_PAD
from ..plots.scenes import scene_figure
from ..plots.studies import N_LABELLED, chart_figure, order_figure, oscillating_signals
from ..scene import Scene, SceneResult
from ..scene.freewheel_loads import DUTY_NOTE, FREEWHEELS
from ..scene.headings import heading
from ..scene.keys import by_dotted_key, in_range
from ..scene.reading import display_units
from ..scene.run import initial_values
from ..scene.summary_metrics import input_speed
from ..scene.summary_text import WIDTH, SummaryWriter, three_digits
from ..scene.vehicle_metrics import TIME_TO
from ..studies.order_analysis import ANGLES, BEARING, SIGNALS, orders
from ..studies.order_result import BASES, LINK1

TEMPLATE = Path(__file__).parent / "templates" / "report.html"
# variables that a run for a report records in addition to the outputs of the scene
RECORDED = (
    *(BEARING.get(name, name) for name in SIGNALS),
    *ANGLES,
    *("satellite_force", "satellite_force_peak", "shaking_moment_x", "shaking_moment_y", "shaking_moment_z"),
    "housing_torque",
)
# resolution of figures; width in inches, at which text is legible on paper; maximum height of a row of panels
DPI, WIDTH_ON_PAPER, ROW_HEIGHT = 190, 9.0, 2.0
# size of the text of legends in the figures of a scene, points
LEGEND_SIZE = 8.0
# maximum number of numbers and of inputs on the first page
MAX_NUMBERS, MAX_INPUTS = 5, 12
# numbers of the first page by importance; TIME_TO is the start of the names of acceleration times
MAIN_NUMBERS = {
    "omega_out_final": "output speed at the end",
    "output_torque_mean": "mean output torque",
    TIME_TO: "",
    "tracking_error_rms": "speed error, RMS",
    "efficiency": "efficiency",
    "output_torque_peak": "peak output torque",
    "satellite_force_peak": "peak force on a satellite bearing",
    "omega_out_maximum": "maximum output speed",
    "input_torque_mean": "mean input torque",
    "driven_acceleration_peak": "peak acceleration of the driven mass",
    "shaft_torque_peak": "peak shaft torque",
    "twist_peak": "peak twist of the shaft",
    "omega_out_peak": "peak speed of the driven mass",
    "energy_in": "energy from the drive",
}
# maximum number of values of a list; of longer lists the report contains the ends
MAX_VALUES = 16


class Part(NamedTuple):
    """Content of a section.

    Attributes:
        texts: Sentences.
        columns: Headings of the table.
        rows: Rows of the table.
        picture: Data URI of a figure; "" for none.
        caption: Caption of the figure.
    """

    texts: Sequence[str] = ()
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[str]] = ()
    picture: str = ""
    caption: str = ""


class Check(NamedTuple):
    """Result of a check on the first page.

    Attributes:
        is_met: True if the check is met.
        text: The check in words.
    """

    is_met: bool
    text: str


def report_file(
    file: Path,
    keys: Mapping[str, object],
    result: SceneResult,
    fmu: Path,
    command: str,
    choice_lines: Sequence[str] = (),
    progress: Progress = lambda fraction: None,
) -> bytes:
    """Make the report of a run.

    Args:
        file: Scene file.
        keys: Values that replace values of the file, by dotted key.
        result: Result of the run; for a module with the variables in RECORDED.
        fmu: FMU file of the run.
        command: Command that repeats the report.
        choice_lines: Lines about the choice of the fidelity.
        progress: Function called with the completed fraction, 0 to 1.

    Returns:
        The HTML file.
    """
    content = read_file(file, MAX_TEXT_SIZE)
    text = content.decode("utf-8-sig")
    units = display_units(file, keys)
    writer = SummaryWriter(result, units, WIDTH)
    inputs, *parameters = _input_sections(result.scene, text, keys).items()
    sections: dict[str, Part] = dict([inputs])
    parts = PARTS | {"Orders": partial(_orders, fmu=fmu, speed_unit=units.get("rad/s", "rad/s"))}
    for number, (title, make) in enumerate(parts.items()):
        progress(number / len(PARTS))
        try:
            sections[title] = make(result)
        except InertiaModuleError as reason:
            sections[title] = Part([f"Not available: {reason}."])
    version, day = f"inertia-module {__version__}", f"{date.today()}"
    origin = {
        "scene file": f"{file.name}, SHA-256 {hashlib.sha256(content).hexdigest()}",
        "FMU": f"{fmu.name} {read_description(fmu, validate=False).guid}",
        "version": f"{version}, Python {platform.python_version()}, {platform.platform()}",
        "date": day,
        "command": command,
    }
    conditions = [
        (key, value.replace("N.m", "N·m").replace("kg.m2", "kg·m²"))
        for key, value, source, *_ in inputs[1].rows
        if source != "default" and key != "run.outputs"
    ]
    answer = {
        "checks": _checks(result, writer, choice_lines),
        "numbers": _main_numbers(result, writer),
        "picture": _picture(_scene_figure(result, rows=2), height=3.4),
        "inputs": conditions[:MAX_INPUTS],
        "more": len(conditions) > MAX_INPUTS,
    }
    page = {
        "scene": result.scene,
        "answer": answer,
        "sections": sections | dict(parameters),
        "origin": origin,
        "text": text,
        "head": {
            "title": _css_text(result.scene.title),
            "version": _css_text(f"{file.name}, {day}, {version}"),
        },
    }
    return render_xml(TEMPLATE, page)


def _scene_figure(result: SceneResult, rows: int | None = None) -> Figure:
    """Return the figure of a scene with short titles, because other parts of the report have the numbers.

    Args:
        result: Result of the run.
        rows: Maximum number of rows of panels; None for all.
    """
    figure = scene_figure(result, rows)
    for axes in figure.axes:
        title = axes.get_title(loc="left").partition(": output")[0].partition(" (")[0]
        axes.set_title(title, loc="left", pad=TITLE_PAD)
        legend = axes.get_legend()
        for text in legend.get_texts() if legend else ():
            text.set_fontsize(LEGEND_SIZE)
    return figure


def _picture(figure: Figure, height: float | None = None, row_height: float = ROW_HEIGHT) -> str:
    """Return a figure without its title as a data URI, because the section has a heading.

    Args:
        figure: The figure.
        height: Height, inches; None for the height of its rows of panels.
        row_height: Height of a row of panels, inches.
    """
    figure.suptitle("")
    grids = (axes.get_gridspec() for axes in figure.axes)
    rows = max((grid.nrows for grid in grids if grid is not None), default=1)
    figure.set_size_inches(WIDTH_ON_PAPER, height or row_height * rows)
    figure.set_dpi(DPI)
    return f"data:image/png;base64,{base64.b64encode(picture_of(figure, 'png')).decode()}"


def _with_spaces(name: str) -> str:
    return name.replace("_", " ")


def _css_text(text: str) -> str:
    """Return a text for a string of CSS; all characters except letters, digits and spaces are escaped."""
    return "".join(
        sign if sign.isascii() and (sign.isalnum() or sign == " ") else f"\\{ord(sign):x} " for sign in text
    )


# --- first page ---


def _checks(result: SceneResult, writer: SummaryWriter, choice_lines: Sequence[str]) -> list[Check]:
    """Return the checks of a run: warnings and notes, limits that are met, and the energy balance.

    Args:
        result: Result of the run.
        writer: Writer of the summary, for units.
        choice_lines: Lines about the choice of the fidelity.
    """
    notes = [f"{heading(name)} {text}" for name, text in result.remarks.items() if name != DUTY_NOTE]
    checks = [Check(False, writer.in_display_units(text)) for text in (*result.warnings, *notes)]
    for name, limit in result.limits.items():
        value, unit = result.quantities[name]
        if value <= limit:
            scale = writer.scale(unit, value, limit)
            checks.append(Check(True, f"{heading(name)} {scale.text(value)} (limit {scale.text(limit)})"))
    residual = writer.metrics.get("energy_residual_relative")
    if residual is not None:
        checks.append(Check(True, f"energy balance: relative error {abs(residual):.2g}"))
    return checks + [Check(True, line) for line in choice_lines]


def _main_numbers(result: SceneResult, writer: SummaryWriter) -> list[tuple[str, str]]:
    """Return labels and texts of the main numbers of a run."""
    numbers = []
    for start, label in MAIN_NUMBERS.items():
        names = [start] if start in result.quantities else []
        if start == TIME_TO:
            names = [name for name in result.quantities if name.startswith(TIME_TO)]
        for name in names[:1]:
            value = result.quantities[name].value
            text = f"{three_digits(100.0 * value)} %" if name == "efficiency" else writer.text(name)
            numbers.append((label or heading(name), text))
    return numbers[:MAX_NUMBERS]


# --- inputs ---


def _flat(tables: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted keys and values of nested tables."""
    for name, value in tables.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def _text_of(value: Any) -> str:
    """Return a value of a scene as text: numbers with six digits, of a long list the ends."""
    if isinstance(value, list):
        texts = [_text_of(element) for element in value]
        ends = [*texts[:3], f"… ({len(texts)} in all)", texts[-1]]
        return ", ".join(texts if len(texts) <= MAX_VALUES else ends)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.6g}"
    return re.sub(r"\d+\.\d{6,}", lambda digits: f"{float(digits[0]):.6g}", str(value))


def _input_sections(scene: Any, text: str, keys: Mapping[str, object]) -> dict[str, Part]:
    """Return sections with the keys of a scene, their values and sources.

    Args:
        scene: The scene.
        text: Text of the scene file.
        keys: Values that replace values of the file, by dotted key.

    Returns:
        Section of the inputs, then a section of the model's parameters for each group.
    """
    sources = {key: ("scene file", source_value) for key, source_value in _flat(tomllib.loads(text))}
    sources |= {key: ("--set", source_value) for key, source_value in _flat(by_dotted_key(keys))}

    def source(key: str, value_text: str, default: str) -> str:
        """Return the source of a value, with the text in the source if it differs from the value."""
        table = key.rpartition(".")[0]
        place, source_value = sources.get(key) or sources.get(f"{table}.file") or (default, value_text)
        return place if _text_of(source_value) == value_text else f"{place}: {_text_of(source_value)}"

    is_module = isinstance(scene, Scene)
    table, values = ("mechanism", initial_values(scene)[0]) if is_module else ("shaft", scene.parameters())
    unused_groups = {Group.BEVEL if values.get("layout") else Group.PLANAR}
    unused_groups |= {Group.ELASTIC} if is_module and values.get("fidelity") != ELASTIC else set()
    parameter_keys, rows = set[str](), {group: list[Sequence[str]]() for group in ("", *Group)}
    for variable in with_causality(PARAMETER, table=scene.VARIABLES.values()):
        name, group = variable.name, variable.group
        key = "accuracy.tolerance" if is_module and name == "tolerance" else f"{table}.{name}"
        value = values.get(name, variable.start)
        value_text = _text_of(in_range(variable).written(value))
        origin = source(key, value_text, "default" if value == variable.start else "other keys")
        parameter_keys.add(key)
        if origin != "default" or group not in unused_groups:
            rows[group].append((name, value_text, origin, variable.description))
    for key, value in _flat(scene.model_dump(mode="json", exclude_none=True)):
        if key not in parameter_keys and key.rpartition(".")[2] not in ("title", "description"):
            rows[""].append((key, _text_of(value), source(key, _text_of(value), "default")))
    columns = ("parameter", "value", "source", "meaning")
    parts = {f"Parameters: {group}": Part([], columns, rows[group]) for group in Group if rows[group]}
    note = (
        "A value that differs from its source includes contributions of other keys, such as the inertia of a"
        " load."
    )
    return {"Inputs": Part([note], ("key", "value", "source"), rows[""]), **parts}


# --- results ---


def _summary(result: SceneResult) -> Part:
    """Return the section of the summary, in two columns."""
    lines = list(result.lines().items())
    half = -(-len(lines) // 2)
    pairs = zip_longest(lines[:half], lines[half:], fillvalue=("", ""))
    text = "All metrics of the run in SI units, in the order of summary.json."
    return Part([text], ("number", "value") * 2, [(*left, *right) for left, right in pairs])


def _module(result: SceneResult) -> Scene:
    """Return the scene of a run; reject a scene of a driven shaft."""
    if isinstance(result.scene, Scene):
        return result.scene
    raise ParameterError("the scene is a driven shaft without satellites and freewheels")


def _mechanism(result: SceneResult) -> Part:
    """Return the section with the sketch of one module."""
    text = (
        "One module, to scale. The sketch shows pitch circles or pitch cones; other dimensions are not"
        " parameters."
    )
    picture = _picture(mechanism_figure(_module(result).parameters()), height=3.2)
    return Part(picture=picture, caption=text)


def _curves(result: SceneResult) -> Part:
    """Return the section with the curves of the run."""
    caption = (
        "Results over time. A band is the range of a signal that oscillates faster than the picture resolves."
    )
    return Part(picture=_picture(_scene_figure(result), row_height=1.65), caption=caption)


def _chart(result: SceneResult) -> Part:
    """Return the section with the chart at the maximum speed of link 1 in the run."""
    scene, speeds = _module(result), input_speed(result)
    omega1 = float(speeds[np.abs(speeds).argmax()])
    if omega1 == 0.0:
        raise ParameterError("link 1 does not turn")
    chart = compute_chart(scene.parameters(), omega1, engagements=True)
    limits, units = scene.freewheels.of("indexing_frequency"), chart.units(omega1)
    numbers = chart.summary(omega1, limits).items()
    rows = [(_with_spaces(name), f"{value:.6g} {printed_unit(units[name])}") for name, value in numbers]
    allowed = {"mechanism": min(limits.values()) * math.tau / abs(omega1)} if limits else {}
    figure = chart_figure({"mechanism": chart}, allowed=allowed, omega1=omega1)
    at = f"at the maximum speed of link 1 in the run, {omega1:.5g} rad/s"
    limit = scene.drive_torque_limit(omega1)
    beyond = "" if limit is None else chart.beyond_drive(omega1, limit)
    half = -(-len(rows) // 2)
    pairs = [(*a, *b) for a, b in zip_longest(rows[:half], rows[half:], fillvalue=("", ""))]
    texts = [f"{beyond[0].upper()}{beyond[1:]}."] if beyond else []
    caption = f"Steady-state means over the speed ratio, {at}."
    return Part(texts, ("number", "value") * 2, pairs, _picture(figure), caption)


def _orders(result: SceneResult, fmu: Path | None = None, speed_unit: str = "rad/s") -> Part:
    """Return the section with the main orders from the first to the last revolution of link 1.

    Args:
        result: Result of the run.
        fmu: FMU file of the run, for a run in shorter steps.
        speed_unit: Unit of the speed of link 1.
    """
    scene, record = _module(result), result
    moving_rows = np.flatnonzero(np.diff(record["input_angle"] / math.tau + record["input_turns"]))
    if not moving_rows.size:
        raise ParameterError("link 1 does not turn")
    begin, end = record.time[moving_rows[0]], record.time[moving_rows[-1] + 1]
    spectra = orders(scene, fmu, record=record, begin=begin, end=end)
    lines = spectra.lines(N_LABELLED, speed_unit=speed_unit)
    rows = [
        (label, *line) for name, label in oscillating_signals(spectra).items() for line in lines[name].items()
    ]
    text = f"Orders in cycles per {BASES[LINK1]}, from {begin:g} s to {end:g} s."
    text += f" They were recorded in steps of {spectra.step * 1e3:.3g} ms."
    picture = _picture(order_figure(spectra, "", speed_unit=speed_unit))
    return Part([], ("signal", "order", "amplitude"), rows, picture, text)


def _energy(result: SceneResult) -> Part:
    """Return the section of energies, their mean power, and the fraction of each cause of losses."""
    time, losses = (result.quantities[name].value for name in ("simulated_time", "energy_lost"))
    rows = []
    for name, (value, unit) in result.quantities.items():
        if name.startswith("energy_") or name == "efficiency":
            power = f"{value / time:.4g} W" if unit == "J" else ""
            share = f"{100.0 * value / losses:.3g} %" if name.startswith(LOST_TO) else ""
            rows.append((_with_spaces(name), f"{value:.6g} {printed_unit(unit)}", power, share))
    texts = [] if losses else ["The mechanism is ideal: no losses."]
    return Part(texts, ("energy", "value", "mean power", "share of the losses"), rows)


def _duty(result: SceneResult) -> Part:
    """Return the section of the freewheel duty: engagement frequencies, maximum torque and slip."""
    _module(result)
    if DUTY_NOTE in result.remarks:
        raise ParameterError(f"it {result.remarks[DUTY_NOTE]}")
    lines = result.lines()
    frequencies = ("engagement frequency mean", "engagement frequency maximum")
    rows = [
        (number, *(lines.get(f"{name} {number}", "not present") for name in FREEWHEELS))
        for number in (*frequencies, "torque peak", "overrunning speed peak")
    ]
    text = (
        "The mean frequency covers the whole run. The maximum covers ten consecutive engagements, because"
        " manufacturers limit the indexing frequency of sprags."
    )
    return Part([text], ("number", *(f"{name} freewheel" for name in FREEWHEELS)), rows)


# sections of the results by title
PARTS: dict[str, Callable[[SceneResult], Part]] = {
    "Mechanism": _mechanism,
    "Results": _summary,
    "Energy and losses": _energy,
    "Freewheel duty": _duty,
    "Curves": _curves,
    "Torque converter chart": _chart,
    "Orders": _orders,
}
