"""Method `timestepping`: fixed steps, complementarity of impulses and end velocities in each (Moreau).

No event is searched for, so every step costs the same. No step makes energy, however coarse: links 1 and 2
move by a discrete gradient, contacts close by inelastic impacts at the end of a step, an elastic shaft moves
by the midpoint rule (docs/mechanics.md).
"""

import math

from ..accumulate import add, wrap_drive_angle, wrap_input_angle
from ..codes import DRIVING, HELD, HELD_DRIVING
from ..contact import settle
from ..impulse import push_driven_mass
from ..inertia import reduced_inertia
from ..links import inertia_of_link1, inertia_of_link2, slip_inertia

# below this change of q, rad, the derivative of I is more exact than its difference
SMALLEST_DIFFERENCE = 1e-5
# what a torque of the shaft may change of the speed it acts on in a step that resolves it
RESOLVED = 4.0


def steps_in(d, h):
    """Number of equal steps no longer than max_step in a communication step h."""
    return max(1.0, math.ceil(h / d.max_step - 1e-9))


def look_ahead(d, x, w, slip_angle):
    """Take I, I', B, G where the step ends if link 1 turns by this angle relative to link 2."""
    w.slip_angle = slip_angle
    w.end_i, w.end_i1, _, w.end_b, _, w.end_g, _, _ = reduced_inertia(d, x.q + d.k * slip_angle)
    x.step_evaluations += 1.0


def load_hub(d, x, w, load, h):
    """Find the impulse on the hub, of the load or the shaft: hub_load + hub_gain u at its mean speed u.

    The mean relative speed behind it is relative_load + relative_gain u. Where the step does not resolve the
    shaft its torque is that of the twist at the end, and the relative speed is taken out there (w.stiff).
    """
    w.hub_load = load * h
    w.hub_gain = 0.0
    w.stiff = 0.0
    if d.elastic == 0.0:
        return
    damping = d.damping + 0.5 * d.stiffness * h
    if (d.damping + d.stiffness * h) * h * (1.0 / d.J3 + 1.0 / d.J4) > RESOLVED:
        w.stiff = 1.0
        damping += 0.5 * d.stiffness * h
    free = 2.0 * d.J4 * (1.0 - d.balancer)
    share = 1.0 / (2.0 * d.J4 + h * (d.friction + damping))
    spring = h * d.stiffness * x.twist
    w.relative_gain = share * (free + h * d.friction)
    w.relative_load = share * (2.0 * d.J4 * x.relative - free * x.omega3 + w.hub_load - spring)
    w.hub_load = spring + h * damping * w.relative_load
    w.hub_gain = h * damping * w.relative_gain


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


def drive_mass(d, x, w, h):
    """The driven mass over the step, behind a hub whose speed changes evenly (to w.seen3) about its mean."""
    w.mean_relative = w.relative_load + w.relative_gain * w.mean3
    w.seen3 = 2.0 * w.mean3 - x.omega3
    w.omega4 = w.seen3 - 2.0 * w.mean_relative + x.relative
    if d.friction * h > RESOLVED * d.J4:
        mean4 = abs(w.mean3 - w.mean_relative)
        w.omega4 = max(-mean4, min(mean4, w.omega4))


def follow(d, x, w, held, joined, given, h):
    """Follow all over the step with link 2 held or not, joined with the hub or not.

    Returns:
        As settle, impacts at the end of the step included.
    """
    if held:
        turn_link1(d, x, w, given, h)
    elif joined:
        move_links(d, x, w, d.J3, w.hub_load, w.hub_gain, given, h)
    else:
        move_links(d, x, w, 0.0, 0.0, 0.0, given, h)
    w.pushed = 0.0
    if joined:
        w.end3 = w.end2
        w.mean3 = 0.0 if held else (w.angle1 - w.new_slip_angle) / h
        w.pushed = w.hub_load if held else d.J3 * (w.end3 - x.omega3) + w.taken
    else:
        w.end3 = x.omega3 - (w.hub_load + w.hub_gain * x.omega3) / (d.J3 + 0.5 * w.hub_gain)
        w.mean3 = 0.5 * (x.omega3 + w.end3)
    inertia3 = d.J3
    if d.elastic != 0.0:
        drive_mass(d, x, w, h)
        if w.stiff != 0.0:
            inertia3 += (1.0 - d.balancer) * d.J4
            mass3 = w.omega4 + d.balancer * (w.end3 - w.seen3)
            w.end3 += d.J4 * (mass3 - w.end3) / inertia3
    inertia2 = inertia_of_link2(d, w.end_i, w.end_b, w.end_g)
    if w.pushed > 0.0 and d.output != 0.0:
        # it is the impulse over the whole step that must not pull
        back = 0.0 if held else w.pushed / inertia2
        settled = settle(d, inertia2, w.end2 + back, inertia3, w.end3 - w.pushed / inertia3)
        if settled[3] == DRIVING or settled[3] == HELD_DRIVING:
            return settled
    end2, end3, output, mode = settle(d, inertia2, w.end2, inertia3, w.end3)
    return end2, end3, output + w.pushed, mode


def follow_contacts(d, x, w, given, h):
    """The same; what touches at the beginning stays together where nothing pulls it apart."""
    always = d.output == 0.0
    touches = always or x.omega3 == x.omega2
    joined = always or (touches and x.step_mode == DRIVING)
    end2, end3, output, mode = follow(d, x, w, False, joined, given, h)
    if joined and not always and (mode != DRIVING or w.pushed <= 0.0):
        joined = False
        end2, end3, output, mode = follow(d, x, w, False, joined, given, h)
    held = d.housing != 0.0 and x.omega2 == 0.0 and (mode == HELD or mode == HELD_DRIVING)
    driving = touches and (always or mode == DRIVING or mode == HELD_DRIVING)
    if held or driving != joined:
        end2, end3, output, mode = follow(d, x, w, held, driving, given, h)
        if w.pushed < 0.0 and not always:
            driving = False
            end2, end3, output, mode = follow(d, x, w, held, driving, given, h)
    w.held = 1.0 if held else 0.0
    w.joined = 1.0 if driving else 0.0
    return end2, end3, output, mode


def turn_shaft(d, x, w, end3, load, h):
    """The hub to its end speed, with twist, driven mass and works of the shaft behind it."""
    mean4 = w.mean3
    if d.elastic != 0.0:
        mean4 -= w.mean_relative
        lost = h * (d.damping * w.mean_relative * w.mean_relative + d.friction * mean4 * mean4)
        lost -= d.balancer * d.J4 * (w.seen3 - x.omega3) * mean4
        x.energy_lost, x.energy_lost_low = add(x.energy_lost, x.energy_lost_low, lost)
        x.twist, x.twist_low = add(x.twist, x.twist_low, h * w.mean_relative)
        x.omega3 = w.seen3
        x.relative = w.seen3 - w.omega4
        x.relative_low = 0.0
        push_driven_mass(d, x, w.end3 - w.seen3, False)
        x.omega3 = w.end3
        if w.stiff != 0.0:
            x.relative = 0.0
            x.relative_low = 0.0
        push_driven_mass(d, x, end3 - w.end3, w.stiff != 0.0)
    x.energy_out, x.energy_out_low = add(x.energy_out, x.energy_out_low, load * h * mean4)
    x.omega3 = end3
    x.omega3_low = 0.0


def one_step(d, x, w, given, load, h):
    """One fixed step from where look_ahead or the step before has left w.

    Args:
        given: change of omega1, rad/s, or impulse of the input torque, N m s. load: N m.
    """
    w.begin_i, w.begin_i1, w.begin_b, w.begin_g = w.end_i, w.end_i1, w.end_b, w.end_g
    load_hub(d, x, w, load, h)
    w.new_slip_angle = h * (x.omega1 - x.omega2)
    look_ahead(d, x, w, w.new_slip_angle)
    follow_contacts(d, x, w, given, h)
    look_ahead(d, x, w, w.new_slip_angle)
    end2, end3, output, mode = follow(d, x, w, w.held != 0.0, w.joined != 0.0, given, h)
    if w.pushed < 0.0 and d.output != 0.0:
        end2, end3, output, mode = follow_contacts(d, x, w, given, h)
    if w.reached == 0.0:
        # the drive stays where it is: there the energy always suffices
        w.slip_angle = 0.0
        w.end_i, w.end_i1, w.end_b, w.end_g = w.begin_i, w.begin_i1, w.begin_b, w.begin_g
        end2, end3, output, mode = follow_contacts(d, x, w, given, h)
    # links 1 and 2 take the impact that brings link 2 to its end speed
    reaction = d.k * (w.end_b + d.k * w.end_g) * (end2 - w.end2)
    if d.by_torque != 0.0:
        w.end1 += reaction / inertia_of_link1(d, w.end_i, w.end_b, w.end_g)
        x.theta1, x.theta1_low = add(x.theta1, x.theta1_low, w.angle1)
        wrap_input_angle(x)
    else:
        x.input_impulse += w.impulse1 - reaction
        w.work1 -= w.end1 * reaction
    turn_shaft(d, x, w, end3, load, h)
    # on to just where the inertia at the end is that of: with another the energy would not be what it was
    x.q, x.q_low = add(x.q, x.q_low, d.k * w.slip_angle)
    wrap_drive_angle(d, x)
    x.energy_in, x.energy_in_low = add(x.energy_in, x.energy_in_low, w.work1)
    x.output_impulse += output
    x.output_square += output * output / h
    x.torque_peak = max(x.torque_peak, abs(output) / h)
    x.omega1 = w.end1
    x.omega1_low = 0.0
    x.omega2 = end2
    x.omega2_low = 0.0
    if mode != x.step_mode:
        x.step_mode = mode
        x.step_switches += 1.0
