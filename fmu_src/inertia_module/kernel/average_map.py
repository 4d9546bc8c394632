"""Mean torque over speed ratio, found once: the map of fidelity averaged (DESIGN section 5).

Without gravity the mean output torque at constant omega1 and output speed is omega1^2 F(sigma),
sigma = omega3 / |omega1|, with one F for either sign of omega1. The steady motion is found by
average_motion over one period of q. It begins where link 2 surely rests: Jacobi's integral C falls
only in the housing, so where it could fall lowest link 2 is held if any torque is passed at all.

No torque is passed above sigma = 1 with omega1 > 0: the housing can only push forward, and its mean
torque is Tc (1 - sigma).
"""

import math

from .average_motion import drive_inertia, travel
from .average_table import finish_table, knot, predict, put_knot, worst_interval
from .derive import TWO_PI
from .slots import *

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
FIRST_KNOTS = 9
# the last ratio below lock-up
LAST_SLIP = 1e-6
# ... and of energy and speed of link 2, which matter less
OTHER_SHARE = 0.2
# evaluations of the mechanism after which one sign of omega1 is refined no more
MOST_EVALUATIONS = 8e5


def map_key(p, n):
    """The parameter that the map depends on, number n of it, or -1 after the last."""
    if n <= P_J16 - P_LAYOUT:
        return p[P_LAYOUT + n]
    if n == P_J16 - P_LAYOUT + 1:
        return p[P_J2]
    if n == P_J16 - P_LAYOUT + 2:
        return 1.0  # a map is there
    return -1.0


def is_map_of(p, d):
    """Whether the map in d is that of these parameters."""
    for n in range(P_J16 - P_LAYOUT + 3):
        if d[D_MAP_KEY + n] != map_key(p, n):
            return False
    return True


def extreme_value(d, which, sign, c, q):
    """What is to be largest at q."""
    i, i1, _, _, h, _, _ = drive_inertia(d, q)
    d[D_MAP_EVALUATIONS] += 1.0
    if which == LARGEST_HELD:
        return sign * (h - i)
    if which == LARGEST_LOCK:
        return -i1
    return sign * (c + i) / h


def find_largest(d, which, sign, c, start, length):
    """Drive angle in start to start + length where it is largest, and how large."""
    looks = int(math.ceil(length * d[D_HARMONIC] / TWO_PI * LOOKS_PER_CYCLE)) + 2
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
    part = min(TWO_PI, cycles / PARTS * TWO_PI / d[D_HARMONIC])
    return part, int(cycles * TWO_PI / (d[D_HARMONIC] * part))


def go_to_part(d, phase, part, parts, n):
    """Set the relative phase of part n. Returns the drive angle where it begins."""
    d[D_PHASE_B] = phase + n * (TWO_PI / parts)
    return n * (TWO_PI / parts) if part < TWO_PI else 0.0


def find_largest_anywhere(d, which, sign, c):
    """Drive angle where it is largest in the whole period (or its parts), and how large."""
    period = period_of_map(d)
    if period * d[D_HARMONIC] <= TWO_PI * LARGEST_CYCLES:
        return find_largest(d, which, sign, c, 0.0, period)
    part, parts = parts_of_period(d, LARGEST_CYCLES)
    phase = d[D_PHASE_B]
    best_q = 0.0
    best = -1e300
    for n in range(parts):
        q, value = find_largest(d, which, sign, c, go_to_part(d, phase, part, parts, n), part)
        if value > best:
            best = value
            best_q = q
    d[D_PHASE_B] = phase
    return best_q, best


def period_of_map(d):
    """Angle of the drive in which everything comes back, rad."""
    # with three or more satellites the drive's own turn leaves nothing in the reduced inertia
    return TWO_PI / d[D_S] if d[D_PAIRED] == 0.0 and d[D_PLANAR] == 0.0 else d[D_PERIOD]


def add_part(d, direction, speed, start, warm, length):
    """Travel one part of the period from rest at start; the first angle warm is not counted."""
    i, _, _, _, h, _, _ = drive_inertia(d, start)
    mode = DRIVING if speed == 1.0 else FREE
    c = h - i
    if warm > 0.0:
        mode, c = travel(d, direction, speed, mode, c, start, warm, False)
    travel(d, direction, speed, mode, c, start + direction * warm, length, True)


def find_means(d, direction, speed):
    """Sums over the steady motion at v = |omega1 - omega3| / |omega1|, left in d."""
    for n in range(6):
        d[D_SUM_TIME + n] = 0.0
    header = D_MAP_FORWARD if direction > 0.0 else D_MAP_BACKWARD
    period = period_of_map(d)
    if period * d[D_HARMONIC] <= TWO_PI * LARGEST_CYCLES:
        add_part(d, direction, speed, d[header + 3], 0.0, period)
        return
    # half of the angle allowed goes to reach the steady motion
    part, parts = parts_of_period(d, 0.5 * LARGEST_CYCLES)
    phase = d[D_PHASE_B]
    for n in range(parts):
        begin = go_to_part(d, phase, part, parts, n)
        low = begin - part if direction > 0.0 else begin
        start, _ = find_largest(d, LARGEST_HELD, -direction, 0.0, low, part)
        add_part(d, direction, speed, start, direction * (begin - start), part)
    d[D_PHASE_B] = phase


def find_knot(d, direction, sigma, slip):
    """Means at one ratio, slip = 1 - sigma: (F, energy, omega2, ripple, peak) over powers of omega1."""
    find_means(d, direction, slip if direction > 0.0 else 1.0 + sigma)
    time = d[D_SUM_TIME]
    torque = d[D_SUM_TORQUE] / time
    turned = d[D_SUM_ANGLE] / d[D_K]
    energy = d[D_J2] + (d[D_SUM_ENERGY] - 2.0 * d[D_J2] * turned) / time
    omega2 = max(0.0, direction * (1.0 - turned / time) if direction > 0.0 else turned / time - 1.0)
    variance = d[D_SUM_SQUARE] / time - torque * torque
    return torque, energy, min(omega2, sigma), math.sqrt(max(variance, 0.0)), d[D_SUM_PEAK]


def find_ends(d):
    """Where torque ends for either sign of omega1, where the motion begins, the lock-up torque."""
    _, lock = find_largest_anywhere(d, LARGEST_LOCK, 1.0, 0.0)
    d[D_MAP_LOCK] = max(0.5 * d[D_K] * lock, 0.0)
    for n in range(2):
        direction = 1.0 - 2.0 * n
        header = D_MAP_FORWARD if n == 0 else D_MAP_BACKWARD
        start, value = find_largest_anywhere(d, LARGEST_HELD, -direction, 0.0)
        d[header + 3] = start
        c = -direction * value
        _, square = find_largest_anywhere(d, LARGEST_SPEED_SQUARE, -direction, c)
        if n == 0:
            least = math.sqrt(max(-square, 0.0))
            d[header + 2] = 1.0 if least < LAST_SLIP else 0.0
            d[header + 1] = 1.0 - least if least >= LAST_SLIP else 1.0
        else:
            d[header + 2] = 0.0
            d[header + 1] = max(math.sqrt(max(square, 1.0)) - 1.0, 0.0)


def add_knot(d, direction, sigma):
    """Find one knot and put it in its place. Returns the error of the table there before."""
    header = D_MAP_FORWARD if direction > 0.0 else D_MAP_BACKWARD
    end = d[header + 1]
    torque, energy, omega2, ripple, peak = find_knot(d, direction, sigma, max(1.0 - sigma, LAST_SLIP))
    if sigma >= end and d[header + 2] == 0.0:
        torque = 0.0
        ripple = 0.0
        peak = 0.0
    error = predict(d, header, sigma, torque, energy, omega2, OTHER_SHARE)
    put_knot(d, header, sigma, torque, energy, omega2, ripple, peak, error)
    return error


def build_side(d, direction):
    """Knots for one sign of omega1, refined where the table is worst."""
    header = D_MAP_FORWARD if direction > 0.0 else D_MAP_BACKWARD
    d[header] = 0.0
    end = d[header + 1]
    first = FIRST_KNOTS if end > 0.0 else 1
    for n in range(first):
        add_knot(d, direction, end if n == first - 1 else n * end / (first - 1))
    d[D_MAP_EVALUATIONS] = 0.0
    while d[header] < MAP_ROWS and end > 0.0 and d[D_MAP_EVALUATIONS] < MOST_EVALUATIONS:
        row, error = worst_interval(d, header)
        if error < MAP_ERROR:
            break
        add_knot(d, direction, 0.5 * (knot(d, header, row) + knot(d, header, row + 1)))
    finish_table(d, header)


def build_map(p, d):
    """Fill d with the map of these parameters, unless it is there."""
    if is_map_of(p, d):
        return
    for n in range(D_MAP_KEY, D_SIZE):
        d[n] = 0.0
    find_ends(d)
    build_side(d, 1.0)
    build_side(d, -1.0)
    for n in range(P_J16 - P_LAYOUT + 3):
        d[D_MAP_KEY + n] = map_key(p, n)
