"""The parts of a scene around its mechanism: [drive], [load], [controller].

With a vehicle as load a controller controls the vehicle speed (m/s), with any other load omega_out (rad/s);
bare numbers are in that unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from .. import loops
from ..common.errors import must_be
from ..contract.variables import LARGEST_SPEED
from ..kernel.codes import DRIVE_SPEED, DRIVE_TORQUE
from ..loops.cycles import CYCLES, KILOMETRE_PER_HOUR, Cycle
from ..loops.engine import check_drag, check_rising
from ..loops.loads import STANDARD_GRAVITY
from ..loops.sources import Sampled, Signal, Table
from .keys import AngularSpeed, ConstantOrTable, Duration, Strict, Tabulated, Times, Torque, checked, quantity

# --- drives ---

Turning = Annotated[float, quantity("rad/s", 0.0, LARGEST_SPEED)]


class AnyDrive(Strict):
    """A drive of link 1, which gives the input INPUT of the module."""

    INPUT: ClassVar[str] = "omega1"

    @property
    def mode(self) -> int:
        """Value of the module's parameter drive."""
        return DRIVE_SPEED if self.INPUT == "omega1" else DRIVE_TORQUE

    @property
    def start_speed(self) -> float | None:
        """Speed of link 1 at the start, rad/s, of a drive that gives a torque."""
        return None

    def signal(self) -> Signal | None:
        """The input, rad/s or N.m, constant or over time, if independent of the state of the module."""
        given: Signal | None = getattr(self, self.INPUT, None)
        return given

    def systems(self, step: float) -> list[Any]:
        """Make the systems that give the inputs, of this step, s."""
        signal = self.signal()
        return [] if signal is None else [loops.source(self.INPUT, signal, step)]

    def driven(self, parameters: Mapping[str, float]) -> dict[str, float]:
        """Parameters of the module with what its drive adds to them."""
        return {**parameters} if self.mode == DRIVE_SPEED else {**parameters, "drive": float(DRIVE_TORQUE)}

    def check_step(self, step: float, inertia: float) -> None:
        """Refuse a step, s, that is too long; inertia: of all that turns with link 1, kg.m2."""


class ConstantDrive(AnyDrive):
    """Link 1 turns at constant speed."""

    kind: Literal["constant"]
    omega1: AngularSpeed


class RampDrive(AnyDrive):
    """The speed of link 1 changes linearly between two values and is held before and after."""

    kind: Literal["ramp"]
    initial: AngularSpeed
    final: AngularSpeed
    start: Annotated[float, quantity("s", 0.0)] = 0.0
    duration: Duration

    def signal(self) -> Signal:
        """Speed of link 1 over time, rad/s."""
        return Table([self.start, self.start + self.duration], [self.initial, self.final])


class TableDrive(Tabulated, AnyDrive):
    """The speed of link 1 over time."""

    kind: Literal["table"]
    time: Times
    omega1: list[Annotated[float, quantity("rad/s")]]


class ControlledDrive(AnyDrive):
    """The speed of link 1 is what [controller] commands."""

    kind: Literal["controlled"]


class TorqueDrive(AnyDrive):
    """A torque on link 1, whose speed follows from it and is omega1, rad/s, at the start."""

    INPUT: ClassVar[str] = "drive_torque"

    omega1: AngularSpeed = 0.0

    @property
    def start_speed(self) -> float | None:
        """Speed of link 1 at the start, rad/s."""
        return self.omega1


class ControlledTorque(TorqueDrive):
    """The torque on link 1 is what [controller] commands."""

    kind: Literal["controlled_torque"]


class ConstantTorque(TorqueDrive):
    """A constant torque on link 1, N.m."""

    kind: Literal["torque"]
    drive_torque: Torque


class TorqueTable(Tabulated, TorqueDrive):
    """A torque on link 1 over time, s, N.m."""

    kind: Literal["torque_table"]
    time: Times
    drive_torque: list[Annotated[float, quantity("N.m")]]


class TorqueOverSpeed(Tabulated):
    """A torque over the speed of the engine, constant beyond the ends."""

    speed: list[Annotated[float, quantity("rad/s")]]
    torque: list[Annotated[float, quantity("N.m", 0.0)]]

    @model_validator(mode="after")
    def _rising(self) -> TorqueOverSpeed:
        check_rising(self.speed)
        return self


class ThrottleOverTime(Tabulated):
    """The throttle over time, from 0, closed, to 1, full load."""

    time: Times
    throttle: list[Annotated[float, quantity("1", 0.0, 1.0)]]


class DragOverSpeed(TorqueOverSpeed):
    """The size of a torque against the motion over the speed of the engine."""

    torque: list[Annotated[float, quantity("N.m")]]

    @model_validator(mode="after")
    def _against_the_motion(self) -> Self:
        check_drag("torque", self.torque)
        return self


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

    The throttle interpolates between -drag (closed) and full load. One governor raises the torque below the
    idle speed, another one cuts it above the top speed. The control unit samples the speed once a
    communication step and holds the torque over it.

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
    drag: DragOverSpeed | None = None
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
        full, drag = self.full_load, self.drag or DragOverSpeed(speed=[0.0], torque=[0.0])
        speeds = np.union1d(full.speed, drag.speed)
        both = (np.interp(speeds, table.speed, table.torque).tolist() for table in (full, drag))
        return loops.EngineMap(tuple(speeds.tolist()), *map(tuple, both))

    def driven(self, parameters: Mapping[str, float]) -> dict[str, float]:
        """Parameters of the module, which carries the rotor of the engine."""
        return loops.torque_driven(parameters, self.inertia)

    def check_step(self, step: float, inertia: float) -> None:
        """Reject a step over which the constant governor torque would reverse the sign of the speed error."""
        gain = self.governor.proportional_gain
        if step * gain > inertia:
            raise ValueError(
                f"the step must be at most inertia / gain = {inertia / gain:g} s with"
                f" drive.governor.proportional_gain = {gain:g} N.m.s/rad (got {step:g} s)"
            )

    def systems(self, step: float) -> list[Any]:
        """Make the source of the throttle, and the engine.

        From throttle and input_speed, rad/s, to drive_torque, N.m; state: integrals of the governors.
        """
        limits, given = self.torque_map(), self.governor
        governor = loops.Governor(given.proportional_gain, given.integral_gain, step)

        def law(_: float, x: Any, u: Any) -> tuple[list[float], list[float]]:
            """Compute torque and integrals: throttle torque, raised at idle speed, cut at top speed."""
            throttle, speed = u
            closed, full = limits.limits(speed)
            asked = closed + throttle * (full - closed)
            kept, idle = governor.sample(x[0], given.idle, speed, (asked, full))
            torque, top = governor.sample(x[1], given.top_speed, speed, (closed, kept))
            return [torque], [idle, top]

        signals, integrals = ["throttle", "input_speed"], ["idle_integral", "top_integral"]
        engine = Sampled("engine", step, signals, ["drive_torque"], law, integrals)
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


# --- loads ---


class Coupling(Strict):
    """Elastic coupling between output shaft and load (without it they are rigid)."""

    stiffness: Annotated[float, quantity("N.m/rad", above=0.0)]
    damping: Annotated[float, quantity("N.m.s/rad", 0.0)] = 0.0


def _coupling(table: Coupling | None) -> loops.Coupling | None:
    return None if table is None else loops.Coupling(table.stiffness, table.damping)


class TorqueOverTime(Tabulated):
    """Torque over time."""

    time: Times
    torque: list[Annotated[float, quantity("N.m")]]


class SlopeOverDistance(Tabulated):
    """Slope of the road (rise over run) over distance."""

    distance: list[Annotated[float, quantity("m")]]
    slope: list[Annotated[float, quantity("1")]]


class TorqueLoad(ConstantOrTable):
    """A torque on the output shaft that does not depend on the motion."""

    SIGNAL: ClassVar[str] = "torque"

    kind: Literal["torque"]
    torque: Torque | None = None
    torque_over_time: TorqueOverTime | None = None

    def build(self, step: float, one_way: bool, start_speed: float) -> loops.Load:
        """Make the load as a system.

        Args:
            step: communication step, s.
            one_way: True if the shaft cannot turn backwards.
            start_speed: speed of the shaft at the start, rad/s.
        """
        return loops.Load(loops.source("load_torque", self.one_signal(), step))


class ShaftLoad(Strict):
    """A shaft with inertia, viscous friction and a torque against it."""

    kind: Literal["shaft"]
    inertia: Annotated[float, quantity("kg.m2", above=0.0)]
    viscous_friction: Annotated[float, quantity("N.m.s/rad", 0.0)] = 0.0
    torque: Torque = 0.0
    coupling: Coupling | None = None

    def build(self, step: float, one_way: bool, start_speed: float) -> loops.Load:
        """Make the shaft as a system."""
        return loops.shaft_load(
            step, self.inertia, self.viscous_friction, self.torque, _coupling(self.coupling)
        )


class VehicleLoad(Strict):
    """A vehicle on a road, behind a final drive.

    Attributes:
        times_to: speeds that the summary has times to, m/s.
        friction_coefficient: largest tractive force over the load of the driven axles.
        driven_axle_load: load of the driven axles, N; without it the weight of the vehicle.
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
        """Largest tractive force, N (Coulomb friction); None if the scene gives no friction coefficient."""
        if self.friction_coefficient is None:
            return None
        return self.friction_coefficient * (self.driven_axle_load or self.mass * STANDARD_GRAVITY)

    def build(self, step: float, one_way: bool, start_speed: float) -> loops.Load:
        """Make the vehicle as a system."""
        table, coupling = self.slope_over_distance, _coupling(self.coupling)
        others = {"kind", "slope", "slope_over_distance", "coupling", "times_to"}
        own = self.model_dump(exclude=others | {"friction_coefficient", "driven_axle_load"})
        slope = self.slope if table is None else table.signal()
        return loops.vehicle_load(
            step, **own, slope=slope, one_way=one_way, coupling=coupling, start_speed=start_speed
        )


Load = Annotated[TorqueLoad | ShaftLoad | VehicleLoad, Field(discriminator="kind")]


# --- controllers ---


def _by_measured(vehicle_unit: str, shaft_unit: str, minimum: float | None = None) -> BeforeValidator:
    """Validator of a quantity whose unit depends on the speed that is controlled."""

    def check(value: Any, info: ValidationInfo) -> Any:
        vehicle = (info.context or {}).get("vehicle")
        return checked(value, vehicle_unit if vehicle else shaft_unit, minimum)

    return BeforeValidator(check)


class ConstantReference(Strict):
    """Constant reference speed."""

    kind: Literal["constant"]
    speed: Annotated[float, _by_measured("m/s", "rad/s")]

    def signal(self) -> Signal:
        """Reference speed, m/s or rad/s by the load."""
        return self.speed

    def driving_cycle(self) -> Cycle | None:
        """Return None: a constant speed is no driving cycle."""
        return None


class TableReference(Tabulated):
    """A speed over time."""

    kind: Literal["table"]
    time: Times
    speed: list[Annotated[float, _by_measured("m/s", "rad/s")]]

    def driving_cycle(self) -> Cycle | None:
        """Return the table as a driving cycle of a vehicle."""
        name = Path(self.file).name if self.file else "the reference"
        return Cycle(name, np.array(self.time), np.array(self.speed))


CycleName: Any = Literal[tuple(CYCLES)]


class CycleReference(Strict):
    """A driving cycle."""

    kind: Literal["cycle"]
    cycle: CycleName

    def signal(self) -> Signal:
        """The speed over time, m/s."""
        return loops.Table(CYCLES[self.cycle].time, CYCLES[self.cycle].speed)

    def driving_cycle(self) -> Cycle | None:
        """Return the published driving cycle."""
        return CYCLES[self.cycle]


class Brake(Strict):
    """The driver's brake: a force in proportion to the excess of the vehicle's speed."""

    gain: Annotated[float, quantity("N.s/m", 0.0)]
    maximum: Annotated[float, quantity("N", 0.0)]
    margin: Annotated[float, quantity("m/s", 0.0)] = 0.0


class PiController(Strict):
    """PI controller of the speed with limits and anti-windup: gives COMMAND, by a drive of kind DRIVE."""

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
