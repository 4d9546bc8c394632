"""Fidelity `elastic`: both links, hub, shaft and driven mass from event to event by Radau collocation.

The method is L-stable: oscillations of the shaft that are too fast to matter are damped out within a
step, all others are followed (:mod:`.followed`).
"""

import math

from ..accumulate import add, wrap_drive_angle, wrap_input_angle
from ..codes import COLLOCATED, DRIVING, FREE, HELD, HELD_DRIVING, LINK2, NONE, OUTPUT
from ..contact import TORQUE_ROUNDING, is_held
from ..guards import fourth_bound_inside
from ..links import accelerations, angular_momentum, inertia_at_output, response, torque_scale
from ..loads import INSIDE_PHASE, sample_load
from ..search import find_crossing, first_crossing, is_surely_positive
from ..shaft import carried_by_link2, hub_rate, relative_rate, shaft_torque
from ..works import (
    add_held_works,
    add_link_losses,
    add_moving_works,
    add_shaft_works,
    add_work_in,
    inertia_integral,
)
from .collocated_guards import collocated_guard, fit_polynomials, land
from .collocation import change
from .elastic_error import embedded_tolerance, fastest_speed, step_error
from .elastic_stages import guess_rates, solve_stages
from .followed import hub_compliance, is_slow, shaft_frequency, swing_of_load, widest_rate
from .step_size import REJECTIONS, SAFETY, carry_size, first_size, next_factor

# stage inside the step at which the force on the bearing is seen
SEEN = 2
# phase of the highest harmonic within one step, rad
STEP_PHASE = 2.0
# phase between two looks at a guard, rad
LOOK_PHASE = 0.7
MOST_LOOKS = 12
# a twisted shaft at rest: speeds are measured by this share of what its energy could drive
TWIST_SHARE = 1e-3
# error of the inside of a step, as a fraction of the one allowed to the embedded formula
INSIDE = 0.01
# a velocity below this fraction of the fastest one is zero
VELOCITY_ROUNDING = 1e-13
# a torque below this fraction of its scale is zero: more than where the mode is chosen, so that it sees it
CROSSING = 100.0 * TORQUE_ROUNDING


def start_rates(d, x, w):
    """(alpha1, omega2', omega3', rate of omega3 - omega4) at the beginning, and the inertia behind link 2."""
    torque = shaft_torque(d, x)
    held = is_held(x)
    x.step_evaluations += 1.0
    carried, friction, behind = carried_by_link2(d, x, torque)
    rate1, rate2, _ = accelerations(d, x.q, x.omega1, x.omega2, w.prescribed, held, carried, friction, behind)
    guess_rates(w, rate1, rate2)
    w.alpha1 = rate1
    sample_load(d, x, x.q, x.omega1, x.omega2, rate1, rate2)
    rate3 = hub_rate(d, x, torque, rate2)
    rates = (rate1, rate2, rate3, relative_rate(d, x, w.load, torque, rate3))
    return rates, 0.0 if held else inertia_at_output(d, x.q)


def highest_rate(d, x, w, remaining):
    """Fastest rate of the highest harmonic of the pulses from now on, rad/s."""
    horizon = remaining
    if d.by_torque != 0.0:
        # what its torque makes of link 1 counts for the pulses of one step
        growth = d.harmonic * d.k * abs(w.alpha1)
        if 0.5 * growth * remaining * remaining > STEP_PHASE:
            horizon = math.sqrt(2.0 * STEP_PHASE / growth)
    end1 = x.omega1 + w.alpha1 * horizon
    slip = max(abs(x.omega1 - x.omega2), abs(end1 - x.omega2))
    return d.harmonic * d.k * slip


def try_steps(d, x, w, remaining, fastest):
    """Make the longest step whose error is allowed; its stages are left in w.

    Returns:
        (whether there is one, whether the shaft's own motion is followed, rate of the fastest phase).
    """
    rates, inertia2 = start_rates(d, x, w)
    compliance = hub_compliance(d, x, inertia2)
    pulse_rate = highest_rate(d, x, w, remaining)
    widest = max(pulse_rate, widest_rate(d, fastest))
    fastest = max(fastest, TWIST_SHARE * shaft_frequency(d, compliance) * abs(x.twist))
    swing = swing_of_load(d, x, compliance, widest, fastest, rates[3])
    followed = swing > 0.0 or is_slow(d, compliance, widest)
    limit = min(remaining, d.max_step)
    if pulse_rate * limit > STEP_PHASE:  # else its guards cannot be searched
        limit = STEP_PHASE / pulse_rate
    h = first_size(x, limit)
    for attempt in range(REJECTIONS):
        if solve_stages(d, x, w, h):
            error = step_error(d, x, w, rates, compliance, followed, swing, fastest)
            factor = next_factor(error, 6.0, SAFETY)
            if error <= 1.0:
                carry_size(x, h, factor, attempt)
                rate = max(pulse_rate, shaft_frequency(d, compliance)) if followed else pulse_rate
                return True, followed, rate
            h *= factor
        else:
            h *= 0.5
    return False, False, 0.0


def rounding_of(x, which):
    """Share of its scale below which a guard is zero: of a velocity or of a torque."""
    mode = x.mode
    if (mode == FREE) or (mode == DRIVING and which == LINK2) or (mode == HELD and which == OUTPUT):
        return VELOCITY_ROUNDING
    return CROSSING


def guard_tolerance(d, x, w, which, fastest):
    """Threshold below which a guard counts as crossed: velocities by what link 2 and the hub take on."""
    mode = x.mode
    if rounding_of(x, which) == VELOCITY_ROUNDING:
        fastest_output = max(abs(x.omega2), abs(x.omega3))
        share = response(d, d.J2 + (d.J3 if mode == DRIVING else 0.0)) if d.F_by_alpha1 > 0.0 else 0.0
        return VELOCITY_ROUNDING * max(fastest_output, fastest * share)
    torque = shaft_torque(d, x)
    if which == OUTPUT and mode == HELD_DRIVING:
        # the shaft alone presses the hub on link 2: by what it swings with behind it
        return CROSSING * (abs(torque) + abs(x.relative) * math.sqrt(d.stiffness * d.J4))
    scale = torque_scale(d, x.omega1, w.alpha1, 2.0 * d.k * fastest, 0.0)
    if d.by_torque != 0.0:
        scale += abs(w.prescribed)
    return CROSSING * (scale + abs(torque) + abs(w.load))


def is_clear(d, x, w, which, followed, fourth_bound):
    """Tell whether a guard stays positive in the step, by its ends (its end if stiffness is damped out)."""
    value1, rate1 = collocated_guard(d, x, w, which, 1.0)
    if value1 < 0.0:
        return False
    if not followed and x.mode != HELD and x.mode != FREE:
        return True
    value0, rate0 = collocated_guard(d, x, w, which, 0.0)
    return is_surely_positive(value0, rate0, value1, rate1, 1.0, fourth_bound)


def first_event(d, x, w, rate, followed, fastest, cleared):
    """Earliest fall of a guard, but of the one cleared, in the step in hand: (fraction or -1, which)."""
    fit_polynomials(d, x, w)
    earliest = -1.0
    which = NONE
    looks = min(MOST_LOOKS, 1 + int(math.floor(rate * w.step / LOOK_PHASE)))
    for guard in range(2):
        if guard == cleared or (d.housing if guard == LINK2 else d.output) == 0.0:
            continue
        zero = guard_tolerance(d, x, w, guard, fastest)
        fourth_bound = fourth_bound_inside(d, x, w, guard, zero / CROSSING)
        if looks == 1 and is_clear(d, x, w, guard, followed, fourth_bound):
            continue
        # the inside of a step is less accurate than its end: a dip that is shallower than its error is none
        shallow = 1.0 + INSIDE * embedded_tolerance(d.tolerance) / rounding_of(x, guard)
        sigma = first_crossing(d, x, w, guard, zero * shallow, fourth_bound, looks)
        value, slope = collocated_guard(d, x, w, guard, 1.0)
        if sigma < 0.0 and value < -zero:
            sigma = find_crossing(d, x, w, guard, zero, 0.0, 1.0, value, slope)
        if sigma > 0.0 and (earliest < 0.0 or sigma < earliest):
            earliest = sigma
            which = guard
    return earliest, which


def end_at_event(d, x, w, rate, followed, fastest):
    """Let the step end at the first event in it, if any. Returns the guard that falls there, or NONE."""
    cleared = NONE
    for _ in range(2):
        sigma, which = first_event(d, x, w, rate, followed, fastest, cleared)
        if sigma < 0.0:
            return NONE
        if land(d, x, w, which, guard_tolerance(d, x, w, which, fastest), sigma):
            return which
        cleared = which  # a crossing of the polynomial alone: what of the other guard?
    return NONE


def commit(d, x, w, which, turned1):
    """Take the end of the step over; where a velocity has met its limit it is set there."""
    mode = x.mode
    x.twist, x.twist_low = add(x.twist, x.twist_low, change(w, w.stage_relative))
    x.relative, x.relative_low = add(x.relative, x.relative_low, change(w, w.rate_relative))
    x.q, x.q_low = add(x.q, x.q_low, d.k * (turned1 - change(w, w.stage_omega2)))
    wrap_drive_angle(d, x)
    x.omega1, x.omega1_low = add(x.omega1, x.omega1_low, change(w, w.rate1))
    x.omega2, x.omega2_low = add(x.omega2, x.omega2_low, change(w, w.rate2))
    x.omega3, x.omega3_low = add(x.omega3, x.omega3_low, change(w, w.rate3))
    if d.housing != 0.0 and not is_held(x) and (which == LINK2 or x.omega2 < 0.0):
        x.omega2 = 0.0
        x.omega2_low = 0.0
    if mode == DRIVING:
        x.omega3 = x.omega2
        x.omega3_low = x.omega2_low
    elif mode != HELD_DRIVING and (which == OUTPUT or x.omega3 < x.omega2):
        if d.housing != 0.0 and (mode == HELD or x.omega3 < 0.0):
            x.omega3 = 0.0
            x.omega3_low = 0.0
        x.omega2 = x.omega3
        x.omega2_low = x.omega3_low


def see_stage(d, x, w, n):
    """See the bearing's force at a stage of the step."""
    sample_load(d, x, w.stage_q[n], w.stage_omega1[n], w.stage_omega2[n], w.rate1[n], w.rate2[n])


def advance_elastic(d, x, w, remaining):
    """Advance by one step, or to the first event in it.

    Returns:
        (time passed or -1 if no step is small enough, whether the contact mode may change then).
    """
    w.solver = COLLOCATED
    fastest = fastest_speed(x)
    found, followed, rate = try_steps(d, x, w, remaining, fastest)
    if not found:
        return -1.0, False
    which = end_at_event(d, x, w, rate, followed, fastest)
    if rate * w.step > INSIDE_PHASE:
        see_stage(d, x, w, SEEN)
    h = w.step
    q = x.q
    start1 = x.omega1
    momentum = angular_momentum(d, q, start1, x.omega2) if d.by_torque == 0.0 else 0.0
    add_shaft_works(d, x, w)
    turned1 = h * (start1 + 0.5 * w.prescribed * h)
    if d.by_torque != 0.0:
        turned1 = change(w, w.stage_omega1)
    commit(d, x, w, which, turned1)
    if d.by_torque != 0.0:
        x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, turned1)
        wrap_input_angle(x)
        add_work_in(x, w.prescribed * turned1)
        add_link_losses(d, x, w)
    elif is_held(x):
        phi = inertia_integral(d, x, q, start1, w.prescribed, 0.0, h) if w.prescribed != 0.0 else 0.0
        add_held_works(d, x, q, start1, w.prescribed, h, phi)
    else:
        add_moving_works(d, x, w, start1, momentum)
        add_link_losses(d, x, w)
    return h, which != NONE
