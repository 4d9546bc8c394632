"""Tables of a scene for the environment of its mechanism: [drive], [load], [controller].

With a vehicle as load a controller controls the vehicle speed (m/s), with any other load omega_out (rad/s).
Numbers without a unit are in the unit of this speed.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from .. import driveline
from ..common.errors import must_be
from ..driveline.cycles import CYCLES, KILOMETRE_PER_HOUR, Cycle
from ..driveline.engine import check_drag, check_rising
from ..driveline.loads import STANDARD_GRAVITY
from ..driveline.sources import Sampled, Signal, Table
from ..interface.variables import LARGEST_SPEED
from ..kernel.codes import DRIVE_SPEED, DRIVE_TORQUE
from .keys import AngularSpeed, ConstantOrTable, Duration, Strict, Tabulated, Times, Torque, checked, quantity

# --- drives ---

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

    def systems(self, step: float) -> list[Any]:
        """Make the systems that produce the input.

        Args:
            step: Communication step, s.
        """
        signal = self.signal()
        return [] if signal is None else [driveline.source(self.INPUT, signal, step)]

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

    def systems(self, step: float) -> list[Any]:
        """Make the source of the throttle and the engine.

        Inputs of the engine are throttle and input_speed, rad/s; its output is drive_torque, N.m. Its states
        are the integrals of the governors.

        Args:
            step: Communication step, s.
        """
        limits, settings = self.torque_map(), self.governor
        governor = driveline.Governor(settings.proportional_gain, settings.integral_gain, step)

        def law(_: float, x: Any, u: Any) -> tuple[list[float], list[float]]:
            """Return torque and integrals: the throttle torque, raised at idle speed, cut at top speed."""
            throttle, speed = u
            closed, full = limits.limits(speed)
            throttle_torque = closed + throttle * (full - closed)
            raised_torque, idle = governor.sample(x[0], settings.idle, speed, (throttle_torque, full))
            torque, top = governor.sample(x[1], settings.top_speed, speed, (closed, raised_torque))
            return [torque], [idle, top]

        signals, integrals = ["throttle", "input_speed"], ["idle_integral", "top_integral"]
        engine = Sampled("engine", step, signals, ["drive_torque"], law, integrals)
        return [driveline.source("throttle", self.one_signal(), step), engine]


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


# --- loads ---


class Coupling(Strict):
    """Elastic coupling between output shaft and load, which are rigidly connected without it.

    Attributes:
        stiffness: Stiffness, N.m/rad.
        damping: Damping, N.m.s/rad.
    """

    stiffness: Annotated[float, quantity("N.m/rad", above=0.0)]
    damping: Annotated[float, quantity("N.m.s/rad", 0.0)] = 0.0


def _coupling(table: Coupling | None) -> driveline.Coupling | None:
    return None if table is None else driveline.Coupling(table.stiffness, table.damping)


class TorqueOverTime(Tabulated):
    """Torque over time.

    Attributes:
        time: Points, s.
        torque: Torque at each point, N.m.
    """

    time: Times
    torque: list[Annotated[float, quantity("N.m")]]


class SlopeOverDistance(Tabulated):
    """Slope of the road over distance.

    Attributes:
        distance: Points, m.
        slope: Slope (rise over run) at each point.
    """

    distance: list[Annotated[float, quantity("m")]]
    slope: list[Annotated[float, quantity("1")]]


class TorqueLoad(ConstantOrTable):
    """Torque against the output shaft that does not depend on the motion.

    Attributes:
        torque: Constant torque, N.m; None with torque_over_time.
        torque_over_time: Torque over time; None with torque.
    """

    SIGNAL: ClassVar[str] = "torque"

    kind: Literal["torque"]
    torque: Torque | None = None
    torque_over_time: TorqueOverTime | None = None

    def build(self, step: float, prevents_reverse: bool, start_speed: float) -> driveline.Load:
        """Make the load as a system.

        Args:
            step: Communication step, s.
            prevents_reverse: True if the shaft cannot rotate backward.
            start_speed: Initial speed of the shaft, rad/s.
        """
        return driveline.Load(driveline.source("load_torque", self.one_signal(), step))


class ShaftLoad(Strict):
    """Shaft with inertia, viscous friction and a constant torque.

    Attributes:
        inertia: Inertia, kg.m2.
        viscous_friction: Viscous friction, N.m.s/rad.
        torque: Torque against forward motion, N.m.
        coupling: Elastic coupling to the output shaft; None for a rigid connection.
    """

    kind: Literal["shaft"]
    inertia: Annotated[float, quantity("kg.m2", above=0.0)]
    viscous_friction: Annotated[float, quantity("N.m.s/rad", 0.0)] = 0.0
    torque: Torque = 0.0
    coupling: Coupling | None = None

    def build(self, step: float, prevents_reverse: bool, start_speed: float) -> driveline.Load:
        """Make the shaft as a load as a system.

        Args:
            step: Communication step, s.
            prevents_reverse: True if the shaft cannot rotate backward.
            start_speed: Initial speed of the shaft, rad/s.
        """
        return driveline.shaft_load(
            step, self.inertia, self.viscous_friction, self.torque, _coupling(self.coupling)
        )


class VehicleLoad(Strict):
    """Vehicle on a road, behind a final drive.

    Attributes:
        mass: Mass of the vehicle, kg.
        wheel_radius: Radius of the wheels, m.
        final_drive: Speed of the output shaft over the speed of the wheels.
        rolling_resistance: Rolling resistance over normal force.
        drag_area: Drag coefficient times frontal area, m2.
        air_density: Density of the air, kg/m3.
        slope: Constant slope of the road (rise over run).
        slope_over_distance: Slope over distance, which replaces slope.
        coupling: Elastic coupling to the output shaft; None for a rigid connection.
        times_to: Target speeds of the acceleration times in the summary, m/s.
        friction_coefficient: Maximum tractive force over the load of the driven axles; None for no check.
        driven_axle_load: Load of the driven axles, N; None for the weight of the vehicle.
    """

    kind: Literal["vehicle"]
    mass: Annotated[float, quantity("kg", above=0.0)]
    wheel_radius: Annotated[float, quantity("m", above=0.0)]
    final_drive: Annotated[float, quantity("1", above=0.0)]
    rolling_resistance: Annotated[float, quantity("1", 0.0, 1.0)] = 0.01
    drag_area: Annotated[float, quantity("m2", 0.0)] = 0.0
    air_density: Annotated[float, quantity("kg/m3", 0.0)] = 1.2
    slope: Annotated[float, quantity("1", -1.0, 1.0)] = 0.0
    slope_over_distance: SlopeOverDistance | None = None
    coupling: Coupling | None = None
    times_to: list[Annotated[float, quantity("m/s", 0.0)]] = Field(
        default=[50.0 * KILOMETRE_PER_HOUR, 100.0 * KILOMETRE_PER_HOUR]
    )

    friction_coefficient: Annotated[float, quantity("1", maximum=3.0, above=0.0)] | None = None
    driven_axle_load: Annotated[float, quantity("N", above=0.0)] | None = None

    @model_validator(mode="after")
    def _check_grip(self) -> Self:
        if self.driven_axle_load is None:
            return self
        weight = self.mass * STANDARD_GRAVITY
        if self.friction_coefficient is None:
            raise ValueError("driven_axle_load requires friction_coefficient")
        if self.driven_axle_load > weight * (1.0 + 1e-9):
            allowed = f"at most the weight of the vehicle, {weight:g} N"
            raise ValueError(must_be("driven_axle_load", allowed, self.driven_axle_load))
        return self

    @property
    def grip(self) -> float | None:
        """Return the maximum tractive force, N (Coulomb friction); None without a friction coefficient."""
        if self.friction_coefficient is None:
            return None
        return self.friction_coefficient * (self.driven_axle_load or self.mass * STANDARD_GRAVITY)

    def build(self, step: float, prevents_reverse: bool, start_speed: float) -> driveline.Load:
        """Make the vehicle as a load as a system.

        Args:
            step: Communication step, s.
            prevents_reverse: True if the shaft cannot rotate backward.
            start_speed: Initial speed of the shaft, rad/s.
        """
        table, coupling = self.slope_over_distance, _coupling(self.coupling)
        others = {"kind", "slope", "slope_over_distance", "coupling", "times_to"}
        own = self.model_dump(exclude=others | {"friction_coefficient", "driven_axle_load"})
        slope = self.slope if table is None else table.signal()
        return driveline.vehicle_load(
            step, **own, slope=slope, one_way=prevents_reverse, coupling=coupling, start_speed=start_speed
        )


Load = Annotated[TorqueLoad | ShaftLoad | VehicleLoad, Field(discriminator="kind")]


# --- controllers ---


def _by_measured(vehicle_unit: str, shaft_unit: str, minimum: float | None = None) -> BeforeValidator:
    """Make a validator of a quantity whose unit depends on the controlled speed."""

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
    speed: Annotated[float, _by_measured("m/s", "rad/s")]

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
    speed: list[Annotated[float, _by_measured("m/s", "rad/s")]]

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
        """Make the systems of reference, controller and brake.

        Args:
            step: Communication step, s.
            measured: Name of the controlled speed.
        """
        systems = [
            driveline.source("reference", self.reference.signal(), step),
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
    proportional_gain: Annotated[float, _by_measured("N.s", "N.m.s/rad", 0.0)]
    integral_gain: Annotated[float, _by_measured("N", "N.m/rad", 0.0)] = 0.0
    feedforward: Annotated[float, _by_measured("N.s", "N.m.s/rad")] = 0.0
    minimum: Torque
    maximum: Torque


Controller = Annotated[PiController | PiTorqueController, Field(discriminator="kind")]
