"""One instance of an FMU, 2.0 or 3.0, for co-simulation, by names: set, advance, read, save, restore."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes import c_char_p, c_double, c_int
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FmuError, did_you_mean
from .calls import Instance, Kept
from .descriptions import number_for

__all__ = ["Fmu", "FmuError", "Kept", "Plant", "as_names"]


def as_names(names: str | Sequence[str]) -> tuple[str, ...]:
    """Names, of which one alone may be given as it is."""
    return (names,) if isinstance(names, str) else tuple(names)


def _kind(variable: Any) -> str:
    """The kind of call that reads and sets a variable: FMI has none of its own for enumerations."""
    return variable.type if variable.type in ("Real", "Boolean") else "Integer"


class Plant(Protocol):
    """Plant of a loop: the part of Fmu that a loop needs."""

    def set(self, **values: float) -> None:
        """Set inputs by name."""

    def advance(self, step: float) -> None:
        """Advance by a communication step, s."""

    def read(self, names: Sequence[str]) -> tuple[float, ...]:
        """Values by name."""


class Fmu(Instance):
    """One co-simulation instance of an FMU, 2.0 or 3.0, initialised and ready to step; a context manager.

    Those of FMI 3.0 run without event mode and early return.

    Args:
        path: the .fmu file; without one that of the module, as it comes with the package or is built.
        parameters: start values by name: numbers, strings with a unit ("90 deg"), enumerations by number
            or item name.
        inputs: inputs by name, set before the end of initialisation (so no jump at the start).
        tolerance: relative tolerance of the experiment, or None.
        start_time: of the experiment, s.
        stop_time: of the experiment, s, or None.

    Attributes:
        time: the communication point reached, s.
        messages: what the FMU logged, oldest first. warnings: those of them that are warnings.
        variables: fmpy's, by name. units: unit of each variable that has one.

    Raises:
        FmuError: the file is no such FMU, a name is unknown, or a value is refused; all methods raise it
            once the instance is closed.
    """

    def __init__(
        self,
        path: Path | str | None = None,
        parameters: Mapping[str, float | bool | str] | None = None,
        inputs: Mapping[str, float | str] | None = None,
        tolerance: float | None = None,
        start_time: float = 0.0,
        stop_time: float | None = None,
    ) -> None:
        super().__init__(path, start_time)
        self._readers: dict[tuple[str, ...], tuple[Any, Any, int, list[tuple[int, str]]]] = {}
        try:
            self._call("setupExperiment", tolerance, start_time, stop_time)
            self._assign(parameters or {})
            self._assign(inputs or {})
            self._call("enterInitializationMode")
            self._before_start()
            self._call("exitInitializationMode")
        except BaseException:
            self.close()
            raise

    def _before_start(self) -> None:
        """Prepare what a kind of instance needs before the end of its initialisation."""

    def _variable(self, name: str) -> Any:
        variable = self.variables.get(name)
        if variable is None:
            hint = did_you_mean(name, self.variables)
            raise FmuError(f"{name} must be a variable of {self.path.name} {hint}")
        return variable

    def _assign(self, values: Mapping[str, float | bool | str]) -> None:
        """Set variables by name: all of them or, on an unknown name or value, none."""
        calls: dict[str, dict[int, float]] = {}
        for variable, value in [(self._variable(name), value) for name, value in values.items()]:
            calls.setdefault(_kind(variable), {})[variable.valueReference] = number_for(variable, value)
        for kind, numbers in calls.items():
            convert = {"Real": float, "Boolean": bool, "Integer": int}[kind]
            self._call(f"set{kind}", list(numbers), [convert(number) for number in numbers.values()])

    def set(self, **values: float | str) -> None:
        """Set inputs and tunable parameters by name; all or none.

        Args:
            values: numbers, or strings with a unit.

        Raises:
            FmuError: an unknown name, no quantity, a variable that cannot be set now, or a value of a tunable
                parameter that the FMU refuses.
        """
        self._assign(values)

    def advance(self, step: float) -> None:
        """Advance by a communication step, s.

        Raises:
            FmuError: the FMU refused the step; its state is as it was.
        """
        try:
            self._call("doStep", self.time, step)
        except FmuError as error:
            raise FmuError(f"at time {self.time:.9g} s: {error}") from error
        self.time += step

    def read(self, names: str | Sequence[str]) -> tuple[float, ...]:
        """Values by name, of any type, as floats.

        Args:
            names: of variables, or one alone.

        Raises:
            FmuError: an unknown name, or the FMU refuses to give a value.
        """
        key = as_names(names)
        if key not in self._readers:
            self._readers[key] = self._reader(key)
        references, values, count, others = self._readers[key]
        if count:
            self._call("fmi2GetReal", references, count, values)
        found = list(values)
        for place, name in others:  # in rising order
            found.insert(place, self._read_one(name))
        return tuple(found)

    def _reader(self, names: tuple[str, ...]) -> tuple[Any, Any, int, list[tuple[int, str]]]:
        """Split names: arguments of the call that reads the reals, and places and names of the others."""
        reals = [name for name in names if self._variable(name).type == "Real"]
        others = [(place, name) for place, name in enumerate(names) if self.variables[name].type != "Real"]
        return self._references(reals), (c_double * len(reals))(), len(reals), others

    def _read_one(self, name: str) -> float:
        variable = self._variable(name)
        return float(self._call(f"get{_kind(variable)}", [variable.valueReference])[0])

    def __getitem__(self, name: str) -> float:
        return self.read(name)[0]

    def set_logging(self, on: bool, *categories: str) -> None:
        """Switch log categories on or off; all of them if none is named.

        Raises:
            FmuError: an unknown category.
        """
        names = (c_char_p * len(categories))(*(category.encode() for category in categories))
        self._call("fmi2SetDebugLogging", int(on), len(categories), names)

    def _references(self, names: Sequence[str]) -> Any:
        from fmpy.fmi2 import fmi2ValueReference

        return (fmi2ValueReference * len(names))(*(self._variable(name).valueReference for name in names))

    def set_rates(self, **rates: float) -> None:
        """Give inputs a rate over the coming step (native FMUs; see docs/fmu.md).

        Args:
            rates: by name, in the unit of the input per second.

        Raises:
            FmuError: an unknown name, no input, or an FMU that takes no derivatives of inputs.
        """
        count = len(rates)
        orders, values = (c_int * count)(*[1] * count), (c_double * count)(*rates.values())
        self._call("fmi2SetRealInputDerivatives", self._references(tuple(rates)), count, orders, values)

    def rates(self, names: str | Sequence[str]) -> tuple[float, ...]:
        """Rates of outputs at the end of the last step, per second (native FMUs; see docs/fmu.md).

        Args:
            names: of outputs, or one alone.

        Raises:
            FmuError: an unknown name, no output, or an FMU that gives no derivatives of outputs.
        """
        references = self._references(as_names(names))
        count = len(references)
        orders, values = (c_int * count)(*[1] * count), (c_double * count)()
        self._call("fmi2GetRealOutputDerivatives", references, count, orders, values)
        return tuple(values)

    def jacobian(self, outputs: str | Sequence[str], inputs: str | Sequence[str]) -> NDArray[np.float64]:
        """How outputs after the last step change with the inputs over it (native FMUs; see docs/fmu.md).

        Returns:
            Shape (outputs, inputs), units of the output over those of the input.

        Raises:
            FmuError: an unknown name, or an FMU that gives no directional derivatives.
        """
        unknowns, knowns = list(self._references(as_names(outputs))), self._references(as_names(inputs))
        columns = [self._call("getDirectionalDerivative", unknowns, [known], [1.0]) for known in knowns]
        return np.array(columns, dtype=np.float64).reshape(len(knowns), len(unknowns)).T
