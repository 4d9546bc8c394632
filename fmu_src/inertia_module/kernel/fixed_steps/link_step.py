"""Links 1 and 2 over a fixed step by a discrete gradient: the energy changes by the works to the last term.

The speed or the torque of link 1 is given; derivation in docs/mechanics.md, method timestepping.
"""

import math

from ..links import friction_power, inertia_of_link1, slip_inertia

# below this change of q, rad, the difference of I is rounding, and its derivative gives it as exactly
SMALLEST_DIFFERENCE = 1e-8


def move_links(d, x, w, held, carried, load, gain, prescribed, h):
    """Links 1 and 2 over the step, link 2 held or against the impulse load + gain u, u its mean speed.

    Writes w.end1, end2, new_slip_angle, angle1 (of link 1), impulse1 and work1 (of the input torque),
    load_impulse, friction_work (the work of the links' viscous friction), lost_by_load, slip_stopped (whether
    w.friction has stopped the slip) and reached: whether the energy suffices to come to where the step is to
    end. Besides the load w.friction, N m, resists the slip, and weights w.weight1 and w.weight_slip, N m, the
    angles of link 1 and of the slip. With w.straight the energy is not looked at: the way would be too short.

    Args:
        carried: inertia that link 2 carries, kg m^2.
        prescribed: change of omega1, rad/s, or impulse of the input torque, N m s.
    """
    w.slip_stopped = 0.0
    if held and d.by_torque == 0.0:
        turn_link1(d, x, w, prescribed, h)
        return
    slip = x.omega1 - x.omega2
    total, coupling, inertia = slip_inertia(d, x.i, x.b, x.g, carried)
    end_total, end_coupling, end_inertia = slip_inertia(d, w.end_i, w.end_b, w.end_g, carried)
    if held:
        # the slip is all the motion there is
        coupling = end_coupling = 1.0
        inertia = inertia_of_link1(d, x.i, x.b, x.g)
        end_inertia = inertia_of_link1(d, w.end_i, w.end_b, w.end_g)
    root = math.sqrt(inertia)
    end_root = math.sqrt(end_inertia)
    per_root = 1.0 / (root + end_root)
    per_end = 1.0 / end_root
    mean_coupling = 0.5 * (coupling + end_coupling)
    by_torque = d.by_torque
    # y = omega1, or the angular momentum P: it changes by what is given (P by the load, too)
    y = x.omega1
    share = 1.0
    end_rate = 0.0
    speed = y + 0.5 * prescribed
    force = 0.5 * y
    change = d.k * d.k * (w.end_g - x.g)
    driven = prescribed - by_torque * h * w.weight1
    if by_torque != 0.0:
        y = total * (x.omega1 - coupling * slip)
        share -= mean_coupling
        end_rate = 0.0 if held else 0.5 / end_total
        speed = 0.5 * (x.omega1 - coupling * slip) + (y + driven) * end_rate
        force = (x.omega1 - coupling * slip) * end_rate
        change = end_inertia - inertia
    slope = 0.5 * d.k * (x.i1 + w.end_i1)
    if abs(d.k * w.slip_angle) > SMALLEST_DIFFERENCE:
        slope = (w.end_i - x.i) / w.slip_angle
    force *= slope
    # what resists goes by the mean speeds: of link 1 mean1 + answer1 rho, of link 2 less by the mean slip rho
    resisting = gain + h * d.b2
    give = 1.0 / (1.0 + (resisting + h * d.b1) * end_rate)
    mean1 = (speed - load * end_rate) * give
    answer1 = by_torque * (mean_coupling + resisting * end_rate) * give
    resist2 = load + resisting * mean1
    resist1 = h * d.b1 * mean1
    less2 = resisting * (1.0 - answer1)
    more1 = h * d.b1 * answer1
    # sigma = sum of s = sqrt(mu) rho at both ends
    surplus = share * less2 + by_torque * mean_coupling * more1 + h * d.k * d.k * d.bq
    surplus *= 2.0 * per_root * per_root
    weight = 1.0 + surplus
    per_weight = 1.0 / weight
    end_y = y + driven - by_torque * (resist2 + resist1)
    push = 2.0 * h * per_root * force * end_y - 2.0 * h * per_root * w.weight_slip
    pull = driven * mean_coupling + share * resist2 - by_torque * mean_coupling * resist1
    pull = (pull + by_torque * force * w.slip_angle * (less2 - more1)) * per_root
    twice = 2.0 * root * slip
    free = (2.0 * pull - surplus * twice + push) * per_weight
    # friction takes no more than what stops the slip, at the end or in the mean, and never turns it back
    by_friction = 2.0 * per_root * per_weight
    at_stop = friction = 0.0
    stop = 1e300
    if w.friction > 0.0:
        at_stop = slip * (change * per_root - end_root)
        stop = (free - at_stop) / by_friction
        turn = (twice + free) / by_friction
        if (stop > 0.0) == (turn > 0.0):
            friction = math.copysign(min(h * w.friction, abs(stop), abs(turn)), stop)
    way = w.slip_angle / (h * per_root)
    rise = free
    for resisted in (friction, 0.0):
        rise = at_stop if resisted == stop else free - by_friction * resisted
        w.foreseen = h * (twice + rise) * per_root
        # the energy at the end allows weight sigma no more than reach to either side of the centre
        pulled = pull - resisted * per_root
        centre = 0.5 * twice + pulled
        square = centre * centre + weight * push * way
        w.reached = 1.0 if square >= 0.0 else 0.0
        if square >= 0.0 and push * (twice + rise - way) > 0.0 and w.straight == 0.0:
            reach = math.copysign(math.sqrt(square), weight * (twice + rise) - centre)
            # reach - centre, without its cancellation
            more = weight * push * way / (reach + centre) if reach * centre > 0.0 else reach - centre
            rise = (2.0 * pulled - surplus * twice + more) * per_weight
        friction = resisted
        if resisted * (twice + rise) >= 0.0:
            break
    if friction != 0.0 and rise == at_stop:
        w.slip_stopped = 1.0
    turned = (twice + rise) * per_root
    # rho by its change: else omega2 would take over the rounding of omega1
    change_slip = (rise - change * per_root * slip) * per_end
    end_slip = slip + change_slip
    w.new_slip_angle = h * turned
    w.lost_by_load = friction * turned
    mean1 += answer1 * turned
    mean2 = mean1 - turned
    w.load_impulse = load + gain * mean2
    w.friction_work = h * friction_power(d, mean1, mean2, d.b2)
    resisted = w.load_impulse + h * (d.b1 * mean1 + d.b2 * mean2)
    if by_torque != 0.0:
        end_y = y + driven - resisted
        w.end1 = 2.0 * end_rate * end_y + end_coupling * end_slip
        w.angle1 = h * mean1
        w.work1 = prescribed / h * w.angle1
    else:
        w.end1 = end_y
        w.angle1 = h * speed
        kept = mean_coupling * change_slip - d.k * (w.end_b - x.b) * (slip + 0.5 * change_slip)
        w.impulse1 = 0.5 * (total + end_total) * prescribed + (w.end_i - x.i) * speed - kept + resisted
        w.impulse1 += h * w.weight1
        missing = mean_coupling * turned - 0.5 * (coupling * slip + end_coupling * end_slip)
        w.work1 = speed * w.impulse1 + prescribed * missing
    w.end2 = x.omega2 + ((w.end1 - x.omega1) - change_slip)
    if held:
        w.end2 = 0.0
    if w.slip_stopped != 0.0:
        w.end2 = w.end1
    w.weighing = w.weight1 * w.angle1 + w.weight_slip * w.slip_angle


def turn_link1(d, x, w, prescribed, h):
    """Step with link 2 held and the speed given: link 1 turns the inertia Phi."""
    inertia = inertia_of_link1(d, x.i, x.b, x.g)
    end_inertia = inertia_of_link1(d, w.end_i, w.end_b, w.end_g)
    w.reached = 1.0
    w.end2 = 0.0
    w.end1 = x.omega1 + prescribed
    mean1 = x.omega1 + 0.5 * prescribed
    w.angle1 = w.new_slip_angle = w.foreseen = h * mean1
    friction = h * (d.b1 + d.k * d.k * d.bq)
    against = h * (w.weight1 + w.weight_slip)
    against += math.copysign(h * w.friction, mean1) if mean1 != 0.0 else 0.0
    w.impulse1 = 0.5 * (
        end_inertia * w.end1 - inertia * x.omega1 + 0.5 * (inertia + end_inertia) * prescribed
    )
    w.impulse1 += friction * mean1 + against
    w.work1 = 0.5 * (end_inertia * w.end1 * w.end1 - inertia * x.omega1 * x.omega1)
    w.work1 += (friction * mean1 + against) * mean1 + w.weight_slip * (w.slip_angle - w.angle1)
    w.friction_work = friction * mean1 * mean1
    w.lost_by_load = h * w.friction * abs(mean1)
    w.weighing = (w.weight1 + w.weight_slip) * w.angle1
