"""Levels of fidelity: what each models, and the settings at which it is measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from ..contract.variable import ENUMERATIONS
from ..contract.variables import VARIABLES
from ..kernel.codes import AVERAGED, ELASTIC, EVENT, KINEMATIC, RIGID, TIMESTEPPING

FIDELITIES = {number: name for name, number, _ in ENUMERATIONS["Fidelity"]}
METHODS = {number: name for name, number, _ in ENUMERATIONS["Method"]}

# outputs that a fidelity does not model, and why; everything else it has
NOT_MODELLED: Mapping[int, Mapping[str, str]] = {
    fidelity: {
        variable.name: need.reason
        for variable in VARIABLES
        for need in variable.needs
        if fidelity in need.lacking
    }
    for fidelity in FIDELITIES
}


@dataclass(frozen=True)
class Level:
    """Level of fidelity at one setting.

    Attributes:
        fidelity, method: numbers as in the table of variables. setting: as it is printed.
        parameters: that make the setting, such as tolerance.
    """

    fidelity: int
    method: int
    setting: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)

    @property
    def fidelity_name(self) -> str:
        """Such as rigid."""
        return FIDELITIES[self.fidelity]

    @property
    def method_name(self) -> str:
        """Such as event; "" where there is no choice of one."""
        return METHODS[self.method] if self.fidelity in (RIGID, ELASTIC) else ""

    @property
    def name(self) -> str:
        """Fidelity and method, such as "rigid, event"."""
        return ", ".join(filter(None, (self.fidelity_name, self.method_name)))

    @property
    def values(self) -> dict[str, float]:
        """Parameters of the module for this level."""
        return {"fidelity": float(self.fidelity), "method": float(self.method), **self.parameters}


def event(fidelity: int, tolerance: float) -> Level:
    """Make a level from event to event, at a tolerance."""
    return Level(fidelity, EVENT, f"tolerance {tolerance:.0e}", {"tolerance": tolerance})


def timestepping(fidelity: int, step: float) -> Level:
    """Make a level in fixed steps, s."""
    return Level(fidelity, TIMESTEPPING, f"step {1e3 * step:g} ms", {"max_step": step})


TOLERANCES = tuple(10.0**-n for n in range(3, 12))
STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
_FEW_TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
_FEW_STEPS = (1e-2, 1e-3, 1e-4)


def all_levels(elastic: bool, kinematic: bool = True, few: bool = False) -> Iterator[Level]:
    """Yield the levels to measure, from coarse to fine.

    Args:
        elastic: there are parameters of an elastic output. kinematic: that one too.
        few: fewer tolerances and steps, for long scenes.
    """
    if kinematic:
        yield Level(KINEMATIC, EVENT, "prescribed ratio")
    yield Level(AVERAGED, EVENT, "map")
    for fidelity in (RIGID, ELASTIC) if elastic else (RIGID,):
        for step in _FEW_STEPS if few else STEPS:
            yield timestepping(fidelity, step)
        for tolerance in _FEW_TOLERANCES if few else TOLERANCES:
            yield event(fidelity, tolerance)
