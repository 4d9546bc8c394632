"""How long the next internal step may be, by the error of the last one."""

SAFETY = 0.9
SMALLEST_FACTOR = 0.2
LARGEST_FACTOR = 5.0
# tries of a step before it is given up
REJECTIONS = 100


def first_size(x, limit):
    """Size a step is tried with first: that carried in the state, if there is one, at most limit."""
    return min(limit, x.step_size) if x.step_size > 0.0 else 0.1 * limit


def next_factor(error, order, safety):
    """By how much the next step may be longer, with this error over the allowed one."""
    if not error < 1e300:
        return SMALLEST_FACTOR
    if error == 0.0:
        return LARGEST_FACTOR
    return min(LARGEST_FACTOR, max(SMALLEST_FACTOR, safety * error ** (-1.0 / order)))


def carry_size(x, h, factor, attempt):
    """Carry the size for the next step in the state, after a step h allowed at this attempt (from 0)."""
    # a step cut short by the end of the communication step says little about longer ones
    short = attempt == 0 and h < x.step_size
    x.step_size = max(factor * h, x.step_size) if short else factor * h
