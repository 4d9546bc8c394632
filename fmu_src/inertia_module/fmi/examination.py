"""Examination of an FMU in a separate process: validation, simulation, replay of its reference experiments.

Native code of an FMU can corrupt or end its process. Therefore the report is written to a journal at each
stage, and `check` monitors the process and evaluates its end.

Run: python -m inertia_module.fmi.examination FILE.fmu JOURNAL.json MEMORY
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import sys
import threading
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from fmpy import platform as host
from fmpy import platform_tuple, sharedLibraryExtension
from fmpy.validation import validate_fmu

from ..common.errors import FmuError, cannot_read, sentence_of
from .archive import MAX_UNPACKED, ArchiveError, read_archive
from .copies import unpacked
from .cosimulation import Array, Plan, Values, run
from .experiments import FILE_ERRORS, Experiment, experiments
from .instance import Log, read_description
from .replay import replay
from .report import Journal, Report, listed
from .times import Span, span_of

# maximum number of simulated steps of the default experiment
MAX_STEPS = 100_000


def examine(path: Path, journal: Journal) -> Report:
    """Validate an FMU file, simulate it with and without event mode, and replay its reference experiments.

    Args:
        path: path of the file.
        journal: journal that receives the report; its file is written at each stage.

    Returns:
        The report of the journal.

    Raises:
        FmuError: the file is no FMU.
    """
    report = journal.report
    journal.begin("unpacking the FMU")
    content = read_archive(path)
    try:
        folder = Path(unpacked(content))
    except ArchiveError as error:
        report.problems.append(str(error))
        return report
    except FmuError as error:
        raise FmuError(cannot_read(path, error)) from error
    journal.begin("reading the FMU")
    description = read_description(path, validate=False)
    report.facts = _facts(description, folder)
    report.problems += validate_fmu(str(folder))
    tests = _experiments(folder, report)
    if _can_simulate(description, folder, report):
        _simulate(description, folder, journal)
        if getattr(description.coSimulation, "hasEventMode", False):
            _simulate(description, folder, journal, events=True)
        if tests and description.coSimulation is None:
            report.warnings.append("reference results are not checked: this requires co-simulation")
            tests = []
        for experiment in tests:
            replay(description, folder, journal, experiment)
    return report


def _kinds(description: Any) -> list[str]:
    """Return the names of the interface types of an FMU."""
    kinds = {
        "co-simulation": description.coSimulation,
        "model exchange": description.modelExchange,
        "scheduled execution": description.scheduledExecution,
    }
    return [name for name, kind in kinds.items() if kind is not None]


def _facts(description: Any, folder: Path) -> dict[str, str]:
    """Return the properties of an FMU by heading."""
    return {
        "model": str(description.modelName),
        "FMI": f"{description.fmiVersion}, {' and '.join(_kinds(description)) or 'no interface'}",
        "generation tool": description.generationTool or "unspecified",
        "platforms": ", ".join(_platforms(folder)) or "none",
        "variables": str(len(description.modelVariables)),
    }


def _platforms(folder: Path) -> list[str]:
    """Return the platforms of an unpacked FMU: names of their folders, and c-code for sources."""
    places = [*folder.glob("binaries/*")]
    names = sorted(place.name for place in places if any(file.is_file() for file in place.rglob("*")))
    return names + ["c-code"] * any(folder.glob("sources/*.c"))


def _can_simulate(description: Any, folder: Path, report: Report) -> bool:
    """Return True if an FMU can be simulated on this machine; otherwise add the reason to the report."""
    interface = description.coSimulation or description.modelExchange
    if interface is None:  # a warning and no problem, because the FMU is correct
        report.warnings.append("the FMU is not simulated: it supports scheduled execution only")
        return False
    place = platform_tuple if description.fmiVersion[0] == "3" else host
    library = PurePosixPath("binaries", place, f"{interface.modelIdentifier}{sharedLibraryExtension}")
    if not (folder / library).is_file():
        report.problems.append(f"the FMU cannot be simulated on this machine: no {library}")
        return False
    return True


def _experiments(folder: Path, report: Report) -> list[Experiment]:
    """Return the reference experiments in an FMU; an unreadable file is added to the problems."""
    try:
        return experiments(folder)
    except FILE_ERRORS as error:
        report.problems.append(cannot_read("the reference experiments", error))
        return []


# --- steps through the default experiment ---


class _Samples:
    """Outputs of a run: the last values, and the first times with values that are not finite.

    Args:
        journal: journal that receives the progress.
        times: communication points, s, shape (steps + 1,).

    Attributes:
        time: last time, s.
        count: number of steps.
        last: last values by name.
        not_finite: first time of a value that is not finite, s, by name.
    """

    def __init__(self, journal: Journal, times: Array) -> None:
        self._journal, self._start, self._steps = journal, float(times[0]), times.size - 1
        self.time, self.count = self._start, 0
        self.last: dict[str, Values] = {}
        self.not_finite: dict[str, float] = {}

    def take(self, time: float, values: dict[str, Values]) -> None:
        """Store the values of a communication point.

        Args:
            time: simulation time, s.
            values: values of the outputs by name.
        """
        self.time, self.last = time, values
        self.count += time > self._start
        for name, elements in values.items():
            if not all(isinstance(value, str) or np.isfinite(value) for value in elements):
                self.not_finite.setdefault(name, time)
        self._journal.reach(time, self.count / self._steps)


def _default_times(description: Any, report: Report) -> Array:
    """Return the communication points of the default experiment, s; a long one is cut with a warning."""
    span = span_of(description, {})
    if span.steps > MAX_STEPS:
        report.warnings.append(
            f"only {MAX_STEPS} of {span.steps:.4g} steps of the default experiment are simulated"
            f" ({span.start:g} s to {span.stop:g} s by {span.step:g} s)"
        )
        span = Span(span.start, span.start + MAX_STEPS * span.step, span.step, span.is_variable)
    return span.times(MAX_STEPS)


def _simulate(description: Any, folder: Path, journal: Journal, events: bool = False) -> None:
    """Simulate the default experiment of an FMU and check its outputs."""
    report, log = journal.report, Log()
    outputs = [variable for variable in description.modelVariables if variable.causality == "output"]
    mode = " with event mode" * events
    journal.begin(f"simulation{mode}")
    try:
        times = _default_times(description, report)
        journal.begin(f"simulation{mode} to {times[-1]:g} s")
        samples = _Samples(journal, times)
        tolerance = getattr(description.defaultExperiment, "tolerance", None)
        plan = Plan(times, outputs, float(tolerance) if tolerance else None, events=events)
        is_over = run(description, str(folder), plan, log, samples.take)
    except Exception as error:
        report.problems.append(
            f"{journal.stage} failed: {'; '.join(listed(log.errors)) or sentence_of(error)}"
        )
        return
    finally:
        report.warnings += listed(log.warnings)
    report.problems += [f"the FMU logs an error: {message}" for message in listed(log.errors)]
    report.problems += [
        f"output {name} is not finite at t = {t:g} s" for name, t in samples.not_finite.items()
    ]
    report.facts["simulated with event mode" if events else "simulated"] = (
        f"{samples.time:g} s in {samples.count} steps" + is_over * "; the FMU ends the simulation"
    )
    report.outputs |= {name: _plain(values) for name, values in samples.last.items()}


def _plain(values: Values) -> Any:
    """Return values for a report: a list for several values, None for a value that is not finite."""
    plain = [value if isinstance(value, str) or np.isfinite(value) else None for value in values]
    return plain[0] if len(plain) == 1 else plain


# --- the process ---


def _end_with_parent() -> None:
    """Start a thread that kills this process and its group when the parent closes the standard input."""

    def watch() -> None:
        with contextlib.suppress(OSError):
            while os.read(0, 1):
                pass
        if os.name == "posix":
            os.killpg(0, signal.SIGKILL)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _limit_resources(memory: int) -> None:
    """Limit memory, bytes, and file sizes of this process, if the system supports it; forbid core files."""
    try:
        import resource
    except ImportError:  # Windows
        return
    limits = {resource.RLIMIT_CORE: 0, resource.RLIMIT_DATA: memory, resource.RLIMIT_FSIZE: MAX_UNPACKED}
    for kind, limit in limits.items():
        with contextlib.suppress(OSError, ValueError):
            resource.setrlimit(kind, (limit, limit))


def _flush() -> None:
    """Flush the standard output of Python and of C."""
    with contextlib.suppress(OSError, ValueError):
        sys.stdout.flush()
    if os.name == "posix":
        ctypes.CDLL(None).fflush(None)


def main(path: str, file: str, memory: str) -> None:
    """Examine an FMU file and write the report to a journal.

    Args:
        path: path of the FMU file.
        file: path of the journal.
        memory: memory limit, bytes, as text.
    """
    _end_with_parent()
    _limit_resources(int(memory))
    journal = Journal(Path(file))
    try:
        examine(Path(path), journal)
    except FmuError as error:
        journal.error = str(error)
    except Exception as error:
        journal.report.problems.append(f"{journal.stage} failed: {sentence_of(error)}")
    journal.is_done = True
    journal.write()
    _flush()
    os._exit(0)  # skips the destructors of libraries, which are not part of the examination


if __name__ == "__main__":
    main(*sys.argv[1:])
