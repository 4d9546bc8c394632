"""Internal steps of the averaged speed: J3 omega3' = T(omega1, omega3) - load, one scalar equation.

Explicit steps use Hermite's corrected trapezoid (order 4) as predictor and corrector, with both
derivatives. Implicit ones (a light shaft follows the mean torque at once) use the two-derivative method
of stability function Pade(1, 2): order 3, L-stable, so a transient costs no small steps.
Source: Hairer and Wanner, Solving Ordinary Differential Equations II, sections IV.3 and IV.5.

A step leaves in the workspace w.next, omega3 at its end, w.error, its error over the allowed one, and
w.turned3, w.work and w.turned2, the integrals of omega3, T omega3 and omega2.
"""

from ..accumulate import add
from .rates import mean_rates

# largest h |df/domega3| of an explicit step
LARGEST_EXPLICIT = 0.4
NEWTON_STEPS = 12
# a transient is resolved by steps up to this h |df/domega3|, until it has come down to so many errors
RESOLVED = 2.0
TRANSIENT = 10.0
# steps tried before the tolerance is given up, and to stop where the shaft rests or the map ends
TRIES = 80
CUTS = 60
# a speed within this fraction of another is at it
ROUNDING = 1e-12


def hermite(h, y0, d0, y1, d1):
    """Integral over h by values and rates at both ends, order 4."""
    return h * (0.5 * (y0 + y1) + h * (d0 - d1) / 12.0)


def damped(h, y0, y1, d1):
    """Integral over h, order 3, without the rate at the beginning: right also through a transient."""
    return h * (y0 / 3.0 + y1 / 1.5 - h * d1 / 6.0)


def integrate(w, h, omega3, first, last_omega3, last, rate0, rate1, implicit):
    """Integrals over the step, first and last being what mean_rates returns at its ends."""
    t0, slope0, time0, y0, part0, partial0 = first
    t1, slope1, time1, y1, part1, partial1 = last
    g0 = t0 * omega3
    g1 = t1 * last_omega3
    dg1 = (time1 + slope1 * rate1) * last_omega3 + t1 * rate1
    dy1 = partial1 + part1 * rate1
    w.next = last_omega3
    if implicit:
        w.turned3 = damped(h, omega3, last_omega3, rate1)
        w.work = damped(h, g0, g1, dg1)
        w.turned2 = damped(h, y0, y1, dy1)
        return
    dg0 = (time0 + slope0 * rate0) * omega3 + t0 * rate0
    w.turned3 = hermite(h, omega3, rate0, last_omega3, rate1)
    w.work = hermite(h, g0, dg0, g1, dg1)
    w.turned2 = hermite(h, y0, partial0 + part0 * rate0, y1, dy1)


def explicit_step(d, side, x, w, speed, speed_rate, h, first, allowed):
    """One explicit step."""
    inertia = d.J3
    omega3 = x.omega3
    rate = (first[0] - x.load_torque) / inertia
    bend = (first[2] + first[1] * rate) / inertia
    knot = x.map_knot
    guess = omega3 + h * (rate + 0.5 * h * bend)
    last = mean_rates(side, x, speed + speed_rate * h, speed_rate, guess)
    rate1 = (last[0] - x.load_torque) / inertia
    bend1 = (last[2] + last[1] * rate1) / inertia
    found = omega3 + hermite(h, rate, bend, rate1, bend1)
    # the corrector leaves h |lambda| / 2 of the predictor's error; across a knot T" jumps
    share = 0.2 if x.map_knot != knot else 0.5 * h * (abs(first[1]) + abs(last[1])) / inertia
    w.error = share * abs(found - guess) / allowed
    integrate(w, h, omega3, first, found, last, rate, rate1, False)


def is_one_way(side, x, speed, found, rate):
    """Whether the torque left keeps the sign of rate at the knots between: no balance is skipped."""
    low = min(x.omega3, found)
    high = max(x.omega3, found)
    for n in range(int(side.count)):
        knot = side.knots[n]
        here = knot.ratio * speed
        if here >= high:
            break
        if here > low and (speed * speed * knot.torque[0] - x.load_torque) * rate < 0.0:
            return False
    return True


def implicit_step(d, side, x, w, speed, speed_rate, h, first, allowed):
    """One implicit step; an error without bound if it is not found."""
    inertia = d.J3
    omega3 = x.omega3
    rate = (first[0] - x.load_torque) / inertia
    end = speed + speed_rate * h
    found = omega3
    w.error = 1e300
    last = first
    for _ in range(NEWTON_STEPS):
        last = mean_rates(side, x, end, speed_rate, found)
        rate1 = (last[0] - x.load_torque) / inertia
        slope = last[1] / inertia
        bend1 = last[2] / inertia + slope * rate1
        x.step_evaluations += 1.0
        left = found - omega3 - h * (rate / 3.0 + rate1 / 1.5 - h * bend1 / 6.0)
        steep = 1.0 - h * slope / 1.5 + h * h * slope * slope / 6.0
        move = -left / steep
        found += move
        if abs(move) <= 1e-3 * allowed or abs(move) <= 1e-15 * abs(found):
            # where the slope is positive the balance repels: a damped step would be drawn to it
            if slope <= 0.0 and is_one_way(side, x, end, found, rate):
                w.error = abs(h / 3.0 * (rate1 - rate - h * bend1) / steep) / allowed
                # a transient that is damped out within the step would be wrong in the angle and the work
                away = abs(rate / first[1]) * inertia
                if h * abs(first[1]) > RESOLVED * inertia:
                    w.error = max(w.error, away / (TRANSIENT * allowed))
            break
    rate1 = (last[0] - x.load_torque) / inertia
    integrate(w, h, omega3, first, found, last, rate, rate1, True)


def take_step(d, side, x, w, speed, speed_rate, h, first, allowed):
    """One step from x.omega3, explicit if it can be; x is left as it is."""
    if h * abs(first[1]) <= LARGEST_EXPLICIT * d.J3:
        explicit_step(d, side, x, w, speed, speed_rate, h, first, allowed)
    else:
        implicit_step(d, side, x, w, speed, speed_rate, h, first, allowed)
    x.step_evaluations += 1.0


def take_accurate_step(d, side, x, w, speed, speed_rate, h, first, allowed):
    """One step, no longer than h, as long as the error allows. Returns its length or -1."""
    wanted = h
    for _ in range(TRIES):
        take_step(d, side, x, w, speed, speed_rate, h, first, allowed)
        if w.error <= 1.0:
            factor = min(5.0, 0.8 * w.error**-0.25) if w.error > 1e-4 else 5.0
            # a step cut short by the end of the communication step says little about longer ones
            x.step_size = max(factor * h, x.step_size) if h == wanted else factor * h
            return h
        h *= max(0.1, 0.8 * w.error**-0.25) if w.error < 1e4 else 0.1
    return -1.0


def past_end(side, w, end_speed):
    """How far the step went past rest or the end of the map, rad/s."""
    return max(w.next - side.end * end_speed, -w.next)


def cut_step(d, side, x, w, speed, speed_rate, h, first, allowed, zero):
    """Cut a step that went past rest or the end of the map where it gets there. Returns its length."""
    high = h
    high_past = past_end(side, w, speed + speed_rate * h)
    low = 0.0
    low_past = max(-x.omega3, x.omega3 - side.end * speed)
    if low_past > -zero:
        low_past = -high_past  # it begins where the map ends: that is not where it is to stop
    # Illinois: a secant that never leaves the bracket
    for _ in range(CUTS):
        h = high - high_past * (high - low) / (high_past - low_past)
        if not low < h < high:
            h = 0.5 * (low + high)
        if not low < h < high:
            return high
        take_step(d, side, x, w, speed, speed_rate, h, first, allowed)
        past = past_end(side, w, speed + speed_rate * h)
        if abs(past) <= zero:
            break
        if past > 0.0:
            high = h
            high_past = past
            low_past *= 0.5
        else:
            low = h
            low_past = past
            high_past *= 0.5
    return h


def slip(d, side, x, w, omega1, alpha1, remaining):
    """Advance the shaft under the mean torque by one accurate step; where it rests or the map ends, it stops.

    Returns:
        (time passed or -1, impulse of the output torque).
    """
    speed = abs(omega1)
    speed_rate = side.direction * alpha1
    omega3 = x.omega3
    first = mean_rates(side, x, speed, speed_rate, omega3)
    x.step_evaluations += 1.0
    h = min(remaining, d.max_step)
    if x.step_size > 0.0:
        h = min(h, x.step_size)
    fastest = max(omega3, max(speed, speed + speed_rate * h))
    allowed = d.tolerance * fastest + 1e-300
    h = take_accurate_step(d, side, x, w, speed, speed_rate, h, first, allowed)
    if h < 0.0:
        return -1.0, 0.0
    zero = ROUNDING * fastest
    cut = past_end(side, w, speed + speed_rate * h) > zero
    if cut:
        h = cut_step(d, side, x, w, speed, speed_rate, h, first, allowed, zero)
    rests = cut and -w.next > w.next - side.end * (speed + speed_rate * h)
    x.omega3, x.omega3_low = add(omega3, x.omega3_low, w.next - omega3)
    end = side.end * abs(omega1 + alpha1 * h)
    if rests or x.omega3 < 0.0:
        x.omega3 = 0.0
        x.omega3_low = 0.0
    elif cut or x.omega3 > end:
        x.omega3 = end
        x.omega3_low = 0.0
    return h, d.J3 * (w.next - omega3) + x.load_torque * h
