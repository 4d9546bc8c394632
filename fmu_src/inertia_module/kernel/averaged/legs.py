"""Legs of the averaged output shaft: it rests, is locked to link 1, coasts, or slips under the mean torque.

Each leg but the last is known in closed form. One that is advanced leaves the integrals over it of omega3,
T omega3 and omega2 in the workspace: w.turned3, w.work, w.turned2.
"""

import math

from ..accumulate import add

# a torque or speed within this fraction of another is at it
ROUNDING = 1e-12

RESTING = 0
LOCKED = 1
COASTING = 2
SLIPPING = 3


def can_lock(d, x, omega1, alpha1, load):
    """Whether the shaft turns with link 1 and the drive, at rest in it, can hold the torque it takes."""
    if omega1 <= 0.0 or x.omega3 != omega1:
        return False
    if d.forward.locks == 0.0 and x.omega2 != omega1:
        return False  # the mean motion never comes up to link 1
    torque = load + d.J3 * alpha1
    most = d.map_lock * omega1 * omega1
    if alpha1 < 0.0 and torque >= most * (1.0 - ROUNDING):
        return False  # it is just being lost
    return 0.0 <= torque <= most * (1.0 + ROUNDING)


def choose_leg(d, side, x, omega1, alpha1):
    """What the output shaft does from now on."""
    load = x.load_torque
    speed = abs(omega1)
    growing = side.direction * alpha1
    if can_lock(d, x, omega1, alpha1, load):
        return LOCKED
    if x.omega3 == 0.0 and load >= 0.0:
        stall = side.knots[0].torque[0]
        torque = stall * speed * speed
        if torque < load * (1.0 - ROUNDING) or stall == 0.0:
            return RESTING
        if torque <= load * (1.0 + ROUNDING) and growing <= 0.0:
            return RESTING
        return SLIPPING
    gap = x.omega3 - side.end * speed
    closing = load / d.J3 + side.end * growing
    if gap > 0.0 or (gap == 0.0 and closing <= 0.0):
        return COASTING
    return SLIPPING


def time_at_rest(side, load, omega1, alpha1, remaining):
    """Time the shaft stays at rest: until the stall torque is up to the load."""
    speed = abs(omega1)
    growing = side.direction * alpha1
    stall = side.knots[0].torque[0]
    if growing <= 0.0 or stall * (speed + growing * remaining) ** 2 <= load or stall <= 0.0:
        return remaining
    return min(max((math.sqrt(load / stall) - speed) / growing, 0.0), remaining)


def time_locked(d, load, omega1, alpha1, remaining):
    """Time lock-up holds while omega1 falls."""
    torque = load + d.J3 * alpha1
    if alpha1 >= 0.0 or torque <= 0.0 or d.map_lock * (omega1 + alpha1 * remaining) ** 2 >= torque:
        return remaining
    return min(max((omega1 - math.sqrt(torque / d.map_lock)) / -alpha1, 0.0), remaining)


def rest(side, x, w, omega1, alpha1, remaining):
    """Let the shaft rest, held by the housing. Returns (time, impulse of the output torque)."""
    h = time_at_rest(side, x.load_torque, omega1, alpha1, remaining)
    w.turned3 = 0.0
    w.work = 0.0
    w.turned2 = 0.0
    return h, x.load_torque * h


def turn_locked(d, x, w, omega1, alpha1, remaining):
    """Let the shaft turn with link 1. Returns (time, impulse of the output torque)."""
    h = time_locked(d, x.load_torque, omega1, alpha1, remaining)
    torque = x.load_torque + d.J3 * alpha1
    w.turned3 = h * (omega1 + 0.5 * alpha1 * h)
    w.work = torque * w.turned3
    w.turned2 = w.turned3
    x.omega3 = omega1 + alpha1 * h
    x.omega3_low = 0.0
    return h, torque * h


def coast(d, side, x, w, omega1, alpha1, remaining):
    """Let the shaft coast until it comes down to where the map ends. Returns the time."""
    speed = abs(omega1)
    growing = side.direction * alpha1
    gap = x.omega3 - side.end * speed
    closing = x.load_torque / d.J3 + side.end * growing
    arrives = closing > 0.0 and gap < closing * remaining
    h = gap / closing if arrives else remaining
    change = -x.load_torque * h / d.J3
    w.turned3 = h * (x.omega3 + 0.5 * change)
    w.work = 0.0
    w.turned2 = side.knots[int(side.count) - 1].omega2[0] * h * (speed + 0.5 * growing * h)
    x.omega3, x.omega3_low = add(x.omega3, x.omega3_low, change)
    if arrives or x.omega3 < 0.0:
        x.omega3 = side.end * abs(omega1 + alpha1 * h)
        x.omega3_low = 0.0
    return h
