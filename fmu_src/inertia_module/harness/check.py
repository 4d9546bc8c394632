"""Check of any FMU file: it is valid, steps, and gives the reference results that it carries along.

Those are found by the layered standard FMI-LS-REF: experiments (MA-HS-Experiments), inputs and results as
CSV, parameters as SSV of SSP. A result of no experiment is taken for that of the default one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from fmpy import platform as host
from fmpy import platform_tuple, simulate_fmu, supported_platforms
from fmpy.validation import validate_fmu

from .fmu import Log, read_description
from .loading import OTHERS, callbacks_of, unpacked
from .results import Result
from .simulate import drive

STEPS = 100
MANIFEST = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml"
# what a result may deviate that comes without a tolerance, over the largest value of the reference
SHARE = 1e-2
# what a file that is not as the standards have it raises
UNREADABLE = (OSError, SyntaxError, LookupError, ValueError)


@dataclass
class Deviation:
    """Worst deviation of a variable from its reference, at a time, s, and what is allowed, in its unit."""

    experiment: str
    variable: str
    deviation: float
    allowed: float
    time: float

    def __str__(self) -> str:
        return f"{self.deviation:.2g} at {self.time:g} s, allowed {self.allowed:g}"


@dataclass
class Report:
    """Findings about an FMU file.

    Attributes:
        problems: one line each; empty if all is well. warnings: that it logs, and what is not done.
        facts: properties of the FMU by heading. outputs: last value of each output stepped to.
        references: what it deviates from the results that it carries along.
    """

    problems: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, float] = field(default_factory=dict)
    references: list[Deviation] = field(default_factory=list)


class Experiment(NamedTuple):
    """An experiment with results, as its file has it.

    Attributes:
        name: of it. results: their file. settings: times and tolerance by their names in the file.
        inputs: their file, or None. parameters: with units, by name. allowed: absolute tolerances by name.
    """

    name: str
    results: Path
    settings: Mapping[str, str] = {}
    inputs: Path | None = None
    parameters: Mapping[str, float | str] = {}
    allowed: Mapping[str, float] = {}


def _parameters(file: Path) -> Iterator[tuple[str, float | str]]:
    """Names and values of a parameter set: numbers, quantities, names of items."""
    for row in ElementTree.parse(file).iterfind(".//{*}Parameter"):
        given, unit = row[0].attrib["value"], row[0].get("unit", "1")
        value = float(given) if row[0].tag.endswith(("Real", "Integer")) else given
        yield row.attrib["name"], value if unit == "1" else f"{given} {unit}"


def _experiment(one: ElementTree.Element, folder: Path) -> Experiment:
    """An experiment of a file in a folder."""
    # drafts of the format differ in where the times are
    settings = {**getattr(one.find("TransientSimulation"), "attrib", {}), **one.attrib}
    files = {kind.tag: folder / kind.get("source", "") for kind in one}
    given = dict(_parameters(files["Parameters"])) if "Parameters" in files else {}
    allowed = {row.attrib["variable"]: float(row.attrib["absolute"]) for row in one.iter("Tolerance")}
    return Experiment(settings["name"], files["References"], settings, files.get("Stimuli"), given, allowed)


def experiments(folder: Path) -> list[Experiment]:
    """Experiments with results that an FMU carries along in the folder of its content; else UNREADABLE."""
    manifest, found, results = folder / MANIFEST, list[Experiment](), list[Path]()
    if not manifest.is_file():
        return found
    for related in ElementTree.parse(manifest).iterfind("Related"):
        role, file = related.get("role", ""), manifest.parent / related.get("source", "")
        if role.startswith("experiment"):
            rows = ElementTree.parse(file).iterfind("Experiment[References]")
            found += [_experiment(row, file.parent) for row in rows]
        elif role == "result" and file.suffix == ".csv":
            results.append(file)
    bound = [one.results for one in found]
    return found + [Experiment(file.stem, file) for file in results if file not in bound]


def deviations(one: Experiment, expected: Result, table: Result) -> Iterator[Deviation]:
    """Worst deviations of the table of a run, up to its end, from what its experiment has for results."""
    rows = max(int(np.searchsorted(expected.time, table.time[-1], "right")), 1)
    for name in expected.names[1:]:
        apart = np.abs(np.interp(expected.time, table.time, table[name]) - expected[name])[:rows]
        worst = int(np.argmax(apart))
        allowed = one.allowed.get(name, SHARE * float(np.abs(expected[name]).max()))
        yield Deviation(one.name, name, float(apart[worst]), allowed, float(expected.time[worst]))


def _step(path: Path, description: Any, report: Report, events: bool = False) -> None:
    """Run the default experiment in STEPS steps, or from event to event too, and look at the outputs."""
    stop = float(getattr(description.defaultExperiment, "stopTime", None) or 1.0)
    what = f"stepping it to {stop:g} s" + " with event mode" * events
    modes: dict[str, Any] = {"use_event_mode": events, "early_return_allowed": events, "debug_logging": True}
    log = Log()
    if description.fmiVersion == "3.0":
        modes["logger"] = log.take
    else:
        callbacks_of(log, OTHERS)
    try:
        table = simulate_fmu(str(path), stop_time=stop, output_interval=stop / STEPS, **modes)
    except Exception as error:
        report.problems.append(f"{what} fails: {'; '.join(log.errors) or error}")
        return
    finally:
        report.warnings += log.warnings
    report.problems.extend(f"it logs an error: {message}" for message in log.errors)
    heading = "with event mode" if events else "stepped to"
    end = float(table["time"][-1])
    ended = end < stop - 0.5 * stop / STEPS
    report.facts[heading] = f"{end:g} s in {len(table) - 1} steps" + ended * ", where it ends the simulation"
    for name in table.dtype.names or ():
        values = np.asarray(table[name], dtype=float)
        report.outputs[name] = float(values[-1])
        if not np.isfinite(values).all():
            report.problems.append(f"output {name} is not finite")


def _replay(path: Path, step: float | None, report: Report, one: Experiment) -> None:
    """Drive an FMU through an experiment; step: where the experiment has none, s, or None."""
    try:
        expected = Result.from_csv(one.results)
        stop = float(one.settings.get("stopTime", expected.time[-1]))
        step = float(one.settings.get("stepSize", step or stop / STEPS))
        tolerance = float(one.settings["tolerance"]) if "tolerance" in one.settings else None
        table = drive(path, one.inputs or {}, stop, step, expected.names[1:], one.parameters, tolerance)
    except UNREADABLE as error:
        report.problems.append(f"experiment {one.name} fails: {error}")
        return
    if table.time[-1] < stop:
        report.facts[one.name] = f"{table.time[-1]:g} s, where it ends the simulation"
    for found in deviations(one, expected, table):
        report.references.append(found)
        if found.deviation > found.allowed:
            report.problems.append(f"{one.name}: {found.variable} deviates from its reference: {found}")


def check_fmu(path: Path) -> Report:
    """Validate an FMU file by fmpy, step it, with event mode too where it has one, replay its references."""
    report, description = Report(), read_description(path, validate=False)
    platforms = supported_platforms(str(path))
    kinds = {"co-simulation": description.coSimulation, "model exchange": description.modelExchange}
    report.facts = {
        "model": description.modelName,
        "FMI": f"{description.fmiVersion}, {' and '.join(name for name, kind in kinds.items() if kind)}",
        "made by": description.generationTool or "not said",
        "platforms": ", ".join(platforms) or "none",
        "variables": str(len(description.modelVariables)),
    }
    report.problems += validate_fmu(str(path))
    if not {host, platform_tuple} & set(platforms):
        report.problems.append(f"it cannot be stepped here: it has no binary for {host}")
        return report
    _step(path, description, report)
    if getattr(description.coSimulation, "hasEventMode", False):
        _step(path, description, report, events=True)
    folder, step = Path(unpacked(path.read_bytes())), getattr(description.defaultExperiment, "stepSize", None)
    try:
        carried = experiments(folder)
    except UNREADABLE as error:
        report.problems.append(f"the experiments that it carries along cannot be read: {error}")
        return report
    if carried and description.coSimulation is None:
        report.warnings.append("its references are not replayed: that takes co-simulation")
        return report
    for one in carried:
        _replay(path, step and float(step), report, one)
    return report
