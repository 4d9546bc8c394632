"""Controllers in discrete time: PI with limits and anti-windup, and the driver's foot on the brake."""

from __future__ import annotations

from typing import Any

from .engine import Governor


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
        step: communication step, s.
        proportional_gain: command per unit of the measured speed.
        integral_gain: command per unit of the measured speed and second.
        limits: least and greatest command.
        feedforward: command per unit of the reference.
        measured: name of the measured speed. command: name of the output.

    Returns:
        A discrete-time control.NonlinearIOSystem with inputs reference and measured, output command, and
        the integral, in units of the command, as its state.

    Raises:
        ValueError: a gain is negative or not finite, or the limits are not in order.
    """
    import control as ct

    governor = Governor(proportional_gain, integral_gain, step)
    low, high = limits
    if not low < high:
        raise ValueError(f"limits must be a lower and a higher one, are {low:g} and {high:g}")

    def sample(x: Any, u: Any) -> tuple[float, float]:
        return governor.sample(x[0], u[0], u[1], limits, feedforward * u[0])

    return ct.nlsys(
        lambda _, x, u, __: sample(x, u)[1:],
        lambda _, x, u, __: sample(x, u)[:1],
        inputs=["reference", measured],
        outputs=[command],
        states=["integral"],
        dt=step,
        name="pi_speed_controller",
    )


def driver_brake(step: float, gain: float, greatest: float, margin: float = 0.0) -> Any:
    """The driver's brake: a force in proportion to how much the vehicle is too fast.

    Args:
        step: communication step, s. gain: N per m/s. greatest: force the brakes can have, N.
        margin: excess of speed that is let pass, m/s.

    Returns:
        A static discrete-time control.NonlinearIOSystem with inputs reference and vehicle_speed, m/s,
        and output brake_force, N.
    """
    import control as ct

    def output(_: float, __: Any, u: Any, ___: Any) -> list[float]:
        return [min(max(gain * (u[1] - u[0] - margin), 0.0), greatest)]

    return ct.nlsys(
        None,
        output,
        inputs=["reference", "vehicle_speed"],
        outputs=["brake_force"],
        dt=step,
        name="driver_brake",
    )
