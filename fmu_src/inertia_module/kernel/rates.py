"""Rates of the outputs, from two short steps onwards from the present state, inputs going on as they do."""

from .elastic import hub_compliance, shaft_frequency
from .slots import *
from .step import advance

# a short step over the time in which the fastest of the motion turns by a radian
SHARE = 1e-4
# how often the short steps are cut down where a freewheel switches within them, and to what share
CUTS = 3
CUT = 0.01


def fastest_rate(p, d, x):
    """Angular frequency of the fastest motion there is, rad/s; 1 where nothing moves."""
    rate = d[D_HARMONIC] * d[D_K] * (abs(x[X_OMEGA1]) + abs(x[X_OMEGA2]))
    if p[P_FIDELITY] == ELASTIC:
        rate += shaft_frequency(d, hub_compliance(d, x, d[D_J2]))
    return rate if rate > 1.0 else 1.0


def go_on(u, x):
    """Inputs that go on from the end of the last step: no jump of the speed, the same slope and torques."""
    u[U_OMEGA1] = x[X_OMEGA1]
    u[U_OMEGA1_RATE] = x[X_ALPHA1]
    u[U_OMEGA1_RATE_GIVEN] = 1.0
    u[U_LOAD_TORQUE] = x[X_LOAD_TORQUE]
    u[U_LOAD_TORQUE_RATE_GIVEN] = 0.0
    u[U_DRIVE_TORQUE] = x[X_DRIVE_TORQUE]
    u[U_DRIVE_TORQUE_RATE_GIVEN] = 0.0


def copy(source, begin, target, to, size):
    """Copy some numbers from one array to another."""
    for n in range(size):
        target[to + n] = source[begin + n]


def write_rates(p, d, u, x, y, w):
    """Put the rate of each output in its place in y, one-sided towards later times, per second.

    A step mean holds for its step: its rate is 0. u and x are left as they become in between.
    Returns a status.
    """
    h = SHARE / fastest_rate(p, d, x)
    copy(x, 0, w, W_KEPT_STATE, X_SIZE)
    copy(y, 0, w, W_OUTPUTS_0, Y_SIZE)
    for cut in range(CUTS):
        if cut > 0:
            copy(w, W_KEPT_STATE, x, 0, X_SIZE)
            h *= CUT
        go_on(u, x)
        status = advance(p, d, u, x, y, w, h, RATES)
        copy(y, 0, w, W_OUTPUTS_1, Y_SIZE)
        if status == OK:
            go_on(u, x)
            status = advance(p, d, u, x, y, w, h, RATES)
        if status != OK:
            return status
        if x[X_SWITCHES] == w[W_KEPT_STATE + X_SWITCHES]:
            break
    for n in range(Y_SIZE):
        y[n] = ((w[W_OUTPUTS_1 + n] - w[W_OUTPUTS_0 + n]) * 4.0 - (y[n] - w[W_OUTPUTS_0 + n])) / (2.0 * h)
    y[Y_INPUT_TORQUE_MEAN] = 0.0
    y[Y_OUTPUT_TORQUE_MEAN] = 0.0
    return OK
