"""Mean torque over speed ratio, found once: the map of fidelity averaged (docs/mechanics.md).

Without friction and gravity all scales with one speed v. With the speed of link 1 given that is omega1, and
the mean output torque is v^2 F(s), s = omega3 / |v|, with one F for either sign. With its torque given omega1
swings within a pulse and the energy E of links 1, 2 and imbalances hardly changes: v is that of
E = J* v^2 / 2, and the mean of omega1 is v g(s).

What friction b and drag D take of a motion goes with b / |v| and D / v^2. So torques are over V^2 instead,
V = |v| + V0, V0 the speed at which friction and drag would take the stall torque: to first order, and where
links crawl and friction alone counts, they are parabolas of the slowness V0 / V, which goes from 0 without
bound to 1 at rest. Between the slownesses of table.SLOWNESS they are cubics. Friction of link 1, its speed
given, and of the output needs no map.

With omega1 > 0 no torque is passed above ratio 1: the housing can only push forward, and its mean torque is
Tc (1 - sigma).
"""

import math

from ..accumulate import clear, copy
from ..codes import NOT_STEADY, OK
from ..equations.losses import FREEWHEEL, MESH, VISCOUS
from ..links import inertia_at_input
from . import steady, table

# the map is refined until its error, in stall torques, is below this at the middle of each interval
MAP_ERROR = 1e-4
# ... under its torque, where the averaged motion itself is no better
MAP_ERROR_BY_TORQUE = 5e-4
# ... and with losses, where a knot costs six motions more
LOSSY_MAP_ERROR = 2e-4
# three or more
FIRST_KNOTS = 9
# the last ratio below lock-up
LAST_SLIP = 1e-6
# evaluations of the mechanism after which one sign of omega1 is refined no more, nor by its slowest motions
ENOUGH_EVALUATIONS = 1e7
# the fastest output that the drive may get past under the torque of link 1, over that which it comes to rest
# at, and how near it is looked for
FASTEST = 1.2
SHORTEST = 1e-4
# share of the ratio in which the torque goes to zero at least, where the pulses fail at once
RAMP = 0.02
# ... share of the last ratio from which on links with play may stick together before lock-up, for good
NEARLY = 0.9
# the first motion of links that crawl
CRAWLING = table.MOTIONS - 2
# 1 - slowness of links that rest, where drag decides before friction
REST = 1e-12
# share of the largest torque that stands for a stall torque of nothing
LEAST_STALL = 0.01


def slow_speed(p, d, stall):
    """Input speed, rad/s, at which friction and drag would take the stall torque, stall omega1^2; 0: none."""
    viscous = p.link2_friction + p.housing_drag_viscous + p.output_drag_viscous + d.k * d.k * p.drive_friction
    if d.by_torque != 0.0:
        viscous += p.input_friction
    drag = p.housing_drag + p.output_drag
    stall = max(stall, LEAST_STALL * d.F_by_speed)
    if not stall > 0.0:
        return 0.0
    return (viscous + math.sqrt(viscous * viscous + 4.0 * stall * drag)) / (2.0 * stall)


def rub(d, knot, m, omega1, omega2):
    """Write what friction and drag take from links that turn evenly as the losses of motion m of the knot.

    Args:
        d: constants with friction and drag as at the speed V0. omega1, omega2: speeds over v.

    Returns:
        Their sum.
    """
    slip = omega1 - omega2
    over = knot.ratio - omega2
    for place in range(m, len(knot.lost), table.MOTIONS):
        knot.lost[place] = 0.0
    z = table.SLOWNESS[m]
    linear = z * (1.0 - z)
    viscous = d.b1 * omega1 * omega1 + d.bq * ((d.k * slip) * (d.k * slip)) + d.b2 * omega2 * omega2
    knot.lost[table.MOTIONS * VISCOUS + m] = linear * viscous
    knot.lost[table.MOTIONS * MESH + m] = linear * d.mesh_loss * pulled(d) * slip * slip
    drag = linear * (d.housing_drag_viscous * omega2 * omega2 + d.output_drag_viscous * over * over)
    drag += z * z * (d.housing_drag * omega2 + d.output_drag * over)
    knot.lost[table.MOTIONS * FREEWHEEL + m] = drag
    return linear * viscous + knot.lost[table.MOTIONS * MESH + m] + drag


def pulled(d):
    """Torque of the mesh at links that crawl, over their slip, N m s."""
    return d.k * d.k * d.bq / (1.0 - d.mesh_loss)


def crawl(p, d, side, knot, m):
    """Write motion m of the knot for links so slow that friction and drag alone count: omega2 is constant."""
    steady.set_losses(p, d, 1.0 / side.slow)
    ratio = knot.ratio
    z = table.SLOWNESS[m]
    fast = max(1.0 - z, REST)
    pulling = pulled(d)
    resisting = pulling + d.b2 + d.housing_drag_viscous
    # link 2 rests, is taken along by the output, or turns between where its torques balance
    turning = fast * (side.direction * pulling + d.output_drag_viscous * ratio)
    turning += z * (d.output_drag - d.housing_drag)
    resistance = fast * (resisting + d.output_drag_viscous)
    omega2 = min(max(turning, 0.0) / (resistance + 1e-300), ratio)
    viscous, drag = -d.output_drag_viscous * (ratio - omega2), d.output_drag
    if ratio == 0.0:
        viscous, drag = max(side.direction * pulling, 0.0), 0.0
    elif omega2 == ratio:
        viscous, drag = side.direction * pulling - resisting * ratio, d.housing_drag
    knot.value[table.TORQUE + m] = z * ((1.0 - z) * viscous - z * drag)
    knot.value[table.OMEGA2 + m] = omega2
    rub(d, knot, m, side.direction, omega2)


def find_end(d, side):
    """Speed ratios: up to which a steady motion is looked for, and above which no torque is passed.

    Whether link 2 comes up to link 1 is left in the side.
    """
    locks = side.direction > 0.0 and -steady.find_largest(d, side, steady.NEAREST)[1] < LAST_SLIP * LAST_SLIP
    side.locks = 1.0 if locks else 0.0
    end = max(steady.find_largest(d, side, steady.THROWN)[1], 0.0)
    # with losses link 2 may be faster than what it is thrown with
    faster = d.lossy != 0.0 and side.direction > 0.0
    if d.by_torque == 0.0:
        end = 1.0 if locks or faster else end
        return end, end
    if faster and not locks:
        end = max(end, 1.0)
    # light as link 1 may be, the drive has to get past the output
    return FASTEST * end if locks else end, end


def add_knot(p, d, w, side, n, ratio):
    """Find the knot at this ratio and insert it as number n. Returns whether there is a steady motion."""
    held = ratio
    if d.by_torque == 0.0 and side.direction > 0.0:
        held = min(ratio, 1.0 - LAST_SLIP)
    count = int(side.count)
    knot = w.knot
    foresee(w, side, n, held)
    found = steady.find_steady(p, w, side, held, 0.0)
    if found:
        # very nearly this one
        knot.ratio = ratio / write_steady(d, w, knot)
        found = n == 0 or knot.ratio > side.knots[n - 1].ratio
        found = found and (n == count or knot.ratio < side.knots[n].ratio)
        if count == 0 and d.lossy != 0.0:
            side.slow = slow_speed(p, d, knot.value[table.TORQUE])
    if found and side.slow != 0.0:
        found = add_slower(p, d, w, side, knot, held)
    if not found:
        return False
    error = table.table_error(side, n - 1, knot) if n < count else table.UNKNOWN_ERROR
    table.insert_knot(side, n, knot, error)
    return True


def foresee(w, side, n, ratio):
    """Take how the motion of knot n begins, and its torque of link 1, from the line through the next two."""
    count = int(side.count)
    if count == 0:
        return
    a = side.knots[n - 1 if n < count else max(n - 2, 0)]
    b = side.knots[min(n, count - 1)]
    t = (ratio - a.ratio) / (b.ratio - a.ratio) if b.ratio > a.ratio else 0.0
    w.drive = a.drive + t * (b.drive - a.drive)
    w.begin_energy = max(a.begin_energy + t * (b.begin_energy - a.begin_energy), steady.LEAST_ENERGY)
    w.begin_omega2 = max(a.begin_omega2 + t * (b.begin_omega2 - a.begin_omega2), 0.0)


def write_means(w, knot, m, v):
    """Write mean torque, speed of link 2 and losses of the motion in the sums, its speed v, as motion m."""
    share = (1.0 - table.SLOWNESS[m]) * (1.0 - table.SLOWNESS[m])
    knot.value[table.TORQUE + m] = share * w.sum_torque / (w.sum_time * v * v)
    knot.value[table.OMEGA2 + m] = max(0.0, w.sum_omega2 / (w.sum_time * v))
    for cause in range(len(w.sum_lost)):
        knot.lost[table.MOTIONS * cause + m] = share * w.sum_lost[cause] / (w.sum_time * (v * (v * v)))


def write_steady(d, w, knot):
    """Write the motion in the sums into the knot. Returns its speed v."""
    v = steady.speed_of_sums(d, w)
    time = w.sum_time
    write_means(w, knot, 0, v)
    # mean energy of links 1 and 2 without J1, or the mean speed of link 1
    knot.value[table.INPUT] = 2.0 * w.sum_energy / time - d.J1
    if d.by_torque != 0.0:
        knot.value[table.INPUT] = abs(w.sum_omega1) / (time * v)
    mean = knot.value[table.TORQUE]
    variance = w.sum_square / (time * ((v * v) * (v * v))) - mean * mean
    knot.value[table.RIPPLE] = math.sqrt(max(variance, 0.0))
    knot.drive, knot.begin_energy, knot.begin_omega2 = w.drive, w.begin_energy, w.begin_omega2
    knot.value[table.PEAK] = w.sum_peak / (v * v)
    return v


def fill(knot, m, last, following):
    """Write motion m of the knot by parabolas of the slowness through the two last and a later motion."""
    z = table.SLOWNESS
    za, zb, zc = z[m] - z[last - 1], z[m] - z[last], z[m] - z[following]
    a = zb * zc / ((z[last - 1] - z[last]) * (z[last - 1] - z[following]))
    b = za * zc / ((z[last] - z[last - 1]) * (z[last] - z[following]))
    c = 1.0 - a - b
    value, lost = knot.value, knot.lost
    for curve in range(2):
        n = table.TORQUE if curve == 0 else table.OMEGA2
        value[n + m] = a * value[n + last - 1] + b * value[n + last] + c * value[n + following]
    value[table.OMEGA2 + m] = min(max(value[table.OMEGA2 + m], 0.0), knot.ratio)
    for n in range(0, len(lost), table.MOTIONS):
        lost[n + m] = a * lost[n + last - 1] + b * lost[n + last] + c * lost[n + following]


def add_slower(p, d, w, side, knot, held):
    """Find what friction and drag leave at this knot.

    Returns:
        Whether there are these steady motions. Slower than the table is refined for there may be none, or two
        that come in turns, and a link 2 that is light is stiff under drag: such motions are filled in.
    """
    # under its torque links at the lowest speed crawl: rounding decides whether there is a motion
    followed = CRAWLING - 1 if d.by_torque != 0.0 else CRAWLING
    needed = table.SLOWER if d.by_torque + d.plays != 0.0 else 2
    before = growth = 0.0
    if d.by_torque != 0.0:
        # the first torque that is tried keeps the speed against what friction takes of the ideal motion
        steady.set_losses(p, d, 1.0 / side.slow)
        omega1 = side.direction * knot.value[table.INPUT]
        z = table.SLOWNESS[1]
        growth = rub(d, knot, 1, omega1, knot.value[table.OMEGA2]) / (z * (1.0 - z) * omega1)
    found = followed
    for m in range(1, followed):
        slow = table.SLOWNESS[m] / (1.0 - table.SLOWNESS[m])
        given = w.drive
        w.drive += growth * (slow - before)
        worth = m < table.SLOWER or d.map_evaluations < ENOUGH_EVALUATIONS
        if not worth or not steady.find_steady(p, w, side, held, slow / side.slow):
            if m < needed:
                return False
            found = m
            break
        growth = (w.drive - given) / (slow - before)
        before = slow
        write_means(w, knot, m, steady.speed_of_sums(d, w))
        knot.value[table.OMEGA2 + m] = min(knot.value[table.OMEGA2 + m], knot.ratio)
    for m in range(followed, table.MOTIONS):
        crawl(p, d, side, knot, m)
    for m in range(found, followed):
        fill(knot, m, found - 1, followed)
    return True


def end_map(p, d, w, side, end):
    """End the map where no torque is passed any more, at the ratio end, or in lock-up.

    From the last knot to there is no steady motion under the torque of link 1: the drive comes to rest in
    link 1, at the torque it had there; or the pulses fail that brought the energy of the next, and the torque
    goes to zero.
    """
    count = int(side.count)
    last, knot = side.knots[count - 1], w.knot
    copy(knot.numbers, last.numbers)
    if side.locks != 0.0 or (d.by_torque == 0.0 and side.direction > 0.0 and last.ratio < end):
        if d.by_torque != 0.0 or last.ratio < end:
            # there both turn alike, faster than link 1 on average before where it is light
            knot.ratio = end
            if d.by_torque != 0.0:
                knot.ratio = max(last.value[table.INPUT], last.ratio * (1.0 + LAST_SLIP))
                knot.value[table.INPUT] = knot.ratio
            steady.set_losses(p, d, 1.0 / side.slow if side.slow > 0.0 else 0.0)
            for m in range(table.MOTIONS):
                knot.value[table.OMEGA2 + m] = knot.ratio
                rub(d, knot, m, knot.ratio, knot.ratio)
            table.insert_knot(side, count, knot, 0.0)
    elif d.by_torque != 0.0 and last.value[table.TORQUE] > MAP_ERROR * side.knots[0].value[table.TORQUE]:
        knot.ratio = max(end, last.ratio * (1.0 + RAMP))
        knot.value[table.TORQUE] = knot.value[table.RIPPLE] = knot.value[table.PEAK] = 0.0
        if side.slow != 0.0:
            for m in range(CRAWLING, table.MOTIONS):
                crawl(p, d, side, knot, m)
            for m in range(1, CRAWLING):
                # drag alone is left
                knot.value[table.TORQUE + m] = min(knot.value[table.TORQUE + m], 0.0)
        table.insert_knot(side, count, knot, 0.0)
    elif d.lossy == 0.0:
        last.value[table.TORQUE] = last.value[table.RIPPLE] = last.value[table.PEAK] = 0.0
    elif d.by_torque != 0.0 or side.direction < 0.0:
        for m in range(table.MOTIONS):
            last.value[table.TORQUE + m] = min(last.value[table.TORQUE + m], 0.0)


def add_first_knots(p, d, w, side, most):
    """Find knots from ratio 0 up to the last one at which there is a steady motion, at most this one.

    Returns:
        Whether there are any, and where the speed of link 1 is given all but those next to lock-up.
    """
    if not add_knot(p, d, w, side, 0, 0.0):
        return False
    ratio = 0.0
    step = most / (FIRST_KNOTS - 1)
    while ratio < most and 2.0 * side.count < len(side.knots):
        if step <= (SHORTEST if d.map_evaluations < ENOUGH_EVALUATIONS else RAMP) * most:
            break
        following = ratio + step if ratio + 1.5 * step < most else most
        if add_knot(p, d, w, side, int(side.count), following):
            ratio = following
        elif d.by_torque + d.plays == 0.0:
            return False
        else:
            step *= 0.5
    complete = d.by_torque != 0.0 or ratio >= NEARLY * most
    return complete and d.map_evaluations <= steady.MOST_EVALUATIONS


def extend(p, d, w, side):
    """Add knots as long as torque is passed: losses may hold link 2 until it is thrown faster.

    (Forwards none is passed beyond ratio 1, where the map ends already.)
    """
    n = int(side.count)
    least = MAP_ERROR * side.knots[0].value[table.TORQUE]
    while 1 < n and 2 * n < len(side.knots) and side.knots[n - 1].value[table.TORQUE] > least:
        last = side.knots[n - 1].ratio
        if not add_knot(p, d, w, side, n, 2.0 * last - side.knots[n - 2].ratio):
            return
        n += 1


def build_side(p, d, w, side, allowed):
    """Find knots for one sign of omega1, refined where the table is worst.

    Args:
        d: constants of the mechanism held. side: of d, with its direction. allowed: error of the table.

    Returns:
        Whether there are steady motions.
    """
    d.map_evaluations = 0.0
    # link 2 surely rests where its momentum is largest, if any torque is passed
    start, side.thrown = steady.find_largest(d, side, steady.MOMENTUM)
    side.start = start - side.direction * steady.HEAD_START / d.harmonic
    inertia = inertia_at_input(d, side.start)
    # so much that losses do not take all the energy on the way
    w.drive = 0.5 * side.direction * inertia if d.lossy != 0.0 else 0.0
    w.begin_energy = 1.0
    w.begin_omega2 = 0.0
    if d.map_inertia == 0.0:
        # that with which v is the mean of omega1 where the output rests; any energy shows it
        d.map_inertia = inertia
        steady.find_steady(p, w, side, 0.0, 0.0)
        d.map_inertia = 2.0 * w.sum_energy * w.sum_time / (w.sum_omega1 * w.sum_omega1)
    last_ratio, end = find_end(d, side)
    if not add_first_knots(p, d, w, side, last_ratio):
        return False
    if d.lossy != 0.0 and d.by_torque == 0.0 and side.direction < 0.0:
        extend(p, d, w, side)
    end_map(p, d, w, side, end)
    while side.count < len(side.knots) and end > 0.0 and d.map_evaluations < ENOUGH_EVALUATIONS:
        n, error = table.worst_interval(side)
        if error < allowed:
            break
        middle = 0.5 * (side.knots[n].ratio + side.knots[n + 1].ratio)
        if not add_knot(p, d, w, side, n + 1, middle):
            if d.by_torque + d.plays == 0.0:
                return False
            side.knots[n].error = 0.0
    if side.count > 1.0:
        for n in range(int(side.count)):
            table.set_slopes(side, n)
    side.end = side.knots[int(side.count) - 1].ratio
    return True


def is_map_of(p, d):
    """Tell whether the map in d is that of these parameters: of the first numbers of p."""
    for n in range(len(d.map_key)):
        if d.map_key[n] != p.numbers[n]:
            return False
    return d.map_ready == 1.0


def build_map(p, d, w):
    """Fill d with the map of these parameters, unless it is there; w: workspace.

    Returns:
        Status: OK, or NOT_STEADY where no steady motion is found: d is as it was.
    """
    if is_map_of(p, d):
        return OK
    allowed = MAP_ERROR if d.by_torque == 0.0 else MAP_ERROR_BY_TORQUE
    if d.lossy != 0.0:
        allowed = max(allowed, LOSSY_MAP_ERROR)
    held = w.held
    steady.hold_output(d, w, allowed)
    held.map_inertia = 0.0
    _, largest = steady.find_largest(held, held.forward, steady.LOCK)
    held.map_lock = 0.5 * d.k * largest
    for n in range(2):
        side = held.forward if n == 0 else held.backward
        clear(side.numbers)
        side.direction = 1.0 if n == 0 else -1.0
        if not build_side(p, held, w, side, allowed):
            return NOT_STEADY
    d.map_lock, d.map_inertia, d.map_evaluations = held.map_lock, held.map_inertia, held.map_evaluations
    copy(d.forward.numbers, held.forward.numbers)
    copy(d.backward.numbers, held.backward.numbers)
    for n in range(len(d.map_key)):
        d.map_key[n] = p.numbers[n]
    d.map_ready = 1.0
    return OK
