"""The first fall of a guard in the steady motion, between two instants of it."""

from ..codes import FREE, HELD
from ..events.search import next_look
from .instants import instant_after

DIP_LOOKS = 8
SHARE = 0.4  # of a third: the margin for a guard that is no cubic and has no bound
# share of an interval within which a fall is found; it is taken just past, so that the next mode holds
NEAR = 1e-9
ROOT_LOOKS = 60

# guards of the mode in hand, positive while it goes on
TORQUE_GUARD = 0  # held: F < 0; driving: F > 0
LINK2_GUARD = 1  # free: omega2 > 0
OUTPUT_GUARD = 2  # free: omega2 < omega3


def stays_positive(value0, rate0, value1, rate1, h):
    """Tell whether a guard that is not negative at both ends of a short interval h stays so inside."""
    return value0 + SHARE * h * rate0 >= 0.0 and value1 - SHARE * h * rate1 >= 0.0


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
