"""A communication step by fidelity and method, with the speed or the torque of link 1 given."""

from .accumulate import add, wrap_input_angle
from .averaged.jump import jump_averaged, takes_up_jump
from .averaged.run import run_averaged
from .codes import AVERAGED, DRIVE_TORQUE, DRIVING, ELASTIC, KINEMATIC, OK, TIMESTEPPING
from .engine import run_events, switch
from .general.choice import choose_states
from .general.motion import evaluate, recall, take_state
from .general.states import GEARED
from .impulse import jump_input
from .links import prescribed_at_input
from .shaft import is_stiff
from .solvers.kinematic import follow_ratio, prescribe
from .solvers.timestepping import run_timestepping


def accelerations_now(d, x):
    """Accelerations of links 1 and 2 in the present mode, rad/s^2."""
    if x.output_state == GEARED:
        prescribe(d, x, 0.0)
        return d.machine.alpha1, d.machine.alpha2
    take_state(d, x)
    if x.rates_cached != 0.0:
        recall(d.machine, x.now)
    else:
        evaluate(d, x, prescribed_at_input(d, x), x.load_torque, False)
    return d.machine.alpha1, d.machine.alpha2


def keep_ratio(d, x):
    """Give link 2 and the output the speed that is prescribed."""
    x.omega2 = x.omega3 = d.ratio * x.omega1
    x.omega2_low = x.omega3_low = 0.0
    follow_ratio(x, x.omega1, x.omega2)


def follow_parameters(p, d, x):
    """Write what parameters prescribe at once: the prescribed speed of link 2, or contact mode and alpha1."""
    if p.fidelity == KINEMATIC:
        keep_ratio(d, x)
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


def run_pulses(p, d, x, w, h):
    """Advance the rigid, elastic or kinematic module by h. Returns a status."""
    if p.method == TIMESTEPPING and p.fidelity != KINEMATIC:
        return run_timestepping(d, x, w, h)
    return run_events(d, x, w, h)


def turn_input(p, d, x, start1, h):
    """Angle and speed of link 1 at the end of the step, its speed given from start1 on."""
    if p.fidelity == AVERAGED:  # else it has turned with all the rest
        x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, h * (start1 + 0.5 * x.alpha1 * h))
        wrap_input_angle(x)
    x.omega1 = start1 + x.alpha1 * h
    x.omega1_low = 0.0
    if p.fidelity == KINEMATIC:
        keep_ratio(d, x)


def run_at_speed(p, d, u, x, w, h, jump):
    """Advance by h with the speed of link 1 given, after a jump of it (or of a prescribed ratio).

    Returns:
        (status, impulses of the input torque and of the output freewheel in the jump, N m s).
    """
    input_jump = 0.0
    output_jump = 0.0
    if jump != 0.0 or (p.fidelity == KINEMATIC and x.omega2 != d.ratio * x.omega1):
        if p.fidelity == AVERAGED:
            if takes_up_jump(d, x, jump, h):
                x.alpha1 += jump / h
            else:
                input_jump = jump_averaged(d, x, jump)
        else:
            x.torques_continue = 0.0
            stiff = p.fidelity == ELASTIC and is_stiff(d, x, u.omega1)
            input_jump, output_jump = jump_input(d, x, jump, stiff)
    start1 = x.omega1
    if p.fidelity == AVERAGED:
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
