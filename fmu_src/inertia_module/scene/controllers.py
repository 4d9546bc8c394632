"""Table [controller] of a scene: speed controller, its reference and the brake of the driver.

With a vehicle as load a controller controls the vehicle speed (m/s), with any other load omega_out (rad/s).
Numbers without a unit are in the unit of this speed.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from .. import driveline
from ..common.errors import must_be
from ..driveline.connection import Environment
from ..driveline.cycles import CYCLES, Cycle
from ..driveline.sources import Signal
from ..interface.variables import LARGEST_SPEED
from .keys import AngularSpeed, Strict, Tabulated, Times, Torque, checked, quantity


def _unit_by_load(vehicle_unit: str, shaft_unit: str, minimum: float | None = None) -> BeforeValidator:
    """Make a validator of a quantity with one unit for a vehicle as load and another for other loads."""

    def check(value: Any, info: ValidationInfo) -> Any:
        vehicle = (info.context or {}).get("vehicle")
        return checked(value, vehicle_unit if vehicle else shaft_unit, minimum)

    return BeforeValidator(check)


class ConstantReference(Strict):
    """Constant reference speed.

    Attributes:
        speed: Speed, m/s or rad/s.
    """

    kind: Literal["constant"]
    speed: Annotated[float, _unit_by_load("m/s", "rad/s")]

    def signal(self) -> Signal:
        """Return the reference speed: m/s for a vehicle, else rad/s."""
        return self.speed

    def driving_cycle(self) -> Cycle | None:
        """Return None, because a constant speed is not a driving cycle."""
        return None


class TableReference(Tabulated):
    """Reference speed over time.

    Attributes:
        time: Points, s.
        speed: Speed at each point, m/s or rad/s.
    """

    kind: Literal["table"]
    time: Times
    speed: list[Annotated[float, _unit_by_load("m/s", "rad/s")]]

    def driving_cycle(self) -> Cycle | None:
        """Return the table as a driving cycle of a vehicle."""
        name = Path(self.file).name if self.file else "the reference"
        return Cycle(name, np.array(self.time), np.array(self.speed))


CycleName: Any = Literal[tuple(CYCLES)]


class CycleReference(Strict):
    """Published driving cycle as reference.

    Attributes:
        cycle: Name of the cycle.
    """

    kind: Literal["cycle"]
    cycle: CycleName

    def signal(self) -> Signal:
        """Return the speed of the vehicle, m/s, over time, s."""
        return driveline.Table(CYCLES[self.cycle].time, CYCLES[self.cycle].speed)

    def driving_cycle(self) -> Cycle | None:
        """Return the published driving cycle."""
        return CYCLES[self.cycle]


class Brake(Strict):
    """Brake of the driver: a force proportional to the excess of the vehicle speed.

    Attributes:
        gain: Force per excess speed, N.s/m.
        maximum: Maximum force, N.
        margin: Speed above the reference at which the brake begins to act, m/s.
    """

    gain: Annotated[float, quantity("N.s/m", 0.0)]
    maximum: Annotated[float, quantity("N", 0.0)]
    margin: Annotated[float, quantity("m/s", 0.0)] = 0.0


class PiController(Strict):
    """PI speed controller with limits and anti-windup that commands the speed of link 1.

    Units depend on the controlled speed: m/s for a vehicle, else rad/s.

    Attributes:
        COMMAND: Input of the module that the controller commands.
        DRIVE: Kind of drive that the controller requires.
        proportional_gain: Command per speed error.
        integral_gain: Rate of the command per speed error.
        feedforward: Command per reference speed.
        minimum: Minimum command.
        maximum: Maximum command.
        reference: Reference speed.
        brake: Brake of the driver of a vehicle, or None.
    """

    COMMAND: ClassVar[str] = "omega1"
    DRIVE: ClassVar[str] = "controlled"

    kind: Literal["pi"]
    proportional_gain: Annotated[float, _unit_by_load("rad/m", "1", 0.0)]
    integral_gain: Annotated[float, _unit_by_load("rad/m/s", "1/s", 0.0)] = 0.0
    feedforward: Annotated[float, _unit_by_load("rad/m", "1")] = 0.0
    minimum: AngularSpeed = 0.0
    maximum: AngularSpeed = LARGEST_SPEED
    reference: Annotated[ConstantReference | TableReference | CycleReference, Field(discriminator="kind")]
    brake: Brake | None = None

    @model_validator(mode="after")
    def _limits_in_order(self) -> Self:
        if not self.minimum < self.maximum:
            raise ValueError(must_be("minimum", f"below maximum = {self.maximum:g}", self.minimum))
        return self

    def build(self, step: float, measured: str) -> list[Environment]:
        """Make the systems of reference, controller and brake.

        Args:
            step: Communication step, s.
            measured: Name of the controlled speed.
        """
        systems: list[Environment] = [
            driveline.Sources({"reference": self.reference.signal()}, step),
            driveline.pi_speed_controller(
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
            systems.append(
                driveline.driver_brake(step, self.brake.gain, self.brake.maximum, self.brake.margin)
            )
        return systems


class PiTorqueController(PiController):
    """PI speed controller that commands drive_torque within the limits of an engine or motor."""

    COMMAND: ClassVar[str] = "drive_torque"
    DRIVE: ClassVar[str] = "controlled_torque"

    kind: Literal["pi_torque"]  # type: ignore[assignment]
    proportional_gain: Annotated[float, _unit_by_load("N.s", "N.m.s/rad", 0.0)]
    integral_gain: Annotated[float, _unit_by_load("N", "N.m/rad", 0.0)] = 0.0
    feedforward: Annotated[float, _unit_by_load("N.s", "N.m.s/rad")] = 0.0
    minimum: Torque
    maximum: Torque


Controller = Annotated[PiController | PiTorqueController, Field(discriminator="kind")]
