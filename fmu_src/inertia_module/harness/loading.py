"""FMUs by fmpy: instances, unpacked, each with log messages of its own, FMI 3.0 called like 2.0; checks.

Importing it brings fmpy along.
"""

from __future__ import annotations

import hashlib
import io
import shutil
import tempfile
import threading
import weakref
from ctypes import byref, c_void_p
from dataclasses import dataclass, field
from multiprocessing.util import Finalize
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract, platform_tuple, simulate_fmu, supported_platforms
from fmpy import platform as host
from fmpy.fmi1 import FMICallException, calloc, free, printLogMessage
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy
from fmpy.validation import validate_fmu

from .fmu import RUN, WARNING, Log, read_description


class Unpacked:
    """Folder with an FMU's content: removed with the last reference to it, or when the process ends.

    Args:
        content: of the FMU's file.
    """

    def __init__(self, content: bytes) -> None:
        self.folder = tempfile.mkdtemp(prefix="fmu-")
        # also at the end of processes that multiprocessing has forked, which atexit knows nothing of; after
        # those that this one has forked, which leave the folder to it
        remove = Finalize(self, shutil.rmtree, args=(self.folder, True), exitpriority=-1)
        try:
            extract(io.BytesIO(content), self.folder)
        except BaseException:
            remove()
            raise


_lock = threading.Lock()
# by the content of the FMU's file
_copies: weakref.WeakValueDictionary[str, Unpacked] = weakref.WeakValueDictionary()


def unpacked(path: Path) -> Unpacked:
    """Unpack an FMU, or find the copy that another instance in this process holds."""
    content = path.read_bytes()
    key = hashlib.sha256(content).hexdigest()
    with _lock:
        copy = _copies.get(key) or Unpacked(content)
        _copies[key] = copy
        return copy


# of the environment that callbacks carry; of instances that fmpy makes itself, which carry none
_logs: weakref.WeakValueDictionary[int, Log] = weakref.WeakValueDictionary()
_OTHERS = 0


def _dispatch(environment: int | None, instance: bytes, status: int, category: bytes, message: bytes) -> None:
    """Pass a message on to the log it is for; without one it is printed, as fmpy does."""
    log = _logs.get(environment or _OTHERS)
    if log is None:
        printLogMessage(environment, instance, status, category, message)
    else:
        log.take(environment, status, category, message)


_DISPATCHER = fmi2CallbackLoggerTYPE(_dispatch)


def callbacks_of(log: Log, environment: int | None = None) -> Any:
    """Callbacks of one instance of FMI 2.0 with a log, and its own environment unless one is given.

    Fmpy's proxy, which formats the messages, knows one callback a process: the last one given. One that is
    freed while another instance still logs would crash the process: that of all instances stays.
    """
    callbacks = fmi2CallbackFunctions()
    callbacks.logger = _DISPATCHER
    addLoggerProxy(byref(callbacks))
    callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    callbacks.componentEnvironment = key = id(log) if environment is None else environment
    _logs[key] = log
    return callbacks


def instantiate(description: Any, folder: str, name: str, log: Log) -> Any:
    """Make an instance for co-simulation, with FMPy's FMI 2.0 method names.

    Args:
        description: fmpy's. folder: with its content. name: of the instance. log: takes its messages.
    """
    arguments = {
        "guid": description.guid,
        "unzipDirectory": folder,
        "modelIdentifier": description.coSimulation.modelIdentifier,
        "instanceName": name,
    }
    if description.fmiVersion == "2.0":
        instance = FMU2Slave(**arguments)
        instance.instantiate(callbacks=callbacks_of(log), loggingOn=True)
    else:
        instance = Slave(**arguments)
        instance.instantiate(logMessage=log.take, loggingOn=True)
    whole_runs = getattr(instance.dll, RUN, None)
    if whole_runs is not None:
        whole_runs.argtypes, whole_runs.restype = (c_void_p, c_void_p), _check_status
        setattr(instance, RUN, whole_runs)
    return instance


def _check_status(status: int) -> None:
    """Raise where fmpy does for functions of the standards."""
    if status > WARNING:
        raise FMICallException(RUN, status)


class Slave(FMU3Slave):  # type: ignore[misc]
    """Adapter: an FMI 3.0 instance for co-simulation with FMPy's FMI 2.0 method names, but for values.

    Event mode and early return only if instantiate is asked for them. Names are those of the standards.
    """

    _experiment: tuple[float | None, float, float | None] = (None, 0.0, None)

    def setupExperiment(
        self, tolerance: float | None = None, startTime: float = 0.0, stopTime: float | None = None
    ) -> None:
        """Keep the experiment, s: FMI 3.0 has it with the beginning of initialization."""
        self._experiment = (tolerance, startTime, stopTime)

    def enterInitializationMode(self) -> None:
        super().enterInitializationMode(*self._experiment)

    getFMUstate, setFMUstate = FMU3Slave.getFMUState, FMU3Slave.setFMUState
    freeFMUstate, serializeFMUstate = FMU3Slave.freeFMUState, FMU3Slave.serializeFMUState
    deSerializeFMUstate = FMU3Slave.deserializeFMUState
    getRealOutputDerivatives = FMU3Slave.getOutputDerivatives

    def setRealInputDerivatives(self, *arguments: Any) -> None:
        raise NotImplementedError("FMI 3.0 has no derivatives of inputs")


# --- check of any FMU ---

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
    log = Log()
    if description.fmiVersion == "3.0":
        modes["logger"] = log.take
    else:
        callbacks_of(log, _OTHERS)
    try:
        table = simulate_fmu(str(path), stop_time=stop, output_interval=stop / STEPS, **modes)
    except Exception as error:
        report.problems.append(f"{what} fails: {'; '.join(log.errors) or error}")
        return
    finally:
        report.warnings += log.warnings
    report.problems.extend(f"it logs an error: {message}" for message in log.errors)
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
