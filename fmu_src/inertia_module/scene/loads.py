"""Table [load] of a scene: load on the output shaft."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from .. import driveline
from ..common.errors import must_be
from ..driveline.cycles import KILOMETRE_PER_HOUR
from ..driveline.loads import STANDARD_GRAVITY
from .keys import ConstantOrTable, Strict, Tabulated, Times, Torque, quantity


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
        """Make the load.

        Args:
            step: Communication step, s.
            prevents_reverse: True if the shaft cannot rotate backward.
            start_speed: Initial speed of the shaft, rad/s.
        """
        return driveline.Load(driveline.Sources({"load_torque": self.one_signal()}, step))


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
        """Make the load.

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
        """Make the load.

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
            step,
            **own,
            slope=slope,
            prevents_reverse=prevents_reverse,
            coupling=coupling,
            start_speed=start_speed,
        )


Load = Annotated[TorqueLoad | ShaftLoad | VehicleLoad, Field(discriminator="kind")]
