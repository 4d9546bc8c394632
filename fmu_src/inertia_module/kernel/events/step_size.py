"""How long a step is, and by which method it is made: the longest one of allowed error."""

import math

from ..codes import HELD
from ..equations.states import is_wound
from ..links import fastest_own_rate, shaft_frequency
from ..tableau import LONG, SHORT
from .error import CUSP, fastest_speed, step_error
from .guards import how_many_guards, is_clear, is_watched
from .rosenbrock import differentiate, make_stiff_step
from .stages import make_step

# phase of the highest harmonic within one step, rad
STEP_PHASE = 4.0
# ... where a link is far lighter at an angle than at others, so that its speed has a spike there, and where
# the output can swing, which errors of long steps are estimated too low for; losses damp these
SHORT_PHASE, SWING_PHASE, DAMPED_PHASE = 1.0, 1.25, 1.6
# ... up to which the few stages of a short step tell what a guard does
QUIET_PHASE = 2.0
# phase of shaft and springs within a step from which on it is a stiff one, and its share of the longest step
STIFF, STIFF_SHARE = 4.0, 0.8
# a swing of at most so many tolerances of the output's speed is let go of, by a stiff step of this phase,
# where stiff ones may then grow to so much
LET_GO, LET_GO_PHASE, WORTH = 5.0, 8.0, 100.0
# steps are often as long as is stable, and a little longer are tried in vain ...
SAFETY = 0.8
SHORT_SAFETY = 0.9
# ... but not those that follow a swing of the shaft, by a phase between these: longer still they would soon
# be stiff ones, and tried in vain
SWUNG, NEARLY_STIFF = 1.0, 3.0
SMALLEST_FACTOR = 0.2
LARGEST_FACTOR = 5.0
# tries of a step before it is given up
REJECTIONS = 100
# share of its size that a step keeps where a freewheel has switched, and phase that is tried first then: an
# error of a longer step may be estimated far too low
AFRESH, AFRESH_PHASE = 0.5, 1.0


def advance_of_phase(d, x, w):
    """Advance of the highest harmonic in the step in hand, rad."""
    slip = abs(x.omega1 - x.omega2)
    end = abs(x.omega1 + w.change.omega1 - x.omega2 - w.change.omega2)
    return w.step * d.harmonic * d.k * max(slip, end)


def longest_step(d, x, w, remaining):
    """Longest step that is searched for events: a bounded phase of the highest harmonic."""
    m = d.machine
    step = min(remaining, d.max_step)
    swinging = DAMPED_PHASE if d.losses != 0.0 else SWING_PHASE
    swinging = swinging if d.elastic != 0.0 else STEP_PHASE
    phase = SHORT_PHASE if d.lightest < CUSP else swinging
    scale = d.harmonic * d.k
    slip = abs(x.omega1 - x.omega2)
    if scale * slip * step > phase:
        step = phase / (scale * slip)
    growth = scale * abs(m.alpha1 - m.alpha2)
    if 0.5 * growth * step * step > phase:
        step = math.sqrt(2.0 * phase / growth)
    return step


def size_afresh(d, x):
    """Size that is tried at most where a freewheel has switched."""
    return AFRESH_PHASE / max(d.harmonic * d.k * abs(x.omega1 - x.omega2), 1e-300)


def resume_size(d, x):
    """Take up the step size that the contact mode was left with, where the output is rigid.

    What link 2 does while it is held and the speed of link 1 is given is known however long the step.
    """
    if d.elastic != 0.0 or x.mode == x.sized_mode:
        return
    resumed = AFRESH * x.step_size
    for mode in range(len(x.sizes)):  # what a forged state says is no place in an array
        if mode == x.sized_mode:
            x.sizes[mode] = x.step_size
        elif mode == x.mode and x.sizes[mode] > 0.0:
            resumed = x.sizes[mode]
    x.step_size = resumed
    if x.mode != HELD or d.by_torque != 0.0:
        x.step_size = min(x.step_size, size_afresh(d, x))
    x.sized_mode = x.mode


def first_size(size, limit):
    """Size a step is tried with first: that carried in the state, if there is one, at most limit."""
    return min(limit, size) if size > 0.0 else 0.1 * limit


def next_factor(error, order, safety, smallest):
    """By how much the next step may be longer, with this error over the allowed one."""
    if not error < 1e300:
        return SMALLEST_FACTOR
    if error == 0.0:
        return LARGEST_FACTOR
    return min(LARGEST_FACTOR, max(smallest, safety * error ** (-1.0 / order)))


def carried(size, h, factor):
    """Step size to carry in the state after an allowed step h, where this size was to be tried.

    A step cut short by the end of the communication step says little about longer ones.
    """
    return max(factor * h, size) if h < size else factor * h


def try_short_step(d, x, w, remaining):
    """Make the step to the end of the time remaining by the pair of order 5, where that will do.

    It will where the error is allowed and no guard comes near zero. Returns as try_steps.
    """
    make_step(d, x, w, SHORT, remaining)
    fastest = fastest_speed(d, x, w)
    error = step_error(d, x, w, fastest)
    size = next_factor(error, 5.0, SHORT_SAFETY, SMALLEST_FACTOR) * remaining
    x.short_size = max(size, x.short_size) if size > remaining else size  # (as in carried)
    if not error <= 1.0 or advance_of_phase(d, x, w) > QUIET_PHASE:
        return -1.0
    for guard in range(how_many_guards(d)):
        if is_watched(d, x, guard) and not is_clear(x, w, guard):
            return -1.0
    return fastest


def swings_little(d, x, w):
    """Tell whether the swing at the beginning of the step is next to none of the output's motion."""
    swing = max(abs(x.relative), abs(w.rates[0].relative) / shaft_frequency(d, 1.0 / d.J3))
    return d.J3 * swing <= LET_GO * w.tolerance * (d.J3 + d.J4) * abs(x.omega3)


def try_steps(d, x, w, limit):
    """Make the longest step of allowed error. Returns the largest speed in it, or -1 where none will do."""
    resume_size(d, x)
    h = first_size(x.step_size, limit)
    own = fastest_own_rate(d, x) if d.elastic != 0.0 else 0.0
    if h * own <= STIFF and limit * own > WORTH and swings_little(d, x, w):
        h = LET_GO_PHASE / own
    differentiated = False
    for attempt in range(REJECTIONS):
        swings = SWUNG < h * own < NEARLY_STIFF and not is_wound(x)
        order, safety = 8.0, SHORT_SAFETY if swings else SAFETY
        if h * own > STIFF:
            order, safety = 5.0, SHORT_SAFETY
            if not differentiated:
                differentiate(d, x, w)
                differentiated = True
            h = min(h, max(STIFF_SHARE * longest_step(d, x, w, 1e300), STIFF / own))
            make_stiff_step(d, x, w, h)
        else:
            make_step(d, x, w, LONG, h)
        fastest = fastest_speed(d, x, w)
        error = step_error(d, x, w, fastest)
        factor = next_factor(error, order, safety, SMALLEST_FACTOR)
        if error <= 1.0:
            x.step_size = carried(x.step_size if attempt == 0 else h, h, factor)
            return fastest
        h *= factor
    return -1.0
