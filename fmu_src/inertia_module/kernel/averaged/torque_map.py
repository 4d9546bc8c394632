"""Mean torque over speed ratio, found once: the map of fidelity averaged (docs/mechanics.md).

Without gravity the mean output torque at constant omega1 and output speed is omega1^2 F(sigma),
sigma = omega3 / |omega1|, with one F for either sign of omega1. The steady motion is found by
average_motion over one period of q. It begins where link 2 surely rests: Jacobi's integral C falls
only in the housing, so where it could fall lowest link 2 is held if any torque is passed at all.

No torque is passed above sigma = 1 with omega1 > 0: the housing can only push forward, and its mean
torque is Tc (1 - sigma).
"""

import math

from ..codes import DRIVING, FREE
from ..derive import TWO_PI
from .motion import drive_inertia, travel
from .table import UNKNOWN_ERROR, finish_table, insert_knot, table_error, worst_interval

# cycles of the highest harmonic that one mean is taken over at most
LARGEST_CYCLES = 800.0
# beyond that, at least so many parts, spread evenly over the relative phase of drive and satellite
PARTS = 16
# angle between two looks for an extreme, in cycles of the highest harmonic
LOOKS_PER_CYCLE = 12.0
GOLDEN_LOOKS = 40

# what of the motion is to be largest
LARGEST_HELD = 0  # H - I
LARGEST_LOCK = 1  # -I'
LARGEST_SPEED_SQUARE = 2  # (C + I) / H

# the map is refined until its error, in stall torques, is below this at the middle of each interval
MAP_ERROR = 1e-4
# three or more
FIRST_KNOTS = 9
# the last ratio below lock-up
LAST_SLIP = 1e-6
# evaluations of the mechanism after which one sign of omega1 is refined no more
MOST_EVALUATIONS = 8e5


def is_map_of(p, d):
    """Whether the map in d is that of these parameters (fields.MAP_KEY)."""
    last = len(d.map_key) - 1
    for n in range(last):
        if d.map_key[n] != p.numbers[n]:
            return False
    return d.map_ready == 1.0 and d.map_key[last] == p.link2_inertia


def mark_map(p, d):
    """Mark the map in d as that of these parameters."""
    last = len(d.map_key) - 1
    for n in range(last):
        d.map_key[n] = p.numbers[n]
    d.map_key[last] = p.link2_inertia
    d.map_ready = 1.0


def extreme_value(d, which, sign, c, q):
    """What is to be largest at q."""
    i, i1, _, _, h, _, _ = drive_inertia(d, q)
    d.map_evaluations += 1.0
    if which == LARGEST_HELD:
        return sign * (h - i)
    if which == LARGEST_LOCK:
        return -i1
    return sign * (c + i) / h


def find_largest(d, which, sign, c, start, length):
    """Drive angle in start to start + length where it is largest, and how large."""
    looks = int(math.ceil(length * d.harmonic / TWO_PI * LOOKS_PER_CYCLE)) + 2
    width = length / looks
    best_q = start
    best = extreme_value(d, which, sign, c, start)
    before = best
    here = extreme_value(d, which, sign, c, start + width)
    for n in range(1, looks + 1):
        after = extreme_value(d, which, sign, c, start + (n + 1) * width)
        if here >= before and here >= after:
            # the top of the parabola through the three is near: only a promising one is looked at
            bend = before - 2.0 * here + after
            top = here - (after - before) ** 2 / (8.0 * bend) if bend < 0.0 else here
            if top + 0.1 * (top - here) > best:
                low = start + (n - 1) * width
                q, value = refine_largest(d, which, sign, c, low, low + 2.0 * width)
                if value > best:
                    best = value
                    best_q = q
        before = here
        here = after
    return best_q, best


def refine_largest(d, which, sign, c, low, high):
    """Largest value between low and high by golden sections."""
    golden = 0.6180339887498949
    inner = high - golden * (high - low)
    outer = low + golden * (high - low)
    value_inner = extreme_value(d, which, sign, c, inner)
    value_outer = extreme_value(d, which, sign, c, outer)
    for _ in range(GOLDEN_LOOKS):
        if value_inner > value_outer:
            high = outer
            outer = inner
            value_outer = value_inner
            inner = high - golden * (high - low)
            value_inner = extreme_value(d, which, sign, c, inner)
        else:
            low = inner
            inner = outer
            value_inner = value_outer
            outer = low + golden * (high - low)
            value_outer = extreme_value(d, which, sign, c, outer)
    if value_inner > value_outer:
        return inner, value_inner
    return outer, value_outer


def parts_of_period(d, cycles):
    """Length, rad, and number of the parts that stand for a long period, of so many cycles together.

    The satellite meets the drive at every relative phase, evenly, so turns of the drive at evenly
    spread phases are as good as all turns of the period. Where a turn itself is long, parts of it.
    """
    part = min(TWO_PI, cycles / PARTS * TWO_PI / d.harmonic)
    return part, int(cycles * TWO_PI / (d.harmonic * part))


def go_to_part(d, phase, part, parts, n):
    """Set the relative phase of part n. Returns the drive angle where it begins."""
    d.phase_b = phase + n * (TWO_PI / parts)
    return n * (TWO_PI / parts) if part < TWO_PI else 0.0


def find_largest_anywhere(d, which, sign, c):
    """Drive angle where it is largest in the whole period (or its parts), and how large."""
    period = period_of_map(d)
    if period * d.harmonic <= TWO_PI * LARGEST_CYCLES:
        return find_largest(d, which, sign, c, 0.0, period)
    part, parts = parts_of_period(d, LARGEST_CYCLES)
    phase = d.phase_b
    best_q = 0.0
    best = -1e300
    for n in range(parts):
        q, value = find_largest(d, which, sign, c, go_to_part(d, phase, part, parts, n), part)
        if value > best:
            best = value
            best_q = q
    d.phase_b = phase
    return best_q, best


def period_of_map(d):
    """Angle of the drive in which everything comes back, rad."""
    # with three or more satellites the drive's own turn leaves nothing in the reduced inertia
    return TWO_PI / d.s if d.paired == 0.0 and d.planar == 0.0 else d.period


def add_part(d, direction, speed, start, warm, length):
    """Travel one part of the period from rest at start; the first angle warm is not counted."""
    i, _, _, _, h, _, _ = drive_inertia(d, start)
    mode = DRIVING if speed == 1.0 else FREE
    c = h - i
    if warm > 0.0:
        mode, c = travel(d, direction, speed, mode, c, start, warm, False)
    travel(d, direction, speed, mode, c, start + direction * warm, length, True)


def clear_sums(d):
    """Set the sums over the steady motion to zero."""
    d.sum_time = 0.0
    d.sum_torque = 0.0
    d.sum_square = 0.0
    d.sum_energy = 0.0
    d.sum_angle = 0.0
    d.sum_peak = 0.0


def add_period(d, side, speed):
    """Add the steady motion at v = |omega1 - omega3| / |omega1| to the sums."""
    direction = side.direction
    period = period_of_map(d)
    if period * d.harmonic <= TWO_PI * LARGEST_CYCLES:
        add_part(d, direction, speed, side.start, 0.0, period)
        return
    # half of the angle allowed goes to reach the steady motion
    part, parts = parts_of_period(d, 0.5 * LARGEST_CYCLES)
    phase = d.phase_b
    for n in range(parts):
        begin = go_to_part(d, phase, part, parts, n)
        low = begin - part if direction > 0.0 else begin
        start, _ = find_largest(d, LARGEST_HELD, -direction, 0.0, low, part)
        add_part(d, direction, speed, start, direction * (begin - start), part)
    d.phase_b = phase


def find_means(d, side, sigma):
    """Means at one ratio: (F, energy, omega2, ripple, peak) over powers of omega1."""
    forward = side.direction > 0.0
    clear_sums(d)
    add_period(d, side, max(1.0 - sigma, LAST_SLIP) if forward else 1.0 + sigma)
    time = d.sum_time
    torque = d.sum_torque / time
    turned = d.sum_angle / d.k
    energy = d.J2 + (d.sum_energy - 2.0 * d.J2 * turned) / time
    omega2 = max(0.0, 1.0 - turned / time if forward else turned / time - 1.0)
    variance = d.sum_square / time - torque * torque
    return torque, energy, min(omega2, sigma), math.sqrt(max(variance, 0.0)), d.sum_peak


def find_end(d, side):
    """Where the torque ends, and where the steady motion begins."""
    direction = side.direction
    start, value = find_largest_anywhere(d, LARGEST_HELD, -direction, 0.0)
    side.start = start
    _, square = find_largest_anywhere(d, LARGEST_SPEED_SQUARE, -direction, -direction * value)
    if direction > 0.0:
        least = math.sqrt(max(-square, 0.0))
        side.locks = 1.0 if least < LAST_SLIP else 0.0
        side.end = 1.0 if least < LAST_SLIP else 1.0 - least
    else:
        side.end = max(math.sqrt(max(square, 1.0)) - 1.0, 0.0)


def add_knot(d, side, n, sigma):
    """Find the knot at sigma and insert it as number n."""
    torque, energy, omega2, ripple, peak = find_means(d, side, sigma)
    if sigma >= side.end and side.locks == 0.0:
        torque = 0.0
        ripple = 0.0
        peak = 0.0
    error = UNKNOWN_ERROR
    if n < int(side.count):
        error = table_error(side, n - 1, sigma, torque, energy, omega2)
    insert_knot(side, n, sigma, torque, energy, omega2, ripple, peak, error)


def build_side(d, side, direction):
    """Knots for one sign of omega1, refined where the table is worst."""
    for n in range(len(side.numbers)):
        side.numbers[n] = 0.0
    side.direction = direction
    find_end(d, side)
    end = side.end
    last = FIRST_KNOTS - 1 if end > 0.0 else 0
    for n in range(last):
        add_knot(d, side, n, n * end / last)
    add_knot(d, side, last, end)
    d.map_evaluations = 0.0
    while side.count < len(side.knots) and end > 0.0 and d.map_evaluations < MOST_EVALUATIONS:
        n, error = worst_interval(side)
        if error < MAP_ERROR:
            break
        add_knot(d, side, n + 1, 0.5 * (side.knots[n].ratio + side.knots[n + 1].ratio))
    finish_table(side)


def build_map(p, d):
    """Fill d with the map of these parameters, unless it is there."""
    if is_map_of(p, d):
        return
    d.map_ready = 0.0
    _, lock = find_largest_anywhere(d, LARGEST_LOCK, 1.0, 0.0)
    d.map_lock = max(0.5 * d.k * lock, 0.0)
    build_side(d, d.forward, 1.0)
    build_side(d, d.backward, -1.0)
    mark_map(p, d)
