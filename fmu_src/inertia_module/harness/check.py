"""Check of any FMU file: fmpy's validation, then a run over its default experiment."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import platform as host
from fmpy import platform_tuple, simulate_fmu, supported_platforms
from fmpy.validation import validate_fmu

from .fmu import read_description
from .loading import messages_of_others, pass_on

STEPS = 100


@dataclass
class Report:
    """Findings about an FMU file.

    Attributes:
        problems: one line each; empty if all is well. warnings: that it logs.
        facts: what it is, by heading. outputs: last value of each output stepped to.
    """

    problems: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, float] = field(default_factory=dict)


def _step(path: Path, description: Any, report: Report, events: bool = False) -> None:
    """Run the default experiment in STEPS steps, or from event to event too, and look at the outputs."""
    experiment = description.defaultExperiment
    stop = float(getattr(experiment, "stopTime", None) or 1.0)
    what = f"stepping it to {stop:g} s" + " with event mode" * events
    modes: dict[str, Any] = {"use_event_mode": events, "early_return_allowed": events, "debug_logging": True}
    if description.fmiVersion == "3.0":
        modes["logger"] = pass_on
    with messages_of_others(report.warnings) as messages:
        try:
            table = simulate_fmu(str(path), stop_time=stop, output_interval=stop / STEPS, **modes)
        except Exception as error:
            report.problems.append(f"{what} fails: {'; '.join(messages) or error}")
            return
    report.problems.extend(f"it logs an error: {message}" for message in messages)
    heading = "with event mode" if events else "stepped to"
    report.facts[heading] = f"{stop:g} s in {len(table) - 1} steps"
    for name in table.dtype.names or ():
        values = np.asarray(table[name], dtype=float)
        report.outputs[name] = float(values[-1])
        if not np.isfinite(values).all():
            report.problems.append(f"output {name} is not finite")


def check_fmu(path: Path) -> Report:
    """Validate an FMU file with fmpy and step it, with event mode too where it has one.

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
    _step(path, description, report)
    if getattr(description.coSimulation, "hasEventMode", False):
        _step(path, description, report, events=True)
    return report
