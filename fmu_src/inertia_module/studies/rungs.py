"""The rungs of the ladder: what each models, and the settings at which it is measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from ..kernel.codes import AVERAGED, ELASTIC, EVENT, KINEMATIC, RIGID, TIMESTEPPING
from ..variables import ENUMERATIONS

FIDELITIES = {number: name for name, number, _ in ENUMERATIONS["Fidelity"]}
METHODS = {number: name for name, number, _ in ENUMERATIONS["Method"]}

_NO_PULSES = "has no pulses, only their mean"
_NO_PHASE = "has no drive angle, so it does not know where the imbalance is"
_NO_SHAFT = "has no elastic shaft"
_PRESCRIBED = "prescribes the motion instead of solving it"

_PULSES = (
    "omega2",
    "input_torque",
    "mesh_torque",
    "output_torque",
    "housing_torque",
    "contact_mode",
    "contact_switches",
)
_RIPPLE = ("torque_ripple", "torque_peak")
_PHASE = (
    "imbalance_acceleration",
    *(
        f"imbalance_{quantity}{axis}"
        for quantity in ("", "velocity_", "acceleration_")
        for axis in ("x", "y", "z")
    ),
    "drive_angle",
    "drive_turns",
)
_SHAFT = ("shaft_twist",)

# what a rung does not model, and why; everything else it has
NOT_MODELLED: Mapping[int, Mapping[str, str]] = {
    KINEMATIC: dict.fromkeys(("omega2", "omega_out", "omega_hub"), _PRESCRIBED),
    AVERAGED: (
        dict.fromkeys((*_PULSES, *_RIPPLE), _NO_PULSES)
        | dict.fromkeys(_PHASE, _NO_PHASE)
        | dict.fromkeys(_SHAFT, _NO_SHAFT)
    ),
    RIGID: dict.fromkeys(_SHAFT, _NO_SHAFT),
    ELASTIC: {},
}


@dataclass(frozen=True)
class Rung:
    """One setting of one rung.

    Attributes:
        fidelity, method: numbers as in the table of variables. setting: in words.
        parameters: that make it, besides fidelity and method.
    """

    fidelity: int
    method: int
    setting: str
    parameters: Mapping[str, float] = field(default_factory=dict)

    @property
    def fidelity_name(self) -> str:
        """Such as rigid."""
        return FIDELITIES[self.fidelity]

    @property
    def method_name(self) -> str:
        """Such as event; "" where the rung has no choice of one."""
        return METHODS[self.method] if self.fidelity in (RIGID, ELASTIC) else ""

    @property
    def values(self) -> dict[str, float]:
        """Parameters of the module for this rung."""
        return {"fidelity": float(self.fidelity), "method": float(self.method), **self.parameters}

    def lacks(self, output: str) -> str:
        """Why an output is not modelled, "" where it is."""
        return NOT_MODELLED[self.fidelity].get(output, "")


def event(fidelity: int, tolerance: float) -> Rung:
    """From event to event, at a tolerance."""
    return Rung(fidelity, EVENT, f"tolerance {tolerance:.0e}", {"tolerance": tolerance})


def timestepping(fidelity: int, step: float) -> Rung:
    """In fixed steps, s."""
    return Rung(fidelity, TIMESTEPPING, f"step {1e3 * step:g} ms", {"max_step": step})


TOLERANCES = tuple(10.0**-n for n in range(3, 12))
STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
_FEW_TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
_FEW_STEPS = (1e-2, 1e-3, 1e-4)


def ladder(elastic: bool, kinematic: bool = True, few: bool = False) -> Iterator[Rung]:
    """The rungs to measure, from coarse to fine.

    Args:
        elastic: whether there are parameters of an elastic output. kinematic: whether to include it.
        few: fewer tolerances and steps, for long scenes.
    """
    if kinematic:
        yield Rung(KINEMATIC, EVENT, "prescribed ratio")
    yield Rung(AVERAGED, EVENT, "map")
    for fidelity in (RIGID, ELASTIC) if elastic else (RIGID,):
        for step in _FEW_STEPS if few else STEPS:
            yield timestepping(fidelity, step)
        for tolerance in _FEW_TOLERANCES if few else TOLERANCES:
            yield event(fidelity, tolerance)
