"""What the averaged map says at one instant: torque, speed of link 2, energy, and their slopes.

A side is the map for one sign of omega1 (fields.SIDE). The output shaft turns at x.omega3. All goes with the
speed v: omega1, or where its torque is given that of the energy J* v^2 / 2 of links 1 and 2 (see torque_map).
"""

# a ratio beyond the end of the map by this fraction is at it
ROUNDING = 1e-14


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
        (F, its slope in s, mean omega2 / |v|, its slope).
    """
    s = ratio(omega3, speed)
    knot = side.knots[find_knot(side, x, s)]
    if s > side.end * (1.0 + ROUNDING):
        return knot.torque[0], 0.0, knot.omega2[0], 0.0
    t = s - knot.ratio
    torque, torque1 = cubic_at(knot.torque, t)
    part, part1 = cubic_at(knot.omega2, t)
    return torque, torque1, part, part1


def look_up_input(side, x, speed, omega3):
    """Mean |omega1| / |v| under the torque of link 1 and its slope in s, as look_up."""
    s = ratio(omega3, speed)
    knot = side.knots[find_knot(side, x, s)]
    if s > side.end * (1.0 + ROUNDING):
        return knot.input[0], 0.0
    return cubic_at(knot.input, s - knot.ratio)


def flow(d, side, x, speed, speed_rate, omega3):
    """Rates of |v| and omega3 and of what is integrated besides, and how they change.

        J* v' = M1 g - v F omega3        J3 omega3' = v^2 F - load

    Args:
        speed: |v|. speed_rate: its rate where the speed of link 1 is given, else without effect.

    Returns:
        (v', omega3', the slopes of both in v and omega3, T, omega2, |omega1|, the rates of these five).
    """
    torque, torque1, part, part1 = look_up(side, x, speed, omega3)
    share, share1 = 1.0, 0.0
    if d.by_torque != 0.0:
        share, share1 = look_up_input(side, x, speed, omega3)
        if speed == 0.0 and omega3 == 0.0:
            # from rest the ratio is that of the accelerations, and stays
            start = max(-x.load_torque, 0.0) / d.J3
            growing = abs(x.drive_torque) / d.map_inertia
            _, _, part, _ = look_up(side, x, growing, start)
            share, _ = look_up_input(side, x, growing, start)
            torque1, part1, share1 = 0.0, 0.0, 0.0
    s = ratio(omega3, speed)
    passed = speed * speed * torque
    passed_by_speed = 2.0 * speed * torque - omega3 * torque1
    passed_by_omega3 = speed * torque1
    rate3 = (passed - x.load_torque) / d.J3
    rate = speed_rate
    by_speed = 0.0
    by_omega3 = 0.0
    if d.by_torque != 0.0:
        drive = side.direction * x.drive_torque
        rate = (drive * share - speed * torque * omega3) / d.map_inertia
        share_by_omega3 = share1 / speed if share1 != 0.0 else 0.0
        by_speed = -(drive * s * share_by_omega3 + omega3 * (torque - s * torque1)) / d.map_inertia
        by_omega3 = (drive * share_by_omega3 - speed * torque - omega3 * torque1) / d.map_inertia
    part_rate = rate * (part - s * part1) + rate3 * part1
    share_rate = rate * (share - s * share1) + rate3 * share1
    passed_rate = passed_by_speed * rate + passed_by_omega3 * rate3
    return (
        (rate, by_speed * rate + by_omega3 * rate3),
        (rate3, passed_rate / d.J3),
        (by_speed, by_omega3, passed_by_speed / d.J3, passed_by_omega3 / d.J3),
        (passed, passed_rate),
        (speed * part, part_rate),
        (speed * share, share_rate),
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


def mesh_share(x, omega1, torque):
    """Mean mesh torque, the part rho = omega3 / omega1 of the mean output torque: power balances."""
    return torque * x.omega3 / omega1 if torque != 0.0 and omega1 != 0.0 else 0.0


def mean_input_torque(d, side, x, omega1, alpha1, alpha3, torque):
    """M1 of the mean balance M1 omega1 = T omega3 + dE/dt, E = omega1^2 epsilon(sigma) / 2."""
    if d.by_torque != 0.0:
        return x.drive_torque
    _, share, share1 = energy_at(d, side, x, omega1)
    sigma = ratio(x.omega3, abs(omega1))
    if sigma >= side.end:
        return share * alpha1 + mesh_share(x, omega1, torque)
    sign = 1.0 if omega1 >= 0.0 else -1.0
    return sign * torque * sigma + (share - 0.5 * sigma * share1) * alpha1 + sign * 0.5 * share1 * alpha3
