"""Integration of the mean motion: the L-stable two-stage Rosenbrock method ROS2, to the end of each regime.

Source: Verwer, Spee, Blom and Hundsdorfer, SIAM J. Sci. Comput. 20 (1999), with gamma = 1 - 1 / sqrt 2:

    (1 - gamma h J) k1 = f(y)
    (1 - gamma h J) k2 = f(y + h k1) - 2 k1
    y + h (3 k1 + k2) / 2           of order 2; the embedded y + h k1 is of order 1

The Jacobian J is computed by differences. Angles, impulses and losses are integrated with the two speeds.
"""

import math

from ..accumulate import clear, wrap_drive_angle, wrap_input_angle
from ..codes import OK, STEP_TOO_SMALL, TOO_MUCH_WORK
from ..records import Constants, Doubles, Side, State, Workspace
from .mean_motion import (
    COASTING,
    LOCKED,
    SLIPPING,
    energy_of_mechanism,
    regime_indicator,
    set_regime,
    side_now,
    speed_ratio,
    update_end,
    write_mean_rates,
)

GAMMA = 1.0 - math.sqrt(0.5)
# Minimum tolerance of the embedded error over the largest speed; the mean motion itself is not more accurate
MIN_TOLERANCE = 1e-4
# Change of a speed for the Jacobian over the largest speed
DIFFERENCE_FRACTION = 1e-7
# step-size controller: safety factor, minimum and maximum factor
SAFETY, MIN_FACTOR, MAX_FACTOR = 0.9, 0.1, 5.0
# Maximum internal steps of a communication step, trials of a step, iterations to the end of a regime
MAX_STEPS, MAX_TRIALS, MAX_ITERATIONS = 20000, 60, 60
# Fraction of a step to which the end of a regime is located; fractions of the speeds that count as rest, and
# as the end of coasting
TIME_RTOL, REST_RTOL, SNAP_RTOL = 1e-12, 1e-12, 1e-9
# First step from rest over the communication step
START_RATIO = 1e-9
# Maximum correction of the input speed by the energy balance over this speed
MAX_CORRECTION = 1e-3
# Positions of the two accelerations in fields.MEAN
OMEGA1, OMEGA3 = 0, 1


def differentiate(d: Constants, side: Side, x: State, w: Workspace, regime: int, h: float) -> None:
    """Write the derivatives of all rates by omega1 and omega3 at the beginning of a step, by differences.

    Args:
        d: Constants.
        side: Map for the sign of omega1.
        x: State.
        w: Workspace with the rates at the beginning in w.means[0].
        regime: Regime of the output shaft.
        h: First trial step, s. From rest the speeds after it are the scale of the differences.
    """
    start, by1, by3 = w.means[0].numbers, w.mean_slopes[0].numbers, w.mean_slopes[1].numbers
    gained = h * (abs(start[OMEGA1]) + abs(start[OMEGA3]))
    change = DIFFERENCE_FRACTION * max(abs(x.omega1), x.omega3, min(gained, 1.0), REST_RTOL)
    change1 = side.direction * change
    # Differences away from the end of the regime
    change3 = -change if regime == SLIPPING and x.omega3 > 0.5 * side.end * abs(x.omega1) else change
    write_mean_rates(d, side, x, regime, x.omega1 + change1, x.omega3, w.mean_slopes[0])
    write_mean_rates(d, side, x, regime, x.omega1, x.omega3 + change3, w.mean_slopes[1])
    for n in range(len(start)):
        by1[n] = (by1[n] - start[n]) / change1
        by3[n] = (by3[n] - start[n]) / change3


def solve_stage(w: Workspace, h: float, k: Doubles) -> None:
    """Solve (1 - gamma h J) k = r for all integrated quantities.

    Args:
        w: Workspace with the derivatives.
        h: Step, s.
        k: The right side r, overwritten by the solution: all rates of a stage.
    """
    by1, by3 = w.mean_slopes[0].numbers, w.mean_slopes[1].numbers
    c = GAMMA * h
    a11, a13 = 1.0 - c * by1[OMEGA1], -c * by3[OMEGA1]
    a31, a33 = -c * by1[OMEGA3], 1.0 - c * by3[OMEGA3]
    determinant = a11 * a33 - a13 * a31
    k1 = (a33 * k[OMEGA1] - a13 * k[OMEGA3]) / determinant
    k3 = (a11 * k[OMEGA3] - a31 * k[OMEGA1]) / determinant
    for n in range(len(k)):
        k[n] += c * (by1[n] * k1 + by3[n] * k3)


def make_step(d: Constants, side: Side, x: State, w: Workspace, regime: int, h: float) -> None:
    """Make a step from w.means[0] and the derivatives: changes in w.mean_change, stages in w.mean_stages.

    Args:
        d: Constants.
        side: Map for the sign of omega1.
        x: State at the beginning.
        w: Workspace.
        regime: Regime of the output shaft.
        h: Step, s.
    """
    first, second, change = w.mean_stages[0].numbers, w.mean_stages[1].numbers, w.mean_change.numbers
    start, middle = w.means[0].numbers, w.means[1].numbers
    w.mean_length = h
    for n in range(len(first)):
        first[n] = start[n]
    solve_stage(w, h, first)
    omega1, omega3 = x.omega1 + h * first[OMEGA1], x.omega3 + h * first[OMEGA3]
    write_mean_rates(d, side, x, regime, omega1, omega3, w.means[1])
    for n in range(len(first)):
        second[n] = middle[n] - 2.0 * first[n]
    solve_stage(w, h, second)
    for n in range(len(first)):
        change[n] = 0.5 * h * (3.0 * first[n] + second[n])
    if d.by_torque == 0.0:
        change[OMEGA1] = h * x.alpha1
    if regime == LOCKED:
        change[OMEGA3] = change[OMEGA1]


def step_error(x: State, w: Workspace, tolerance: float) -> float:
    """Return the embedded error of both speeds over the tolerance times the largest speed."""
    first, second = w.mean_stages[0], w.mean_stages[1]
    omega1, omega3 = x.omega1 + w.mean_change.omega1, x.omega3 + w.mean_change.omega3
    fastest = max(abs(x.omega1), abs(omega1), x.omega3, abs(omega3))
    error1, error3 = first.omega1 + second.omega1, first.omega3 + second.omega3
    return 0.5 * w.mean_length * max(abs(error1), abs(error3)) / (tolerance * fastest + 1e-300)


def end_indicator(d: Constants, side: Side, x: State, w: Workspace, regime: int) -> float:
    """Return the event indicator of the regime at the end of the present step."""
    return regime_indicator(
        d, side, x, regime, x.omega1 + w.mean_change.omega1, x.omega3 + w.mean_change.omega3
    )


def end_at_event(d: Constants, side: Side, x: State, w: Workspace, regime: int, beyond: float) -> None:
    """Shorten the present step to the end of the regime by the Illinois method. It ends just after it.

    Args:
        d: Constants.
        side: Map for the sign of omega1.
        x: State at the beginning.
        w: Workspace.
        regime: Regime of the output shaft.
        beyond: Event indicator at the end of the step, positive.
    """
    low, high = 0.0, w.mean_length
    g_low, g_high = regime_indicator(d, side, x, regime, x.omega1, x.omega3), beyond
    if g_low >= 0.0:
        g_low = -beyond  # The step begins at the end of another regime
    last = 0
    end = high
    for _ in range(MAX_ITERATIONS):
        if high - low <= TIME_RTOL * end:
            break
        middle = high - g_high * (high - low) / (g_high - g_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        make_step(d, side, x, w, regime, middle)
        g = end_indicator(d, side, x, w, regime)
        if g > 0.0:
            high, g_high = middle, g
            g_low *= 0.5 if last > 0 else 1.0
            last = 1
        else:
            low, g_low = middle, g
            g_high *= 0.5 if last < 0 else 1.0
            last = -1
            if g == 0.0 and middle > TIME_RTOL * end:
                return
    # A shorter step could be lost in the round-off of the time
    make_step(d, side, x, w, regime, max(high, TIME_RTOL * end))


def advance_regime(
    d: Constants, side: Side, x: State, w: Workspace, regime: int, limit: float
) -> tuple[bool, bool]:
    """Make one step within the tolerance, up to the end of the regime.

    Args:
        d: Constants.
        side: Map for the sign of omega1.
        x: State at the beginning.
        w: Workspace with the tolerance.
        regime: Regime of the output shaft.
        limit: Longest step, s.

    Returns:
        (is_accepted, has_ended): True if a step satisfies the tolerance; True if the regime ends with it.
    """
    write_mean_rates(d, side, x, regime, x.omega1, x.omega3, w.means[0])
    if x.omega1 == 0.0 and x.omega3 == 0.0 and (regime == SLIPPING or regime == COASTING):
        # The speed ratio is undefined until both move, so the first step is very small and explicit
        clear(w.mean_slopes[0].numbers)
        clear(w.mean_slopes[1].numbers)
        x.mean_step = START_RATIO * limit
        make_step(d, side, x, w, regime, x.mean_step)
        return True, False
    h = min(x.mean_step if x.mean_step > 0.0 else limit, limit)
    differentiate(d, side, x, w, regime, h)
    tolerance = max(w.tolerance, MIN_TOLERANCE)
    for _ in range(MAX_TRIALS):
        make_step(d, side, x, w, regime, h)
        error = step_error(x, w, tolerance)
        factor = SAFETY / math.sqrt(error) if error > 0.0 else MAX_FACTOR
        factor = min(max(factor, MIN_FACTOR), MAX_FACTOR)
        if error <= 1.0:
            x.mean_step = max(x.mean_step, factor * h) if h == limit else factor * h
            beyond = end_indicator(d, side, x, w, regime)
            if beyond > 0.0:
                end_at_event(d, side, x, w, regime, beyond)
            return True, beyond > 0.0
        h *= factor
        x.mean_step = h
    return False, False


def energy_gained(d: Constants, side: Side, x: State, omega1: float, omega3: float) -> float:
    """Return the kinetic energy that the mechanism and the output shaft gain in a step to these speeds, J.

    Args:
        d: Constants; d.steady is written for the end of the step.
        side: Map for the sign of omega1.
        x: State at the beginning.
        omega1: Input speed at the end, rad/s.
        omega3: Speed of the output shaft at the end, rad/s.
    """
    before = energy_of_mechanism(d, side, x, x.omega1, x.omega3)
    gained = energy_of_mechanism(d, side, x, omega1, omega3) - before
    return gained + 0.5 * d.J3 * (omega3 - x.omega3) * (x.omega3 + omega3)


def balanced_speed(
    d: Constants, side: Side, x: State, regime: int, omega1: float, omega3: float, gain: float
) -> float:
    """Return the input speed at which a torque-driven step has gained the energy ``gain``, rad/s.

    One iteration of Newton's method corrects the integrated speed.

    Args:
        d: Constants.
        side: Map for the sign of omega1.
        x: State at the beginning.
        regime: Regime of the output shaft.
        omega1: Input speed at the end, rad/s.
        omega3: Speed of the output shaft at the end, rad/s.
        gain: Energy that the step must gain, J.
    """
    difference = gain - energy_gained(d, side, x, omega1, omega3)
    s = min(speed_ratio(omega3, abs(omega1)), side.end)
    inertia = d.J1 + d.steady.inertia - (0.5 * s * d.steady.slope if regime == SLIPPING else 0.0)
    if regime == LOCKED:
        inertia += d.J3
    correction = difference / (inertia * omega1) if omega1 != 0.0 else 0.0
    return omega1 + correction if abs(correction) < MAX_CORRECTION * abs(omega1) else omega1


def accept_step(d: Constants, side: Side, x: State, w: Workspace, regime: int) -> None:
    """Add the present step to the state and its sums by an energy balance.

    Speed-driven, the balance gives the input work. Torque-driven, it gives a small correction of the input
    speed.

    Args:
        d: Constants.
        side: Map for the sign of omega1.
        x: State.
        w: Workspace.
        regime: Regime of the output shaft.
    """
    change = w.mean_change
    omega1, omega3 = x.omega1 + change.omega1, x.omega3 + change.omega3
    lost = 0.0
    for cause in range(len(change.lost)):
        x.lost[cause] += change.lost[cause]
        lost += change.lost[cause]
    used = x.load_torque * change.theta3 + lost
    if d.by_torque == 0.0:
        gain = energy_gained(d, side, x, omega1, omega3)
        x.energy_in += gain + used
    else:
        work = x.drive_torque * change.theta1
        x.energy_in += work
        omega1 = balanced_speed(d, side, x, regime, omega1, omega3, work - used)
    x.step_lost += lost
    x.energy_out += x.load_torque * change.theta3
    x.theta1 += change.theta1
    wrap_input_angle(x)
    x.q += d.k * (change.theta1 - change.theta2)
    wrap_drive_angle(d, x)
    x.turned3 += change.theta3
    x.omega1, x.omega3 = omega1, omega3
    x.input_impulse += change.drive
    x.output_impulse += change.output
    x.housing_impulse += change.output + d.b2 * change.theta2 - change.mesh


def set_to_limits(side: Side, x: State, regime: int, has_ended: bool) -> None:
    """Set speeds at the end of a regime exactly to its limit.

    Args:
        side: Map for the sign of omega1.
        x: State.
        regime: Regime of the step.
        has_ended: True if the regime ends.
    """
    if regime == LOCKED:
        x.omega3 = x.omega1
    if not has_ended:
        return
    limit = side.end * abs(x.omega1)
    if regime == SLIPPING:
        x.omega3 = limit if x.omega3 > 0.5 * limit else 0.0
    elif regime == COASTING and x.omega3 - limit <= SNAP_RTOL * x.omega3:
        x.omega3 = limit


def run_averaged(d: Constants, x: State, w: Workspace, h: float) -> int:
    """Advance the mean motion by a communication step.

    Args:
        d: Constants.
        x: State with the inputs of the step.
        w: Workspace.
        h: Communication step, s.

    Returns:
        Status.
    """
    start = x.omega1
    time = 0.0
    for _ in range(MAX_STEPS):
        side = side_now(d, x)
        regime = set_regime(d, side, x)
        limit = h - time
        # A prescribed speed changes its sign, and the map with it
        reaches_zero = (
            d.by_torque == 0.0 and x.omega1 * x.alpha1 < 0.0 and abs(x.omega1) < abs(x.alpha1) * limit
        )
        if reaches_zero:
            limit = -x.omega1 / x.alpha1
        is_accepted, has_ended = advance_regime(d, side, x, w, regime, min(limit, d.max_step))
        if not is_accepted:
            return STEP_TOO_SMALL
        accept_step(d, side, x, w, regime)
        arrives = w.mean_length >= limit
        time += w.mean_length
        if d.by_torque == 0.0:
            x.omega1 = 0.0 if reaches_zero and arrives else start + x.alpha1 * time
        elif has_ended and side.direction * x.omega1 <= REST_RTOL * x.omega3:
            x.omega1 = 0.0
        set_to_limits(side, x, regime, has_ended)
        if arrives and not reaches_zero:
            update_end(d, x)
            return OK
    return TOO_MUCH_WORK
