"""Internal steps of the averaged motion, in any leg: speed v of the input and omega3, with all sums.

Gentle ones are of order 3, explicit. Others are by Rosenbrock's method of events.rosenbrock, with derivatives
by differences: a light shaft follows the mean torque at once, and a transient must cost no small steps.
"""

from ..accumulate import clear, total
from ..equations.losses import FREEWHEEL, VISCOUS
from ..events.advance import SHORT_GROWTH
from ..events.rosenbrock import GAMMA, STAGES, A, C
from ..events.stages import LOST, OMEGA3, Q, weigh, weighed_four, weighed_rate
from ..events.stages import OMEGA1 as V
from ..events.step_size import SHORT_SAFETY, carried, first_size, next_factor
from ..fields import CAUSES
from ..tableau import GENTLE, GENTLE_END, GENTLE_ERROR, THIRDS
from .rates import (
    COASTING,
    LOCKED,
    RESTING,
    SLIPPING,
    energy_at,
    free_torque,
    lock_ratio,
    look_up,
    write_mean_rates,
)
from .table import TORQUE

# how many of fields.FOLLOWED a module with losses has
LOSSY = LOST + CAUSES
# share of the speeds by which one is changed for a difference to one side, and to both: these are as exact
APART, TO_BOTH_SIDES = 1e-7, 1e-6
# what the energies of a step may miss, in errors allowed of the speeds
BALANCE = 10.0
# share of the allowed error that a gentle step may have: there are many of them
GENTLE_SHARE = 0.1
# evaluations of a step by Rosenbrock's method over those of a gentle one
DEARER = 2.5
# largest step, over the time in which a motion that its balance repels grows by e
REPELLED = 1.0
# from such a step on, over the time in which a balance attracts, it may be looked beyond
STIFF = 0.4
# share of a rejected step tried next, at least and at most: where speeds settle at once, errors hardly fall
LEAST, REJECTED = 0.02, 0.75
# steps tried before the tolerance is given up, and to stop where a leg ends
TRIES = 80
CUTS = 60
# a leg that is beyond its end by this share of its speeds or torques has come there
ARRIVED = 1e-12


def differentiate_by(d, side, x, w, leg, change, change3, both, slopes):
    """Derivatives of all rates by v, or where that is not changed by omega3, by a difference."""
    write_mean_rates(d, side, x, leg, x.omega1 + change, x.omega3 + change3, slopes)
    before, width = w.rates[1 if both else 0].numbers, change if change != 0.0 else change3
    if both:
        write_mean_rates(d, side, x, leg, x.omega1 - change, x.omega3 - change3, w.rates[1])
        width *= 2.0
    for n in range(LOSSY):
        slopes.numbers[n] = (slopes.numbers[n] - before[n]) / width


def differentiate(d, side, x, w, leg):
    """Derivatives of all rates by both speeds at the beginning of a step, by differences within its leg."""
    start, by_v, by_omega3 = w.rates[0], w.slopes[0], w.slopes[1]
    clear(by_v.numbers)
    clear(by_omega3.numbers)
    speed = abs(x.omega1)
    fastest = max(speed, x.omega3)
    if fastest == 0.0:
        # from rest all goes along one line
        change, change3 = APART * start.omega1, APART * start.omega3
        if change != 0.0:
            differentiate_by(d, side, x, w, leg, change, change3, False, by_v)
        elif change3 != 0.0:
            differentiate_by(d, side, x, w, leg, 0.0, change3, False, by_omega3)
        return
    # (within the map, narrow as it may be)
    slips = leg == SLIPPING
    most = side.end * speed
    if d.by_torque != 0.0 or x.alpha1 != 0.0:
        apart = TO_BOTH_SIDES * fastest
        both = speed > apart and (not slips or x.omega3 <= side.end * (speed - apart))
        change = side.direction * (apart if both else APART * fastest)
        differentiate_by(d, side, x, w, leg, change, 0.0, both, by_v)
    if slips or leg == COASTING:
        fastest = max(most, x.omega3) if slips else fastest
        apart = TO_BOTH_SIDES * fastest
        both = x.omega3 > apart and (not slips or x.omega3 + apart <= most)
        if not both:
            apart = APART * fastest
            apart = -apart if slips and x.omega3 + apart > most else apart
        differentiate_by(d, side, x, w, leg, 0.0, apart, both, by_omega3)


def how_many_followed(d):
    """How many of fields.FOLLOWED there are."""
    return LOSSY if d.lossy != 0.0 else LOST


def keep_to_leg(d, side, x, w, leg):
    """Set the changes of speeds over the step in hand that are known."""
    if d.by_torque == 0.0:
        w.change.omega1 = x.alpha1 * w.step
    if leg == LOCKED:
        w.change.omega3 = lock_ratio(d, side) * (x.omega1 + w.change.omega1) - x.omega3


def make_gentle_step(d, side, x, w, leg, h):
    """Make the step h by the explicit pair: changes of all that is followed, errors as a last stage."""
    w.step = h
    for stage in range(1, GENTLE_END + 1):
        v = x.omega1 + h * weighed_rate(w, GENTLE + stage, stage, V, 1)
        omega3 = x.omega3 + h * weighed_rate(w, GENTLE + stage, stage, OMEGA3, 1)
        write_mean_rates(d, side, x, leg, v, omega3, w.rates[stage])
    for n in range(how_many_followed(d)):
        w.change.numbers[n] = h * weighed_rate(w, GENTLE + GENTLE_END, GENTLE_END, n, 1)
        w.stages[STAGES - 1].numbers[n] = h * weighed_rate(w, GENTLE_ERROR, GENTLE_END + 1, n, 1)
    keep_to_leg(d, side, x, w, leg)


def make_stiff_step(d, side, x, w, leg, h):
    """Make the step h by Rosenbrock's method: changes of all that is followed, errors as a last stage."""
    followed = how_many_followed(d)
    per_step = 1.0 / h
    own = 1.0 / (GAMMA * h)
    by_v, by_omega3 = w.slopes[0].numbers, w.slopes[1].numbers
    a, b = own - by_v[V], -by_omega3[V]
    c, e = -by_v[OMEGA3], own - by_omega3[OMEGA3]
    determinant = a * e - b * c
    w.step = h
    clear(w.stages[0].numbers)
    for stage in range(STAGES):
        row = (STAGES - 1) * stage
        rates, changes = w.rates[min(stage, 1)].numbers, w.stages[stage].numbers
        if stage > 0:
            _, v, _, omega3 = weighed_four(w.stages, A, row, 1, stage, Q)
            write_mean_rates(d, side, x, leg, x.omega1 + v, x.omega3 + omega3, w.rates[1])
        weigh(w.stages, C, row, 1, stage, per_step, changes, 0, followed)
        for n in range(followed):
            changes[n] += rates[n]
        v = (e * changes[V] - b * changes[OMEGA3]) / determinant
        omega3 = (a * changes[OMEGA3] - c * changes[V]) / determinant
        for n in range(followed):
            changes[n] = GAMMA * h * (changes[n] + by_v[n] * v + by_omega3[n] * omega3)
    weigh(w.stages, A, (STAGES - 1) * (STAGES - 1), 1, STAGES - 1, 1.0, w.change.numbers, 0, followed)
    for n in range(followed):
        w.change.numbers[n] += w.stages[STAGES - 1].numbers[n]
    keep_to_leg(d, side, x, w, leg)


def lost_in_step(d, change):
    """Energy that the step in hand takes, J."""
    return total(change.lost) if d.lossy != 0.0 else 0.0


def per_speed(x, w):
    """1 / mean omega1 of the step in hand; 0 where work tells less of the impulse of M1 than its integral."""
    last = w.stages[STAGES - 1]
    omega1 = x.omega1 + 0.5 * w.change.omega1
    if omega1 == 0.0 or abs(last.drive - last.work_in / omega1) > abs(last.drive):
        return 0.0
    return 1.0 / omega1


def balance(d, side, x, w, leg):
    """Impulses and work of a step by the balances, exact in its ends."""
    change = w.change
    change.output = d.J3 * change.omega3 + x.load_torque * w.step + d.b3 * change.turned3
    # the mesh's impulse stood in place of the housing's
    change.housing = change.output + d.b2 * change.omega2 - change.housing
    # (nor do single freewheels turn in it)
    change.omega2 = change.wound_housing = change.wound_output = 0.0
    if d.by_torque != 0.0:
        return
    omega3 = x.omega3
    work = 0.5 * d.J3 * change.omega3 * (2.0 * omega3 + change.omega3) + x.load_torque * change.turned3
    work += lost_in_step(d, change)
    before = energy_at(d, side, x, x.omega1)
    x.omega3 = omega3 + change.omega3
    work += energy_at(d, side, x, x.omega1 + change.omega1) - before
    x.omega3 = omega3
    if leg == COASTING and d.lossy != 0.0:
        # the torques are linear there, what they take is not
        cause = FREEWHEEL if change.lost[FREEWHEEL] > change.lost[VISCOUS] else VISCOUS
        change.lost[cause] += change.work_in - work
        return
    if x.alpha1 == 0.0 and x.omega1 != 0.0:
        change.drive = work / x.omega1
    else:
        change.drive += per_speed(x, w) * (work - change.work_in)
    change.work_in = work


def fastest_speed(x, w):
    """Largest speed at the ends of the step in hand, rad/s."""
    change = w.change
    return max(abs(x.omega1), abs(x.omega1 + change.omega1), x.omega3, x.omega3 + change.omega3)


def energy_residual(d, x, w, fastest):
    """Energy residual of a step under a torque, over its energies at the fastest speed."""
    change = w.change
    put_in = x.drive_torque * change.theta1
    put_out = x.load_torque * change.turned3
    residual = put_in - put_out - 0.5 * d.map_inertia * change.omega1 * (2.0 * x.omega1 + change.omega1)
    residual -= 0.5 * d.J3 * change.omega3 * (2.0 * x.omega3 + change.omega3)
    residual -= lost_in_step(d, change)
    energies = (d.map_inertia + d.J3) * fastest * fastest + abs(put_in) + abs(put_out)
    return abs(residual) / energies if energies > 0.0 else 0.0


def is_one_way(d, side, x, w):
    """Tell whether the torque left keeps its sign at the knots that a step passes: no balance is skipped."""
    speed = abs(x.omega1 + w.change.omega1)
    found = x.omega3 + w.change.omega3
    low, high = min(x.omega3, found), max(x.omega3, found)
    for n in range(int(side.count)):
        here = side.knots[n].ratio * speed
        if here >= high:
            break
        left = look_up(side, x, speed, side.knots[n].ratio)[0] - x.load_torque - d.b3 * here
        if here > low and left * w.rates[0].omega3 < 0.0:
            return False
    return True


def step_error(d, side, x, w, leg, remaining):
    """Estimated error of the step in hand over the allowed one.

    Args:
        remaining: of the communication step: what a ramp of link 1 passes through in it is its scale.
    """
    stiff = leg == SLIPPING and w.pair == THIRDS and w.step * abs(w.slopes[1].omega3) > STIFF
    if stiff and not is_one_way(d, side, x, w):
        return 1e300
    last = w.stages[STAGES - 1]
    fastest = max(fastest_speed(x, w), w.at_rest)
    allowed = w.tolerance * fastest + 1e-300
    # (within a narrow map the shaft's speed is no larger)
    narrow = min(side.end, 1.0) if leg == SLIPPING else 1.0
    error = abs(last.omega3) / (narrow * allowed + 1e-300)
    if d.by_torque != 0.0:
        residual = energy_residual(d, x, w, fastest)
        error = max(error, abs(last.omega1) / allowed, residual / (BALANCE * w.tolerance))
    elif d.lossy != 0.0 and leg != COASTING:
        # the balance of energies gives the work but for what is lost, ...
        stored = 2.0 * energy_at(d, side, x, x.omega1) + d.J3 * x.omega3 * x.omega3
        energies = stored + abs(w.change.work_in)
        error = max(error, abs(lost_in_step(d, last)) / (BALANCE * w.tolerance * energies + 1e-300))
    if d.by_torque == 0.0 and x.alpha1 != 0.0:
        # ... and nearly the impulse of a ramp
        missed = abs(last.drive - per_speed(x, w) * last.work_in)
        ramped = max(abs(x.omega1), abs(x.omega1 + x.alpha1 * remaining))
        momentum = 2.0 * energy_at(d, side, x, side.direction * ramped) / ramped + abs(w.change.drive)
        error = max(error, missed / (BALANCE * w.tolerance * momentum + 1e-300))
    if w.pair == GENTLE:
        error /= GENTLE_SHARE
    return error if error < 1e300 else 1e300


def beyond_leg(d, side, x, w, leg):
    """How far the step in hand goes beyond its leg, over its speeds or torques; below 0 within it."""
    v, omega3 = x.omega1 + w.change.omega1, x.omega3 + w.change.omega3
    fastest = fastest_speed(x, w) + 1e-300
    speed = side.direction * v
    # (link 1 comes to rest where it has not been)
    past = -speed / fastest if d.by_torque != 0.0 and x.omega1 != 0.0 else -1.0
    if leg == SLIPPING:
        return max(past, (omega3 - side.end * speed) / fastest, -omega3 / fastest)
    if leg == COASTING:
        return max(past, (side.end * speed - omega3) / fastest)
    if leg == RESTING:
        rest = beyond_rest(d, side, x, max(speed, 0.0))
        return past if rest == x.load_torque == 0.0 else max(past, rest)
    write_mean_rates(d, side, x, LOCKED, v, omega3, d.mean)
    most = most_locked_torque(d, side, x, speed)
    torque = d.mean.output
    scale = max(most + d.output_drag, abs(x.load_torque), 1e-300)
    return max(past, (torque - most) / scale, -(torque + d.output_drag) / scale)


def beyond_rest(d, side, x, speed):
    """How far the mean torque at a shaft at rest is beyond its load, over the torques there are.

    A load that pushes it is held by the drag of both freewheels; where link 1 rests it is beyond the map.
    """
    load = x.load_torque
    scale = abs(load) + side.knots[0].value[TORQUE] * speed * speed + d.housing_drag + d.output_drag
    held = min(d.output_drag, d.housing_drag) if load < 0.0 else 0.0
    if load < 0.0 and speed == 0.0:
        held = 0.0 - free_torque(d, side, look_up(side, x, 0.0, side.end)[0])
    return (look_up(side, x, speed, 0.0)[0] - load - held) / (scale + 1e-300)


def most_locked_torque(d, side, x, v):
    """Largest torque that lock-up holds at this speed, N m; towards it the mean torque tends to no more.

    It is that of the ideal mechanism, less what resists link 2: friction only holds more. Where the ideal
    mechanism does not come there, that of the last knot may hold with losses.
    """
    reached = look_up(side, x, v, side.end)[0]
    if side.locks == 0.0 and x.omega2 != x.omega3:
        return reached
    omega1 = lock_ratio(d, side) * v
    held = d.map_lock * omega1 * omega1 - d.housing_drag - (d.b2 + d.housing_drag_viscous) * omega1
    return max(held, reached)


def make_step(d, side, x, w, leg, h):
    """Make the step h by the method in hand."""
    if w.pair == GENTLE:
        make_gentle_step(d, side, x, w, leg, h)
    else:
        make_stiff_step(d, side, x, w, leg, h)


def cut_step(d, side, x, w, leg, past):
    """Cut the step in hand, which goes so far beyond its leg, where it gets to the end of that."""
    low, high = 0.0, w.step
    clear(w.change.numbers)
    low_past = beyond_leg(d, side, x, w, leg)
    if low_past >= -ARRIVED:
        low_past = -past  # where it begins is an end, too, but not where it is to stop
    # Illinois: a secant that never stays at one end
    kept = 0
    for _ in range(CUTS):
        h = high - past * (high - low) / (past - low_past)
        if not low < h < high:
            h = 0.5 * (low + high)
        if not low < h < high:
            h = high
        make_step(d, side, x, w, leg, h)
        now = beyond_leg(d, side, x, w, leg)
        if abs(now) <= ARRIVED or h == high:
            return
        if now > 0.0:
            high, past = h, now
            low_past *= 0.5 if kept > 0 else 1.0
            kept = 1
        else:
            low, low_past = h, now
            past *= 0.5 if kept < 0 else 1.0
            kept = -1


def try_step(d, side, x, w, leg, h, remaining):
    """Make the step h by the method in hand, or its part up to where the leg ends.

    Returns:
        (its error over the allowed one, whether the leg ends there).
    """
    make_step(d, side, x, w, leg, h)
    error = step_error(d, side, x, w, leg, remaining)
    past = beyond_leg(d, side, x, w, leg) if error <= 1.0 else 0.0
    if past <= ARRIVED:
        return error, False
    # (a step far beyond the end is judged by what it would come to there)
    cut_step(d, side, x, w, leg, past)
    return step_error(d, side, x, w, leg, remaining), True


def next_size(size, h, error, order):
    """Size to try after a step h with this error over the allowed one."""
    factor = next_factor(error, order, SHORT_SAFETY, LEAST)
    return h * min(factor, REJECTED) if error > 1.0 else carried(size, h, factor)


def advance_leg(d, side, x, w, leg, remaining):
    """Make one accurate step in a leg, or its part up to where the leg ends, into w.change.

    It is made by the method that gets further by an evaluation.

    Returns:
        (whether a step is small enough, whether the leg ends there).
    """
    write_mean_rates(d, side, x, leg, x.omega1, x.omega3, w.rates[0])
    limit = min(remaining, d.max_step)
    error, ends, differentiated = 1e300, False, False
    for _ in range(TRIES):
        gentle, stiff = first_size(x.sizes[leg], limit), first_size(x.step_size, limit)
        if DEARER * gentle >= stiff:
            w.pair = GENTLE
            error, ends = try_step(d, side, x, w, leg, gentle, remaining)
            x.sizes[leg] = next_size(x.sizes[leg], w.step, error, 3.0)
            if x.step_size < limit:
                x.step_size = SHORT_GROWTH * stiff  # so that it is tried again
        else:
            w.pair = THIRDS
            if not differentiated:
                differentiate(d, side, x, w, leg)
                differentiated = True
            growth = max(w.slopes[0].omega1, w.slopes[1].omega3)
            h = REPELLED / growth if stiff * growth > REPELLED else stiff
            error, ends = try_step(d, side, x, w, leg, h, remaining)
            x.step_size = next_size(x.step_size, w.step, error, 5.0)
            x.sizes[leg] = SHORT_GROWTH * gentle
        if error <= 1.0:
            break
    balance(d, side, x, w, leg)
    return error <= 1.0, ends
