"""The one entry of the compiled kernel of the module: all its operations (see :mod:`.codes`)."""

from .accumulate import copy
from .codes import CHECK, OK, OUTPUTS, RATES, RIGID, START, STEP_TO_SWITCH, SWITCH, TUNE, WARN
from .derive import warnings
from .engine import follow_parameters, switch_now
from .links import fastest_own_rate
from .outputs import write_late_outputs, write_outputs
from .step import advance, check, start, tune

# rates of the outputs, from two short steps onwards from the present state, inputs going on as they do:
# a short step over the time in which the fastest of the motion turns by a radian
SHARE = 1e-4
# how often the short steps are cut down where a freewheel switches within them, and to what share
CUTS = 3
CUT = 0.01


def fastest_rate(d, x):
    """Angular frequency of the fastest motion there is, rad/s; 1 where nothing moves."""
    rate = d.harmonic * d.k * (abs(x.omega1) + abs(x.omega2))
    if d.elastic != 0.0:
        rate += fastest_own_rate(d, x)
    return rate if rate > 1.0 else 1.0


def go_on(u, x):
    """Inputs that go on from the end of the last step: no jump of the speed, the same slope and torques."""
    u.omega1 = x.omega1
    u.omega1_rate = x.alpha1
    u.omega1_rate_given = 1.0
    u.load_torque = x.load_torque
    u.load_torque_rate_given = 0.0
    u.drive_torque = x.drive_torque
    u.drive_torque_rate_given = 0.0


def write_rates(d, u, x, y, w):
    """Put the rate of each output in its place in y, one-sided towards later times, per second.

    A mean or peak holds for its step: its rate is 0. u and x are left as they become in between.
    Returns a status.
    """
    switch_now(d, x)
    if x.torques_continue == 0.0:
        follow_parameters(d, x)  # which may have changed since the last step
    write_outputs(x, y)
    write_late_outputs(d, x, y)
    h = SHARE / fastest_rate(d, x)
    copy(w.kept.numbers, x.numbers)
    copy(w.outputs_0.numbers, y.numbers)
    for cut in range(CUTS):
        if cut > 0:
            copy(x.numbers, w.kept.numbers)
            h *= CUT
        go_on(u, x)
        status = advance(d, u, x, y, w, h, RATES)
        copy(w.outputs_1.numbers, y.numbers)
        if status == OK:
            go_on(u, x)
            status = advance(d, u, x, y, w, h, RATES)
        if status != OK:
            return status
        if x.switches == w.kept.switches:
            break
    rated = len(w.outputs_0.numbers)
    for n in range(rated):
        begin = w.outputs_0.numbers[n]
        y.numbers[n] = ((w.outputs_1.numbers[n] - begin) * 4.0 - (y.numbers[n] - begin)) / (2.0 * h)
    for n in range(rated, len(y.numbers)):
        y.numbers[n] = 0.0
    # the angle may just have come around, and after many turns its difference is rounding
    y.output_angle = w.outputs_0.omega_out
    y.output_turns = 0.0
    y.output_flange_angle = w.outputs_0.omega_out
    y.input_flange_angle = w.outputs_0.input_speed
    return OK


def call(operation, p, d, u, x, y, w, h):
    """Carry out one of the operations START, STEP ... of :mod:`.codes`. Returns a status."""
    w.stops = 1.0 if operation == STEP_TO_SWITCH and p.fidelity >= RIGID else 0.0
    if operation == START:
        return start(p, d, u, x, y, w)
    if operation == CHECK:
        return check(p, d, u)
    if operation == WARN:
        return warnings(p)
    if operation == TUNE:
        return tune(p, d, x, w)
    if operation == OUTPUTS:
        write_late_outputs(d, x, y)
        return OK
    if operation == SWITCH:
        switch_now(d, x)
        write_outputs(x, y)
        return OK
    if operation == RATES:
        return write_rates(d, u, x, y, w)
    return advance(d, u, x, y, w, h, operation)
