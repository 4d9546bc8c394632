"""An engine as [drive] of a scene: torque over speed, throttle, idle and top speed kept by a governor."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from .. import loops
from ..common.errors import must_be
from ..contract.variable import LARGEST_SPEED
from ..loops import EngineMap, Governor
from .tables import Strict, Tabulated, Times, one_signal
from .units import quantities, quantity

Turning = Annotated[float, quantity("rad/s", 0.0, LARGEST_SPEED)]


class TorqueOverSpeed(Tabulated):
    """A torque over the speed of the engine, constant beyond the ends."""

    POINTS: ClassVar[str] = "speed"
    VALUES: ClassVar[str] = "torque"
    UNITS: ClassVar[tuple[str, str]] = ("rad/s", "N.m")

    speed: Annotated[list[float], quantities("rad/s")]
    torque: Annotated[list[float], quantities("N.m", 0.0)]


class ThrottleOverTime(Tabulated):
    """The throttle over time, from 0, closed, to 1, full load."""

    VALUES: ClassVar[str] = "throttle"
    UNITS: ClassVar[tuple[str, str]] = ("s", "1")

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


class EngineDrive(Strict):
    """An engine on link 1, whose speed follows from its torque.

    The throttle shares out the torque between closed, -drag, and full load. Below the idle speed a governor
    gives more, above the top speed another one less. The control unit samples the speed once a communication
    step and holds the torque over it.

    Attributes:
        inertia: of the rotor and all that turns with it, besides mechanism.input_inertia, kg.m2.
        full_load, drag: torque at full load, and against the motion with the throttle closed, N.m.
        throttle, throttle_over_time: one of both, 0 to 1. omega1: at the start, rad/s, else the idle speed.
    """

    kind: Literal["engine"]
    inertia: Annotated[float, quantity("kg.m2", above=0.0)]
    full_load: TorqueOverSpeed
    drag: TorqueOverSpeed | None = None
    throttle: Annotated[float, quantity("1", 0.0, 1.0)] | None = None
    throttle_over_time: ThrottleOverTime | None = None
    governor: EngineGovernor
    omega1: Turning | None = None

    @model_validator(mode="after")
    def _one_throttle(self) -> EngineDrive:
        one_signal("throttle", self.throttle, self.throttle_over_time)
        return self

    @property
    def start_speed(self) -> float:
        """Speed of link 1 at the start, rad/s."""
        return self.governor.idle if self.omega1 is None else self.omega1

    def torque_map(self) -> EngineMap:
        """Limits of the torque over the speed."""
        full, drag = self.full_load, self.drag or TorqueOverSpeed(speed=[0.0], torque=[0.0])
        speeds = np.union1d(full.speed, drag.speed)
        both = (np.interp(speeds, table.speed, table.torque).tolist() for table in (full, drag))
        return EngineMap(tuple(speeds.tolist()), *map(tuple, both))

    def check_step(self, step: float, inertia: float) -> None:
        """Refuse a step, s, over which the torque held by the governor would turn the engine's error round.

        Args:
            step: s. inertia: of engine and link 1, kg.m2.

        Raises:
            ValueError: the step is too long.
        """
        gain = self.governor.proportional_gain
        if step * gain > inertia:
            raise ValueError(
                f"with drive.governor.proportional_gain = {gain:g} N.m.s/rad the step must be at most inertia"
                f" over gain, {inertia / gain:g} s, is {step:g} s"
            )

    def systems(self, step: float) -> list[Any]:
        """The systems that give throttle and drive_torque, of this step, s."""
        throttle = one_signal("throttle", self.throttle, self.throttle_over_time)
        return [loops.source("throttle", throttle, step), self._engine(step)]

    def _engine(self, step: float) -> Any:
        """From throttle and input_speed, rad/s, to drive_torque, N.m; state: integrals of the governors."""
        import control as ct

        limits, given = self.torque_map(), self.governor
        governor = Governor(given.proportional_gain, given.integral_gain, step)

        def sample(x: Any, u: Any) -> tuple[float, float, float]:
            """Torque and integrals: what the throttle asks for, raised to keep idle, cut at the top speed."""
            throttle, speed = u
            closed, full = limits.limits(speed)
            asked = closed + throttle * (full - closed)
            kept, idle = governor.sample(x[0], given.idle, speed, (asked, full))
            torque, top = governor.sample(x[1], given.top_speed, speed, (closed, kept))
            return torque, idle, top

        return ct.nlsys(
            lambda _, x, u, __: sample(x, u)[1:],
            lambda _, x, u, __: sample(x, u)[:1],
            inputs=["throttle", "input_speed"],
            outputs=["drive_torque"],
            states=["idle_integral", "top_integral"],
            dt=step,
            name="engine",
        )
