"""Adapter: an FMI 3.0 FMU with FMPy's FMI 2.0 method names.

The names in it are those of the two standards.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fmpy.fmi3 import FMU3Slave

from ..fmu.description import TYPES_3 as IN_FMI_3

# types of FMI 2.0 by their names in FMI 3.0, where they have others
TYPES = {name: of_fmi_2 for of_fmi_2, name in IN_FMI_3.items()}


class Slave(FMU3Slave):  # type: ignore[misc]
    """An instance for co-simulation; event mode and early return only if instantiate is asked for them.

    Args:
        types: of the variables in the description, by value reference. arguments: those of fmpy.
    """

    def __init__(self, types: Mapping[int, str], **arguments: Any) -> None:
        super().__init__(**arguments)
        self._types = types
        self._experiment: tuple[float | None, float, float | None] = (None, 0.0, None)

    def setupExperiment(
        self, tolerance: float | None = None, startTime: float = 0.0, stopTime: float | None = None
    ) -> None:
        """Keep the experiment, s: FMI 3.0 has it with the beginning of initialization."""
        self._experiment = (tolerance, startTime, stopTime)

    def enterInitializationMode(self) -> None:
        super().enterInitializationMode(*self._experiment)

    def _by_type(self, references: Sequence[int]) -> Iterator[tuple[str, list[int]]]:
        """Types of whole numbers, and the places of the references of each: FMI 2.0 has one type for all."""
        for kind, of_enumerations in (("Int32", False), ("Int64", True)):
            is_one = [self._types.get(reference) == "Enumeration" for reference in references]
            places = [place for place, found in enumerate(is_one) if found == of_enumerations]
            if places:
                yield kind, places

    def getReal(self, references: Sequence[int]) -> Any:
        return self.getFloat64(references)

    def setReal(self, references: Sequence[int], values: Sequence[float]) -> None:
        self.setFloat64(references, values)

    def getInteger(self, references: Sequence[int]) -> Any:
        found: dict[int, int] = {}
        for kind, places in self._by_type(references):
            numbers = getattr(self, f"get{kind}")([references[place] for place in places])
            found |= dict(zip(places, numbers, strict=True))
        return [found[place] for place in range(len(references))]

    def setInteger(self, references: Sequence[int], values: Sequence[int]) -> None:
        for kind, places in self._by_type(references):
            set_values = getattr(self, f"set{kind}")
            set_values([references[place] for place in places], [values[place] for place in places])

    def getFMUstate(self) -> Any:
        return self.getFMUState()

    def setFMUstate(self, state: Any) -> None:
        self.setFMUState(state)

    def freeFMUstate(self, state: Any) -> None:
        self.freeFMUState(state)

    def serializeFMUstate(self, state: Any) -> Any:
        return self.serializeFMUState(state)

    def deSerializeFMUstate(self, saved: bytes, state: Any = None) -> Any:
        return self.deserializeFMUState(saved, state)

    def fmi2SetDebugLogging(self, component: Any, on: int, count: int, categories: Any) -> None:
        self.fmi3SetDebugLogging(component, bool(on), count, categories)

    def fmi2DoStep(self, component: Any, time: float, step: float, no_state_prior: bool) -> None:
        self.doStep(time, step, no_state_prior)

    def fmi2GetReal(self, component: Any, references: Any, count: int, values: Any) -> None:
        self.fmi3GetFloat64(component, references, count, values, count)

    def fmi2GetRealOutputDerivatives(
        self, component: Any, references: Any, count: int, orders: Any, values: Any
    ) -> None:
        self.fmi3GetOutputDerivatives(component, references, count, orders, values, count)

    def fmi2SetRealInputDerivatives(self, *arguments: Any) -> None:
        raise NotImplementedError("FMI 3.0 has no derivatives of inputs")

    def fmi2FreeInstance(self, component: Any) -> None:
        self.freeInstance()
