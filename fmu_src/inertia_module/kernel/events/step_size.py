"""Step-size control of the explicit pairs (Hairer, Norsett and Wanner I, section II.4)."""

import math

from ..records import Constants, State, Workspace
from ..tableau import DOP853_LAST_STAGE, DOP853_ROW, DOPRI5_LAST_STAGE, DOPRI5_ROW
from .error import error_norm, write_scales
from .guards import is_clear, is_watched, n_indicators
from .stages import evaluate_stages, set_step_changes

# Maximum phase of the highest harmonic in a step, rad
STEP_PHASE = 2.0  # Of the pair 8(5,3); a longer step could pass over a pulse
QUIET_PHASE = 2.0  # Of the pair 5(4), whose few stages exclude events
SAFETY, SHORT_SAFETY = 0.8, 0.9  # Safety factors of the pairs 8(5,3) and 5(4)
MIN_FACTOR, MAX_FACTOR = 0.2, 5.0  # Between successive step sizes
SHORT_GROWTH = 1.05  # Growth of the size of the pair 5(4) in each step of the pair 8(5,3)
MAX_REJECTIONS = 100  # Attempts at a step before the status STEP_TOO_SMALL


def longest_step(d: Constants, x: State, remaining: float) -> float:
    """Return the longest step, s: the highest harmonic of q advances by STEP_PHASE at most."""
    m = d.machine
    step = min(remaining, d.max_step)
    scale = d.harmonic * d.k
    slip = abs(x.omega1 - x.omega2)
    if scale * slip * step > STEP_PHASE:
        step = STEP_PHASE / (scale * slip)
    growth = scale * abs(m.alpha1 - m.alpha2)
    if 0.5 * growth * step * step > STEP_PHASE:
        step = math.sqrt(2.0 * STEP_PHASE / growth)
    return step


def next_factor(error: float, order: float, safety: float) -> float:
    """Return the factor from the present step size to the next one.

    Args:
        error: Error norm; 1 is the allowed error.
        order: Order of the error in the step size.
        safety: Safety factor.
    """
    if not error < 1e300:
        return MIN_FACTOR
    if error == 0.0:
        return MAX_FACTOR
    return min(MAX_FACTOR, max(MIN_FACTOR, safety * math.pow(error, -1.0 / order)))


def step_error(d: Constants, x: State, w: Workspace) -> float:
    """Write the changes over the step from its stages and return its error norm."""
    set_step_changes(d, x, w)
    write_scales(d, x, w)
    return error_norm(w)


def try_short_step(d: Constants, x: State, w: Workspace, remaining: float) -> bool:
    """Try one step to the end of the communication step by the pair 5(4).

    Returns:
        True if the step is accepted: the error norm is at most 1 and no event indicator can reach zero.
    """
    w.pair, w.step = DOPRI5_ROW, remaining
    evaluate_stages(d, x, w, 1, DOPRI5_LAST_STAGE)
    error = step_error(d, x, w)
    size = next_factor(error, 5.0, SHORT_SAFETY) * remaining
    x.short_size = max(size, x.short_size) if size > remaining else size
    slip, change = x.omega1 - x.omega2, w.change.omega1 - w.change.omega2
    phase = remaining * d.harmonic * d.k * max(abs(slip), abs(slip + change))
    if error > 1.0 or phase > QUIET_PHASE:
        return False
    for guard in range(n_indicators(d)):
        if is_watched(d, x, guard) and not is_clear(x, w, guard):
            return False
    return True


def make_accepted_step(d: Constants, x: State, w: Workspace, remaining: float, limit: float) -> bool:
    """Make a step and shrink it until its error norm is at most 1.

    Args:
        d: Constants.
        x: State at the beginning of the step; the next step sizes are written.
        w: Workspace; the step and its stages are written.
        remaining: Time to the end of the communication step, s. The pair 5(4) makes a step that reaches it.
        limit: Maximum step of the pair 8(5,3), s.

    Returns:
        True if such a step exists.
    """
    is_short = limit >= remaining and (remaining <= x.short_size or x.short_size == 0.0)
    if is_short and try_short_step(d, x, w, remaining):
        return True
    x.short_size *= SHORT_GROWTH
    h = min(limit, x.step_size) if x.step_size > 0.0 else 0.1 * limit
    for attempt in range(MAX_REJECTIONS):
        w.pair, w.step = DOP853_ROW, h
        evaluate_stages(d, x, w, 1, DOP853_LAST_STAGE)
        error = step_error(d, x, w)
        size = h * next_factor(error, 8.0, SAFETY)
        if error <= 1.0:
            # A step that the end of the communication step has shortened does not reduce the size
            is_cut = attempt == 0 and h < x.step_size
            x.step_size = max(size, x.step_size) if is_cut else size
            return True
        h = size
    return False
