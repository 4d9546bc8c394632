"""Check of any FMU file: it is valid, steps, and gives the reference results that it carries along.

Those are found by the layered standard FMI-LS-REF: experiments (MA-HS-Experiments), inputs and results as
CSV, parameters as SSV of SSP. A result of no experiment is taken for that of the default one.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from fmpy import platform as host
from fmpy import platform_tuple, simulate_fmu, supported_platforms
from fmpy.util import read_csv
from fmpy.validation import validate_fmu

from .fmu import Log, read_description
from .loading import OTHERS, callbacks_of, unpacked

STEPS = 100
MANIFEST = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml"
# what a result may deviate that comes without a tolerance, over the largest value of the reference
SHARE = 1e-2
# arguments of simulate_fmu that an experiment may have
SETTINGS = {
    **{"start_time": "startTime", "stop_time": "stopTime"},
    **{"output_interval": "stepSize", "relative_tolerance": "tolerance"},
}
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
        problems: one line each; empty if all is well. warnings: that it or fmpy gives.
        facts: what it is, by heading. outputs: last value of each output stepped to.
        references: what it deviates from the results that it carries along.
    """

    problems: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, float] = field(default_factory=dict)
    references: list[Deviation] = field(default_factory=list)


class Experiment(NamedTuple):
    """An experiment with results: what fmpy's simulate_fmu takes, their file, absolute tolerances by name."""

    name: str
    results: Path
    arguments: Mapping[str, Any] = {}
    allowed: Mapping[str, float] = {}


def _start_values(file: Path, description: Any) -> Iterator[tuple[str, Any]]:
    """Names of a parameter set and their values as fmpy takes them."""
    types = {variable.name: variable.declaredType for variable in description.modelVariables}
    for parameter in ElementTree.parse(file).iterfind(".//{*}Parameter"):
        name, (given,) = parameter.attrib["name"], parameter
        text, unit = given.attrib["value"], given.get("unit")
        items = {item.name: item.value for item in getattr(types[name], "items", None) or ()}
        yield name, (float(text), unit) if unit else items.get(text, text)


def _experiment(one: ElementTree.Element, folder: Path, description: Any) -> Experiment:
    """An experiment of a file in a folder."""
    # drafts of the format differ in where the times are
    settings = {**getattr(one.find("TransientSimulation"), "attrib", {}), **one.attrib}
    files = {kind.tag: folder / kind.get("source", "") for kind in one}
    arguments: dict[str, Any] = {
        name: float(settings[key]) for name, key in SETTINGS.items() if key in settings
    }
    if "Parameters" in files:
        arguments["start_values"] = dict(_start_values(files["Parameters"], description))
    if "Stimuli" in files:
        arguments["input"] = read_csv(files["Stimuli"])
    allowed = {row.attrib["variable"]: float(row.attrib["absolute"]) for row in one.iter("Tolerance")}
    return Experiment(settings["name"], files["References"], arguments, allowed)


def experiments(folder: Path, description: Any) -> list[Experiment]:
    """Experiments with results that an FMU carries along.

    Args:
        folder: with its content. description: fmpy's.

    Raises:
        OSError, SyntaxError, LookupError, ValueError: a file is missing or not as the standards have it.
    """
    manifest, found, results = folder / MANIFEST, list[Experiment](), list[Path]()
    if not manifest.is_file():
        return found
    for related in ElementTree.parse(manifest).iterfind("Related"):
        role, file = related.get("role", ""), manifest.parent / related.get("source", "")
        if role.startswith("experiment"):
            rows = ElementTree.parse(file).iterfind("Experiment[References]")
            found += [_experiment(row, file.parent, description) for row in rows]
        elif role == "result" and file.suffix == ".csv":
            results.append(file)
    bound = [one.results for one in found]
    return found + [Experiment(file.stem, file) for file in results if file not in bound]


def deviations(one: Experiment, table: Any) -> Iterator[Deviation]:
    """Worst deviations of the table of a run from the results of its experiment.

    Raises:
        OSError, LookupError, ValueError: the results cannot be read, or hold what the table has not.
    """
    expected = read_csv(one.results)
    first, *names = expected.dtype.names
    times = expected[first]
    for name in names:
        found, wanted = (np.asarray(rows[name], float).reshape(len(rows), -1) for rows in (table, expected))
        at_times = [np.interp(times, table["time"], column) for column in found.T]
        apart = np.abs(np.transpose(at_times) - wanted).max(axis=1)
        worst = int(np.argmax(apart))  # which a NaN is
        allowed = one.allowed.get(name, SHARE * float(np.abs(wanted).max()))
        yield Deviation(one.name, name, float(apart[worst]), allowed, float(times[worst]))


def _run(folder: str, description: Any, report: Report, what: str, **options: Any) -> Any:
    """Run an FMU by fmpy; the table, or None where that fails. What it logs goes to the report."""
    log, said = Log(), io.StringIO()
    if description.fmiVersion == "3.0":
        options["logger"] = log.take
    else:
        callbacks_of(log, OTHERS)
    try:
        with contextlib.redirect_stdout(said):  # where fmpy puts warnings
            return simulate_fmu(folder, debug_logging=True, **options)
    except Exception as error:
        report.problems.append(f"{what} fails: {'; '.join(log.errors) or error}")
        log.errors.clear()
        return None
    finally:
        report.warnings += log.warnings + said.getvalue().splitlines()
        report.problems += [f"it logs an error: {message}" for message in log.errors]


def _step(folder: str, description: Any, report: Report, events: bool = False) -> None:
    """Run the default experiment in STEPS steps, or from event to event too, and look at the outputs."""
    stop = float(getattr(description.defaultExperiment, "stopTime", None) or 1.0)
    what = f"stepping it to {stop:g} s" + " with event mode" * events
    modes = {"use_event_mode": events, "early_return_allowed": events}
    table = _run(folder, description, report, what, stop_time=stop, output_interval=stop / STEPS, **modes)
    if table is None:
        return
    heading = "with event mode" if events else "stepped to"
    report.facts[heading] = f"{stop:g} s in {len(table) - 1} steps"
    for name in table.dtype.names or ():
        values = np.asarray(table[name], dtype=float)
        report.outputs[name] = float(values[-1])
        if not np.isfinite(values).all():
            report.problems.append(f"output {name} is not finite")


def _replay(folder: str, description: Any, report: Report, one: Experiment) -> None:
    """Run an experiment, and hold its results against the reference."""
    try:
        _, *names = read_csv(one.results).dtype.names
        table = _run(folder, description, report, f"experiment {one.name}", output=names, **one.arguments)
        found = [] if table is None else list(deviations(one, table))
    except UNREADABLE as error:
        report.problems.append(f"experiment {one.name} has results that cannot be compared: {error}")
        return
    report.references += found
    report.problems += [
        f"{one.name}: {worst.variable} deviates from its reference: {worst}"
        for worst in found
        if not worst.deviation <= worst.allowed
    ]


def check_fmu(path: Path) -> Report:
    """Validate an FMU file with fmpy, step it, with event mode too where it has one, replay its references.

    Raises:
        FmuError: the file is no FMU that could be read at all.
    """
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
    content = unpacked(path)
    _step(content.folder, description, report)
    if getattr(description.coSimulation, "hasEventMode", False):
        _step(content.folder, description, report, events=True)
    try:
        carried = experiments(Path(content.folder), description)
    except UNREADABLE as error:
        report.problems.append(f"the experiments that it carries along cannot be read: {error}")
        return report
    for one in carried:
        _replay(content.folder, description, report, one)
    return report
