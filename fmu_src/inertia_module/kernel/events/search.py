"""Events: where in the step in hand a guard first falls through zero.

A guard is positive while the contact mode goes on; its values and rates come from :mod:`.guards`, and so does
a bound of its fourth derivative. The cubic with the values and rates at the ends of an interval is off by at
most bound t^2 (h - t)^2 / 24 inside, so the ends and the bound tell what the guard cannot do there. The
beginning of a step never counts: what holds there was settled when the mode was chosen.
"""

import math

from ..codes import NONE
from ..equations.choice import torques_at
from ..equations.motion import recall
from ..links import response
from ..tableau import END, PARTS, STAGES, THIRDS, fit
from . import guards
from .rosenbrock import look_inside, make_stiff_step, set_part
from .stages import evaluate_stages, exact_guard, solve_changed
from .step_size import STEP_PHASE, advance_of_phase

CROSSING_LOOKS = 100
# phase of the highest harmonic between two looks at a guard, rad
LOOK_PHASE = 1.0
# share of an interval between two looks below which its cubic is the guard: a dip so short moves nothing
SHORTEST = 0.01
# a guard below this share of the speeds, or of the torques, is zero
VELOCITY_ROUNDING = 1e-13
TORQUE_ROUNDING = 1e-13
# ... a play below this share of the whole
PLAY_ROUNDING = 1e-12
# stiff steps tried to end at an event, and how near to it, in tolerances of its range
LANDINGS, SEARCHES = 60, 4
NEAR_SPEED, NEAR_TORQUE = 1e-2, 0.1


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


def find_crossing(d, x, w, which, zero, low, high, sigma, exact):
    """Fraction where the guard falls below -zero between low, where it has not, and high; -1 if it does not.

    Args:
        sigma: where it is looked for first. exact: whether by the equations, where its fit falls but a torque
            may not, or by its fit, which has fallen at high.
    """
    fallen = not exact
    for _ in range(CROSSING_LOOKS):
        value, rate = guards.fitted_guard(x, w, which, sigma)
        if exact:
            value = exact_guard(d, x, w, which, sigma)
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
    value_low, rate_low = guards.fitted_guard(x, w, which, low)
    high = part
    while low < 1.0:
        value, rate = guards.fitted_guard(x, w, which, high)
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
                sigma = find_crossing(d, x, w, which, zero, low, high, high, False)
                if w.pair != THIRDS and guards.is_exact(x, which):
                    # (a torque with a kink may have fallen where its fit has not)
                    sigma = find_crossing(d, x, w, which, zero, 0.0, high, sigma, True)
                if sigma >= 0.0:
                    return sigma
        low = high
        value_low = value
        rate_low = rate
        high = min(1.0, low + min(part, 2.0 * h))
    return -1.0


def guard_tolerance(d, x, w, which, fastest):
    """Threshold below which a guard counts as crossed."""
    if guards.is_play(x, which):
        return PLAY_ROUNDING * (
            d.housing_engagement_angle if which == guards.HOUSING else d.output_engagement_angle
        )
    if guards.is_speed(x, which):
        fastest_output = max(abs(x.omega2), max(abs(x.omega2 + w.change.omega2), abs(x.omega3)))
        imparted = response(d, d.J2) * fastest if d.F_by_alpha1 > 0.0 else 0.0
        return VELOCITY_ROUNDING * max(imparted, fastest_output)
    # (a freewheel feels no load behind a shaft, but the shaft)
    torques = torques_at(d, d.machine, w.prescribed, w.load if d.elastic == 0.0 else 0.0)
    zero = TORQUE_ROUNDING * torques
    if guards.is_spring(x, which):
        # known to the tolerance: as far as it moves neither side by more over the step
        zero = max(zero, w.tolerance * min(torques, min(d.J2, d.J3) * fastest / w.step))
    return zero


def first_event(d, x, w, fastest, cleared):
    """Earliest fall of a guard, but of the one cleared, in the step just made: (part of it or -1, which)."""
    earliest = -1.0
    which = NONE
    inside = False
    looks = 1 + int(math.floor(min(advance_of_phase(d, x, w), STEP_PHASE) / LOOK_PHASE))
    for guard in range(guards.how_many_guards(d)):
        if guard == cleared or not guards.is_watched(d, x, guard):
            continue
        if guards.is_clear(x, w, guard):
            continue
        if w.pair == THIRDS:
            guards.fit_through(x, w, guard)
        else:
            if not inside:
                evaluate_stages(d, x, w, END + 1, STAGES - 1)
                inside = True
            fit(w.step, w.watched[guard].rate, w.watched[guard].dense)
        zero = guard_tolerance(d, x, w, guard, fastest)
        sigma = first_crossing(d, x, w, guard, zero, guards.fourth_bound_of_fit(x, w, guard), looks)
        if sigma > 0.0 and (earliest < 0.0 or sigma < earliest):
            earliest = sigma
            which = guard
    return earliest, which


def land(d, x, w, which, zero, sigma):
    """Make the stiff step end where the guard falls. Returns whether it does."""
    one = w.watched[which]
    low, high = 0.0, w.step
    value_low, value_high = one.value[0], one.value[PARTS]
    share = NEAR_SPEED if guards.is_speed(x, which) else NEAR_TORQUE
    near = max(4.0 * zero, share * w.tolerance * max(abs(value_low), abs(value_high)))
    t = sigma * high
    was_above = False
    for landing in range(LANDINGS):
        make_stiff_step(d, x, w, t)
        solve_changed(d, x, w, w.change)
        value, rate = guards.value_and_rate(d, x, d.machine, which)
        if -near <= value <= 0.0:
            return True
        # a secant that never stays at one end (Illinois)
        above = value > 0.0
        if above:
            low, value_low = t, value
            value_high *= 0.5 if landing > 0 and was_above else 1.0
            if value_high >= 0.0 and landing > SEARCHES:
                return False  # a crossing of the fit alone
        else:
            high, value_high = t, value
            value_low *= 0.5 if landing > 0 and not was_above else 1.0
        was_above = above
        move = low
        if guards.is_speed(x, which) and rate < 0.0:
            move = t - (value + 0.5 * near) / rate
        elif value_high < 0.0 < value_low:
            move = low + (high - low) * (value_low + 0.5 * near) / (value_low - value_high)
        t = move if low < move < high else 0.5 * (low + high)
    return value <= 0.0


def end_at_event(d, x, w, fastest):
    """Let the stiff step end at the first event in it, if any.

    Returns:
        (part of the step that is left or -1, the guard that falls there or NONE).
    """
    h = w.step
    cleared = NONE
    for part in range(1, PARTS + 1):
        look_inside(d, x, w, part)
    recall(x.now, d.machine)
    for _ in range(2):
        sigma, which = first_event(d, x, w, fastest, cleared)
        if sigma < 0.0:
            break
        if land(d, x, w, which, guard_tolerance(d, x, w, which, fastest), sigma):
            return w.step / h, which
        cleared = which  # a crossing of the fit alone: what of the other guards?
        make_stiff_step(d, x, w, h)
    set_part(d, x, w, 1.0)
    return -1.0, NONE
