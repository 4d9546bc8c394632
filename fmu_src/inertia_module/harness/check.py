"""Checks any FMU file: fmpy's validation, then a run over its default experiment."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..common.errors import DriveError
from .descriptions import existing_fmu
from .logs import messages_of_others

STEPS = 100


@dataclass
class Report:
    """What was found out about an FMU file.

    Attributes:
        path: the file. problems: one line each; empty if all is well. warnings: that it logs.
        facts: what it is, by heading. outputs: last value of each output stepped to.
    """

    path: Path
    problems: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, float] = field(default_factory=dict)


def _facts(description: Any, platforms: list[str]) -> dict[str, str]:
    kinds = {"co-simulation": description.coSimulation, "model exchange": description.modelExchange}
    return {
        "model": description.modelName,
        "FMI": f"{description.fmiVersion}, {' and '.join(name for name, kind in kinds.items() if kind)}",
        "made by": description.generationTool or "not said",
        "platforms": ", ".join(platforms) or "none",
        "variables": str(len(description.modelVariables)),
    }


def _step(path: Path, description: Any, report: Report) -> None:
    """Run the default experiment in STEPS steps and look at the outputs."""
    from fmpy import simulate_fmu

    experiment = description.defaultExperiment
    stop = float(getattr(experiment, "stopTime", None) or 1.0)
    with messages_of_others(report.warnings) as messages:
        try:
            table = simulate_fmu(str(path), stop_time=stop, output_interval=stop / STEPS, debug_logging=True)
        except Exception as error:
            report.problems.append(f"stepping it to {stop:g} s fails: {'; '.join(messages) or error}")
            return
    report.problems.extend(f"it logs an error: {message}" for message in messages)
    report.facts["stepped to"] = f"{stop:g} s in {len(table) - 1} steps"
    for name in table.dtype.names or ():
        values = np.asarray(table[name], dtype=float)
        report.outputs[name] = float(values[-1])
        if not np.isfinite(values).all():
            report.problems.append(f"output {name} is not finite")


def check_fmu(path: Path) -> Report:
    """Validate an FMU file with fmpy and step it.

    Raises:
        DriveError: the file is no FMU that could be read at all.
    """
    from fmpy import platform as host
    from fmpy import platform_tuple, read_model_description, supported_platforms
    from fmpy.validation import validate_fmu

    report = Report(existing_fmu(path))
    try:
        description = read_model_description(str(path), validate=False)
        platforms = list(supported_platforms(str(path)))
    except Exception as error:
        raise DriveError(f"{path} must be an FMU: {error}") from error
    report.facts = _facts(description, platforms)
    report.problems += validate_fmu(str(path))
    hosts = (host, platform_tuple)
    if any(name in platforms for name in hosts):
        _step(path, description, report)
    else:
        report.problems.append(f"it cannot be stepped here: it has no binary for {host}")
    return report
