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


def by_speed(fast, slower, slowest, crawling, w):
    """Value at w (see slowness), and its slope times w.

    Up to 1/3 a parabola, up to 1 a cubic. Slower, what is left beside the friction of links that
    crawl goes with log w, and fades.

    Args:
        fast, slower, slowest: values at 0; 1/9, 1/3, 2/3; 1, 3, 9.
        crawling: of links that crawl: what stays, and what goes with w and its square.
    """
    first, a, b = slower
    c, third, last = slowest
    first -= fast
    a -= fast
    b -= fast
    c -= fast
    if w <= 1.0 / 3.0:
        c2 = 13.5 * a - 40.5 * first
        c1 = 9.0 * first - c2 / 9.0
        return fast + w * (c1 + w * c2), w * (c1 + w * 2.0 * c2)
    c1 = 9.0 * a - 4.5 * b + c
    c2 = 18.0 * b - 22.5 * a - 4.5 * c
    c3 = 13.5 * (a - b) + 4.5 * c
    if w <= 1.0:
        return fast + w * (c1 + w * (c2 + w * c3)), w * (c1 + w * (2.0 * c2 + w * 3.0 * c3))
    stays, linear, square = crawling
    friction = stays + w * (linear + w * square)
    friction_w = w * (linear + 2.0 * w * square)
    last -= stays + LAST * (linear + LAST * square)
    if w >= LAST:
        left = last * LAST / w
        return friction + left, friction_w - left if w < SLOWEST else 0.0
    first = fast + c - stays - linear - square
    slope = LOG_LAST * (c1 + 2.0 * c2 + 3.0 * c3 - linear - 2.0 * square)
    third -= stays + 3.0 * (linear + 3.0 * square) + first + 0.5 * slope
    last -= first + slope
    s2 = 8.0 * third - last
    s3 = 2.0 * last - 8.0 * third
    s = math.log(w) / LOG_LAST
    left = first + s * (slope + s * (s2 + s * s3))
    return friction + left, friction_w + (slope + s * (2.0 * s2 + s * 3.0 * s3)) / LOG_LAST


def slowness(side, speed):
    """Speed at which friction takes the stall torque over this one, at most SLOWEST."""
    return side.slow / speed if SLOWEST * speed > side.slow else SLOWEST


def torque_at_knot(side, knot, speed):
    """Mean output torque at a knot over the square of the speed, N m s^2."""
    if side.slow == 0.0:
        return knot.torque[0]
    first, a, b, c, third, last, linear, square = torques_at_speeds(knot)
    slower, slowest = (first[0], a[0], b[0]), (c[0], third[0], last[0])
    return by_speed(knot.torque[0], slower, slowest, (0.0, linear[0], square[0]), slowness(side, speed))[0]


def torques_at_speeds(knot):
    """Cubics of the torque at the lower speeds."""
    s = knot.slower
    t0, t1, t2, t3 = s[0].torque, s[1].torque, s[2].torque, s[3].torque
    return t0, t1, t2, t3, s[4].torque, s[5].torque, s[6].torque, s[7].torque


def omega2_at_speeds(knot):
    """Cubics of the mean speed of link 2 at the lower speeds."""
    s = knot.slower
    w0, w1, w2, w3 = s[0].omega2, s[1].omega2, s[2].omega2, s[3].omega2
    return w0, w1, w2, w3, s[4].omega2, s[5].omega2, s[6].omega2, s[7].omega2


def cubics_at(fast, cubics, stays, t, w):
    """Value of a cubic with its like at lower speeds, slope, and slope in w times w (see by_speed).

    Args:
        stays: whether the last but one is what stays of links that crawl, else it goes with w.
    """
    first, a, b, c, third, last, crawl, square = cubics
    value, slope = cubic_at(fast, t)
    first0, first1 = cubic_at(first, t)
    a0, a1 = cubic_at(a, t)
    b0, b1 = cubic_at(b, t)
    c0, c1 = cubic_at(c, t)
    third0, third1 = cubic_at(third, t)
    last0, last1 = cubic_at(last, t)
    crawl0, crawl1 = cubic_at(crawl, t)
    square0, square1 = cubic_at(square, t)
    crawling = (crawl0, 0.0, 0.0) if stays else (0.0, crawl0, square0)
    crawling1 = (crawl1, 0.0, 0.0) if stays else (0.0, crawl1, square1)
    value, value_w = by_speed(value, (first0, a0, b0), (c0, third0, last0), crawling, w)
    slope, _ = by_speed(slope, (first1, a1, b1), (c1, third1, last1), crawling1, w)
    return value, slope, value_w


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
        w = slowness(side, speed)
        torque, torque1, torque_w = cubics_at(knot.torque, torques_at_speeds(knot), False, t, w)
        part, part1, part_w = cubics_at(knot.omega2, omega2_at_speeds(knot), True, t, w)
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


def lost_at_knot(knot, cause, w):
    """Mean power that a cause takes at a knot, over the cube of the speed, and its slope in w times w."""
    s = knot.slower
    slower = s[0].lost[cause], s[1].lost[cause], s[2].lost[cause]
    slowest = s[3].lost[cause], s[4].lost[cause], s[5].lost[cause]
    return by_speed(knot.lost[cause], slower, slowest, (0.0, s[6].lost[cause], s[7].lost[cause]), w)


def resistance(side, x, speed, omega3):
    """Power that all losses but that of the output take over |v|, N m, and its slopes in |v| and omega3."""
    s = ratio(omega3, speed)
    n = find_knot(side, x, s)
    here = side.knots[n]
    after = side.knots[min(n + 1, int(side.count) - 1)]
    width = after.ratio - here.ratio
    w = slowness(side, speed) if side.slow != 0.0 else 0.0
    first = first_w = last = last_w = 0.0
    for cause in range(len(here.lost)):
        lost, lost_w = lost_at_knot(here, cause, w)
        first += lost
        first_w += lost_w
        lost, lost_w = lost_at_knot(after, cause, w)
        last += lost
        last_w += lost_w
    slope = (last - first) / width if width > 0.0 else 0.0
    t = s - here.ratio if width > 0.0 else 0.0
    lost = first + t * slope
    lost_w = first_w + t / width * (last_w - first_w) if width > 0.0 else first_w
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
