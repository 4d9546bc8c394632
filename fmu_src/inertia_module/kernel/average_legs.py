"""What the averaged output shaft does: rest, turn locked to link 1, coast, or be driven."""

from .average_table import ROW_TORQUE, first_row
from .slots import *

# a torque or speed within this fraction of another is at it
ROUNDING = 1e-12

RESTING = 0
LOCKED = 1
COASTING = 2
DRIVEN = 3


def header_at(omega1, trend):
    """Header of the map for omega1, or where it is zero for where it goes."""
    direction = omega1 if omega1 != 0.0 else trend
    return D_MAP_FORWARD if direction >= 0.0 else D_MAP_BACKWARD


def can_lock(d, x, header, omega1, alpha1, omega3, load):
    """Whether the shaft turns with link 1 and the drive, at rest in it, can hold the torque it takes."""
    if omega1 <= 0.0 or omega3 != omega1 or header != D_MAP_FORWARD:
        return False
    if d[header + 2] == 0.0 and x[X_OMEGA2] != omega1:
        return False  # the mean motion never comes up to link 1
    torque = load + d[D_J3] * alpha1
    most = d[D_MAP_LOCK] * omega1 * omega1
    if alpha1 < 0.0 and torque >= most * (1.0 - ROUNDING):
        return False  # it is just being lost
    return 0.0 <= torque <= most * (1.0 + ROUNDING)


def choose_leg(d, x, header, omega1, alpha1, load):
    """What the output shaft does from now on, and the contact mode it is shown as."""
    omega3 = x[X_OMEGA3]
    speed = abs(omega1)
    growing = alpha1 if header == D_MAP_FORWARD else -alpha1
    if can_lock(d, x, header, omega1, alpha1, omega3, load):
        return LOCKED
    if omega3 == 0.0 and load >= 0.0:
        stall = d[first_row(header) + ROW_TORQUE]
        torque = stall * speed * speed
        if torque < load * (1.0 - ROUNDING) or stall == 0.0:
            return RESTING
        if torque <= load * (1.0 + ROUNDING) and growing <= 0.0:
            return RESTING
        return DRIVEN
    gap = omega3 - d[header + 1] * speed
    closing = load / d[D_J3] + d[header + 1] * growing
    if gap > 0.0 or (gap == 0.0 and closing <= 0.0):
        return COASTING
    return DRIVEN
