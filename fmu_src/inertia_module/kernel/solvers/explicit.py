"""Rigid output: links 1 and 2 and the output shaft, step by step of the embedded pair up to the next event.

Held, free or driving, all modes are stepped alike in (q, omega1, omega2); omega1 is known where its speed
is given.
"""

import math

from ..accumulate import add, wrap_drive_angle, wrap_input_angle
from ..codes import DRIVING, EXPLICIT, HELD, LINK2, NONE, OUTPUT
from ..contact import TORQUE_ROUNDING, is_held
from ..guards import guard, instant, is_guarded
from ..links import angular_momentum, response, torque_scale
from ..output_shaft import coast, meet, pass_while_held, stop, time_to_stop
from ..search import first_crossing, is_clear
from ..works import add_explicit_works, add_output_square
from .dormand_prince import END
from .explicit_stages import evaluate_stages, fit_inside, keep_stage
from .interpolant import dense_change, error_norm, integral, result

# phase of the highest harmonic within one step, rad
STEP_PHASE = 12.0
# the same where the inertia behind link 2 all but vanishes at an angle, or that of link 1 is light: the
# speeds
# have spikes there, which are not to be stepped over
CUSP_PHASE = 1.0
CUSP_RATIO = 1e-2
# phase between two looks at a guard, and that up to which the ends of a step tell whether one has fallen, rad
LOOK_PHASE = 1.0
QUIET_PHASE = 2.0
# a velocity below this fraction of the speeds that link 2 and the shaft take on is zero
VELOCITY_ROUNDING = 1e-14
SAFETY = 0.9
SMALLEST_FACTOR = 0.2
LARGEST_FACTOR = 5.0
REJECTIONS = 100


def has_cusp(d, w):
    """Whether the inertia behind link 2, or that of link 1 under its torque, is at some angle far below
    its largest.
    """
    if d.by_torque != 0.0 and d.J1 < CUSP_RATIO * d.F_by_alpha1:
        return True
    moving = d.k * d.k * d.mass
    offset = d.pole_offset
    far = offset + 2.0 * d.pole_arm
    least = d.J2 + d.k * d.k * d.J16 + w.carried + moving * offset * offset
    return least < CUSP_RATIO * moving * (far * far + d.spin)


def longest_step(d, x, w, remaining):
    """Longest step that can be searched for events: a bounded phase of the highest harmonic."""
    step = min(remaining, d.max_step)
    phase = CUSP_PHASE if has_cusp(d, w) else STEP_PHASE
    scale = d.harmonic * d.k
    slip = abs(x.omega1 - x.omega2)
    if d.by_torque == 0.0:
        slip = max(slip, abs(x.omega1 + w.given * step - x.omega2))
    if scale * slip * step > phase:
        step = phase / (scale * slip)
    # under its torque a drive at rest has no phase but what it is accelerated to
    growth = scale * abs(w.alpha1 - w.alpha2)
    if d.by_torque != 0.0 and 0.5 * growth * step * step > phase:
        step = math.sqrt(2.0 * phase / growth)
    return step


def step_error(d, w, fastest):
    """Estimated error of the step in hand over the allowed one."""
    if not fastest < 1e300:
        return 1e300
    tolerance = d.tolerance
    # load and drive torque may change the speeds more than the mechanism
    allowed2 = tolerance * max(response(d, d.J2 + w.carried) * fastest, abs(w.change2))
    if allowed2 == 0.0:
        return 0.0
    if d.by_torque != 0.0:
        allowed1 = tolerance * max(response(d, d.J1) * fastest, abs(w.change1))
        return error_norm(w, tolerance, allowed2, w.rate_omega1, allowed1)
    # alpha1 times the integral of P is work, to be compared with the energy at these speeds
    ramp = 0.0
    if w.given != 0.0:
        inertia = (d.F_by_alpha1 + 0.5 * d.F_by_speed) / d.k + d.J1 + d.J2
        ramp = tolerance * inertia * fastest * fastest / abs(w.given)
    return error_norm(w, tolerance, allowed2, w.integrand, ramp)


def try_steps(d, x, w, remaining):
    """Make the longest step whose error is allowed; the stages and changes are left in w, its length in
    w.step.

    The size for the next step is carried in the state, from one communication step to the next.

    Returns:
        Largest speed in the step, rad/s, or -1 if no step will do.
    """
    carried = x.step_size
    limit = longest_step(d, x, w, remaining)
    h = min(limit, carried) if carried > 0.0 else 0.1 * limit
    for attempt in range(REJECTIONS):
        w.step = h
        evaluate_stages(d, x, w)
        w.change1 = h * (result(w.rate_omega1) if d.by_torque != 0.0 else w.given)
        w.change2 = h * result(w.rate_omega2)
        ends = max(abs(x.omega1 + w.change1), abs(x.omega2 + w.change2))
        fastest = max(ends, max(abs(x.omega1), abs(x.omega2)))
        error = step_error(d, w, fastest)
        factor = LARGEST_FACTOR
        if not error < 1e300:
            factor = SMALLEST_FACTOR
        elif error > 0.0:
            factor = min(LARGEST_FACTOR, max(SMALLEST_FACTOR, SAFETY * error**-0.125))
        if error <= 1.0:
            # a step cut short by the end of the communication step says little about longer ones
            x.step_size = max(factor * h, carried) if attempt == 0 and h < carried else factor * h
            w.change_q = h * result(w.rate_q)
            return fastest
        h *= factor
    return -1.0


def zero_of(d, x, w, which, fastest, end2):
    """What a guard has to fall below to have fallen."""
    if is_held(x) or (which == OUTPUT and x.mode == DRIVING):
        rate_q = d.k * fastest if is_held(x) else 2.0 * d.k * fastest
        scale = torque_scale(d, fastest, w.alpha1, rate_q, w.given)
        return TORQUE_ROUNDING * (scale + abs(w.load))
    taken = max(abs(x.omega2), max(abs(end2), abs(x.omega3)))
    return VELOCITY_ROUNDING * max(response(d, d.J2 + w.carried) * fastest, taken)


def first_event(d, x, w, phase, fastest, begin, end2, end):
    """Earliest fall of a guard in the step just made.

    Args:
        phase: advance of the highest harmonic, rad. fastest: largest of the speeds, rad/s.
        begin, end: what guards.instant says at both ends. end2: omega2 at the end, rad/s.

    Returns:
        (fraction of the step or -1, which guard).
    """
    h = w.step
    earliest = -1.0
    which = NONE
    looks = 1 + int(math.floor(phase / LOOK_PHASE))
    inside = False
    for number in range(2):
        if not is_guarded(d, x, number):
            continue
        if phase <= QUIET_PHASE:
            value0, rate0 = guard(d, x, w, number, 0.0, x.omega2, begin[1], begin[2], begin[3], begin[4])
            value1, rate1 = guard(d, x, w, number, h, end2, end[1], end[2], end[3], end[4])
            if is_clear(value0, rate0, value1, rate1, h):
                continue
        if not inside:
            fit_inside(d, x, w)
            inside = True
        zero = zero_of(d, x, w, number, fastest, end2)
        sigma = first_crossing(d, x, w, number, zero, 0.0, 1.0, looks)
        if sigma > 0.0 and (earliest < 0.0 or sigma < earliest):
            earliest = sigma
            which = number
    return earliest, which


def commit(d, x, w, passed, sigma, which):
    """Take over the step or its part sigma, with its works; a velocity that met its limit is set there."""
    start1 = x.omega1
    start2 = x.omega2
    change_q = w.change_q
    change1 = w.change1
    change2 = w.change2
    if sigma >= 0.0:
        change_q = dense_change(w.dense_q, sigma)
        change2 = dense_change(w.dense_omega2, sigma)
        change1 = dense_change(w.dense_omega1, sigma) if d.by_torque != 0.0 else w.given * passed
    integrated = 0.0
    if d.by_torque != 0.0 or w.given != 0.0:
        integrated = integral(w, w.integrand, sigma)
    if x.mode == DRIVING:
        add_output_square(d, x, w, sigma)
    x.q, x.q_low = add(x.q, x.q_low, change_q)
    wrap_drive_angle(d, x)
    x.omega1, x.omega1_low = add(x.omega1, x.omega1_low, change1)
    turned1 = passed * (start1 + 0.5 * w.given * passed)
    if d.by_torque != 0.0:
        turned1 = integrated
        x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, turned1)
        wrap_input_angle(x)
    if is_held(x):
        pass_while_held(d, x, w.load, passed)
    else:
        x.omega2, x.omega2_low = add(x.omega2, x.omega2_low, change2)
        if which == LINK2 or (d.housing != 0.0 and x.omega2 < 0.0):
            x.omega2 = 0.0
            x.omega2_low = 0.0
        if x.mode == DRIVING:
            x.omega3 = x.omega2
            x.omega3_low = x.omega2_low
        else:
            coast(d, x, w.load, passed)
            meet(d, x, which)
    if which != NONE and d.by_torque == 0.0:
        w.momentum_end = angular_momentum(d, x.q, x.omega1, x.omega2)
        x.step_evaluations += 1.0
    add_explicit_works(d, x, w, start1, start2, passed, turned1, turned1 - change_q / d.k, integrated)


def advance_explicit(d, x, w, remaining):
    """Advance by one step, or to the first event in it.

    Returns:
        (time passed or -1 if no step is small enough, whether the contact mode may change then).
    """
    driving = x.mode == DRIVING
    w.solver = EXPLICIT
    w.carried = d.J3 if driving else 0.0
    w.carried_torque = w.load if driving else 0.0
    stopping = time_to_stop(d, x, w.load, remaining) if x.mode == HELD else -1.0
    if stopping >= 0.0:
        remaining = stopping
    begin = (w.alpha1, w.alpha2, w.jerk2, w.free, w.free_rate, w.momentum)
    if w.known == 0.0:
        begin = instant(d, x, w, x.q, x.omega1, x.omega2)
        w.momentum = begin[5]
    w.alpha1 = begin[0]
    w.alpha2 = begin[1]
    keep_stage(d, w, 0, x.omega1, x.omega2, begin[0], begin[1], begin[5])
    fastest = try_steps(d, x, w, remaining)
    if fastest < 0.0:
        return -1.0, False
    h = w.step
    slip = abs(x.omega1 - x.omega2)
    end1 = x.omega1 + w.change1
    end2 = x.omega2 + w.change2
    end = instant(d, x, w, x.q + w.change_q, end1, end2)
    keep_stage(d, w, END, end1, end2, end[0], end[1], end[5])
    phase = h * d.harmonic * d.k * max(slip, abs(end1 - end2))
    sigma, which = first_event(d, x, w, phase, fastest, begin, end2, end)
    passed = sigma * h if sigma >= 0.0 else h
    w.alpha1, w.alpha2, w.jerk2, w.free, w.free_rate, w.momentum_end = end
    w.known = 1.0 if which == NONE else 0.0
    commit(d, x, w, passed, sigma, which)
    w.momentum = w.momentum_end
    if stopping >= 0.0 and passed >= stopping and which == NONE:
        stop(x)
        return passed, True
    return passed, which != NONE
