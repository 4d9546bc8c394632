"""Periodic orbit of the mechanism at constant input and output speed: one period of the pinion shaft.

The output shaft is so heavy that its speed is constant. Link 2 then has a return map: its speed at the end of
a period over its speed at the beginning. The map never decreases, and a fixed point lies between 0 and the
speed of the output. The period begins where link 2 is at rest in nearly all orbits; the first period is then
the orbit.

Torque-driven, the input torque and the initial input speed are unknown as well. A fixed-point iteration
adjusts them until the energy at the end of the period is equal to its initial value and the mean input speed
is correct.
"""

import math

from ..accumulate import TWO_PI, clear, copy
from ..equations.choice import select_mode, select_mode_after_event
from ..events.advance import advance_to_event
from ..inertia import reduced_inertia
from ..inputs import reset_sums
from ..links import energy_of_links, kinetic_energy
from ..records import Constants, State, Workspace

# Inertia of the output shaft over the inertia of the mechanism
HELD_INERTIA_RATIO = 1e12
# Maximum period, revolutions of the pinion shaft; it replaces a longer period
MAX_REVOLUTIONS = 1000.0
# Maximum number of periods in the search for the fixed point
MAX_PERIODS = 30
# Change of omega2 over a period that counts as 0, over omega1
OMEGA2_ATOL = 1e-5
# Energy gain that counts as 0, over the kinetic energy, and allowed relative error of the mean input speed
ENERGY_RTOL = 1e-4
# Number of corrections of the input torque before the secant method extrapolates them, and its maximum factor
N_PLAIN_CORRECTIONS, MAX_SECANT_FACTOR = 12, 10.0
# Maximum internal steps of a period, and evaluations of the equations of motion for a map
MAX_STEPS = 200000
MAX_EVALUATIONS = 6e7
# Fraction of a period that counts as its end
END_RTOL = 1e-9
# Maximum time of a period over its time at the smallest constant slip; after it links 1 and 2 stick together
MAX_TIME_RATIO = 4.0
# No limit of an internal step, s
NO_LIMIT = 1e9
# Samples in a cycle of the highest harmonic in the search for a maximum
SAMPLES = 48
# Phase of the highest harmonic between the beginning of the period and the release of link 2, rad
HEAD_START = 0.5

# Kinds of quantities whose maximum over the period is needed, at the input speed 1: inertia I of the
# imbalances; torque that locks links 1 and 2; momentum of links 1 and 2 while link 2 is at rest; speed of
# link 2 in free flight; negative square of its slip
INERTIA, LOCK_TORQUE, MOMENTUM, FLIGHT_SPEED, FLIGHT_SLIP = 0, 1, 2, 3, 4


def hold_output(d: Constants) -> None:
    """Set the inertia of the output shaft so large that no torque changes its speed."""
    d.J3 = HELD_INERTIA_RATIO * (d.J2 + d.F_by_alpha1)
    d.max_step = NO_LIMIT


def period_length(d: Constants) -> float:
    """Return the angle of the pinion shaft, rad, after which the reduced inertia repeats."""
    # With three or more satellites the reduced inertia depends only on the angle B
    length = TWO_PI / d.s if d.satellites > 2.0 and d.planar == 0.0 else d.period
    return min(length, TWO_PI * MAX_REVOLUTIONS)


def quantity(d: Constants, kind: int, direction: float, momentum: float, q: float) -> float:
    """Return a quantity (INERTIA to FLIGHT_SLIP) at an angle of the pinion shaft and the input speed 1.

    In free flight from rest at constant input speed Jacobi's integral holds:

        (J2 + k^2 G) (omega1 - omega2)^2 - I = constant

    Args:
        d: Constants.
        kind: INERTIA, LOCK_TORQUE, MOMENTUM, FLIGHT_SPEED or FLIGHT_SLIP.
        direction: Sign of omega1.
        momentum: Momentum at which link 2 is released, kg m^2.
        q: Angle of the pinion shaft, rad.
    """
    i, i1, _, _, g, _ = reduced_inertia(d, q)
    if kind == INERTIA:
        return i
    if kind == LOCK_TORQUE:
        return -0.5 * d.k * i1
    if kind == MOMENTUM:
        return direction * (i - d.k * d.k * g)
    square = (d.J2 + i - direction * momentum) / (d.J2 + d.k * d.k * g)
    if kind == FLIGHT_SLIP:
        return -square
    return direction * (1.0 - math.sqrt(max(square, 0.0)))


def maximum(d: Constants, kind: int, direction: float, momentum: float) -> tuple[float, float]:
    """Return the maximum of a quantity over the period: samples, and the parabola through the highest three.

    Args:
        d: Constants.
        kind: See quantity.
        direction: Sign of omega1.
        momentum: See quantity.

    Returns:
        (angle, maximum): rad, and the unit of the quantity at the input speed 1.
    """
    length = period_length(d)
    count = int(math.ceil(length * d.harmonic / TWO_PI)) * SAMPLES
    width = length / count
    best_q, best = 0.0, -1e300
    before = quantity(d, kind, direction, momentum, -width)
    here = quantity(d, kind, direction, momentum, 0.0)
    for n in range(count):
        after = quantity(d, kind, direction, momentum, (n + 1) * width)
        if here > best and before <= here >= after:
            best_q, best = n * width, here
            curvature = before - 2.0 * here + after
            if curvature < 0.0:
                best_q += 0.5 * width * (before - after) / curvature
                best = here - 0.125 * (after - before) * (after - before) / curvature
        before = here
        here = after
    return best_q, best


def release_angle(d: Constants, direction: float) -> float:
    """Return an angle of the pinion shaft at which link 2 is at rest in each period, rad.

    The strongest pulse releases link 2 at the maximum of the momentum of links 1 and 2. The angle is
    HEAD_START before it.
    """
    return maximum(d, MOMENTUM, direction, 0.0)[0] - direction * HEAD_START / d.harmonic


def angle_travelled(x: State) -> float:
    """Return the angle of the pinion shaft since the sums of the state began, rad."""
    return x.q - x.begin_q + TWO_PI * (x.drive_turns - x.begin_drive_turns)


def energy_midway(d: Constants, before: State, after: State, time: float) -> float:
    """Return the kinetic energy of links 1 and 2 at the middle of a step by cubic Hermite interpolation, J.

    Args:
        d: Constants.
        before: State at the beginning of the step.
        after: State at its end.
        time: Length of the step, s.
    """
    turned = angle_travelled(after) - angle_travelled(before)
    slip0, slip1 = before.omega1 - before.omega2, after.omega1 - after.omega2
    slip = 1.5 * turned / (d.k * time) - 0.25 * (slip0 + slip1)
    omega1 = 0.5 * (before.omega1 + after.omega1)
    i, _, b, _, g, _ = reduced_inertia(d, before.q + 0.5 * turned + 0.125 * time * d.k * (slip0 - slip1))
    return energy_of_links(d, i, b, g, omega1, omega1 - slip)


def integrate_period(d: Constants, x: State, w: Workspace, length: float) -> float:
    """Integrate the motion over an angle of the pinion shaft and write its mean energy to w.orbit_energy.

    A step that passes the end is repeated with the fraction of its time that a constant slip needs.

    Args:
        d: Constants.
        x: State at the beginning of the period.
        w: Workspace.
        length: Angle, rad.

    Returns:
        Time of the period, s, or -1 if links 1 and 2 stick together in this period.
    """
    before = w.saved
    time = energy = 0.0
    slowest = max(abs(x.omega1) - x.omega3, 1e-6 * abs(x.omega1))
    if x.omega1 < 0.0:
        slowest = abs(x.omega1)
    longest = MAX_TIME_RATIO * length / (d.k * slowest)
    limit = longest
    left = length
    e0 = kinetic_energy(d, x.q, x.omega1, x.omega2, 0.0)
    for _ in range(MAX_STEPS):
        copy(before.numbers, x.numbers)
        passed, event = advance_to_event(d, x, w, limit)
        if passed < 0.0 or time > longest:
            return -1.0
        remaining = length - abs(angle_travelled(x))
        if remaining < -END_RTOL * length:
            copy(x.numbers, before.numbers)
            x.rates_cached = 0.0
            limit = passed * left / (left - remaining)
            continue
        e1 = kinetic_energy(d, x.q, x.omega1, x.omega2, 0.0)
        if passed > 0.0:
            energy += passed / 6.0 * (e0 + 4.0 * energy_midway(d, before, x, passed) + e1)
        e0 = e1
        time += passed
        left = remaining
        if event:
            select_mode_after_event(d, x)
            e0 = kinetic_energy(d, x.q, x.omega1, x.omega2, 0.0)
        if left <= END_RTOL * length:
            w.orbit_energy = energy / time
            return time
        slip = abs(x.omega1 - x.omega2)
        limit = longest
        if d.k * slip * longest > left:
            limit = left / (d.k * slip)
    return -1.0


def begin_period(d: Constants, x: State, w: Workspace, omega1: float, omega2: float, omega3: float) -> None:
    """Set the state at the beginning of a period. The remaining engagement angles do not change.

    Args:
        d: Constants.
        x: State.
        w: Workspace with orbit_start and orbit_torque.
        omega1: Speed of link 1, rad/s.
        omega2: Speed of link 2, rad/s.
        omega3: Speed of the output shaft, rad/s.
    """
    play_housing, play_output = x.play_housing, x.play_output
    clear(x.numbers)
    x.play_housing, x.play_output = play_housing, play_output
    x.q = w.orbit_start % d.period
    x.omega1 = omega1
    x.omega2 = omega2
    x.omega3 = omega3
    x.last_input_speed = omega1
    x.drive_torque = w.orbit_torque if d.by_torque != 0.0 else 0.0
    w.prescribed = x.drive_torque
    w.load = 0.0
    select_mode(d, x, 0.0)
    reset_sums(x)


def input_angle(x: State) -> float:
    """Return the angle of link 1 since the sums of the state began, rad."""
    return x.theta1 - x.begin_theta1 + TWO_PI * (x.input_turns - x.begin_input_turns)


def correction_factor(corrections: int, change: float, reduction: float) -> float:
    """Return the factor of a correction of the input torque: 1, or later the factor of the secant method.

    Args:
        corrections: Number of previous corrections.
        change: Last change of the torque, N m.
        reduction: Decrease of the missing torque by this change, N m.
    """
    if corrections < N_PLAIN_CORRECTIONS or reduction == 0.0:
        return 1.0
    return min(max(change / reduction, 1.0), MAX_SECANT_FACTOR)


def find_orbit(d: Constants, x: State, w: Workspace, omega1: float, ratio: float, length: float) -> float:
    """Find the periodic orbit at a mean input speed and a ratio. The state then holds the sums of its period.

    The fixed point of the return map is bracketed. The first four guesses of the initial speed of link 2 are:
    rest, the final speed of this period, the speed of the output, the final speed of this period. Then secant
    and bisection alternate.

    Args:
        d: Constants with a held output (see hold_output).
        x: State.
        w: Workspace with tolerance, orbit_start and, torque-driven, a first guess of orbit_torque.
        omega1: Mean input speed, rad/s, not 0.
        ratio: omega3 / |omega1|.
        length: Angle of a period, rad.

    Returns:
        Time of the period, s, or -1 if there is no orbit.
    """
    speed = abs(omega1) * ratio
    atol = OMEGA2_ATOL * abs(omega1)
    low, high = 0.0, speed
    gain = loss = 0.0
    begin, begin1 = 0.0, omega1
    corrections = 0
    last_torque = last_missing = 0.0
    guesses = 0
    x.play_housing = 0.0
    x.play_output = d.output_engagement_angle
    time = -1.0
    for _ in range(MAX_PERIODS):
        begin_period(d, x, w, begin1, begin, speed)
        begin_energy = kinetic_energy(d, x.q, x.omega1, x.omega2, 0.0)
        time = integrate_period(d, x, w, length)
        d.map_evaluations += x.step_evaluations
        if d.map_evaluations > MAX_EVALUATIONS:
            return -1.0
        turned = input_angle(x)
        gained = kinetic_energy(d, x.q, x.omega1, x.omega2, 0.0) - begin_energy
        if time < 0.0:
            # Losses nearly stop link 1 within the period, because the torque is too small
            if d.by_torque == 0.0 or w.orbit_torque != 0.0 or turned * omega1 <= 0.0:
                return -1.0
            w.orbit_torque -= gained / turned
            continue
        end = min(x.omega2, speed)
        change = end - begin
        if d.by_torque != 0.0:
            scale = omega1 * time / turned
            is_periodic = abs(gained) <= ENERGY_RTOL * w.orbit_energy and abs(scale - 1.0) <= ENERGY_RTOL
            if not is_periodic:
                # Torque and energy scale with the square of the speed. Losses that grow with the torque
                # reduce the effect of a correction
                missing = -gained / turned * scale * scale
                torque = w.orbit_torque * scale * scale
                factor = correction_factor(corrections, torque - last_torque, last_missing - missing)
                corrections += 1
                last_torque, last_missing = torque, missing
                w.orbit_torque = torque + missing * factor
                begin1 *= scale
                begin = end
                continue
        if abs(change) <= atol or high - low <= atol:
            return time
        if change > 0.0:
            low, gain = begin, change
        else:
            high, loss = begin, -change
        guesses += 1
        begin = end
        if guesses == 2:
            begin = speed
        elif guesses > 3:
            begin = low + (gain / (gain + loss) if guesses % 2 == 0 else 0.5) * (high - low)
    return time
