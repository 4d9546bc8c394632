"""Internal steps of the averaged motion, in any leg: speed v of the input and omega3, with all sums.

They are of Ros4, an L-stable Rosenbrock method of four stages, of orders 4(3) (Hairer and Wanner, Solving
Ordinary Differential Equations II, section IV.7), in the form of events.rosenbrock; one more stage makes its
error L-stable too. Derivatives are differences. So a light shaft follows the mean torque at once, and a
transient costs no small steps.
"""

from ..accumulate import clear, total
from ..equations.losses import FREEWHEEL, VISCOUS
from ..events.stages import LOST, OMEGA3, Q, weigh, weighed_four
from ..events.stages import OMEGA1 as V
from ..events.step_size import SHORT_SAFETY, carry_size, first_size, next_factor
from ..fields import CAUSES
from .rates import (
    COASTING,
    LOCKED,
    RESTING,
    SLIPPING,
    energy_at,
    lock_ratio,
    look_up,
    write_mean_rates,
)
from .table import TORQUE

STAGES = 5
GAMMA = 0.57282
# rows of stages: the points they are at (the fourth is at that of the third); what is added, of the last the
# weights of the error
A = (
    *(0.0, 0.0, 0.0, 0.0),
    *(2.0, 0.0, 0.0, 0.0),
    *(1.867943637803922, 0.2344449711399156, 0.0, 0.0),
)
C = (
    *(0.0, 0.0, 0.0, 0.0),
    *(-7.137615036412310, 0.0, 0.0, 0.0),
    *(2.580708087951457, 0.6515950076447975, 0.0, 0.0),
    *(-2.137148994382534, -0.3214669691237626, -0.6949742501781779, 0.0),
    *(-0.2815431932141155 / GAMMA, -0.07276199124934920 / GAMMA),
    *(-0.1082196201495311 / GAMMA, -1.093502252409163 / GAMMA),
)
CHANGE = (2.255570073418735, 0.2870493262186792, 0.4353179431840180, 1.093502252409163)
# how many of fields.FOLLOWED a module with losses has
LOSSY = LOST + CAUSES
# share of the speeds by which one is changed for a difference
APART = 1e-7
# steps tried before the tolerance is given up, and to stop where a leg ends
TRIES = 80
CUTS = 120
# a leg that is beyond its end by this share of its speeds or torques has come there
ARRIVED = 1e-12


def differentiate_by(d, side, x, w, leg, change, change3, slopes):
    """Derivatives of all rates by v, or where that is not changed by omega3, by a difference."""
    apart = change if change != 0.0 else change3
    if apart == 0.0:
        clear(slopes.numbers)
        return
    write_mean_rates(d, side, x, leg, x.omega1 + change, x.omega3 + change3, slopes)
    start = w.rates[0].numbers
    for n in range(LOSSY):
        slopes.numbers[n] = (slopes.numbers[n] - start[n]) / apart


def differentiate(d, side, x, w, leg):
    """Derivatives of all rates at the beginning of a step by the speeds that change in it."""
    speed, by_v, by_omega3 = abs(x.omega1), w.slopes[0], w.slopes[1]
    apart = apart3 = 0.0
    if speed == x.omega3 == 0.0:
        # from rest all goes along one line
        apart, apart3 = APART * w.rates[0].omega1, APART * w.rates[0].omega3
        differentiate_by(d, side, x, w, leg, apart, apart3, by_v)
        differentiate_by(d, side, x, w, leg, 0.0, apart3 if apart == 0.0 else 0.0, by_omega3)
        return
    if d.by_torque != 0.0 or x.alpha1 != 0.0:
        apart = side.direction * APART * max(speed, x.omega3)
    if leg == SLIPPING or leg == COASTING:
        # (within the map, narrow as it may be)
        apart3 = APART * max(side.end * speed if leg == SLIPPING else speed, x.omega3)
        apart3 = -apart3 if x.omega3 > apart3 else apart3
    differentiate_by(d, side, x, w, leg, apart, 0.0, by_v)
    differentiate_by(d, side, x, w, leg, 0.0, apart3, by_omega3)


def keep_to_leg(d, side, x, w, leg):
    """Set the changes of speeds over the step in hand that are known."""
    if d.by_torque == 0.0:
        w.change.omega1 = x.alpha1 * w.step
    if leg == LOCKED:
        w.change.omega3 = lock_ratio(d, side) * (x.omega1 + w.change.omega1) - x.omega3


def take_step(d, side, x, w, leg, h):
    """Make the step h: changes of all that is followed into w.change, their errors as a last stage."""
    followed = LOSSY if d.lossy != 0.0 else LOST
    last = STAGES - 1
    own = 1.0 / (GAMMA * h)
    by_v, by_omega3 = w.slopes[0].numbers, w.slopes[1].numbers
    a, b = own - by_v[V], -by_omega3[V]
    c, e = -by_v[OMEGA3], own - by_omega3[OMEGA3]
    determinant = a * e - b * c
    w.step = h
    for stage in range(STAGES):
        changes = w.stages[stage].numbers
        if stage == 1 or stage == 2:
            _, v, _, omega3 = weighed_four(w.stages, A, last * stage, stage, Q)
            write_mean_rates(d, side, x, leg, x.omega1 + v, x.omega3 + omega3, w.rates[1])
        weigh(w.stages, C, last * stage, stage, 1.0 / h, changes, 0, followed)
        if stage < last:
            rates = w.rates[min(stage, 1)].numbers
            for n in range(followed):
                changes[n] += rates[n]
        v = (e * changes[V] - b * changes[OMEGA3]) / determinant
        omega3 = (a * changes[OMEGA3] - c * changes[V]) / determinant
        for n in range(followed):
            changes[n] = GAMMA * h * (changes[n] + by_v[n] * v + by_omega3[n] * omega3)
    weigh(w.stages, CHANGE, 0, last, 1.0, w.change.numbers, 0, followed)
    keep_to_leg(d, side, x, w, leg)


def balance(d, side, x, w, leg):
    """Impulses and work of a step by the balances, exact in its ends."""
    change = w.change
    change.output = d.J3 * change.omega3 + x.load_torque * w.step + d.b3 * change.turned3
    # the mesh's impulse stood in place of the housing's
    change.housing = change.output + d.b2 * change.omega2 - change.housing
    # (nor do single freewheels turn in it)
    change.omega2 = change.wound_housing = change.wound_output = 0.0
    if d.lossy != 0.0:
        for cause in range(CAUSES):
            # (below zero is an error of the step)
            change.lost[cause] = max(change.lost[cause], 0.0)
    if d.by_torque != 0.0:
        return
    omega3 = x.omega3
    work = 0.5 * d.J3 * change.omega3 * (2.0 * omega3 + change.omega3) + x.load_torque * change.turned3
    work += total(change.lost) if d.lossy != 0.0 else 0.0
    before = energy_at(d, side, x, x.omega1)
    x.omega3 = omega3 + change.omega3
    work += energy_at(d, side, x, x.omega1 + change.omega1) - before
    x.omega3 = omega3
    if leg == COASTING and d.lossy != 0.0:
        # the torques are linear there, what they take is not
        cause = FREEWHEEL if change.lost[FREEWHEEL] > change.lost[VISCOUS] else VISCOUS
        change.lost[cause] += change.work_in - work
        return
    change.work_in = work
    if x.alpha1 == 0.0 and x.omega1 != 0.0:
        change.drive = change.work_in / x.omega1


def fastest_speed(x, w):
    """Largest speed at the ends of the step in hand, rad/s."""
    change = w.change
    fastest = max(abs(x.omega1), abs(x.omega1 + change.omega1), x.omega3, x.omega3 + change.omega3)
    return fastest + 1e-300


def beyond_rest(d, side, x, speed):
    """How far the mean torque at a shaft at rest is beyond its load, over the torques there are.

    A load that pushes it is held by the drag of both freewheels.
    """
    load = x.load_torque
    scale = abs(load) + side.knots[0].value[TORQUE] * speed * speed + d.housing_drag + d.output_drag
    held = min(d.output_drag, d.housing_drag) if load < 0.0 else 0.0
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


def step_error(d, side, x, w, leg):
    """Estimated error of the speeds in the step in hand over the allowed one."""
    error = w.stages[STAGES - 1]
    allowed = w.tolerance * fastest_speed(x, w)
    # (within a narrow map the shaft's speed is no larger)
    narrow = min(side.end, 1.0) if leg == SLIPPING else 1.0
    return min(max(abs(error.omega1), abs(error.omega3) / (narrow + 1e-300)) / allowed, 1e300)


def past_end(d, side, x, w, leg):
    """How far the step in hand is beyond the end of its leg, over its speeds or torques; below 0: not yet."""
    v, omega3 = x.omega1 + w.change.omega1, x.omega3 + w.change.omega3
    speed = side.direction * v
    fastest = fastest_speed(x, w)
    # (link 1 comes to rest where it has not been: the map is another there)
    past = -speed / fastest if x.omega1 != 0.0 else -1.0
    if leg == SLIPPING:
        return max(past, (omega3 - side.end * speed) / fastest, -omega3 / fastest)
    if leg == COASTING:
        return max(past, (side.end * speed - omega3) / fastest)
    if leg == RESTING:
        return max(past, beyond_rest(d, side, x, max(speed, 0.0)))
    write_mean_rates(d, side, x, LOCKED, v, omega3, d.mean)
    most = most_locked_torque(d, side, x, speed)
    torque = d.mean.output
    scale = max(most + d.output_drag, abs(x.load_torque), 1e-300)
    return max(past, (torque - most) / scale, -(torque + d.output_drag) / scale)


def cut_step(d, side, x, w, leg, past):
    """Cut the step in hand, past the end of its leg, where it gets there: by halving and secants in turns."""
    # (it may begin at an end: that is not where it is to stop)
    low, high, low_past = 0.0, w.step, -past
    for n in range(CUTS):
        h = high - past * (high - low) / (past - low_past)
        if n % 2 == 0 or not low < h < high:
            h = 0.5 * (low + high)
        if not low < h < high:
            h = high
        take_step(d, side, x, w, leg, h)
        now = past_end(d, side, x, w, leg)
        if abs(now) <= ARRIVED or h == high:
            return
        if now > 0.0:
            high, past = h, now
        else:
            low, low_past = h, now


def try_steps(d, side, x, w, leg, limit):
    """Make the longest step of allowed error. Returns whether there is one."""
    h = first_size(x, limit)
    for attempt in range(TRIES):
        take_step(d, side, x, w, leg, h)
        error = step_error(d, side, x, w, leg)
        factor = next_factor(error, 4.0, SHORT_SAFETY)
        if error <= 1.0:
            carry_size(x, h, factor, attempt)
            return True
        h *= factor
    return False


def advance_leg(d, side, x, w, leg, remaining):
    """Make one accurate step in a leg, or its part up to where the leg ends, into w.change.

    Returns:
        Whether a step is small enough.
    """
    write_mean_rates(d, side, x, leg, x.omega1, x.omega3, w.rates[0])
    differentiate(d, side, x, w, leg)
    if not try_steps(d, side, x, w, leg, min(remaining, d.max_step)):
        return False
    past = past_end(d, side, x, w, leg)
    if past > ARRIVED:
        cut_step(d, side, x, w, leg, past)
    balance(d, side, x, w, leg)
    return True
