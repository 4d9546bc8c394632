"""Steady motion of link 2 at constant omega1 and held output speed: what the averaged map is made of.

With omega1 constant and of size 1 the free motion has Jacobi's integral: with H = J2 + k^2 G and
r = (q'/k)^2, the speed of the drive, H r - I = C. Held, r = 1 and C is H - I; driving, r = v^2 with
v = |omega1 - omega3| and C is H v^2 - I. So everything follows from the drive angle by quadrature,
no differential equation is integrated, and every torque is F = k/2 d(H r - I)/dq at constant r.
All angles are those travelled, u, in the direction of omega1.
Source: DESIGN section 3; Arnold, Mathematical Methods of Classical Mechanics, on relative equilibria.
"""

import math

from ..codes import DRIVING, FREE, HELD
from ..inertia import reduced_inertia
from ..search import next_look, stays_positive

# phase of the highest harmonic within one interval, rad
INTERVAL_PHASE = 1.0
# share of the distance to the nearest singularity of 1/q' that an interval may cover
SINGULAR_SHARE = 0.3
DIP_LOOKS = 8
# share of an interval within which a fall is found; it is taken just past, so that the next mode holds
NEAR = 1e-9
ROOT_LOOKS = 60

# four-point Lobatto rule on [0, 1]: ends and two inner nodes
LOBATTO_NODE = 0.27639320225002106
LOBATTO_END = 1.0 / 12.0
LOBATTO_INNER = 5.0 / 12.0

# guards of the mode in hand, positive while it goes on
LINK2_GUARD = 0  # free: omega2 > 0
OUTPUT_GUARD = 1  # free: omega2 < omega3
HELD_GUARD = 2  # F < 0
DRIVING_GUARD = 3  # F > 0


def drive_inertia(d, q):
    """(I, I', I'', B, H, H', H'') with H = J2 + k^2 G, kg m^2."""
    i, i1, i2, b, _, g, g1, g2 = reduced_inertia(d, q)
    square = d.k * d.k
    return i, i1, i2, b, d.J2 + square * g, square * g1, square * g2


def guard_value(which, direction, r, c, inertia):
    """One guard and its rate per angle travelled; r is that of the driving link 2."""
    i, i1, i2, _, h, h1, h2 = inertia
    if which == LINK2_GUARD:
        return direction * (h - i - c), h1 - i1
    if which == OUTPUT_GUARD:
        return direction * (c - (h * r - i)), i1 - h1 * r
    if which == HELD_GUARD:
        return i1 - h1, direction * (i2 - h2)
    return h1 * r - i1, direction * (h2 * r - i2)


def guard_at(d, which, direction, r, c, q):
    """One guard and its rate at the drive angle q."""
    d.map_evaluations += 1.0
    return guard_value(which, direction, r, c, drive_inertia(d, q))


def find_dip(d, which, direction, r, c, q, value0, rate0, value1, rate1, length):
    """Angle travelled from q to where the guard is negative, or -1 if it is not within length."""
    low = 0.0
    high = length
    for _ in range(DIP_LOOKS):
        if stays_positive(value0, rate0, value1, rate1, high - low):
            return -1.0
        look = next_look(low, rate0, high, rate1)
        value, rate = guard_at(d, which, direction, r, c, q + direction * look)
        if value < 0.0:
            return look
        if rate < 0.0:
            low = look
            value0 = value
            rate0 = rate
        else:
            high = look
            value1 = value
            rate1 = rate
    return -1.0


def find_fall(d, which, direction, r, c, q, length):
    """Angle travelled from q to where the guard falls through zero; it is negative at length."""
    low = 0.0
    high = length
    look = length
    value, rate = guard_at(d, which, direction, r, c, q + direction * look)
    for _ in range(ROOT_LOOKS):
        move = look - value / rate if rate < 0.0 else low
        if low < move < high:
            if abs(move - look) <= NEAR * length:
                return min(move + NEAR * length, high)
            look = move
        else:
            look = 0.5 * (low + high)
        if not high - low > 1e-13 * length:
            return high
        value, rate = guard_at(d, which, direction, r, c, q + direction * look)
        if value < 0.0:
            high = look
        else:
            low = look
    return high


def fall_inside(d, which, direction, r, c, q, value0, rate0, value1, rate1, length):
    """Angle travelled to the first fall of a guard within length, or -1."""
    if value1 >= 0.0:
        length = find_dip(d, which, direction, r, c, q, max(value0, 0.0), rate0, value1, rate1, length)
        if length < 0.0:
            return -1.0
    return find_fall(d, which, direction, r, c, q, length)


def first_fall(d, mode, direction, r, c, q, begin, end, length):
    """First fall of a guard of the mode between two angles with this inertia.

    Returns:
        (angle travelled from q or -1, which guard).
    """
    which = HELD_GUARD if mode == HELD else (DRIVING_GUARD if mode == DRIVING else LINK2_GUARD)
    value0, rate0 = guard_value(which, direction, r, c, begin)
    value1, rate1 = guard_value(which, direction, r, c, end)
    fall = fall_inside(d, which, direction, r, c, q, value0, rate0, value1, rate1, length)
    if mode != FREE:
        return fall, which
    # the other guard is looked at up to the fall of the first
    value0, rate0 = guard_value(OUTPUT_GUARD, direction, r, c, begin)
    if fall < 0.0:
        value1, rate1 = guard_value(OUTPUT_GUARD, direction, r, c, end)
    else:
        length = fall
        value1, rate1 = guard_at(d, OUTPUT_GUARD, direction, r, c, q + direction * length)
    other = fall_inside(d, OUTPUT_GUARD, direction, r, c, q, value0, rate0, value1, rate1, length)
    if other >= 0.0:
        return other, OUTPUT_GUARD
    return fall, which


def add_node(d, mode, speed, c, weight, inertia):
    """Add one node of the quadrature, of so much angle, to the sums."""
    i, i1, _, b, h, h1, _ = inertia
    r = 1.0
    torque = 0.0
    if mode == FREE:
        r = max((c + i) / h, 0.0)
        if speed < 1.0:
            r = max(r, speed * speed)
    elif mode == DRIVING:
        r = speed * speed
        torque = max(0.5 * d.k * (h1 * r - i1), 0.0)
    time = weight / (d.k * math.sqrt(r)) if r > 0.0 else 0.0
    d.sum_time += time
    d.sum_torque += time * torque
    d.sum_square += time * torque * torque
    d.sum_energy += time * (i + h * r) + 2.0 * weight * b
    d.sum_angle += weight
    d.sum_peak = max(d.sum_peak, torque)


def add_interval(d, mode, direction, speed, c, q, begin, end, length):
    """Add an interval from q to the sums by Lobatto's rule, begin and end being the inertia there."""
    add_node(d, mode, speed, c, LOBATTO_END * length, begin)
    for n in range(2):
        node = LOBATTO_NODE if n == 0 else 1.0 - LOBATTO_NODE
        inside = drive_inertia(d, q + direction * node * length)
        add_node(d, mode, speed, c, LOBATTO_INNER * length, inside)
    d.map_evaluations += 2.0
    add_node(d, mode, speed, c, LOBATTO_END * length, end)


def smooth_length(c, inertia):
    """How far 1/q' stays smooth while link 2 is free: where q' is least it has poles next to the angle."""
    i, i1, i2, _, h, h1, h2 = inertia
    r = (c + i) / h
    if not r > 0.0:
        r = 1e-300
    slope = (i1 - r * h1) / h
    bend = (i2 - r * h2 - 2.0 * slope * h1) / h
    root = math.sqrt(r)
    rate = math.sqrt(0.5 * abs(bend)) + 0.5 * abs(slope) / root
    return SINGULAR_SHARE * root / rate if rate > 0.0 else 1e300


def next_mode(mode, fallen, at_rest):
    """Contact mode after the fall of a guard; with the output at rest there is no free motion."""
    if mode == FREE:
        return HELD if fallen == LINK2_GUARD else DRIVING
    if not at_rest:
        return FREE
    return DRIVING if mode == HELD else HELD


def travel(d, direction, speed, mode, c, start, length, counted):
    """Let the drive travel, output speed held.

    Args:
        direction: sign of omega1, 1 or -1.
        speed: v = |omega1 - omega3| / |omega1|, above zero: the speed of the drive over k while driving.
        mode, c: contact mode and Jacobi's integral at start.
        start, length: drive angle, and angle to travel, rad.
        counted: whether the sums in d are to be added to.

    Returns:
        (mode, c) at the end.
    """
    driving = speed * speed
    longest = INTERVAL_PHASE / d.harmonic
    least = 1e-12 * length
    done = 0.0
    begin = drive_inertia(d, start)
    while done < length:
        q = start + direction * done
        step = min(longest, length - done)
        if mode == FREE:
            step = min(step, max(smooth_length(c, begin), 1e-6 * longest))
        end = drive_inertia(d, q + direction * step)
        d.map_evaluations += 1.0
        fall, fallen = first_fall(d, mode, direction, driving, c, q, begin, end, step)
        if fall >= 0.0:
            step = max(fall, least)
            end = drive_inertia(d, q + direction * step)
            d.map_evaluations += 1.0
        if counted:
            add_interval(d, mode, direction, speed, c, q, begin, end, step)
        done += step
        begin = end
        if fall >= 0.0:
            if mode != FREE:
                i, _, _, _, h, _, _ = end
                c = h - i if mode == HELD else h * driving - i
            mode = next_mode(mode, fallen, speed == 1.0)
    return mode, c
