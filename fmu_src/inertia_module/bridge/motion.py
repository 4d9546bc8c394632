"""Motion of an FMU that a system of python-control can start anew from."""

from __future__ import annotations

from collections.abc import Sequence

from ..common.errors import did_you_mean
from ..contract.driven_shaft import BY_NAME as OF_SHAFT
from ..contract.variable import DRIVE_ANGLE, ENUMERATIONS, LINK1_ANGLE, SINCE_START
from ..contract.variables import BY_NAME as OF_MODULE
from ..harness.fmu import Fmu, FmuError
from ..kernel.codes import DRIVE_TORQUE

# what of the motion has a start parameter, by fidelity
_MOTION = {
    "kinematic": ("drive_angle",),
    "averaged": ("omega_out",),
    "rigid": ("drive_angle", "omega2", "omega_out"),
}
_SHAFT_MOTION = ("omega_out", "twist")
# speed of link 1 where a torque drives the module, which starts at omega1
_INPUT_SPEED = "input_speed"


def start_name(name: str) -> str:
    """Parameter or input that a number of the motion starts from."""
    return "omega1" if name == _INPUT_SPEED else f"{name}_start"


def check_inputs(fmu: Fmu, inputs: Sequence[str]) -> None:
    """Refuse inputs of a system that are none of the FMU, or that have no effect with its drive.

    Raises:
        FmuError: the input, and what is allowed.
    """
    known = [name for name, variable in fmu.variables.items() if variable.causality == "input"]
    for name in inputs:
        if name not in known:
            raise FmuError(f"input {name} must be one of the FMU {did_you_mean(name, known)}")
    if "drive" not in fmu.variables:
        return
    by_torque = _is_driven_by_torque(fmu)
    idle, given, drive = (
        ("omega1", "drive_torque", "torque") if by_torque else ("drive_torque", "omega1", "speed")
    )
    if idle in inputs:
        raise FmuError(
            f"with drive = {drive} an input must be {given}, is {idle}: that has no effect after the start"
        )


def _is_driven_by_torque(fmu: Fmu) -> bool:
    return "drive" in fmu.variables and fmu["drive"] == DRIVE_TORQUE


def check_outputs(names: Sequence[str], motion: Sequence[str]) -> None:
    """Refuse outputs of a system that do not follow from its motion.

    Raises:
        FmuError: the output, and what is allowed.
    """
    for name in names:
        variable = OF_MODULE.get(name) or OF_SHAFT.get(name)
        follows = variable.follows if variable is not None else ""
        if follows == SINCE_START:
            raise FmuError(
                f"with output {name} state must be 'whole', is 'motion': it is a sum since the start,"
                " which does not follow from the motion"
            )
        if follows == LINK1_ANGLE or (follows == DRIVE_ANGLE and "drive_angle" not in motion):
            raise FmuError(
                f"with output {name} state must be 'whole', is 'motion': it depends on {follows}, which is"
                f" no state here ({', '.join(motion)})"
            )


def motion_of(fmu: Fmu) -> tuple[str, ...]:
    """Names of the motion that the FMU has start parameters for.

    Raises:
        FmuError: these are not all of its motion.
    """
    if "input_hold" in fmu.variables and fmu["input_hold"] != 0.0:
        raise FmuError(
            "with state = 'motion' input_hold must be constant, is linear: that goes on from the last two"
            " inputs; state = 'whole' has them"
        )
    if "fidelity" not in fmu.variables:
        return _SHAFT_MOTION
    fidelity = ENUMERATIONS["Fidelity"][int(fmu["fidelity"])][0]
    if fidelity not in _MOTION:
        raise FmuError(
            f"with state = 'motion' fidelity must be one of {', '.join(_MOTION)}, is {fidelity}: that has no"
            " start parameters for all of its motion; state = 'whole' needs none"
        )
    return (*_MOTION[fidelity], _INPUT_SPEED) if _is_driven_by_torque(fmu) else _MOTION[fidelity]
