"""A communication step by fidelity and method, with the speed or the torque of link 1 given."""

from .accumulate import add, time_later, wrap_drive_angle, wrap_input_angle
from .averaged.jump import jump_averaged, takes_up_jump
from .averaged.run import run_averaged
from .codes import AVERAGED, DRIVE_TORQUE, DRIVING, ELASTIC, KINEMATIC, OK, TIMESTEPPING, TOO_MUCH_WORK
from .engine import run_events, switch
from .general.choice import choose_states
from .general.jump import jump_general
from .general.motion import evaluate, recall, take_state
from .impulse import jump_kinematic
from .limits import MAX_EVALUATIONS, MAX_STEPS
from .links import prescribed_at_input
from .loads import sample_load
from .shaft import is_stiff
from .solvers.kinematic import advance_kinematic
from .solvers.timestepping import clear_losses, one_step, steps_in


def accelerations_now(d, x):
    """Accelerations of links 1 and 2 in the present mode, rad/s^2."""
    take_state(d, x)
    if x.rates_cached != 0.0:
        recall(d.machine, x.now)
    else:
        evaluate(d, x, prescribed_at_input(d, x), x.load_torque, False)
    return d.machine.alpha1, d.machine.alpha2


def follow_parameters(p, d, x):
    """Write what parameters prescribe at once: the prescribed speed of link 2, or contact mode and alpha1."""
    if p.fidelity == KINEMATIC:
        x.omega2 = p.kinematic_ratio * x.omega1
        x.omega3 = x.omega2
        x.mode = DRIVING
    elif p.fidelity != AVERAGED:
        choose_states(d, x, 0.0)
        if p.drive == DRIVE_TORQUE:
            x.alpha1, _ = accelerations_now(d, x)


def switch_now(p, d, x):
    """Carry out the switch that the last step has stopped at, if it has."""
    if x.switching != 0.0:
        switch(d, x)
        if p.drive == DRIVE_TORQUE:
            x.alpha1, _ = accelerations_now(d, x)


def run_timestepping(d, x, w, h):
    """Advance by h in equal steps. Returns a status."""
    count = steps_in(d, h)
    if count > MAX_STEPS:
        return TOO_MUCH_WORK
    part = h / count
    clear_losses(d, w)
    number = 0.0
    start1 = x.omega1
    while number < count:
        number += 1.0
        if d.by_torque != 0.0:
            prescribed = x.drive_torque * part
        else:
            prescribed = start1 + x.alpha1 * part * number - x.omega1
        omega1, omega2 = x.omega1, x.omega2
        one_step(d, x, w, prescribed, x.load_torque, part)
        sample_load(d, x, x.q, x.omega1, x.omega2, (x.omega1 - omega1) / part, (x.omega2 - omega2) / part)
    # what the torques now follow from
    switches, evaluations = x.step_switches, x.step_evaluations
    choose_states(d, x, 0.0)
    x.step_switches, x.step_evaluations = switches, evaluations
    return OK


def run_kinematic(p, d, x, h):
    """Advance the prescribed motion by h. Returns a status."""
    time = 0.0
    low = 0.0
    while time < h:
        remaining = (h - time) - low
        speed = x.omega1 + x.alpha1 * time
        passed = advance_kinematic(d, x, p.kinematic_ratio, speed, x.alpha1, remaining)
        wrap_drive_angle(d, x)
        if passed >= remaining:
            time = h
        else:
            time, low = time_later(time, low, passed)
        if x.step_evaluations > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
    speed = p.kinematic_ratio * (x.omega1 + x.alpha1 * h)
    x.omega2 = speed
    x.omega2_low = 0.0
    x.omega3 = speed
    x.omega3_low = 0.0
    return OK


def run_pulses(p, d, x, w, h):
    """Advance the rigid or elastic module by h. Returns a status."""
    if p.method == TIMESTEPPING:
        return run_timestepping(d, x, w, h)
    return run_events(d, x, w, h)


def turn_input(p, d, x, start1, h):
    """Angle and speed of link 1 at the end of the step, its speed given from start1 on."""
    if p.fidelity == AVERAGED:  # else it has turned with all the rest
        x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, h * (start1 + 0.5 * x.alpha1 * h))
        wrap_input_angle(x)
    x.omega1 = start1 + x.alpha1 * h
    x.omega1_low = 0.0


def run_at_speed(p, d, u, x, w, h, jump):
    """Advance by h with the speed of link 1 given, after a jump of it (or of a prescribed ratio).

    Returns:
        (status, impulses of the input torque and of the output freewheel in the jump, N m s).
    """
    input_jump = 0.0
    output_jump = 0.0
    if p.fidelity == KINEMATIC:
        input_jump, output_jump = jump_kinematic(d, x, jump, p.kinematic_ratio)
    elif jump != 0.0:
        if p.fidelity == AVERAGED:
            if takes_up_jump(d, x, jump, h):
                x.alpha1 += jump / h
            else:
                input_jump = jump_averaged(d, x, jump)
        else:
            x.torques_continue = 0.0
            stiff = p.fidelity == ELASTIC and is_stiff(d, x, u.omega1)
            input_jump, output_jump = jump_general(p, d, x, jump, stiff)
    start1 = x.omega1
    if p.fidelity == KINEMATIC:
        status = run_kinematic(p, d, x, h)
    elif p.fidelity == AVERAGED:
        status = run_averaged(d, x, w, h)
    else:
        status = run_pulses(p, d, x, w, h)
    if status == OK:
        turn_input(p, d, x, start1, x.length)
    return status, input_jump, output_jump


def run_by_torque(p, d, x, w, h):
    """Advance by h with the torque on link 1 given. Returns a status."""
    if p.fidelity == AVERAGED:
        status = run_averaged(d, x, w, h)
    else:
        status = run_pulses(p, d, x, w, h)
        if status == OK:
            x.alpha1, _ = accelerations_now(d, x)
    x.input_impulse = x.drive_torque * x.length
    return status
