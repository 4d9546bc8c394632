"""What a refusal by the kernel of DrivenShaft says to a person."""

from __future__ import annotations

from collections.abc import Sequence

from .driven_shaft_variables import BY_NAME
from .kernel import driven_shaft_slots as slots
from .kernel.slots import BAD_LOAD_TORQUE, BAD_STEP
from .messages import refused_step
from .variables import refusal


def explain(status: int, values: Sequence[float], inputs: Sequence[float], step: float) -> str:
    """The message for a status of the kernel.

    Args:
        status: status code of the kernel, not OK. values: parameters by slot.
        inputs: inputs by slot. step: communication step, s.
    """
    if status == slots.BAD_HUB_SPEED:
        return refusal(BY_NAME["hub_speed"], inputs[slots.U_HUB_SPEED])
    if status == BAD_LOAD_TORQUE:
        return refusal(BY_NAME["load_torque"], inputs[slots.U_LOAD_TORQUE])
    if status == BAD_STEP:
        return refused_step(step)
    return (
        f"communication step = {step:.16g} s is given up: the motion leaves the range of doubles with"
        f" hub_speed = {inputs[slots.U_HUB_SPEED]:.16g} rad/s and load_torque ="
        f" {inputs[slots.U_LOAD_TORQUE]:.16g} N.m; allowed is what stays below 1e300"
    )
