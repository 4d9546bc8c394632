"""One accurate internal step of the driven output shaft, stopped exactly where something happens."""

from .average_rates import driving_rates
from .average_step import GENTLE, W_ERROR, W_NEXT, gentle_step, stiff_step
from .slots import *

# a speed within this fraction of another is at it
ROUNDING = 1e-12


def one_step(d, x, w, header, speed, speed_rate, load, h, first, allowed):
    """One step of the driven shaft into the workspace, explicit if it can be. Whether it is accurate."""
    omega3 = x[X_OMEGA3]
    if h * abs(first[1]) <= GENTLE * d[D_J3]:
        gentle_step(d, x, w, header, speed, speed_rate, omega3, load, h, first, allowed)
    else:
        stiff_step(d, x, w, header, speed, speed_rate, omega3, load, h, first, allowed)
    x[X_STEP_EVALUATIONS] += 1.0
    return w[W_ERROR] <= 1.0


def overshoot(d, w, header, speed, speed_rate, h):
    """How far the step in the workspace went past rest (negative speed) or the end of the map, 1/s."""
    found = w[W_NEXT]
    past_end = found - d[header + 1] * (speed + speed_rate * h)
    return max(past_end, -found)


def drive(d, x, w, header, omega1, alpha1, load, remaining):
    """Advance the driven shaft by one accurate step, stopped exactly where it rests or the map ends.

    Returns:
        (time passed or -1, event): event 0 none, 1 at rest, 2 at the end of the map.
    """
    speed = abs(omega1)
    speed_rate = alpha1 if header == D_MAP_FORWARD else -alpha1
    omega3 = x[X_OMEGA3]
    first = driving_rates(d, x, header, speed, speed_rate, omega3)
    x[X_STEP_EVALUATIONS] += 1.0
    h = min(remaining, d[D_MAX_STEP])
    if x[X_STEP_SIZE] > 0.0:
        h = min(h, x[X_STEP_SIZE])
    fastest = max(omega3, max(speed, speed + speed_rate * h))
    allowed = d[D_TOLERANCE] * fastest + 1e-300
    wanted = h
    good = False
    for _ in range(80):
        good = one_step(d, x, w, header, speed, speed_rate, load, h, first, allowed)
        if good:
            break
        h *= max(0.1, 0.8 * w[W_ERROR] ** -0.25) if w[W_ERROR] < 1e4 else 0.1
    if not good:
        return -1.0, 0
    error = w[W_ERROR]
    factor = min(5.0, 0.8 * error**-0.25) if error > 1e-4 else 5.0
    # a step cut short by the end of the communication step says little about longer ones
    x[X_STEP_SIZE] = max(factor * h, x[X_STEP_SIZE]) if h == wanted else factor * h
    past = overshoot(d, w, header, speed, speed_rate, h)
    if past <= ROUNDING * fastest:
        return h, 0
    low = 0.0
    low_past = max(-omega3, omega3 - d[header + 1] * speed)
    if low_past > -ROUNDING * fastest:
        low_past = -past  # it begins where the map ends: that is not where it is to stop
    high = h
    high_past = past
    # Illinois: a secant that never leaves the bracket
    for _ in range(60):
        h = high - high_past * (high - low) / (high_past - low_past)
        if not low < h < high:
            h = 0.5 * (low + high)
        if not low < h < high:
            h = high
            break
        one_step(d, x, w, header, speed, speed_rate, load, h, first, allowed)
        past = overshoot(d, w, header, speed, speed_rate, h)
        if abs(past) <= ROUNDING * fastest:
            break
        if past > 0.0:
            high = h
            high_past = past
            low_past *= 0.5
        else:
            low = h
            low_past = past
            high_past *= 0.5
    return h, 1 if -w[W_NEXT] > w[W_NEXT] - d[header + 1] * (speed + speed_rate * h) else 2
