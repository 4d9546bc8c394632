"""Discrete-time controllers: PI with limits and anti-windup, and the brake of a driver."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..common.deprecated import renamed_arguments
from ..common.errors import must_be
from .engine import Governor

if TYPE_CHECKING:
    from .discrete_system import DiscreteSystem, Numbers

__all__ = ["driver_brake", "pi_speed_controller"]


def pi_speed_controller(
    step: float,
    proportional_gain: float,
    integral_gain: float,
    limits: tuple[float, float],
    *,
    feedforward: float = 0.0,
    measured: str = "omega_out",
    command: str = "omega1",
) -> DiscreteSystem:
    """Make a PI controller with output limits, feedforward and anti-windup by back-calculation.

    The control law is Governor.sample, for any measured speed and any command.

    Args:
        step: Communication step, s.
        proportional_gain: Command per unit of the measured speed.
        integral_gain: Rate of the command, 1/s, per unit of the measured speed.
        limits: Minimum and maximum command.
        feedforward: Command per unit of the reference.
        measured: Name of the measured speed.
        command: Name of the output.

    Returns:
        A system with the inputs "reference" and ``measured`` and the output ``command``. Its state is the
        integral, in units of the command.

    Raises:
        ValueError: A gain is negative or not finite, or the limits are not in order.
    """
    from .discrete_system import DiscreteSystem

    governor = Governor(proportional_gain, integral_gain, step)
    low, high = limits
    if not low < high:
        raise ValueError(must_be("limits", "a minimum below a maximum", f"{low:g} and {high:g}"))

    def law(_: float, x: Numbers, u: Numbers) -> tuple[list[float], list[float]]:
        output, integral = governor.sample(x[0], u[0], u[1], limits, feedforward * u[0])
        return [output], [integral]

    return DiscreteSystem("pi_speed_controller", step, ["reference", measured], [command], law, ["integral"])


@renamed_arguments(greatest="maximum")
def driver_brake(step: float, gain: float, maximum: float, margin: float = 0.0) -> DiscreteSystem:
    """Make the brake of a driver: a force proportional to the excess of the vehicle speed.

    Args:
        step: Communication step, s.
        gain: Force per excess speed, N.s/m.
        maximum: Maximum force of the brake, N.
        margin: Excess speed at which the brake begins to act, m/s.

    Returns:
        A system without states, with the inputs reference and vehicle_speed, m/s, and the output
        brake_force, N.
    """
    from .discrete_system import DiscreteSystem

    def law(_: float, __: Numbers, u: Numbers) -> tuple[list[float], tuple[()]]:
        return [min(max(gain * (u[1] - u[0] - margin), 0.0), maximum)], ()

    return DiscreteSystem("driver_brake", step, ["reference", "vehicle_speed"], ["brake_force"], law)
