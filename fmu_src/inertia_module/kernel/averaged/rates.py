"""Rates by the averaged map at one instant: torque, speed of link 2, energy, and their slopes.

A side is the map for one sign of omega1 (fields.SIDE). The output shaft turns at x.omega3. All goes with the
speed v: omega1, or where its torque is given that of the energy J* v^2 / 2 of links 1 and 2 (see torque_map).
"""

import math

# a ratio beyond the end of the map by this fraction is at it
ROUNDING = 1e-14
# slower than at the lowest speed of the map by this, the torque goes with the square of the speed once more
SLOWEST = 1e6
# lowest speed with a motion of its own, and its logarithm
LAST = 9.0
LOG_LAST = math.log(LAST)
# places in the shares of links that crawl: what goes with the slowness, with its square; of the value without
# friction; what stays of the speed of links that crawl
CRAWLING, FAST, STAYS = 6, 8, 9


def side_at(d, omega1, trend):
    """The side of the map for omega1, or where it is zero for where it goes."""
    direction = omega1 if omega1 != 0.0 else trend
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


def cubic_at(cubic, t):
    """Value and slope of a cubic, the ratio t above its knot."""
    c1, c2, c3 = cubic[1], cubic[2], cubic[3]
    return cubic[0] + t * (c1 + t * (c2 + t * c3)), c1 + t * (2.0 * c2 + 3.0 * t * c3)


def shares(w):
    """Shares that values at some speeds have in that at w (see slowness), and how they change, times w.

    Up to 1/3 it is a parabola, up to 1 a cubic. Slower, what is left beside the friction of links that crawl
    is a cubic of log w that goes on with the same slope, and then fades.

    Returns:
        Shares and slopes: six of the values at 1/9, 1/3, 2/3, 1, 3, 9, two of what links that crawl have with
        w and its square, one of the value at 0, one of what stays of links that crawl.
    """
    if w <= 1.0 / 3.0:
        a, b = w * (13.5 - 40.5 * w), w * (13.5 * w - 1.5)
        a_w, b_w = w * (13.5 - 81.0 * w), w * (27.0 * w - 1.5)
        now = (a, b, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0 - a - b, 0.0)
        return now, (a_w, b_w, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -a_w - b_w, 0.0)
    if w <= 1.0:
        a, a_w = w * (9.0 + w * (13.5 * w - 22.5)), w * (9.0 + w * (40.5 * w - 45.0))
        b, b_w = w * (w * (18.0 - 13.5 * w) - 4.5), w * (w * (36.0 - 40.5 * w) - 4.5)
        c, c_w = w * (1.0 + w * (4.5 * w - 4.5)), w * (1.0 + w * (13.5 * w - 9.0))
        now = (0.0, a, b, c, 0.0, 0.0, 0.0, 0.0, 1.0 - a - b - c, 0.0)
        return now, (0.0, a_w, b_w, c_w, 0.0, 0.0, 0.0, 0.0, -a_w - b_w - c_w, 0.0)
    square = w * w
    if w >= LAST:
        e = LAST / w
        now = (0.0, 0.0, 0.0, 0.0, 0.0, e, w - LAST * e, square - LAST * LAST * e, 0.0, 1.0 - e)
        if w >= SLOWEST:
            return now, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        return now, (0.0, 0.0, 0.0, 0.0, 0.0, -e, w + LAST * e, 2.0 * square + LAST * LAST * e, 0.0, e)
    # a cubic of s by the values at 1, 3 and 9 and the slope at 1
    s = math.log(w) / LOG_LAST
    c, c_w = 1.0 + s * s * (6.0 * s - 7.0), s * (18.0 * s - 14.0) / LOG_LAST
    slope, slope_w = LOG_LAST * s * (1.0 + s * (2.0 * s - 3.0)), 1.0 + s * (6.0 * s - 6.0)
    d, d_w = 8.0 * s * s * (1.0 - s), s * (16.0 - 24.0 * s) / LOG_LAST
    e, e_w = s * s * (2.0 * s - 1.0), s * (6.0 * s - 2.0) / LOG_LAST
    crawl = w - c - slope - 3.0 * d - 9.0 * e
    crawl_w = w - c_w - slope_w - 3.0 * d_w - 9.0 * e_w
    crawl2 = square - c - 2.0 * slope - 9.0 * d - 81.0 * e
    crawl2_w = 2.0 * square - c_w - 2.0 * slope_w - 9.0 * d_w - 81.0 * e_w
    now = (0.0, 4.5 * slope, -9.0 * slope, c + 5.5 * slope, d, e, crawl, crawl2, -slope, 0.0)
    change = 4.5 * slope_w, -9.0 * slope_w, c_w + 5.5 * slope_w
    return now, (0.0, *change, d_w, e_w, crawl_w, crawl2_w, -slope_w, 0.0)


def slowness(side, speed):
    """Speed at which friction takes the stall torque over this one, at most SLOWEST."""
    if side.slow == 0.0:
        return 0.0
    return side.slow / speed if SLOWEST * speed > side.slow else SLOWEST


def torque_at_knot(side, knot, speed):
    """Mean output torque at a knot over the square of the speed, N m s^2."""
    now, _ = shares(slowness(side, speed))
    torque = now[FAST] * knot.torque[0]
    for m in range(FAST):
        torque += now[m] * knot.slower[m].torque[0]
    return torque


def lost_at_knot(knot, cause, now):
    """Mean power that a cause takes at a knot, over the cube of the speed; now: shares (or their slopes)."""
    lost = now[FAST] * knot.lost[cause]
    for m in range(FAST):
        lost += now[m] * knot.slower[m].lost[cause]
    return lost


def lost_between(side, x, s, cause, now):
    """Mean power that a cause takes at a ratio, over the cube of the speed, and its slope (lost_at_knot)."""
    n = find_knot(side, x, s)
    here = side.knots[n]
    lost = lost_at_knot(here, cause, now)
    if n == int(side.count) - 1:
        return lost, 0.0
    after = side.knots[n + 1]
    slope = (lost_at_knot(after, cause, now) - lost) / (after.ratio - here.ratio)
    return lost + (s - here.ratio) * slope, slope


def ratio(omega3, speed):
    """omega3 / |omega1|; where link 1 rests, 0 or beyond any map."""
    if omega3 <= 0.0:
        return 0.0
    return omega3 / speed if omega3 < 1e100 * speed else 1e100


def look_up(side, x, speed, omega3):
    """The map up to its end; beyond, its last values go on.

    Args:
        side, x: the map, and the state that remembers its knot.
        speed: |v|. omega3: of the output shaft.

    Returns:
        (F, its slope in s, mean omega2 / |v|, its slope, what both fall with 1 / |v|, times 1 / |v|).
    """
    s = ratio(omega3, speed)
    knot = side.knots[find_knot(side, x, s)]
    beyond = s > side.end * (1.0 + ROUNDING)
    t = 0.0 if beyond else s - knot.ratio
    torque, torque1 = cubic_at(knot.torque, t)
    part, part1 = cubic_at(knot.omega2, t)
    torque_w, part_w = 0.0, 0.0
    if side.slow != 0.0:
        now, by_w = shares(slowness(side, speed))
        torque, torque1, torque_w = now[FAST] * torque, now[FAST] * torque1, by_w[FAST] * torque
        part, part1, part_w = now[FAST] * part, now[FAST] * part1, by_w[FAST] * part
        for m in range(FAST):
            value, slope = cubic_at(knot.slower[m].torque, t)
            torque += now[m] * value
            torque1 += now[m] * slope
            torque_w += by_w[m] * value
            value, slope = cubic_at(knot.slower[m].omega2, t)
            n = STAYS if m == CRAWLING else m
            part += now[n] * value
            part1 += now[n] * slope
            part_w += by_w[n] * value
    if beyond:
        return torque, 0.0, part, 0.0, torque_w, part_w
    return torque, torque1, part, part1, torque_w, part_w


def look_up_input(side, x, speed, omega3):
    """Mean |omega1| / |v| under the torque of link 1 and its slope in s, as look_up."""
    s = ratio(omega3, speed)
    knot = side.knots[find_knot(side, x, s)]
    if s > side.end * (1.0 + ROUNDING):
        return knot.input[0], 0.0
    return cubic_at(knot.input, s - knot.ratio)


def resistance(side, x, speed, omega3):
    """Power that all losses but that of the output take over |v|, N m, and its slopes in |v| and omega3."""
    s = ratio(omega3, speed)
    now, by_w = shares(slowness(side, speed))
    lost = slope = lost_w = 0.0
    for cause in range(len(side.knots[0].lost)):
        own, own_slope = lost_between(side, x, s, cause, now)
        lost += own
        slope += own_slope
        lost_w += lost_between(side, x, s, cause, by_w)[0]
    return speed * speed * lost, speed * (2.0 * lost - s * slope - lost_w), speed * slope


def flow(d, side, x, speed, speed_rate, omega3):
    """Rates of |v| and omega3 and of what is integrated besides, and how they change.

        J* v' = M1 g - v F omega3 - losses / v        J3 omega3' = v^2 F - b3 omega3 - load

    Args:
        speed: |v|. speed_rate: its rate where the speed of link 1 is given, else without effect.

    Returns:
        (v', omega3', the slopes of both in v and omega3, T, omega2, |omega1|, power lost by torque, the rates
        of these six).
    """
    at_rest = speed == 0.0 and omega3 == 0.0
    if side.slow != 0.0 and d.by_torque != 0.0:
        # friction and drag resist at rest too, and in a step tried beyond it
        speed = max(speed, side.slow / SLOWEST)
    torque, torque1, part, part1, torque_w, part_w = look_up(side, x, speed, omega3)
    share, share1 = 1.0, 0.0
    if d.by_torque != 0.0:
        share, share1 = look_up_input(side, x, speed, omega3)
        if at_rest:
            # from rest the ratio is that of the accelerations, and stays
            start = max(-x.load_torque, 0.0) / d.J3
            growing = abs(x.drive_torque) / d.map_inertia
            _, _, part, _, _, _ = look_up(side, x, growing, start)
            share, _ = look_up_input(side, x, growing, start)
            torque1, part1, share1 = 0.0, 0.0, 0.0
    s = ratio(omega3, speed)
    passed = speed * speed * torque
    passed_by_speed = speed * (2.0 * torque - torque_w) - omega3 * torque1
    passed_by_omega3 = speed * torque1
    rate3 = (passed - x.load_torque - d.b3 * omega3) / d.J3
    rate = speed_rate
    own_by_speed = 0.0
    by_omega3 = 0.0
    lost, lost_rate = 0.0, 0.0
    if d.by_torque != 0.0:
        drive = side.direction * x.drive_torque
        taken, taken1, taken3 = 0.0, 0.0, 0.0
        if d.lossy != 0.0:
            taken, taken1, taken3 = resistance(side, x, speed, omega3)
        rate = (drive * share - speed * torque * omega3 - taken) / d.map_inertia
        share_by_omega3 = share1 / speed if share1 != 0.0 else 0.0
        # (the torque falls with the slowness too)
        own_by_speed = omega3 * (torque - s * torque1 - torque_w) + taken1
        own_by_speed = -(drive * s * share_by_omega3 + own_by_speed) / d.map_inertia
        by_omega3 = (drive * share_by_omega3 - speed * torque - omega3 * torque1 - taken3) / d.map_inertia
        lost = speed * taken
        lost_rate = rate * taken + speed * (taken1 * rate + taken3 * rate3)
    part_rate = rate * (part - s * part1 - part_w) + rate3 * part1
    share_rate = rate * (share - s * share1) + rate3 * share1
    passed_rate = passed_by_speed * rate + passed_by_omega3 * rate3
    return (
        (rate, own_by_speed * rate + by_omega3 * rate3),
        (rate3, (passed_rate - d.b3 * rate3) / d.J3),
        (own_by_speed, by_omega3, passed_by_speed / d.J3, (passed_by_omega3 - d.b3) / d.J3),
        (passed, passed_rate),
        (speed * part, part_rate),
        (speed * share, share_rate),
        (lost, lost_rate),
    )


def energy_at(d, side, x, v):
    """Mean kinetic energy of links 1 and 2 and the imbalances: (E, 2 E / v^2, its slope in s)."""
    if d.by_torque != 0.0:
        return 0.5 * v * v * d.map_inertia, d.map_inertia, 0.0
    speed = abs(v)
    s = ratio(x.omega3, speed)
    knot = side.knots[find_knot(side, x, s)]
    share, share1 = cubic_at(knot.input, s - knot.ratio if s < side.end else 0.0)
    share += d.J1
    return 0.5 * speed * speed * share, share, share1


def input_speed(d, side, x, v):
    """Mean omega1, rad/s."""
    return v * look_up_input(side, x, abs(v), x.omega3)[0] if d.by_torque != 0.0 else v


def ripple_at(side, x, v):
    """RMS about the mean, and peak, of the output torque."""
    s = ratio(x.omega3, abs(v))
    if s >= side.end:
        return 0.0, 0.0
    n = find_knot(side, x, s)
    knot = side.knots[n]
    after = side.knots[n + 1]
    t = (s - knot.ratio) * (1.0 / (after.ratio - knot.ratio))
    ripple = knot.ripple + t * (after.ripple - knot.ripple)
    peak = knot.peak + t * (after.peak - knot.peak)
    return v * v * ripple, v * v * peak
