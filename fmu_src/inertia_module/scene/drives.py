"""The [drive] of a scene: what turns link 1. A speed or a torque, given or commanded; an engine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from .. import loops
from ..common.errors import must_be
from ..contract.variables import LARGEST_SPEED
from ..kernel.codes import DRIVE_SPEED, DRIVE_TORQUE
from ..loops.sources import Signal, Table
from .fields import (
    AngularSpeed,
    ConstantOrTable,
    Duration,
    Strict,
    Tabulated,
    Time,
    Times,
    Torque,
    quantities,
    quantity,
)

Turning = Annotated[float, quantity("rad/s", 0.0, LARGEST_SPEED)]


class AnyDrive(Strict):
    """A drive of link 1.

    Attributes:
        INPUT: of the module, which the drive gives. COMMANDED: it leaves that to [controller].
    """

    INPUT: ClassVar[str] = "omega1"
    COMMANDED: ClassVar[bool] = False

    @property
    def mode(self) -> int:
        """Value of the module's parameter drive."""
        return DRIVE_SPEED if self.INPUT == "omega1" else DRIVE_TORQUE

    @property
    def start_speed(self) -> float | None:
        """Speed of link 1 at the start, rad/s, of a drive that gives a torque."""
        return None

    def signal(self) -> Signal | None:
        """The input, rad/s or N.m, constant or over time, if it follows from nothing the module does."""
        given: Signal | None = getattr(self, self.INPUT, None)
        return given

    def prescribed(self) -> dict[str, Signal]:
        """Inputs of the module that follow from nothing the module does, by name."""
        signal = self.signal()
        return {} if signal is None else {self.INPUT: signal}

    def systems(self, step: float) -> list[Any]:
        """Make the systems that give the inputs, of this step, s."""
        return [loops.source(name, signal, step) for name, signal in self.prescribed().items()]

    def driven(self, parameters: Mapping[str, float]) -> dict[str, float]:
        """Parameters of the module with what its drive adds to them."""
        return {**parameters} if self.mode == DRIVE_SPEED else {**parameters, "drive": float(DRIVE_TORQUE)}

    def check_step(self, step: float, inertia: float) -> None:
        """Refuse a step that is too long for the drive.

        Args:
            step: s. inertia: of all that turns with link 1, kg.m2.

        Raises:
            ValueError: the step is too long.
        """


class ConstantDrive(AnyDrive):
    """Link 1 turns at constant speed."""

    kind: Literal["constant"]
    omega1: AngularSpeed


class RampDrive(AnyDrive):
    """The speed of link 1 changes linearly between two values and is held before and after."""

    kind: Literal["ramp"]
    initial: AngularSpeed
    final: AngularSpeed
    start: Time = 0.0
    duration: Duration

    def signal(self) -> Signal:
        """Speed of link 1 over time, rad/s."""
        return Table([self.start, self.start + self.duration], [self.initial, self.final])


class TableDrive(Tabulated, AnyDrive):
    """The speed of link 1 over time."""

    kind: Literal["table"]
    time: Times
    omega1: Annotated[list[float], quantities("rad/s")]


class ControlledDrive(AnyDrive):
    """The speed of link 1 is what [controller] commands."""

    COMMANDED: ClassVar[bool] = True

    kind: Literal["controlled"]


class TorqueDrive(AnyDrive):
    """A torque on link 1, whose speed follows from it.

    Attributes:
        omega1: speed of link 1 at the start, rad/s.
    """

    INPUT: ClassVar[str] = "drive_torque"

    omega1: AngularSpeed = 0.0

    @property
    def start_speed(self) -> float | None:
        """Speed of link 1 at the start, rad/s."""
        return self.omega1


class ControlledTorque(TorqueDrive):
    """The torque on link 1 is what [controller] commands."""

    COMMANDED: ClassVar[bool] = True

    kind: Literal["controlled_torque"]


class ConstantTorque(TorqueDrive):
    """A constant torque on link 1, N.m."""

    kind: Literal["torque"]
    drive_torque: Torque


class TorqueTable(Tabulated, TorqueDrive):
    """A torque on link 1 over time, s, N.m."""

    kind: Literal["torque_table"]
    time: Times
    drive_torque: Annotated[list[float], quantities("N.m")]


class TorqueOverSpeed(Tabulated):
    """A torque over the speed of the engine, constant beyond the ends."""

    speed: Annotated[list[float], quantities("rad/s")]
    torque: Annotated[list[float], quantities("N.m", 0.0)]


class ThrottleOverTime(Tabulated):
    """The throttle over time, from 0, closed, to 1, full load."""

    time: Times
    throttle: Annotated[list[float], quantities("1", 0.0, 1.0)]


class EngineGovernor(Strict):
    """PI governors of the idle and of the top speed, with the same gains."""

    idle: Turning
    top_speed: Turning
    proportional_gain: Annotated[float, quantity("N.m.s/rad", above=0.0)]
    integral_gain: Annotated[float, quantity("N.m/rad", 0.0)] = 0.0

    @model_validator(mode="after")
    def _in_order(self) -> EngineGovernor:
        if not self.idle < self.top_speed:
            raise ValueError(must_be("idle", f"below top_speed = {self.top_speed:g} rad/s", self.idle))
        return self


class EngineDrive(ConstantOrTable, AnyDrive):
    """An engine on link 1, whose speed follows from its torque.

    The throttle shares out the torque between closed, -drag, and full load. Below the idle speed a governor
    gives more, above the top speed another one less. The control unit samples the speed once a communication
    step and holds the torque over it.

    Attributes:
        inertia: of the rotor and all that turns with it, besides mechanism.input_inertia, kg.m2.
        full_load, drag: torque at full load, and against the motion with the throttle closed, N.m.
        throttle, throttle_over_time: one of both, 0 to 1. omega1: at the start, rad/s, else the idle speed.
    """

    INPUT: ClassVar[str] = "drive_torque"
    SIGNAL: ClassVar[str] = "throttle"

    kind: Literal["engine"]
    inertia: Annotated[float, quantity("kg.m2", above=0.0)]
    full_load: TorqueOverSpeed
    drag: TorqueOverSpeed | None = None
    throttle: Annotated[float, quantity("1", 0.0, 1.0)] | None = None
    throttle_over_time: ThrottleOverTime | None = None
    governor: EngineGovernor
    omega1: Turning | None = None

    @property
    def start_speed(self) -> float | None:
        """Speed of link 1 at the start, rad/s."""
        return self.governor.idle if self.omega1 is None else self.omega1

    def torque_map(self) -> loops.EngineMap:
        """Limits of the torque over the speed."""
        full, drag = self.full_load, self.drag or TorqueOverSpeed(speed=[0.0], torque=[0.0])
        speeds = np.union1d(full.speed, drag.speed)
        both = (np.interp(speeds, table.speed, table.torque).tolist() for table in (full, drag))
        return loops.EngineMap(tuple(speeds.tolist()), *map(tuple, both))

    def driven(self, parameters: Mapping[str, float]) -> dict[str, float]:
        """Parameters of the module, which carries the rotor of the engine."""
        return loops.torque_driven(parameters, self.inertia)

    def check_step(self, step: float, inertia: float) -> None:
        """Refuse a step over which the torque held by the governor would turn the engine's error round."""
        gain = self.governor.proportional_gain
        if step * gain > inertia:
            raise ValueError(
                f"with drive.governor.proportional_gain = {gain:g} N.m.s/rad the step must be at most inertia"
                f" over gain, {inertia / gain:g} s, is {step:g} s"
            )

    def systems(self, step: float) -> list[Any]:
        """Make the source of the throttle, and the engine.

        From throttle and input_speed, rad/s, to drive_torque, N.m; state: integrals of the governors.
        """
        import control as ct

        limits, given = self.torque_map(), self.governor
        governor = loops.Governor(given.proportional_gain, given.integral_gain, step)

        def sample(x: Any, u: Any) -> tuple[float, float, float]:
            """Torque and integrals: what the throttle asks for, raised to keep idle, cut at the top speed."""
            throttle, speed = u
            closed, full = limits.limits(speed)
            asked = closed + throttle * (full - closed)
            kept, idle = governor.sample(x[0], given.idle, speed, (asked, full))
            torque, top = governor.sample(x[1], given.top_speed, speed, (closed, kept))
            return torque, idle, top

        engine = ct.nlsys(
            lambda _, x, u, __: sample(x, u)[1:],
            lambda _, x, u, __: sample(x, u)[:1],
            inputs=["throttle", "input_speed"],
            outputs=["drive_torque"],
            states=["idle_integral", "top_integral"],
            dt=step,
            name="engine",
        )
        return [loops.source("throttle", self.one_signal(), step), engine]


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
