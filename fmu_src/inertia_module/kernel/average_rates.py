"""What the averaged map says at one instant: torque, speed of link 2, energy, and their slopes."""

from .average_table import ROW_ENERGY, ROW_OMEGA2, ROW_PEAK, ROW_RIPPLE, ROW_TORQUE, first_row
from .slots import *

# a ratio beyond the end of the map by this fraction is at it
ROUNDING = 1e-14


def find_map_row(d, x, header, sigma):
    """Address of the last knot not above sigma; looked for from the one last used."""
    base = first_row(header)
    last = base + (int(d[header]) - 1) * MAP_ROW
    row = int(x[X_MAP_ROW])
    if row < base or row > last:
        row = base
    while row > base and d[row] > sigma:
        row -= MAP_ROW
    while row < last and d[row + MAP_ROW] <= sigma:
        row += MAP_ROW
    x[X_MAP_ROW] = row
    return row


def column_at(d, row, column, t):
    """Value and slope of one cubic, the ratio t above its knot."""
    c1 = d[row + column + 1]
    c2 = d[row + column + 2]
    c3 = d[row + column + 3]
    return d[row + column] + t * (c1 + t * (c2 + t * c3)), c1 + t * (2.0 * c2 + 3.0 * t * c3)


def ratio(omega3, speed):
    """omega3 / |omega1|; where link 1 rests, 0 or beyond any map."""
    if omega3 <= 0.0:
        return 0.0
    return omega3 / speed if omega3 < 1e100 * speed else 1e100


def driving_rates(d, x, header, speed, speed_rate, omega3):
    """Mean torque and mean omega2 up to the end of the map; beyond, its last values go on.

    Args:
        speed, speed_rate: |omega1| and its rate. omega3: of the output shaft.

    Returns:
        (T, dT/domega3, dT/dt at constant omega3, omega2, its slope in omega3 and in time).
    """
    sigma = ratio(omega3, speed)
    row = find_map_row(d, x, header, sigma)
    if sigma > d[header + 1] * (1.0 + ROUNDING):
        part = d[row + ROW_OMEGA2]
        slope = speed * d[row + ROW_TORQUE]
        return speed * slope, 0.0, 2.0 * speed_rate * slope, speed * part, 0.0, speed_rate * part
    t = sigma - d[row]
    torque, torque1 = column_at(d, row, ROW_TORQUE, t)
    part, part1 = column_at(d, row, ROW_OMEGA2, t)
    return (
        speed * speed * torque,
        speed * torque1,
        speed_rate * (2.0 * speed * torque - omega3 * torque1),
        speed * part,
        part1,
        speed_rate * (part - sigma * part1),
    )


def energy_at(d, x, header, omega1, omega3):
    """Mean kinetic energy of links 1 and 2 and the imbalances: (E, epsilon, its slope in sigma)."""
    speed = abs(omega1)
    sigma = ratio(omega3, speed)
    row = find_map_row(d, x, header, sigma)
    share, share1 = column_at(d, row, ROW_ENERGY, sigma - d[row] if sigma < d[header + 1] else 0.0)
    share += d[D_J1]
    return 0.5 * speed * speed * share, share, share1


def ripple_at(d, x, header, omega1, omega3):
    """RMS about the mean, and peak, of the output torque."""
    speed = abs(omega1)
    sigma = ratio(omega3, speed)
    row = find_map_row(d, x, header, sigma)
    if sigma >= d[header + 1]:
        return 0.0, 0.0
    t = (sigma - d[row]) * d[row + 15]
    square = speed * speed
    ripple = d[row + ROW_RIPPLE] + t * (d[row + MAP_ROW + ROW_RIPPLE] - d[row + ROW_RIPPLE])
    peak = d[row + ROW_PEAK] + t * (d[row + MAP_ROW + ROW_PEAK] - d[row + ROW_PEAK])
    return square * ripple, square * peak


def mean_input_torque(d, x, header, omega1, alpha1, omega3, alpha3, torque):
    """M1 of the mean balance M1 omega1 = T omega3 + dE/dt, E = omega1^2 epsilon(sigma) / 2."""
    _, share, share1 = energy_at(d, x, header, omega1, omega3)
    speed = abs(omega1)
    sigma = ratio(omega3, speed)
    if sigma >= d[header + 1]:
        return share * alpha1 + (torque * omega3 / omega1 if torque != 0.0 else 0.0)
    sign = 1.0 if omega1 >= 0.0 else -1.0
    return sign * torque * sigma + (share - 0.5 * sigma * share1) * alpha1 + sign * 0.5 * share1 * alpha3
