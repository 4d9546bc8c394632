"""Steady motion of links 1 and 2 with the output speed held: what the averaged map is made of.

The drive angle q is the variable. Each contact mode has its integrals, which only the torque of link 1 changes,
so the speeds follow from q, and dt = dq / q'. Behind a shaft of held speed link 2 is kept at that speed while it
drives, as it is kept at rest while the housing holds it, and the torque F of :mod:`..links` passes through it.
The drive travels one way: where it comes to rest in link 1 there is no such motion.

An instant is (omega1, omega2, alpha1, alpha2, omega2'', F, F'); t is the motion in hand (fields.TRAVEL).
"""

import math

from ..codes import DRIVING, FREE, HELD
from ..inertia import reduced_inertia
from ..links import kinetic_energy, motion
from ..search import next_look, stays_positive

# phase of the highest harmonic within one interval, rad
INTERVAL_PHASE = 1.0
# share of the distance to the nearest singularity of 1/q' that an interval may cover, and the least interval
SINGULAR_SHARE = 0.3
SHORTEST = 1e-6
DIP_LOOKS = 8
# share of an interval within which a fall is found; it is taken just past, so that the next mode holds
NEAR = 1e-9
ROOT_LOOKS = 60
# slip below this fraction of the speeds: the drive comes to rest in link 1
AT_REST = 1e-9
LEAST_SQUARE = 1e-24

# four-point Lobatto rule on [0, 1]: ends and two inner nodes
LOBATTO_NODE = 0.27639320225002106
LOBATTO_END = 1.0 / 12.0
LOBATTO_INNER = 5.0 / 12.0

# guards of the mode in hand, positive while it goes on
TORQUE_GUARD = 0  # held: F < 0; driving: F > 0
LINK2_GUARD = 1  # free: omega2 > 0
OUTPUT_GUARD = 2  # free: omega2 < omega3


def take_integrals(d, t, omega1, omega2):
    """Set the integrals of the mode in hand by the speeds at t.q.

    Free: Jacobi's integral C = H r - I of the slip r = (omega1 - omega2)^2, H = J2 + k^2 G, with omega1 constant;
    else 2 E and the angular momentum P. Link 2 of constant speed u: 2 (E - u P), and omega1 where it is given.
    """
    i, _, _, b, _, g, _, _ = reduced_inertia(d, t.q)
    slip = omega1 - omega2
    if d.by_torque == 0.0:
        t.energy = (d.J2 + d.k * d.k * g) * slip * slip - i
        return
    own = d.J1 + i
    t.momentum = own * omega1 + b * d.k * slip + d.J2 * omega2
    if t.mode == FREE:
        t.energy = 2.0 * kinetic_energy(d, t.q, omega1, omega2, 0.0)
    else:
        phi = own + d.k * (2.0 * b + d.k * g)
        t.energy = phi * slip * slip - (own + d.J2) * omega2 * omega2


def speeds_at(d, t, q, energy, momentum):
    """Speeds of both links by the integrals of the mode in hand, and the square of the slip, below 0 if there is none."""
    i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
    k = d.k
    own = d.J2 + k * k * g
    kept = t.omega3 if t.mode == DRIVING else 0.0
    link1 = d.J1 + i
    d.map_evaluations += 1.0
    if d.by_torque == 0.0:
        if t.mode != FREE:
            return t.direction, kept, (t.direction - kept) * (t.direction - kept)
        square = (energy + i) / own
        return t.direction, t.direction * (1.0 - signed_root(square)), square
    if t.mode != FREE:
        square = (energy + (link1 + d.J2) * kept * kept) / (link1 + k * (2.0 * b + k * g))
        return kept + t.direction * signed_root(square), kept, square
    # 2 E = P^2 / a + (own - c^2 / a) slip^2 with the coefficients of omega1^2 and omega1 times the slip
    a = link1 + d.J2
    c = k * b - d.J2
    square = (energy - momentum * momentum / a) / (own - c * c / a)
    slip = t.direction * signed_root(square)
    omega1 = (momentum - c * slip) / a
    return omega1, omega1 - slip, square


def signed_root(square):
    """Root of the size of a square, with its sign."""
    return math.copysign(math.sqrt(abs(square)), square)


def integrals_after(d, t, here, angle):
    """The integrals so much drive angle further: the torque of link 1 adds M1 theta1 to E and M1 t to P."""
    if d.by_torque == 0.0 or t.given == 0.0:
        return t.energy, t.momentum
    if t.mode != FREE:
        return t.energy + 2.0 * t.given * angle / d.k, t.momentum
    # by the midpoint
    part = t.given * angle / d.k
    slip = here[0] - here[1]
    energy = t.energy + part * here[0] / slip
    momentum = t.momentum + 0.5 * part / slip
    omega1, _, square = speeds_at(d, t, t.q + 0.5 * angle, energy, momentum)
    slip = t.direction * math.sqrt(max(square, LEAST_SQUARE))
    return t.energy + 2.0 * part * omega1 / slip, t.momentum + part / slip


def instant(d, t, q, omega1, omega2):
    """Accelerations and the torque that passes link 2, which is kept at its speed in all modes but the free."""
    d.map_evaluations += 1.0
    alpha1, alpha2, jerk2, torque, torque_rate, _ = motion(
        d, q, omega1, omega2, t.given, t.mode != FREE, 0.0, 0.0, 0.0
    )
    return omega1, omega2, alpha1, alpha2, jerk2, torque, torque_rate


def instant_after(d, t, here, length):
    """Instant so much angle travelled after this one, at t.q."""
    angle = t.direction * length
    energy, momentum = integrals_after(d, t, here, angle)
    omega1, omega2, _ = speeds_at(d, t, t.q + angle, energy, momentum)
    return instant(d, t, t.q + angle, omega1, omega2)


def guard(d, t, which, at):
    """A guard and its rate per angle travelled."""
    omega1, omega2, alpha1, alpha2, _, torque, torque_rate = at
    slip = omega1 - omega2
    per_angle = 1.0 / (d.k * max(abs(slip), 1e-300))
    if which == LINK2_GUARD:
        return omega2, alpha2 * per_angle
    if which == OUTPUT_GUARD:
        # of the squares, which stay smooth where the slip vanishes
        least = omega1 - t.omega3
        rate = 2.0 * ((alpha1 - alpha2) / d.k - abs(least) * alpha1 * per_angle)
        return slip * abs(slip) - least * abs(least), rate
    if t.mode == HELD:
        return -torque, -torque_rate * per_angle
    return torque, torque_rate * per_angle


def find_dip(d, t, which, here, end, length):
    """Angle travelled to where the guard is negative, or -1 if it is not within length."""
    low = 0.0
    high = length
    value0, rate0 = guard(d, t, which, here)
    value0 = max(value0, 0.0)
    value1, rate1 = guard(d, t, which, end)
    for _ in range(DIP_LOOKS):
        if stays_positive(value0, rate0, value1, rate1, high - low):
            return -1.0
        look = next_look(low, rate0, high, rate1)
        value, rate = guard(d, t, which, instant_after(d, t, here, look))
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


def find_fall(d, t, which, here, length):
    """Angle travelled to where the guard falls through zero; it is negative at length."""
    low = 0.0
    high = length
    look = length
    value, rate = guard(d, t, which, instant_after(d, t, here, look))
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
        value, rate = guard(d, t, which, instant_after(d, t, here, look))
        if value < 0.0:
            high = look
        else:
            low = look
    return high


def fall_inside(d, t, which, here, end, length):
    """Angle travelled to the first fall of a guard between two instants, or -1."""
    value, _ = guard(d, t, which, end)
    if value >= 0.0:
        length = find_dip(d, t, which, here, end, length)
        if length < 0.0:
            return -1.0
    return find_fall(d, t, which, here, length)


def first_fall(d, t, here, end, length):
    """First fall of a guard of the mode between two instants: (angle travelled or -1, which guard)."""
    which = LINK2_GUARD if t.mode == FREE else TORQUE_GUARD
    fall = fall_inside(d, t, which, here, end, length)
    if t.mode != FREE:
        return fall, which
    # the other guard is looked at up to the fall of the first
    if fall >= 0.0:
        length = fall
        end = instant_after(d, t, here, length)
    other = fall_inside(d, t, OUTPUT_GUARD, here, end, length)
    if other >= 0.0:
        return other, OUTPUT_GUARD
    return fall, which


def add_node(d, t, q, at, weight):
    """Add one node of the quadrature, which stands for so much angle travelled, to the sums."""
    omega1, omega2, _, _, _, torque, _ = at
    torque = max(torque, 0.0) if t.mode == DRIVING else 0.0
    time = weight / (d.k * abs(omega1 - omega2))
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
    bend = 2.0 * abs(jerk2) / (d.k * d.k * slip)
    if length > 0.0:
        bend = max(bend, abs(slope - slope_before) / length)
    rate = math.sqrt(0.5 * bend) + 0.5 * abs(slope) / slip
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
    while done < length:
        smooth, slope = smooth_length(d, here, slope, step)
        step = min(INTERVAL_PHASE / d.harmonic, length - done)
        if t.mode == FREE or d.by_torque != 0.0:
            step = min(step, max(smooth, SHORTEST * INTERVAL_PHASE / d.harmonic))
        end = instant_after(d, t, here, step)
        fall, fallen = first_fall(d, t, here, end, step)
        if fall >= 0.0:
            step = max(fall, 1e-12 * length)
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
