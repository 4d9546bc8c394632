"""Loads on the output shaft in discrete time: given torque, shaft with friction, vehicle on a road.

A load is coupled to the shaft either rigidly, then its inertia belongs to the FMU (output_inertia) and
it only returns the torque of its resistances, or elastically, then it turns by itself behind a spring
and damper and returns their torque. What is linear is sampled exactly (zero-order hold).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from .coupling import Coupling, check_coupling, sample, sample_coupled
from .sources import Signal, evaluate, source

STANDARD_GRAVITY = 9.80665


class Load(NamedTuple):
    """A load on the output shaft.

    Attributes:
        system: to connect: discrete-time control.NonlinearIOSystem, or Sources, from omega_out, rad/s, to
            load_torque, N.m.
        inertia: at the output shaft, kg.m2. coupling: to the output shaft, or None if rigid.
        friction: viscous, N.m.s/rad.
    """

    system: Any
    inertia: float = 0.0
    coupling: Coupling | None = None
    friction: float = 0.0

    @property
    def rigid_inertia(self) -> float:
        """To be added to output_inertia of the FMU, kg.m2 (0 where coupled elastically)."""
        return self.inertia if self.coupling is None else 0.0

    def check_step(self, shaft_inertia: float) -> None:
        """Refuse a step that is too long: the torque of the load is held while the shaft moves.

        Args:
            shaft_inertia: of the output shaft without the load, kg.m2.

        Raises:
            ValueError: friction held over a step would turn the shaft round; or see check_coupling.
        """
        step = float(self.system.dt)
        if self.coupling is not None:
            check_coupling(self.coupling, self.inertia, shaft_inertia, step)
            return
        inertia = self.inertia + shaft_inertia
        if step * self.friction > inertia:
            raise ValueError(
                f"with viscous_friction = {self.friction:g} N.m.s/rad the step must be at most inertia over"
                f" friction, {inertia / self.friction:g} s, is {step:g} s"
            )


def torque_source(torque: Signal, step: float) -> Load:
    """A torque that does not depend on the motion.

    Args:
        torque: N.m, positive against the motion: constant, or table over time. step: s.
    """
    return Load(source("load_torque", torque, step))


def shaft_load(
    step: float,
    inertia: float,
    viscous_friction: float = 0.0,
    torque: Signal = 0.0,
    coupling: Coupling | None = None,
) -> Load:
    """A shaft with inertia, viscous friction and a torque against it.

    Coupled rigidly, the friction torque is held over a step: the speed is exact to first order in
    step viscous_friction / inertia.

    Args:
        step: communication step, s. inertia: kg.m2. viscous_friction: N.m.s/rad.
        torque: N.m, positive against the motion: constant, or table over time.
        coupling: to the output shaft, or None if rigid.

    Returns:
        Load with output load_torque, and with a coupling also load_speed, rad/s.
    """
    import control as ct

    if coupling is None:

        def rigid(time: float, _: Any, u: Any, __: Any) -> list[float]:
            return [viscous_friction * u[0] + evaluate(torque, time)]

        system = ct.nlsys(
            None, rigid, inputs=["omega_out"], outputs=["load_torque"], dt=step, name="shaft_load"
        )
        return Load(system, inertia, friction=viscous_friction)
    a, b = sample_coupled(inertia, coupling, viscous_friction, step)

    def update(time: float, x: Any, u: Any, _: Any) -> Any:
        return a @ x + b @ [u[0], evaluate(torque, time)]

    def output(_: float, x: Any, u: Any, __: Any) -> list[float]:
        return [coupling.torque(x[0], u[0] - x[1]), x[1]]

    system = ct.nlsys(
        update,
        output,
        inputs=["omega_out"],
        outputs=["load_torque", "load_speed"],
        states=["twist", "speed", "angle"],
        dt=step,
        name="shaft_load",
    )
    return Load(system, inertia, coupling, viscous_friction)


def dry_friction(free_speed: float, effect: float, capacity: float) -> float:
    """Friction torque that brings a shaft to rest within the step, as far as it reaches, N.m.

    The complementarity condition of dry friction in discrete time: it never turns the motion round,
    and holds at standstill.

    Args:
        free_speed: speed at the end of the step without it, rad/s.
        effect: loss of speed over the step by 1 N.m of it, rad/s.
        capacity: largest friction torque, N.m.
    """
    return min(max(free_speed / effect, -capacity), capacity)


class _Road:
    """Resistances of a vehicle on a road, as torques at the output shaft, N.m."""

    def __init__(
        self, mass: float, radius: float, rolling: float, drag_area: float, density: float, slope: Signal
    ) -> None:
        self.radius = radius  # m of way per rad of the output shaft
        self.weight = mass * STANDARD_GRAVITY
        self.rolling = rolling
        self.drag = 0.5 * density * drag_area
        self.slope = slope

    def resistances(self, speed: float, distance: float, brake_force: float) -> tuple[float, ...]:
        """(drag, climb, capacity of rolling friction, capacity of the brake), N.m."""
        angle = math.atan(evaluate(self.slope, distance))
        return (
            self.radius * self.drag * speed * abs(speed),
            self.radius * self.weight * math.sin(angle),
            self.radius * self.rolling * self.weight * math.cos(angle),
            self.radius * max(brake_force, 0.0),
        )


_VEHICLE_OUTPUTS = (
    "load_torque",
    "load_speed",
    "vehicle_speed",
    "distance",
    "drag_torque",
    "slope_torque",
    "rolling_torque",
    "brake_torque",
)


def vehicle_load(
    step: float,
    mass: float,
    wheel_radius: float,
    final_drive: float,
    *,
    rolling_resistance: float = 0.01,
    drag_area: float = 0.0,
    air_density: float = 1.2,
    slope: Signal = 0.0,
    one_way: bool = True,
    coupling: Coupling | None = None,
) -> Load:
    """A vehicle driven by the output shaft through a final drive.

    Rolling resistance and brake are dry friction. Where the freewheels keep the shaft from turning
    backwards (one_way), they act with their full capacity against forward motion, at standstill too: the
    housing freewheel carries what is not needed. Elsewhere they bring the vehicle to rest within a step
    at most and hold it there.

    Args:
        step: communication step, s. mass: kg. wheel_radius: m.
        final_drive: turns of the output shaft per turn of the wheels.
        rolling_resistance: rolling friction over weight. drag_area: drag coefficient times area, m2.
        air_density: kg/m3. slope: rise over run: constant, or table over distance, m.
        one_way: whether the output shaft cannot turn backwards.
        coupling: between the output shaft and the vehicle, or None if rigid.

    Returns:
        Load with inputs omega_out, rad/s, and brake_force, N (at the wheels), and outputs load_torque;
        load_speed, rad/s (of the vehicle, at the output shaft); vehicle_speed, m/s; distance, m; and the
        torques drag_torque, slope_torque, rolling_torque, brake_torque that act on the vehicle, N.m at
        the output shaft.
    """
    import control as ct

    radius = wheel_radius / final_drive
    inertia = mass * radius * radius
    road = _Road(mass, radius, rolling_resistance, drag_area, air_density, slope)
    if coupling is None:
        update, output, states = _rigid_vehicle(step, road, inertia, one_way)
    else:
        update, output, states = _coupled_vehicle(step, road, inertia, coupling)
    system = ct.nlsys(
        update,
        output,
        inputs=["omega_out", "brake_force"],
        outputs=_VEHICLE_OUTPUTS,
        states=states,
        dt=step,
        name="vehicle_load",
    )
    return Load(system, inertia, coupling)


def _shared(friction: float, rolling: float, brake: float) -> tuple[float, float]:
    """Dry friction as shared by rolling resistance and brake, N.m each."""
    capacity = rolling + brake
    return (friction * rolling / capacity, friction * brake / capacity) if capacity > 0.0 else (0.0, 0.0)


def _rigid_vehicle(step: float, road: _Road, inertia: float, one_way: bool) -> tuple[Any, Any, list[str]]:
    """State (distance) of a vehicle that moves with the output shaft."""
    a, b = sample([[0.0]], [[road.radius]], step)

    def update(_: float, x: Any, u: Any, __: Any) -> Any:
        return a @ x + b @ u[:1]

    def output(_: float, x: Any, u: Any, __: Any) -> tuple[float, ...]:
        speed = road.radius * u[0]
        drag, climb, rolling, brake = road.resistances(speed, x[0], u[1])
        friction = rolling + brake
        if not one_way:
            # the drive's part of the free speed is not known here: it shows in the next step
            effect = step / inertia
            friction = dry_friction(u[0] - effect * (drag + climb), effect, friction)
        rolling, brake = _shared(friction, rolling, brake)
        return drag + climb + friction, u[0], speed, x[0], drag, climb, rolling, brake

    return update, output, ["distance"]


def _coupled_vehicle(
    step: float, road: _Road, inertia: float, coupling: Coupling
) -> tuple[Any, Any, list[str]]:
    """State (twist, speed, angle), referred to the output shaft, of a vehicle behind a coupling."""
    a, b = sample_coupled(inertia, coupling, 0.0, step)

    def resistances(x: Any, u: Any) -> tuple[float, ...]:
        drag, climb, rolling, brake = road.resistances(road.radius * x[1], road.radius * x[2], u[1])
        free = a @ x + b @ [u[0], drag + climb]
        friction = dry_friction(free[1], -b[1, 1], rolling + brake)
        return drag, climb, *_shared(friction, rolling, brake)

    def update(_: float, x: Any, u: Any, __: Any) -> Any:
        return a @ x + b @ [u[0], sum(resistances(x, u))]

    def output(_: float, x: Any, u: Any, __: Any) -> tuple[float, ...]:
        torque = coupling.torque(x[0], u[0] - x[1])
        return torque, x[1], road.radius * x[1], road.radius * x[2], *resistances(x, u)

    return update, output, ["twist", "speed", "angle"]
