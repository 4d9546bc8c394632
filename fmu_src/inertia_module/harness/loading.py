"""FMUs loaded by fmpy: a log for each instance, FMI 3.0 by the calls of 2.0.

Importing it imports fmpy.
"""

from __future__ import annotations

import weakref
from ctypes import byref, c_void_p
from typing import Any

from fmpy import fmi2
from fmpy.fmi1 import FMICallException, calloc, free, printLogMessage
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy

from .fmu import DISCARD, RUN, WARNING, Log

# logs by the environment that callbacks carry; instances that fmpy makes itself carry none
_logs: weakref.WeakValueDictionary[int | None, Log] = weakref.WeakValueDictionary()


def _dispatch(environment: int | None, instance: bytes, status: int, category: bytes, message: bytes) -> None:
    """Append a message to the log of its instance; print it as fmpy does if there is none."""
    log = _logs.get(environment)
    if log is None:
        printLogMessage(environment, instance, status, category, message)
    else:
        log.take(environment, status, category, message)


_DISPATCHER = fmi2.fmi2CallbackLoggerTYPE(_dispatch)


def callbacks_of(log: Log) -> Any:
    """Callbacks of one instance of FMI 2.0 with a log.

    Fmpy's proxy, which formats the messages, knows one callback a process: the last one given. One that is
    freed while another instance still logs would crash the process: that of all instances stays.
    """
    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = _DISPATCHER
    addLoggerProxy(byref(callbacks))
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
    callbacks.componentEnvironment = key = id(log)
    _logs[key] = log
    return callbacks


def instantiate(description: Any, folder: str, name: str, log: Log, events: bool = False) -> Any:
    """Make an instance of an unpacked FMU, with FMPy's FMI 2.0 method names.

    Args:
        description: of the FMU, by fmpy.
        folder: of the unpacked FMU.
        name: of the instance.
        log: takes the messages of the instance.
        events: use event mode and allow early return (FMI 3.0).
    """
    arguments = {
        "guid": description.guid,
        "unzipDirectory": folder,
        "modelIdentifier": description.coSimulation.modelIdentifier,
        "instanceName": name,
    }
    if description.fmiVersion == "2.0":
        instance = fmi2.FMU2Slave(**arguments)
        instance.instantiate(callbacks=callbacks_of(log), loggingOn=True)
        instance.getEnumeration, instance.setEnumeration = instance.getInteger, instance.setInteger
    else:
        instance = Slave(**arguments)
        modes = {"eventModeUsed": events, "earlyReturnAllowed": events}
        instance.instantiate(logMessage=log.take, loggingOn=True, **modes)
    whole_runs = getattr(instance.dll, RUN, None)
    if whole_runs is not None:
        whole_runs.argtypes, whole_runs.restype = (c_void_p, c_void_p), _check_status
        setattr(instance, RUN, whole_runs)
    return instance


def _check_status(status: int) -> None:
    """Raise on a status of failure, as fmpy does for functions of the standards."""
    if status > WARNING:
        raise FMICallException(RUN, status)


class Slave(FMU3Slave):  # type: ignore[misc]
    """Adapter: an FMI 3.0 instance for co-simulation with FMPy's FMI 2.0 method names.

    Event mode and early return only if instantiate is asked for them. Names are those of the standards.
    """

    _experiment: tuple[float | None, float, float | None] = (None, 0.0, None)
    _ended = False

    def setupExperiment(
        self, tolerance: float | None = None, startTime: float = 0.0, stopTime: float | None = None
    ) -> None:
        """Keep the experiment, s: FMI 3.0 has it with the beginning of initialization."""
        self._experiment = (tolerance, startTime, stopTime)

    def enterInitializationMode(self) -> None:
        super().enterInitializationMode(*self._experiment)

    getReal, setReal = FMU3Slave.getFloat64, FMU3Slave.setFloat64
    getInteger, setInteger = FMU3Slave.getInt32, FMU3Slave.setInt32
    getEnumeration, setEnumeration = FMU3Slave.getInt64, FMU3Slave.setInt64
    getFMUstate, setFMUstate = FMU3Slave.getFMUState, FMU3Slave.setFMUState
    freeFMUstate, serializeFMUstate = FMU3Slave.freeFMUState, FMU3Slave.serializeFMUState
    deSerializeFMUstate = FMU3Slave.deserializeFMUState
    getRealOutputDerivatives = FMU3Slave.getOutputDerivatives

    def doStep(self, *arguments: Any, **named: Any) -> Any:
        """Step; where the FMU ends the simulation that is said as in FMI 2.0."""
        answer = super().doStep(*arguments, **named)
        self._ended = answer[1]
        if self._ended:
            raise FMICallException("fmi3DoStep", DISCARD)
        return answer

    def getBooleanStatus(self, kind: int) -> bool:
        """Tell whether the last step has ended the simulation: of what FMI 2.0 can be asked only this."""
        return self._ended

    def setRealInputDerivatives(self, *arguments: Any) -> None:
        raise NotImplementedError("FMI 3.0 does not support input derivatives")
