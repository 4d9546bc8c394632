"""The [drive] of a scene: what turns link 1."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, Field

from .. import loops
from ..contract.variable import ENUMERATIONS
from ..kernel.codes import DRIVE_SPEED, DRIVE_TORQUE
from ..loops import torque_driven
from ..loops.sources import Signal, Table
from .engine import EngineDrive
from .errors import SceneError
from .loads import Torque
from .tables import AngularSpeed, Duration, Strict, Tabulated, Time, Times
from .units import quantities


class GivenDrive(Strict):
    """An input of the module is given, whatever the module does; INPUT is its name."""

    INPUT: ClassVar[str] = "omega1"

    def signal(self) -> Signal:
        """The input, constant or over time, rad/s or N.m."""
        raise NotImplementedError

    def systems(self, step: float) -> list[Any]:
        """The system that gives the input, of this step, s."""
        return [loops.source(self.INPUT, self.signal(), step)]


class ConstantDrive(GivenDrive):
    """Link 1 turns at constant speed."""

    kind: Literal["constant"]
    omega1: AngularSpeed

    def signal(self) -> Signal:
        """Speed of link 1, rad/s."""
        return self.omega1


class RampDrive(GivenDrive):
    """The speed of link 1 changes linearly between two values and is held before and after."""

    kind: Literal["ramp"]
    initial: AngularSpeed
    final: AngularSpeed
    start: Time = 0.0
    duration: Duration

    def signal(self) -> Signal:
        """Speed of link 1 over time, rad/s."""
        return Table([self.start, self.start + self.duration], [self.initial, self.final])


class TableDrive(Tabulated, GivenDrive):
    """The speed of link 1 over time."""

    VALUES: ClassVar[str] = "omega1"
    UNITS: ClassVar[tuple[str, str]] = ("s", "rad/s")

    kind: Literal["table"]
    time: Times
    omega1: Annotated[list[float], quantities("rad/s")]


class ControlledDrive(Strict):
    """The speed of link 1 is what [controller] commands."""

    kind: Literal["controlled"]

    def systems(self, _: float) -> list[Any]:
        """None: the command is that of the controller."""
        return []


class TorqueDrive(Strict):
    """A torque on link 1, whose speed follows from it.

    Attributes:
        omega1: speed of link 1 at the start, rad/s.
    """

    omega1: AngularSpeed = 0.0

    @property
    def start_speed(self) -> float:
        """Speed of link 1 at the start, rad/s."""
        return self.omega1


class ControlledTorque(TorqueDrive):
    """The torque on link 1 is what [controller] commands."""

    kind: Literal["controlled_torque"]

    def systems(self, _: float) -> list[Any]:
        """None: the command is that of the controller."""
        return []


class ConstantTorque(TorqueDrive, GivenDrive):
    """A constant torque on link 1, N.m."""

    INPUT: ClassVar[str] = "drive_torque"

    kind: Literal["torque"]
    drive_torque: Torque

    def signal(self) -> Signal:
        """Torque on link 1, N.m."""
        return self.drive_torque


class TorqueTable(Tabulated, TorqueDrive, GivenDrive):
    """A torque on link 1 over time, s, N.m."""

    INPUT: ClassVar[str] = "drive_torque"
    VALUES: ClassVar[str] = "drive_torque"
    UNITS: ClassVar[tuple[str, str]] = ("s", "N.m")

    kind: Literal["torque_table"]
    time: Times
    drive_torque: Annotated[list[float], quantities("N.m")]


# drives that take the module's drive = torque
TORQUE_DRIVES = (TorqueDrive, EngineDrive)
# drives that leave it to [controller]
CONTROLLED_DRIVES = (ControlledDrive, ControlledTorque)

Drive = Annotated[
    ConstantDrive
    | RampDrive
    | TableDrive
    | ControlledDrive
    | ConstantTorque
    | TorqueTable
    | ControlledTorque
    | EngineDrive,
    Field(discriminator="kind"),
]


def with_drive(drive: BaseModel, parameters: Mapping[str, float]) -> dict[str, float]:
    """Parameters of the module with what its drive adds to them: how it is driven, the rotor of an engine."""
    if isinstance(drive, EngineDrive):
        return torque_driven(parameters, drive.inertia)
    return (
        {**parameters, "drive": float(DRIVE_TORQUE)} if isinstance(drive, TORQUE_DRIVES) else {**parameters}
    )


def check_drive(drive: Any, given: float | None) -> None:
    """Refuse a mechanism.drive that contradicts the drive of the scene.

    Raises:
        SceneError: what is given, and what is allowed.
    """
    torque = isinstance(drive, TORQUE_DRIVES)
    needed = DRIVE_TORQUE if torque else DRIVE_SPEED
    if given is None or given == needed:
        return
    names = {number: name for name, number, _ in ENUMERATIONS["Drive"]}
    others = "a drive.kind that gives a speed" if torque else "a drive.kind that gives a torque"
    raise SceneError(
        f"with drive.kind = {drive.kind!r} mechanism.drive must be {names[needed]!r}, which the scene sets"
        f" itself, is {names[int(given)]!r}; it needs {others}"
    )
