"""Legs of the averaged output shaft: it rests, is locked to link 1, coasts, or slips under the mean torque.

Each leg but the last is known in closed form, for in it the speed v of the input changes evenly. One that is
advanced leaves the integrals over it of omega3, T omega3, omega2, |omega1| and b3 omega3^2 in the workspace:
w.turned3, w.work, w.turned2, w.turned1, w.lost3, and |v| at its end in w.next_speed.
"""

import math

from ..accumulate import add
from .rates import SLOWEST, resistance, torque_at_knot

# a torque or speed within this fraction of another is at it
ROUNDING = 1e-12

# to find when a shaft is pulled away
HALVINGS = 60

RESTING = 0
LOCKED = 1
COASTING = 2
SLIPPING = 3
# a coasting shaft within this fraction of the end of the map is at it
ARRIVED = 1e-9
# below it the mean of an exponential is a series
SERIES = 0.3


def slowed(z):
    """Means over 0 <= t <= 1 of exp(-z t), (1 - exp(-z)) / z, and its integral, (z - 1 + exp(-z)) / z^2."""
    if z < SERIES:
        # the first eight terms: to rounding
        first = 1.0
        second = 0.5
        term = 1.0
        for n in range(2, 10):
            term *= -z / n
            first += term
            second += term / (n + 1.0)
        return first, second
    first = -math.expm1(-z) / z
    return first, (1.0 - first) / z


def last_knot(side):
    """The knot where the map ends."""
    return side.knots[int(side.count) - 1]


def lock_ratio(d, side):
    """omega3 / v in lock-up."""
    return side.end if d.by_torque != 0.0 else 1.0


def mean_acceleration(d, knot, rate):
    """Mean acceleration of link 1 in a leg in which v changes evenly at this knot of the map, rad/s^2."""
    return knot.input[0] * rate if d.by_torque != 0.0 else rate


def leg_rate(d, side, x, leg, v, alpha1):
    """Rate of v in a leg, rad/s^2: alpha1 where the speed is given, else by the torque of link 1."""
    if d.by_torque == 0.0:
        return alpha1
    resisting = 0.0
    if d.lossy != 0.0:
        speed = max(abs(v), side.slow / SLOWEST)
        resisting, _, _ = resistance(side, x, speed, 0.0 if leg == RESTING else side.end * speed)
        if leg == COASTING:
            resisting += coasting_torque(d, side, x, speed) * side.end
    if leg == LOCKED:
        # J* v = (J* / end^2) end omega1: so much inertia turns with link 1 and the shaft
        driving = side.end * (x.drive_torque - x.load_torque - d.b3 * side.end * v)
        return (driving - resisting) / (d.map_inertia + side.end * side.end * d.J3)
    share = side.knots[0].input[0] if leg == RESTING else last_knot(side).input[0]
    driving = x.drive_torque * share
    if v == 0.0 and abs(driving) <= resisting:
        return 0.0
    return (driving - math.copysign(resisting, side.direction)) / d.map_inertia


def mean_rate(d, side, x, leg, v, alpha1, h):
    """Rate of v in the middle of a leg of h, rad/s^2."""
    rate = leg_rate(d, side, x, leg, v, alpha1)
    if d.by_torque == 0.0 or d.lossy == 0.0:
        return rate
    return leg_rate(d, side, x, leg, v + 0.5 * h * rate, alpha1)


def even_time(d, side, x, leg, v, alpha1, h, tolerance):
    """Time, at most h, in which losses under the torque of link 1 let v change as evenly as is allowed."""
    if d.by_torque == 0.0 or d.lossy == 0.0:
        return h
    rate = leg_rate(d, side, x, leg, v, alpha1)
    for _ in range(HALVINGS):
        middle = leg_rate(d, side, x, leg, v + 0.5 * h * rate, alpha1)
        again = leg_rate(d, side, x, leg, v + 0.5 * h * middle, alpha1)
        end = leg_rate(d, side, x, leg, v + h * middle, alpha1)
        x.step_evaluations += 1.0
        error = h * (abs(again - middle) + abs(rate - 2.0 * middle + end) / 6.0)
        allowed = tolerance * max(abs(v), abs(h * middle))
        if not error > allowed:
            break
        h *= max(0.1, 0.8 * (allowed / error) ** (1.0 / 3.0))
    return h


def locked_torque(d, side, load, v, rate):
    """Output torque of a shaft that turns with link 1, N m."""
    return load + d.J3 * lock_ratio(d, side) * rate + d.b3 * lock_ratio(d, side) * v


def most_locked_torque(d, side, v):
    """Largest torque that lock-up holds at this speed, N m; towards it the mean torque tends to no more.

    It is that of the ideal mechanism, less what resists link 2: friction only holds more.
    """
    omega1 = lock_ratio(d, side) * v
    held = d.map_lock * omega1 * omega1 - d.housing_drag - (d.b2 + d.housing_drag_viscous) * omega1
    return max(held, torque_at_knot(side, last_knot(side), v) * v * v)


def coasting_torque(d, side, x, speed):
    """Output torque beyond the end of the map, N m: what drag takes from the shaft."""
    if d.lossy == 0.0:
        return 0.0
    beyond = d.output_drag_viscous * (x.omega3 - side.end * speed)
    if side.locks != 0.0:
        return -d.output_drag - beyond
    return torque_at_knot(side, last_knot(side), speed) * speed * speed - beyond


def holds_lock(d, side, x, v, alpha1, load):
    """Tell whether the drive, at rest in link 1, can hold the torque of a shaft that turns with it."""
    rate = leg_rate(d, side, x, LOCKED, v, alpha1)
    torque = locked_torque(d, side, load, v, rate)
    most = most_locked_torque(d, side, v)
    if rate < 0.0 and torque >= most * (1.0 - ROUNDING):
        return False  # it is just being lost
    return -d.output_drag <= torque <= most * (1.0 + ROUNDING)


def can_lock(d, side, x, v, alpha1, load):
    """Tell whether the shaft turns with link 1 and the drive, at rest in it, can hold the torque it takes."""
    if v <= 0.0:
        return False
    if d.by_torque != 0.0:
        if side.locks == 0.0 or abs(x.omega3 - side.end * v) > ROUNDING * x.omega3:
            return False
    elif x.omega3 != v or (side.locks == 0.0 and x.omega2 != v):
        return False  # (without locks the mean motion never comes up to link 1)
    return holds_lock(d, side, x, v, alpha1, load)


def closing_in(d, side, x, v, alpha1):
    """How far a coasting shaft is beyond the end of the map, rad/s, how fast it slows and comes nearer."""
    speed = abs(v)
    slowing = (x.load_torque + d.b3 * x.omega3 - coasting_torque(d, side, x, speed)) / d.J3
    closing = slowing + side.end * side.direction * leg_rate(d, side, x, COASTING, v, alpha1)
    return x.omega3 - side.end * speed, slowing, closing


def choose_leg(d, side, x, v, alpha1):
    """Choose what the output shaft does from now on."""
    load = x.load_torque
    speed = abs(v)
    if can_lock(d, side, x, v, alpha1, load):
        return LOCKED
    if x.omega3 == v == alpha1 == 0.0 and -min(d.output_drag, d.housing_drag) <= load < 0.0:
        return RESTING  # drag of both freewheels holds the shaft
    if x.omega3 == 0.0 and load >= 0.0:
        stall = torque_at_knot(side, side.knots[0], speed)
        torque = stall * speed * speed
        if torque < load * (1.0 - ROUNDING) or stall == 0.0:
            return RESTING
        growing = side.direction * leg_rate(d, side, x, RESTING, v, alpha1)
        if torque <= load * (1.0 + ROUNDING) and growing <= 0.0:
            return RESTING
        return SLIPPING
    gap, _, closing = closing_in(d, side, x, v, alpha1)
    if gap > 0.0 or (gap == 0.0 and closing <= 0.0):
        return COASTING
    return SLIPPING


def time_at_rest(side, load, v, rate, remaining):
    """Time the shaft stays at rest: until the stall torque is up to the load."""
    stall = side.knots[0]
    end = abs(v + rate * remaining)
    if side.direction * rate <= 0.0 or torque_at_knot(side, stall, end) * end * end <= load:
        return remaining
    low, high = 0.0, remaining
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        end = abs(v + rate * middle)
        if torque_at_knot(side, stall, end) * end * end > load:
            high = middle
        else:
            low = middle
    return high


def time_locked(d, side, x, v, rate, alpha1, remaining):
    """Time lock-up holds while link 1 slows down."""
    load = x.load_torque
    if rate >= 0.0 or holds_lock(d, side, x, v + rate * remaining, alpha1, load):
        return remaining
    low, high = 0.0, remaining
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if holds_lock(d, side, x, v + rate * middle, alpha1, load):
            low = middle
        else:
            high = middle
    return high


def turn_input(d, side, x, w, leg, v, rate, h):
    """Take v and the mean angle of link 1 over h in a leg in which v changes evenly."""
    share = 1.0
    if d.by_torque != 0.0:
        share = side.knots[0].input[0] if leg == RESTING else last_knot(side).input[0]
    w.next_speed = abs(v + rate * h)
    w.turned1 = share * h * abs(v + 0.5 * rate * h)


def rest(d, side, x, w, v, alpha1, remaining):
    """Let the shaft rest, held by the housing. Returns (time, impulse of the output torque)."""
    rate = mean_rate(d, side, x, RESTING, v, alpha1, remaining)
    h = time_at_rest(side, x.load_torque, v, rate, remaining)
    turn_input(d, side, x, w, RESTING, v, rate, h)
    w.turned3 = 0.0
    w.work = 0.0
    w.lost3 = 0.0
    w.turned2 = 0.0
    return h, x.load_torque * h


def turn_locked(d, side, x, w, v, alpha1, remaining):
    """Let the shaft turn with link 1. Returns (time, impulse of the output torque)."""
    rate = mean_rate(d, side, x, LOCKED, v, alpha1, remaining)
    ratio = lock_ratio(d, side)
    h = time_locked(d, side, x, v, rate, alpha1, remaining)
    torque = locked_torque(d, side, x.load_torque, v + 0.5 * rate * h, rate)
    turn_input(d, side, x, w, LOCKED, v, rate, h)
    w.turned3 = ratio * h * (v + 0.5 * rate * h)
    swing = d.b3 * h * (ratio * rate * h) ** 2 / 12.0
    w.work = torque * w.turned3 + swing
    w.lost3 = d.b3 * ratio * (v + 0.5 * rate * h) * w.turned3 + swing
    w.turned2 = w.turned3
    x.omega3 = ratio * (v + rate * h)
    x.omega3_low = 0.0
    return h, torque * h


def coasting_works(d, side, x, w, speed, rate, slowing, change, h):
    """Work of the drag of a coasting shaft over h, what friction of the output takes, and what drag does, J.

    The speed falls at an even rate and with friction: that of its balance. Returns the impulse of the drag.
    """
    friction = d.b3 + d.output_drag_viscous
    mean = x.omega3 + 0.5 * change
    w.lost3 = 0.0
    of_change = 0.0  # integral of the torque times the time from the middle
    if friction > 0.0:
        even = (friction * x.omega3 - d.J3 * slowing) * w.turned3 - d.J3 * change * mean
        w.lost3 = max(d.b3 / friction * even, 0.0)
        of_change = d.J3 * d.output_drag_viscous / friction * (h * mean - w.turned3)
    impulse = d.J3 * change + x.load_torque * h + d.b3 * w.turned3
    w.work = d.J3 * change * mean + x.load_torque * w.turned3 + w.lost3
    w.dragged = max(side.end * (impulse * (speed + 0.5 * rate * h) + rate * of_change) - w.work, 0.0)
    return impulse


def coast(d, side, x, w, v, alpha1, remaining):
    """Let the shaft coast until it comes down to where the map ends. Returns (time, impulse of the drag)."""
    speed = abs(v)
    rate = mean_rate(d, side, x, COASTING, v, alpha1, remaining)
    gap, slowing, closing = closing_in(d, side, x, v, alpha1)
    arrives = closing > 0.0 and gap < closing * remaining
    h = gap / closing if arrives else remaining
    turn_input(d, side, x, w, COASTING, v, rate, h)
    # friction and drag let the rate fade
    first, second = 1.0, 0.5
    if d.lossy != 0.0:
        first, second = slowed((d.b3 + d.output_drag_viscous) * h / d.J3)
    change = -slowing * h * first
    w.turned3 = h * (x.omega3 - slowing * h * second)
    impulse = w.work = w.lost3 = w.dragged = 0.0
    if d.lossy != 0.0:
        impulse = coasting_works(d, side, x, w, speed, side.direction * rate, slowing, change, h)
    w.turned2 = last_knot(side).omega2[0] * h * (speed + 0.5 * side.direction * rate * h)
    x.omega3, x.omega3_low = add(x.omega3, x.omega3_low, change)
    end = side.end * abs(v + rate * h)
    if (arrives and x.omega3 <= end * (1.0 + ARRIVED)) or x.omega3 < 0.0:
        x.omega3 = end
        x.omega3_low = 0.0
    return h, impulse
