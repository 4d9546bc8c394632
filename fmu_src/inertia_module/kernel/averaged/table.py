"""Knots of the averaged map: interpolated without overshoot, added where the table is worst.

Slopes are those of Fritsch and Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300, as in SciPy's
PchipInterpolator: between knots no value leaves the range of its neighbours.
A cubic is its four coefficients in the distance from its knot: value, slope, and those of square and cube.
"""

# error of an interval that has not been looked at
UNKNOWN_ERROR = 1e300
# what the input has and the speed of link 2 matter less than the torque
OTHER_SHARE = 0.2
# no interval is halved that is no wider, over the last ratio: where drag begins to act, at ratio 0, the
# torque jumps
NARROWEST = 2.5e-4


def inner_slope(left, right, before, here, after):
    """Slope at a knot by the values there and at its neighbours, which are left and right away."""
    s0 = (here - before) / left
    s1 = (after - here) / right
    if s0 * s1 <= 0.0:
        return 0.0
    w0 = 2.0 * right + left
    w1 = right + 2.0 * left
    return (w0 + w1) / (w0 / s0 + w1 / s1)


def end_slope(near, far, here, following, beyond):
    """Slope at the first or last knot by the values there and at the two next, near and then far further."""
    s0 = (following - here) / near
    s1 = (beyond - following) / far
    slope = ((2.0 * near + far) * s0 - near * s1) / (near + far)
    if slope * s0 <= 0.0:
        return 0.0
    if s0 * s1 <= 0.0 and abs(slope) > 3.0 * abs(s0):
        return 3.0 * s0
    return slope


def slope_at(inner, near, far, a, here, b):
    """Slope of a cubic at a knot by those on both sides, or at an end by the two next (far = 0: by one)."""
    if inner:
        return inner_slope(near, far, a[0], here[0], b[0])
    if far == 0.0:
        return (a[0] - here[0]) / near
    return end_slope(near, far, here[0], a[0], b[0])


def set_slopes(side, n):
    """Write the slopes at knot n of two, which are a straight line, or more."""
    last = int(side.count) - 1
    here = side.knots[n]
    inner = 0 < n < last
    step = 1 if n == 0 else -1
    a = side.knots[n - 1 if inner else n + step]
    b = side.knots[n + 1 if inner else n + step * min(last, 2)]
    near = here.ratio - a.ratio if inner else a.ratio - here.ratio
    far = b.ratio - here.ratio if inner else b.ratio - a.ratio
    here.torque[1] = slope_at(inner, near, far, a.torque, here.torque, b.torque)
    here.input[1] = slope_at(inner, near, far, a.input, here.input, b.input)
    here.omega2[1] = slope_at(inner, near, far, a.omega2, here.omega2, b.omega2)
    if side.slow != 0.0:
        for m in range(len(here.slower)):
            slower = here.slower[m]
            slower.torque[1] = slope_at(
                inner, near, far, a.slower[m].torque, slower.torque, b.slower[m].torque
            )
            slower.omega2[1] = slope_at(
                inner, near, far, a.slower[m].omega2, slower.omega2, b.slower[m].omega2
            )


def cubic_coefficients(here, after, h):
    """The other two coefficients of a cubic that ends, h further, with the value and slope of the next."""
    m0 = here[1]
    m1 = after[1]
    s = (after[0] - here[0]) / h
    return (3.0 * s - 2.0 * m0 - m1) / h, (m0 + m1 - 2.0 * s) / (h * h)


def interpolate(here, after, h, t):
    """Value t above a knot, while the map is built."""
    c2, c3 = cubic_coefficients(here, after, h)
    return here[0] + t * (here[1] + t * (c2 + t * c3))


def table_error(side, n, knot):
    """Error of the table at this knot, between knots n and n + 1, in units of the first knot's values."""
    set_slopes(side, n)
    set_slopes(side, n + 1)
    first = side.knots[0]
    a = side.knots[n]
    b = side.knots[n + 1]
    h = b.ratio - a.ratio
    t = knot.ratio - a.ratio
    error = abs(interpolate(a.torque, b.torque, h, t) - knot.torque[0])
    error = error / first.torque[0] if first.torque[0] > 0.0 else 0.0
    error2 = OTHER_SHARE * abs(interpolate(a.omega2, b.omega2, h, t) - knot.omega2[0])
    error3 = OTHER_SHARE * abs(interpolate(a.input, b.input, h, t) - knot.input[0])
    error3 = error3 / first.input[0] if first.input[0] > 0.0 else 0.0
    return max(error, max(error2, error3))


def error_at_speeds(side, n, speeds):
    """Error that the table had where knot n has just been inserted, of the torque at the lower speeds.

    The slopes of its neighbours are still those of that table.

    Args:
        speeds: how many of them count.
    """
    a, here, b = side.knots[n - 1], side.knots[n], side.knots[n + 1]
    h = b.ratio - a.ratio
    t = here.ratio - a.ratio
    error = 0.0
    for m in range(speeds):
        foreseen = interpolate(a.slower[m].torque, b.slower[m].torque, h, t)
        error = max(error, abs(foreseen - here.slower[m].torque[0]))
    return error / side.knots[0].torque[0] if side.knots[0].torque[0] > 0.0 else 0.0


def insert_knot(side, n, knot, error):
    """Insert a knot as number n; error is that of the table there before it."""
    count = int(side.count)
    for m in range(count, n, -1):
        side.knots[m] = side.knots[m - 1]
    side.knots[n] = knot
    # halving an interval at least halves its error
    side.knots[n].error = 0.5 * error
    if n > 0:
        side.knots[n - 1].error = 0.5 * error
    side.count = count + 1.0


def worst_interval(side):
    """(number of the knot before the worst interval, its error)."""
    worst = 0
    error = 0.0
    last = int(side.count) - 1
    for n in range(last):
        width = side.knots[n + 1].ratio - side.knots[n].ratio
        if side.knots[n].error > error and width > NARROWEST * side.knots[last].ratio:
            worst = n
            error = side.knots[n].error
    return worst, error


def set_cubic_coefficients(here, after, h):
    """Write the last two coefficients of a cubic."""
    here[2], here[3] = cubic_coefficients(here, after, h)


def finish_table(side):
    """Write the coefficients of all cubics; beyond the last knot there is no torque."""
    count = int(side.count)
    if count > 1:
        for n in range(count):
            set_slopes(side, n)
    for n in range(count - 1):
        here = side.knots[n]
        after = side.knots[n + 1]
        h = after.ratio - here.ratio
        set_cubic_coefficients(here.torque, after.torque, h)
        set_cubic_coefficients(here.input, after.input, h)
        set_cubic_coefficients(here.omega2, after.omega2, h)
        if side.slow != 0.0:
            for m in range(len(here.slower)):
                set_cubic_coefficients(here.slower[m].torque, after.slower[m].torque, h)
                set_cubic_coefficients(here.slower[m].omega2, after.slower[m].omega2, h)
