"""Method `timestepping`: fixed steps, complementarity of impulses and end velocities in each (Moreau).

No event is searched for, so no step takes more than two evaluations (with losses five). No step makes
energy, however coarse: links 1 and 2 move by a discrete gradient, freewheels close by inelastic impacts, an
elastic shaft moves by the midpoint rule (docs/mechanics.md).
"""

import math

from ..accumulate import clear, copy
from ..codes import OK, TOO_MUCH_WORK
from ..equations.choice import select_mode
from ..equations.losses import FREEWHEEL, JOURNAL, MESH
from ..equations.states import OVERRUNNING, count_switch, has_friction, is_housing_engaged, is_output_engaged
from ..events.advance import commit
from ..impulse import shaft_inertia, solve_impact
from ..inertia import reduced_inertia
from ..links import inertia_of_link1, inertia_of_link2
from ..loads import sample_load
from . import motion

# fixed steps that one communication step may take
MAX_STEPS = 1e7
# shortest part of a step: what closes before it closes at its end
SHORTEST = 1e-6
# how much later than foreseen a step is parted: what has not met there meets at its end
LATER = 1.001
# how often the loads of the satellites are taken from the step found with those before
LOADED = 3
# share of the speeds by which a slip misses zero that friction has stopped
STOPPED = 1e-14


def look_ahead(d, x, w, slip_angle):
    """End the step where link 1 has turned by this angle relative to link 2: I, I', B, G there."""
    w.far_angle = slip_angle
    write_inertia(d, x.q + d.k * slip_angle, w.far)
    x.step_evaluations += 1.0
    if d.weight != 0.0:
        motion.weigh(d, x, w)
    end_at(x, w, 1.0)


def write_inertia(d, q, at):
    """Write I, I', B, G at the drive angle q into a record (fields.INERTIA)."""
    at.i, at.i1, at.b, _, at.g, _ = reduced_inertia(d, q)


def end_at(x, w, part):
    """End this part of the way ahead, with the inertia between; 1 is where look_ahead looked."""
    for n in range(len(w.end.numbers)):
        w.end.numbers[n] = x.here.numbers[n] + part * (w.far.numbers[n] - x.here.numbers[n])
    w.slip_angle = part * w.far_angle


def closes(engagement_angle, play):
    """Tell whether a freewheel may carry with this play at the end of a step, rad."""
    return engagement_angle == 0.0 or play <= 0.0


def follow(d, x, w, held, joined, prescribed, h):
    """Follow all over the step with link 2 held or not, joined with the hub or not.

    Writes what it comes to with the impacts at its end: w.settled2, settled3, output, mode, as settle.
    Returns the impulse that holds link 2 and hub together, N m s.
    """
    acting = h * w.dragging
    hub = motion.load_hub(d, x, w, joined, h)
    hub_load, hub_gain, theta = hub
    drag_load, drag_gain = motion.drag_on_link2(d, x, held, acting)
    over_load, over_gain = motion.drag_on_hub(d, x, joined, hub, acting)
    carried = holding = 0.0
    load = drag_load - over_load
    gain = drag_gain + over_gain
    if joined:
        carried = d.J3
        holding = acting * d.output_drag
        load += hub_load
        gain += hub_gain
    motion.move_links(d, x, w, held, carried, load, gain, prescribed, h)
    mean2 = 0.0 if held else (w.change.theta1 - w.new_slip_angle) / h
    drag = drag_load + drag_gain * mean2
    overrun = over_load - over_gain * mean2
    if joined:
        w.end3 = w.end2
        w.mean3 = mean2
        contact = hub_load if held else d.J3 * (w.end3 - x.omega3) + hub_load + hub_gain * mean2
    else:
        contact = -overrun
        braking = hub_load + hub_gain * x.omega3 + overrun
        w.end3 = x.omega3 - braking / (d.J3 + theta * hub_gain)
        w.mean3 = x.omega3 + theta * (w.end3 - x.omega3)
    # a freewheel with play left takes an impulse where that is used up in the step
    stops = d.housing != 0.0 and closes(d.housing_engagement_angle, x.play_housing + h * mean2)
    meets = closes(d.output_engagement_angle, x.play_output + h * (w.mean3 - mean2))
    drag *= mean2
    overrun *= w.mean3 - mean2
    w.change.lost[FREEWHEEL] = drag + overrun
    w.reversed = 1.0 if drag < 0.0 or overrun < 0.0 else 0.0
    inertia3 = shaft_inertia(d, w.stiff != 0.0)
    if d.elastic != 0.0:
        motion.drive_mass(d, x, w, h)
        if w.stiff != 0.0:
            mass3 = w.omega4 + d.balancer * (w.end3 - w.seen3)
            w.end3 += d.J4 * (mass3 - w.end3) / inertia3
    inertia2 = inertia_of_link2(d, w.end.i, w.end.b, w.end.g)
    push = contact + holding
    # it is the impulse over the whole step that must not pull, but for the drag
    rested = max(push - motion.mesh_impulse(d, x, w, h), 0.0) if held else 0.0
    w.settled2, w.settled3, output, w.mode = solve_impact(
        d, inertia2, w.end2, inertia3, w.end3, stops, meets, max(push, 0.0), rested
    )
    w.change.output = output + contact
    return push


def follow_closed(d, x, w, prescribed, h):
    """A step in which a closed freewheel stays closed unless the contact force is negative."""
    always = d.output == 0.0
    joined = always or (x.omega3 == x.omega2 and x.play_output == 0.0)
    push = follow(d, x, w, False, joined, prescribed, h)
    if joined and not always and push <= 0.0:
        follow(d, x, w, False, False, prescribed, h)
    stays = x.omega2 == 0.0 and x.play_housing == 0.0
    if d.housing != 0.0 and stays and is_housing_engaged(w.mode):
        joined = always or (x.omega3 == 0.0 and x.play_output == 0.0)
        push = follow(d, x, w, True, joined, prescribed, h)
        if joined and not always and push < 0.0:
            follow(d, x, w, True, False, prescribed, h)


def follow_contacts(d, x, w, prescribed, h):
    """A step with contacts as above; without drag in a step that would turn back against it."""
    follow_closed(d, x, w, prescribed, h)
    if w.reversed != 0.0:
        w.dragging = 0.0
        follow_closed(d, x, w, prescribed, h)
        w.dragging = d.losses


def passes(d):
    """How often a step is followed to know its loads."""
    return LOADED if has_friction(d) or d.weight != 0.0 else 0


def follow_loaded(d, x, w, prescribed, h, foresee):
    """A step with contacts as above, its friction and its weights those of the step found before.

    Args:
        foresee: whether it ends where that one came to.
    """
    w.straight = 1.0
    w.friction_before = w.friction
    for _ in range(passes(d)):
        follow_contacts(d, x, w, prescribed, h)
        motion.find_friction(d, x, w, h)
        if foresee:
            w.far_angle1 = w.change.theta1
            look_ahead(d, x, w, w.foreseen)
    w.straight = 0.0
    follow_contacts(d, x, w, prescribed, h)


def share_until_closed(d, x, w):
    """Share of the step after which a freewheel without play closes (1: none), and if it is the housing's."""
    meets = d.output_engagement_angle == 0.0 and is_output_engaged(w.mode)
    if meets and x.omega3 > x.omega2 and w.end2 > w.end3:
        return (x.omega3 - x.omega2) / (x.omega3 - x.omega2 + w.end2 - w.end3), False
    stops = d.housing_engagement_angle == 0.0 and is_housing_engaged(w.mode)
    if stops and x.omega2 > 0.0 and w.end2 < 0.0:
        return x.omega2 / (x.omega2 - w.end2), True
    return 1.0, False


def close_within(d, x, w, prescribed, h, share, housing):
    """Go the step in two, parted where a freewheel closes and holds link 2 or joins it with the hub.

    No part makes energy with any inertia between, so nothing is evaluated there. Returns whether it went.
    """
    share = max(share, SHORTEST)
    rests = x.omega2 == 0.0 and w.end2 == 0.0
    joined = housing and is_output_engaged(w.mode) and x.omega3 == x.omega2 and x.play_output == 0.0
    target = 0.0 if housing or rests else x.omega3 + share * (w.end3 - x.omega3)
    slip = x.omega1 + share * (w.end1 - x.omega1) - target
    turned = 0.5 * share * h * (x.omega1 - x.omega2 + slip)
    angle = turned + (1.0 - share) * h * slip
    look_ahead(d, x, w, angle)
    for n in range(3):
        if share >= 1.0:
            return False
        # (any will do where the drive turns back)
        part = turned / angle if turned * (angle - turned) > 0.0 else share
        end_at(x, w, part)
        follow(d, x, w, rests, joined, share * prescribed, share * h)
        gap = x.omega2 if housing else x.omega3 - x.omega2
        left = w.end2 if housing else w.end3 - w.end2
        longer = LATER * gap / (gap - left) if gap > left else 1.0
        if n < 2 and longer * share > SHORTEST:
            share *= longer
            turned = longer * w.new_slip_angle
    if w.reached == 0.0 or w.reversed != 0.0:
        return False
    copy(w.part.numbers, x.numbers)
    finish(d, x, w, share * h)
    end_at(x, w, 1.0)
    w.slip_angle = (1.0 - part) * angle
    rest = 1.0 - share
    follow_loaded(d, x, w, rest * prescribed, rest * h, False)
    if w.reached == 0.0:
        copy(x.numbers, w.part.numbers)
        w.weighed = 0.0
        return False
    finish(d, x, w, rest * h)
    return True


def finish(d, x, w, h):
    """Take over what the step, or a part of it, ends with."""
    change = w.change
    end2, end3 = w.settled2, w.settled3
    if w.slip_stopped != 0.0 and abs(end2 - w.end1) <= STOPPED * abs(w.end1):
        if end3 == end2:
            end3 = w.end1
        end2 = w.end1
    held, driving = is_housing_engaged(w.mode), is_output_engaged(w.mode)
    impact = (held and x.play_housing > 0.0) or (driving and x.play_output > 0.0)
    if impact:
        inertia2 = inertia_of_link2(d, w.end.i, w.end.b, w.end.g)
        inertia3 = shaft_inertia(d, w.stiff != 0.0)
        lost = inertia2 * (w.end2 * w.end2 - end2 * end2) + inertia3 * (w.end3 * w.end3 - end3 * end3)
        change.lost[FREEWHEEL] += 0.5 * lost
    # links 1 and 2 take the impact that brings link 2 to its end speed
    reaction = d.k * (w.end.b + d.k * w.end.g) * (end2 - w.end2)
    if d.by_torque != 0.0:
        w.end1 += reaction / inertia_of_link1(d, w.end.i, w.end.b, w.end.g)
    else:
        change.drive -= reaction
        change.work_in -= w.end1 * reaction
    w.end2 = end2
    turned2 = change.theta1 - w.new_slip_angle
    mesh = motion.mesh_impulse(d, x, w, h)
    change.housing = d.J2 * (end2 - x.omega2) + d.b2 * turned2 + change.output - mesh
    change.square = change.output * change.output / h
    # on to just where the inertia at the end is that of: with another the energy would not be the same
    change.q = d.k * w.slip_angle
    change.wound_housing = -turned2
    change.wound_output = turned2 - h * w.mean3
    w.weighed += w.weighing
    change.lost[JOURNAL] = w.journal_share * change.lost[MESH]
    change.lost[MESH] -= change.lost[JOURNAL]
    motion.turn_shaft(d, x, w, h)
    commit(d, x, w)
    # (speeds as they are, so that those of parts that move together are equal)
    x.omega1 = w.end1
    x.omega2 = end2
    motion.end_hub(d, x, w, end3)
    if held:
        x.play_housing = 0.0
    if driving:
        x.play_output = 0.0
    if not impact:
        x.torque_peak = max(x.torque_peak, abs(change.output) / h)
        x.housing_torque_peak = max(x.housing_torque_peak, d.housing * abs(change.housing) / h)
    x.housing_slip_peak = max(x.housing_slip_peak, end2)
    x.output_slip_peak = max(x.output_slip_peak, end3 - end2)
    copy(x.here.numbers, w.end.numbers)
    x.friction = w.friction
    count_switch(x, x.step_mode, w.mode, True, True)
    x.step_mode = w.mode


def one_step(d, x, w, prescribed, h):
    """One fixed step, in two parts where a freewheel closes within it.

    Args:
        prescribed: change of omega1, rad/s, or impulse of the input torque, N m s.
    """
    w.friction = x.friction
    w.journal_share = w.weight1 = w.weight_slip = w.weighed = 0.0
    w.dragging = d.losses
    falls = d.weight * d.by_torque != 0.0
    if falls:
        copy(w.fallen.numbers, x.numbers)
    given = 0.0 if d.by_torque != 0.0 else 0.5 * prescribed
    w.far_angle1 = h * (x.omega1 + given)
    look_ahead(d, x, w, h * (x.omega1 - x.omega2 + given))
    follow_loaded(d, x, w, prescribed, h, True)
    share, housing = share_until_closed(d, x, w)
    friction = w.friction
    if not (share < 1.0 and close_within(d, x, w, prescribed, h, share, housing)):
        if share < 1.0:
            w.friction = friction
            end_at(x, w, 1.0)
            follow_contacts(d, x, w, prescribed, h)
        elif passes(d) == 0 and w.foreseen != w.far_angle:
            look_ahead(d, x, w, w.foreseen)
            follow_contacts(d, x, w, prescribed, h)
        if w.reached == 0.0:
            # the drive stays where it is: there the energy always suffices
            end_at(x, w, 0.0)
            if d.weight != 0.0:
                w.far_angle = 0.0
                motion.weigh(d, x, w)
            follow_contacts(d, x, w, prescribed, h)
        finish(d, x, w, h)
    if falls:
        motion.end_fall(d, x, w)


def run_timestepping(d, x, w, h):
    """Advance by h in equal steps no longer than max_step. Returns a status."""
    count = max(1.0, math.ceil(h / d.max_step - 1e-9))
    if count > MAX_STEPS:
        return TOO_MUCH_WORK
    part = h / count
    start1 = x.omega1
    w.load, w.prescribed = x.load_torque, x.drive_torque
    clear(w.change.numbers)
    # what takes over the changes of a step is told by these whether play is left to turn back
    x.housing_state = x.output_state = OVERRUNNING
    number = 0.0
    while number < count:
        number += 1.0
        prescribed = x.drive_torque * part
        if d.by_torque == 0.0:
            prescribed = start1 + x.alpha1 * part * number - x.omega1
        omega1, omega2 = x.omega1, x.omega2
        one_step(d, x, w, prescribed, part)
        sample_load(d, x, x.q, x.omega1, x.omega2, (x.omega1 - omega1) / part, (x.omega2 - omega2) / part)
    # what the torques now follow from
    select_mode(d, x, 0.0)
    return OK
