"""Loads on the output shaft in discrete time: given torque, shaft with friction, vehicle on a road.

A load is coupled to the shaft either rigidly, then its inertia belongs to the FMU (output_inertia) and
it only returns the torque of its resistances, or elastically, then it turns by itself behind a spring
and damper and returns their torque. What is linear is sampled exactly (zero-order hold).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .sources import Sampled, Signal, evaluate

__all__ = ["Coupling", "Load", "shaft_load", "vehicle_load"]

Array = NDArray[np.float64]

STANDARD_GRAVITY = 9.80665
# states of a load behind a coupling, referred to the output shaft
COUPLED = ("twist", "speed", "angle")


class Coupling(NamedTuple):
    """Elastic coupling between the output shaft and the load.

    The load follows a shaft of given speed exactly; its torque on the shaft is held over a step, so
    the two together are right to first order in the step.

    Attributes:
        stiffness: N.m/rad. damping: N.m.s/rad.
    """

    stiffness: float
    damping: float

    def torque(self, twist: float, speed_difference: float) -> float:
        """Torque on both sides, N.m."""
        return self.stiffness * twist + self.damping * speed_difference


def sample_coupled(inertia: float, coupling: Coupling, friction: float, step: float) -> tuple[Array, Array]:
    """Exact step of twist, speed and angle of an inertia behind a coupling.

    Returns:
        (A, B) for the state (twist, speed, angle) and the input (speed of the shaft, torque against), held.
    """
    from scipy.linalg import expm

    stiffness, damping = coupling
    # the inputs are states that stay
    rates = np.zeros((5, 5))
    rates[:3] = [
        [0.0, -1.0, 0.0, 1.0, 0.0],
        [stiffness / inertia, -(damping + friction) / inertia, 0.0, damping / inertia, -1.0 / inertia],
        [0.0, 1.0, 0.0, 0.0, 0.0],
    ]
    whole = expm(step * rates)
    return whole[:3, :3], whole[:3, 3:]


class Load(NamedTuple):
    """A load on the output shaft.

    Attributes:
        system: to connect: a Sampled system, or one of python-control, from omega_out, rad/s, to
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
        """Inertia to add to output_inertia of the FMU, kg.m2 (0 where coupled elastically)."""
        return self.inertia if self.coupling is None else 0.0

    def check_step(self, shaft_inertia: float) -> None:
        """Reject a step that is too long: the load torque is constant while the shaft moves.

        Behind an elastic coupling, in the order of ClosedLoop, no swing of shaft and load may grow, and the
        damping may not turn the shaft round within a step.

        Args:
            shaft_inertia: of the output shaft without the load, kg.m2.

        Raises:
            ValueError: the step is too long, or friction held over it would turn the shaft round.
        """
        step = float(self.system.dt)
        if self.coupling is None:
            inertia = self.inertia + shaft_inertia
            if step * self.friction > inertia:
                raise ValueError(
                    f"the step must be at most inertia / friction = {inertia / self.friction:g} s with"
                    f" viscous_friction = {self.friction:g} N.m.s/rad (got {step:g} s)"
                )
            return
        a, b = sample_coupled(self.inertia, self.coupling, 0.0, step)
        # state (twist, speed of the load, speed of the shaft): first the shaft, then the load
        shaft = np.eye(3)
        stiffness, damping = self.coupling
        shaft[2] -= step / shaft_inertia * np.array([stiffness, -damping, damping])
        behind = np.eye(3)
        behind[:2, :2] = a[:2, :2]
        behind[:2, 2] = b[:2, 0]
        growth = np.abs(np.linalg.eigvals(behind @ shaft)).max()
        if growth > 1.0 + 1e-6 or step * damping > shaft_inertia:
            raise ValueError(
                f"the step must be shorter with stiffness = {stiffness:g} N.m/rad, damping = {damping:g}"
                f" N.m.s/rad and a shaft inertia of {shaft_inertia:g} kg.m2 (got {step:g} s)."
                " A softer coupling or a larger shaft inertia also helps."
            )


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
    if coupling is None:

        def rigid(time: float, _: Any, u: Any) -> tuple[list[float], tuple[()]]:
            return [viscous_friction * u[0] + evaluate(torque, time)], ()

        system = Sampled("shaft_load", step, ["omega_out"], ["load_torque"], rigid)
        return Load(system, inertia, friction=viscous_friction)
    a, b = sample_coupled(inertia, coupling, viscous_friction, step)

    def law(time: float, x: Any, u: Any) -> tuple[list[float], Any]:
        following = a @ x + b @ [u[0], evaluate(torque, time)]
        return [coupling.torque(x[0], u[0] - x[1]), x[1]], following.tolist()

    system = Sampled("shaft_load", step, ["omega_out"], ["load_torque", "load_speed"], law, COUPLED)
    return Load(system, inertia, coupling, viscous_friction)


def dry_friction(free_speed: float, effect: float, capacity: float) -> float:
    """Friction torque, N.m, that brings a shaft to rest within the step, limited to its capacity.

    The complementarity condition of dry friction in discrete time: it never turns the motion round, and holds
    at standstill. Without it the step ends at free_speed, rad/s; 1 N.m of it reduces that by effect, rad/s.
    """
    return min(max(free_speed / effect, -capacity), capacity)


def _shared(friction: float, rolling: float, brake: float) -> tuple[float, float]:
    """Dry friction as shared by rolling resistance and brake, N.m each."""
    capacity = rolling + brake
    return (friction * rolling / capacity, friction * brake / capacity) if capacity > 0.0 else (0.0, 0.0)


_VEHICLE_OUTPUTS = (
    *("load_torque", "load_speed", "vehicle_speed", "distance"),
    *("drag_torque", "slope_torque", "rolling_torque", "brake_torque"),
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
    start_speed: float = 0.0,
) -> Load:
    """A vehicle driven by the output shaft through a final drive.

    Rolling resistance and brake are dry friction. Where the freewheels keep the shaft from turning
    backwards (one_way), they act with their full capacity against forward motion, at standstill too: the
    housing freewheel carries what is not needed. Elsewhere they bring the vehicle to rest within a step
    at most and hold it there.

    Coupled rigidly, the distance is the integral of the speed by the trapezoidal rule.

    Args:
        step: communication step, s.
        mass: mass of the vehicle, kg.
        wheel_radius: radius of the wheels, m.
        final_drive: turns of the output shaft per turn of the wheels.
        rolling_resistance: rolling friction over weight.
        drag_area: drag coefficient times area, m2.
        air_density: density of the air, kg/m3.
        slope: rise over run, constant, or table over distance, m.
        one_way: True if the output shaft cannot turn backwards.
        coupling: coupling of output shaft and vehicle, or None if rigid.
        start_speed: speed of the output shaft at the start, rad/s; used for the distance.

    Returns:
        Load with inputs omega_out, rad/s, and brake_force, N (at the wheels), and outputs load_torque;
        load_speed, rad/s (of the vehicle, at the output shaft); vehicle_speed, m/s; distance, m; and the
        torques drag_torque, slope_torque, rolling_torque, brake_torque that act on the vehicle, N.m at
        the output shaft.
    """
    radius = wheel_radius / final_drive  # m of way per rad of the output shaft
    inertia = mass * radius * radius
    weight, drag = mass * STANDARD_GRAVITY, 0.5 * air_density * drag_area

    def road(speed: float, distance: float, brake_force: float) -> tuple[float, float, float, float]:
        """Drag, climb, capacities of rolling friction and of the brake: torques at the output shaft, N.m."""
        angle = math.atan(evaluate(slope, distance))
        return (
            radius * drag * speed * abs(speed),
            radius * weight * math.sin(angle),
            radius * rolling_resistance * weight * math.cos(angle),
            radius * max(brake_force, 0.0),
        )

    if coupling is not None:
        a, b = sample_coupled(inertia, coupling, 0.0, step)

    def law(_: float, x: Any, u: Any) -> tuple[tuple[float, ...], Any]:
        if coupling is None:
            # the state is the sum of step times speed at the end of each step
            speed, distance = u[0], x[0] + 0.5 * step * radius * (start_speed - u[0])
        else:
            speed, distance = x[1], radius * x[2]
        drag, climb, rolling, brake = road(radius * speed, distance, u[1])
        friction = rolling + brake
        if coupling is not None:
            free = a @ x + b @ [u[0], drag + climb]
            friction = dry_friction(free[1], -b[1, 1], friction)
        elif not one_way:
            # the drive's part of the free speed is not known here: it shows in the next step
            effect = step / inertia
            friction = dry_friction(u[0] - effect * (drag + climb), effect, friction)
        parts = drag, climb, *_shared(friction, rolling, brake)
        torque, following = drag + climb + friction, [x[0] + step * radius * speed]
        if coupling is not None:
            torque = coupling.torque(x[0], u[0] - speed)
            following = (a @ x + b @ [u[0], sum(parts)]).tolist()
        return (torque, speed, radius * speed, distance, *parts), following

    states = ("distance",) if coupling is None else COUPLED
    inputs = ["omega_out", "brake_force"]
    return Load(Sampled("vehicle_load", step, inputs, _VEHICLE_OUTPUTS, law, states), inertia, coupling)
