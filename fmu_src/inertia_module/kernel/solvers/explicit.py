"""Rigid output: links 1 and 2 and the output shaft, step by step of the embedded pair up to the next event.

Held, free or driving, all modes are stepped alike in (q, omega1, omega2); omega1 is known where its speed
is given.
"""

import math

from ..accumulate import add, wrap_drive_angle, wrap_input_angle
from ..codes import DRIVING, EXPLICIT, HELD, LINK2, NONE
from ..contact import is_held
from ..guards import instant, is_guarded, keep_motion
from ..links import angular_momentum, response
from ..loads import INSIDE_PHASE, sample_load
from ..output_shaft import coast, meet, pass_while_held, stop, time_to_stop
from ..shaft import carried_by_link2
from ..works import add_explicit_works, add_output_square, add_viscous_losses
from .dormand_prince import END, NODES, sum_9
from .dormand_prince_5 import END as SHORT_END
from .explicit_events import QUIET_PHASE, advance_of_phase, first_event, is_quiet
from .explicit_stages import evaluate_short_stages, evaluate_stages, keep_stage
from .interpolant import dense_change, error_norm, integral, short_error_norm, step_mean
from .step_size import REJECTIONS, SAFETY, carry_size, first_size, next_factor

# stage inside the step at which the force on the bearing is seen
SEEN = 9
# phase of the highest harmonic within one step, rad
STEP_PHASE = 12.0
# the same where the inertia behind link 2 all but vanishes at an angle, or that of link 1 is light: the
# speeds have spikes there, which are not to be stepped over
CUSP_PHASE = 1.0
CUSP_RATIO = 1e-2
# share of the allowed error that a step of the pair of order 5 may have: there are many of them
SHORT_SHARE = 0.1
# how fast the longest step of the pair of order 5 is thought to grow while the other one is used
SHORT_GROWTH = 1.05


def has_cusp(d, w):
    """Tell whether the inertia behind link 2, or that of link 1 under its torque, is at some angle far below
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
        slip = max(slip, abs(x.omega1 + w.prescribed * step - x.omega2))
    if scale * slip * step > phase:
        step = phase / (scale * slip)
    # under its torque a drive at rest has no phase but what it is accelerated to
    growth = scale * abs(x.rate1 - x.rate2)
    if d.by_torque != 0.0 and 0.5 * growth * step * step > phase:
        step = math.sqrt(2.0 * phase / growth)
    return step


def set_changes(d, w):
    """Changes of q and of both speeds over the step in hand, from its stages."""
    w.change_q = w.step * step_mean(w, w.rate_q)
    w.change1 = w.step * (step_mean(w, w.rate_omega1) if d.by_torque != 0.0 else w.prescribed)
    w.change2 = w.step * step_mean(w, w.rate_omega2)


def step_error(d, x, w):
    """(estimated error of the step in hand over the allowed one, largest speed in it)."""
    ends = max(abs(x.omega1 + w.change1), abs(x.omega2 + w.change2))
    fastest = max(ends, max(abs(x.omega1), abs(x.omega2)))
    if not fastest < 1e300:
        return 1e300, fastest
    tolerance = d.tolerance
    # load and drive torque may change the speeds more than the mechanism
    allowed2 = tolerance * max(response(d, d.J2 + w.carried) * fastest, abs(w.change2))
    if allowed2 == 0.0:
        return 0.0, fastest
    others = w.integrand
    allowed = 0.0
    if d.by_torque != 0.0:
        others = w.rate_omega1
        allowed = tolerance * max(response(d, d.J1) * fastest, abs(w.change1))
    elif w.prescribed != 0.0:
        # alpha1 times the integral of P is work, to be compared with the energy at these speeds
        inertia = (d.F_by_alpha1 + 0.5 * d.F_by_speed) / d.k + d.J1 + d.J2
        allowed = tolerance * inertia * fastest * fastest / abs(w.prescribed)
    if w.short != 0.0:
        return short_error_norm(w, tolerance, allowed2, others, allowed), fastest
    return error_norm(w, tolerance, allowed2, others, allowed), fastest


def try_short_step(d, x, w, remaining, begin):
    """Make the step to the end of the time remaining by the pair of order 5, where that will do.

    It will where the error is allowed and the ends of the step tell that no guard falls within.

    Args:
        begin: what guards.instant says at the beginning.

    Returns:
        (whether it will do, what guards.instant says at the end).
    """
    w.short = 1.0
    w.step = remaining
    evaluate_short_stages(d, x, w)
    set_changes(d, w)
    end = end_of_step(d, x, w, SHORT_END)
    error, _ = step_error(d, x, w)
    error /= SHORT_SHARE
    x.short_size = next_factor(error, 5.0, SAFETY) * remaining
    if not error <= 1.0:
        return False, end
    if advance_of_phase(d, x, w) > QUIET_PHASE:
        return False, end
    for number in range(2):
        if is_guarded(d, x, number) and not is_quiet(d, x, w, number, begin, end):
            return False, end
    return True, end


def try_steps(d, x, w, limit):
    """Make the longest step whose error is allowed; the stages and changes are left in w, its length in
    w.step.

    The size for the next step is carried in the state, from one communication step to the next.

    Returns:
        Largest speed in the step, rad/s, or -1 if no step will do.
    """
    w.short = 0.0
    h = first_size(x, limit)
    for attempt in range(REJECTIONS):
        w.step = h
        evaluate_stages(d, x, w)
        set_changes(d, w)
        error, fastest = step_error(d, x, w)
        factor = next_factor(error, 8.0, SAFETY)
        if error <= 1.0:
            carry_size(x, h, factor, attempt)
            return fastest
        h *= factor
    return -1.0


def end_of_step(d, x, w, last):
    """Keep what guards.instant gives at the end of the step in hand as its last stage."""
    end1 = x.omega1 + w.change1
    end2 = x.omega2 + w.change2
    end = instant(d, x, w, x.q + w.change_q, end1, end2)
    keep_stage(d, w, last, end1, end2, end[0], end[1], end[5])
    return end


def see_inside(d, x, w, sigma):
    """See the bearing's force at a stage inside the step, or its part sigma, where the drive turns far."""
    inside = 0.0 <= sigma < NODES[SEEN]
    if w.short != 0.0 or inside or d.harmonic * abs(w.change_q) < INSIDE_PHASE:
        return
    omega1 = x.omega1 + NODES[SEEN] * w.step * w.prescribed
    if d.by_torque != 0.0:
        omega1 = w.integrand[SEEN]
    alpha1 = w.rate_omega1[SEEN]
    q = x.q + w.step * sum_9(w.rate_q)
    sample_load(d, x, q, omega1, omega1 - w.rate_q[SEEN] / d.k, alpha1, w.rate_omega2[SEEN])


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
        change1 = dense_change(w.dense_omega1, sigma) if d.by_torque != 0.0 else w.prescribed * passed
    see_inside(d, x, w, sigma)
    integrated = 0.0
    if d.by_torque != 0.0 or w.prescribed != 0.0:
        integrated = integral(w, w.integrand, sigma)
    if x.mode == DRIVING:
        add_output_square(d, x, w, sigma)
    if d.viscous != 0.0:
        add_viscous_losses(d, x, w, sigma)
    x.q, x.q_low = add(x.q, x.q_low, change_q)
    wrap_drive_angle(d, x)
    x.omega1, x.omega1_low = add(x.omega1, x.omega1_low, change1)
    turned1 = passed * (start1 + 0.5 * w.prescribed * passed)
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
    w.solver = EXPLICIT
    w.carried, w.carried_friction, w.carried_torque = carried_by_link2(d, x, w.load)
    stopping = time_to_stop(d, x, w.load, remaining) if x.mode == HELD else -1.0
    if stopping >= 0.0:
        remaining = stopping
    if x.rates_cached == 0.0:
        keep_motion(x, instant(d, x, w, x.q, x.omega1, x.omega2))
    begin = (x.rate1, x.rate2, x.jerk2, x.free, x.free_rate, x.momentum, x.motion_energy)
    keep_stage(d, w, 0, x.omega1, x.omega2, begin[0], begin[1], begin[5])
    sample_load(d, x, x.q, x.omega1, x.omega2, begin[0], begin[1])
    limit = longest_step(d, x, w, remaining)
    done = False
    end = begin
    sigma = -1.0
    which = NONE
    short = remaining <= x.short_size or x.short_size == 0.0
    if short and limit >= remaining and not has_cusp(d, w):
        done, end = try_short_step(d, x, w, remaining, begin)
    if not done:
        x.short_size *= SHORT_GROWTH  # so that it is tried again
        fastest = try_steps(d, x, w, limit)
        if fastest < 0.0:
            return -1.0, False
        end = end_of_step(d, x, w, END)
        sigma, which = first_event(d, x, w, fastest, begin, end)
    passed = sigma * w.step if sigma >= 0.0 else w.step
    w.momentum_end = end[5]
    commit(d, x, w, passed, sigma, which)
    keep_motion(x, end)
    if stopping >= 0.0 and passed >= stopping and which == NONE:
        stop(x)
        return passed, True
    return passed, which != NONE
