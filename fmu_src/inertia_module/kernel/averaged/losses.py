"""Steady motion with losses, the output speed held: one period of it by the general equations of motion.

Link 1 turns at the speed 1. What loads lose is the same at every speed; friction and drag are those of an
input speed, scaled: b / |omega1| and drag / omega1^2. To first order torque and losses, so scaled, are
parabolas of 1 / |omega1|; here they are cubics through four speeds: without bound; that at which friction and
drag would take the stall torque; 3/2 of it and 3 times it. With less friction it is a parabola
with one at 9 times it instead, for friction may end the driving. Down to a ninth of it what is left beside
the friction of links that crawl is a cubic of log |omega1|. Friction of link 1 and of the output needs no
map.
"""

import math

from ..accumulate import copy
from ..codes import FREEWHEEL, MESH, VISCOUS
from ..derive import TWO_PI
from ..equations.choice import choose_next_states, choose_states
from ..events.advance import advance_general
from .largest import LARGEST_CYCLES, go_to_part, is_long, parts_of_period, period_of_map

# slownesses (see rates) with motions of their own
SLOWNESSES = (1.0 / 9.0, 1.0 / 3.0, 2.0 / 3.0, 1.0, 3.0, 9.0)
# inertia that holds the output speed, over that of the mechanism
HEAVY = 1e30
TOLERANCE = 1e-6
# periods until it comes back to where it was: the mean torque that turns link 2 meanwhile, over the largest
# of the mesh, or how near it is known, rad/s
PERIODS = 60
BACK = 1e-6
NEAR = 1e-5
# internal steps before a period is given up, and the share of it that is as good as its end
MOST_STEPS = 200000
END = 1e-9
NO_LIMIT = 1e9
# phase of the highest harmonic, at the speed of link 1, in the first step after an event
FIRST_PHASE = 1.0
# share of the largest torque that stands for a stall torque of nothing
LEAST_STALL = 0.01


def slow_speed(p, d, stall):
    """Input speed, rad/s, at which friction and drag would take the stall torque, stall omega1^2; 0: none."""
    viscous = p.link2_friction + p.housing_drag_viscous + p.output_drag_viscous + d.k * d.k * p.drive_friction
    drag = p.housing_drag + p.output_drag
    stall = max(stall, LEAST_STALL * d.F_by_speed)
    if not stall > 0.0:
        return 0.0
    return (viscous + math.sqrt(viscous * viscous + 4.0 * stall * drag)) / (2.0 * stall)


def crawl(p, d, side, knot):
    """Write the motion of links so slow that friction alone counts into the knot: omega2 is constant then.

    Drags go with the square of the slowness, what is viscous goes with it.
    """
    set_losses(p, d, 1.0 / side.slow)
    linear, square = knot.slower[len(SLOWNESSES)], knot.slower[len(SLOWNESSES) + 1]
    ratio = knot.ratio
    # of the mesh, over the slip
    pulling = d.k * d.k * d.bq / (1.0 - d.mesh_loss)
    driving = side.direction * pulling - (pulling + d.b2 + d.housing_drag_viscous) * ratio
    overrun = side.direction * pulling + d.output_drag_viscous * ratio
    ahead = d.output_drag - d.housing_drag
    omega2 = 0.0
    if ratio == 0.0:
        linear.torque[0] = max(overrun, 0.0)
        square.torque[0] = 0.0
    elif ahead > 0.0 or (ahead == 0.0 and driving >= 0.0):
        omega2 = ratio
        linear.torque[0] = driving
        square.torque[0] = -d.housing_drag
    else:
        if ahead == 0.0 and overrun > 0.0:
            omega2 = overrun / (pulling + d.b2 + d.housing_drag_viscous + d.output_drag_viscous)
        linear.torque[0] = -d.output_drag_viscous * (ratio - omega2)
        square.torque[0] = -d.output_drag
    linear.omega2[0] = omega2
    square.omega2[0] = 0.0
    for cause in range(len(linear.lost)):
        linear.lost[cause] = square.lost[cause] = 0.0
    slip = 1.0 - side.direction * omega2
    over = ratio - omega2
    linear.lost[VISCOUS] = d.bq * (d.k * slip) ** 2 + d.b2 * omega2 * omega2
    linear.lost[MESH] = d.mesh_loss * pulling * slip * slip
    linear.lost[FREEWHEEL] = d.housing_drag_viscous * omega2 * omega2 + d.output_drag_viscous * over * over
    square.lost[FREEWHEEL] = d.housing_drag * omega2 + d.output_drag * over
    set_losses(p, d, 0.0)


def set_losses(p, d, slowness):
    """Set the friction and drag that links of speed 1 have for the input speed 1 / slowness."""
    square = slowness * slowness
    d.bq = slowness * p.drive_friction
    d.b2 = slowness * p.link2_friction
    d.housing_drag_viscous = slowness * p.housing_drag_viscous
    d.output_drag_viscous = slowness * p.output_drag_viscous
    d.housing_drag = square * p.housing_drag
    d.output_drag = square * p.output_drag


def angle_travelled(x):
    """Angle of the drive since the sums were cleared, rad, without sign."""
    return abs(x.q - x.begin_q + TWO_PI * x.drive_turns)


def clear_sums(x):
    """Clear the sums of the motion in x."""
    x.begin_q = x.q
    x.drive_turns = 0.0
    x.output_impulse = 0.0
    x.output_square = 0.0
    x.torque_peak = 0.0
    for cause in range(len(x.lost)):
        x.lost[cause] = 0.0
        x.lost_low[cause] = 0.0


def follow(d, x, w, length):
    """Follow the motion in x over so much angle of the drive. Returns the time it takes, or -1."""
    time = 0.0
    left = length
    limit = NO_LIMIT
    for _ in range(MOST_STEPS):
        copy(w.kept.numbers, x.numbers)
        passed, event = advance_general(d, x, w, limit)
        if passed < 0.0:
            return -1.0
        rest = length - angle_travelled(x)
        if rest < -END * length:
            # back, and no further than at the present speed: exact where link 2 is held or drives
            copy(x.numbers, w.kept.numbers)
            limit = min(0.5 * limit, left / (d.k * abs(x.omega1 - x.omega2)))
            continue
        if event:
            choose_next_states(d, x)
            # what was locked for long moves at once now
            x.step_size = min(x.step_size, FIRST_PHASE / (d.harmonic * d.k))
        time += passed
        left = rest
        if left <= END * length:
            return time
        if limit < NO_LIMIT:
            limit = left / (d.k * abs(x.omega1 - x.omega2))
    return -1.0


def add_part(d, x, w, q, direction, ratio, length, before):
    """Add the motion over an angle of the drive to the sums in d; it begins at q with x.omega2.

    Args:
        before: whether it goes over the same angle once before, not counted.

    Returns:
        Whether it comes to its end.
    """
    omega2 = x.omega2
    for n in range(len(x.numbers)):
        x.numbers[n] = 0.0
    x.q = q % d.period
    x.omega1 = direction
    x.omega2 = omega2
    x.omega3 = ratio
    choose_states(d, x, False)
    time = -1.0
    for _ in range(2 if before else 1):
        clear_sums(x)
        x.omega3 = ratio
        time = follow(d, x, w, length)
        if time < 0.0:
            return False
    d.sum_time += time
    d.sum_torque += x.output_impulse
    d.sum_square += x.output_square
    d.sum_omega2 += direction * (time - angle_travelled(x) / d.k)
    d.sum_peak = max(d.sum_peak, x.torque_peak)
    for cause in range(len(x.lost)):
        d.sum_lost[cause] += x.lost[cause]
    return True


def add_period(d, x, w, side, ratio, begin):
    """Set the sums in d to those over a period, or the parts that stand for it, in which omega2 begins so.

    Returns:
        omega2 at its end, or -1: the motion does not come there.
    """
    d.sum_time = d.sum_torque = d.sum_square = d.sum_omega2 = d.sum_peak = 0.0
    for cause in range(len(d.sum_lost)):
        d.sum_lost[cause] = 0.0
    x.omega2 = begin
    through = True
    if not is_long(d):
        through = add_part(d, x, w, side.start, side.direction, ratio, period_of_map(d), False)
    else:
        part, parts = parts_of_period(d, 0.25 * LARGEST_CYCLES)
        phase = d.phase_b
        for n in range(parts):
            q = go_to_part(d, phase, part, parts, n)
            through = through and add_part(d, x, w, q, side.direction, ratio, part, True)
        d.phase_b = phase
    return x.omega2 if through else -1.0


def add_steady(d, x, w, side, ratio, slowness):
    """Set the sums in d to those of the steady motion: omega2 is at the end of a period what it began with.

    What it ends with never falls with what it begins with, and between 0 and the speed of the output there is
    such a motion. If link 2 comes to rest in it, a motion from rest becomes it; if it drives, one that begins
    with the speed of the output does.

    Returns:
        Whether it is found.
    """
    low = begin = gain = loss = 0.0
    high = ratio
    inertia = d.J2 + d.F_by_alpha1
    ideal = slowness == 0.0 and d.mesh_loss + d.satellite_loss + d.journal == 0.0
    for n in range(PERIODS):
        end = add_period(d, x, w, side, ratio, begin)
        if end < 0.0:
            return False
        change = end - begin
        # (without friction link 2 turns on for ever as it was thrown)
        if ideal or abs(change) * inertia <= BACK * d.F_by_speed * d.sum_time or high - low <= NEAR:
            return True
        if change > 0.0:
            low = begin
            gain = change
        else:
            high = begin
            loss = change
        if n == 1:
            begin = ratio
        elif n < 3:
            begin = end
        else:
            share = gain / (gain - loss) if n % 2 == 1 else 0.5
            begin = low + share * (high - low)
    return False


def settle_losses(p, d, w, side, ratio, slowness):
    """Sums in d over the steady motion with losses at this speed ratio, friction as at 1 / slowness.

    Where there is none, d.map_failed is set.

    Args:
        w: workspace; w.part is the state that is followed.
    """
    inertia, longest, b1, b3 = d.J3, d.max_step, d.b1, d.b3
    d.J3 = HEAVY * (d.J2 + d.F_by_alpha1)
    w.tolerance = TOLERANCE
    d.max_step = NO_LIMIT
    d.b1 = d.b3 = 0.0
    set_losses(p, d, slowness)
    w.prescribed = 0.0
    w.load = 0.0
    through = add_steady(d, w.part, w, side, ratio, slowness)
    d.J3, d.max_step, d.b1, d.b3 = inertia, longest, b1, b3
    set_losses(p, d, 0.0)
    if not through:
        d.map_failed = 1.0
        d.sum_time = max(d.sum_time, 1.0)
