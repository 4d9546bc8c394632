"""The [controller] of a scene: what speed is wanted, and who sees to it.

With a vehicle as load the vehicle speed is controlled (m/s), with any other load omega_out (rad/s);
bare numbers are in that unit.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from .. import loops
from ..common.errors import did_you_mean, must_be
from ..contract.variables import LARGEST_SPEED
from ..loops.cycles import CYCLES, Cycle
from ..loops.sources import Signal
from .fields import AngularSpeed, Strict, Tabulated, Times, Torque, checked, quantity
from .loads import SHAFT_SPEED, SPEED_UNITS


def _speed_unit(context: Any) -> str:
    return SPEED_UNITS[(context or {}).get("measured", SHAFT_SPEED)]


def _by_measured(vehicle_unit: str, shaft_unit: str, minimum: float | None = None) -> BeforeValidator:
    """Validator of a quantity, or a list of them, whose unit depends on the speed that is controlled."""

    def check(value: Any, info: ValidationInfo) -> Any:
        unit = vehicle_unit if _speed_unit(info.context) == "m/s" else shaft_unit
        if isinstance(value, list):
            return [checked(item, unit, minimum) for item in value]
        return checked(value, unit, minimum)

    return BeforeValidator(check)


class Reference(Strict, ABC):
    """A wanted speed."""

    def driving_cycle(self) -> Cycle | None:
        """The driving cycle to be followed, if it is one."""
        return None

    @abstractmethod
    def signal(self) -> Signal:
        """The wanted speed, constant or over time."""


class ConstantReference(Reference):
    """One speed all the time."""

    kind: Literal["constant"]
    speed: Annotated[float, _by_measured("m/s", "rad/s")]

    def signal(self) -> Signal:
        """The speed."""
        return self.speed


class TableReference(Tabulated, Reference):
    """A speed over time."""

    kind: Literal["table"]
    time: Times
    speed: Annotated[list[float], _by_measured("m/s", "rad/s")]

    @classmethod
    def columns(cls, context: Any = None) -> dict[str, str]:
        """Units of both columns: that of the speed follows from what hangs on the shaft."""
        return {"time": "s", "speed": _speed_unit(context)}


def _known_cycle(name: Any) -> str:
    if name not in CYCLES:
        raise ValueError(f"must be a driving cycle, is {name!r} {did_you_mean(name, CYCLES)}")
    return str(name)


class CycleReference(Reference):
    """A driving cycle."""

    kind: Literal["cycle"]
    cycle: Annotated[str, BeforeValidator(_known_cycle)]

    def driving_cycle(self) -> Cycle | None:
        """The cycle itself."""
        return CYCLES[self.cycle]

    def signal(self) -> Signal:
        """The speed over time, m/s."""
        cycle = CYCLES[self.cycle]
        return loops.Table(cycle.time, cycle.speed)


class Brake(Strict):
    """The driver's brake: a force in proportion to how much the vehicle is too fast."""

    gain: Annotated[float, quantity("N.s/m", 0.0)]
    maximum: Annotated[float, quantity("N", 0.0)]
    margin: Annotated[float, quantity("m/s", 0.0)] = 0.0


class PiController(Strict):
    """PI controller of the speed that commands omega1, with limits and anti-windup.

    Attributes:
        COMMAND: the input of the module that it commands. DRIVE: kind of [drive] that leaves it to it.
    """

    COMMAND: ClassVar[str] = "omega1"
    DRIVE: ClassVar[str] = "controlled"

    kind: Literal["pi"]
    proportional_gain: Annotated[float, _by_measured("rad/m", "1", 0.0)]
    integral_gain: Annotated[float, _by_measured("rad/m/s", "1/s", 0.0)] = 0.0
    feedforward: Annotated[float, _by_measured("rad/m", "1")] = 0.0
    minimum: AngularSpeed = 0.0
    maximum: AngularSpeed = LARGEST_SPEED
    reference: Annotated[ConstantReference | TableReference | CycleReference, Field(discriminator="kind")]
    brake: Brake | None = None

    @model_validator(mode="after")
    def _limits_in_order(self) -> Self:
        if not self.minimum < self.maximum:
            raise ValueError(must_be("minimum", f"below maximum = {self.maximum:g}", self.minimum))
        return self

    def build(self, step: float, measured: str) -> list[Any]:
        """Make the systems of reference, controller and brake, of this step, s."""
        systems = [
            loops.source("reference", self.reference.signal(), step),
            loops.pi_speed_controller(
                step,
                self.proportional_gain,
                self.integral_gain,
                (self.minimum, self.maximum),
                feedforward=self.feedforward,
                measured=measured,
                command=self.COMMAND,
            ),
        ]
        if self.brake is not None:
            systems.append(loops.driver_brake(step, self.brake.gain, self.brake.maximum, self.brake.margin))
        return systems


class PiTorqueController(PiController):
    """PI controller of the speed that commands drive_torque, within the limits of an engine or motor."""

    COMMAND: ClassVar[str] = "drive_torque"
    DRIVE: ClassVar[str] = "controlled_torque"

    kind: Literal["pi_torque"]  # type: ignore[assignment]
    proportional_gain: Annotated[float, _by_measured("N.s", "N.m.s/rad", 0.0)]
    integral_gain: Annotated[float, _by_measured("N", "N.m/rad", 0.0)] = 0.0
    feedforward: Annotated[float, _by_measured("N.s", "N.m.s/rad")] = 0.0
    minimum: Torque
    maximum: Torque


Controller = Annotated[PiController | PiTorqueController, Field(discriminator="kind")]
