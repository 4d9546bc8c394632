"""Where in a step of the integrator link 2 leaves its contact mode: guards and their crossings.

A guard is positive while the mode goes on. While link 2 is free they are omega2 (housing) and
omega3 - omega2 (output); while it drives they are omega2 and the torque Tc. All rates are exact.
The beginning of a step never counts: what holds there was settled when the mode was chosen.
"""

import math

from .collocated_guards import collocated_guard
from .contact import TORQUE_ROUNDING
from .dormand_prince import dense_change, dense_coefficients, dense_rate, extra_stages
from .dynamics import motion_rates, torque_scale
from .guards import next_look, stays_positive
from .slots import *
from .torque_guards import driven_guard_inside

# a velocity below this fraction of the speeds that link 2 and the shaft take on is zero
VELOCITY_ROUNDING = 1e-14
# phase of the highest harmonic between two looks at a guard, rad
LOOK_PHASE = 1.0
# up to this phase of a step its ends tell whether a guard can have dipped inside
QUIET_PHASE = 2.0
# looks for a dip between two looks at a guard
DIP_LOOKS = 30


def output_guard(d, x, w, t, omega2, alpha2, jerk2):
    """Second guard and its rate, the time t into the step."""
    load = w[W_LOAD]
    if x[X_MODE] == DRIVING:
        return load + d[D_J3] * alpha2, d[D_J3] * jerk2
    slowing = load / d[D_J3]
    return x[X_OMEGA3] - slowing * t - omega2, -slowing - alpha2


def guard_inside(d, x, w, which, sigma):
    """A guard at the fraction sigma of the step and its rate per unit of sigma.

    Velocities are those of the dense output (or of the collocation polynomials, with the elastic
    output); a torque is evaluated exactly at its state. The sign of W_COLLOCATED says which step it is.
    """
    if w[W_COLLOCATED] > 0.0:
        return collocated_guard(d, x, w, which, sigma)
    if w[W_COLLOCATED] < 0.0:
        return driven_guard_inside(d, x, w, which, sigma)
    h = w[W_STEP]
    omega2 = x[X_OMEGA2] + dense_change(w, W_DENSE_OMEGA2, sigma)
    if which == OUTPUT and x[X_MODE] == DRIVING:
        q = x[X_Q] + dense_change(w, W_DENSE_Q, sigma)
        omega1 = w[W_OMEGA1] + w[W_ALPHA1] * sigma * h
        alpha2, jerk2, _ = motion_rates(
            d, q, omega1, w[W_ALPHA1], omega2, w[W_SHAFT_INERTIA], w[W_SHAFT_TORQUE]
        )
        x[X_STEP_EVALUATIONS] += 1.0
        return w[W_LOAD] + d[D_J3] * alpha2, h * d[D_J3] * jerk2
    rate = dense_rate(w, W_DENSE_OMEGA2, sigma)
    if which == LINK2:
        return omega2, rate
    slowing = h * w[W_LOAD] / d[D_J3]
    return x[X_OMEGA3] - slowing * sigma - omega2, -slowing - rate


def find_dip(d, x, w, which, zero, low, value_low, rate_low, high, value_high, rate_high):
    """Fraction of the step, low to high, where the guard is below -zero, or -1 if its lowest is not."""
    for _ in range(DIP_LOOKS):
        if stays_positive(value_low, rate_low, value_high, rate_high, high - low):
            return -1.0
        sigma = next_look(low, rate_low, high, rate_high)
        value, rate = guard_inside(d, x, w, which, sigma)
        if value < -zero:
            return sigma
        if rate < 0.0:
            low = sigma
            value_low = value
            rate_low = rate
        else:
            high = sigma
            value_high = value
            rate_high = rate
    return -1.0


def find_crossing(d, x, w, which, zero, low, high):
    """Fraction where the guard falls below -zero; it is below at high and not at low."""
    sigma = high
    value, rate = guard_inside(d, x, w, which, sigma)
    for _ in range(100):
        if -4.0 * zero <= value < -zero:
            return sigma
        move = sigma - (value + 2.0 * zero) / rate if rate < 0.0 else low
        sigma = move if low < move < high else 0.5 * (low + high)
        if not low < sigma < high:
            return high
        value, rate = guard_inside(d, x, w, which, sigma)
        if value < -zero:
            high = sigma
        else:
            low = sigma
    return high


def first_crossing(d, x, w, which, zero, looks):
    """First crossing of one guard in the step, looked for in so many parts of it, or -1."""
    low = 0.0
    value_low, rate_low = guard_inside(d, x, w, which, 0.0)
    for look in range(1, looks + 1):
        high = look / looks
        value, rate = guard_inside(d, x, w, which, high)
        found = -1.0
        if value < -zero:
            found = high
        else:
            found = find_dip(d, x, w, which, zero, low, value_low, rate_low, high, value, rate)
        if found > 0.0:
            return find_crossing(d, x, w, which, zero, low, found)
        low = high
        value_low = value
        rate_low = rate
    return -1.0


def is_clear(value0, rate0, value1, rate1, h):
    """Whether a guard, not negative at the beginning of the step, is so to its end."""
    return value1 >= 0.0 and stays_positive(value0, rate0, value1, rate1, h)


def is_step_quiet(d, x, w, phase, omega2_end, alpha2, jerk2, alpha2_end, jerk2_end):
    """Whether neither guard can have fallen through zero in the step."""
    if phase > QUIET_PHASE:
        return False
    h = w[W_STEP]
    if d[D_HOUSING] != 0.0 and not is_clear(x[X_OMEGA2], alpha2, omega2_end, alpha2_end, h):
        return False
    if d[D_OUTPUT] == 0.0:
        return True
    value0, rate0 = output_guard(d, x, w, 0.0, x[X_OMEGA2], alpha2, jerk2)
    value1, rate1 = output_guard(d, x, w, h, omega2_end, alpha2_end, jerk2_end)
    return is_clear(value0, rate0, value1, rate1, h)


def first_event(d, x, w, phase, fastest, taken):
    """Earliest event in the step just made.

    Args:
        phase: advance of the highest harmonic over the step, rad.
        fastest: largest of the speeds, rad/s: what a torque is to be called zero against.
        taken: largest speed that link 2 and the shaft take on, rad/s: the same for a velocity. Behind
            a heavy shaft it is far below fastest, and so are the errors of it.

    Returns:
        (fraction of the step or -1, which guard).
    """
    extra_stages(d, w, x[X_Q], x[X_OMEGA2])
    x[X_STEP_EVALUATIONS] += 3.0
    dense_coefficients(w, W_RATE_Q, W_DENSE_Q)
    dense_coefficients(w, W_RATE_OMEGA2, W_DENSE_OMEGA2)
    looks = 1 + int(math.floor(phase / LOOK_PHASE))
    earliest = -1.0
    which = NONE
    if d[D_HOUSING] != 0.0:
        earliest = first_crossing(d, x, w, LINK2, VELOCITY_ROUNDING * taken, looks)
        which = LINK2
    if d[D_OUTPUT] != 0.0:
        zero = VELOCITY_ROUNDING * taken
        if x[X_MODE] == DRIVING:
            scale = torque_scale(d, w[W_OMEGA1], w[W_ALPHA1], 2.0 * d[D_K] * fastest)
            zero = TORQUE_ROUNDING * (scale + abs(w[W_LOAD]))
        sigma = first_crossing(d, x, w, OUTPUT, zero, looks)
        if sigma > 0.0 and (earliest < 0.0 or sigma < earliest):
            earliest = sigma
            which = OUTPUT
    return earliest, which
