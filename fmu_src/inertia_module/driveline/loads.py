"""Discrete-time loads on the output shaft: torque, shaft with friction, vehicle on a road.

A load is connected to the output shaft rigidly or elastically. The inertia of a rigid load belongs to the FMU
(output_inertia), and the load returns the torque of its resistances. An elastic load moves downstream of a
spring and a damper and returns their torque. Its linear equations are sampled exactly (zero-order hold).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.deprecated import renamed_arguments
from .sources import Signal, Sources, evaluate

if TYPE_CHECKING:
    import control as ct

    from .discrete_system import Numbers

__all__ = ["Coupling", "Load", "shaft_load", "vehicle_load"]

Array = NDArray[np.float64]

STANDARD_GRAVITY = 9.80665
# states of an elastically coupled load, referred to the output shaft
COUPLED = ("twist", "speed", "angle")


class Coupling(NamedTuple):
    """Elastic coupling between the output shaft and the load.

    The motion of the load is exact for a piecewise constant speed of the shaft. The torque on the shaft is
    constant in each step, so shaft and load together are accurate to first order in the step.

    Attributes:
        stiffness: Stiffness, N.m/rad.
        damping: Damping, N.m.s/rad.
    """

    stiffness: float
    damping: float

    def torque(self, twist: float, speed_difference: float) -> float:
        """Return the torque on both sides, N.m.

        Args:
            twist: Angle of the shaft minus angle of the load, rad.
            speed_difference: Speed of the shaft minus speed of the load, rad/s.
        """
        return self.stiffness * twist + self.damping * speed_difference


def sample_coupled(inertia: float, coupling: Coupling, friction: float, step: float) -> tuple[Array, Array]:
    """Discretise an inertia downstream of a coupling exactly (zero-order hold).

    Args:
        inertia: Inertia of the load, kg.m2.
        coupling: Coupling to the shaft.
        friction: Viscous friction of the load, N.m.s/rad.
        step: Step, s.

    Returns:
        Matrices A, shape (3, 3), and B, shape (3, 2), for the state (twist, speed, angle) and the input
        (speed of the shaft, torque against the load).
    """
    from scipy.linalg import expm

    stiffness, damping = coupling
    # The inputs are constant states.
    rates = np.zeros((5, 5))
    rates[:3] = [
        [0.0, -1.0, 0.0, 1.0, 0.0],
        [stiffness / inertia, -(damping + friction) / inertia, 0.0, damping / inertia, -1.0 / inertia],
        [0.0, 1.0, 0.0, 0.0, 0.0],
    ]
    transition = expm(step * rates)
    return transition[:3, :3], transition[:3, 3:]


class Load(NamedTuple):
    """Load on the output shaft.

    Attributes:
        system: System of python-control from omega_out, rad/s, to load_torque, N.m; or Sources of a
            load_torque that does not depend on the motion.
        inertia: Inertia referred to the output shaft, kg.m2.
        coupling: Coupling to the output shaft, or None for a rigid connection.
        friction: Viscous friction, N.m.s/rad.
    """

    system: ct.InputOutputSystem | Sources
    inertia: float = 0.0
    coupling: Coupling | None = None
    friction: float = 0.0

    @property
    def rigid_inertia(self) -> float:
        """Return the inertia to add to output_inertia of the FMU, kg.m2 (0 with a coupling)."""
        return self.inertia if self.coupling is None else 0.0

    def check_step(self, shaft_inertia: float) -> None:
        """Reject a step that is too long for a load torque that is constant in each step.

        For a rigid load, friction must not reverse the shaft within a step. For an elastic load, the
        oscillation of shaft and load in the order of ClosedLoop must not grow, and the damping must not
        reverse the shaft within a step.

        Args:
            shaft_inertia: Inertia of the output shaft without the load, kg.m2.

        Raises:
            ValueError: The step is too long.
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
        # State: twist, speed of the load, speed of the shaft. The shaft moves first, then the load.
        shaft = np.eye(3)
        stiffness, damping = self.coupling
        shaft[2] -= step / shaft_inertia * np.array([stiffness, -damping, damping])
        load = np.eye(3)
        load[:2, :2] = a[:2, :2]
        load[:2, 2] = b[:2, 0]
        growth = np.abs(np.linalg.eigvals(load @ shaft)).max()
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
    """Make a shaft with inertia, viscous friction and a torque.

    Without a coupling the friction torque is constant in each step, so the speed is accurate to first order
    in step * viscous_friction / inertia.

    Args:
        step: Communication step, s.
        inertia: Inertia, kg.m2.
        viscous_friction: Viscous friction, N.m.s/rad.
        torque: Torque against forward motion, N.m: constant, or table over time, s.
        coupling: Coupling to the output shaft, or None for a rigid connection.

    Returns:
        Load with output load_torque, and with a coupling also load_speed, rad/s.
    """
    from .discrete_system import DiscreteSystem

    if coupling is None:

        def rigid(time: float, _: Numbers, u: Numbers) -> tuple[list[float], tuple[()]]:
            return [viscous_friction * u[0] + evaluate(torque, time)], ()

        system = DiscreteSystem("shaft_load", step, ["omega_out"], ["load_torque"], rigid)
        return Load(system, inertia, friction=viscous_friction)
    a, b = sample_coupled(inertia, coupling, viscous_friction, step)

    def law(time: float, x: Numbers, u: Numbers) -> tuple[list[float], list[float]]:
        next_state = a @ x + b @ [u[0], evaluate(torque, time)]
        return [coupling.torque(x[0], u[0] - x[1]), x[1]], next_state.tolist()

    system = DiscreteSystem("shaft_load", step, ["omega_out"], ["load_torque", "load_speed"], law, COUPLED)
    return Load(system, inertia, coupling, viscous_friction)


def dry_friction(free_speed: float, speed_per_torque: float, capacity: float) -> float:
    """Return the friction torque that stops a shaft within the step, limited to its capacity, N.m.

    This is the complementarity condition of dry friction in discrete time. Friction never reverses the
    motion, and it sticks at standstill.

    Args:
        free_speed: Speed at the end of the step without friction, rad/s.
        speed_per_torque: Decrease of this speed per friction torque, rad/s per N.m.
        capacity: Maximum friction torque, N.m.
    """
    return min(max(free_speed / speed_per_torque, -capacity), capacity)


def _divide_friction(friction: float, rolling: float, brake: float) -> tuple[float, float]:
    """Divide dry friction between rolling resistance and brake in proportion to their capacities, N.m."""
    capacity = rolling + brake
    return (friction * rolling / capacity, friction * brake / capacity) if capacity > 0.0 else (0.0, 0.0)


_VEHICLE_OUTPUTS = (
    *("load_torque", "load_speed", "vehicle_speed", "distance"),
    *("drag_torque", "slope_torque", "rolling_torque", "brake_torque"),
)


@renamed_arguments(one_way="prevents_reverse")
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
    prevents_reverse: bool = True,
    coupling: Coupling | None = None,
    start_speed: float = 0.0,
) -> Load:
    """Make a vehicle that the output shaft drives through a final drive.

    Rolling resistance and brake are dry friction. With prevents_reverse they act with full capacity against
    forward motion, also at standstill; the housing freewheel supports the excess. Otherwise they decelerate
    the vehicle without reversing it, and hold it at standstill.

    Without a coupling the distance is the integral of the speed by the trapezoidal rule.

    Args:
        step: Communication step, s.
        mass: Mass of the vehicle, kg.
        wheel_radius: Radius of the wheels, m.
        final_drive: Speed of the output shaft over the speed of the wheels.
        rolling_resistance: Rolling resistance over normal force.
        drag_area: Drag coefficient times frontal area, m2.
        air_density: Density of the air, kg/m3.
        slope: Slope (rise over run): constant, or table over distance, m.
        prevents_reverse: True if freewheels prevent the output shaft from rotating backward.
        coupling: Coupling of output shaft and vehicle, or None for a rigid connection.
        start_speed: Initial speed of the output shaft, rad/s, for the distance.

    Returns:
        Load with the inputs omega_out, rad/s, and brake_force, N (at the wheels). Its outputs are
        load_torque, N.m; load_speed (speed of the vehicle referred to the output shaft), rad/s;
        vehicle_speed, m/s; distance, m; and drag_torque, slope_torque, rolling_torque and brake_torque on the
        vehicle, referred to the output shaft, N.m.
    """
    from .discrete_system import DiscreteSystem

    radius = wheel_radius / final_drive  # distance per angle of the output shaft, m/rad
    inertia = mass * radius * radius
    weight, drag_factor = mass * STANDARD_GRAVITY, 0.5 * air_density * drag_area

    def road(speed: float, distance: float, brake_force: float) -> tuple[float, float, float, float]:
        """Return torques of drag and slope, and capacities of rolling resistance and brake, N.m."""
        angle = math.atan(evaluate(slope, distance))
        return (
            radius * drag_factor * speed * abs(speed),
            radius * weight * math.sin(angle),
            radius * rolling_resistance * weight * math.cos(angle),
            radius * max(brake_force, 0.0),
        )

    if coupling is not None:
        a, b = sample_coupled(inertia, coupling, 0.0, step)

    def law(_: float, x: Numbers, u: Numbers) -> tuple[tuple[float, ...], list[float]]:
        if coupling is None:
            # The state is the sum of step times speed, with the speed at the end of each step.
            speed, distance = u[0], x[0] + 0.5 * step * radius * (start_speed - u[0])
        else:
            speed, distance = x[1], radius * x[2]
        drag_torque, slope_torque, rolling, brake = road(radius * speed, distance, u[1])
        resistance = drag_torque + slope_torque
        friction = rolling + brake
        if coupling is not None:
            free_state = a @ x + b @ [u[0], resistance]
            friction = dry_friction(free_state[1], -b[1, 1], friction)
        elif not prevents_reverse:
            # The free speed excludes the torque of the FMU, which is unknown here; it acts in the next step.
            speed_per_torque = step / inertia
            friction = dry_friction(u[0] - speed_per_torque * resistance, speed_per_torque, friction)
        parts = drag_torque, slope_torque, *_divide_friction(friction, rolling, brake)
        torque, next_state = resistance + friction, [x[0] + step * radius * speed]
        if coupling is not None:
            torque = coupling.torque(x[0], u[0] - speed)
            next_state = (a @ x + b @ [u[0], sum(parts)]).tolist()
        return (torque, speed, radius * speed, distance, *parts), next_state

    states = ("distance",) if coupling is None else COUPLED
    inputs = ["omega_out", "brake_force"]
    return Load(
        DiscreteSystem("vehicle_load", step, inputs, _VEHICLE_OUTPUTS, law, states), inertia, coupling
    )
