"""A step with the speed of link 1 given: a jump of it, then the motion by fidelity and method."""

from .accumulate import add, assign, later, wrap_drive_angle, wrap_input_angle
from .average import run_averaged
from .average_jump import jump_averaged, takes_up_jump
from .contact import select_mode
from .elastic import advance_elastic, is_stiff, shaft_frequency
from .held import advance_held
from .impulse import jump_input, jump_kinematic
from .kinematic import advance_kinematic
from .limits import MAX_EVALUATIONS, MAX_STEPS, STALLS_ALLOWED, SWITCHES_ALLOWED, SWITCHES_PER_PULSE
from .outputs import shaft_load
from .pulse import advance_moving
from .slots import *
from .timestepping import one_step, put_inertia, put_shaft, steps_in


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
    choose_mode(p, d, x, omega1 + alpha1 * h)  # what the torques now follow from
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


def run_at_speed(p, d, u, x, w, h, jump):
    """Advance by h with the speed of link 1 given, after a jump of it.

    Returns:
        (status, impulses of the input torque and of the output freewheel in the jump, N m s).
    """
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
    return status, input_jump, output_jump
