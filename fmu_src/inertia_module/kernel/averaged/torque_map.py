"""Torque map of fidelity averaged: means of periodic orbits over the speed ratio and the slowness.

Without friction all torques scale with omega1^2: one orbit per ratio omega3 / |omega1| is enough. Friction b
and drag D scale with b / |omega1| and D / omega1^2. Torques are therefore divided by V^2 with V = |omega1| +
V0, where V0 is the input speed at which friction and drag take the stall torque. They are then nearly
parabolas of the slowness V0 / V, which is 0 at infinite speed and 1 at rest. Losses by load scale with
omega1^2 as well.

The grid is fixed: RATIOS shares of the last ratio and SLOWNESS. Between ratios all curves are monotone cubics
(PCHIP: Fritsch & Carlson, 1980, SIAM Journal on Numerical Analysis 17, slopes of Fritsch & Butland, 1984),
between slownesses cubics through the nearest four. At rest friction and drag alone act: link 2 turns evenly.

Friction of link 1 and of the output shaft is exact without a map. Driven by torque, orbits have the constant
input torque that keeps their energy; they depend on J1.
"""

import math

from ..accumulate import clear, total
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

# speed ratios of the grid over the last one, closer at both ends
RATIOS = (
    *(0.0, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.26, 0.32, 0.38, 0.44),
    *(0.5, 0.56, 0.62, 0.69, 0.76, 0.82, 0.88, 0.93, 0.97, 1.0),
)
# slownesses V0 / (|omega1| + V0) of the grid: without friction; orbits; friction and drag alone
SLOWNESS = (0.0, 0.125, 0.25, 0.375, 0.5, 0.5625, 0.625, 0.6875, 0.75, 0.8125, 0.875, 0.99, 1.0)
EVEN = 11
# causes of losses in the map
LOSSES = (VISCOUS, MESH, JOURNAL, FREEWHEEL)
# points of a cubic
CUBIC = 4
# places in a column of the map (fields.COLUMN)
TORQUE, LINK2, LOST = 0, len(SLOWNESS), 2 * len(SLOWNESS)
ENERGY = LOST + len(LOSSES) * len(SLOWNESS)
RIPPLE, PEAK = ENERGY + 1, ENERGY + 2
# ratio of the first orbit (the drag of the output freewheel acts only while the output turns), and slip of
# the last one over the last ratio
FIRST_RATIO, LAST_SLIP = 1e-4, 2e-3
# square of the least slip in free flight, over omega1^2, at which link 2 reaches link 1
LOCK_SLIP_SQUARED = 1e-9
# tolerance of an orbit
ORBIT_TOLERANCE = 1e-6
# stall torque that stands for none, over the largest mesh torque
MIN_STALL_RATIO = 0.01
# growth of the last ratio while losses by load, which release link 2 later and faster, leave a torque there:
# factor, largest number of times, torque over the largest mesh torque that counts as none
GROWTH, MAX_GROWTHS, NO_TORQUE_RATIO = 1.1, 8, 1e-4
# last ratio of a mechanism that transmits no torque
MIN_LAST_RATIO = 0.01
# input speed that stands for rest, over V0
REST_SPEED_RATIO = 1e-6
# least inertia J1 over the largest inertia I of the imbalances, driven by torque
MIN_INPUT_INERTIA_RATIO = 5.0


def is_light_input(d: Constants) -> bool:
    """Return True if link 1, driven by torque, is too light compared to the imbalances for a mean motion."""
    largest = maximum(d, INERTIA, 1.0, 0.0)[1]
    return d.by_torque != 0.0 and d.J1 < MIN_INPUT_INERTIA_RATIO * largest


def cubic_weights(z: float) -> tuple[int, tuple[float, float, float, float]]:
    """Return the first of CUBIC slownesses around z and the Lagrange weights of their values."""
    n = 0
    for m in range(1, len(SLOWNESS) - CUBIC + 1):
        if z > SLOWNESS[m + 1]:
            n = m
    za, zb, zc, zd = SLOWNESS[n], SLOWNESS[n + 1], SLOWNESS[n + 2], SLOWNESS[n + 3]
    a, b, c, e = z - za, z - zb, z - zc, z - zd
    return n, (
        b * c * e / ((za - zb) * (za - zc) * (za - zd)),
        a * c * e / ((zb - za) * (zb - zc) * (zb - zd)),
        a * b * e / ((zc - za) * (zc - zb) * (zc - zd)),
        a * b * c / ((zd - za) * (zd - zb) * (zd - zc)),
    )


def inner_slope(left: float, right: float, s0: float, s1: float) -> float:
    """Return the slope at a point by the secants to its neighbours: their weighted harmonic mean.

    Args:
        left: distance to the point before
        right: distance to the point after
        s0: secant from the point before
        s1: secant to the point after
    """
    if s0 * s1 <= 0.0:
        return 0.0
    w0, w1 = 2.0 * right + left, right + 2.0 * left
    return (w0 + w1) * s0 * s1 / (w0 * s1 + w1 * s0)


def end_slope(near: float, far: float, s0: float, s1: float) -> float:
    """Return the slope at the first or last point by the next two secants, shape-preserving.

    Args:
        near: distance to the next point
        far: distance from the next point to the second next
        s0: secant to the next point
        s1: secant from the next point to the second next
    """
    slope = ((2.0 * near + far) * s0 - near * s1) / (near + far)
    if slope * s0 <= 0.0:
        return 0.0
    return 3.0 * s0 if s0 * s1 < 0.0 and abs(slope) > 3.0 * abs(s0) else slope


def pchip(side: Side, n: int, s: float, a: float, b: float, c: float, e: float) -> tuple[float, float]:
    """Interpolate a curve of the map between points n and n + 1 of RATIOS.

    Args:
        side: map for one sign of omega1
        n: number of the point before s
        s: speed ratio
        a: value at point n - 1 (at point n = 0)
        b: value at point n
        c: value at point n + 1
        e: value at point n + 2 (at the last point)

    Returns:
        (value, slope in s).
    """
    last = len(RATIOS) - 2
    width = side.end * (RATIOS[n + 1] - RATIOS[n])
    left = side.end * (RATIOS[n] - RATIOS[n - 1]) if n > 0 else width
    right = side.end * (RATIOS[n + 2] - RATIOS[n + 1]) if n < last else width
    per_width = 1.0 / width
    before, rise, after = (b - a) / left, (c - b) * per_width, (e - c) / right
    m0 = inner_slope(left, width, before, rise) if n > 0 else end_slope(width, right, rise, after)
    m1 = inner_slope(width, right, rise, after) if n < last else end_slope(width, left, rise, before)
    t = s - side.end * RATIOS[n]
    c2, c3 = (3.0 * rise - 2.0 * m0 - m1) * per_width, (m0 + m1 - 2.0 * rise) * per_width * per_width
    return b + t * (m0 + t * (c2 + t * c3)), m0 + t * (2.0 * c2 + 3.0 * t * c3)


def interval(side: Side, s: float) -> int:
    """Return the number of the interval of the map that contains the ratio s."""
    n = 0
    while n < len(RATIOS) - 2 and s >= side.end * RATIOS[n + 1]:
        n += 1
    return n


def curve(side: Side, n: int, s: float, place: int) -> tuple[float, float]:
    """Return value and slope at ratio s, in interval n, of a number of each column.

    Args:
        side: map for one sign of omega1
        n: number of the interval
        s: speed ratio
        place: place of the number in a column
    """
    before, after = max(n - 1, 0), min(n + 2, len(RATIOS) - 1)
    a, b = side.columns[before].numbers[place], side.columns[n].numbers[place]
    c, e = side.columns[n + 1].numbers[place], side.columns[after].numbers[place]
    return pchip(side, n, s, a, b, c, e)


def surface(
    side: Side, n: int, s: float, first: int, weights: tuple[float, float, float, float], place: int
) -> float:
    """Return the value at ratio s and a slowness of numbers that each column has for all slownesses.

    Args:
        side: map for one sign of omega1
        n: number of the interval
        s: speed ratio
        first: first slowness of the cubic
        weights: weights of the cubic
        place: place of the first number in a column
    """
    if side.slow == 0.0:
        value, _ = curve(side, n, s, place)
        return value
    w0, w1, w2, w3 = weights
    before, after = max(n - 1, 0), min(n + 2, len(RATIOS) - 1)
    i = place + first
    a, b = side.columns[before].numbers, side.columns[n].numbers
    c, e = side.columns[n + 1].numbers, side.columns[after].numbers
    value, _ = pchip(
        side,
        n,
        s,
        w0 * a[i] + w1 * a[i + 1] + w2 * a[i + 2] + w3 * a[i + 3],
        w0 * b[i] + w1 * b[i + 1] + w2 * b[i + 2] + w3 * b[i + 3],
        w0 * c[i] + w1 * c[i + 1] + w2 * c[i + 2] + w3 * c[i + 3],
        w0 * e[i] + w1 * e[i + 1] + w2 * e[i + 2] + w3 * e[i + 3],
    )
    return value


def look_up(d: Constants, side: Side, speed: float, ratio: float, means: Steady) -> None:
    """Write the means of the steady motion at an input speed and a speed ratio up to the last one.

    Args:
        d: constants
        side: map for one sign of omega1
        speed: magnitude of omega1, rad/s
        ratio: omega3 / |omega1|
        means: record that is written (fields.STEADY)
    """
    s = min(max(ratio, 0.0), side.end)
    n = interval(side, s)
    weights = (1.0, 0.0, 0.0, 0.0)
    first = 0
    scale = speed
    if side.slow > 0.0:
        scale = speed + side.slow
        first, weights = cubic_weights(side.slow / scale)
    means.torque = scale * scale * surface(side, n, s, first, weights, TORQUE)
    # no cubic makes link 2 turn backwards or faster than the output
    means.omega2 = speed * min(max(surface(side, n, s, first, weights, LINK2), 0.0), s)
    means.inertia, means.slope = curve(side, n, s, ENERGY)
    clear(means.lost)
    if d.lossy != 0.0:
        for cause in range(len(LOSSES)):
            value = surface(side, n, s, first, weights, LOST + len(SLOWNESS) * cause)
            means.lost[int(LOSSES[cause])] = scale * scale * max(value, 0.0)
    means.resistance = total(means.lost)


def look_up_pulses(side: Side, speed: float, ratio: float) -> tuple[float, float]:
    """Return RMS about the mean and peak of the output torque, N m, of the ideal motion.

    Args:
        side: map for one sign of omega1
        speed: magnitude of omega1, rad/s
        ratio: omega3 / |omega1|
    """
    if ratio >= side.end:
        return 0.0, 0.0
    n = interval(side, ratio)
    ripple, _ = curve(side, n, ratio, RIPPLE)
    peak, _ = curve(side, n, ratio, PEAK)
    return speed * speed * ripple, speed * speed * peak


# --- building ---


def set_friction(p: Parameters, d: Constants, share: float) -> None:
    """Set friction and drag of the satellites, link 2 and the freewheels to a share of the parameters.

    Args:
        p: parameters
        d: constants
        share: 1, or 0 for the motion at infinite speed
    """
    d.b1 = d.b3 = 0.0
    d.bq = share * p.drive_friction
    d.b2 = share * p.link2_friction
    d.housing_drag = share * p.housing_drag
    d.housing_drag_viscous = share * p.housing_drag_viscous
    d.output_drag = share * p.output_drag
    d.output_drag_viscous = share * p.output_drag_viscous


def balance_speed(p: Parameters, d: Constants, stall: float) -> float:
    """Return the input speed, rad/s, at which friction and drag take the stall torque; 0 without any.

    Args:
        p: parameters
        d: constants
        stall: stall torque of the ideal motion over omega1^2, kg m^2
    """
    viscous = p.link2_friction + p.housing_drag_viscous + p.output_drag_viscous + d.k * d.k * p.drive_friction
    drag = p.housing_drag + p.output_drag
    stall = max(stall, MIN_STALL_RATIO * d.F_by_speed)
    if not stall > 0.0:
        return 0.0
    return (viscous + math.sqrt(viscous * viscous + 4.0 * stall * drag)) / (2.0 * stall)


def last_ratio(d: Constants, direction: float) -> tuple[float, float]:
    """Return the last ratio of the map, and 1 if free flight takes link 2 to link 1 there, else 0.

    Forwards no torque is transmitted above ratio 1, because the housing only pushes. Losses may take link 2
    to link 1 where free flight does not.
    """
    momentum = maximum(d, MOMENTUM, direction, 0.0)[1]
    locks = direction > 0.0 and -maximum(d, FLIGHT_SLIP, direction, momentum)[1] < LOCK_SLIP_SQUARED
    flight = max(maximum(d, FLIGHT_SPEED, direction, momentum)[1], 0.0)
    if locks or (direction > 0.0 and d.lossy != 0.0):
        return 1.0, 1.0 if locks else 0.0
    return max(flight, MIN_LAST_RATIO), 0.0


def write_orbit(
    d: Constants, x: State, w: Workspace, column: Column, m: int, omega1: float, scale: float, time: float
) -> None:
    """Write the means of an orbit for slowness m into a column of the map.

    Args:
        d: constants
        x: state after the period, with its sums
        w: workspace with orbit_energy
        column: of the map
        m: number of the slowness
        omega1: mean input speed, rad/s
        scale: V, rad/s
        time: of the period, s
    """
    speed, square = abs(omega1), scale * scale
    column.torque[m] = x.output_impulse / (time * square)
    column.link2[m] = (omega1 - angle_travelled(x) / (d.k * time)) / speed
    for cause in range(len(LOSSES)):
        column.lost[len(SLOWNESS) * cause + m] = x.lost[int(LOSSES[cause])] / (time * speed * square)
    if m == 0:
        column.inertia = 2.0 * w.orbit_energy / square - d.J1
        mean = x.output_impulse / time
        variance = x.output_square / time - mean * mean
        column.ripple = math.sqrt(max(variance, 0.0)) / square
        column.peak = x.torque_peak / square


def copy_orbit(column: Column, before: Column, m: int) -> None:
    """Copy the means for slowness m from the column of the ratio before.

    Args:
        column: of the map, written
        before: column of the ratio before
        m: number of the slowness
    """
    column.torque[m] = before.torque[m]
    column.link2[m] = before.link2[m]
    for n in range(m, len(column.lost), len(SLOWNESS)):
        column.lost[n] = before.lost[n]
    if m == 0:
        column.inertia, column.ripple, column.peak = before.inertia, before.ripple, before.peak


def write_even(d: Constants, side: Side, column: Column, m: int, ratio: float) -> None:
    """Write the means of slow links for slowness m: friction and drag alone act, and link 2 turns evenly.

    Link 2 rests, turns with the output shaft, or at the speed between at which its torques balance.

    Args:
        d: constants with friction and drag
        side: map for one sign of omega1, with its V0
        column: of the map
        m: number of the slowness
        ratio: omega3 / |omega1|
    """
    speed = side.slow * max((1.0 - SLOWNESS[m]) / SLOWNESS[m], REST_SPEED_RATIO)
    omega3 = ratio * speed
    pull = d.k * d.k * d.bq / (1.0 - d.mesh_loss)
    resisting = pull + d.b2 + d.housing_drag_viscous
    driving = side.direction * pull * speed + d.output_drag_viscous * omega3 + d.output_drag - d.housing_drag
    omega2 = min(max(driving, 0.0) / (resisting + d.output_drag_viscous + 1e-300), omega3)
    over, slip = omega3 - omega2, side.direction * speed - omega2
    torque = -d.output_drag - d.output_drag_viscous * over
    if over == 0.0:
        torque = side.direction * pull * speed - resisting * omega2 - d.housing_drag
    square = (speed + side.slow) * (speed + side.slow)
    column.torque[m] = torque / square
    column.link2[m] = omega2 / speed
    power = speed * square
    viscous = d.bq * d.k * d.k * slip * slip + d.b2 * omega2 * omega2
    drag = (d.housing_drag + d.housing_drag_viscous * omega2) * omega2
    drag += (d.output_drag + d.output_drag_viscous * over) * over
    # in the order of LOSSES; journals lose nothing
    column.lost[m] = viscous / power
    column.lost[len(SLOWNESS) + m] = d.mesh_loss * pull * slip * slip / power
    column.lost[2 * len(SLOWNESS) + m] = 0.0
    column.lost[3 * len(SLOWNESS) + m] = drag / power


def grid_ratio(side: Side, n: int) -> float:
    """Return the speed ratio of the orbit for point n of RATIOS."""
    return min(max(side.end * RATIOS[n], FIRST_RATIO * side.end), side.end * (1.0 - LAST_SLIP))


def add_orbits(d: Constants, w: Workspace, side: Side, m: int, omega1: float) -> bool:
    """Write the orbits of all ratios for slowness m; a ratio without one has the means of the ratio before.

    Args:
        d: constants with the friction of this slowness
        w: workspace
        side: map for one sign of omega1
        m: number of the slowness
        omega1: mean input speed of the orbits, rad/s

    Returns:
        True if there is an orbit at the first ratio.
    """
    length = period_length(d)
    scale = abs(omega1) + (side.slow if 0 < m < EVEN else 0.0)
    w.orbit_torque = 0.0
    for n in range(len(RATIOS)):
        time = find_orbit(d, w.part, w, omega1, grid_ratio(side, n), length)
        if time > 0.0:
            write_orbit(d, w.part, w, side.columns[n], m, omega1, scale, time)
        elif n == 0:
            return False
        else:
            copy_orbit(side.columns[n], side.columns[n - 1], m)
    return True


def shift_orbits(column: Column, m: int) -> None:
    """Add to the orbits at constant input speed the change that the oscillation of the input speed makes.

    The change is the change without friction: the orbit by torque is at slowness 0, the orbit at constant
    speed at EVEN.

    Args:
        column: of the map
        m: number of the slowness
    """
    share = (1.0 - SLOWNESS[m]) * (1.0 - SLOWNESS[m])
    column.torque[m] += share * (column.torque[0] - column.torque[EVEN])
    column.link2[m] += column.link2[0] - column.link2[EVEN]
    for n in range(0, len(column.lost), len(SLOWNESS)):
        column.lost[n + m] += share * (column.lost[n] - column.lost[n + EVEN])


def add_friction(p: Parameters, d: Constants, w: Workspace, side: Side) -> bool:
    """Fill the map at all slownesses above 0. Returns True if there are periodic orbits.

    The orbits have constant input speed, because friction may stop a link 1 that is driven by torque.

    Args:
        p: parameters
        d: constants with a held output, without friction
        w: workspace
        side: map for one sign of omega1, complete at slowness 0, with its V0
    """
    by_torque = d.by_torque
    d.by_torque = 0.0
    complete = by_torque == 0.0 or add_orbits(d, w, side, EVEN, side.direction)
    set_friction(p, d, 1.0)
    for m in range(1, EVEN):
        omega1 = side.direction * side.slow * (1.0 - SLOWNESS[m]) / SLOWNESS[m]
        complete = complete and add_orbits(d, w, side, m, omega1)
        if by_torque != 0.0:
            for n in range(len(RATIOS)):
                shift_orbits(side.columns[n], m)
    for n in range(len(RATIOS)):
        for m in range(EVEN, len(SLOWNESS)):
            write_even(d, side, side.columns[n], m, grid_ratio(side, n))
    d.by_torque = by_torque
    return complete


def extend(d: Constants, w: Workspace, side: Side) -> None:
    """Let the last ratio of a mechanism with losses grow while the orbit there transmits a torque.

    Args:
        d: constants with a held output, without friction
        w: workspace
        side: map for one sign of omega1
    """
    for _ in range(MAX_GROWTHS):
        w.orbit_torque = 0.0
        time = find_orbit(d, w.part, w, side.direction, side.end, period_length(d))
        if time < 0.0 or w.part.output_impulse <= NO_TORQUE_RATIO * d.F_by_speed * time:
            return
        side.end *= GROWTH


def build_side(p: Parameters, d: Constants, w: Workspace, side: Side) -> bool:
    """Fill the map for one sign of omega1. Returns True if there are periodic orbits.

    Args:
        p: parameters
        d: constants with a held output
        w: workspace
        side: map, with its direction
    """
    side.end, side.locks = last_ratio(d, side.direction)
    side.slow = 0.0
    w.orbit_start = release_angle(d, side.direction)
    set_friction(p, d, 0.0)
    if d.lossy != 0.0 and side.direction < 0.0:
        extend(d, w, side)
    if not add_orbits(d, w, side, 0, side.direction):
        return False
    last = side.columns[len(RATIOS) - 1]
    if side.end < 1.0 or side.direction < 0.0:
        last.torque[0] = min(last.torque[0], 0.0)
    if d.lossy != 0.0:
        side.slow = balance_speed(p, d, side.columns[0].torque[0])
    return side.slow == 0.0 or add_friction(p, d, w, side)


def is_map_of(p: Parameters, d: Constants) -> bool:
    """Return True if the map in d belongs to these parameters: to the first numbers of p."""
    for n in range(len(d.map_key)):
        if d.map_key[n] != p.numbers[n]:
            return False
    return d.map_ready > 0.0


def build_map(p: Parameters, d: Constants, w: Workspace) -> int:
    """Fill d with the map of these parameters, unless it is there.

    Args:
        p: parameters
        d: constants of these parameters
        w: workspace

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
    complete = build_side(p, d, w, d.forward) and build_side(p, d, w, d.backward)
    derive_constants(p, d)
    if not complete:
        return NO_CYCLIC_STEADY_STATE
    for n in range(len(d.map_key)):
        d.map_key[n] = p.numbers[n]
    d.map_ready = 1.0
    return OK
