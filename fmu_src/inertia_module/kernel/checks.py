"""Checks of parameters that are invalid only in combination; messages are in interface/messages.py."""

from . import codes
from .averaged.torque_map import is_light_input
from .equations.satellites import is_self_locking
from .parameters import min_inertia_ratio
from .records import Constants

SINGULAR_RATIO = 1e-12  # An inertia below this fraction of its maximum counts as zero
MIN_STIFFNESS = 1e-2  # N m/rad, of the spring of a freewheel


def check_torque_drive(d: Constants) -> int:
    """Return the status of the requirements of torque-driven operation.

    Args:
        d: Constants.
    """
    if d.by_torque == 0.0:
        return codes.OK
    if d.fidelity == codes.KINEMATIC:
        return codes.TORQUE_DRIVE_UNSUPPORTED
    if not d.input_inertia > SINGULAR_RATIO * d.F_by_alpha1:
        return codes.INPUT_INERTIA_TOO_SMALL
    return codes.OK


def check_averaged(d: Constants) -> int:
    """Return the status of the requirements of fidelity averaged.

    Args:
        d: Constants.
    """
    if d.fidelity != codes.AVERAGED:
        return codes.OK
    if d.windage > 0.0:
        return codes.WINDAGE_UNSUPPORTED
    if d.housing_freewheel == 0.0 or d.output_freewheel == 0.0:
        return codes.FREEWHEELS_REQUIRED
    return codes.OK


def check_start_speeds(d: Constants) -> int:
    """Return the status of the initial speeds: freewheels allow one sign of their relative speed.

    Args:
        d: Constants.
    """
    omega2 = d.omega2_start
    omega_out = d.omega_out_start
    if d.housing_freewheel != 0.0 and omega2 < 0.0:
        return codes.BAD_START_HOUSING
    if d.output_freewheel == 0.0:
        if omega2 != omega_out:
            return codes.BAD_START_RIGID
    elif omega_out < omega2:
        return codes.BAD_START_OUTPUT
    return codes.OK


def check_combinations(d: Constants) -> int:
    """Return the status of all combinations except self-locking meshes and a light link 1.

    Args:
        d: Constants.
    """
    if 0.0 < d.housing_stiffness < MIN_STIFFNESS or 0.0 < d.freewheel_stiffness < MIN_STIFFNESS:
        return codes.SOFT_FREEWHEEL
    status = check_torque_drive(d)
    if status != codes.OK:
        return status
    if d.fidelity == codes.KINEMATIC:
        return codes.BACKLASH_UNSUPPORTED if d.backlash != 0.0 else codes.OK
    status = check_averaged(d)
    if status != codes.OK:
        return status
    if not min_inertia_ratio(d) > SINGULAR_RATIO:
        return codes.SINGULAR
    return check_start_speeds(d)


def check_parameters(d: Constants) -> int:
    """Return OK, or the status of parameters that are rejected together.

    Args:
        d: Constants (parameters.derive_constants).
    """
    status = check_combinations(d)
    if status == codes.OK and d.losses + d.averaged_losses != 0.0 and is_self_locking(d):
        return codes.SELF_LOCKING
    if status == codes.OK and d.fidelity == codes.AVERAGED and is_light_input(d):
        return codes.LIGHT_INPUT
    return status
