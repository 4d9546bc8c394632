"""Fidelity `elastic`: link 2, hub, shaft and driven mass from event to event by Radau collocation.

The method is L-stable: oscillations of the shaft that are too fast to matter are damped out within a
step, all others are followed. An oscillation of rate Omega holds about (pulse rate / Omega)^2 of the
energy of a pulse, so one is followed up to Omega = pulse rate / sqrt(tolerance).
"""

import math

from .accumulate import add, assign, wrap_drive_angle
from .collocated_guards import collocated_guard, land, put_polynomials
from .collocation import embedded_error
from .contact import TORQUE_ROUNDING
from .dynamics import angular_momentum, free_torque, torque_scale
from .elastic_stages import change, solve_stages
from .elastic_works import add_held_works, add_moving_works, add_shaft_works
from .events import find_crossing, first_crossing
from .guards import stays_positive
from .inertia import reduced_inertia
from .radau_table import GAMMA, STAGES
from .shaft import damp_error, relative_rate, shaft_torque
from .slots import *
from .torque_elastic_stages import driven_horizon, put_driven_start

# phase of the highest harmonic within one step, rad
STEP_PHASE = 2.0
# phase between two looks at a guard, rad
LOOK_PHASE = 0.7
MOST_LOOKS = 12
REJECTIONS = 100
SAFETY = 0.9
SMALLEST_FACTOR = 0.2
LARGEST_FACTOR = 5.0
# a twisted shaft at rest: speeds are measured by this share of what its energy could drive
TWIST_SHARE = 1e-3
# error of the inside of a step, as a fraction of the one allowed to the embedded formula
INSIDE = 0.01
# a velocity below this fraction of the fastest one is zero
VELOCITY_ROUNDING = 1e-13
# a torque below this fraction of its scale is zero: more than where the mode is chosen, so that it sees it
CROSSING = 100.0 * TORQUE_ROUNDING


def embedded_tolerance(tolerance):
    """Tolerance for the embedded formula of order 5 that leaves the method of order 9 this one (Hairer)."""
    return 0.1 * tolerance**0.6


def fastest_speed(x, w):
    """Largest of all speeds at the beginning of the step, rad/s."""
    omega3 = x[X_OMEGA3]
    shaft = max(abs(omega3), abs(omega3 - x[X_RELATIVE]))
    return max(max(abs(w[W_OMEGA1]), abs(x[X_OMEGA2])), shaft)


def fastest_at_end(w):
    """Largest of all speeds at the end of the step in hand, rad/s."""
    last = STAGES - 1
    omega3 = w[W_STAGE_OMEGA3 + last]
    shaft = max(abs(omega3), abs(omega3 - w[W_STAGE_RELATIVE + last]))
    drive = abs(w[W_OMEGA1] + w[W_ALPHA1] * w[W_STEP])
    return max(max(drive, abs(w[W_STAGE_OMEGA2 + last])), shaft)


def hub_compliance(d, x, inertia2):
    """1/J of what the shaft torque accelerates: the hub, link 2 with it, or nothing."""
    mode = x[X_MODE]
    if mode == HELD_DRIVING:
        return 0.0
    return 1.0 / (d[D_J3] + inertia2) if mode == DRIVING else 1.0 / d[D_J3]


def shaft_frequency(d, compliance):
    """Angular frequency of the shaft between hub and driven mass, without damping, rad/s."""
    return math.sqrt(d[D_STIFFNESS] * (compliance + 1.0 / d[D_J4]))


def slowest_rate(d, compliance):
    """Modulus of the slowest eigenvalue of the shaft, rad/s: a damped one may be slow though stiff."""
    mobility = compliance + 1.0 / d[D_J4]
    half = 0.5 * d[D_DAMPING] * mobility
    square = d[D_STIFFNESS] * mobility
    if half * half <= square:
        return math.sqrt(square)
    return square / (half + math.sqrt(half * half - square))


def is_followed(d, compliance, pulse_rate):
    """Whether the shaft's own motion is resolved, not damped out."""
    return slowest_rate(d, compliance) ** 2 <= d[D_FOLLOWED] * pulse_rate * pulse_rate


def is_stiff(d, x, omega1):
    """Whether the shaft is too stiff for its own motion to be followed, omega1 jumping to this value."""
    k = d[D_K]
    _, _, _, _, _, g, _, _ = reduced_inertia(d, x[X_Q])
    compliance = 1.0 / (d[D_J3] + d[D_J2] + k * k * g)
    omega3 = x[X_OMEGA3]
    speeds = max(max(abs(x[X_OMEGA1]), abs(omega1)), max(abs(omega3), abs(omega3 - x[X_RELATIVE])))
    return not is_followed(d, compliance, widest_rate(d, x, speeds, compliance))


def widest_rate(d, x, fastest, compliance):
    """Rate of the pulses if their slip were the fastest speed around, rad/s."""
    return d[D_HARMONIC] * d[D_K] * max(fastest, abs(x[X_TWIST]) * shaft_frequency(d, compliance))


def step_error(d, x, w, start, compliance, followed, fastest):
    """Estimated error of the step in hand over the allowed one.

    Args:
        start: (alpha1, omega2', omega3', rate of omega3 - omega4) at the beginning.
    """
    h = w[W_STEP]
    driven = w[W_COLLOCATED] == DRIVEN_COLLOCATED
    static = TWIST_SHARE * shaft_frequency(d, compliance) * abs(x[X_TWIST])
    fastest = max(max(fastest, static), fastest_at_end(w))
    rate1, rate2, rate3, rate_relative = start
    own = d[D_ALPHA_SLOPE]
    error_q = d[D_K] * h * embedded_error(x[X_OMEGA2], w, W_STAGE_OMEGA2)
    if driven:
        error_q -= d[D_K] * h * embedded_error(x[X_OMEGA1], w, W_STAGE_OMEGA1)
    error2 = h * embedded_error(rate2, w, W_RATE2)
    error3 = h * embedded_error(rate3, w, W_RATE3)
    relative = h * embedded_error(rate_relative, w, W_RATE_RELATIVE)
    twist = h * embedded_error(x[X_RELATIVE], w, W_STAGE_RELATIVE)
    twist, error3, relative = damp_error(d, GAMMA * h, compliance, twist, error3, relative)
    hub = 1.0 / compliance if compliance > 0.0 else 0.0
    common = error3 - relative if hub == 0.0 else error3 - relative * d[D_J4] / (hub + d[D_J4])
    share = own / (own + d[D_J2] + d[D_J3] + d[D_J4]) if own > 0.0 else 1.0
    moved = abs(change(d, w, W_RATE3))
    error = abs(error_q)
    if fastest > 0.0:
        error = max(error, abs(common) / max(share * fastest, moved))
        if x[X_MODE] == FREE:
            share = own / (own + d[D_J2]) if own > 0.0 else 1.0
            error = max(error, abs(error2) / max(share * fastest, abs(change(d, w, W_RATE2))))
    if driven and fastest > 0.0:
        share = own / (own + d[D_J1])
        error1 = h * embedded_error(rate1, w, W_RATE1)
        error = max(error, abs(error1) / max(share * fastest, abs(change(d, w, W_RATE1))))
    if followed and fastest > 0.0:
        speed = max(abs(relative), shaft_frequency(d, compliance) * abs(twist))
        share = own / (own + d[D_J2] + d[D_J3]) if own > 0.0 else 1.0
        allowed = max(share * fastest, moved)
        error = max(error, speed / allowed)
    return error / embedded_tolerance(d[D_TOLERANCE])


def start_rates(d, x, w):
    """(alpha1, omega2', omega3', rate of omega3 - omega4) at the beginning, and the inertia behind link 2."""
    mode = x[X_MODE]
    torque = shaft_torque(d, x)
    driving = mode == DRIVING
    rate2 = 0.0
    inertia2 = 0.0
    if w[W_COLLOCATED] == DRIVEN_COLLOCATED:
        w[W_ALPHA1], rate2, inertia2 = put_driven_start(d, x, w, torque)
    elif driving or mode == FREE:
        k = d[D_K]
        _, i1, _, b, _, g, g1, _ = reduced_inertia(d, x[X_Q])
        x[X_STEP_EVALUATIONS] += 1.0
        inertia2 = d[D_J2] + k * k * g
        rate_q = k * (w[W_OMEGA1] - x[X_OMEGA2])
        free = free_torque(d, w[W_OMEGA1], w[W_ALPHA1], rate_q, i1, b, g, g1)
        rate2 = (free - torque) / (inertia2 + d[D_J3]) if driving else free / inertia2
    rate3 = rate2 if driving else (0.0 if mode == HELD_DRIVING else -torque / d[D_J3])
    return (w[W_ALPHA1], rate2, rate3, relative_rate(d, x, w[W_LOAD], torque, rate3)), inertia2


def longest_step(d, remaining, pulse_rate):
    """Longest step whose guards can be searched."""
    step = min(remaining, d[D_MAX_STEP])
    return STEP_PHASE / pulse_rate if pulse_rate * step > STEP_PHASE else step


def highest_rate(d, x, w, remaining):
    """Fastest rate of the highest harmonic of the pulses from now on, rad/s."""
    end1 = w[W_OMEGA1] + w[W_ALPHA1] * remaining
    slip = max(abs(w[W_OMEGA1] - x[X_OMEGA2]), abs(end1 - x[X_OMEGA2]))
    return d[D_HARMONIC] * d[D_K] * slip


def try_steps(d, x, w, remaining, fastest):
    """Make the longest step whose error is allowed; its stages are left in w.

    Returns:
        (whether there is one, whether the shaft's own motion is followed, rate of the fastest phase).
    """
    start, inertia2 = start_rates(d, x, w)
    compliance = hub_compliance(d, x, inertia2)
    horizon = remaining
    if w[W_COLLOCATED] == DRIVEN_COLLOCATED:
        horizon = driven_horizon(d, w, remaining, STEP_PHASE)
    pulse_rate = highest_rate(d, x, w, horizon)
    followed = is_followed(d, compliance, max(pulse_rate, widest_rate(d, x, fastest, compliance)))
    limit = longest_step(d, remaining, pulse_rate)
    carried = x[X_STEP_SIZE]
    h = min(limit, carried) if carried > 0.0 else 0.1 * limit
    for attempt in range(REJECTIONS):
        if solve_stages(d, x, w, h):
            error = step_error(d, x, w, start, compliance, followed, fastest)
            factor = LARGEST_FACTOR
            if not error < 1e300:
                factor = SMALLEST_FACTOR
            elif error > 0.0:
                factor = min(LARGEST_FACTOR, max(SMALLEST_FACTOR, SAFETY * error ** (-1.0 / 6.0)))
            if error <= 1.0:
                # a step cut short by the end of the communication step says little about longer ones
                x[X_STEP_SIZE] = max(factor * h, carried) if attempt == 0 and h < carried else factor * h
                rate = max(pulse_rate, shaft_frequency(d, compliance)) if followed else pulse_rate
                return True, followed, rate
            h *= factor
        else:
            h *= 0.5
    return False, False, 0.0


def zero_of(d, x, w, which, fastest):
    """What a guard has to fall below to have fallen: velocities by what link 2 and the hub take on."""
    mode = x[X_MODE]
    if (mode == FREE) or (mode == DRIVING and which == LINK2) or (mode == HELD and which == OUTPUT):
        carried = d[D_J2] + (d[D_J3] if mode == DRIVING else 0.0)
        own = d[D_ALPHA_SLOPE]
        taken = max(abs(x[X_OMEGA2]), abs(x[X_OMEGA3]))
        return VELOCITY_ROUNDING * max(taken, fastest * own / (own + carried) if own > 0.0 else 0.0)
    torque = shaft_torque(d, x)
    scale = torque_scale(d, w[W_OMEGA1], w[W_ALPHA1], 2.0 * d[D_K] * fastest)
    return CROSSING * (scale + abs(torque) + abs(w[W_LOAD]) + abs(w[W_DRIVE_TORQUE]))


def is_clear(d, x, w, which, followed):
    """Whether a guard stays positive in the step, by its ends (its end alone if stiffness is damped out)."""
    value1, rate1 = collocated_guard(d, x, w, which, 1.0)
    if value1 < 0.0:
        return False
    if not followed and x[X_MODE] != HELD and x[X_MODE] != FREE:
        return True
    value0, rate0 = collocated_guard(d, x, w, which, 0.0)
    return value0 >= 0.0 and stays_positive(value0, rate0, value1, rate1, 1.0)


def first_event(d, x, w, rate, followed, fastest, cleared):
    """Earliest fall of a guard, but of the one cleared, in the step in hand: (fraction or -1, which)."""
    put_polynomials(d, x, w)
    earliest = -1.0
    which = NONE
    # the inside of a step is less accurate than its end: a dip that is shallower than its error is none
    shallow = 1.0 + INSIDE * embedded_tolerance(d[D_TOLERANCE]) / VELOCITY_ROUNDING
    looks = min(MOST_LOOKS, 1 + int(math.floor(rate * w[W_STEP] / LOOK_PHASE)))
    for guard in range(2):
        if guard == cleared or d[D_HOUSING if guard == LINK2 else D_OUTPUT] == 0.0:
            continue
        if looks == 1 and is_clear(d, x, w, guard, followed):
            continue
        zero = zero_of(d, x, w, guard, fastest)
        sigma = first_crossing(d, x, w, guard, zero * shallow, looks)
        if sigma < 0.0 and collocated_guard(d, x, w, guard, 1.0)[0] < -zero:
            sigma = find_crossing(d, x, w, guard, zero, 0.0, 1.0)
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
        if land(d, x, w, which, zero_of(d, x, w, which, fastest), sigma):
            return which
        cleared = which  # a crossing of the polynomial alone: what of the other guard?
    return NONE


def commit(d, x, w, which):
    """Take the end of the step over; where a velocity has met its limit it is set there."""
    mode = x[X_MODE]
    h = w[W_STEP]
    omega1 = w[W_OMEGA1] + 0.5 * w[W_ALPHA1] * h
    add(x, X_TWIST, change(d, w, W_STAGE_RELATIVE))
    add(x, X_RELATIVE, change(d, w, W_RATE_RELATIVE))
    turned1 = h * omega1
    if w[W_COLLOCATED] == DRIVEN_COLLOCATED:
        turned1 = change(d, w, W_STAGE_OMEGA1)
    add(x, X_Q, d[D_K] * (turned1 - change(d, w, W_STAGE_OMEGA2)))
    wrap_drive_angle(d, x)
    add(x, X_OMEGA2, change(d, w, W_RATE2))
    add(x, X_OMEGA3, change(d, w, W_RATE3))
    held = mode == HELD or mode == HELD_DRIVING
    if d[D_HOUSING] != 0.0 and not held and (which == LINK2 or x[X_OMEGA2] < 0.0):
        assign(x, X_OMEGA2, 0.0)
    if mode == DRIVING:
        x[X_OMEGA3] = x[X_OMEGA2]
        x[X_OMEGA3_LOW] = x[X_OMEGA2_LOW]
    elif mode != HELD_DRIVING and (which == OUTPUT or x[X_OMEGA3] < x[X_OMEGA2]):
        if d[D_HOUSING] != 0.0 and (mode == HELD or x[X_OMEGA3] < 0.0):
            assign(x, X_OMEGA3, 0.0)
        x[X_OMEGA2] = x[X_OMEGA3]
        x[X_OMEGA2_LOW] = x[X_OMEGA3_LOW]


def advance_elastic(d, x, w, omega1, alpha1, load, remaining):
    """Advance by one step, or to the first event in it.

    Returns:
        (time passed or -1 if no step is small enough, whether the contact mode may change then).
    """
    w[W_OMEGA1] = omega1
    w[W_ALPHA1] = alpha1
    w[W_LOAD] = load
    w[W_DRIVE_TORQUE] = 0.0
    w[W_COLLOCATED] = COLLOCATED
    fastest = fastest_speed(x, w)
    found, followed, rate = try_steps(d, x, w, remaining, fastest)
    if not found:
        return -1.0, False
    which = end_at_event(d, x, w, rate, followed, fastest)
    h = w[W_STEP]
    held = x[X_MODE] == HELD or x[X_MODE] == HELD_DRIVING
    q = x[X_Q]
    momentum = angular_momentum(d, q, omega1, x[X_OMEGA2])
    add_shaft_works(d, x, w, load)
    commit(d, x, w, which)
    if held:
        add_held_works(d, x, w, q)
    else:
        add_moving_works(d, x, w, momentum)
    return h, which != NONE
