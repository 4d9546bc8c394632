"""The [load] of a scene: what hangs on the output shaft."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from .. import loops
from ..loops.cycles import KILOMETRE_PER_HOUR
from ..loops.sources import Signal
from .fields import ConstantOrTable, Strict, Tabulated, Times, Torque, quantities, quantity

VEHICLE_SPEED = "vehicle_speed"
SHAFT_SPEED = "omega_out"
SPEED_UNITS = {VEHICLE_SPEED: "m/s", SHAFT_SPEED: "rad/s"}


def measured_speed(load_kind: Any) -> str:
    """Name of the speed that a controller controls with a kind of load."""
    return VEHICLE_SPEED if load_kind == "vehicle" else SHAFT_SPEED


class Coupling(Strict):
    """Elastic coupling between output shaft and load (without it they are rigid)."""

    stiffness: Annotated[float, quantity("N.m/rad", above=0.0)]
    damping: Annotated[float, quantity("N.m.s/rad", 0.0)] = 0.0


def _coupling(table: Coupling | None) -> loops.Coupling | None:
    return None if table is None else loops.Coupling(table.stiffness, table.damping)


class TorqueOverTime(Tabulated):
    """Torque over time."""

    time: Times
    torque: Annotated[list[float], quantities("N.m")]


class SlopeOverDistance(Tabulated):
    """Slope of the road, rise over run, over the way."""

    distance: Annotated[list[float], quantities("m")]
    slope: Annotated[list[float], quantities("1")]


class AnyLoad(Strict, ABC):
    """A load on the output shaft."""

    def prescribed(self) -> dict[str, Signal]:
        """Inputs of the module that follow from nothing the module does, by name."""
        return {}

    @abstractmethod
    def build(self, step: float, one_way: bool) -> loops.Load:
        """Make the load as a system of this step, s; one_way: the shaft cannot turn backwards."""


class TorqueLoad(ConstantOrTable, AnyLoad):
    """A torque on the output shaft that does not depend on the motion."""

    SIGNAL: ClassVar[str] = "torque"

    kind: Literal["torque"]
    torque: Torque | None = None
    torque_over_time: TorqueOverTime | None = None

    def prescribed(self) -> dict[str, Signal]:
        """Inputs of the module that follow from nothing the module does, by name."""
        return {"load_torque": self.one_signal()}

    def build(self, step: float, one_way: bool) -> loops.Load:
        """Make the torque as a system."""
        return loops.Load(loops.source("load_torque", self.one_signal(), step))


class ShaftLoad(AnyLoad):
    """A shaft with inertia, viscous friction and a torque against it."""

    kind: Literal["shaft"]
    inertia: Annotated[float, quantity("kg.m2", above=0.0)]
    viscous_friction: Annotated[float, quantity("N.m.s/rad", 0.0)] = 0.0
    torque: Torque = 0.0
    coupling: Coupling | None = None

    def build(self, step: float, one_way: bool) -> loops.Load:
        """Make the shaft as a system."""
        return loops.shaft_load(
            step, self.inertia, self.viscous_friction, self.torque, _coupling(self.coupling)
        )


class VehicleLoad(AnyLoad):
    """A vehicle on a road, behind a final drive.

    Attributes:
        times_to: speeds, m/s, to which the summary gives the time from standstill.
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
    times_to: Annotated[list[float], quantities("m/s", 0.0)] = Field(
        default=[50.0 * KILOMETRE_PER_HOUR, 100.0 * KILOMETRE_PER_HOUR]
    )

    def build(self, step: float, one_way: bool) -> loops.Load:
        """Make the vehicle as a system."""
        table = self.slope_over_distance
        return loops.vehicle_load(
            step,
            self.mass,
            self.wheel_radius,
            self.final_drive,
            rolling_resistance=self.rolling_resistance,
            drag_area=self.drag_area,
            air_density=self.air_density,
            slope=self.slope if table is None else table.signal(),
            one_way=one_way,
            coupling=_coupling(self.coupling),
        )


Load = Annotated[TorqueLoad | ShaftLoad | VehicleLoad, Field(discriminator="kind")]
