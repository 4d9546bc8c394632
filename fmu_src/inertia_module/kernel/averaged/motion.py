"""Steady motion of links 1 and 2 with the output speed held: what the averaged map is made of.

The drive angle q is the variable. Each contact mode has its integrals, which only the torque of link 1
changes, so the speeds follow from q, and dt = dq / q'. Behind a shaft of held speed link 2 is kept at that
speed while it drives, as it is kept at rest while the housing holds it, and the torque F of :mod:`..links`
passes through it. The drive travels one way: where it comes to rest in link 1 there is no such motion.

An instant is (omega1, omega2, alpha1, alpha2, omega2'', F, F'); t is the motion in hand (fields.TRAVEL).
"""

import math

from ..codes import DRIVING, FREE, HELD
from ..links import kinetic_energy
from .falls import LINK2_GUARD, first_fall
from .instants import instant, instant_after, integrals_after, take_integrals

# phase of the highest harmonic within one interval, rad
INTERVAL_PHASE = 1.0
# share of the distance to the nearest singularity of 1/q' that an interval may cover, and the least interval
SINGULAR_SHARE = 0.3
SHORTEST = 1e-6
# slip below this fraction of the speeds: the drive comes to rest in link 1
AT_REST = 1e-9
# share of the angle to travel that is travelled at least before a freewheel switches, and after how many
# switches in a row that is doubled: rounding alone makes them
LEAST = 1e-12
SWITCHES = 8.0

# four-point Lobatto rule on [0, 1]: ends and two inner nodes
LOBATTO_NODE = 0.27639320225002106
LOBATTO_END = 1.0 / 12.0
LOBATTO_INNER = 5.0 / 12.0


def add_node(d, t, q, at, weight):
    """Add one node of the quadrature, which stands for so much angle travelled, to the sums."""
    omega1, omega2, _, _, _, torque, _ = at
    torque = max(torque, 0.0) if t.mode == DRIVING else 0.0
    slip = abs(omega1 - omega2)
    if t.mode == FREE and t.direction > 0.0:
        slip = max(slip, omega1 - t.omega3)  # (link 2 is no faster than the output, but for rounding)
    time = weight / (d.k * slip)
    d.sum_time += time
    d.sum_torque += time * torque
    d.sum_square += time * torque * torque
    d.sum_energy += time * kinetic_energy(d, q, omega1, omega2, 0.0)
    d.sum_omega1 += time * omega1
    d.sum_omega2 += time * omega2
    d.sum_peak = max(d.sum_peak, torque)


def add_interval(d, t, here, end, length):
    """Add the interval between two instants to the sums by Lobatto's rule of four points."""
    add_node(d, t, t.q, here, LOBATTO_END * length)
    for n in range(2):
        node = (LOBATTO_NODE if n == 0 else 1.0 - LOBATTO_NODE) * length
        inside = instant_after(d, t, here, node)
        add_node(d, t, t.q + t.direction * node, inside, LOBATTO_INNER * length)
    add_node(d, t, t.q + t.direction * length, end, LOBATTO_END * length)


def smooth_length(d, at, slope_before, length):
    """How far 1/q' stays smooth: where q' is least it has poles next to the angle.

    Args:
        slope_before: of the square of the slip, by q, at the beginning of the last interval, of this length.

    Returns:
        (length, slope now).
    """
    omega1, omega2, alpha1, alpha2, jerk2, _, _ = at
    slip = abs(omega1 - omega2)
    slope = 2.0 * (alpha1 - alpha2) / d.k
    # the rate of alpha1 by difference, that of alpha2 is known
    curvature = 2.0 * abs(jerk2) / (d.k * d.k * slip)
    if length > 0.0:
        curvature = max(curvature, abs(slope - slope_before) / length)
    rate = math.sqrt(0.5 * curvature) + 0.5 * abs(slope) / slip
    return SINGULAR_SHARE * slip / rate if rate > 0.0 else 1e300, slope


def next_mode(t, fallen):
    """Contact mode after the fall of a guard; with the output at rest there is no free motion."""
    if t.mode == FREE:
        return HELD if fallen == LINK2_GUARD else DRIVING
    if t.omega3 != 0.0:
        return FREE
    return DRIVING if t.mode == HELD else HELD


def begin_travel(d, t, q):
    """Begin at the drive angle q, link 1 at speed 1 and link 2 at rest: held, or about to be thrown.

    Returns the instant.
    """
    t.q = q
    t.mode = HELD
    here = instant(d, t, q, t.direction, 0.0)
    if not here[5] < 0.0:
        t.mode = DRIVING if t.omega3 == 0.0 else FREE
        here = instant(d, t, q, t.direction, 0.0)
    take_integrals(d, t, t.direction, 0.0)
    return here


def travel(d, t, here, length, counted):
    """Let the drive travel from an instant at t.q so much angle, output speed held.

    Args:
        counted: whether the sums in d are to be added to.

    Returns:
        (whether it gets there: the drive does not come to rest in link 1, instant there).
    """
    start = t.q
    done = 0.0
    step = 0.0
    slope = 0.0
    least = shortest = LEAST * length
    switches = 0.0
    while done < length:
        smooth, slope = smooth_length(d, here, slope, step)
        step = min(INTERVAL_PHASE / d.harmonic, length - done)
        if t.mode == FREE or d.by_torque != 0.0:
            step = min(step, max(smooth, SHORTEST * INTERVAL_PHASE / d.harmonic))
        end = instant_after(d, t, here, step)
        fall, fallen = first_fall(d, t, here, end, step)
        if fall < 0.0:
            least = shortest
            switches = 0.0
        else:
            switches += 1.0
            if switches > SWITCHES and fall < least:
                least *= 2.0
            step = max(fall, min(least, max(step, shortest)))
            end = instant_after(d, t, here, step)
        if not t.direction * (end[0] - end[1]) > AT_REST * (abs(end[0]) + abs(end[1])):
            return False, here
        if counted:
            add_interval(d, t, here, end, step)
        t.energy, t.momentum = integrals_after(d, t, here, t.direction * step)
        done += step
        t.q = start + t.direction * done
        here = end
        if fall >= 0.0:
            t.mode = next_mode(t, fallen)
            omega2 = t.omega3 if t.mode == DRIVING else 0.0
            here = instant(d, t, t.q, end[0], end[1] if t.mode == FREE else omega2)
            take_integrals(d, t, here[0], here[1])
            step = 0.0
    return True, here
