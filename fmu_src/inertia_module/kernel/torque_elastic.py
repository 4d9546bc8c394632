"""Fidelity `elastic` where the input torque is given: link 1 is in the collocation of :mod:`.elastic`."""

from .accumulate import add, wrap_input_angle
from .elastic import commit, end_at_event, fastest_speed, try_steps
from .elastic_stages import change
from .elastic_works import add_shaft_works
from .slots import *


def advance_driven_elastic(d, x, w, load, remaining):
    """Advance by one step, or to the first event in it.

    Returns:
        (time passed or -1 if no step is small enough, whether the contact mode may change then).
    """
    w[W_OMEGA1] = x[X_OMEGA1]
    w[W_ALPHA1] = 0.0
    w[W_LOAD] = load
    w[W_COLLOCATED] = DRIVEN_COLLOCATED
    fastest = fastest_speed(x, w)
    found, followed, rate = try_steps(d, x, w, remaining, fastest)
    if not found:
        return -1.0, False
    which = end_at_event(d, x, w, rate, followed, fastest)
    h = w[W_STEP]
    add_shaft_works(d, x, w, load)
    turned1 = change(d, w, W_STAGE_OMEGA1)
    commit(d, x, w, which)
    add(x, X_OMEGA1, change(d, w, W_RATE1))
    add(x, X_THETA1, turned1)
    wrap_input_angle(x)
    add(x, X_ENERGY_IN, w[W_DRIVE_TORQUE] * turned1)
    return h, which != NONE
