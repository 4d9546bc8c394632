"""Legs of the averaged output shaft: it rests, is locked to link 1, coasts, or slips under the mean torque.

Each leg but the last is known in closed form, for in it the speed v of the input changes evenly. One that is
advanced leaves the integrals over it of omega3, T omega3, omega2 and |omega1| in the workspace: w.turned3,
w.work, w.turned2, w.turned1, and |v| at its end in w.next_speed.
"""

import math

from ..accumulate import add

# a torque or speed within this fraction of another is at it
ROUNDING = 1e-12

RESTING = 0
LOCKED = 1
COASTING = 2
SLIPPING = 3


def last_knot(side):
    """The knot where the map ends."""
    return side.knots[int(side.count) - 1]


def lock_ratio(d, side):
    """omega3 / v in lock-up."""
    return side.end if d.by_torque != 0.0 else 1.0


def mean_acceleration(d, knot, rate):
    """Mean acceleration of link 1 in a leg in which v changes evenly at this knot of the map, rad/s^2."""
    return knot.input[0] * rate if d.by_torque != 0.0 else rate


def leg_rate(d, side, x, leg, alpha1):
    """Rate of v in a leg, rad/s^2: alpha1 where the speed is given, else by the torque of link 1."""
    if d.by_torque == 0.0:
        return alpha1
    if leg == LOCKED:
        # J* v = (J* / end^2) end omega1: so much inertia turns with link 1 and the shaft
        return side.end * (x.drive_torque - x.load_torque) / (d.map_inertia + side.end * side.end * d.J3)
    share = side.knots[0].input[0] if leg == RESTING else last_knot(side).input[0]
    return x.drive_torque * share / d.map_inertia


def most_locked_torque(d, side, v):
    """Largest torque that lock-up holds at this speed, N m; towards it the mean torque tends to no more."""
    omega1 = lock_ratio(d, side) * v
    return max(d.map_lock * omega1 * omega1, last_knot(side).torque[0] * v * v)


def can_lock(d, side, x, v, alpha1, load):
    """Whether the shaft turns with link 1 and the drive, at rest in it, can hold the torque it takes."""
    if v <= 0.0:
        return False
    if d.by_torque != 0.0:
        if side.locks == 0.0 or abs(x.omega3 - side.end * v) > ROUNDING * x.omega3:
            return False
    elif x.omega3 != v or (side.locks == 0.0 and x.omega2 != v):
        return False  # (without locks the mean motion never comes up to link 1)
    rate = leg_rate(d, side, x, LOCKED, alpha1)
    torque = load + d.J3 * lock_ratio(d, side) * rate
    most = most_locked_torque(d, side, v)
    if rate < 0.0 and torque >= most * (1.0 - ROUNDING):
        return False  # it is just being lost
    return 0.0 <= torque <= most * (1.0 + ROUNDING)


def choose_leg(d, side, x, v, alpha1):
    """What the output shaft does from now on."""
    load = x.load_torque
    speed = abs(v)
    if can_lock(d, side, x, v, alpha1, load):
        return LOCKED
    if x.omega3 == 0.0 and load >= 0.0:
        stall = side.knots[0].torque[0]
        torque = stall * speed * speed
        if torque < load * (1.0 - ROUNDING) or stall == 0.0:
            return RESTING
        growing = side.direction * leg_rate(d, side, x, RESTING, alpha1)
        if torque <= load * (1.0 + ROUNDING) and growing <= 0.0:
            return RESTING
        return SLIPPING
    gap = x.omega3 - side.end * speed
    closing = load / d.J3 + side.end * side.direction * leg_rate(d, side, x, COASTING, alpha1)
    if gap > 0.0 or (gap == 0.0 and closing <= 0.0):
        return COASTING
    return SLIPPING


def time_at_rest(side, load, v, rate, remaining):
    """Time the shaft stays at rest: until the stall torque is up to the load."""
    speed = abs(v)
    growing = side.direction * rate
    stall = side.knots[0].torque[0]
    if growing <= 0.0 or stall * (speed + growing * remaining) ** 2 <= load or stall <= 0.0:
        return remaining
    return min(max((math.sqrt(load / stall) - speed) / growing, 0.0), remaining)


def time_locked(d, side, torque, v, rate, remaining):
    """Time lock-up holds while link 1 slows down."""
    if rate >= 0.0 or torque <= 0.0 or most_locked_torque(d, side, v + rate * remaining) >= torque:
        return remaining
    most = most_locked_torque(d, side, 1.0)
    return min(max((v - math.sqrt(torque / most)) / -rate, 0.0), remaining)


def turn_input(d, side, x, w, leg, v, rate, h):
    """Take v and the mean angle of link 1 over h in a leg in which v changes evenly."""
    share = 1.0
    if d.by_torque != 0.0:
        share = side.knots[0].input[0] if leg == RESTING else last_knot(side).input[0]
    w.next_speed = abs(v + rate * h)
    w.turned1 = share * h * abs(v + 0.5 * rate * h)


def rest(d, side, x, w, v, alpha1, remaining):
    """Let the shaft rest, held by the housing. Returns (time, impulse of the output torque)."""
    rate = leg_rate(d, side, x, RESTING, alpha1)
    h = time_at_rest(side, x.load_torque, v, rate, remaining)
    turn_input(d, side, x, w, RESTING, v, rate, h)
    w.turned3 = 0.0
    w.work = 0.0
    w.turned2 = 0.0
    return h, x.load_torque * h


def turn_locked(d, side, x, w, v, alpha1, remaining):
    """Let the shaft turn with link 1. Returns (time, impulse of the output torque)."""
    rate = leg_rate(d, side, x, LOCKED, alpha1)
    ratio = lock_ratio(d, side)
    torque = x.load_torque + d.J3 * ratio * rate
    h = time_locked(d, side, torque, v, rate, remaining)
    turn_input(d, side, x, w, LOCKED, v, rate, h)
    w.turned3 = ratio * h * (v + 0.5 * rate * h)
    w.work = torque * w.turned3
    w.turned2 = w.turned3
    x.omega3 = ratio * (v + rate * h)
    x.omega3_low = 0.0
    return h, torque * h


def coast(d, side, x, w, v, alpha1, remaining):
    """Let the shaft coast until it comes down to where the map ends. Returns the time."""
    speed = abs(v)
    rate = leg_rate(d, side, x, COASTING, alpha1)
    growing = side.direction * rate
    gap = x.omega3 - side.end * speed
    closing = x.load_torque / d.J3 + side.end * growing
    arrives = closing > 0.0 and gap < closing * remaining
    h = gap / closing if arrives else remaining
    turn_input(d, side, x, w, COASTING, v, rate, h)
    change = -x.load_torque * h / d.J3
    w.turned3 = h * (x.omega3 + 0.5 * change)
    w.work = 0.0
    w.turned2 = last_knot(side).omega2[0] * h * (speed + 0.5 * growing * h)
    x.omega3, x.omega3_low = add(x.omega3, x.omega3_low, change)
    if arrives or x.omega3 < 0.0:
        x.omega3 = side.end * abs(v + rate * h)
        x.omega3_low = 0.0
    return h
