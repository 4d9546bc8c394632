"""Mean torque over speed ratio, found once: the map of fidelity averaged (docs/mechanics.md).

Without gravity all scales with one speed v. With the speed of link 1 given that is omega1, and the mean
output torque is v^2 F(s), s = omega3 / |v|, with one F for either sign. With its torque given omega1 swings
within a pulse and the energy E of links 1, 2 and imbalances hardly changes: v is that of E = J* v^2 / 2, and
the mean of omega1 is v g(s). The steady motion is found by motion.travel over one period of q, with the mean
input torque that keeps E. It begins where link 2 surely rests: its angular momentum rises only in the
housing, so where it could be largest link 2 is held if any torque is passed at all.

With omega1 > 0 no torque is passed above ratio 1: the housing can only push forward, and its mean torque is
Tc (1 - sigma).
"""

import math

from ..codes import FREE, NOT_STEADY, OK
from .instants import speeds_at, take_integrals
from .largest import (
    LARGEST_CYCLES,
    LOCK,
    MOMENTUM,
    THROWN,
    find_largest,
    find_largest_anywhere,
    go_to_part,
    is_long,
    parts_of_period,
    period_of_map,
)
from .losses import SLOWNESSES, crawl, set_losses, settle_losses, slow_speed
from .map_key import is_map_of, mark_map
from .motion import begin_travel, travel
from .table import UNKNOWN_ERROR, error_at_speeds, finish_table, insert_knot, table_error, worst_interval

# the map is refined until its error, in stall torques, is below this at the middle of each interval
MAP_ERROR = 1e-4
# ... under its torque, where the averaged motion itself is no better
MAP_ERROR_BY_TORQUE = 5e-4
# ... and with losses, where a knot costs four motions more
LOSSY_MAP_ERROR = 2e-4
# three or more
FIRST_KNOTS = 9
# the last ratio below lock-up
LAST_SLIP = 1e-6
# evaluations of the mechanism after which one sign of omega1 is refined no more
MOST_EVALUATIONS = 1.5e6
# the motion begins so much phase of the highest harmonic before, under a torque that moves where link 2 is
# thrown
HEAD_START = 0.5
# rounds to find the input torque that keeps the energy, and what is left of it
ROUNDS = 8
KEPT = 1e-5
# to find the fastest output, over the speed that link 1 begins with, that the drive gets past
FASTEST = 1.2
BISECTIONS = 14
# share of the ratio in which the torque goes to zero at least, where the pulses fail at once
RAMP = 0.02


def add_part(d, t, start, warm, length):
    """Travel one part of the period from rest at start; the first angle warm is not counted.

    Returns whether the drive gets through.
    """
    here = begin_travel(d, t, start)
    if warm > 0.0:
        through, here = travel(d, t, here, warm, False)
        if not through:
            return False
    through, here = travel(d, t, here, length, True)
    return through


def head_start(d):
    """Angle before that of the largest momentum where the motion begins, rad."""
    return HEAD_START / d.harmonic if d.by_torque != 0.0 else 0.0


def add_period(d, t, side):
    """Add the steady motion at the output speed t.omega3 to the sums, cleared before.

    Returns whether the drive gets through.
    """
    d.sum_time = 0.0
    d.sum_torque = 0.0
    d.sum_square = 0.0
    d.sum_energy = 0.0
    d.sum_omega1 = 0.0
    d.sum_omega2 = 0.0
    d.sum_peak = 0.0
    direction = t.direction
    if not is_long(d):
        return add_part(d, t, side.start - direction * head_start(d), 0.0, period_of_map(d))
    # half of the angle allowed goes to reach the steady motion
    part, parts = parts_of_period(d, 0.5 * LARGEST_CYCLES)
    phase = d.phase_b
    through = True
    for n in range(parts):
        begin = go_to_part(d, phase, part, parts, n)
        low = begin - part if direction > 0.0 else begin
        start, _ = find_largest(d, t, MOMENTUM, low, part)
        start -= direction * head_start(d)
        through = through and add_part(d, t, start, direction * (begin - start), part)
    d.phase_b = phase
    return through


def settle(d, t, side, omega3):
    """Add the steady motion at this output speed, with the input torque that keeps its energy.

    Returns whether there is one.
    """
    t.omega3 = omega3
    t.prescribed = 0.0
    if d.by_torque == 0.0:
        return add_period(d, t, side)
    for _ in range(ROUNDS):
        if not add_period(d, t, side):
            return False
        before = t.prescribed
        t.prescribed = omega3 * d.sum_torque / d.sum_omega1
        if abs(t.prescribed - before) <= KEPT * abs(t.prescribed):
            break
    return True


def speed_of_energy(d):
    """The speed v that all scales with, of the motion in the sums, link 1 having begun with speed 1."""
    if d.by_torque == 0.0:
        return 1.0
    return math.sqrt(2.0 * d.sum_energy / (d.sum_time * d.map_inertia))


def find_end(d, t, side):
    """Output speeds: up to which there is a steady motion, and above which no torque is passed.

    Where it begins, and whether link 2 comes up to link 1, is left in the side.
    """
    t.prescribed = 0.0
    phase = d.phase_b
    side.start, d.phase_b, _ = find_largest_anywhere(d, t, MOMENTUM)
    t.q = side.start
    t.mode = FREE
    take_integrals(d, t, t.direction, 0.0)
    d.phase_b = phase
    q, d.phase_b, end = find_largest_anywhere(d, t, THROWN)
    square = speeds_at(d, t, q, t.energy, t.momentum)[2]
    d.phase_b = phase
    locks = t.direction > 0.0 and square < LAST_SLIP * LAST_SLIP
    side.locks = 1.0 if locks else 0.0
    if d.by_torque == 0.0:
        # with losses link 2 may be faster than what it is thrown with
        end = 1.0 if locks or (d.lossy != 0.0 and t.direction > 0.0) else max(end, 0.0)
        return end, end
    # light as link 1 may be, the drive has to get past the output: the torque that keeps the energy only
    # helps
    t.omega3 = max(end, 0.0)
    end = t.omega3
    if not locks and add_period(d, t, side):
        return end, end
    low = 0.0
    high = FASTEST if locks else t.omega3
    for _ in range(BISECTIONS):
        t.omega3 = 0.5 * (low + high)
        if add_period(d, t, side):
            low = t.omega3
        else:
            high = t.omega3
    return low, end


def add_knot(p, d, w, side, n, omega3):
    """Find the knot at this output speed and insert it as number n, where its ratio belongs there."""
    locks = d.by_torque == 0.0 and side.locks != 0.0
    fastest = 1.0 - LAST_SLIP if locks or (d.lossy != 0.0 and side.direction > 0.0) else omega3
    held = min(omega3, fastest)
    settle(d, d.travel, side, held)
    v = speed_of_energy(d)
    time = d.sum_time
    ratio = omega3 / v
    count = int(side.count)
    falls = n > 0 and ratio <= side.knots[n - 1].ratio
    if falls or (n < count and ratio >= side.knots[n].ratio):
        # behind a link 1 so light the ratio does not follow the speed of the output: the table goes past this
        # one
        side.knots[n - 1].error = 0.0
        return
    # mean energy of links 1 and 2 without J1, or the mean speed of link 1
    input1 = 2.0 * d.sum_energy / time - d.J1 if d.by_torque == 0.0 else abs(d.sum_omega1) / (time * v)
    if d.lossy != 0.0:
        settle_losses(p, d, w, side, held, 0.0)
        time = d.sum_time
    torque = d.sum_torque / (time * v * v)
    variance = d.sum_square / (time * v**4) - torque * torque
    omega2 = min(max(0.0, d.sum_omega2 / (time * v)), ratio)
    error = table_error(side, n - 1, ratio, torque, input1, omega2) if n < count else UNKNOWN_ERROR
    insert_knot(
        side, n, ratio, torque, input1, omega2, math.sqrt(max(variance, 0.0)), d.sum_peak / (v * v), error
    )
    side.knots[n].omega3 = omega3
    if d.lossy != 0.0:
        add_losses(p, d, w, side, side.knots[n], held)
        if n < count and side.slow != 0.0:
            error = 0.5 * error_at_speeds(side, n, len(SLOWNESSES) - 2)
            side.knots[n].error = max(side.knots[n].error, error)
            side.knots[n - 1].error = max(side.knots[n - 1].error, error)


def add_losses(p, d, w, side, knot, held):
    """Find what losses leave at this knot, those without friction and drag being in the sums."""
    for cause in range(len(knot.lost)):
        knot.lost[cause] = d.sum_lost[cause] / d.sum_time
    if side.slow == 0.0:
        return
    for m in range(len(SLOWNESSES)):
        slower = knot.slower[m]
        settle_losses(p, d, w, side, held, SLOWNESSES[m] / side.slow)
        slower.torque[0] = d.sum_torque / d.sum_time
        slower.omega2[0] = min(max(0.0, d.sum_omega2 / d.sum_time), knot.ratio)
        for cause in range(len(knot.lost)):
            slower.lost[cause] = d.sum_lost[cause] / d.sum_time
    crawl(p, d, side, knot)


def end_map(d, side, end):
    """End the map where no torque is passed any more, at the speed end, or in lock-up.

    From the last knot to there is no steady motion under the torque of link 1: the drive comes to rest in
    link 1, at the torque it had there; or the pulses fail that brought the energy of the next, and the torque
    goes to zero.
    """
    count = int(side.count)
    last = side.knots[count - 1]
    if side.locks != 0.0:
        if d.by_torque != 0.0:
            # there both turn alike, faster than link 1 on average before where it is light
            ratio = max(last.input[0], last.ratio * (1.0 + LAST_SLIP))
            insert_knot(side, count, ratio, last.torque[0], ratio, ratio, last.ripple, last.peak, 0.0)
    elif d.by_torque != 0.0 and last.torque[0] > MAP_ERROR * side.knots[0].torque[0]:
        v = last.omega3 / last.ratio if last.ratio > 0.0 else 1.0
        ratio = max(end / v, last.ratio * (1.0 + RAMP))
        insert_knot(side, count, ratio, 0.0, last.input[0], last.omega2[0], 0.0, 0.0, 0.0)
    elif d.lossy == 0.0:
        last.torque[0] = 0.0
        last.ripple = 0.0
        last.peak = 0.0


def build_side(p, d, w, side, direction):
    """Knots for one sign of omega1, refined where the table is worst."""
    for n in range(len(side.numbers)):
        side.numbers[n] = 0.0
    t = d.travel
    t.direction = direction
    side.direction = direction
    last_speed, end = find_end(d, t, side)
    if d.map_inertia == 0.0:
        settle(d, t, side, 0.0)
        d.map_inertia = 2.0 * d.sum_energy * d.sum_time / (d.sum_omega1 * d.sum_omega1)
    if d.lossy != 0.0:
        settle(d, t, side, 0.0)
        side.slow = slow_speed(p, d, d.sum_torque / d.sum_time)
    allowed = MAP_ERROR if d.by_torque == 0.0 else MAP_ERROR_BY_TORQUE
    if d.lossy != 0.0:
        allowed = LOSSY_MAP_ERROR
    last = FIRST_KNOTS - 1 if end > 0.0 else 0
    for n in range(last + 1):
        add_knot(p, d, w, side, int(side.count), n * last_speed / max(last, 1))
    end_map(d, side, end)
    d.map_evaluations = 0.0
    while side.count < len(side.knots) and end > 0.0 and d.map_evaluations < MOST_EVALUATIONS:
        n, error = worst_interval(side)
        if error < allowed:
            break
        add_knot(p, d, w, side, n + 1, 0.5 * (side.knots[n].omega3 + side.knots[n + 1].omega3))
    finish_table(side)
    side.end = side.knots[int(side.count) - 1].ratio


def build_map(p, d, w):
    """Fill d with the map of these parameters, unless it is there; w: workspace.

    Returns:
        Status: OK, or NOT_STEADY where no steady motion with losses is found.
    """
    if is_map_of(p, d):
        return OK
    d.map_ready = 0.0
    d.map_failed = 0.0
    d.map_inertia = 0.0
    t = d.travel
    _, _, lock = find_largest_anywhere(d, t, LOCK)
    d.map_lock = max(0.5 * d.k * lock, 0.0)
    set_losses(p, d, 0.0)
    build_side(p, d, w, d.forward, 1.0)
    build_side(p, d, w, d.backward, -1.0)
    set_losses(p, d, 1.0)
    if d.map_failed != 0.0:
        return NOT_STEADY
    mark_map(p, d)
    return OK
