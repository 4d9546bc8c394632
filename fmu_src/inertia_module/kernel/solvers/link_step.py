"""Links 1 and 2 over a fixed step by a discrete gradient: the energy changes by the works to the last term.

The speed or the torque of link 1 is given; derivation in docs/mechanics.md, method timestepping.
"""

import math

from ..links import inertia_of_link1, slip_inertia

# below this change of q, rad, the derivative of I is more exact than its difference
SMALLEST_DIFFERENCE = 1e-5


def move_links(d, x, w, carried, load, gain, given, h):
    """Links 1 and 2 over the step, link 2 against the impulse load + gain u, u its mean speed.

    Writes w.end1, end2, new_slip_angle, angle1 (of link 1), impulse1 and work1 (of the input torque), taken
    (the impulse of the load) and reached: whether the energy suffices to come to where the step is to end.

    Args:
        carried: inertia that link 2 carries, kg m^2.
        given: change of omega1, rad/s, or impulse of the input torque, N m s.
    """
    slip = x.omega1 - x.omega2
    total, coupling, inertia = slip_inertia(d, w.begin_i, w.begin_b, w.begin_g, carried)
    end_total, end_coupling, end_inertia = slip_inertia(d, w.end_i, w.end_b, w.end_g, carried)
    root = math.sqrt(inertia)
    end_root = math.sqrt(end_inertia)
    per_root = 1.0 / (root + end_root)
    mean_coupling = 0.5 * (coupling + end_coupling)
    by_torque = d.by_torque
    # y = omega1, or the angular momentum P: it changes by what is given (P by the load, too)
    y = x.omega1
    share = 1.0
    end_rate = 0.0
    speed = y + 0.5 * given
    force = 0.5 * y
    if by_torque != 0.0:
        y = total * (x.omega1 - coupling * slip)
        share -= mean_coupling
        end_rate = 0.5 / end_total
        speed = 0.5 * (x.omega1 - coupling * slip) + (y + given) * end_rate
        force = (x.omega1 - coupling * slip) * end_rate
    # sigma = sum of sqrt(mu) rho at both ends; the impulse of the load is load - answer sigma
    give = 1.0 / (1.0 + gain * end_rate)
    load = (load + gain * speed) * give
    answer = gain * give * share * per_root
    weight = 1.0 + 2.0 * answer * share * per_root
    half = root * slip + (given * mean_coupling + share * load) * per_root
    end_y = y + given - by_torque * load
    change = w.end_i - w.begin_i
    push = d.k * h * (w.begin_i1 + w.end_i1) * per_root
    if abs(d.k * w.slip_angle) > SMALLEST_DIFFERENCE:
        push = 2.0 * h * change / w.slip_angle * per_root
    sigma = 2.0 * half + push * force * end_y
    if answer != 0.0:
        sigma += push * force * by_torque * answer * w.slip_angle / (h * per_root)
    w.foreseen = h * sigma / weight * per_root
    # the energy allows weight sigma no more than reach to either side of the centre
    centre = half + by_torque * force * change * answer
    square = centre * centre + 2.0 * weight * force * change * end_y
    w.reached = 1.0 if square >= 0.0 else 0.0
    if square >= 0.0:
        reach = math.sqrt(square)
        sigma = centre + max(-reach, min(reach, sigma - centre))
    sigma /= weight
    end_slip = (sigma - root * slip) / end_root
    turned = sigma * per_root
    w.new_slip_angle = h * turned
    w.taken = load - answer * sigma
    if by_torque != 0.0:
        end_y = y + given - w.taken
        w.end1 = 2.0 * end_rate * end_y + end_coupling * end_slip
        w.angle1 = h * (speed - w.taken * end_rate + mean_coupling * turned)
        w.work1 = given / h * w.angle1
    else:
        w.end1 = end_y
        w.angle1 = h * speed
        before = coupling * slip
        after = end_coupling * end_slip
        w.impulse1 = (end_total * end_y - after) - (total * y - before) + w.taken
        w.work1 = speed * w.impulse1 + given * (mean_coupling * turned - 0.5 * (before + after))
    w.end2 = w.end1 - end_slip


def turn_link1(d, x, w, given, h):
    """The same with link 2 held: link 1 turns the inertia Phi."""
    inertia = inertia_of_link1(d, w.begin_i, w.begin_b, w.begin_g)
    end_inertia = inertia_of_link1(d, w.end_i, w.end_b, w.end_g)
    w.reached = 1.0
    w.end2 = 0.0
    if d.by_torque != 0.0:
        start = math.sqrt(inertia) * x.omega1
        end_root = math.sqrt(end_inertia)
        twice = math.sqrt(inertia) + end_root
        end = start + 2.0 * given / twice
        w.end1 = end / end_root
        w.angle1 = h * (start + end) / twice
        w.work1 = given / h * w.angle1
    else:
        w.end1 = x.omega1 + given
        w.angle1 = h * (x.omega1 + 0.5 * given)
        w.impulse1 = 0.5 * (end_inertia * w.end1 - inertia * x.omega1 + 0.5 * (inertia + end_inertia) * given)
        w.work1 = 0.5 * (end_inertia * w.end1 * w.end1 - inertia * x.omega1 * x.omega1)
    w.new_slip_angle = w.angle1
    w.foreseen = w.angle1
