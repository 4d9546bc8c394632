"""Knots of the averaged map: kept sorted, interpolated without overshoot.

Slopes are those of Fritsch and Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300, as in SciPy's
PchipInterpolator: between knots no value leaves the range of its neighbours.
"""

from .slots import *

# a row: ratio; cubics in the distance from it of torque, energy and speed of link 2; ripple, peak
ROW_TORQUE = 1
ROW_ENERGY = 5
ROW_OMEGA2 = 9
ROW_RIPPLE = 13
ROW_PEAK = 14
# while the map is built the error of the interval that follows, then one over its width
ROW_ERROR = 15
UNKNOWN_ERROR = 1e300


def first_row(header):
    """Where the rows of one sign of omega1 begin."""
    return D_MAP_KNOTS + (MAP_ROWS * MAP_ROW if header == D_MAP_BACKWARD else 0)


def knot(d, header, n):
    """Speed ratio of knot n."""
    return d[first_row(header) + n * MAP_ROW]


def slope_at(d, header, column, n):
    """Slope at knot n of the quantity in this column."""
    last = int(d[header]) - 1
    base = first_row(header)
    if last < 1:
        return 0.0
    if 0 < n < last:
        here = base + n * MAP_ROW
        h0 = d[here] - d[here - MAP_ROW]
        h1 = d[here + MAP_ROW] - d[here]
        s0 = (d[here + column] - d[here - MAP_ROW + column]) / h0
        s1 = (d[here + MAP_ROW + column] - d[here + column]) / h1
        if s0 * s1 <= 0.0:
            return 0.0
        w0 = 2.0 * h1 + h0
        w1 = h1 + 2.0 * h0
        return (w0 + w1) / (w0 / s0 + w1 / s1)
    step = MAP_ROW if n == 0 else -MAP_ROW
    here = base + n * MAP_ROW
    h0 = d[here + step] - d[here]
    s0 = (d[here + step + column] - d[here + column]) / h0
    if last < 2:
        return s0
    h1 = d[here + 2 * step] - d[here + step]
    s1 = (d[here + 2 * step + column] - d[here + step + column]) / h1
    slope = ((2.0 * h0 + h1) * s0 - h0 * s1) / (h0 + h1)
    if slope * s0 <= 0.0:
        return 0.0
    if s0 * s1 <= 0.0 and abs(slope) > 3.0 * abs(s0):
        return 3.0 * s0
    return slope


def cubic(d, header, column, n):
    """Coefficients of the cubic in the distance from knot n, up to knot n + 1."""
    here = first_row(header) + n * MAP_ROW
    h = d[here + MAP_ROW] - d[here]
    m0 = slope_at(d, header, column, n)
    m1 = slope_at(d, header, column, n + 1)
    s = (d[here + MAP_ROW + column] - d[here + column]) / h
    return d[here + column], m0, (3.0 * s - 2.0 * m0 - m1) / h, (m0 + m1 - 2.0 * s) / (h * h)


def interpolate(d, header, column, n, sigma):
    """Value at sigma, between knots n and n + 1, while the map is built."""
    c0, c1, c2, c3 = cubic(d, header, column, n)
    t = sigma - knot(d, header, n)
    return c0 + t * (c1 + t * (c2 + t * c3))


def find_row(d, header, sigma):
    """Number of the last knot not above sigma."""
    n = int(d[header]) - 1
    while n > 0 and knot(d, header, n) > sigma:
        n -= 1
    return n


def predict(d, header, sigma, torque, energy, omega2, other_share):
    """Error of the table at sigma, in units of the first knot's values."""
    count = int(d[header])
    if count < 2 or sigma > knot(d, header, count - 1):
        return UNKNOWN_ERROR
    n = find_row(d, header, sigma)
    base = first_row(header)
    error = abs(interpolate(d, header, ROW_TORQUE, n, sigma) - torque)
    scale = d[base + ROW_TORQUE]
    error = error / scale if scale > 0.0 else 0.0
    error2 = other_share * abs(interpolate(d, header, ROW_OMEGA2, n, sigma) - omega2)
    scale = d[base + ROW_ENERGY]
    error3 = other_share * abs(interpolate(d, header, ROW_ENERGY, n, sigma) - energy)
    error3 = error3 / scale if scale > 0.0 else 0.0
    return max(error, max(error2, error3))


def put_knot(d, header, sigma, torque, energy, omega2, ripple, peak, error):
    """Put a knot in its place; error is that of the table there before it."""
    count = int(d[header])
    base = first_row(header)
    n = count
    while n > 0 and knot(d, header, n - 1) > sigma:
        for column in range(MAP_ROW):
            d[base + n * MAP_ROW + column] = d[base + (n - 1) * MAP_ROW + column]
        n -= 1
    here = base + n * MAP_ROW
    for column in range(MAP_ROW):
        d[here + column] = 0.0
    d[here] = sigma
    d[here + ROW_TORQUE] = torque
    d[here + ROW_ENERGY] = energy
    d[here + ROW_OMEGA2] = omega2
    d[here + ROW_RIPPLE] = ripple
    d[here + ROW_PEAK] = peak
    # halving an interval at least halves its error
    half = 0.5 * error
    d[here + ROW_ERROR] = half
    if n > 0:
        d[here - MAP_ROW + ROW_ERROR] = half
    d[header] = count + 1.0


def worst_interval(d, header):
    """(number of the knot before the worst interval, its error)."""
    worst = 0
    error = 0.0
    base = first_row(header)
    for n in range(int(d[header]) - 1):
        if d[base + n * MAP_ROW + ROW_ERROR] > error:
            worst = n
            error = d[base + n * MAP_ROW + ROW_ERROR]
    return worst, error


def finish_table(d, header):
    """Write the coefficients of all cubics; beyond the last knot there is no torque."""
    base = first_row(header)
    last = int(d[header]) - 1
    for n in range(last):
        here = base + n * MAP_ROW
        for column in (ROW_TORQUE, ROW_ENERGY, ROW_OMEGA2):
            _, c1, c2, c3 = cubic(d, header, column, n)
            d[here + column + 1] = c1
            d[here + column + 2] = c2
            d[here + column + 3] = c3
        d[here + ROW_ERROR] = 1.0 / (d[here + MAP_ROW] - d[here])
    # at the last knot the slopes are those from below
    for column in (ROW_TORQUE, ROW_ENERGY, ROW_OMEGA2):
        d[base + last * MAP_ROW + column + 1] = slope_at(d, header, column, last)
    d[base + last * MAP_ROW + ROW_ERROR] = 0.0
