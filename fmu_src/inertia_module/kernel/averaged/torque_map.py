"""Torque map of fidelity averaged: means of periodic orbits over the speed ratio and the slowness.

Without friction all torques scale with omega1^2: one orbit per ratio omega3 / |omega1| is sufficient.
Relative to omega1^2, viscous friction b scales with b / |omega1| and drag D with D / omega1^2. Torques are
therefore divided by V^2 with V = |omega1| + V0. V0 is the input speed at which friction and drag consume the
stall torque. The quotients are nearly parabolas of the slowness V0 / V, which is 0 at infinite speed and 1 at
rest. Load-dependent losses scale with omega1^2 as well.

The ratios of the grid are fixed fractions of the last ratio (RATIOS). The slownesses are not fixed, because
the torque has kinks at which the pulses no longer move link 2. Each new slowness halves the interval with the
largest interpolation error (equidistribution: de Boor, 1978, A Practical Guide to Splines). Between the
points all curves are monotone cubics (Fritsch & Carlson, 1980, SIAM Journal on Numerical Analysis 17). Over
the ratio they have the slopes of Fritsch & Butland (1984, SIAM Journal on Scientific and Statistical
Computing 5); over the slowness they have the slopes of parabolas, limited as by Hyman (1983, same journal 4).
Near rest only friction and drag act, and the speed of link 2 is constant.

Friction of link 1 and of the output shaft is exact without a map. Torque-driven, an orbit has the constant
input torque at which its energy is periodic; it depends on J1.
"""

import math

from ..accumulate import clear, copy, total
from ..codes import NO_CYCLIC_STEADY_STATE, OK
from ..equations.losses import FREEWHEEL, JOURNAL, MESH, VISCOUS
from ..parameters import derive_constants
from ..records import Column, Constants, Parameters, Side, State, Steady, Workspace
from .periodic_orbit import (
    FLIGHT_SLIP,
    FLIGHT_SPEED,
    INERTIA,
    LOCK_TORQUE,
    MOMENTUM,
    angle_travelled,
    find_orbit,
    hold_output,
    maximum,
    period_length,
    release_angle,
)

# Speed ratios of the grid over the last ratio, closer at both ends
RATIOS = (
    *(0.0, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.26, 0.32, 0.38, 0.44),
    *(0.5, 0.56, 0.62, 0.69, 0.76, 0.82, 0.88, 0.93, 0.97, 1.0),
)
# First slownesses of the grid; at the last N_FRICTION_ONLY only friction and drag act
FIRST_SLOWNESSES = (0.0, 0.25, 0.5, 0.75, 0.99, 1.0)
N_FRICTION_ONLY = 2
# Number of slownesses of the complete grid
SLOWNESSES = 15
# Evaluations of the equations of motion on one side of the map after which new slownesses have no orbits
MAX_REFINEMENT_EVALUATIONS = 1e7
# Causes of losses in the map
LOSSES = (VISCOUS, MESH, JOURNAL, FREEWHEEL)
# Positions in a column of the map (fields.COLUMN)
TORQUE, LINK2, LOST = 0, SLOWNESSES, 2 * SLOWNESSES
ENERGY = LOST + len(LOSSES) * SLOWNESSES
RIPPLE, PEAK = ENERGY + 1, ENERGY + 2
# Ratio of the first orbit over the last ratio, not 0 because the drag of the output freewheel acts only while
# the output turns; distance of the last orbit from the last ratio, over this ratio
FIRST_RATIO, LAST_SLIP = 1e-4, 2e-3
# Square of the minimum slip in free flight, over omega1^2, below which link 2 reaches link 1
LOCK_SLIP_SQUARED = 1e-9
# Relative tolerance of an orbit
ORBIT_TOLERANCE = 1e-6
# Minimum stall torque in the formula of V0 over the bound of the mesh torque, both over omega1^2
MIN_STALL_RATIO = 0.01
# Growth of the last ratio at negative input speed, where load-dependent losses release link 2 later and
# faster: factor, maximum number of repetitions, torque over the bound of the mesh torque that counts as 0
GROWTH, MAX_GROWTHS, NO_TORQUE_RATIO = 1.1, 8, 1e-4
# Last ratio of a mechanism that transmits no torque
MIN_LAST_RATIO = 0.01
# Minimum input speed over V0, for rest
REST_SPEED_RATIO = 1e-6
# Minimum inertia J1 over the maximum inertia I of the imbalances, torque-driven
MIN_INPUT_INERTIA_RATIO = 5.0


def is_light_input(d: Constants) -> bool:
    """Return True if a torque-driven link 1 is too light relative to the imbalances for a mean motion."""
    max_inertia = maximum(d, INERTIA, 1.0, 0.0)[1]
    return d.by_torque != 0.0 and d.J1 < MIN_INPUT_INERTIA_RATIO * max_inertia


def make_cell(
    left: float, width: float, right: float, t: float
) -> tuple[float, float, float, float, float, float]:
    """Return the coefficients for cubic that depend only on the positions of the points.

    Args:
        left: Distance from the point before the interval; 0 if the interval is the first one.
        width: Width of the interval.
        right: Distance from the interval to the point after it; 0 if the interval is the last one.
        t: Distance from the beginning of the interval.

    Returns:
        (1/left, 1/width, 1/right, weight0, weight1, t): inverse distances, 0 if there is no point; weights of
        the neighbouring secant in the slopes at both ends of the interval; t.
    """
    per_left = 1.0 / left if left > 0.0 else 0.0
    per_right = 1.0 / right if right > 0.0 else 0.0
    weight0 = width / (left + width) if left > 0.0 else -width / (width + right)
    weight1 = width / (width + right) if right > 0.0 else -width / (left + width)
    return per_left, 1.0 / width, per_right, weight0, weight1, t


def limited_slope(rise: float, other: float, weight: float, is_end: bool, is_harmonic: bool) -> float:
    """Return the slope at a point for a monotone cubic.

    It is the slope of the parabola through three points, limited; or, between the first and the last point,
    the weighted harmonic mean of both secants.

    Args:
        rise: Slope of the secant of the interval.
        other: Slope of the secant of the neighbouring interval. At the first and the last point of the curve
            it is the only neighbour, on the other side of the interval.
        weight: Weight of ``other``.
        is_end: True at the first and the last point of the curve.
        is_harmonic: True for the harmonic mean.
    """
    slope = rise + weight * (other - rise)
    if is_end:
        return max(min(slope / rise, 3.0), 0.0) * rise if rise != 0.0 else 0.0
    if is_harmonic:
        mean = (1.0 + weight) * rise + (2.0 - weight) * other
        return 3.0 * rise * other / mean if rise * other > 0.0 else 0.0
    limit = 3.0 * min(abs(rise), abs(other))
    return min(max(slope, -limit), limit)


def cubic(
    cell: tuple[float, float, float, float, float, float],
    a: float,
    b: float,
    c: float,
    e: float,
    is_harmonic: bool,
) -> tuple[float, float]:
    """Interpolate a curve between two of its points.

    Args:
        cell: Coefficients of the interval (make_cell).
        a: Value at the point before.
        b: Value at the beginning of the interval.
        c: Value at its end.
        e: Value at the point after.
        is_harmonic: True if the slopes are harmonic means of secants (limited_slope).

    Returns:
        (value, slope).
    """
    per_left, per_width, per_right, weight0, weight1, t = cell
    before, rise, after = (b - a) * per_left, (c - b) * per_width, (e - c) * per_right
    is_first, is_last = per_left == 0.0, per_right == 0.0
    m0 = limited_slope(rise, after if is_first else before, weight0, is_first, is_harmonic)
    m1 = limited_slope(rise, before if is_last else after, weight1, is_last, is_harmonic)
    c2, c3 = (3.0 * rise - 2.0 * m0 - m1) * per_width, (m0 + m1 - 2.0 * rise) * per_width * per_width
    return b + t * (m0 + t * (c2 + t * c3)), m0 + t * (2.0 * c2 + 3.0 * t * c3)


def ratio_interval(side: Side, s: float) -> int:
    """Return the number of the interval of the map that contains the ratio s."""
    n = 0
    while n < len(RATIOS) - 2 and s >= side.end * RATIOS[n + 1]:
        n += 1
    return n


def ratio_cell(side: Side, n: int, s: float) -> tuple[float, float, float, float, float, float]:
    """Return the coefficients of a ratio for cubic.

    Args:
        side: Map for one sign of omega1.
        n: Number of the interval.
        s: Speed ratio.
    """
    left = side.end * (RATIOS[n] - RATIOS[n - 1]) if n > 0 else 0.0
    right = side.end * (RATIOS[n + 2] - RATIOS[n + 1]) if n < len(RATIOS) - 2 else 0.0
    return make_cell(left, side.end * (RATIOS[n + 1] - RATIOS[n]), right, s - side.end * RATIOS[n])


def slowness_interval(side: Side, z: float) -> int:
    """Return the number of the interval of the map that contains the slowness z."""
    m = 0
    while m < len(side.slowness) - 2 and z >= side.slowness[m + 1]:
        m += 1
    return m


def slowness_cell(side: Side, m: int, z: float) -> tuple[float, float, float, float, float, float]:
    """Return the coefficients of a slowness for cubic.

    Args:
        side: Map for one sign of omega1.
        m: Number of the interval.
        z: Slowness.
    """
    left = side.slowness[m] - side.slowness[m - 1] if m > 0 else 0.0
    right = side.slowness[m + 2] - side.slowness[m + 1] if m < len(side.slowness) - 2 else 0.0
    return make_cell(left, side.slowness[m + 1] - side.slowness[m], right, z - side.slowness[m])


def curve(
    side: Side, n: int, cell: tuple[float, float, float, float, float, float], position: int
) -> tuple[float, float]:
    """Interpolate a number that each column has once, over the ratio.

    Args:
        side: Map for one sign of omega1.
        n: Number of the interval.
        cell: Coefficients of the ratio (ratio_cell).
        position: Position of the number in a column.

    Returns:
        (value, slope) at the ratio.
    """
    before, after = max(n - 1, 0), min(n + 2, len(RATIOS) - 1)
    a, b = side.columns[before].numbers[position], side.columns[n].numbers[position]
    c, e = side.columns[n + 1].numbers[position], side.columns[after].numbers[position]
    return cubic(cell, a, b, c, e, True)


def at_slowness(
    column: Column, m: int, cell: tuple[float, float, float, float, float, float], position: int
) -> float:
    """Interpolate numbers that a column has for each slowness, and return the value at a slowness.

    Args:
        column: Column of the map.
        m: Number of the interval.
        cell: Coefficients of the slowness (slowness_cell).
        position: Position of the first number in the column.
    """
    before, after = position + max(m - 1, 0), position + min(m + 2, SLOWNESSES - 1)
    i = position + m
    values = column.numbers
    value, _ = cubic(cell, values[before], values[i], values[i + 1], values[after], False)
    return value


def surface(
    side: Side,
    n: int,
    ratio: tuple[float, float, float, float, float, float],
    m: int,
    slowness: tuple[float, float, float, float, float, float],
    position: int,
) -> float:
    """Interpolate numbers that each column has for each slowness, and return the value at ratio and slowness.

    Args:
        side: Map for one sign of omega1.
        n: Number of the interval of the ratio.
        ratio: Coefficients of the ratio (ratio_cell).
        m: Number of the interval of the slowness.
        slowness: Coefficients of the slowness (slowness_cell).
        position: Position of the first number in a column.
    """
    if side.v0 == 0.0:
        value, _ = curve(side, n, ratio, position)
        return value
    a = at_slowness(side.columns[max(n - 1, 0)], m, slowness, position)
    b = at_slowness(side.columns[n], m, slowness, position)
    c = at_slowness(side.columns[n + 1], m, slowness, position)
    e = at_slowness(side.columns[min(n + 2, len(RATIOS) - 1)], m, slowness, position)
    value, _ = cubic(ratio, a, b, c, e, True)
    return value


def look_up(d: Constants, side: Side, speed: float, ratio: float, means: Steady) -> None:
    """Write the means of the steady motion at an input speed and a speed ratio.

    A ratio beyond the last one counts as the last one.

    Args:
        d: Constants.
        side: Map for one sign of omega1.
        speed: Magnitude of omega1, rad/s.
        ratio: omega3 / |omega1|.
        means: Record that is written (fields.STEADY).
    """
    s = min(max(ratio, 0.0), side.end)
    n = ratio_interval(side, s)
    cell = ratio_cell(side, n, s)
    scale = speed + side.v0
    m, slowness = 0, cell
    if side.v0 > 0.0:
        z = side.v0 / scale
        m = slowness_interval(side, z)
        slowness = slowness_cell(side, m, z)
    means.torque = scale * scale * surface(side, n, cell, m, slowness, TORQUE)
    means.omega2 = speed * min(max(surface(side, n, cell, m, slowness, LINK2), 0.0), s)
    means.inertia, means.slope = curve(side, n, cell, ENERGY)
    clear(means.lost)
    if d.averaged_losses != 0.0:
        for cause in range(len(LOSSES)):
            value = surface(side, n, cell, m, slowness, LOST + SLOWNESSES * cause)
            means.lost[int(LOSSES[cause])] = scale * scale * max(value, 0.0)
    means.resistance = total(means.lost)


def look_up_energy(side: Side, ratio: float, means: Steady) -> None:
    """Write the inertia of the mean energy and its slope over the speed ratio.

    A ratio beyond the last one counts as the last one.

    Args:
        side: Map for one sign of omega1.
        ratio: omega3 / |omega1|.
        means: Record that is written (fields.STEADY).
    """
    s = min(max(ratio, 0.0), side.end)
    n = ratio_interval(side, s)
    means.inertia, means.slope = curve(side, n, ratio_cell(side, n, s), ENERGY)


def look_up_pulses(side: Side, speed: float, ratio: float) -> tuple[float, float]:
    """Return the standard deviation and the peak of the output torque of the ideal motion, N m.

    Args:
        side: Map for one sign of omega1.
        speed: Magnitude of omega1, rad/s.
        ratio: omega3 / |omega1|.
    """
    if ratio >= side.end:
        return 0.0, 0.0
    n = ratio_interval(side, ratio)
    cell = ratio_cell(side, n, ratio)
    ripple, _ = curve(side, n, cell, RIPPLE)
    peak, _ = curve(side, n, cell, PEAK)
    return speed * speed * ripple, speed * speed * peak


def set_friction(p: Parameters, d: Constants, factor: float) -> None:
    """Set friction and drag of pinion shafts, link 2 and freewheels to a multiple of the parameters.

    Args:
        p: Parameters.
        d: Constants.
        factor: 1, or 0 for the motion at infinite speed.
    """
    d.b1 = d.b3 = 0.0
    d.bq = factor * p.drive_friction
    d.b2 = factor * p.link2_friction
    d.housing_drag = factor * p.housing_drag
    d.housing_drag_viscous = factor * p.housing_drag_viscous
    d.output_drag = factor * p.output_drag
    d.output_drag_viscous = factor * p.output_drag_viscous


def resistance(p: Parameters, d: Constants, speed: float) -> float:
    """Return the torque of all friction and drag of the map if all parts turn at the input speed, N m.

    Args:
        p: Parameters.
        d: Constants.
        speed: Magnitude of omega1, rad/s.
    """
    viscous = p.link2_friction + p.housing_drag_viscous + p.output_drag_viscous + d.k * d.k * p.drive_friction
    return p.housing_drag + p.output_drag + viscous * speed


def balance_speed(p: Parameters, d: Constants, stall: float) -> float:
    """Return V0, the input speed at which friction and drag consume the stall torque, rad/s; 0 without them.

    Args:
        p: Parameters.
        d: Constants.
        stall: Stall torque of the ideal motion over omega1^2, kg m^2.
    """
    drag = resistance(p, d, 0.0)
    viscous = resistance(p, d, 1.0) - drag
    stall = max(stall, MIN_STALL_RATIO * d.F_by_speed)
    if not stall > 0.0:
        return 0.0
    return (viscous + math.sqrt(viscous * viscous + 4.0 * stall * drag)) / (2.0 * stall)


def last_ratio(d: Constants, direction: float) -> tuple[float, float]:
    """Return the last ratio of the map, at which the mechanism no longer drives the output.

    For a positive input speed it is at most 1, because the housing only pushes. With losses link 2 may reach
    link 1 also if it does not in free flight.

    Args:
        d: Constants.
        direction: Sign of omega1.

    Returns:
        (ratio, locks): locks is 1 if link 2 reaches the speed of link 1 in free flight, otherwise 0.
    """
    momentum = maximum(d, MOMENTUM, direction, 0.0)[1]
    locks = direction > 0.0 and -maximum(d, FLIGHT_SLIP, direction, momentum)[1] < LOCK_SLIP_SQUARED
    flight = max(maximum(d, FLIGHT_SPEED, direction, momentum)[1], 0.0)
    if locks or (direction > 0.0 and d.averaged_losses != 0.0):
        return 1.0, 1.0 if locks else 0.0
    return max(flight, MIN_LAST_RATIO), 0.0


def write_orbit(
    d: Constants, x: State, w: Workspace, column: Column, m: int, omega1: float, scale: float, time: float
) -> None:
    """Write the means of an orbit for slowness m into a column of the map.

    Args:
        d: Constants.
        x: State after the period, with its sums.
        w: Workspace with orbit_energy.
        column: Column of the map, written.
        m: Number of the slowness.
        omega1: Mean input speed, rad/s.
        scale: V, rad/s.
        time: Time of the period, s.
    """
    speed, square = abs(omega1), scale * scale
    column.torque[m] = x.output_impulse / (time * square)
    column.link2[m] = (omega1 - angle_travelled(x) / (d.k * time)) / speed
    for cause in range(len(LOSSES)):
        column.lost[SLOWNESSES * cause + m] = x.lost[int(LOSSES[cause])] / (time * speed * square)
    if m == 0:
        column.inertia = 2.0 * w.orbit_energy / square - d.J1
        mean = x.output_impulse / time
        variance = x.output_square / time - mean * mean
        column.ripple = math.sqrt(max(variance, 0.0)) / square
        column.peak = x.torque_peak / square


def copy_orbit(column: Column, before: Column, m: int) -> None:
    """Copy the means for slowness m from the column of the previous ratio.

    Args:
        column: Column of the map, written.
        before: Column of the previous ratio.
        m: Number of the slowness.
    """
    column.torque[m] = before.torque[m]
    column.link2[m] = before.link2[m]
    for n in range(m, len(column.lost), SLOWNESSES):
        column.lost[n] = before.lost[n]
    if m == 0:
        column.inertia, column.ripple, column.peak = before.inertia, before.ripple, before.peak


def write_friction_means(d: Constants, side: Side, column: Column, m: int, ratio: float) -> None:
    """Write the means for a slowness m so large that only friction and drag act.

    The speed of link 2 is then constant: 0, equal to the output speed, or the value between them at which the
    torques on link 2 balance.

    Args:
        d: Constants with friction and drag.
        side: Map for one sign of omega1, with its V0.
        column: Column of the map, written.
        m: Number of the slowness.
        ratio: omega3 / |omega1|.
    """
    speed = side.v0 * max((1.0 - side.slowness[m]) / side.slowness[m], REST_SPEED_RATIO)
    omega3 = ratio * speed
    pull = d.k * d.k * d.bq / (1.0 - d.mesh_loss)
    resisting = pull + d.b2 + d.housing_drag_viscous
    driving = side.direction * pull * speed + d.output_drag_viscous * omega3 + d.output_drag - d.housing_drag
    omega2 = min(max(driving, 0.0) / (resisting + d.output_drag_viscous + 1e-300), omega3)
    overrun, slip = omega3 - omega2, side.direction * speed - omega2
    torque = -d.output_drag - d.output_drag_viscous * overrun
    if overrun == 0.0:
        torque = side.direction * pull * speed - resisting * omega2 - d.housing_drag
    square = (speed + side.v0) * (speed + side.v0)
    column.torque[m] = torque / square
    column.link2[m] = omega2 / speed
    power = speed * square
    viscous = d.bq * d.k * d.k * slip * slip + d.b2 * omega2 * omega2
    drag = (d.housing_drag + d.housing_drag_viscous * omega2) * omega2
    drag += (d.output_drag + d.output_drag_viscous * overrun) * overrun
    # In the order of LOSSES; journal friction needs centrifugal forces, which are 0 here
    column.lost[m] = viscous / power
    column.lost[SLOWNESSES + m] = d.mesh_loss * pull * slip * slip / power
    column.lost[2 * SLOWNESSES + m] = 0.0
    column.lost[3 * SLOWNESSES + m] = drag / power


def grid_ratio(side: Side, n: int) -> float:
    """Return the speed ratio of the orbit for RATIOS[n]."""
    return min(max(side.end * RATIOS[n], FIRST_RATIO * side.end), side.end * (1.0 - LAST_SLIP))


def compute_orbit(d: Constants, w: Workspace, side: Side, n: int, m: int, omega1: float) -> bool:
    """Write the orbit of ratio n for slowness m, and return True if there is one.

    Args:
        d: Constants with the friction of this slowness.
        w: Workspace.
        side: Map for one sign of omega1.
        n: Number of the ratio.
        m: Number of the slowness.
        omega1: Mean input speed of the orbit, rad/s.
    """
    scale = abs(omega1) + (side.v0 if m > 0 else 0.0)
    time = find_orbit(d, w.orbit, w, omega1, grid_ratio(side, n), period_length(d))
    if time > 0.0:
        write_orbit(d, w.orbit, w, side.columns[n], m, omega1, scale, time)
    return time > 0.0


def add_orbit(d: Constants, w: Workspace, side: Side, n: int, m: int, omega1: float) -> bool:
    """Write the orbit of ratio n for slowness m. If there is no orbit, copy the means of the previous ratio.

    Args:
        d: Constants with the friction of this slowness.
        w: Workspace.
        side: Map for one sign of omega1.
        n: Number of the ratio.
        m: Number of the slowness.
        omega1: Mean input speed of the orbit, rad/s.

    Returns:
        True if the column has means.
    """
    if compute_orbit(d, w, side, n, m, omega1):
        return True
    if n > 0:
        copy_orbit(side.columns[n], side.columns[n - 1], m)
    return n > 0


def add_orbits(d: Constants, w: Workspace, side: Side, m: int, omega1: float) -> bool:
    """Write the orbits of all ratios for slowness m.

    Args:
        d: Constants with the friction of this slowness.
        w: Workspace.
        side: Map for one sign of omega1.
        m: Number of the slowness.
        omega1: Mean input speed of the orbits, rad/s.
    """
    w.orbit_torque = 0.0
    for n in range(len(RATIOS)):
        if not add_orbit(d, w, side, n, m, omega1):
            return False
    return True


def shift_orbits(side: Side, column: Column, before: Column) -> None:
    """Add the effect of an oscillating input speed to the orbits at constant input speed.

    The effect is taken from the motion without friction: the difference between the torque-driven orbit and
    the orbit at constant input speed.

    Args:
        side: Map for one sign of omega1.
        column: Column of the map, at slowness 0 with the torque-driven orbit; written at the other
            slownesses.
        before: Copy of the column, at slowness 0 with the orbit at constant input speed.
    """
    for m in range(1, len(side.slowness) - N_FRICTION_ONLY):
        share = (1.0 - side.slowness[m]) * (1.0 - side.slowness[m])
        column.torque[m] += share * (column.torque[0] - before.torque[0])
        column.link2[m] += column.link2[0] - before.link2[0]
        for n in range(0, len(column.lost), SLOWNESSES):
            column.lost[n + m] += share * (column.lost[n] - before.lost[n])


def curvature(side: Side, n: int, m: int) -> float:
    """Return the second divided difference of the torque over three slownesses in a column, over V^2.

    Args:
        side: Map for one sign of omega1.
        n: Number of the ratio.
        m: Number of the slowness in the middle.
    """
    torque = side.columns[n].torque
    left, right = side.slowness[m] - side.slowness[m - 1], side.slowness[m + 1] - side.slowness[m]
    return ((torque[m + 1] - torque[m]) / right - (torque[m] - torque[m - 1]) / left) / (left + right)


def interpolation_error(side: Side, m: int, count: int) -> float:
    """Return an estimate of the interpolation error of the torque in an interval of slownesses, over V^2.

    It is the squared width times the change of the curvature towards the neighbour with the smaller change.
    The choice between two neighbours (as in ENO interpolation) ignores a kink in one of them.

    Args:
        side: Map for one sign of omega1.
        m: Number of the interval.
        count: Number of slownesses so far.
    """
    width = side.slowness[m + 1] - side.slowness[m]
    max_change = 0.0
    for n in range(len(RATIOS)):
        left = right = 1e300
        if m > 1:
            left = abs(curvature(side, n, m) - curvature(side, n, m - 1))
        if m < count - 3:
            right = abs(curvature(side, n, m + 1) - curvature(side, n, m + 2))
        max_change = max(max_change, width * width * min(left, right))
    return max_change


def insert_slowness(side: Side, m: int, count: int) -> None:
    """Insert the middle of an interval of slownesses, with interpolated means.

    Args:
        side: Map for one sign of omega1.
        m: Number of the interval.
        count: Number of slownesses so far.
    """
    middle = 0.5 * (side.slowness[m] + side.slowness[m + 1])
    cell = slowness_cell(side, m, middle)
    for n in range(len(RATIOS)):
        numbers = side.columns[n].numbers
        for position in range(0, ENERGY, SLOWNESSES):
            value = at_slowness(side.columns[n], m, cell, position)
            for i in range(count - m - 1):
                numbers[position + count - i] = numbers[position + count - i - 1]
            numbers[position + m + 1] = value
    for i in range(count - m - 1):
        side.slowness[count - i] = side.slowness[count - i - 1]
    side.slowness[m + 1] = middle


def input_speed(side: Side, z: float) -> float:
    """Return the input speed at the slowness z above 0, rad/s."""
    return side.direction * side.v0 * (1.0 - z) / z


def worst_interval(p: Parameters, d: Constants, side: Side, count: int) -> int:
    """Return the number of the interval of slownesses with the largest interpolation error.

    Args:
        p: Parameters.
        d: Constants.
        side: Map for one sign of omega1.
        count: Number of slownesses so far.
    """
    worst, max_error = 0, -1.0
    for m in range(count - N_FRICTION_ONLY):
        z = 0.5 * (side.slowness[m] + side.slowness[m + 1])
        speed = abs(input_speed(side, z))
        scale = max(side.columns[0].torque[0] * speed * speed, resistance(p, d, speed))
        error = interpolation_error(side, m, count) / (z * z * scale)
        if error > max_error:
            worst, max_error = m, error
    return worst


def refine(p: Parameters, d: Constants, w: Workspace, side: Side, count: int, max_evaluations: float) -> None:
    """Insert a slowness with its orbits. Where there is no orbit, the interpolated means remain.

    At low speed a period is long. With a very light link 2, friction and drag then require many steps.

    Args:
        p: Parameters.
        d: Constants with friction.
        w: Workspace.
        side: Map for one sign of omega1.
        count: Number of slownesses so far.
        max_evaluations: Evaluations for the map after which no orbit is computed.
    """
    m = worst_interval(p, d, side, count) + 1
    insert_slowness(side, m - 1, count)
    omega1 = input_speed(side, side.slowness[m])
    for n in range(len(RATIOS)):
        if d.map_evaluations < max_evaluations:
            compute_orbit(d, w, side, n, m, omega1)


def add_friction(p: Parameters, d: Constants, w: Workspace, side: Side) -> bool:
    """Fill the map at all slownesses above 0, and return True if there are periodic orbits.

    The orbits have constant input speed, because friction may stop a torque-driven link 1.

    Args:
        p: Parameters.
        d: Constants with a held output, driven by speed.
        w: Workspace.
        side: Map for one sign of omega1, complete at slowness 0, with its V0.
    """
    set_friction(p, d, 1.0)
    count = len(FIRST_SLOWNESSES)
    for m in range(count):
        side.slowness[m] = FIRST_SLOWNESSES[m]
    for n in range(len(RATIOS)):
        for m in range(count - N_FRICTION_ONLY, count):
            write_friction_means(d, side, side.columns[n], m, grid_ratio(side, n))
    max_evaluations = d.map_evaluations + MAX_REFINEMENT_EVALUATIONS
    has_orbits = True
    for m in range(1, count - N_FRICTION_ONLY):
        has_orbits = has_orbits and add_orbits(d, w, side, m, input_speed(side, side.slowness[m]))
    if has_orbits:
        for m in range(count, SLOWNESSES):
            refine(p, d, w, side, m, max_evaluations)
    set_friction(p, d, 0.0)
    return has_orbits


def drive_by_torque(d: Constants, w: Workspace, side: Side) -> bool:
    """Replace the orbits without friction by orbits at constant input torque, and shift all others.

    Args:
        d: Constants with a held output, without friction, driven by torque.
        w: Workspace.
        side: Map for one sign of omega1, complete at constant input speed.

    Returns:
        True if there are periodic orbits.
    """
    w.orbit_torque = 0.0
    for n in range(len(RATIOS)):
        copy(w.column.numbers, side.columns[n].numbers)
        if not add_orbit(d, w, side, n, 0, side.direction):
            return False
        if side.v0 > 0.0:
            shift_orbits(side, side.columns[n], w.column)
    return True


def extend_last_ratio(d: Constants, w: Workspace, side: Side) -> None:
    """Increase the last ratio of a mechanism with losses while its orbit transmits a torque.

    Args:
        d: Constants with a held output, without friction.
        w: Workspace.
        side: Map for one sign of omega1.
    """
    for _ in range(MAX_GROWTHS):
        w.orbit_torque = 0.0
        time = find_orbit(d, w.orbit, w, side.direction, side.end, period_length(d))
        if time < 0.0 or w.orbit.output_impulse <= NO_TORQUE_RATIO * d.F_by_speed * time:
            return
        side.end *= GROWTH


def build_side(p: Parameters, d: Constants, w: Workspace, side: Side) -> bool:
    """Fill the map for one sign of omega1, and return True if there are periodic orbits.

    Args:
        p: Parameters.
        d: Constants with a held output.
        w: Workspace.
        side: Map with its direction, written.
    """
    side.end, side.locks = last_ratio(d, side.direction)
    side.v0 = 0.0
    w.orbit_start = release_angle(d, side.direction)
    set_friction(p, d, 0.0)
    if d.averaged_losses != 0.0 and side.direction < 0.0:
        extend_last_ratio(d, w, side)
    by_torque = d.by_torque
    if d.averaged_losses != 0.0:
        d.by_torque = 0.0
    has_orbits = add_orbits(d, w, side, 0, side.direction)
    if has_orbits and d.averaged_losses != 0.0:
        side.v0 = balance_speed(p, d, side.columns[0].torque[0])
        has_orbits = side.v0 == 0.0 or add_friction(p, d, w, side)
        d.by_torque = by_torque
        if has_orbits and by_torque != 0.0:
            has_orbits = drive_by_torque(d, w, side)
    last = side.columns[len(RATIOS) - 1]
    if side.end < 1.0 or side.direction < 0.0:
        # Beyond it the output freewheel overruns and transmits no driving torque
        for m in range(SLOWNESSES):
            last.torque[m] = min(last.torque[m], 0.0)
    return has_orbits


def is_map_of(p: Parameters, d: Constants) -> bool:
    """Return True if the map in d belongs to these parameters. The first numbers of p are its key."""
    for n in range(len(d.map_key)):
        if d.map_key[n] != p.numbers[n]:
            return False
    return d.map_ready > 0.0


def build_map(p: Parameters, d: Constants, w: Workspace) -> int:
    """Fill d with the map of these parameters, unless d already contains it.

    Args:
        p: Parameters.
        d: Constants of these parameters.
        w: Workspace.

    Returns:
        Status: OK, or NO_CYCLIC_STEADY_STATE if there are no periodic orbits; d.map_ready is then -1.
    """
    if is_map_of(p, d):
        return OK
    d.map_ready = -1.0
    d.map_evaluations = 0.0
    d.map_lock = maximum(d, LOCK_TORQUE, 1.0, 0.0)[1]
    d.forward.direction, d.backward.direction = 1.0, -1.0
    w.tolerance = ORBIT_TOLERANCE
    hold_output(d)
    has_orbits = build_side(p, d, w, d.forward) and build_side(p, d, w, d.backward)
    derive_constants(p, d)
    if not has_orbits:
        return NO_CYCLIC_STEADY_STATE
    for n in range(len(d.map_key)):
        d.map_key[n] = p.numbers[n]
    d.map_ready = 1.0
    return OK
