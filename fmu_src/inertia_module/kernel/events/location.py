"""Event location: the fraction of the present step at which an event indicator first falls through zero.

The dense output is sampled. The first interval in which the indicator falls is narrowed by the Illinois
method (M. Dowell and P. Jarratt, A modified regula falsi method, BIT 11, 1971, 168). A torque that ends a
contact mode is evaluated by the equations of motion, because the dense output is less accurate than the step.
"""

from ..codes import NO_EVENT
from ..equations.choice import torque_magnitude
from ..links import response
from ..records import Constants, State, Workspace
from ..tableau import DOP853_LAST_STAGE, DOP853_ROW, N_STAGES, fit_dense_output
from . import guards
from .error import fastest_link
from .guards import fitted_guard
from .stages import evaluate_stages, exact_guard

SAMPLES = 16  # Points of the dense output at which an indicator is sampled
MAX_ITERATIONS = 100
# Fraction of speeds and torques, and of the engagement angle, below which an indicator is zero
INDICATOR_RTOL, PLAY_RTOL = 1e-13, 1e-12


def illinois(
    d: Constants,
    x: State,
    w: Workspace,
    which: int,
    zero: float,
    low: float,
    value_low: float,
    high: float,
    value_high: float,
    by_equations: bool,
) -> float:
    """Return the fraction of the step at which an indicator has just fallen below -zero.

    Args:
        d: Constants.
        x: State at the beginning of the step.
        w: Workspace with the present step.
        which: Number of the indicator.
        zero: Threshold of the indicator; the search ends between -3 zero and -zero.
        low: Fraction of the step at which the indicator has not yet fallen below -zero.
        value_low: Indicator there, at least -zero.
        high: Fraction of the step at which it has fallen below -zero.
        value_high: Indicator there, below -zero.
        by_equations: True to evaluate the indicator by the equations of motion, False by the dense output.
    """
    value_low += 2.0 * zero
    value_high += 2.0 * zero
    side = 0
    for _ in range(MAX_ITERATIONS):
        if abs(value_high) <= zero:
            break
        sigma = high - value_high * (high - low) / (value_high - value_low)
        if not low < sigma < high:
            sigma = 0.5 * (low + high)
        if not low < sigma < high:
            break
        value = 2.0 * zero
        value += exact_guard(d, x, w, which, sigma) if by_equations else fitted_guard(x, w, which, sigma)
        if value <= zero:
            high, value_high = sigma, value
            if side < 0:
                value_low *= 0.5
            side = -1
        else:
            low, value_low = sigma, value
            if side > 0:
                value_high *= 0.5
            side = 1
    return high


def lowest_point(before: float, here: float, after: float) -> float:
    """Return the lowest point of the parabola through three samples, in sample intervals from the middle one.

    It is 0 if the middle sample is not the lowest one.
    """
    if here > before or here >= after:
        return 0.0
    return 0.5 * (before - after) / (before - 2.0 * here + after)


def fall_between(
    d: Constants,
    x: State,
    w: Workspace,
    which: int,
    zero: float,
    low: float,
    value_low: float,
    high: float,
    value_high: float,
) -> float:
    """Return the fraction of the step at which an indicator falls, or -1 if its torque does not fall.

    Args:
        d: Constants.
        x: State at the beginning of the step.
        w: Workspace with the present step.
        which: Number of the indicator.
        zero: Threshold of the indicator.
        low: Fraction of the step at which its dense output has not fallen.
        value_low: Dense output there.
        high: Fraction of the step at which its dense output has fallen below -zero.
        value_high: Dense output there.
    """
    sigma = illinois(d, x, w, which, zero, low, value_low, high, value_high, False)
    if which >= guards.FLOW or guards.is_speed(x, which):
        return sigma
    value = exact_guard(d, x, w, which, sigma)
    if value < -zero:
        return illinois(d, x, w, which, zero, low, max(value_low, -zero), sigma, value, True)
    value_high = exact_guard(d, x, w, which, high)
    if value_high < -zero:
        return illinois(d, x, w, which, zero, sigma, value, high, value_high, True)
    return -1.0


def first_fall(d: Constants, x: State, w: Workspace, which: int, zero: float) -> float:
    """Return the fraction of the step at which an indicator first falls below -zero, or -1.

    Between two samples the lowest point of the parabola through three samples is tested.
    """
    interval = 1.0 / SAMPLES
    low = 0.0
    value_before = value_low = fitted_guard(x, w, which, 0.0)
    for n in range(1, SAMPLES + 1):
        high = n * interval
        value_high = fitted_guard(x, w, which, high)
        sigma = -1.0
        offset = lowest_point(value_before, value_low, value_high) if n > 1 else 0.0
        lowest = low + offset * interval
        value_lowest = fitted_guard(x, w, which, lowest) if offset != 0.0 else 0.0
        if value_lowest < -zero:
            begin, value_begin = (low, value_low) if offset > 0.0 else (low - interval, value_before)
            sigma = fall_between(d, x, w, which, zero, begin, value_begin, lowest, value_lowest)
        if sigma < 0.0 and value_high < -zero:
            sigma = fall_between(d, x, w, which, zero, low, value_low, high, value_high)
        if sigma >= 0.0:
            return sigma
        low, value_before, value_low = high, value_low, value_high
    return -1.0


def guard_tolerance(d: Constants, x: State, w: Workspace, which: int) -> float:
    """Return the threshold below which an indicator counts as zero."""
    links = fastest_link(x, w.change)
    if guards.is_play(x, which):
        return PLAY_RTOL * (
            d.housing_engagement_angle if which == guards.HOUSING else d.output_engagement_angle
        )
    if guards.is_speed(x, which):
        fastest_output = max(abs(x.omega2), max(abs(x.omega2 + w.change.omega2), abs(x.omega3)))
        imparted = response(d, d.J2) * links if d.F_by_alpha1 > 0.0 else 0.0
        return INDICATOR_RTOL * max(imparted, fastest_output)
    # The load acts on a freewheel only through an elastic shaft
    torques = torque_magnitude(d, d.machine, w.prescribed, w.load if d.elastic == 0.0 else 0.0)
    zero = INDICATOR_RTOL * torques
    if guards.is_spring(x, which):
        # The deflection of a spring is only accurate to the tolerance
        zero = max(zero, w.tolerance * min(torques, min(d.J2, d.J3) * links / w.step))
    return zero


def first_event(d: Constants, x: State, w: Workspace) -> tuple[float, int]:
    """Return the fraction of the present step at which the first event occurs, and its indicator.

    It is 1 and NO_EVENT if there is no event. An accepted step of the pair 5(4) contains none
    (step_size.try_short_step).

    Args:
        d: Constants; ``d.machine`` is written.
        x: State at the beginning of the step.
        w: Workspace with the step; the dense output is written.
    """
    earliest, which = -1.0, NO_EVENT
    has_dense_output = False
    for guard in range(guards.n_indicators(d) if w.pair == DOP853_ROW else 0):
        if not guards.is_watched(d, x, guard) or guards.is_clear(x, w, guard):
            continue
        if not has_dense_output:
            evaluate_stages(d, x, w, DOP853_LAST_STAGE + 1, N_STAGES - 1)
            has_dense_output = True
        fit_dense_output(w.step, w.indicators[guard].rate, w.indicators[guard].dense)
        sigma = first_fall(d, x, w, guard, guard_tolerance(d, x, w, guard))
        if sigma > 0.0 and (earliest < 0.0 or sigma < earliest):
            earliest = sigma
            which = guard
    return earliest if which != NO_EVENT else 1.0, which
