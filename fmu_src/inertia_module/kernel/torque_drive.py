"""A step with the input torque given: omega1 is a state, so link 1 carries the inertia of what drives it."""

from .accumulate import later, wrap_drive_angle
from .contact import TORQUE_ROUNDING
from .elastic import shaft_frequency
from .limits import MAX_EVALUATIONS, MAX_STEPS, STALLS_ALLOWED, SWITCHES_ALLOWED, SWITCHES_PER_PULSE
from .outputs import shaft_load
from .slots import *
from .timestepping import put_shaft, steps_in
from .torque_average import run_driven_averaged
from .torque_contact import select_driven_mode
from .torque_dynamics import acceleration
from .torque_elastic import advance_driven_elastic
from .torque_pulse import advance_driven
from .torque_stages import is_held
from .torque_timestepping import driven_step, put_slip_inertia

# share of its size that a step keeps after an event that was none
STALLED = 0.25


def driven_mode(p, d, x):
    """Contact mode of the state in x."""
    return driven_mode_within(p, d, x, TORQUE_ROUNDING)


def driven_mode_within(p, d, x, rounding):
    """The same, rounding as for select_driven_mode."""
    load, rate = shaft_load(p, d, x)
    omega1, omega2, omega3 = x[X_OMEGA1], x[X_OMEGA2], x[X_OMEGA3]
    return select_driven_mode(d, x[X_Q], omega1, omega2, omega3, x[X_DRIVE_TORQUE], load, rate, rounding)


def put_acceleration(p, d, x):
    """Acceleration of link 1 in the present mode: the torques follow from it."""
    load, _ = shaft_load(p, d, x)
    driving = x[X_MODE] == DRIVING
    inertia = d[D_J3] if driving else 0.0
    omega1, omega2, torque = x[X_OMEGA1], x[X_OMEGA2], x[X_DRIVE_TORQUE]
    x[X_ALPHA1], _ = acceleration(
        d, x[X_Q], omega1, omega2, torque, is_held(x), inertia, load if driving else 0.0
    )


def choose_mode(p, d, x, rounding):
    """Choose the contact mode anew and count a switch if it is another."""
    mode = driven_mode_within(p, d, x, rounding)
    if mode != x[X_MODE]:
        x[X_MODE] = mode
        x[X_STEP_SWITCHES] += 1.0


def run_driven_timestepping(p, d, x, w, h):
    """Advance all by h in equal steps. Returns a status."""
    count = steps_in(d, h)
    if count > MAX_STEPS:
        return TOO_MUCH_WORK
    part = h / count
    number = 0.0
    put_slip_inertia(d, x, w)
    put_shaft(p, d, w, part)
    while number < count:
        driven_step(p, d, x, w, x[X_DRIVE_TORQUE], x[X_LOAD_TORQUE], part)
        number += 1.0
    choose_mode(p, d, x, TORQUE_ROUNDING)  # what the torques now follow from
    put_acceleration(p, d, x)
    return OK


def run_driven(p, d, x, w, h):
    """Advance all by h from event to event. Returns a status."""
    w[W_DRIVE_TORQUE] = x[X_DRIVE_TORQUE]
    time = 0.0
    low = 0.0
    travel = 0.0
    stalls = 0
    choose_mode(p, d, x, TORQUE_ROUNDING)
    while time < h:
        remaining = (h - time) - low
        mode = x[X_MODE]
        slip = abs(x[X_OMEGA1]) + abs(x[X_OMEGA2])
        if p[P_FIDELITY] == ELASTIC:
            passed, event = advance_driven_elastic(d, x, w, x[X_LOAD_TORQUE], remaining)
            travel += passed * shaft_frequency(d, 1.0 / d[D_J3])
        else:
            passed, event = advance_driven(d, x, w, x[X_LOAD_TORQUE], remaining)
        if passed < 0.0:
            return STEP_TOO_SMALL
        travel += passed * d[D_K] * (slip + abs(x[X_OMEGA1]) + abs(x[X_OMEGA2]))
        wrap_drive_angle(d, x)
        if passed >= remaining:
            time = h
        else:
            time, low = later(time, low, passed)
        if event:
            choose_mode(p, d, x, TORQUE_ROUNDING)
            if x[X_MODE] == mode:
                # a rate too slow to be waited for: the sign alone decides; or a coarse step: a shorter one
                choose_mode(p, d, x, 0.0)
                x[X_STEP_SIZE] *= STALLED
            stalls = stalls + 1 if x[X_MODE] == mode else 0
            if stalls > STALLS_ALLOWED:
                return TOO_MANY_SWITCHES
            if x[X_STEP_SWITCHES] > SWITCHES_ALLOWED + SWITCHES_PER_PULSE * d[D_HARMONIC] * travel:
                return TOO_MANY_SWITCHES
        if x[X_STEP_EVALUATIONS] > MAX_EVALUATIONS:
            return TOO_MUCH_WORK
    put_acceleration(p, d, x)
    return OK


def run_by_torque(p, d, x, w, h):
    """Advance by h with the torque on link 1 given. Returns a status."""
    if p[P_FIDELITY] == AVERAGED:
        status = run_driven_averaged(d, x, w, h)
    elif p[P_METHOD] == TIMESTEPPING:
        status = run_driven_timestepping(p, d, x, w, h)
    else:
        status = run_driven(p, d, x, w, h)
    x[X_INPUT_IMPULSE] = x[X_DRIVE_TORQUE] * h
    return status
