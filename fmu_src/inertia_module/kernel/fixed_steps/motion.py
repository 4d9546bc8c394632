"""Links 1 and 2, the loads of the satellites and the hub over a fixed step (docs/mechanics.md, timestepping).

Links 1 and 2 by a discrete gradient, the speed or the torque of link 1 given: the energy changes by the works
to the last term. Works of the weights are the change of their potential; friction is one torque against the
slip of links 1 and 2, by the loads of the step itself. The hub, with drag and the elastic shaft, by the
midpoint rule.
"""

import math

from ..accumulate import copy
from ..equations.losses import MESH, SHAFT, VISCOUS
from ..equations.motion import potential_energy
from ..equations.satellites import RESOLVE_SIGNS, gravity_potential, satellite_friction
from ..impulse import jump_driven_mass
from ..layout import imbalance_position
from ..links import (
    friction_power,
    inertia_of_link1,
    inertia_of_link2,
    kinetic_energy,
    momentum_of_links,
    slip_inertia,
)

# below this change of q, rad, the difference of I is rounding, and its derivative gives it as exactly
SMALLEST_DIFFERENCE = 1e-8
# share of the kinetic energy that the speeds give back
UNFALLEN = 0.5
# share of a change of friction that it does not cause itself, at least: meshes that jam are refused
NOT_ITS_OWN = 0.1
# what a torque of the shaft may change of the speed it acts on in a step that resolves it
RESOLVED = 4.0


def move_links(d, x, w, held, carried, load, gain, prescribed, h):
    """Links 1 and 2 over the step, link 2 held or against the impulse load + gain u, u its mean speed.

    Writes w.end1, end2, new_slip_angle, of w.change the angle of link 1, impulse and work of the input torque
    and what friction takes (that by loads as lost in the mesh), slip_stopped (whether w.friction has stopped
    the slip) and reached: whether the energy suffices to come to where the step is to end. Besides the load
    w.friction, N m, resists the slip, and weights w.weight1 and w.weight_slip, N m, the angles of link 1 and
    of the slip. With w.straight the energy is not looked at: the way would be too short.

    Args:
        carried: inertia that link 2 carries, kg m^2.
        prescribed: change of omega1, rad/s, or impulse of the input torque, N m s.
    """
    change = w.change
    w.slip_stopped = 0.0
    if held and d.by_torque == 0.0:
        turn_link1(d, x, w, prescribed, h)
        return
    slip = x.omega1 - x.omega2
    total, coupling, inertia = slip_inertia(d, x.here.i, x.here.b, x.here.g, carried)
    end_total, end_coupling, end_inertia = slip_inertia(d, w.end.i, w.end.b, w.end.g, carried)
    if held:
        # the slip is all the motion there is
        coupling = end_coupling = 1.0
        inertia = inertia_of_link1(d, x.here.i, x.here.b, x.here.g)
        end_inertia = inertia_of_link1(d, w.end.i, w.end.b, w.end.g)
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
    growth = d.k * d.k * (w.end.g - x.here.g)
    driven = prescribed - by_torque * h * w.weight1
    if by_torque != 0.0:
        y = momentum_of_links(d, x.here.i, x.here.b, x.omega1, x.omega2, carried) if not held else 0.0
        share -= mean_coupling
        end_rate = 0.0 if held else 0.5 / end_total
        speed = 0.5 * y / total + (y + driven) * end_rate
        force = y / total * end_rate
        growth = end_inertia - inertia
    slope = 0.5 * d.k * (x.here.i1 + w.end.i1)
    if abs(d.k * w.slip_angle) > SMALLEST_DIFFERENCE:
        slope = (w.end.i - x.here.i) / w.slip_angle
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
        at_stop = slip * (growth * per_root - end_root)
        stop = (free - at_stop) / by_friction
        turn = (twice + free) / by_friction
        if (stop > 0.0) == (turn > 0.0):
            friction = math.copysign(min(h * w.friction, abs(stop), abs(turn)), stop)
    way = w.slip_angle / (h * per_root)
    rise = free
    for n in range(2):
        resisted = friction if n == 0 else 0.0
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
    # speeds by their changes: else omega2 would take over the rounding of omega1
    change_slip = (rise - growth * per_root * slip) * per_end
    change2 = prescribed - change_slip
    w.new_slip_angle = h * turned
    change.lost[MESH] = friction * turned
    mean1 += answer1 * turned
    mean2 = mean1 - turned
    change.lost[VISCOUS] = h * friction_power(d, mean1, mean2, d.b2)
    resisted = load + gain * mean2 + h * (d.b1 * mean1 + d.b2 * mean2)
    if by_torque != 0.0:
        # P at the end if omega2 stayed as it is
        unmoved = momentum_of_links(d, w.end.i, w.end.b, x.omega1 + change_slip, x.omega2, carried)
        change2 = 2.0 * end_rate * (y + driven - resisted - unmoved)
        change.theta1 = h * mean1
    else:
        change.theta1 = h * speed
        kept = mean_coupling * change_slip - d.k * (w.end.b - x.here.b) * (slip + 0.5 * change_slip)
        change.drive = 0.5 * (total + end_total) * prescribed + (w.end.i - x.here.i) * speed - kept + resisted
        change.drive += h * w.weight1
        missing = mean_coupling * turned - 0.5 * (coupling * slip + end_coupling * (slip + change_slip))
        change.work_in = speed * change.drive + prescribed * missing
    w.end1 = x.omega1 + (change2 + change_slip)
    w.end2 = x.omega2 + change2
    if held:
        w.end2 = 0.0
    if w.slip_stopped != 0.0:
        w.end2 = w.end1
    w.weighing = w.weight1 * change.theta1 + w.weight_slip * w.slip_angle


def turn_link1(d, x, w, prescribed, h):
    """Step with link 2 held and the speed given: link 1 turns the inertia Phi."""
    change = w.change
    inertia = inertia_of_link1(d, x.here.i, x.here.b, x.here.g)
    end_inertia = inertia_of_link1(d, w.end.i, w.end.b, w.end.g)
    w.reached = 1.0
    w.end2 = 0.0
    w.end1 = x.omega1 + prescribed
    mean1 = x.omega1 + 0.5 * prescribed
    change.theta1 = w.new_slip_angle = w.foreseen = h * mean1
    friction = h * (d.b1 + d.k * d.k * d.bq)
    against = h * (w.weight1 + w.weight_slip)
    against += math.copysign(h * w.friction, mean1) if mean1 != 0.0 else 0.0
    change.drive = 0.5 * (
        end_inertia * w.end1 - inertia * x.omega1 + 0.5 * (inertia + end_inertia) * prescribed
    )
    change.drive += friction * mean1 + against
    change.work_in = 0.5 * (end_inertia * w.end1 * w.end1 - inertia * x.omega1 * x.omega1)
    change.work_in += (friction * mean1 + against) * mean1 + w.weight_slip * (w.slip_angle - change.theta1)
    change.lost[VISCOUS] = friction * mean1 * mean1
    change.lost[MESH] = h * w.friction * abs(mean1)
    w.weighing = (w.weight1 + w.weight_slip) * change.theta1


def mesh_impulse(d, x, w, h):
    """Impulse that the mesh passes to link 2 in the step that w has found: what link 1 does not keep."""
    put_in = x.drive_torque * h if d.by_torque != 0.0 else w.change.drive
    before = (d.J1 + x.here.i) * x.omega1 + d.k * x.here.b * (x.omega1 - x.omega2)
    after = (d.J1 + w.end.i) * w.end1 + d.k * w.end.b * (w.end1 - w.end2)
    return put_in - (after - before) - d.b1 * w.change.theta1 - h * w.weight1


def find_friction(d, x, w, h):
    """Take from the step that w has found what its loads resist its slip with, w.friction, N m.

    All is linear in it but for signs, so the step before and this one tell where it is its own cause.
    """
    k = d.k
    journals = spun = 0.0
    if d.journal_friction + d.satellite_loss > 0.0:
        alpha1 = (w.end1 - x.omega1) / h
        rate2_q = k * ((w.end1 - w.end2) - (x.omega1 - x.omega2)) / h
        q = x.q + 0.5 * k * w.new_slip_angle
        mean1 = x.omega1 + 0.5 * h * alpha1
        journals, spun, by_alpha1, by_rate2 = satellite_friction(
            d,
            q,
            imbalance_position(d, q, 0.0),
            mean1,
            k * w.new_slip_angle / h,
            alpha1,
            rate2_q,
            RESOLVE_SIGNS,
        )
        spun = k * (journals + spun + by_alpha1 * alpha1 + by_rate2 * rate2_q)
    mesh = mesh_impulse(d, x, w, h) / h
    change = w.friction - w.friction_before
    by_spun = by_mesh = more = 0.0
    if change != 0.0 and w.slip_stopped == 0.0:
        by_spun = (spun - w.spun) / change
        by_mesh = (mesh - w.mesh) / change
    for n in range(2):
        sign = 1.0 if n == 0 else -1.0
        share = max(1.0 - by_spun - sign * d.mesh_loss * by_mesh, NOT_ITS_OWN)
        more = (spun + sign * d.mesh_loss * mesh - w.friction) / share
        if sign * (mesh + by_mesh * more) >= 0.0:
            break
    w.spun = spun
    w.mesh = mesh
    w.friction_before = w.friction
    w.friction = max(0.0, w.friction + more)
    w.journal_share = min(1.0, k * journals / w.friction) if w.friction > 0.0 else 0.0


def weigh(d, x, w):
    """Differences of the potential of the imbalances on the way ahead, by the angles of link 1 and the slip.

    Both are means over the way of the other, so that together they are its change to the last term.
    """
    half = 0.5 * w.far_angle1
    theta1 = x.theta1 + half
    here, by_theta1, by_q = gravity_potential(d, imbalance_position(d, x.q, 0.0), theta1)
    angle = d.k * w.far_angle
    there, far_by_theta1, _ = gravity_potential(d, imbalance_position(d, x.q + angle, 0.0), theta1)
    w.weight1 = 0.5 * (by_theta1 + far_by_theta1)
    if half != 0.0:
        w.weight1 *= math.sin(half) / half
    w.weight_slip = d.k * by_q
    if abs(angle) > SMALLEST_DIFFERENCE:
        w.weight_slip = (there - here) / w.far_angle * math.cos(half)


def end_fall(d, x, w):
    """Take from the speeds what the weights have worked more than they have fallen.

    That happens only with the torque of link 1 given, for its angle is not known beforehand. Where that is
    much of what moves the step ends where it began, at rest.
    """
    gained = potential_energy(d, x) - potential_energy(d, w.fallen) - w.weighed
    if gained <= 0.0:
        return
    omega4 = x.omega3 - x.relative
    moving = kinetic_energy(d, x.q, x.omega1, x.omega2, x.omega3) + 0.5 * d.elastic * d.J4 * omega4 * omega4
    slower = 0.0
    if gained < UNFALLEN * moving:
        slower = math.sqrt(1.0 - gained / moving)
    else:
        copy(x.numbers, w.fallen.numbers)
    x.omega1 *= slower
    x.omega2 *= slower
    x.omega3 *= slower
    x.relative *= slower


def load_hub(d, x, w, joined, h):
    """Impulse of load, friction or shaft on the hub: load + gain u, u its mean speed, rad/s.

    Behind it an elastic shaft slips by w.relative_load + w.relative_gain u. Where the step does not resolve
    the shaft its torque is that of the twist at the end. A light hub that turns freely then ends at its mean
    speed, but where not even link 2 with the hub is heavy enough it meets the driven mass (w.stiff).

    Returns:
        (load, gain, share of the step's change of speed that u has, 1/2 or 1).
    """
    load = w.load * h
    gain = d.b3 * h
    w.stiff = 0.0
    # one that friction stops within the step does not turn back
    theta = 0.5 if gain < 2.0 * d.J3 else 1.0
    if d.elastic == 0.0:
        return load, gain, theta
    damping = d.shaft_damping + d.shaft_stiffness * h
    pull = damping * h
    together = d.J3 + inertia_of_link2(d, x.here.i, x.here.b, x.here.g)
    if pull * (together + d.J4) > RESOLVED * together * d.J4:
        w.stiff = 1.0
    elif not joined and pull * (d.J3 + d.J4) > RESOLVED * d.J3 * d.J4:
        theta = 1.0
    else:
        damping -= 0.5 * d.shaft_stiffness * h
    free = 2.0 * d.J4 * (1.0 - d.balancer)
    share = 1.0 / (2.0 * d.J4 + h * (d.driven_friction + damping))
    spring = h * d.shaft_stiffness * x.twist
    w.relative_gain = share * (free + h * d.driven_friction)
    w.relative_load = share * (2.0 * d.J4 * x.relative - free * x.omega3 + load - spring)
    return spring + h * damping * w.relative_load, gain + h * damping * w.relative_gain, theta


def drag_on_link2(d, x, held, acting):
    """Impulse of the housing freewheel's drag on link 2: (load, gain) as above; acting: for this time, s."""
    if held or (x.play_housing > 0.0 and x.omega2 < 0.0):
        return 0.0, 0.0
    return acting * d.housing_drag, acting * d.housing_drag_viscous


def drag_on_hub(d, x, joined, hub, acting):
    """Impulse of the output freewheel's drag on the hub: load - gain u, u of link 2; hub: as of load_hub."""
    if joined or (x.play_output > 0.0 and x.omega3 < x.omega2):
        return 0.0, 0.0
    load, gain, theta = hub
    drag = acting * d.output_drag
    viscous = acting * d.output_drag_viscous
    braking = load + gain * x.omega3 + drag + viscous * (x.omega3 - x.omega2)
    mean3 = x.omega3 - theta * braking / (d.J3 + theta * gain)
    return drag + viscous * mean3, viscous


def drive_mass(d, x, w, h):
    """The driven mass over the step, behind a hub whose speed changes evenly (to w.seen3) about its mean."""
    w.mean_relative = w.relative_load + w.relative_gain * w.mean3
    w.seen3 = 2.0 * w.mean3 - x.omega3
    w.omega4 = w.seen3 - 2.0 * w.mean_relative + x.relative
    if d.driven_friction * h > RESOLVED * d.J4:
        mean4 = abs(w.mean3 - w.mean_relative)
        w.omega4 = max(-mean4, min(mean4, w.omega4))


def turn_shaft(d, x, w, h):
    """Write what the step changes behind link 2: twist, angle of the output, works of friction and shaft."""
    change = w.change
    mean4 = w.mean3
    change.lost[VISCOUS] += h * d.b3 * w.mean3 * w.mean3
    if d.elastic != 0.0:
        mean4 -= w.mean_relative
        lost = h * (d.shaft_damping * w.mean_relative * w.mean_relative + d.driven_friction * mean4 * mean4)
        lost -= d.balancer * d.J4 * (w.seen3 - x.omega3) * mean4
        change.lost[SHAFT] = lost
        change.twist = h * w.mean_relative
    change.turned3 = h * mean4


def end_hub(d, x, w, end3):
    """Set hub and driven mass to the speeds that the step ends with, end3 after the impacts at its end."""
    if d.elastic != 0.0:
        x.omega3 = w.seen3
        x.relative = w.seen3 - w.omega4
        x.relative_low = 0.0
        jump_driven_mass(d, x, w.end3 - w.seen3, False)
        x.omega3 = w.end3
        if w.stiff != 0.0:
            x.relative = 0.0
            x.relative_low = 0.0
        jump_driven_mass(d, x, end3 - w.end3, w.stiff != 0.0)
    x.omega3 = end3
