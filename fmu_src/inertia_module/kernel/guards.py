"""Whether a guard can have dipped below zero between two looks, by its values and rates there."""

# A cubic with these values and rates is positive if its Bernstein coefficients are: value + h rate / 3
# from either end. The larger share is the margin for a guard that is no cubic.
SHARE = 0.4


def stays_positive(value0, rate0, value1, rate1, h):
    """Whether a guard that is not negative at both ends of a short interval h stays so inside."""
    return value0 + SHARE * h * rate0 >= 0.0 and value1 - SHARE * h * rate1 >= 0.0


def next_look(low, rate_low, high, rate_high):
    """Where to look for the lowest point: where the rate passes zero, if it does, else the middle."""
    if rate_low < 0.0 < rate_high:
        middle = low - rate_low * (high - low) / (rate_high - rate_low)
        if low < middle < high:
            return middle
    return 0.5 * (low + high)
