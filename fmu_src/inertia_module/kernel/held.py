"""Link 2 held: the motion is known, only the moment of release has to be found.

With omega2 = 0 the drive angle is q + k (omega1 t + alpha1 t^2 / 2) and link 1 has one degree of
freedom of inertia Phi(q) = J1 + I + 2 k B + k^2 G, so work and impulse of the input torque are exact.
"""

from .accumulate import add, assign
from .contact import TORQUE_ROUNDING
from .dynamics import held_inertia, held_torque, torque_scale
from .guards import next_look, stays_positive
from .slots import *

# phase of the highest harmonic between two looks at the guard, rad
SCAN_PHASE = 1.5
# looks for a dip in one interval
LOOKS = 30
# intervals before the angle is wrapped and the work counted
SCAN_INTERVALS = 64

# five-point Gauss-Legendre rule on [0, 1]
GAUSS_NODE_1 = 0.04691007703066802
GAUSS_NODE_2 = 0.23076534494715845
GAUSS_WEIGHT_1 = 0.11846344252809454
GAUSS_WEIGHT_2 = 0.23931433524968324
GAUSS_WEIGHT_3 = 0.28444444444444444


def held_angle(d, q, omega1, alpha1, t):
    """Drive angle after the time t with link 2 held."""
    return q + d[D_K] * t * (omega1 + 0.5 * alpha1 * t)


def release_guard(d, x, q, omega1, alpha1, threshold, t):
    """Torque left in the housing freewheel, threshold - F, and its rate after the time t."""
    x[X_STEP_EVALUATIONS] += 1.0
    torque, rate = held_torque(d, held_angle(d, q, omega1, alpha1, t), omega1 + alpha1 * t, alpha1)
    return threshold - torque, -rate


def find_low(d, x, q, omega1, alpha1, threshold, zero, low, value_low, rate_low, high, value_high, rate_high):
    """Time of a point between low and high where the guard is below -zero, or -1 if its lowest is not."""
    for _ in range(LOOKS):
        if stays_positive(value_low, rate_low, value_high, rate_high, high - low):
            return -1.0
        t = next_look(low, rate_low, high, rate_high)
        value, rate = release_guard(d, x, q, omega1, alpha1, threshold, t)
        if value < -zero:
            return t
        if rate < 0.0:
            low = t
            value_low = value
            rate_low = rate
        else:
            high = t
            value_high = value
            rate_high = rate
    return -1.0


def find_release(d, x, q, omega1, alpha1, threshold, zero, start, end):
    """First time found where the guard is below -zero, knowing it is not at start and is at end."""
    low = start
    high = end
    value, rate = release_guard(d, x, q, omega1, alpha1, threshold, end)
    t = end
    for _ in range(100):
        if -4.0 * zero <= value < -zero:
            return t
        move = t - (value + 2.0 * zero) / rate if rate < 0.0 else low
        t = move if low < move < high else 0.5 * (low + high)
        if not low < t < high:
            return high
        value, rate = release_guard(d, x, q, omega1, alpha1, threshold, t)
        if value < -zero:
            high = t
        else:
            low = t
    return high


def mean_inertia(d, x, q, omega1, alpha1, start, end):
    """Integral of Phi over the time from start to end (five-point Gauss rule)."""
    h = end - start
    near = held_inertia(d, held_angle(d, q, omega1, alpha1, start + GAUSS_NODE_1 * h))
    near += held_inertia(d, held_angle(d, q, omega1, alpha1, end - GAUSS_NODE_1 * h))
    mid = held_inertia(d, held_angle(d, q, omega1, alpha1, start + GAUSS_NODE_2 * h))
    mid += held_inertia(d, held_angle(d, q, omega1, alpha1, end - GAUSS_NODE_2 * h))
    centre = held_inertia(d, held_angle(d, q, omega1, alpha1, start + 0.5 * h))
    x[X_STEP_EVALUATIONS] += 5.0
    return h * (GAUSS_WEIGHT_1 * near + GAUSS_WEIGHT_2 * mid + GAUSS_WEIGHT_3 * centre)


def scan_interval(d, omega1, alpha1, remaining):
    """Time between two looks at the guard."""
    fastest = d[D_HARMONIC] * d[D_K] * max(abs(omega1), abs(omega1 + alpha1 * remaining))
    interval = min(remaining, d[D_MAX_STEP])
    if fastest * interval > SCAN_PHASE:
        interval = SCAN_PHASE / fastest
    return interval


def scan(d, x, omega1, alpha1, threshold, remaining):
    """Follow the guard of the housing freewheel through at most SCAN_INTERVALS intervals.

    Returns:
        (time passed, whether link 2 is released then, integral of Phi if alpha1 is not zero).
    """
    if omega1 == 0.0 and alpha1 == 0.0:
        return remaining, False, 0.0  # nothing turns: the guard stays as it is
    q = x[X_Q]
    zero = TORQUE_ROUNDING * (torque_scale(d, omega1, alpha1, d[D_K] * omega1) + abs(threshold))
    interval = scan_interval(d, omega1, alpha1, remaining)
    value_start, rate_start = release_guard(d, x, q, omega1, alpha1, threshold, 0.0)
    integral = 0.0
    start = 0.0
    for n in range(1, SCAN_INTERVALS + 1):
        end = n * interval
        last = end >= remaining or n == SCAN_INTERVALS
        if end > remaining:
            end = remaining
        found = -1.0
        value, rate = release_guard(d, x, q, omega1, alpha1, threshold, end)
        if value < -zero:
            found = end
        else:
            found = find_low(
                d, x, q, omega1, alpha1, threshold, zero, start, value_start, rate_start, end, value, rate
            )
        if found > 0.0:
            end = find_release(d, x, q, omega1, alpha1, threshold, zero, start, found)
        if alpha1 != 0.0:
            integral += mean_inertia(d, x, q, omega1, alpha1, start, end)
        if found > 0.0:
            return end, True, integral
        start = end
        value_start = value
        rate_start = rate
        if last:
            break
    return start, False, integral


def turn(d, x, omega1, alpha1, h, integral):
    """Turn the drive, with work and impulse of the input torque; integral: of Phi over the time."""
    q = x[X_Q]
    end = omega1 + alpha1 * h
    before = held_inertia(d, q)
    after = held_inertia(d, held_angle(d, q, omega1, alpha1, h))
    x[X_STEP_EVALUATIONS] += 2.0
    add(x, X_ENERGY_IN, 0.5 * (after * end * end - before * omega1 * omega1))
    x[X_INPUT_IMPULSE] += 0.5 * (after * end - before * omega1 + alpha1 * integral)
    add(x, X_Q, d[D_K] * h * (omega1 + 0.5 * alpha1 * h))


def advance_held(d, x, mode, omega1, alpha1, load, remaining):
    """Advance some scan intervals, to the release of link 2 or to where the output shaft stops.

    Returns:
        (time passed, whether the contact mode may change then).
    """
    stop = -1.0
    if mode == HELD and load > 0.0 and d[D_J3] * x[X_OMEGA3] < load * remaining:
        stop = d[D_J3] * x[X_OMEGA3] / load
        remaining = stop
    h, released, integral = scan(d, x, omega1, alpha1, load if mode == HELD_DRIVING else 0.0, remaining)
    if omega1 != 0.0 or alpha1 != 0.0:
        turn(d, x, omega1, alpha1, h, integral)
    if mode == HELD_DRIVING:
        x[X_OUTPUT_IMPULSE] += load * h
        x[X_OUTPUT_SQUARE] += load * load * h
        x[X_TORQUE_PEAK] = max(x[X_TORQUE_PEAK], abs(load))
        return h, released
    coast(d, x, load, h)
    if stop >= 0.0 and h >= stop and not released:
        assign(x, X_OMEGA3, 0.0)
        return h, True
    return h, released


def coast(d, x, load, h):
    """Output shaft on its own: uniform deceleration by the load."""
    change = -load * h / d[D_J3]
    add(x, X_ENERGY_OUT, load * h * (x[X_OMEGA3] + 0.5 * change))
    add(x, X_OMEGA3, change)
