"""Rates of the averaged motion at one instant, by the map: speeds, torques, losses, energy.

A side is the map for one sign of omega1 (fields.SIDE). All goes with the speed v: omega1, or where its torque
is given that of the energy J* v^2 / 2 of links 1 and 2 (see torque_map). The output shaft is in one of four
legs: it rests, is locked to link 1, coasts beyond the end of the map, or slips under the mean torque.
"""

import math

from ..accumulate import total
from ..equations.losses import FREEWHEEL, VISCOUS
from .table import INPUT, MOTIONS, OMEGA2, PEAK, RIPPLE, SLOWNESS, TORQUE, interpolate

RESTING, LOCKED, COASTING, SLIPPING = 0, 1, 2, 3
# to find the ratio of the accelerations from rest
FROM_REST = 64
# motions of a knot about a slowness that it is interpolated from
NEAR = 4


def side_at(d, v, trend):
    """The side of the map for the speed v, or where it is zero for where it goes."""
    direction = v if v != 0.0 else trend
    return d.forward if direction >= 0.0 else d.backward


def find_knot(side, x, sigma):
    """Return the number of the last knot not above sigma, by bisection."""
    n, above = 0, int(side.count)
    while above - n > 1:
        middle = (n + above) // 2
        if side.knots[middle].ratio <= sigma:
            n = middle
        else:
            above = middle
    return n


def share_of(m, share0, share1, share2, share3):
    """Return the share of motion m of NEAR."""
    if m < 2:
        return share0 if m == 0 else share1
    return share2 if m == 2 else share3


def shares(side, speed):
    """First of NEAR motions of a knot about the slowness at a speed, and their shares in a cubic."""
    fast = speed / (speed + side.slow) if side.slow > 0.0 else 1.0
    z = 1.0 - fast
    n = 0
    for m in range(1, MOTIONS - NEAR + 1):
        if z > SLOWNESS[m + 1]:
            n = m
    za, zb, zc, zd = SLOWNESS[n], SLOWNESS[n + 1], SLOWNESS[n + 2], SLOWNESS[n + 3]
    # (nothing cancels where links crawl: all that goes with their speed does with the last one)
    a, b, c, d = z - za, z - zb, z - zc, 1.0 - zd - fast
    return (
        n,
        b * c * d / ((za - zb) * (za - zc) * (za - zd)),
        a * c * d / ((zb - za) * (zb - zc) * (zb - zd)),
        a * b * d / ((zc - za) * (zc - zb) * (zc - zd)),
        a * b * c / ((zd - za) * (zd - zb) * (zd - zc)),
    )


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
    """Mean torque, N m, and mean omega2 over |v| of the map.

    Args:
        side, x: the map, and the state that remembers its knot. speed: |v|. s: ratio of the output to it.
    """
    n = find_knot(side, x, s)
    if side.slow == 0.0:
        return curve_at(side, n, s, TORQUE)[0] * speed * speed, curve_at(side, n, s, OMEGA2)[0]
    first, share0, share1, share2, share3 = shares(side, speed)
    torque = part = 0.0
    for m in range(NEAR):
        torque += share_of(m, share0, share1, share2, share3) * curve_at(side, n, s, TORQUE + first + m)[0]
        part += share_of(m, share0, share1, share2, share3) * curve_at(side, n, s, OMEGA2 + first + m)[0]
    scale = speed + side.slow
    # no cubic turns link 2 back, or ahead of the output
    return torque * scale * scale, min(max(part, 0.0), s)


def look_up_input(side, x, s):
    """Mean |omega1| / |v| under the torque of link 1 or energy without J1 over v^2 / 2, its slope in s."""
    return curve_at(side, find_knot(side, x, s), s, INPUT)


def write_losses(side, x, speed, s, lost):
    """Write the mean powers that the causes take by the map, over |v|, into lost, N m. Returns their sum."""
    first, share0, share1, share2, share3 = shares(side, speed)
    n = find_knot(side, x, s)
    here, after = side.knots[n], side.knots[min(n + 1, int(side.count) - 1)]
    t = (s - here.ratio) / (after.ratio - here.ratio) if after.ratio > here.ratio else 0.0
    scale = speed + side.slow
    for cause in range(len(lost)):
        power = 0.0
        for m in range(NEAR):
            place = MOTIONS * cause + first + m
            lost_here = here.lost[place] + t * (after.lost[place] - here.lost[place])
            power += share_of(m, share0, share1, share2, share3) * lost_here
        lost[cause] = scale * scale * max(power, 0.0)
    return total(lost)


def lock_ratio(d, side):
    """omega3 / v in lock-up."""
    return side.end if d.by_torque != 0.0 else 1.0


def trend(d, x):
    """Where v goes from zero."""
    return x.drive_torque if d.by_torque != 0.0 else x.alpha1


def free_torque(d, side, torque):
    """Mean torque at a shaft beyond the map: drag (between its motions the map may have a trace of it)."""
    return 0.0 - d.output_drag if side.locks != 0.0 else min(torque, 0.0)


def ratio_from_rest(d, side, x, lost):
    """Speed ratio with which both speeds begin at rest: that of the accelerations, which go with it."""
    low, high = 1e-100, 1e100
    for _ in range(FROM_REST):
        s = math.sqrt(low * high)
        torque = look_up(side, x, 0.0, s)[0]
        if s >= side.end:
            torque = free_torque(d, side, torque)
        growing = abs(x.alpha1)
        if d.by_torque != 0.0:
            resisting = write_losses(side, x, 0.0, s, lost) if d.lossy != 0.0 else 0.0
            speed1, _ = look_up_input(side, x, s)
            driving = abs(x.drive_torque) * speed1
            growing = max(driving - torque * min(s, side.end) - resisting, 0.0) / d.map_inertia
        if torque - x.load_torque > d.J3 * s * growing:
            low = s
        else:
            high = s
    return low


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
    # (both may come to rest at once)
    s = omega3 / forward if omega3 < 0.0 and forward < 0.0 else ratio(omega3, speed)
    if speed == 0.0 and omega3 == 0.0 and (leg == SLIPPING or leg == COASTING):
        s = ratio_from_rest(d, side, x, rates.lost)
    within = max(s, side.end) if leg == LOCKED or leg == COASTING else s
    torque, part = look_up(side, x, speed, within)
    share, share1 = look_up_input(side, x, within)
    if leg != SLIPPING:
        share1 = 0.0
    resisting = 0.0
    if d.lossy != 0.0:
        resisting = write_losses(side, x, speed, within, rates.lost)
    beyond = omega3 - side.end * forward  # of what the mechanism itself passes its torque to
    if leg == COASTING:
        torque = free_torque(d, side, torque) - d.output_drag_viscous * beyond
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
    square = v * v
    return square * curve_at(side, n, s, RIPPLE)[0], square * curve_at(side, n, s, PEAK)[0]
