"""Start, and advance by a communication step."""

import math

from .accumulate import add, assign, later, wrap_drive_angle, wrap_input_angle
from .average import run_averaged, set_link2
from .average_jump import jump_averaged, takes_up_jump
from .average_legs import RESTING
from .average_map import build_map
from .contact import select_mode
from .derive import derive
from .elastic import advance_elastic, is_stiff, shaft_frequency
from .held import advance_held
from .impulse import jump_input, jump_kinematic
from .kinematic import advance_kinematic
from .limits import (
    LARGEST_SPEED,
    LARGEST_STEP,
    LARGEST_TORQUE,
    MAX_EVALUATIONS,
    MAX_STEPS,
    SMALLEST_SPEED,
    STALLS_ALLOWED,
    SWITCHES_ALLOWED,
    SWITCHES_PER_PULSE,
)
from .outputs import shaft_load, stored_energy, write_late_outputs, write_outputs
from .pulse import advance_moving
from .slots import *
from .timestepping import one_step, put_inertia, put_shaft, steps_in
from .torque_average import driven_mean, run_driven_averaged
from .torque_drive import driven_mode, put_acceleration, run_driven, run_driven_timestepping


def check_inputs(u):
    """Status of the inputs: finite and within what a drivetrain can mean."""
    if not abs(u[U_OMEGA1]) <= LARGEST_SPEED:
        return BAD_OMEGA1
    if not abs(u[U_LOAD_TORQUE]) <= LARGEST_TORQUE:
        return BAD_LOAD_TORQUE
    if not abs(u[U_DRIVE_TORQUE]) <= LARGEST_TORQUE:
        return BAD_DRIVE_TORQUE
    return OK


def check_rates(u, h):
    """Status of the rates of the inputs that are given: no input becomes absurd within the step h."""
    if u[U_OMEGA1_RATE_GIVEN] != 0.0:
        if not abs(u[U_OMEGA1] + u[U_OMEGA1_RATE] * h) <= LARGEST_SPEED:
            return BAD_OMEGA1_RATE
    if u[U_LOAD_TORQUE_RATE_GIVEN] != 0.0:
        if not abs(u[U_LOAD_TORQUE] + u[U_LOAD_TORQUE_RATE] * h) <= LARGEST_TORQUE:
            return BAD_LOAD_TORQUE_RATE
    if u[U_DRIVE_TORQUE_RATE_GIVEN] != 0.0:
        if not abs(u[U_DRIVE_TORQUE] + u[U_DRIVE_TORQUE_RATE] * h) <= LARGEST_TORQUE:
            return BAD_DRIVE_TORQUE_RATE
    return OK


def check(p, d, u):
    """Derive the constants and check parameters and inputs. Returns a status."""
    status = derive(p, d)
    return check_inputs(u) if status == OK else status


def input_speed(u):
    """omega1, rad/s, or zero where it is too slow to be squared."""
    omega1 = u[U_OMEGA1]
    return omega1 if abs(omega1) >= SMALLEST_SPEED else 0.0


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


def extrapolate_input(p, u, x, h):
    """Slope of omega1 over the coming step and the jump that is left at its beginning."""
    omega1 = input_speed(u)
    alpha1 = 0.0
    if u[U_OMEGA1_RATE_GIVEN] != 0.0:
        alpha1 = u[U_OMEGA1_RATE]
    elif p[P_INPUT_HOLD] != 0.0 and x[X_HELD_STEP] > 0.0:
        alpha1 = (omega1 - x[X_HELD_INPUT]) / x[X_HELD_STEP]
    x[X_HELD_INPUT] = omega1
    x[X_HELD_STEP] = h
    return alpha1, omega1 - x[X_OMEGA1]


def begin(p, u, x, h):
    """Take the inputs of the coming step and clear its sums. Returns the jump of omega1.

    A torque counts by its mean over the step: with its rate given, that at the middle.
    """
    jump = 0.0
    if p[P_DRIVE] == DRIVE_SPEED:
        alpha1, jump = extrapolate_input(p, u, x, h)
        x[X_ALPHA1] = alpha1
    x[X_LOAD_TORQUE] = u[U_LOAD_TORQUE]
    if u[U_LOAD_TORQUE_RATE_GIVEN] != 0.0:
        x[X_LOAD_TORQUE] += 0.5 * h * u[U_LOAD_TORQUE_RATE]
    x[X_DRIVE_TORQUE] = u[U_DRIVE_TORQUE]
    if u[U_DRIVE_TORQUE_RATE_GIVEN] != 0.0:
        x[X_DRIVE_TORQUE] += 0.5 * h * u[U_DRIVE_TORQUE_RATE]
    x[X_INPUT_IMPULSE] = 0.0
    x[X_OUTPUT_IMPULSE] = 0.0
    x[X_OUTPUT_SQUARE] = 0.0
    x[X_TORQUE_PEAK] = 0.0
    x[X_STEP_SWITCHES] = 0.0
    x[X_STEP_EVALUATIONS] = 0.0
    return jump


def present_mode(p, d, x, omega1):
    """Contact mode of the state in x."""
    load, rate = shaft_load(p, d, x)
    return select_mode(d, x[X_Q], omega1, x[X_ALPHA1], x[X_OMEGA2], x[X_OMEGA3], load, rate)


def choose_mode(p, d, x, omega1):
    """Choose the contact mode anew and count a switch if it is another."""
    mode = present_mode(p, d, x, omega1)
    if mode != x[X_MODE]:
        x[X_MODE] = mode
        x[X_STEP_SWITCHES] += 1.0


def run_events(p, d, x, w, h):
    """Advance link 2 and the output shaft by h from event to event. Returns a status."""
    omega1 = x[X_OMEGA1]
    alpha1 = x[X_ALPHA1]
    load = x[X_LOAD_TORQUE]
    time = 0.0
    low = 0.0
    travel = 0.0
    stalls = 0
    choose_mode(p, d, x, omega1)
    while time < h:
        remaining = (h - time) - low
        mode = x[X_MODE]
        speed = omega1 + alpha1 * time
        if p[P_FIDELITY] == ELASTIC:
            passed, event = advance_elastic(d, x, w, speed, alpha1, load, remaining)
            travel += passed * shaft_frequency(d, 1.0 / d[D_J3])
        elif mode == HELD or mode == HELD_DRIVING:
            passed, event = advance_held(d, x, mode, speed, alpha1, load, remaining)
        else:
            passed, event = advance_moving(d, x, w, speed, alpha1, load, remaining)
        if passed < 0.0:
            return STEP_TOO_SMALL
        travel += passed * d[D_K] * (abs(speed) + abs(alpha1) * passed + abs(x[X_OMEGA2]))
        wrap_drive_angle(d, x)
        if passed >= remaining:
            time = h
        else:
            time, low = later(time, low, passed)
        if event:
            choose_mode(p, d, x, omega1 + alpha1 * time)
            stalls = stalls + 1 if x[X_MODE] == mode else 0
            if stalls > STALLS_ALLOWED:
                return TOO_MANY_SWITCHES
            if x[X_STEP_SWITCHES] > SWITCHES_ALLOWED + SWITCHES_PER_PULSE * d[D_HARMONIC] * travel:
                return TOO_MANY_SWITCHES
        if x[X_STEP_EVALUATIONS] > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
    return OK


def run_timestepping(p, d, x, w, h):
    """Advance by h in equal steps. Returns a status."""
    count = steps_in(d, h)
    if count > MAX_STEPS:
        return TOO_MUCH_WORK
    omega1 = x[X_OMEGA1]
    alpha1 = x[X_ALPHA1]
    part = h / count
    number = 0.0
    put_inertia(d, x, w)
    put_shaft(p, d, w, part)
    while number < count:
        one_step(p, d, x, w, omega1 + alpha1 * part * number, alpha1, x[X_LOAD_TORQUE], part)
        number += 1.0
    x[X_MODE] = present_mode(p, d, x, omega1 + alpha1 * h)  # what the torques now follow from
    return OK


def run_kinematic(p, d, x, h):
    """Advance the prescribed motion by h. Returns a status."""
    time = 0.0
    low = 0.0
    while time < h:
        remaining = (h - time) - low
        speed = x[X_OMEGA1] + x[X_ALPHA1] * time
        passed = advance_kinematic(d, x, p[P_KINEMATIC_RATIO], speed, x[X_ALPHA1], remaining)
        wrap_drive_angle(d, x)
        if passed >= remaining:
            time = h
        else:
            time, low = later(time, low, passed)
        if x[X_STEP_EVALUATIONS] > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
    speed = p[P_KINEMATIC_RATIO] * (x[X_OMEGA1] + x[X_ALPHA1] * h)
    assign(x, X_OMEGA2, speed)
    assign(x, X_OMEGA3, speed)
    return OK


def turn_input(x, h):
    """Angle and speed of link 1 at the end of the step, its speed given."""
    add(x, X_THETA1, h * (x[X_OMEGA1] + 0.5 * x[X_ALPHA1] * h))
    wrap_input_angle(x)
    x[X_OMEGA1] += x[X_ALPHA1] * h


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


def run_at_speed(p, d, u, x, w, h, jump):
    """Advance by h with the speed of link 1 given, after a jump of it. Returns a status."""
    input_jump = 0.0
    output_jump = 0.0
    if p[P_FIDELITY] == KINEMATIC:
        if jump != 0.0:
            input_jump, output_jump = jump_kinematic(d, x, jump, p[P_KINEMATIC_RATIO])
        status = run_kinematic(p, d, x, h)
    elif p[P_FIDELITY] == AVERAGED:
        if jump != 0.0:
            if takes_up_jump(d, x, jump, h):
                x[X_ALPHA1] += jump / h
            else:
                input_jump = jump_averaged(d, x, jump)
        status = run_averaged(d, x, w, h)
    else:
        if jump != 0.0:
            stiff = p[P_FIDELITY] == ELASTIC and is_stiff(d, x, u[U_OMEGA1])
            input_jump, output_jump = jump_input(p, d, x, jump, stiff)
        status = run_timestepping(p, d, x, w, h) if p[P_METHOD] == TIMESTEPPING else run_events(p, d, x, w, h)
    if status == OK:
        turn_input(x, h)
        end(x, h, input_jump, output_jump)
    return status


def run_by_torque(p, d, x, w, h):
    """Advance by h with the torque on link 1 given. Returns a status."""
    if p[P_FIDELITY] == AVERAGED:
        status = run_driven_averaged(d, x, w, h)
    elif p[P_METHOD] == TIMESTEPPING:
        status = run_driven_timestepping(p, d, x, w, h)
    else:
        status = run_driven(p, d, x, w, h)
    if status == OK:
        end(x, h, 0.0, 0.0)
    return status


def advance(p, d, u, x, y, w, h, late):
    """Advance by the communication step h, s.

    A status other than OK leaves state and outputs as they were.

    Args:
        p, d, u: parameters, derived constants, inputs (held or extrapolated over the step).
        x, y: state and outputs, written. w: workspace (W_SIZE).
        late: whether the late outputs are wanted, else they stay as they were.
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
    if p[P_DRIVE] == DRIVE_SPEED:
        status = run_at_speed(p, d, u, x, w, h, jump)
    else:
        status = run_by_torque(p, d, x, w, h)
    if status == OK and not is_finite(x):
        status = NOT_FINITE
    if status != OK:
        for n in range(X_SIZE):
            x[n] = w[W_STATE + n]
        return status
    write_outputs(x, y)
    if late:
        write_late_outputs(p, d, x, y)
    return OK
