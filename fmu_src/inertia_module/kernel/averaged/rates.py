"""Rates of the averaged motion at one instant, by the map: speeds, torques, losses, energy.

A side is the map for one sign of omega1 (fields.SIDE). All goes with the speed v: omega1, or where its torque
is given that of the energy J* v^2 / 2 of links 1 and 2 (see torque_map). The output shaft is in one of four
legs: it rests, is locked to link 1, coasts beyond the end of the map, or slips under the mean torque.
"""

import math

from ..equations.losses import FREEWHEEL, VISCOUS
from .table import INPUT, MOTIONS, OMEGA2, TORQUE, interpolate

RESTING, LOCKED, COASTING, SLIPPING = 0, 1, 2, 3
# slower than at the lowest speed of the map by this, the torque goes with the square of the speed once more
SLOWEST = 1e12
# to find the ratio of the accelerations from rest
FROM_REST = 40
# lowest speed with a motion of its own, and its logarithm
LAST = 9.0
LOG_LAST = math.log(LAST)
# motion of links that crawl, the place of what stays of their speed in the shares
CRAWLING, STAYS = 7, 9


def side_at(d, v, trend):
    """The side of the map for the speed v, or where it is zero for where it goes."""
    direction = v if v != 0.0 else trend
    return d.forward if direction >= 0.0 else d.backward


def find_knot(side, x, sigma):
    """Number of the last knot not above sigma; looked for from the one last used."""
    last = int(side.count) - 1
    n = int(x.map_knot)
    if n > last:
        n = 0
    while n > 0 and side.knots[n].ratio > sigma:
        n -= 1
    while n < last and side.knots[n + 1].ratio <= sigma:
        n += 1
    x.map_knot = n
    return n


def last_knot(side):
    """The knot where the map ends."""
    return side.knots[int(side.count) - 1]


def shares(w):
    """Shares that the motions of a knot have in that at the slowness w.

    Up to 1/3 it is a parabola, up to 1 a cubic. Slower, what is left beside the friction of links that crawl
    is a cubic of log w that goes on with the same slope, and then fades.

    Returns:
        Of the motion at 0, at 1/9, 1/3, 2/3, 1, 3, 9, two of what links that crawl have with w and its
        square, one of what stays of links that crawl.
    """
    if w <= 1.0 / 3.0:
        a, b = w * (13.5 - 40.5 * w), w * (13.5 * w - 1.5)
        return 1.0 - a - b, a, b, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if w <= 1.0:
        a = w * (9.0 + w * (13.5 * w - 22.5))
        b = w * (w * (18.0 - 13.5 * w) - 4.5)
        c = w * (1.0 + w * (4.5 * w - 4.5))
        return 1.0 - a - b - c, 0.0, a, b, c, 0.0, 0.0, 0.0, 0.0, 0.0
    square = w * w
    if w >= LAST:
        e = LAST / w
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, e, w - LAST * e, square - LAST * LAST * e, 1.0 - e
    # a cubic of s by the values at 1, 3 and 9 and the slope at 1
    s = math.log(w) / LOG_LAST
    c = 1.0 + s * s * (6.0 * s - 7.0)
    slope = LOG_LAST * s * (1.0 + s * (2.0 * s - 3.0))
    d = 8.0 * s * s * (1.0 - s)
    e = s * s * (2.0 * s - 1.0)
    crawl = w - c - slope - 3.0 * d - 9.0 * e
    crawl2 = square - c - 2.0 * slope - 9.0 * d - 81.0 * e
    return -slope, 0.0, 4.5 * slope, -9.0 * slope, c + 5.5 * slope, d, e, crawl, crawl2, 0.0


def slowness(side, speed):
    """Speed at which friction takes the stall torque over this one, at most SLOWEST."""
    if side.slow == 0.0:
        return 0.0
    return side.slow / speed if SLOWEST * speed > side.slow else SLOWEST


def ratio(omega3, speed):
    """omega3 / |v|; where link 1 rests, 0 or beyond any map."""
    if omega3 <= 0.0:
        return 0.0
    return omega3 / speed if omega3 < 1e100 * speed else 1e100


def curve_at(side, n, s, curve):
    """Value and slope of a curve of the map from knot n on; beyond its end its last value."""
    if n == int(side.count) - 1:
        return side.knots[n].value[curve], 0.0
    return interpolate(side.knots[n], side.knots[n + 1], curve, s)


def look_up(side, x, speed, s):
    """Mean torque over v^2 and mean omega2 over |v| of the map.

    Args:
        side, x: the map, and the state that remembers its knot. speed: |v|. s: ratio of the output to it.
    """
    n = find_knot(side, x, s)
    if side.slow == 0.0:
        return curve_at(side, n, s, TORQUE)[0], curve_at(side, n, s, OMEGA2)[0]
    now = shares(slowness(side, speed))
    torque = part = 0.0
    for m in range(MOTIONS):
        torque += now[m] * curve_at(side, n, s, TORQUE + m)[0]
        part += now[STAYS if m == CRAWLING else m] * curve_at(side, n, s, OMEGA2 + m)[0]
    return torque, part


def look_up_input(side, x, s):
    """Mean |omega1| / |v| under the torque of link 1 or energy without J1 over v^2 / 2, its slope in s."""
    return curve_at(side, find_knot(side, x, s), s, INPUT)


def torque_at_knot(side, knot, speed):
    """Mean output torque at a knot, N m."""
    now = shares(slowness(side, speed))
    torque = 0.0
    for m in range(MOTIONS):
        torque += now[m] * knot.value[TORQUE + m]
    return torque * speed * speed


def lost_at_knot(knot, cause, now):
    """Mean power that a cause takes at a knot, over the cube of the speed; now: shares."""
    lost = 0.0
    for m in range(MOTIONS):
        lost += now[m] * knot.lost[MOTIONS * cause + m]
    return lost


def write_losses(side, x, speed, s, lost):
    """Write the mean powers that the causes take by the map, over |v|, into lost, N m. Returns their sum."""
    now = shares(slowness(side, speed))
    n = find_knot(side, x, s)
    here = side.knots[n]
    t = 0.0
    if n < int(side.count) - 1:
        t = (s - here.ratio) / (side.knots[n + 1].ratio - here.ratio)
    total = 0.0
    for cause in range(len(lost)):
        power = lost_at_knot(here, cause, now)
        if t > 0.0:
            power += t * (lost_at_knot(side.knots[n + 1], cause, now) - power)
        lost[cause] = speed * speed * max(power, 0.0)
        total += lost[cause]
    return total


def lock_ratio(d, side):
    """omega3 / v in lock-up."""
    return side.end if d.by_torque != 0.0 else 1.0


def trend(d, x):
    """Where v goes from zero."""
    return x.drive_torque if d.by_torque != 0.0 else x.alpha1


def ratio_from_rest(d, side, x):
    """Speed ratio with which both speeds begin at rest: that of the accelerations, the shaft by its load."""
    pushed = max(-x.load_torque - min(d.output_drag, d.housing_drag), 0.0) / d.J3
    if d.by_torque == 0.0:
        return ratio(pushed, abs(x.alpha1))
    growing = alone = abs(x.drive_torque) / d.map_inertia
    for _ in range(FROM_REST):
        growing = alone * look_up_input(side, x, ratio(pushed, growing))[0]
    return ratio(pushed, growing)


def write_mean_rates(d, side, x, leg, v, omega3, rates):
    """Write the rates of the averaged motion in a leg into a record.

        J* v' = M1 g - T omega3 / v - losses / v        J3 omega3' = T - b3 omega3 - load

    Args:
        v, omega3: the speeds, also where a step is tried beyond rest or the end of the map.
        rates: fields.FOLLOWED of q, v (omega1), omega3, theta1, the angles of link 2 (omega2) and the output
            (turned3), losses; the torques drive, output and, as housing, that of the mesh.
    """
    direction = side.direction
    forward = direction * v  # below 0 where a step is tried beyond rest: what is linear goes on
    speed = max(forward, 0.0)
    together = lock_ratio(d, side)
    if leg == RESTING:
        omega3 = 0.0
    elif leg == LOCKED:
        omega3 = together * forward
    x.step_evaluations += 1.0
    # friction and drag resist at rest too
    slow = max(speed, side.slow / SLOWEST)
    s = ratio(omega3, speed)
    if speed == 0.0 and omega3 == 0.0 and (leg == SLIPPING or leg == COASTING):
        s = ratio_from_rest(d, side, x)
    factor, part = look_up(side, x, slow, max(s, side.end) if leg == COASTING else s)
    torque = factor * slow * slow
    share, share1 = look_up_input(side, x, s)
    if leg != SLIPPING:
        share1 = 0.0
    if leg == LOCKED or leg == COASTING:
        share = last_knot(side).value[INPUT]
    resisting = 0.0
    if d.lossy != 0.0:
        resisting = write_losses(side, x, slow, s, rates.lost)
    beyond = omega3 - side.end * forward  # of what the mechanism itself passes its torque to
    if leg == COASTING:
        # drag alone is left (between its motions the map may have a trace of torque here)
        torque = 0.0 - d.output_drag if side.locks != 0.0 else min(torque, 0.0)
        torque -= d.output_drag_viscous * beyond
    given = x.load_torque + d.b3 * omega3
    inertia, driving = d.map_inertia, direction * x.drive_torque * share - resisting
    if leg == RESTING:
        torque = x.load_torque
    passed = torque * (side.end if leg == COASTING else min(s, side.end))
    if leg == LOCKED:
        passed = together * given
        inertia += together * together * d.J3
    rate = direction * x.alpha1
    if d.by_torque != 0.0:
        rate = (driving - passed) / inertia
        if v == 0.0:
            rate = max(rate, 0.0)  # friction holds it
    rates.omega1 = direction * rate
    if leg == RESTING:
        rates.omega3 = 0.0
    elif leg == LOCKED:
        rates.omega3 = together * rate
        torque = given + d.J3 * rates.omega3
        passed = together * torque
    else:
        rates.omega3 = (torque - given) / d.J3
    at_rest = speed == 0.0 and rate == 0.0
    taken = 0.0 if at_rest else passed + resisting
    omega1 = v
    rates.omega2 = speed * part
    if leg == RESTING or leg == LOCKED:
        rates.omega2 = omega3
    if d.by_torque != 0.0:
        omega1 = v * share
        rates.drive = x.drive_torque
        rates.housing = direction * taken / share - d.b1 * omega1
    else:
        stored = (d.J1 + share - 0.5 * s * share1) * rate + 0.5 * share1 * rates.omega3
        rates.drive = direction * (stored + taken + d.b1 * speed)
        rates.housing = direction * taken
    rates.output, rates.square = torque, 0.0  # (the pulses' ripple is that of the map)
    rates.theta1 = omega1
    rates.work_in = rates.drive * omega1
    rates.q = d.k * (omega1 - rates.omega2)
    rates.turned3 = omega3
    if d.lossy != 0.0:
        for cause in range(len(rates.lost)):
            rates.lost[cause] *= forward
        rates.lost[VISCOUS] += d.b3 * omega3 * omega3
        if d.by_torque == 0.0:
            rates.lost[VISCOUS] += d.b1 * speed * speed
        rates.lost[FREEWHEEL] -= torque * beyond if leg == COASTING else 0.0


def energy_at(d, side, x, v):
    """Mean kinetic energy of links 1 and 2 and the imbalances, J."""
    if d.by_torque != 0.0:
        return 0.5 * v * v * d.map_inertia
    speed = abs(v)
    return 0.5 * speed * speed * (d.J1 + look_up_input(side, x, ratio(x.omega3, speed))[0])


def ripple_at(side, x, v):
    """RMS about the mean, and peak, of the output torque."""
    s = ratio(x.omega3, abs(v))
    if s >= side.end:
        return 0.0, 0.0
    n = find_knot(side, x, s)
    knot = side.knots[n]
    after = side.knots[n + 1]
    t = (s - knot.ratio) / (after.ratio - knot.ratio)
    ripple = knot.ripple + t * (after.ripple - knot.ripple)
    peak = knot.peak + t * (after.peak - knot.peak)
    return v * v * ripple, v * v * peak
