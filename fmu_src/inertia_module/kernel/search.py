"""Where in the step in hand a guard first falls through zero: one search for every solver.

A guard is positive while the contact mode goes on; its values and rates come from :mod:`.general.guards`,
and so does a bound of its fourth derivative. The cubic with the values and rates at the ends of an interval
is off by at most bound t^2 (h - t)^2 / 24 inside, so the ends and the bound tell what the guard cannot do
there.
The beginning of a step never counts: what holds there was settled when the mode was chosen.
"""

from .general.guards import general_guard, is_exact
from .general.stages import exact_guard

CROSSING_LOOKS = 100
# A cubic with these values and rates is positive if its Bernstein coefficients are: value + h rate / 3 from
# either end. The larger share is the margin for a guard that is no cubic and has no bound.
SHARE = 0.4
# share of an interval between two looks below which its cubic is the guard: a dip so short moves nothing
SHORTEST = 0.01


def stays_positive(value0, rate0, value1, rate1, h):
    """Tell whether a guard that is not negative at both ends of a short interval h stays so inside."""
    return value0 + SHARE * h * rate0 >= 0.0 and value1 - SHARE * h * rate1 >= 0.0


def is_surely_positive(value0, rate0, value1, rate1, h, fourth_bound):
    """Tell whether a guard is not negative in an interval h, by its Bernstein coefficients of degree 4."""
    middle = 0.5 * (value0 + value1) + h * (rate0 - rate1) / 6.0
    return (
        value0 >= 0.0
        and value0 + 0.25 * h * rate0 >= 0.0
        and middle >= fourth_bound * h * h * h * h / 144.0
        and value1 - 0.25 * h * rate1 >= 0.0
        and value1 >= 0.0
    )


def falls_throughout(value0, rate0, value1, rate1, h, fourth_bound):
    """Tell whether the rate of a guard is surely negative in an interval h."""
    rest = -fourth_bound * h * h * h / 124.0  # what the rate of the cubic may be off by
    return rate0 < rest and 3.0 * (value1 - value0) / h - rate0 - rate1 < rest and rate1 < rest


def next_look(low, rate_low, high, rate_high):
    """Where to look for the lowest point: where the rate passes zero, if it does, else the middle."""
    if rate_low < 0.0 < rate_high:
        middle = low - rate_low * (high - low) / (rate_high - rate_low)
        if low < middle < high:
            return middle
    return 0.5 * (low + high)


def find_crossing(d, x, w, which, zero, low, high, value, rate):
    """Fraction where the guard falls below -zero; it is not below at low, and is at high, with this rate."""
    sigma = high
    for _ in range(CROSSING_LOOKS):
        if -4.0 * zero <= value < -zero:
            return sigma
        move = sigma - (value + 2.0 * zero) / rate if rate < 0.0 else low
        sigma = move if low < move < high else 0.5 * (low + high)
        if not low < sigma < high:
            return high
        value, rate = general_guard(x, w, which, sigma)
        if value < -zero:
            high = sigma
        else:
            low = sigma
    return high


def find_exactly(d, x, w, which, zero, low, high, sigma):
    """Fraction where a guard falls by the equations, or -1 if it does not between low and high.

    Args:
        sigma: where it does by its fit, which falls where a torque may not.
    """
    fallen = False
    for _ in range(CROSSING_LOOKS):
        value = exact_guard(d, x, w, which, sigma)
        _, rate = general_guard(x, w, which, sigma)
        if -4.0 * zero <= value < -zero:
            return sigma
        if value < -zero:
            fallen = True
            high = sigma
        elif sigma == high:
            return -1.0
        else:
            low = sigma
        move = sigma - (value + 2.0 * zero) / rate if rate < 0.0 else low
        if low < move < high:
            sigma = move
        else:
            sigma = 0.5 * (low + high) if fallen else high
        if fallen and not low < sigma < high:
            return high
    return high


def first_crossing(d, x, w, which, zero, fourth_bound, looks):
    """First fall of one guard below -zero in the step in hand, looked for in about so many parts, or -1.

    Intervals from the left that are surely clear are passed; one that is not is cut, until the guard surely
    falls all the way.
    """
    part = 1.0 / looks
    low = 0.0
    value_low, rate_low = general_guard(x, w, which, low)
    high = part
    while low < 1.0:
        value, rate = general_guard(x, w, which, high)
        if not abs(value) < 1e300:
            return -1.0  # a motion that overflows is refused at the end of the step
        h = high - low
        clear = is_surely_positive(value_low + zero, rate_low, value + zero, rate, h, fourth_bound)
        if not clear:
            if h > SHORTEST * part and not falls_throughout(
                value_low, rate_low, value, rate, h, fourth_bound
            ):
                high = next_look(low, rate_low, high, rate)
                continue
            if value < -zero:
                sigma = find_crossing(d, x, w, which, zero, low, high, value, rate)
                if w.stiffly == 0.0 and is_exact(x, which):
                    sigma = find_exactly(d, x, w, which, zero, low, high, sigma)
                if sigma >= 0.0:
                    return sigma
        low = high
        value_low = value
        rate_low = rate
        high = min(1.0, low + min(part, 2.0 * h))
    return -1.0
