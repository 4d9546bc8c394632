"""Where in an explicit step a guard falls: told by its ends where it is short, else looked for inside."""

import math

from ..codes import DRIVING, NONE, OUTPUT
from ..contact import TORQUE_ROUNDING, is_held
from ..guards import fourth_bound_inside, guard, is_guarded
from ..links import response, torque_scale
from ..search import first_crossing, is_surely_positive
from .explicit_stages import fit_inside

# phase between two looks at a guard, and that up to which the ends of a step tell whether one has fallen, rad
LOOK_PHASE = 1.0
QUIET_PHASE = 2.0
# a velocity below this fraction of the speeds that link 2 and the shaft take on is zero
VELOCITY_ROUNDING = 1e-14


def advance_of_phase(d, x, w):
    """Advance of the highest harmonic in the step in hand, rad."""
    slip = abs(x.omega1 - x.omega2)
    end = abs(x.omega1 + w.change1 - x.omega2 - w.change2)
    return w.step * d.harmonic * d.k * max(slip, end)


def torque_bound(d, x, w, fastest):
    """Upper bound of the torques in the step in hand, N m."""
    rate_q = d.k * fastest if is_held(x) else 2.0 * d.k * fastest
    return torque_scale(d, fastest, x.rate1, rate_q, w.prescribed) + abs(w.load)


def is_quiet(d, x, w, which, begin, end):
    """Tell whether the ends of a short step tell that a guard does not fall within."""
    h = w.step
    value0, rate0 = guard(d, x, w, which, 0.0, x.omega2, begin[1], begin[2], begin[3], begin[4])
    value1, rate1 = guard(d, x, w, which, h, x.omega2 + w.change2, end[1], end[2], end[3], end[4])
    rate0 *= h
    rate1 *= h
    # the fourth derivative by the cubic's second and third, as of a harmonic that advances by this phase
    phase = advance_of_phase(d, x, w)
    third = abs(12.0 * (value0 - value1) + 6.0 * (rate0 + rate1))
    fourth_bound = phase * (third + phase * abs(rate1 - rate0))
    return is_surely_positive(max(value0, 0.0), rate0, value1, rate1, 1.0, fourth_bound)


def guard_tolerance(d, x, w, which, fastest):
    """Threshold below which a guard counts as crossed."""
    if is_held(x) or (which == OUTPUT and x.mode == DRIVING):
        return TORQUE_ROUNDING * torque_bound(d, x, w, fastest)
    fastest_output = max(abs(x.omega2), max(abs(x.omega2 + w.change2), abs(x.omega3)))
    return VELOCITY_ROUNDING * max(response(d, d.J2 + w.carried) * fastest, fastest_output)


def first_event(d, x, w, fastest, begin, end):
    """Earliest fall of a guard in the step just made.

    Args:
        fastest: largest of the speeds, rad/s. begin, end: what guards.instant says at both ends.

    Returns:
        (fraction of the step or -1, which guard).
    """
    earliest = -1.0
    which = NONE
    phase = advance_of_phase(d, x, w)
    looks = 1 + int(math.floor(phase / LOOK_PHASE))
    scale = torque_bound(d, x, w, fastest)
    inside = False
    for number in range(2):
        if not is_guarded(d, x, number):
            continue
        if phase <= QUIET_PHASE and is_quiet(d, x, w, number, begin, end):
            continue
        if not inside:
            fit_inside(d, x, w)
            inside = True
        fourth_bound = fourth_bound_inside(d, x, w, number, scale, phase)
        sigma = first_crossing(
            d, x, w, number, guard_tolerance(d, x, w, number, fastest), fourth_bound, looks
        )
        if sigma > 0.0 and (earliest < 0.0 or sigma < earliest):
            earliest = sigma
            which = number
    return earliest, which
