"""What a refusal by the kernel says to a person: names, values and what is allowed."""

from __future__ import annotations

from collections.abc import Sequence

from .kernel import slots
from .variables import BY_NAME, LARGEST_STEP, refusal


def _named(values: Sequence[float], *names: str) -> str:
    return ", ".join(f"{name} = {values[BY_NAME[name].slot]:.16g}" for name in names)


def explain_parameters(status: int, values: Sequence[float]) -> str | None:
    """Message for a status of the start, or None if it is not one of the parameters."""
    if status == slots.NO_RECTIFIER:
        named = _named(values, "fidelity", "housing_freewheel", "output_freewheel")
        return (
            f"{named} are refused together: without both freewheels nothing rectifies the pulses and there is"
            " no mean torque; allowed is fidelity = 1 (averaged) with both freewheels"
        )
    if status == slots.SINGULAR:
        names = "link2_inertia", "drive_inertia", "a", "b", "eccentricity", "imbalance_mass"
        return (
            f"{_named(values, *names)} are refused together: the inertia behind link 2 vanishes where the"
            " imbalance rests in link 1 (a = b, or no eccentricity); allowed is link2_inertia > 0,"
            " drive_inertia > 0, or a different from b"
        )
    if status == slots.BAD_START_HOUSING:
        named = _named(values, "omega2_start")
        return f"{named} is refused: with the housing freewheel allowed is omega2_start >= 0"
    if status in (slots.BAD_START_OUTPUT, slots.BAD_START_RIGID):
        named = _named(values, "omega_out_start", "omega2_start")
        word, sign = ("with", ">=") if status == slots.BAD_START_OUTPUT else ("without", "=")
        return (
            f"{named} are refused together: {word} the output freewheel allowed is"
            f" omega_out_start {sign} omega2_start"
        )
    return None


def refused_step(step: float) -> str:
    """Message for a communication step that is none."""
    return f"communication step = {step:.16g} s is refused: allowed is above 0 up to {LARGEST_STEP:g} s"


def explain_step(status: int, values: Sequence[float], inputs: Sequence[float], step: float) -> str:
    """Message for a status of a communication step."""
    if status == slots.BAD_OMEGA1:
        return refusal(BY_NAME["omega1"], inputs[slots.U_OMEGA1])
    if status == slots.BAD_LOAD_TORQUE:
        return refusal(BY_NAME["load_torque"], inputs[slots.U_LOAD_TORQUE])
    named = f"communication step = {step:.16g} s"
    if status == slots.BAD_STEP:
        return refused_step(step)
    if status == slots.TOO_MANY_SWITCHES:
        allowed = "1000 switches and 64 more a pulse"
        return f"{named} is given up: the freewheels switch without end; allowed is {allowed}"
    if status == slots.TOO_MUCH_WORK:
        return (
            f"{named} is given up: it takes more than 5e7 evaluations of the mechanism; allowed is a shorter"
            " communication step or a larger tolerance"
        )
    if status == slots.STEP_TOO_SMALL:
        return (
            f"{named} is given up: no internal step meets {_named(values, 'tolerance')};"
            " allowed is a larger tolerance, or more link2_inertia"
        )
    return (
        f"{named} is given up: the motion leaves the range of doubles with omega1 ="
        f" {inputs[slots.U_OMEGA1]:.16g} rad/s and load_torque = {inputs[slots.U_LOAD_TORQUE]:.16g} N.m;"
        " allowed is what stays below 1e300"
    )


def explain(status: int, values: Sequence[float], inputs: Sequence[float], step: float) -> str:
    """The message for a status of the kernel.

    Args:
        status: status code of the kernel, not OK. values: parameters by slot.
        inputs: inputs by slot. step: communication step, s.
    """
    return explain_parameters(status, values) or explain_step(status, values, inputs, step)
