"""Controllers in discrete time: PI with limits and anti-windup, and the driver's brake."""

from __future__ import annotations

from typing import Any

from ..common.errors import must_be
from .engine import Governor
from .sources import Sampled

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
) -> Any:
    """PI controller with output limits, feedforward of the reference and anti-windup by back-calculation.

    Its law is that of Governor, for any speed and any command.

    Args:
        step: communication step, s. limits: least and greatest command.
        proportional_gain: command per unit of the measured speed; integral_gain: and second.
        feedforward: command per unit of the reference.
        measured: name of the measured speed. command: name of the output.

    Returns:
        A system with inputs reference and measured, output command, and the integral, in units of the
        command, as its state.

    Raises:
        ValueError: a gain is negative or not finite, or the limits are not in order.
    """
    governor = Governor(proportional_gain, integral_gain, step)
    low, high = limits
    if not low < high:
        raise ValueError(must_be("limits", "a minimum below a maximum", f"{low:g} and {high:g}"))

    def law(_: float, x: Any, u: Any) -> tuple[list[float], list[float]]:
        commanded, integral = governor.sample(x[0], u[0], u[1], limits, feedforward * u[0])
        return [commanded], [integral]

    return Sampled("pi_speed_controller", step, ["reference", measured], [command], law, ["integral"])


def driver_brake(step: float, gain: float, greatest: float, margin: float = 0.0) -> Any:
    """The driver's brake: a force in proportion to the excess of the vehicle's speed.

    Args:
        step: communication step, s. gain: N per m/s. greatest: force the brakes can have, N.
        margin: excess of speed without braking, m/s.

    Returns:
        A system without states, with inputs reference and vehicle_speed, m/s, and output brake_force, N.
    """

    def law(_: float, __: Any, u: Any) -> tuple[list[float], tuple[()]]:
        return [min(max(gain * (u[1] - u[0] - margin), 0.0), greatest)], ()

    return Sampled("driver_brake", step, ["reference", "vehicle_speed"], ["brake_force"], law)
