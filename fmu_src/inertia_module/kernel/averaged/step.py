"""Internal steps of the averaged motion: speed v of the input, given or under its torque, and omega3.

Explicit steps use Hermite's corrected trapezoid (order 4) as predictor and corrector, with both
derivatives. Implicit ones (a light shaft follows the mean torque at once) use the two-derivative method
of stability function Pade(1, 2): order 3, L-stable, so a transient costs no small steps.
Source: Hairer and Wanner, Solving Ordinary Differential Equations II, sections IV.3 and IV.5.

A step leaves in the workspace w.next_speed and w.next, |v| and omega3 at its end, w.error, its error over the
allowed one, and w.turned3, w.work, w.turned2, w.turned1 and w.lost3, the integrals of omega3, T omega3,
omega2, |omega1|, and b3 omega3^2.
"""

import math

from ..accumulate import add
from .rates import find_knot, flow, ratio, torque_at_knot

# largest h |df/domega3| of an explicit step
LARGEST_EXPLICIT = 0.4
NEWTON_STEPS = 12
# what the energies of a step may miss, in errors allowed of the speeds
BALANCE = 10.0
# a transient is resolved by steps up to this h |df/domega3|, until it has come down to so many errors
RESOLVED = 2.0
TRANSIENT = 10.0
# steps tried before the tolerance is given up, and to stop where the shaft rests or the map ends
TRIES = 80
CUTS = 60
# a speed within this fraction of another is at it
ROUNDING = 1e-12


def hermite(h, begin, end):
    """Integral over h by value and rate at both ends, order 4."""
    return h * (0.5 * (begin[0] + end[0]) + h * (begin[1] - end[1]) / 12.0)


def damped(h, begin, end):
    """Integral over h, order 3, without the rate at the beginning: right also through a transient."""
    return h * (begin[0] / 3.0 + end[0] / 1.5 - h * end[1] / 6.0)


def integral(h, begin, end, implicit):
    """Integral over h by the rule of the step."""
    return damped(h, begin, end) if implicit else hermite(h, begin, end)


def with_product(omega3, now):
    """(T omega3, its rate) of a flow."""
    return now[3][0] * omega3, now[3][1] * omega3 + now[3][0] * now[1][0]


def middle_speed(h, turned3, begin, end):
    """Speed of the output in the middle of h, rad/s: that of Simpson's rule for the angle turned."""
    if h == 0.0:
        return begin
    middle = 0.25 * (6.0 * turned3 / h - begin - end)
    return min(max(middle, min(begin, end)), max(begin, end))


def finish_step(d, x, w, h, first, last, found_speed, found, implicit):
    """Leave the speeds at the end of a step and its integrals in w; first, last: flow at its ends."""
    w.next_speed = found_speed
    w.next = found
    w.turned3 = integral(h, (x.omega3, first[1][0]), (found, last[1][0]), implicit)
    w.work = integral(h, with_product(x.omega3, first), with_product(found, last), implicit)
    w.lost = integral(h, first[6], last[6], implicit)
    w.lost3 = 0.0
    if d.b3 != 0.0:
        middle = middle_speed(h, w.turned3, x.omega3, found)
        w.lost3 = d.b3 * h * (x.omega3 * x.omega3 + 4.0 * middle * middle + found * found) / 6.0
    w.turned2 = integral(h, first[4], last[4], implicit)
    if d.by_torque != 0.0:
        w.turned1 = integral(h, first[5], last[5], implicit)


def explicit_step(d, side, x, w, speed, speed_rate, h, first, allowed):
    """One explicit step."""
    omega3 = x.omega3
    # with friction the torque has corners; a longer step tried before may have looked elsewhere since
    knot = find_knot(side, x, ratio(omega3, speed)) if d.lossy != 0.0 else x.map_knot
    guess_speed = speed + h * (first[0][0] + 0.5 * h * first[0][1])
    guess = omega3 + h * (first[1][0] + 0.5 * h * first[1][1])
    last = flow(d, side, x, guess_speed, speed_rate, guess)
    found_speed = speed + hermite(h, first[0], last[0])
    found = omega3 + hermite(h, first[1], last[1])
    # the corrector leaves h |lambda| / 2 of the predictor's error; across a knot T" jumps
    share = 0.2 if x.map_knot != knot else 0.5 * h * (steepness(first) + steepness(last))
    w.error = share * max(abs(found - guess), abs(found_speed - guess_speed)) / allowed
    finish_step(d, x, w, h, first, last, found_speed, found, False)


def steepness(now):
    """Size of the slopes of a flow, 1/s."""
    a, b, c, e = now[2]
    return max(abs(e), max(abs(a), math.sqrt(abs(b * c))))


def is_one_way(side, x, b3, speed, found, rate):
    """Tell whether the torque left keeps the sign of rate at the knots between: no balance is skipped."""
    low = min(x.omega3, found)
    high = max(x.omega3, found)
    for n in range(int(side.count)):
        knot = side.knots[n]
        here = knot.ratio * speed
        if here >= high:
            break
        left = speed * speed * torque_at_knot(side, knot, speed) - x.load_torque - b3 * here
        if here > low and left * rate < 0.0:
            return False
    return True


def implicit_step(d, side, x, w, speed, speed_rate, h, first, allowed):
    """One implicit step; an error without bound if it is not found."""
    omega3 = x.omega3
    found_speed = speed + speed_rate * h
    found = omega3
    w.error = 1e300
    last = first
    for _ in range(NEWTON_STEPS):
        last = flow(d, side, x, found_speed, speed_rate, found)
        x.step_evaluations += 1.0
        left = found_speed - speed - damped(h, first[0], last[0])
        left3 = found - omega3 - damped(h, first[1], last[1])
        # 1 - 2/3 h L + 1/6 (h L)^2 with the slopes L
        a, b, c, e = last[2]
        a1 = 1.0 - h * a / 1.5 + h * h * (a * a + b * c) / 6.0
        a2 = -h * b / 1.5 + h * h * b * (a + e) / 6.0
        b1 = -h * c / 1.5 + h * h * c * (a + e) / 6.0
        b2 = 1.0 - h * e / 1.5 + h * h * (b * c + e * e) / 6.0
        steep = a1 * b2 - a2 * b1
        move_speed = (a2 * left3 - b2 * left) / steep
        move = (b1 * left - a1 * left3) / steep
        found_speed += move_speed
        found += move
        moved = max(abs(move), abs(move_speed))
        if moved <= 1e-3 * allowed or moved <= 1e-15 * (abs(found) + abs(found_speed)):
            # where the slope is positive the balance repels: a damped step would be drawn to it
            if e <= 0.0 and is_one_way(side, x, d.b3, found_speed, found, first[1][0]):
                bent = max(step_error(h, first[0], last[0]), step_error(h, first[1], last[1]))
                w.error = abs(bent / steep) / allowed
                # a transient that is damped out within the step would be wrong in the angle and the work
                slope = abs(first[2][3])
                if h * slope > RESOLVED:
                    w.error = max(w.error, abs(first[1][1]) / (slope * slope * TRANSIENT * allowed))
            break
    finish_step(d, x, w, h, first, last, found_speed, found, True)


def step_error(h, begin, end):
    """Difference that the rate at the end leaves of the change of a rate over h, times h / 3."""
    return abs(h / 3.0 * (end[0] - begin[0] - h * end[1]))


def take_step(d, side, x, w, speed, speed_rate, h, first, allowed):
    """One step from x.omega3, explicit if it can be; x is left as it is."""
    if h * steepness(first) <= LARGEST_EXPLICIT:
        explicit_step(d, side, x, w, speed, speed_rate, h, first, allowed)
    else:
        implicit_step(d, side, x, w, speed, speed_rate, h, first, allowed)
    x.step_evaluations += 1.0


def energy_residual(d, side, x, w, speed, fastest, allowed, implicit):
    """Energy residual of a step under a torque, relative to its tolerance: some errors of the speeds.

    Of an implicit step it is that of link 1: a transient of the shaft that is damped out may miss much of the
    little that it moves.
    """
    square = fastest * fastest
    put_in = side.direction * x.drive_torque * w.turned1
    gained = 0.5 * d.map_inertia * (w.next_speed - speed) * (w.next_speed + speed)
    share = abs(put_in - w.work - w.lost - gained) / (d.map_inertia * square + abs(put_in) + abs(w.work))
    if not implicit:
        passed_on = x.load_torque * w.turned3 + w.lost3
        gained = 0.5 * d.J3 * (w.next - x.omega3) * (w.next + x.omega3)
        share += abs(w.work - passed_on - gained) / (d.J3 * square + abs(w.work) + abs(passed_on))
    return share * fastest / (BALANCE * allowed)


def take_accurate_step(d, side, x, w, speed, speed_rate, h, first, allowed, fastest):
    """One step, no longer than h, as long as the error and the balance of energies allow.

    Returns its length or -1.
    """
    wanted = h
    for _ in range(TRIES):
        take_step(d, side, x, w, speed, speed_rate, h, first, allowed)
        if d.by_torque != 0.0:
            implicit = h * steepness(first) > LARGEST_EXPLICIT
            residual = energy_residual(d, side, x, w, speed, fastest, allowed, implicit)
            w.error = max(w.error, residual)
        if w.error <= 1.0:
            factor = min(5.0, 0.8 * w.error**-0.25) if w.error > 1e-4 else 5.0
            # a step cut short by the end of the communication step says little about longer ones
            x.step_size = max(factor * h, x.step_size) if h == wanted else factor * h
            return h
        h *= max(0.1, 0.8 * w.error**-0.25) if w.error < 1e4 else 0.1
    return -1.0


def past_end(side, w):
    """How far the step went past rest or the end of the map, or v past zero, rad/s."""
    return max(max(w.next - side.end * w.next_speed, -w.next), -w.next_speed)


def cut_step(d, side, x, w, speed, speed_rate, h, first, allowed, zero):
    """Cut a step that went past rest or the end of the map where it gets there. Returns its length."""
    high = h
    high_past = past_end(side, w)
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
        past = past_end(side, w)
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


def slip(d, side, x, w, v, rate, remaining):
    """Advance v and omega3 by one accurate step; where the shaft rests or the map ends it stops.

    Returns:
        (time passed or -1, impulse of the output torque).
    """
    speed = abs(v)
    speed_rate = side.direction * rate
    omega3 = x.omega3
    first = flow(d, side, x, speed, speed_rate, omega3)
    x.step_evaluations += 1.0
    h = min(remaining, d.max_step)
    if x.step_size > 0.0:
        h = min(h, x.step_size)
    fastest = max(omega3, max(speed, speed + first[0][0] * h))
    allowed = w.tolerance * fastest + 1e-300
    h = take_accurate_step(d, side, x, w, speed, speed_rate, h, first, allowed, fastest)
    if h < 0.0:
        return -1.0, 0.0
    zero = ROUNDING * fastest
    cut = past_end(side, w) > zero
    if cut:
        h = cut_step(d, side, x, w, speed, speed_rate, h, first, allowed, zero)
    w.next_speed = max(w.next_speed, 0.0)
    end = side.end * w.next_speed
    rests = cut and -w.next > w.next - end
    x.omega3, x.omega3_low = add(omega3, x.omega3_low, w.next - omega3)
    if rests or x.omega3 < 0.0:
        x.omega3 = 0.0
        x.omega3_low = 0.0
    elif cut or x.omega3 > end:
        x.omega3 = end
        x.omega3_low = 0.0
    return h, d.J3 * (w.next - omega3) + x.load_torque * h + d.b3 * w.turned3
