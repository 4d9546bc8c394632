"""Internal steps of the averaged speed: J3 omega3' = T(omega1, omega3) - load, one scalar equation.

Gentle steps use Hermite's corrected trapezoid (order 4) as predictor and corrector, with both
derivatives. Stiff ones (a light shaft follows the mean torque at once) use the two-derivative method
of stability function Pade(1, 2): order 3, L-stable, so a transient costs no small steps.
Source: Hairer and Wanner, Solving Ordinary Differential Equations II, sections IV.3 and IV.5.
"""

from .average_rates import driving_rates
from .average_table import ROW_TORQUE, first_row
from .slots import *

# largest h |df/domega3| of the explicit step
GENTLE = 0.4
NEWTON_LOOKS = 12
# a transient is resolved by steps up to this h |df/domega3|, until it has come down to so many errors
RESOLVED = 2.0
TRANSIENT = 10.0
# work of one step: what is left in the workspace
W_NEXT = 0  # omega3 at the end
W_ERROR = 1  # estimated error over the allowed one
W_TURNED3 = 2  # integral of omega3
W_WORK = 3  # integral of T omega3
W_TURNED2 = 4  # integral of omega2


def hermite(h, y0, d0, y1, d1):
    """Integral over h by values and rates at both ends, order 4."""
    return h * (0.5 * (y0 + y1) + h * (d0 - d1) / 12.0)


def damped(h, y0, y1, d1):
    """Integral over h, order 3, without the rate at the beginning: right also through a transient."""
    return h * (y0 / 3.0 + y1 / 1.5 - h * d1 / 6.0)


def keep(w, h, omega3, first, last_omega3, last, rate0, rate1, stiff):
    """Quadratures of the step, first and last being what driving_rates returns at its ends."""
    t0, slope0, time0, y0, part0, partial0 = first
    t1, slope1, time1, y1, part1, partial1 = last
    g0 = t0 * omega3
    g1 = t1 * last_omega3
    dg1 = (time1 + slope1 * rate1) * last_omega3 + t1 * rate1
    dy1 = partial1 + part1 * rate1
    w[W_NEXT] = last_omega3
    if stiff:
        w[W_TURNED3] = damped(h, omega3, last_omega3, rate1)
        w[W_WORK] = damped(h, g0, g1, dg1)
        w[W_TURNED2] = damped(h, y0, y1, dy1)
        return
    dg0 = (time0 + slope0 * rate0) * omega3 + t0 * rate0
    w[W_TURNED3] = hermite(h, omega3, rate0, last_omega3, rate1)
    w[W_WORK] = hermite(h, g0, dg0, g1, dg1)
    w[W_TURNED2] = hermite(h, y0, partial0 + part0 * rate0, y1, dy1)


def gentle_step(d, x, w, header, speed, speed_rate, omega3, load, h, first, allowed):
    """One explicit step into the workspace."""
    inertia = d[D_J3]
    rate = (first[0] - load) / inertia
    bend = (first[2] + first[1] * rate) / inertia
    row = x[X_MAP_ROW]
    end = speed + speed_rate * h
    guess = omega3 + h * (rate + 0.5 * h * bend)
    last = driving_rates(d, x, header, end, speed_rate, guess)
    rate1 = (last[0] - load) / inertia
    bend1 = (last[2] + last[1] * rate1) / inertia
    found = omega3 + hermite(h, rate, bend, rate1, bend1)
    # the corrector leaves h |lambda| / 2 of the predictor's error; across a knot T" jumps
    share = 0.2 if x[X_MAP_ROW] != row else 0.5 * h * (abs(first[1]) + abs(last[1])) / inertia
    w[W_ERROR] = share * abs(found - guess) / allowed
    keep(w, h, omega3, first, found, last, rate, rate1, False)


def is_one_way(d, header, speed, omega3, found, rate, load):
    """Whether the torque left keeps the sign of rate at the knots between: no balance is skipped."""
    row = first_row(header)
    low = min(omega3, found)
    high = max(omega3, found)
    for _ in range(int(d[header])):
        here = d[row] * speed
        if here >= high:
            break
        if here > low and (speed * speed * d[row + ROW_TORQUE] - load) * rate < 0.0:
            return False
        row += MAP_ROW
    return True


def stiff_step(d, x, w, header, speed, speed_rate, omega3, load, h, first, allowed):
    """One implicit step into the workspace; an error without bound if it is not found."""
    inertia = d[D_J3]
    rate = (first[0] - load) / inertia
    end = speed + speed_rate * h
    found = omega3
    w[W_ERROR] = 1e300
    last = first
    for _ in range(NEWTON_LOOKS):
        last = driving_rates(d, x, header, end, speed_rate, found)
        rate1 = (last[0] - load) / inertia
        slope = last[1] / inertia
        bend1 = last[2] / inertia + slope * rate1
        x[X_STEP_EVALUATIONS] += 1.0
        left = found - omega3 - h * (rate / 3.0 + rate1 / 1.5 - h * bend1 / 6.0)
        steep = 1.0 - h * slope / 1.5 + h * h * slope * slope / 6.0
        move = -left / steep
        found += move
        if abs(move) <= 1e-3 * allowed or abs(move) <= 1e-15 * abs(found):
            # where the slope is positive the balance repels: a damped step would be drawn to it
            if slope <= 0.0 and is_one_way(d, header, end, omega3, found, rate, load):
                w[W_ERROR] = abs(h / 3.0 * (rate1 - rate - h * bend1) / steep) / allowed
                # a transient that is damped out within the step would be wrong in the angle and the work
                away = abs(rate / first[1]) * inertia
                if h * abs(first[1]) > RESOLVED * inertia:
                    w[W_ERROR] = max(w[W_ERROR], away / (TRANSIENT * allowed))
            break
    rate1 = (last[0] - load) / inertia
    keep(w, h, omega3, first, found, last, rate, rate1, True)
