"""What the motion of an FMU is, that a system of python-control can start anew from."""

from __future__ import annotations

from collections.abc import Sequence

from ..driven_shaft_variables import BY_NAME as OF_SHAFT
from ..instance import DriveError, Fmu
from ..kernel.codes import DRIVE_TORQUE
from ..variables import BY_NAME as OF_MODULE
from ..variables import DRIVE_ANGLE, LINK1_ANGLE, SINCE_START

# what of the motion has a start parameter, by fidelity
_MOTION = {
    "kinematic": ("drive_angle",),
    "averaged": ("omega_out",),
    "rigid": ("drive_angle", "omega2", "omega_out"),
}
_FIDELITIES = ("kinematic", "averaged", "rigid", "elastic")
_SHAFT_MOTION = ("omega_out", "twist")
# speed of link 1 where a torque drives the module, which starts at omega1
_INPUT_SPEED = "input_speed"


def start_name(name: str) -> str:
    """Parameter or input that a number of the motion starts from."""
    return "omega1" if name == _INPUT_SPEED else f"{name}_start"


def check_inputs(fmu: Fmu, inputs: Sequence[str]) -> None:
    """Refuse inputs of a system that are none of the FMU, or that have no effect with its drive.

    Raises:
        DriveError: the input, and what is allowed.
    """
    known = [name for name, variable in fmu.variables.items() if variable.causality == "input"]
    for name in inputs:
        if name not in known:
            raise DriveError(f"input {name} is refused: allowed are {', '.join(known)}")
    if "drive" not in fmu.variables:
        return
    by_torque = _is_driven_by_torque(fmu)
    idle, given, drive = (
        ("omega1", "drive_torque", "torque") if by_torque else ("drive_torque", "omega1", "speed")
    )
    if idle in inputs:
        raise DriveError(
            f"input {idle} is refused with drive = {drive}: it has no effect after the start;"
            f" allowed is {given} in its place"
        )


def _is_driven_by_torque(fmu: Fmu) -> bool:
    return "drive" in fmu.variables and fmu["drive"] == DRIVE_TORQUE


def check_outputs(names: Sequence[str], motion: Sequence[str]) -> None:
    """Refuse outputs of a system that do not follow from its motion.

    Raises:
        DriveError: the output, and what is allowed.
    """
    for name in names:
        variable = OF_MODULE.get(name) or OF_SHAFT.get(name)
        follows = variable.follows if variable is not None else ""
        if follows == SINCE_START:
            raise DriveError(
                f"output {name} must follow from the motion with state = 'motion', is a sum since the start;"
                " state = 'whole' has it"
            )
        if follows == LINK1_ANGLE or (follows == DRIVE_ANGLE and "drive_angle" not in motion):
            raise DriveError(
                f"output {name} must follow from the motion ({', '.join(motion)}) with state = 'motion',"
                f" depends on {follows}; state = 'whole' has it"
            )


def motion_of(fmu: Fmu) -> tuple[str, ...]:
    """Names of the motion that the FMU has start parameters for.

    Raises:
        DriveError: these are not all of its motion.
    """
    if "input_hold" in fmu.variables and fmu["input_hold"] != 0.0:
        raise DriveError(
            "input_hold = linear is refused with state = 'motion': it goes on from the last two inputs;"
            " allowed is input_hold = constant, or state = 'whole'"
        )
    if "fidelity" not in fmu.variables:
        return _SHAFT_MOTION
    fidelity = _FIDELITIES[int(fmu["fidelity"])]
    if fidelity not in _MOTION:
        raise DriveError(
            f"fidelity = {fidelity} is refused with state = 'motion': it has no start parameters for all of"
            f" its motion; allowed are {', '.join(_MOTION)}, or state = 'whole'"
        )
    return (*_MOTION[fidelity], _INPUT_SPEED) if _is_driven_by_torque(fmu) else _MOTION[fidelity]
