"""Table [drive] of a scene: speed or torque of link 1, or an engine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from .. import driveline
from ..common.errors import must_be
from ..driveline.connection import Environment
from ..driveline.engine import check_drag, check_rising
from ..driveline.sources import Signal, Sources, Table
from ..interface.variables import LARGEST_SPEED
from ..kernel.codes import DRIVE_SPEED, DRIVE_TORQUE
from .keys import AngularSpeed, ConstantOrTable, Duration, Strict, Tabulated, Times, Torque, quantity

ForwardSpeed = Annotated[float, quantity("rad/s", 0.0, LARGEST_SPEED)]


class AnyDrive(Strict):
    """Base of the drives of link 1.

    Attributes:
        INPUT: Input of the module that the drive prescribes.
    """

    INPUT: ClassVar[str] = "omega1"

    @property
    def mode(self) -> int:
        """Return the value of the parameter ``drive`` of the module."""
        return DRIVE_SPEED if self.INPUT == "omega1" else DRIVE_TORQUE

    @property
    def start_speed(self) -> float | None:
        """Return the initial speed of link 1, rad/s; None for a drive that prescribes the speed."""
        return None

    def signal(self) -> Signal | None:
        """Return the input, rad/s or N.m, constant or over time; None if it depends on the state."""
        signal: Signal | None = getattr(self, self.INPUT, None)
        return signal

    def systems(self, step: float) -> list[Environment]:
        """Make the systems that produce the input.

        Args:
            step: Communication step, s.
        """
        signal = self.signal()
        return [] if signal is None else [Sources({self.INPUT: signal}, step)]

    def driven(self, parameters: Mapping[str, float]) -> dict[str, float]:
        """Return the parameters of the module, including the contribution of the drive.

        Args:
            parameters: Parameters of the mechanism, SI, by name.
        """
        return {**parameters} if self.mode == DRIVE_SPEED else {**parameters, "drive": float(DRIVE_TORQUE)}

    def check_step(self, step: float, inertia: float) -> None:
        """Reject a communication step that is too long for the drive.

        Args:
            step: Communication step, s.
            inertia: Inertia of all parts that rotate with link 1, kg.m2.

        Raises:
            ValueError: The step is too long.
        """


class ConstantDrive(AnyDrive):
    """Constant speed of link 1.

    Attributes:
        omega1: Speed, rad/s.
    """

    kind: Literal["constant"]
    omega1: AngularSpeed


class RampDrive(AnyDrive):
    """Speed of link 1 that changes linearly between two values and is constant before and after.

    Attributes:
        initial: Speed before the ramp, rad/s.
        final: Speed after the ramp, rad/s.
        start: Start of the ramp, s.
        duration: Duration of the ramp, s.
    """

    kind: Literal["ramp"]
    initial: AngularSpeed
    final: AngularSpeed
    start: Annotated[float, quantity("s", 0.0)] = 0.0
    duration: Duration

    def signal(self) -> Signal:
        """Return the speed of link 1, rad/s, over time, s."""
        return Table([self.start, self.start + self.duration], [self.initial, self.final])


class TableDrive(Tabulated, AnyDrive):
    """Speed of link 1 over time.

    Attributes:
        time: Points, s.
        omega1: Speed at each point, rad/s.
    """

    kind: Literal["table"]
    time: Times
    omega1: list[Annotated[float, quantity("rad/s")]]


class ControlledDrive(AnyDrive):
    """Speed of link 1 that the controller commands."""

    kind: Literal["controlled"]


class TorqueDrive(AnyDrive):
    """Base of the drives that prescribe a torque on link 1; its speed follows from the torque.

    Attributes:
        omega1: Initial speed of link 1, rad/s.
    """

    INPUT: ClassVar[str] = "drive_torque"

    omega1: AngularSpeed = 0.0

    @property
    def start_speed(self) -> float | None:
        """Return the initial speed of link 1, rad/s."""
        return self.omega1


class ControlledTorque(TorqueDrive):
    """Torque on link 1 that the controller commands."""

    kind: Literal["controlled_torque"]


class ConstantTorque(TorqueDrive):
    """Constant torque on link 1.

    Attributes:
        drive_torque: Torque, N.m.
    """

    kind: Literal["torque"]
    drive_torque: Torque


class TorqueTable(Tabulated, TorqueDrive):
    """Torque on link 1 over time.

    Attributes:
        time: Points, s.
        drive_torque: Torque at each point, N.m.
    """

    kind: Literal["torque_table"]
    time: Times
    drive_torque: list[Annotated[float, quantity("N.m")]]


class TorqueOverSpeed(Tabulated):
    """Torque over the speed of the engine, constant beyond the ends.

    Attributes:
        speed: Points, rad/s, increasing.
        torque: Torque at each point, N.m.
    """

    speed: list[Annotated[float, quantity("rad/s")]]
    torque: list[Annotated[float, quantity("N.m", 0.0)]]

    @model_validator(mode="after")
    def _rising(self) -> TorqueOverSpeed:
        check_rising(self.speed)
        return self


class ThrottleOverTime(Tabulated):
    """Throttle over time.

    Attributes:
        time: Points, s.
        throttle: Throttle at each point, 0 (closed) to 1 (full load).
    """

    time: Times
    throttle: list[Annotated[float, quantity("1", 0.0, 1.0)]]


class DragOverSpeed(TorqueOverSpeed):
    """Magnitude of a torque against the motion, over the speed of the engine.

    Attributes:
        torque: Torque at each point, N.m.
    """

    torque: list[Annotated[float, quantity("N.m")]]

    @model_validator(mode="after")
    def _against_the_motion(self) -> Self:
        check_drag("torque", self.torque)
        return self


class EngineGovernor(Strict):
    """PI governors of the idle speed and of the top speed, with the same gains.

    Attributes:
        idle: Idle speed, rad/s.
        top_speed: Top speed, rad/s.
        proportional_gain: Proportional gain of both governors, N.m.s/rad.
        integral_gain: Integral gain of both governors, N.m/rad.
    """

    idle: ForwardSpeed
    top_speed: ForwardSpeed
    proportional_gain: Annotated[float, quantity("N.m.s/rad", above=0.0)]
    integral_gain: Annotated[float, quantity("N.m/rad", 0.0)] = 0.0

    @model_validator(mode="after")
    def _in_order(self) -> EngineGovernor:
        if not self.idle < self.top_speed:
            raise ValueError(must_be("idle", f"below top_speed = {self.top_speed:g} rad/s", self.idle))
        return self


class EngineDrive(ConstantOrTable, AnyDrive):
    """Engine on link 1, whose speed follows from its torque.

    The throttle interpolates between -drag (closed) and full load. One governor raises the torque below the
    idle speed, another one cuts it above the top speed. The control unit samples the speed once per
    communication step and holds the torque over the step.

    Attributes:
        inertia: Inertia of the rotor and all parts that rotate with it, added to mechanism.input_inertia,
            kg.m2.
        full_load: Torque at full load over speed.
        drag: Torque against the motion with the throttle closed, over speed; None for no drag.
        throttle: Constant throttle, 0 to 1; None with throttle_over_time.
        throttle_over_time: Throttle over time; None with throttle.
        governor: Governors of idle speed and top speed.
        omega1: Initial speed of link 1, rad/s; None for the idle speed.
    """

    INPUT: ClassVar[str] = "drive_torque"
    SIGNAL: ClassVar[str] = "throttle"

    kind: Literal["engine"]
    inertia: Annotated[float, quantity("kg.m2", above=0.0)]
    full_load: TorqueOverSpeed
    drag: DragOverSpeed | None = None
    throttle: Annotated[float, quantity("1", 0.0, 1.0)] | None = None
    throttle_over_time: ThrottleOverTime | None = None
    governor: EngineGovernor
    omega1: ForwardSpeed | None = None

    @property
    def start_speed(self) -> float | None:
        """Return the initial speed of link 1, rad/s."""
        return self.governor.idle if self.omega1 is None else self.omega1

    def torque_map(self) -> driveline.EngineMap:
        """Return the limits of the torque over the speed."""
        full, drag = self.full_load, self.drag or DragOverSpeed(speed=[0.0], torque=[0.0])
        speeds = np.union1d(full.speed, drag.speed)
        torques = (np.interp(speeds, table.speed, table.torque).tolist() for table in (full, drag))
        return driveline.EngineMap(tuple(speeds.tolist()), *map(tuple, torques))

    def driven(self, parameters: Mapping[str, float]) -> dict[str, float]:
        """Return the parameters of the module with the inertia of the rotor added to link 1.

        Args:
            parameters: Parameters of the mechanism, SI, by name.
        """
        return driveline.torque_driven(parameters, self.inertia)

    def check_step(self, step: float, inertia: float) -> None:
        """Reject a step in which the constant governor torque would reverse the sign of the speed error.

        Args:
            step: Communication step, s.
            inertia: Inertia of all parts that rotate with link 1, kg.m2.

        Raises:
            ValueError: The step is too long.
        """
        gain = self.governor.proportional_gain
        if step * gain > inertia:
            raise ValueError(
                f"the step must be at most inertia / gain = {inertia / gain:g} s with"
                f" drive.governor.proportional_gain = {gain:g} N.m.s/rad (got {step:g} s)"
            )

    def systems(self, step: float) -> list[Environment]:
        """Make the source of the throttle and the engine.

        Args:
            step: Communication step, s.
        """
        governor = self.governor
        engine = driveline.governed_engine(
            step,
            self.torque_map(),
            idle=governor.idle,
            top_speed=governor.top_speed,
            proportional_gain=governor.proportional_gain,
            integral_gain=governor.integral_gain,
        )
        return [Sources({"throttle": self.one_signal()}, step), engine]


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
