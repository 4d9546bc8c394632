"""Estimated error of a step of the equations of motion over the allowed one."""

import math

from ..equations.losses import JOURNAL, MESH
from ..equations.states import LOCKED, OPEN, WOUND, is_open, is_wound
from ..links import response, shaft_frequency
from ..tableau import END, FIFTH, FOURTH, LATE, LONG, SHORT, SHORT_END, THIRD, THIRDS
from . import stages

# sums that are held to the tolerance, for the motion tells nothing of their errors: the losses have kinks
# that are no events, and where link 1 stands still no energy shows what torque holds it
HELD_SUMS = (stages.OF_DRIVE, stages.OF_HOUSING, stages.WORK_IN, stages.LOST + MESH, stages.LOST + JOURNAL)
# a twisted shaft at rest: speeds are measured by this share of what its energy could drive
TWIST_SHARE = 1e-1
# stage of Rosenbrock's method that is its error, and the share of the allowed one that it may have
STIFF_ERROR, STIFF_SHARE = 7, 0.1
# ... and how much more of it a swing of the shaft that is as wide as the output is fast
SWING = 10.0
# ... up to so many allowed errors of the speed of the driven mass
HELD = 900.0
# the error of a work is measured by so many present kinetic energies, from rest by this share of the largest
OF_ENERGY = 10.0
FROM_REST = 0.01
# ... of a loss by this share of it: friction that hardly loads the links for an instant is a kink of its own
OF_LOSSES = 0.1
# share of its largest inertia below which a link has a cusp: errors grow there as its speed does
CUSP = 1e-2
# share of the tolerance where an output swings and nothing brings link 2 to rest, so that errors of phase add
# up; it flies from pulse to pulse before an output that has this share of the speed of links 1 and 2
SWINGING, FLYING = 0.15, 0.33
# angle within a step whose rate squared is no number, rad: what comes to rest need not be followed for ever
NO_TURN = 1e-150
# share of a scale that is rounding
ROUNDING = 1e-13


def fastest_speed(d, x, w):
    """Largest speed of links 1 and 2 at the ends of the step in hand, or one that is none, rad/s."""
    links = max(abs(x.omega1), abs(x.omega1 + w.change.omega1))
    return max(links, abs(x.omega2), abs(x.omega2 + w.change.omega2), NO_TURN / w.step)


def fastest_behind(d, x, w):
    """Largest speed of the output at the ends of the step, or a share of what its twist could drive."""
    output = max(abs(x.omega3), abs(x.omega3 + w.change.omega3))
    if d.elastic == 0.0:
        return output
    change = w.change
    twist = max(abs(x.twist), abs(x.twist + change.twist))
    driven = max(abs(x.omega3 - x.relative), abs(x.omega3 + change.omega3 - x.relative - change.relative))
    return max(output, driven, TWIST_SHARE * shaft_frequency(d, 1.0 / d.J3) * twist)


def speed_behind(d, x, w, fastest):
    """Speed that links 1 and 2 are measured by: what winds up freewheels moves them as it moves, or might."""
    if is_open(x.output_state):
        spring = d.housing_stiffness / max(d.J2 + d.F_by_alpha1, 1e-300)
        return max(fastest, TWIST_SHARE * math.sqrt(spring) * abs(x.wound_housing))
    return max(fastest, fastest_behind(d, x, w)) if is_wound(x) else fastest


def speed_of_torque(d, x, w, fastest):
    """Speed at which what damps a wound up freewheel is as large as the torques, rad/s."""
    housing = d.housing_damping if x.housing_state == WOUND else 0.0
    damping = max(housing, d.freewheel_damping if x.output_state == WOUND else 0.0)
    if damping == 0.0:
        return 1e300
    pulses = 0.5 * (d.k * d.k * d.F_by_slip + d.F_by_speed) * fastest * fastest
    # at rest, too, the springs hold something, or will: what yet slows the hub down
    held = abs(w.rates[0].housing) + abs(w.rates[0].output) + d.J3 * abs(w.rates[0].omega3)
    return (pulses + abs(w.load) + held) / damping


def speed_of_swing(d, x, w, rate, speed, fastest):
    """Speed that errors of the shaft's swing are measured by: it holds little where the output moves faster.

    A swing wider than pulses make it has been excited by a load, and is followed.

    Args:
        rate: of the shaft between hub and driven mass, rad/s. speed: that of errors of the output, rad/s.
    """
    change = w.change
    swing = max(abs(x.relative), abs(x.relative + change.relative))
    swing = max(swing, rate * max(abs(x.twist), abs(x.twist + change.twist)))
    moved = max(abs(x.omega2), abs(x.omega3), abs(change.omega2), abs(change.omega3))
    pulses = d.harmonic * d.k * fastest * response(d, d.J2 + d.J3) * fastest / rate
    if swing >= min(moved, pulses):
        return speed
    # how much wider the swing is than that of the driven mass in it, which a balancer moves along
    wider = abs((1.0 - d.balancer) * d.J4 + d.J3) / max(abs(d.J3 - d.balancer * d.J4), 1e-300)
    return max(speed, min(SWING * moved * speed / max(swing, 1e-300), HELD * wider * moved))


def scale_of(d, x, w, n, fastest):
    """Scale of the error of a followed quantity."""
    change = abs(w.change.numbers[n])
    if n == stages.Q:
        return 1.0
    if n == stages.OMEGA1:
        return max(response(d, d.J1) * fastest, change)
    moved = speed_behind(d, x, w, fastest)
    if n == stages.OMEGA2:
        speed = response(d, d.J2 + (d.J3 if x.output_state == LOCKED else 0.0)) * moved
        return min(max(speed, change), speed_of_torque(d, x, w, fastest))
    speed = response(d, d.J2 + d.J3) * max(fastest, fastest_behind(d, x, w))
    if n == stages.OMEGA3:
        return min(max(speed, change), speed_of_torque(d, x, w, fastest))
    if n == stages.RELATIVE or n == stages.TWIST:
        rate = shaft_frequency(d, 1.0 / d.J3)
        if d.F_by_alpha1 == 0.0:
            speed = TWIST_SHARE * rate * abs(x.twist)  # nothing but loads moves the shaft
        if w.pair == THIRDS:
            speed = speed_of_swing(d, x, w, rate, speed, fastest)
        now = abs(x.relative if n == stages.RELATIVE else x.twist)
        return max(speed if n == stages.RELATIVE else speed / rate, now, change)
    if n == stages.WOUND_HOUSING:
        return max(moved * math.sqrt(d.J2 / max(d.housing_stiffness, 1e-300)), change)
    return max(moved * math.sqrt(d.J2 / max(d.freewheel_stiffness, 1e-300)), change)


def counts(d, x, w, n):
    """Tell whether the error of a followed quantity counts: whether it is one, and not that of another."""
    if n == stages.OMEGA1:
        return d.by_torque != 0.0
    if n == stages.OMEGA3:
        return x.output_state != LOCKED
    if n == stages.OF_DRIVE:
        return d.by_torque == 0.0 and (d.losses != 0.0 or w.prescribed != 0.0)
    if n == stages.WORK_IN:
        return d.losses != 0.0 or (d.by_torque == 0.0 and w.prescribed != 0.0)
    return d.losses != 0.0 or n == stages.Q or n == stages.OMEGA2 or n == stages.TWIST or n == stages.RELATIVE


def is_held_sum(n):
    """Return True if a quantity is one of HELD_SUMS."""
    for place in range(len(HELD_SUMS)):
        if n == HELD_SUMS[place]:
            return True
    return False


def stiff_error(w, n):
    """Error of a quantity in the stiff step in hand, but what goes with that of the shaft's swing."""
    errors, by_twist = w.stages[STIFF_ERROR], w.slopes[stages.TWIST_MOVES].numbers
    own = w.inside.numbers[n] if is_held_sum(n) else errors.numbers[n]
    if n == stages.RELATIVE or n == stages.TWIST or by_twist[stages.RELATIVE] == 0.0:
        return own
    return own - by_twist[n] / by_twist[stages.RELATIVE] * errors.relative


def momentum_passed(d):
    """Momentum that the imbalances pass to links 1 and 2 at most at the speed 1, kg m^2."""
    links = d.J2 * response(d, d.J2)
    if d.by_torque != 0.0:
        links += d.J1 * response(d, d.J1)
    return (d.F_by_alpha1 + 0.5 * d.F_by_speed) / d.k + links


def step_error(d, x, w, fastest):
    """Estimated error of the step in hand over the allowed one.

    Hairer's mix of orders 5 and 3, or the errors of order 4. Errors of the motion count in full, those of
    losses and of stiff steps with all others by their mean: there are many.
    """
    behind = fastest_behind(d, x, w)
    if not max(fastest, behind) < 1e300:
        return 1e300
    tolerance = max(w.tolerance * math.sqrt(min(d.lightest / CUSP, 1.0)), min(w.tolerance, ROUNDING))
    flies = x.housing_state == x.output_state == OPEN and x.omega3 > FLYING * fastest
    if (flies or d.housing == 0.0) and d.elastic != 0.0 and d.losses == 0.0 and w.pair != THIRDS:
        tolerance *= SWINGING
    sum5 = 0.0
    sum3 = 0.0
    count = 0
    moving = stages.how_many_move(d)
    moved = speed_behind(d, x, w, fastest)
    momentum = momentum_passed(d) * moved
    energy = 0.0
    if counts(d, x, w, stages.WORK_IN):
        energy = OF_ENERGY * (w.energy + 0.5 * d.J3 * x.omega3 * x.omega3)
        # (behind a shaft that a load twists links begin so gently that a loss is no scale of its own error)
        energy = max(energy, FROM_REST * (momentum * moved + d.J3 * behind * behind))
    at_rest = moved * w.step <= 2.0 * NO_TURN
    if at_rest or momentum == 0.0:
        momentum = max(momentum, d.J3 * behind)  # such links pass on what the shaft takes
    for number in range(moving + len(HELD_SUMS)):
        n = stages.MOTION[number] if number < moving else HELD_SUMS[number - moving]
        if not counts(d, x, w, n):
            continue
        if number < moving:
            scale = tolerance * scale_of(d, x, w, n, fastest)
        else:
            scale = energy if n >= stages.WORK_IN else momentum
            if n >= stages.LOST:
                scale *= OF_LOSSES
            scale = w.tolerance * max(scale, abs(w.change.numbers[n]))
        if scale > 0.0:
            count += 1
            found5 = 0.0
            if w.pair == THIRDS:
                found3 = stiff_error(w, n) / (STIFF_SHARE * w.step * scale)
            elif w.pair == SHORT:
                found3 = stages.weighed_rate(w, FOURTH, SHORT_END + 1, n, 1) / scale
            else:
                found3 = stages.weighed_rate(w, THIRD, END, n, LATE) / scale
                found5 = stages.weighed_rate(w, FIFTH, END, n, LATE) / scale
            sum3 += found3 * found3
            sum5 += found5 * found5
    if d.losses == 0.0 and w.pair != THIRDS:
        count = 1
    if w.pair != LONG:
        return w.step * math.sqrt(sum3 / max(count, 1)) if sum3 < 1e300 else 1e300
    mix = sum5 + 0.01 * sum3
    if mix == 0.0:
        return 0.0
    return w.step * sum5 / math.sqrt(count * mix) if mix < 1e300 else 1e300
