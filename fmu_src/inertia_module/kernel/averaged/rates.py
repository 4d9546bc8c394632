"""What the averaged map says at one instant: torque, speed of link 2, energy, and their slopes.

A side is the map for one sign of omega1 (fields.SIDE). The output shaft turns at x.omega3.
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


def mean_rates(side, x, speed, speed_rate, omega3):
    """Mean torque and mean omega2 up to the end of the map; beyond, its last values go on.

    Args:
        side, x: the map, and the state that remembers its knot.
        speed, speed_rate: |omega1| and its rate. omega3: of the output shaft.

    Returns:
        (T, dT/domega3, dT/dt at constant omega3, omega2, its slope in omega3 and in time).
    """
    sigma = ratio(omega3, speed)
    knot = side.knots[find_knot(side, x, sigma)]
    if sigma > side.end * (1.0 + ROUNDING):
        part = knot.omega2[0]
        slope = speed * knot.torque[0]
        return speed * slope, 0.0, 2.0 * speed_rate * slope, speed * part, 0.0, speed_rate * part
    t = sigma - knot.ratio
    torque, torque1 = cubic_at(knot.torque, t)
    part, part1 = cubic_at(knot.omega2, t)
    return (
        speed * speed * torque,
        speed * torque1,
        speed_rate * (2.0 * speed * torque - omega3 * torque1),
        speed * part,
        part1,
        speed_rate * (part - sigma * part1),
    )


def energy_at(d, side, x, omega1):
    """Mean kinetic energy of links 1 and 2 and the imbalances: (E, epsilon, its slope in sigma)."""
    speed = abs(omega1)
    sigma = ratio(x.omega3, speed)
    knot = side.knots[find_knot(side, x, sigma)]
    share, share1 = cubic_at(knot.energy, sigma - knot.ratio if sigma < side.end else 0.0)
    share += d.J1
    return 0.5 * speed * speed * share, share, share1


def ripple_at(side, x, omega1):
    """RMS about the mean, and peak, of the output torque."""
    sigma = ratio(x.omega3, abs(omega1))
    if sigma >= side.end:
        return 0.0, 0.0
    n = find_knot(side, x, sigma)
    knot = side.knots[n]
    after = side.knots[n + 1]
    t = (sigma - knot.ratio) * (1.0 / (after.ratio - knot.ratio))
    ripple = knot.ripple + t * (after.ripple - knot.ripple)
    peak = knot.peak + t * (after.peak - knot.peak)
    return omega1 * omega1 * ripple, omega1 * omega1 * peak


def mesh_share(x, omega1, torque):
    """Mean mesh torque, the part rho = omega3 / omega1 of the mean output torque: power balances."""
    return torque * x.omega3 / omega1 if torque != 0.0 and omega1 != 0.0 else 0.0


def mean_input_torque(d, side, x, omega1, alpha1, alpha3, torque):
    """M1 of the mean balance M1 omega1 = T omega3 + dE/dt, E = omega1^2 epsilon(sigma) / 2."""
    _, share, share1 = energy_at(d, side, x, omega1)
    sigma = ratio(x.omega3, abs(omega1))
    if sigma >= side.end:
        return share * alpha1 + mesh_share(x, omega1, torque)
    sign = 1.0 if omega1 >= 0.0 else -1.0
    return sign * torque * sigma + (share - 0.5 * sigma * share1) * alpha1 + sign * 0.5 * share1 * alpha3
