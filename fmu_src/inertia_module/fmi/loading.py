"""Instances of FMUs, loaded with fmpy: each has a log; FMI 3.0 has the method names of FMI 2.0.

The import of this module imports fmpy.
"""

from __future__ import annotations

import weakref
from ctypes import byref, c_void_p
from typing import Any

from fmpy import fmi2
from fmpy.fmi1 import FMICallException, calloc, free, printLogMessage
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy

from .instance import DISCARD, RUN, WARNING, Log

# logs by the environment of the callbacks; instances of fmpy itself have no environment
_logs: weakref.WeakValueDictionary[int | None, Log] = weakref.WeakValueDictionary()


def _dispatch(environment: int | None, instance: bytes, status: int, category: bytes, message: bytes) -> None:
    """Append a message to the log of its instance; print it like fmpy if there is no log."""
    log = _logs.get(environment)
    if log is None:
        printLogMessage(environment, instance, status, category, message)
    else:
        log.take(environment, status, category, message)


_DISPATCHER = fmi2.fmi2CallbackLoggerTYPE(_dispatch)


def callbacks_of(log: Log) -> Any:
    """Return the callbacks of an FMI 2.0 instance that writes its messages to a log.

    All instances share one logger callback, which is never freed. The proxy of fmpy, which formats the
    messages, uses only the last registered callback of the process. If this callback were freed while an
    instance logs, the process would crash.

    Args:
        log: log of the instance.
    """
    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = _DISPATCHER
    addLoggerProxy(byref(callbacks))
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
    callbacks.componentEnvironment = key = id(log)
    _logs[key] = log
    return callbacks


def instantiate(description: Any, folder: str, name: str, log: Log) -> Any:
    """Make an instance of an unpacked FMU, with FMPy's FMI 2.0 method names.

    Args:
        description: model description of fmpy.
        folder: folder of the unpacked FMU.
        name: name of the instance.
        log: log that receives the messages of the instance.
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
        instance.instantiate(logMessage=log.take, loggingOn=True)
    whole_runs = getattr(instance.dll, RUN, None)
    if whole_runs is not None:
        whole_runs.argtypes, whole_runs.restype = (c_void_p, c_void_p), _check_status
        setattr(instance, RUN, whole_runs)
    return instance


def _check_status(status: int) -> None:
    """Raise an error if a status is a failure, as fmpy does for the functions of the standards."""
    if status > WARNING:
        raise FMICallException(RUN, status)


class Slave(FMU3Slave):  # type: ignore[misc]
    """Adapter: an FMI 3.0 instance for co-simulation with FMPy's FMI 2.0 method names.

    Event mode and early return require arguments of instantiate. The method names follow the standards.
    """

    _experiment: tuple[float | None, float, float | None] = (None, 0.0, None)
    _is_over = False

    def setupExperiment(
        self, tolerance: float | None = None, startTime: float = 0.0, stopTime: float | None = None
    ) -> None:
        """Store the experiment; FMI 3.0 passes it to enterInitializationMode.

        Args:
            tolerance: relative tolerance, or None.
            startTime: start time, s.
            stopTime: stop time, s, or None.
        """
        self._experiment = (tolerance, startTime, stopTime)

    def enterInitializationMode(self) -> None:
        """Enter initialization mode with the stored experiment."""
        super().enterInitializationMode(*self._experiment)

    getReal, setReal = FMU3Slave.getFloat64, FMU3Slave.setFloat64
    getInteger, setInteger = FMU3Slave.getInt32, FMU3Slave.setInt32
    getEnumeration, setEnumeration = FMU3Slave.getInt64, FMU3Slave.setInt64
    getFMUstate, setFMUstate = FMU3Slave.getFMUState, FMU3Slave.setFMUState
    freeFMUstate, serializeFMUstate = FMU3Slave.freeFMUState, FMU3Slave.serializeFMUState
    deSerializeFMUstate = FMU3Slave.deserializeFMUState
    getRealOutputDerivatives = FMU3Slave.getOutputDerivatives

    def doStep(self, *arguments: Any, **named: Any) -> Any:
        """Take a step; if the FMU ends the simulation, raise the status of FMI 2.0.

        Args:
            arguments: arguments of FMU3Slave.doStep.
            named: keyword arguments of FMU3Slave.doStep.

        Raises:
            FMICallException: the step fails, or the FMU ends the simulation (status discard).
        """
        result = super().doStep(*arguments, **named)
        self._is_over = result[1]
        if self._is_over:
            raise FMICallException("fmi3DoStep", DISCARD)
        return result

    def getBooleanStatus(self, kind: int) -> bool:
        """Return True if the last step has ended the simulation.

        Args:
            kind: status of FMI 2.0; only fmi2Terminated is used.
        """
        return self._is_over

    def setRealInputDerivatives(self, *arguments: Any) -> None:
        """Raise NotImplementedError: FMI 3.0 does not support input derivatives.

        Args:
            arguments: arguments of FMI 2.0, ignored.
        """
        raise NotImplementedError("FMI 3.0 does not support input derivatives")
