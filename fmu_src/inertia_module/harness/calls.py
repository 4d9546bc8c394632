"""Calls to one instance of an FMU, 2.0 or 3.0: what fails is one kind of error; its states; its end."""

from __future__ import annotations

import contextlib
from ctypes import c_void_p
from pathlib import Path
from typing import Any, NamedTuple, Self

from ..common.errors import FmuError
from .descriptions import fmu_file, read_description
from .logs import WARNING, callbacks_of, log_of
from .unpacked import Unpacked, unpacked


class Kept(NamedTuple):
    """A state kept by an instance, and its time, s."""

    state: c_void_p
    time: float


class Closing:
    """Context that closes itself at the end of a with statement."""

    def close(self) -> None:
        """Free what it holds."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self.close()


class Instance(Closing):
    """One co-simulation instance of an FMU, 2.0 or 3.0, loaded and instantiated; a context manager.

    Args:
        path: the .fmu file; None for that of the module. start_time: of the experiment, s.

    Attributes:
        time: the communication point reached, s.
        messages: what the FMU logged, oldest first. warnings: those of them that are warnings.
        variables: fmpy's, by name. units: unit of each variable that has one.

    Raises:
        FmuError: the file is no such FMU; all methods raise it once the instance is closed.
    """

    def __init__(self, path: Path | str | None, start_time: float = 0.0) -> None:
        self.path = fmu_file(path)
        self.time = start_time
        self.messages: list[str] = []
        self.warnings: list[str] = []
        self._errors: list[str] = []
        self._kept: list[Kept] = []
        self._unpacked: Unpacked | None = None
        self._instance: Any = None
        try:
            self._load()
        except BaseException:
            self.close()
            raise

    def _load(self) -> None:
        from fmpy.fmi2 import FMU2Slave

        from .fmi3 import Slave

        description = read_description(self.path)
        try:
            self._unpacked = unpacked(self.path)
        except Exception as error:
            raise FmuError(f"{self.path} must be an FMU: {error}") from error
        if description.fmiVersion not in ("2.0", "3.0") or description.coSimulation is None:
            raise FmuError(f"{self.path} must be an FMU for co-simulation of FMI 2.0 or 3.0")
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.units = {name: variable.unit for name, variable in self.variables.items() if variable.unit}
        arguments = {
            "guid": description.guid,
            "unzipDirectory": self._unpacked.folder,
            "modelIdentifier": description.coSimulation.modelIdentifier,
            "instanceName": self.path.stem,
        }
        try:
            if description.fmiVersion == "2.0":
                self._instance = FMU2Slave(**arguments)
                self._instance.instantiate(callbacks=callbacks_of(self), loggingOn=True)
            else:
                types = {variable.valueReference: variable.type for variable in description.modelVariables}
                self._instance = Slave(types, **arguments)
                self._instance.instantiate(logMessage=log_of(self), loggingOn=True)
        except Exception as error:
            reasons = "; ".join(self.messages) or str(error)
            raise FmuError(f"{self.path} cannot be instantiated: {reasons}") from error

    def on_message(self, status: int, message: str) -> None:
        """Take a log message of the FMU; status as in FMI 2.0."""
        self.messages.append(message)
        if status == WARNING:
            self.warnings.append(message)
        elif status > WARNING:
            self._errors.append(message)

    def _call(self, function: str, *arguments: Any) -> Any:
        """Call a function of fmpy's instance; a failing status or an error it logs becomes a FmuError."""
        if self._instance is None:
            raise FmuError(f"{self.path.name} is closed: {function} needs an instance that is open")
        if function.startswith("fmi2"):
            arguments = (self._instance.component, *arguments)
        self._errors.clear()
        try:
            found = getattr(self._instance, function)(*arguments)
        except Exception as error:
            raise FmuError("; ".join(self._errors) or f"{function}: {error}") from error
        if self._errors:
            raise FmuError("; ".join(self._errors))
        return found

    def get_state(self) -> Kept:
        """Keep the state to go back to; cheaper than save, and good for this instance only.

        Raises:
            FmuError: the FMU cannot give its state.
        """
        self._kept.append(Kept(self._call("getFMUstate"), self.time))
        return self._kept[-1]

    def _check_kept(self, kept: Kept) -> None:
        # some FMUs crash on a state that is not theirs
        if not any(kept is known for known in self._kept):
            raise FmuError("a state must be one of get_state of this instance, not freed since")

    def set_state(self, kept: Kept) -> None:
        """Take over a state of get_state, and its time.

        Raises:
            FmuError: it is not one, or freed.
        """
        self._check_kept(kept)
        self._call("setFMUstate", kept.state)
        self.time = kept.time

    def free_state(self, kept: Kept) -> None:
        """Free a state of get_state; closing the instance frees all.

        Raises:
            FmuError: it is not one, or freed.
        """
        self._check_kept(kept)
        self._kept = [known for known in self._kept if known is not kept]
        self._call("freeFMUstate", kept.state)

    def save(self) -> bytes:
        """The whole state of the instance, serialised.

        Raises:
            FmuError: the FMU cannot give its state.
        """
        kept = self.get_state()
        try:
            return bytes(self._call("serializeFMUstate", kept.state))
        finally:
            self.free_state(kept)

    def restore(self, saved: bytes, time: float | None = None) -> None:
        """Take over a state of save; time, s, is the communication point it belongs to.

        Raises:
            FmuError: it is not one; the state is as it was.
        """
        if not isinstance(saved, bytes):
            raise FmuError(f"a state must be the bytes that save gave, is {type(saved).__name__}")
        before = self.get_state()
        try:
            state = self._call("deSerializeFMUstate", saved)
            try:
                self._call("setFMUstate", state)
            finally:
                self._instance.freeFMUstate(state)
        except FmuError:
            # the Python FMU else refuses all steps from now on
            self._call("setFMUstate", before.state)
            raise
        finally:
            self.free_state(before)
        if time is not None:
            self.time = time

    def close(self) -> None:
        """Terminate and free the instance; the last one of its FMU removes what was unpacked."""
        if self._instance is not None and getattr(self._instance, "component", None):
            with contextlib.suppress(Exception):
                self._instance.terminate()
            self._instance.freeInstance()
        self._instance = None
        self._kept.clear()
        if self._unpacked is not None:
            self._unpacked.release()
            self._unpacked = None
