"""Where in a period of the drive something of the motion is largest, and long periods by parts."""

import math

from ..derive import TWO_PI
from ..inertia import reduced_inertia
from ..links import inertia_of_link1
from .instants import speeds_at

# cycles of the highest harmonic that one mean is taken over at most
LARGEST_CYCLES = 800.0
# beyond that, at least so many parts, spread evenly over the relative phase of drive and satellite
PARTS = 16
# angle between two looks for an extreme, in cycles of the highest harmonic
LOOKS_PER_CYCLE = 12.0
GOLDEN_LOOKS = 40

# what of the motion is to be largest
LOCK = 0  # -I'
MOMENTUM = 1  # of links 1 and 2 while link 2 is held
THROWN = 2  # omega2 after link 2 was thrown from rest, both torques being zero, with the integrals in t


def value_at(d, t, which, q):
    """Quantity that is to be largest, at q."""
    i, i1, _, b, _, g, _, _ = reduced_inertia(d, q)
    d.map_evaluations += 1.0
    if which == LOCK:
        return -i1
    if which == THROWN:
        return speeds_at(d, t, q, t.energy, t.momentum)[1]
    k = d.k
    if d.by_torque == 0.0:
        return t.direction * (i - k * k * g)
    # at constant energy
    return t.direction * (d.J1 + i + k * b) / math.sqrt(inertia_of_link1(d, i, b, g))


def find_largest(d, t, which, start, length):
    """Drive angle in start to start + length where it is largest, and how large."""
    looks = int(math.ceil(length * d.harmonic / TWO_PI * LOOKS_PER_CYCLE)) + 2
    width = length / looks
    best_q = start
    best = value_at(d, t, which, start)
    before = best
    here = value_at(d, t, which, start + width)
    for n in range(1, looks + 1):
        after = value_at(d, t, which, start + (n + 1) * width)
        if here >= before and here >= after:
            # the top of the parabola through the three is near: only a promising one is looked at
            curve = before - 2.0 * here + after
            top = here - (after - before) ** 2 / (8.0 * curve) if curve < 0.0 else here
            if top + 0.1 * (top - here) > best:
                low = start + (n - 1) * width
                q, value = refine_largest(d, t, which, low, low + 2.0 * width)
                if value > best:
                    best = value
                    best_q = q
        before = here
        here = after
    return best_q, best


def refine_largest(d, t, which, low, high):
    """Largest value between low and high by golden sections."""
    golden = 0.6180339887498949
    inner = high - golden * (high - low)
    outer = low + golden * (high - low)
    value_inner = value_at(d, t, which, inner)
    value_outer = value_at(d, t, which, outer)
    for _ in range(GOLDEN_LOOKS):
        if value_inner > value_outer:
            high = outer
            outer = inner
            value_outer = value_inner
            inner = high - golden * (high - low)
            value_inner = value_at(d, t, which, inner)
        else:
            low = inner
            inner = outer
            value_inner = value_outer
            outer = low + golden * (high - low)
            value_outer = value_at(d, t, which, outer)
    if value_inner > value_outer:
        return inner, value_inner
    return outer, value_outer


def period_of_map(d):
    """Angle of the drive in which everything comes back, rad."""
    # with three or more satellites the drive's own turn leaves nothing in the reduced inertia
    return TWO_PI / d.s if d.paired == 0.0 and d.planar == 0.0 else d.period


def parts_of_period(d, cycles):
    """Length, rad, and number of the parts that stand for a long period, of so many cycles together.

    The satellite meets the drive at every relative phase, evenly, so turns of the drive at evenly
    spread phases are as good as all turns of the period. Where a turn itself is long, parts of it.
    """
    part = min(TWO_PI, cycles / PARTS * TWO_PI / d.harmonic)
    return part, int(cycles * TWO_PI / (d.harmonic * part))


def is_long(d):
    """Tell whether the period is one to be taken by parts."""
    return period_of_map(d) * d.harmonic > TWO_PI * LARGEST_CYCLES


def go_to_part(d, phase, part, parts, n):
    """Set the relative phase of part n. Returns the drive angle where it begins."""
    d.phase_b = phase + n * (TWO_PI / parts)
    return n * (TWO_PI / parts) if part < TWO_PI else 0.0


def find_largest_anywhere(d, t, which):
    """Where it is largest in the whole period (or its parts): drive angle, relative phase, and how large."""
    phase = d.phase_b
    if not is_long(d):
        q, value = find_largest(d, t, which, 0.0, period_of_map(d))
        return q, phase, value
    part, parts = parts_of_period(d, LARGEST_CYCLES)
    best_q = 0.0
    best_phase = phase
    best = -1e300
    for n in range(parts):
        q, value = find_largest(d, t, which, go_to_part(d, phase, part, parts, n), part)
        if value > best:
            best = value
            best_q = q
            best_phase = d.phase_b
    d.phase_b = phase
    return best_q, best_phase, best
