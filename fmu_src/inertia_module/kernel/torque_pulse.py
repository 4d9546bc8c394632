"""The input torque is given: links 1 and 2 and the output shaft, step by step up to the next event.

Held, free or driving, all modes are stepped alike. The impulse of the input torque is the torque times
the time, its work the torque times the angle of link 1, so the energy audit measures the integration.
"""

import math

from .accumulate import add, assign, wrap_drive_angle, wrap_input_angle
from .contact import TORQUE_ROUNDING
from .dormand_prince import dense_change, error_norm, quadrature, result
from .events import LOOK_PHASE, QUIET_PHASE, VELOCITY_ROUNDING, first_crossing, is_clear
from .held import coast
from .pulse import (
    CUSP_PHASE,
    CUSP_RATIO,
    LARGEST_FACTOR,
    REJECTIONS,
    SAFETY,
    SEGMENT_STEPS,
    SMALLEST_FACTOR,
    STEP_PHASE,
    add_square,
    has_cusp,
    meet,
    response,
)
from .slots import *
from .torque_dynamics import driven_torque_scale
from .torque_guards import guard, instant, is_guarded
from .torque_stages import is_held, keep_stage, put_inside, torque_stages


def input_response(d):
    """How much of its own speed the mechanism can impart to link 1 and what it carries, 0 to 1."""
    own = d[D_ALPHA_SLOPE]
    return own / (own + d[D_J1]) if own > 0.0 else 1.0


def longest_step(d, x, w, remaining, motion):
    """Longest step that can be searched for events: a bounded phase of the highest harmonic.

    Args:
        motion: of instant, at the beginning: a drive at rest has no phase but what it is accelerated to.
    """
    step = min(remaining, d[D_MAX_STEP])
    light = d[D_J1] < CUSP_RATIO * d[D_ALPHA_SLOPE]
    phase = CUSP_PHASE if light or has_cusp(d, w) else STEP_PHASE
    scale = d[D_HARMONIC] * d[D_K]
    rate = scale * abs(x[X_OMEGA1] - x[X_OMEGA2])
    growth = scale * abs(motion[0] - motion[1])
    if rate * step > phase:
        step = phase / rate
    if 0.5 * growth * step * step > phase:
        step = math.sqrt(2.0 * phase / growth)
    return step


def try_steps(d, x, w, remaining, motion):
    """Make the longest step whose error is allowed; the stages are left in w, its length in W_STEP.

    Returns:
        Largest speed in the step, rad/s, or -1 if no step will do.
    """
    omega1 = x[X_OMEGA1]
    omega2 = x[X_OMEGA2]
    carried = x[X_STEP_SIZE]
    limit = longest_step(d, x, w, remaining, motion)
    share = response(d, w)
    share1 = input_response(d)
    tolerance = d[D_TOLERANCE]
    h = min(limit, carried) if carried > 0.0 else 0.1 * limit
    for attempt in range(REJECTIONS):
        w[W_STEP] = h
        torque_stages(d, x, w, motion[0], motion[1])
        x[X_STEP_EVALUATIONS] += 11.0
        change1 = h * result(w, W_RATE_OMEGA1)
        change2 = h * result(w, W_RATE_OMEGA2)
        ends = max(abs(omega1 + change1), abs(omega2 + change2))
        fastest = max(ends, max(abs(omega1), abs(omega2)))
        error = 0.0 if fastest < 1e300 else 1e300
        if 0.0 < fastest < 1e300:
            # a torque may change a speed more than the mechanism
            allowed1 = tolerance * max(share1 * fastest, abs(change1))
            allowed2 = tolerance * max(share * fastest, abs(change2))
            error = error_norm(w, tolerance, allowed2, W_RATE_OMEGA1, allowed1)
        factor = LARGEST_FACTOR
        if not error < 1e300:
            factor = SMALLEST_FACTOR
        elif error > 0.0:
            factor = min(LARGEST_FACTOR, max(SMALLEST_FACTOR, SAFETY * error**-0.125))
        if error <= 1.0:
            # a step cut short by the end of the communication step says little about longer ones
            x[X_STEP_SIZE] = max(factor * h, carried) if attempt == 0 and h < carried else factor * h
            return fastest
        h *= factor
    return -1.0


def zero_of(d, x, w, which, fastest, motion):
    """What a guard has to fall below to have fallen."""
    if is_held(x) or (which == OUTPUT and x[X_MODE] == DRIVING):
        rate_q = d[D_K] * fastest
        if not is_held(x):
            rate_q *= 2.0
        scale = driven_torque_scale(d, fastest, motion[0], rate_q, w[W_DRIVE_TORQUE])
        return TORQUE_ROUNDING * (scale + abs(w[W_LOAD]))
    taken = max(
        abs(x[X_OMEGA2]), max(abs(x[X_OMEGA2] + w[W_STEP] * result(w, W_RATE_OMEGA2)), abs(x[X_OMEGA3]))
    )
    return VELOCITY_ROUNDING * max(response(d, w) * fastest, taken)


def first_event(d, x, w, phase, fastest, motion, motion_end):
    """Earliest fall of a guard in the step just made: (fraction of it or -1, which guard)."""
    h = w[W_STEP]
    earliest = -1.0
    which = NONE
    looks = 1 + int(math.floor(phase / LOOK_PHASE))
    inside = False
    for number in range(2):
        if not is_guarded(d, x, number):
            continue
        if phase <= QUIET_PHASE:
            value0, rate0 = guard(d, x, w, number, 0.0, x[X_OMEGA2], motion)
            end2 = x[X_OMEGA2] + h * result(w, W_RATE_OMEGA2)
            value1, rate1 = guard(d, x, w, number, h, end2, motion_end)
            if is_clear(value0, rate0, value1, rate1, h):
                continue
        if not inside:
            put_inside(d, x, w)
            inside = True
        sigma = first_crossing(d, x, w, number, zero_of(d, x, w, number, fastest, motion), looks)
        if sigma > 0.0 and (earliest < 0.0 or sigma < earliest):
            earliest = sigma
            which = number
    return earliest, which


def commit(d, x, w, passed, sigma, which):
    """Take the step or its part sigma over, with its works; a velocity that met its limit is set there."""
    torque = w[W_DRIVE_TORQUE]
    load = w[W_LOAD]
    start2 = x[X_OMEGA2]
    change_q = w[W_STEP] * result(w, W_RATE_Q)
    change1 = w[W_STEP] * result(w, W_RATE_OMEGA1)
    change2 = w[W_STEP] * result(w, W_RATE_OMEGA2)
    if sigma >= 0.0:
        change_q = dense_change(w, W_DENSE_Q, sigma)
        change1 = dense_change(w, W_DENSE_OMEGA1, sigma)
        change2 = dense_change(w, W_DENSE_OMEGA2, sigma)
    turned1 = quadrature(w, W_MOMENTUM, sigma)
    if x[X_MODE] == DRIVING:
        add_square(d, x, w, sigma)
    add(x, X_Q, change_q)
    wrap_drive_angle(d, x)
    add(x, X_THETA1, turned1)
    wrap_input_angle(x)
    add(x, X_OMEGA1, change1)
    add(x, X_ENERGY_IN, torque * turned1)
    if x[X_MODE] == HELD_DRIVING:
        x[X_OUTPUT_IMPULSE] += load * passed
        x[X_OUTPUT_SQUARE] += load * load * passed
        x[X_TORQUE_PEAK] = max(x[X_TORQUE_PEAK], abs(load))
        return
    if x[X_MODE] == HELD:
        coast(d, x, load, passed)
        return
    add(x, X_OMEGA2, change2)
    if which == LINK2 or (d[D_HOUSING] != 0.0 and x[X_OMEGA2] < 0.0):
        assign(x, X_OMEGA2, 0.0)
    if x[X_MODE] == DRIVING:
        x[X_OUTPUT_IMPULSE] += d[D_J3] * (x[X_OMEGA2] - start2) + load * passed
        add(x, X_ENERGY_OUT, load * (turned1 - change_q / d[D_K]))
        x[X_OMEGA3] = x[X_OMEGA2]
        x[X_OMEGA3_LOW] = x[X_OMEGA2_LOW]
        return
    coast(d, x, load, passed)
    meet(d, x, which)


def one_step(d, x, w, remaining, motion):
    """One accepted step, shortened to the first event in it.

    Returns:
        (time passed or -1 if no step is small enough, guard that fell or NONE, motion at the end).
    """
    fastest = try_steps(d, x, w, remaining, motion)
    if fastest < 0.0:
        return -1.0, NONE, motion
    h = w[W_STEP]
    slip = abs(x[X_OMEGA1] - x[X_OMEGA2])
    end1 = x[X_OMEGA1] + h * result(w, W_RATE_OMEGA1)
    end2 = x[X_OMEGA2] + h * result(w, W_RATE_OMEGA2)
    motion_end = instant(d, x, w, x[X_Q] + h * result(w, W_RATE_Q), end1, end2)
    keep_stage(d, w, 8, end1, end2, motion_end[0], motion_end[1])
    phase = h * d[D_HARMONIC] * d[D_K] * max(slip, abs(end1 - end2))
    sigma, which = first_event(d, x, w, phase, fastest, motion, motion_end)
    passed = sigma * h if sigma >= 0.0 else h
    commit(d, x, w, passed, sigma, which)
    return passed, which, motion_end


def advance_driven(d, x, w, load, remaining):
    """Advance to the next event, the end of the time remaining, or SEGMENT_STEPS steps.

    Returns:
        (time passed or -1 if no step is small enough, whether the contact mode may change then).
    """
    driving = x[X_MODE] == DRIVING
    w[W_COLLOCATED] = DRIVEN_PULSE
    w[W_LOAD] = load
    w[W_SHAFT_INERTIA] = d[D_J3] if driving else 0.0
    w[W_SHAFT_TORQUE] = load if driving else 0.0
    stop = -1.0
    if x[X_MODE] == HELD and load > 0.0 and d[D_J3] * x[X_OMEGA3] < load * remaining:
        stop = d[D_J3] * x[X_OMEGA3] / load
        remaining = stop
    motion = instant(d, x, w, x[X_Q], x[X_OMEGA1], x[X_OMEGA2])
    time = 0.0
    which = NONE
    for _ in range(SEGMENT_STEPS):
        passed, which, motion = one_step(d, x, w, remaining - time, motion)
        if passed < 0.0:
            return -1.0, False
        done = passed >= remaining - time
        time = remaining if done else time + passed
        if done or which != NONE:
            break
    if stop >= 0.0 and time >= stop and which == NONE:
        assign(x, X_OMEGA3, 0.0)
        return time, True
    return time, which != NONE
