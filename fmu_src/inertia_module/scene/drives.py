"""The [drive] of a scene: what turns link 1."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from ..loops import Table
from ..variables import LARGEST_SPEED
from .tables import Duration, Strict, Tabulated, Time, Times
from .units import quantities, quantity

AngularSpeed = Annotated[float, quantity("rad/s", -LARGEST_SPEED, LARGEST_SPEED)]


class ConstantDrive(Strict):
    """Link 1 turns at constant speed."""

    kind: Literal["constant"]
    omega1: AngularSpeed

    def signal(self) -> float | Table:
        """Speed of link 1, rad/s."""
        return self.omega1


class RampDrive(Strict):
    """The speed of link 1 changes linearly between two values and is held before and after."""

    kind: Literal["ramp"]
    initial: AngularSpeed
    final: AngularSpeed
    start: Time = 0.0
    duration: Duration

    def signal(self) -> float | Table:
        """Speed of link 1 over time, rad/s."""
        return Table([self.start, self.start + self.duration], [self.initial, self.final])


class TableDrive(Tabulated):
    """The speed of link 1 over time."""

    VALUES: ClassVar[str] = "omega1"
    UNITS: ClassVar[tuple[str, str]] = ("s", "rad/s")

    kind: Literal["table"]
    time: Times
    omega1: Annotated[list[float], quantities("rad/s")]

    def signal(self) -> float | Table:
        """Speed of link 1 over time, rad/s."""
        return self.table()


class ControlledDrive(Strict):
    """The speed of link 1 is what [controller] commands."""

    kind: Literal["controlled"]


Drive = Annotated[ConstantDrive | RampDrive | TableDrive | ControlledDrive, Field(discriminator="kind")]
