"""Start, and advance by a communication step."""

import math

from .accumulate import wrap_drive_angle
from .average import set_link2
from .average_legs import RESTING
from .average_map import build_map
from .derive import derive
from .inputs import begin, check_inputs, check_rates, input_speed
from .limits import LARGEST_STEP
from .outputs import stored_energy, write_late_outputs, write_outputs
from .slots import *
from .speed_drive import present_mode, run_at_speed
from .torque_average import driven_mean
from .torque_drive import driven_mode, put_acceleration, run_by_torque


def check(p, d, u):
    """Derive the constants and check parameters and inputs. Returns a status."""
    status = derive(p, d)
    return check_inputs(u) if status == OK else status


def start(p, d, u, x, y):
    """Derive the constants and set the state at the end of initialisation.

    Args:
        p: parameters (P_SIZE), each within its range. u: inputs (U_SIZE).
        d: derived constants (D_SIZE), x: state (X_SIZE), y: outputs (Y_SIZE), all written.

    Returns:
        Status: OK, one of derive's or of check_inputs.
    """
    status = check(p, d, u)
    if status != OK:
        return status
    if p[P_FIDELITY] == AVERAGED:
        build_map(p, d)
    for n in range(X_SIZE):
        x[n] = 0.0
    x[X_OMEGA1] = input_speed(u)
    x[X_HELD_INPUT] = x[X_OMEGA1]
    x[X_LOAD_TORQUE] = u[U_LOAD_TORQUE]
    x[X_DRIVE_TORQUE] = u[U_DRIVE_TORQUE]
    x[X_Q] = p[P_DRIVE_ANGLE_START]
    wrap_drive_angle(d, x)
    if p[P_FIDELITY] == KINEMATIC:
        x[X_OMEGA2] = p[P_KINEMATIC_RATIO] * x[X_OMEGA1]
        x[X_OMEGA3] = x[X_OMEGA2]
        x[X_MODE] = DRIVING
    else:
        x[X_OMEGA2] = p[P_OMEGA2_START]
        x[X_OMEGA3] = p[P_OMEGA_OUT_START]
        if p[P_FIDELITY] == AVERAGED:
            set_link2(d, x, RESTING, -1.0, 0.0)
            if p[P_DRIVE] == DRIVE_TORQUE:
                x[X_ALPHA1], _ = driven_mean(d, x)
                set_link2(d, x, RESTING, -1.0, 0.0)  # link 1 may be about to move
            x[X_STEP_SWITCHES] = 0.0
        elif p[P_DRIVE] == DRIVE_TORQUE:
            x[X_MODE] = driven_mode(p, d, x)
            put_acceleration(p, d, x)
        else:
            x[X_MODE] = present_mode(p, d, x, x[X_OMEGA1])
    x[X_ENERGY_START] = stored_energy(p, d, x)
    write_outputs(x, y)
    write_late_outputs(p, d, x, y)
    return OK


def end(x, h, input_jump, output_jump):
    """Means over the step, all impulses included."""
    x[X_INPUT_TORQUE_MEAN] = (input_jump + x[X_INPUT_IMPULSE]) / h
    x[X_OUTPUT_TORQUE_MEAN] = (output_jump + x[X_OUTPUT_IMPULSE]) / h
    mean = x[X_OUTPUT_IMPULSE] / h
    variance = x[X_OUTPUT_SQUARE] / h - mean * mean
    x[X_TORQUE_RIPPLE] = math.sqrt(variance) if variance > 0.0 else 0.0
    x[X_SWITCHES] += x[X_STEP_SWITCHES]
    x[X_EVALUATIONS] += x[X_STEP_EVALUATIONS]


def is_finite(x):
    """Whether the motion, its energies and its means are: all else follows from them."""
    motion = (abs(x[X_Q]) + abs(x[X_THETA1])) + (abs(x[X_OMEGA2]) + abs(x[X_OMEGA3]))
    shaft = (abs(x[X_RELATIVE]) + abs(x[X_TWIST])) + abs(x[X_OMEGA1])
    energies = (abs(x[X_ENERGY_IN]) + abs(x[X_ENERGY_OUT])) + abs(x[X_ENERGY_LOST])
    means = abs(x[X_INPUT_TORQUE_MEAN]) + (abs(x[X_OUTPUT_TORQUE_MEAN]) + abs(x[X_TORQUE_RIPPLE]))
    return (motion + shaft) + (energies + means) < 1e300


def advance(p, d, u, x, y, w, h, operation):
    """Advance by the communication step h, s.

    A status other than OK leaves state and outputs as they were.

    Args:
        p, d, u: parameters, derived constants, inputs (held or extrapolated over the step).
        x, y: state and outputs, written. w: workspace (W_SIZE).
        operation: that asks for it; with STEP_ONLY the late outputs stay as they were.
    """
    if not 0.0 < h <= LARGEST_STEP:
        return BAD_STEP
    status = check_inputs(u)
    if status == OK:
        status = check_rates(u, h)
    if status != OK:
        return status
    for n in range(X_SIZE):
        w[W_STATE + n] = x[n]
    jump = begin(p, u, x, h)
    input_jump = 0.0
    output_jump = 0.0
    if p[P_DRIVE] == DRIVE_SPEED:
        status, input_jump, output_jump = run_at_speed(p, d, u, x, w, h, jump)
    else:
        status = run_by_torque(p, d, x, w, h)
    if status == OK:
        end(x, h, input_jump, output_jump)
        if not is_finite(x):
            status = NOT_FINITE
    if status != OK:
        for n in range(X_SIZE):
            x[n] = w[W_STATE + n]
        return status
    write_outputs(x, y)
    if operation != STEP_ONLY:
        write_late_outputs(p, d, x, y)
    return OK
