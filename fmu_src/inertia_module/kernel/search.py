"""Where in the step in hand a guard first falls through zero: one search for every solver.

A guard is positive while the contact mode goes on; its values and rates come from :mod:`.guards`. The
beginning
of a step never counts: what holds there was settled when the mode was chosen.
"""

from .guards import guard_inside

# looks for a dip between two looks at a guard
DIP_LOOKS = 30
CROSSING_LOOKS = 100
# A cubic with these values and rates is positive if its Bernstein coefficients are: value + h rate / 3
# from either end. The larger share is the margin for a guard that is no cubic.
SHARE = 0.4


def stays_positive(value0, rate0, value1, rate1, h):
    """Whether a guard that is not negative at both ends of a short interval h stays so inside."""
    return value0 + SHARE * h * rate0 >= 0.0 and value1 - SHARE * h * rate1 >= 0.0


def is_clear(value0, rate0, value1, rate1, h):
    """Whether a guard, not negative at the beginning of the step, is so to its end."""
    return value1 >= 0.0 and stays_positive(value0, rate0, value1, rate1, h)


def next_look(low, rate_low, high, rate_high):
    """Where to look for the lowest point: where the rate passes zero, if it does, else the middle."""
    if rate_low < 0.0 < rate_high:
        middle = low - rate_low * (high - low) / (rate_high - rate_low)
        if low < middle < high:
            return middle
    return 0.5 * (low + high)


def find_dip(d, x, w, which, zero, low, value_low, rate_low, high, value_high, rate_high):
    """Fraction of the step, low to high, where the guard is below -zero, or -1 if its lowest is not."""
    for _ in range(DIP_LOOKS):
        if stays_positive(value_low, rate_low, value_high, rate_high, high - low):
            return -1.0
        sigma = next_look(low, rate_low, high, rate_high)
        value, rate = guard_inside(d, x, w, which, sigma)
        if value < -zero:
            return sigma
        if rate < 0.0:
            low = sigma
            value_low = value
            rate_low = rate
        else:
            high = sigma
            value_high = value
            rate_high = rate
    return -1.0


def find_crossing(d, x, w, which, zero, low, high):
    """Fraction where the guard falls below -zero; it is below at high and not at low."""
    sigma = high
    value, rate = guard_inside(d, x, w, which, sigma)
    for _ in range(CROSSING_LOOKS):
        if -4.0 * zero <= value < -zero:
            return sigma
        move = sigma - (value + 2.0 * zero) / rate if rate < 0.0 else low
        sigma = move if low < move < high else 0.5 * (low + high)
        if not low < sigma < high:
            return high
        value, rate = guard_inside(d, x, w, which, sigma)
        if value < -zero:
            high = sigma
        else:
            low = sigma
    return high


def first_crossing(d, x, w, which, zero, begin, end, looks):
    """First crossing of one guard between two fractions of the step, looked for in so many parts, or -1."""
    low = begin
    value_low, rate_low = guard_inside(d, x, w, which, low)
    for look in range(1, looks + 1):
        high = end if look == looks else begin + (end - begin) * look / looks
        value, rate = guard_inside(d, x, w, which, high)
        found = high
        if not value < -zero:
            found = find_dip(d, x, w, which, zero, low, value_low, rate_low, high, value, rate)
        if found > begin:
            return find_crossing(d, x, w, which, zero, low, found)
        low = high
        value_low = value
        rate_low = rate
    return -1.0
