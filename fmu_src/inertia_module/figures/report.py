"""Report of a scene as one HTML file, to send or to print: its question, what was found, how to repeat it.

All of it is what the commands run, chart and orders tell. A part that the scene cannot have says why.
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
from ..common.errors import Refused
from ..common.files import MAX_TEXT_SIZE, picture_of, read_file
from ..common.terminal import Progress
from ..contract.variables import LOST_TO, PARAMETER, Group, with_causality
from ..fmu.archive import filled_xml
from ..harness.chart import torque_converter_chart
from ..harness.fmu import read_description
from ..jobs.orders import ANGLES, BASES, BEARING, LINK1, SIGNALS, orders
from ..kernel.codes import ELASTIC
from ..scene import Scene, SceneResult
from ..scene.keys import in_range, keys_of
from ..scene.reading import speed_unit
from ..scene.run import DUTY, FREEWHEELS, input_speed, start_of
from .jobs import NAMED, chart_figure, order_figure
from .mechanism import mechanism_figure
from .scenes import scene_figure

TEMPLATE = Path(__file__).parent / "templates" / "report.html"
# what a run for a report records besides what the scene wants
RECORDED = (
    *(BEARING.get(name, name) for name in SIGNALS),
    *ANGLES,
    *("satellite_force", "satellite_force_peak", "shaking_moment_x", "shaking_moment_y", "shaking_moment_z"),
    "housing_torque",
)
# of pictures, and their size over that on the screen: letters are to be read on paper
DPI, SMALLER = 190, 0.8
# a list of more values is shown by its ends
LISTED = 16


class Part(NamedTuple):
    """Content of a section: sentences, a table with its columns, and the data URI of a picture."""

    texts: Sequence[str] = ()
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[str]] = ()
    picture: str = ""


def report_file(
    file: Path,
    keys: Sequence[str],
    result: SceneResult,
    fmu: Path,
    command: str,
    chosen: Sequence[str] = (),
    progress: Progress = lambda done: None,
) -> bytes:
    """Make the report of a run, of a module with RECORDED.

    Args:
        file: of the scene. keys: given instead of its own, KEY=VALUE each. fmu: the file that was run.
        command: that repeats it. chosen: lines on how the fidelity was chosen.
    """
    content = read_file(file, MAX_TEXT_SIZE)
    text = content.decode("utf-8-sig")
    remarks = [f"warning: {warning}" for warning in result.warnings]
    remarks += [f"{_words(name)} {remark}" for name, remark in result.remarks.items()]
    remarks += chosen
    asked, *parameters = _asked(result.scene, text, keys).items()
    sections = {
        "Warnings and remarks": Part(remarks or ["None."]),
        "Results": _found(result),
    }
    sections |= dict([asked])
    parts = PARTS | {"Orders": partial(_orders, fmu=fmu, speed_unit=speed_unit(file, keys))}
    for number, (title, make) in enumerate(parts.items()):
        progress(number / len(PARTS))
        try:
            sections[title] = make(result)
        except Refused as reason:
            sections[title] = Part([f"Not available: {reason}."])
    origin = {
        "scene file": f"{file.name}, SHA-256 {hashlib.sha256(content).hexdigest()}",
        "FMU": f"{fmu.name} {read_description(fmu, validate=False).guid}",
        "version": f"inertia-module {__version__}, Python {platform.python_version()}, {platform.platform()}",
        "date": f"{date.today()}",
        "command": command,
    }
    sections |= dict(parameters)
    return filled_xml(TEMPLATE, {"scene": result.scene, "sections": sections, "origin": origin, "text": text})


def _picture(figure: Figure, size: float = SMALLER) -> str:
    """A figure as the text of a data URI; its title stands above it on the page."""
    figure.suptitle("")
    figure.set_size_inches(*(size * figure.get_size_inches()))
    figure.set_dpi(DPI)
    return f"data:image/png;base64,{base64.b64encode(picture_of(figure, 'png')).decode()}"


def _words(name: str) -> str:
    return name.replace("_", " ")


# --- what was asked, and what was given ---


def _flat(tables: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Values of tables, by keys with dots."""
    for name, value in tables.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def _shown(value: Any) -> str:
    """A value of a scene as text: numbers to six digits, of a long list the ends."""
    if isinstance(value, list):
        texts = [_shown(one) for one in value]
        ends = [*texts[:3], f"… ({len(texts)} in all)", texts[-1]]
        return ", ".join(texts if len(texts) <= LISTED else ends)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.6g}"
    return re.sub(r"\d+\.\d{6,}", lambda digits: f"{float(digits[0]):.6g}", str(value))


def _asked(scene: Any, text: str, keys: Sequence[str]) -> dict[str, Part]:
    """Sections of the keys of a scene with their values and sources; last, by group, those of its model."""
    sources = {key: ("scene file", written) for key, written in _flat(tomllib.loads(text))}
    sources |= {key: ("--set", written) for key, written in _flat(keys_of(keys))}

    def source(key: str, shown: str, unsaid: str) -> str:
        """Source of a value, with what is written there where that is something else."""
        table = key.rpartition(".")[0]
        place, written = sources.get(key) or sources.get(f"{table}.file") or (unsaid, shown)
        return place if _shown(written) == shown else f"{place}: {_shown(written)}"

    module = isinstance(scene, Scene)
    table, values = ("mechanism", start_of(scene)[0]) if module else ("shaft", scene.parameters())
    idle = {Group.BEVEL if values.get("layout") else Group.PLANAR}
    idle |= {Group.ELASTIC} if module and values.get("fidelity") != ELASTIC else set()
    known, rows = set[str](), {group: list[Sequence[str]]() for group in ("", *Group)}
    for one in with_causality(PARAMETER, table=scene.VARIABLES.values()):
        key = "accuracy.tolerance" if module and one.name == "tolerance" else f"{table}.{one.name}"
        value = values.get(one.name, one.start)
        shown = _shown(in_range(one).written(value))
        told = source(key, shown, "default" if value == one.start else "other keys")
        known.add(key)
        if told != "default" or one.group not in idle:
            rows[one.group].append((one.name, shown, told, one.description))
    for key, value in _flat(scene.model_dump(mode="json", exclude_none=True)):
        if key not in known and key.rpartition(".")[2] not in ("title", "description"):
            rows[""].append((key, _shown(value), source(key, _shown(value), "default")))
    columns = ("parameter", "value", "source", "meaning")
    parts = {f"Parameters: {group}": Part([], columns, rows[group]) for group in Group if rows[group]}
    added = (
        "A value that differs from its source includes contributions of other keys, such as the inertia of a"
        " load."
    )
    return {"Inputs": Part([added], ("key", "value", "source"), rows[""]), **parts}


# --- results ---


def _found(result: SceneResult) -> Part:
    """The summary, in two columns."""
    lines = list(result.lines().items())
    half = -(-len(lines) // 2)
    pairs = zip_longest(lines[:half], lines[half:], fillvalue=("", ""))
    return Part([], ("number", "value") * 2, [(*one, *other) for one, other in pairs])


def _module(result: SceneResult) -> Scene:
    """The scene of a run, which must be one of the module."""
    if isinstance(result.scene, Scene):
        return result.scene
    raise Refused("the scene is a driven shaft without satellites and freewheels")


def _mechanism(result: SceneResult) -> Part:
    """Sketch of one module."""
    text = (
        "One module, to scale. The sketch shows pitch circles or pitch cones; other dimensions are not"
        " parameters."
    )
    return Part([text], picture=_picture(mechanism_figure(_module(result).parameters())))


def _chart(result: SceneResult) -> Part:
    """Chart at the largest speed of link 1 in the run."""
    scene, speeds = _module(result), input_speed(result.record)
    omega1 = float(speeds[np.abs(speeds).argmax()])
    if omega1 == 0.0:
        raise Refused("link 1 does not turn")
    chart = torque_converter_chart(scene.parameters(), omega1, engagements=True)
    limits, units = scene.freewheels.of("indexing_frequency"), chart.units(omega1)
    numbers = chart.summary(omega1, limits).items()
    rows = [(_words(name), f"{value:.6g} {units[name]}") for name, value in numbers]
    allowed = {"mechanism": min(limits.values()) * math.tau / abs(omega1)} if limits else {}
    figure = chart_figure({"mechanism": chart}, allowed=allowed, omega1=omega1)
    at = f"at the maximum speed of link 1 in the run, {omega1:.5g} rad/s"
    limit = scene.drive_torque_limit(omega1)
    beyond = "" if limit is None else chart.beyond_drive(omega1, limit)
    texts = [f"Steady-state means over the speed ratio, {at}."]
    texts += [f"{beyond[0].upper()}{beyond[1:]}."] if beyond else []
    return Part(texts, ("number", "value"), rows, _picture(figure))


def _orders(result: SceneResult, fmu: Path | None = None, speed_unit: str = "rad/s") -> Part:
    """Report the largest orders from the first to the last turn of link 1.

    Args:
        result: of the run.
        fmu: the file that was run, for a run in shorter steps.
        speed_unit: unit of the speed of link 1.
    """
    scene, record = _module(result), result.record
    turning = np.flatnonzero(np.diff(record["input_angle"] / math.tau + record["input_turns"]))
    if not turning.size:
        raise Refused("link 1 does not turn")
    begin, end = record.time[turning[0]], record.time[turning[-1] + 1]
    spectra = orders(scene, fmu, record=record, begin=begin, end=end)
    lines = spectra.lines(NAMED, speed_unit=speed_unit)
    rows = [(_words(name), *line) for name, texts in lines.items() for line in texts.items()]
    text = f"Orders in cycles per {BASES[LINK1]}, from {begin:g} s to {end:g} s."
    text += f" They were recorded in steps of {spectra.step * 1e3:.3g} ms."
    picture = _picture(order_figure(spectra, "", speed_unit=speed_unit))
    return Part([text], ("signal", "order", "amplitude"), rows, picture)


def _energy(result: SceneResult) -> Part:
    """Energies, their mean power, and the causes of what is lost with their shares."""
    time, lost = (result.quantities[name].value for name in ("simulated_time", "energy_lost"))
    rows = []
    for name, (value, unit) in result.quantities.items():
        if name.startswith("energy_") or name == "efficiency":
            power = f"{value / time:.4g} W" if unit == "J" else ""
            share = f"{100.0 * value / lost:.3g} %" if name.startswith(LOST_TO) else ""
            rows.append((_words(name), f"{value:.6g} {unit}", power, share))
    texts = [] if lost else ["The mechanism is ideal: no losses."]
    return Part(texts, ("energy", "value", "mean power", "share of the losses"), rows)


def _duty(result: SceneResult) -> Part:
    """How often each freewheel engages, and the most that it carries and overruns with."""
    _module(result)
    if DUTY in result.remarks:
        raise Refused(f"it {result.remarks[DUTY]}")
    lines = result.lines()
    frequencies = ("engagement frequency mean", "engagement frequency maximum")
    rows = [
        (number, *(lines.get(f"{name} {number}", "not present") for name in FREEWHEELS))
        for number in (*frequencies, "torque peak", "slip peak")
    ]
    text = (
        "The mean frequency covers the whole run. The maximum covers ten consecutive engagements, because"
        " manufacturers limit the indexing frequency of sprags. Slip is the overrunning speed."
    )
    return Part([text], ("number", *(f"{name} freewheel" for name in FREEWHEELS)), rows)


# sections of the results, as far as a scene can have them
PARTS: dict[str, Callable[[SceneResult], Part]] = {
    "Mechanism": _mechanism,
    "Curves": lambda result: Part(picture=_picture(scene_figure(result), size=1.0)),
    "Torque converter chart": _chart,
    "Orders": _orders,
    "Energy and losses": _energy,
    "Freewheel duty": _duty,
}
