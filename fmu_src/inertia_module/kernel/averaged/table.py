"""Knots of the averaged map: interpolated without overshoot, added where the table is worst.

Slopes are those of Fritsch and Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300, as in SciPy's
PchipInterpolator: between knots no value leaves the range of its neighbours.
"""

# slownesses V0 / (|v| + V0) of the motions of a knot (see torque_map): the ideal one, those followed, those
# of links that crawl; the input's curve is common to all. The table is refined for so many lower speeds
SLOWNESS = (0.0, 0.1, 0.25, 0.4, 0.5, 0.75, 0.9, 0.99, 1.0)
MOTIONS = len(SLOWNESS)
SLOWER = 4
# places of their first curves: torques, speeds of link 2; of the ideal motion alone input, ripple and peak;
# powers lost stand by cause
TORQUE, OMEGA2, INPUT = 0, MOTIONS, 2 * MOTIONS
RIPPLE, PEAK = INPUT + 1, INPUT + 2
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
    if far == 0.0:
        return s0
    if s0 == 0.0:
        return 0.0
    s1 = (beyond - following) / far
    slope = ((2.0 * near + far) * s0 - near * s1) / (near + far)
    return s0 * max(0.0, min(slope / s0, 3.0))


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
    for curve in range(len(here.value)):
        # (without losses there is one motion)
        if side.slow == 0.0 and curve < INPUT and curve % MOTIONS != 0:
            continue
        before, value, after = a.value[curve], here.value[curve], b.value[curve]
        if inner:
            here.slope[curve] = inner_slope(near, far, before, value, after)
        else:
            here.slope[curve] = end_slope(near, far, value, before, after)


def interpolate(here, after, curve, ratio):
    """Value of a curve, and its slope, between two knots: by Hermite's cubic."""
    per_width = 1.0 / (after.ratio - here.ratio)
    t = ratio - here.ratio
    m0 = here.slope[curve]
    m1 = after.slope[curve]
    s = (after.value[curve] - here.value[curve]) * per_width
    c2, c3 = (3.0 * s - 2.0 * m0 - m1) * per_width, (m0 + m1 - 2.0 * s) * per_width * per_width
    return here.value[curve] + t * (m0 + t * (c2 + t * c3)), m0 + t * (2.0 * c2 + 3.0 * t * c3)


def missed(side, n, knot, curve, scale):
    """How far a curve is off at this knot, between knots n and n + 1, over a scale."""
    value, _ = interpolate(side.knots[n], side.knots[n + 1], curve, knot.ratio)
    return abs(value - knot.value[curve]) / scale if scale > 0.0 else 0.0


def table_error(side, n, knot):
    """Error of the table at this knot, between knots n and n + 1, in units of the first knot's values."""
    set_slopes(side, n)
    set_slopes(side, n + 1)
    first = side.knots[0].value
    error = missed(side, n, knot, INPUT, first[INPUT])
    worst = OTHER_SHARE * max(error, missed(side, n, knot, OMEGA2, 1.0))
    for curve in range(TORQUE, TORQUE + 1 + (SLOWER if side.slow > 0.0 else 0)):
        worst = max(worst, missed(side, n, knot, curve, first[TORQUE]))
    return worst


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
