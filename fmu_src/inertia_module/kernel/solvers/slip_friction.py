"""Friction of loaded meshes and journals in a fixed step: one impulse against the mean slip of links 1 and 2.

It never drives the slip on, whatever its size, so no step makes energy with it (docs/mechanics.md).
"""

import math

from ..general.satellites import AS_THEY_ARE, spin_torques
from ..layout import imbalance
from .link_step import move_links, turn_link1

# share of the speeds by which a slip misses zero that friction has stopped
STOPPED = 1e-14


def load_satellites(d, x, w, h):
    """Resistance of journals and the mesh 17-6 to q in the middle of the step that w has found."""
    alpha1 = (w.end1 - x.omega1) / h
    mean_slip = w.new_slip_angle / h
    rate2_q = d.k * ((w.end1 - w.end2) - (x.omega1 - x.omega2)) / h
    q = x.q + 0.5 * d.k * w.new_slip_angle
    place = imbalance(d, q, 0.0)
    w.journals, w.spin, w.spin_by_alpha1, w.spin_by_rate2 = spin_torques(
        d, q, place, x.omega1 + 0.5 * h * alpha1, d.k * mean_slip, alpha1, rate2_q, AS_THEY_ARE
    )


def move_rubbing(d, x, w, held, carried, load, gain, prescribed, h, rub):
    """Links 1 and 2 over the step against this impulse on their slip, N m s (see link_step)."""
    w.rub = rub
    if held:
        turn_link1(d, x, w, prescribed, h)
    else:
        move_links(d, x, w, carried, load, gain, prescribed, h)


def mesh_impulse(d, x, w, h):
    """Impulse that the mesh passes to link 2 in the step that w has found: what link 1 does not keep."""
    put_in = x.drive_torque * h if d.by_torque != 0.0 else w.impulse1
    before = (d.J1 + x.i) * x.omega1 + d.k * x.b * (x.omega1 - x.omega2)
    after = (d.J1 + w.end_i) * w.end1 + d.k * w.end_b * (w.end1 - w.end2)
    return put_in - (after - before) - d.b1 * w.angle1 - h * w.weight1


def solve_friction(base, by_base, loss, mesh, by_mesh):
    """The impulse f = base + by_base f + loss |mesh + by_mesh f|, N m s; without end where none solves it."""
    for sign in (1.0, -1.0):
        share = 1.0 - by_base - sign * loss * by_mesh
        if share > 0.0:
            friction = (base + sign * loss * mesh) / share
            if sign * (mesh + by_mesh * friction) >= 0.0:
                return max(friction, 0.0)
    return 1e300


def move_with_friction(d, x, w, held, carried, load, gain, prescribed, h):
    """Links 1 and 2 over the step; their friction, solved for, goes into w.lost_mesh and w.lost_journal.

    All it depends on is linear in it but for signs, so two steps tell it, and a third is made with it.
    """
    w.lost_mesh = w.lost_journal = w.slip_stopped = 0.0
    w.straight = 1.0
    move_rubbing(d, x, w, held, carried, load, gain, prescribed, h, 0.0)
    k = d.k
    slip = x.omega1 - x.omega2
    end_slip, mean, end1 = w.end1 - w.end2, w.new_slip_angle / h, w.end1
    mesh = mesh_impulse(d, x, w, h)
    # the change by an impulse that is about enough to stop the slip, or any
    speed = abs(slip) + abs(end_slip)
    trial = (d.J2 + carried + k * k * x.g) * (speed if speed > 0.0 else 1.0)
    move_rubbing(d, x, w, held, carried, load, gain, prescribed, h, trial)
    by_end = (end_slip - (w.end1 - w.end2)) / trial
    by_mean = (mean - w.new_slip_angle / h) / trial
    by_end1 = (w.end1 - end1) / trial
    by_mesh = (mesh_impulse(d, x, w, h) - mesh) / trial
    # what brings the slip at the end and the mean slip to zero
    stop = end_slip / by_end if by_end > 0.0 else math.copysign(1e300, mean)
    turn = mean / by_mean if by_mean > 0.0 else math.copysign(1e300, mean)
    most = min(abs(stop), abs(turn)) if stop * turn > 0.0 or stop == turn else 0.0
    way = math.copysign(1.0, stop)
    spun = w.spin * h + w.spin_by_alpha1 * (end1 - x.omega1) + w.spin_by_rate2 * k * (end_slip - slip)
    by_spun = w.spin_by_alpha1 * by_end1 - w.spin_by_rate2 * k * by_end
    journals = k * h * w.journals
    friction = solve_friction(journals + k * spun, k * way * by_spun, d.mesh_loss, mesh, way * by_mesh)
    rub = way * min(friction, most)
    w.straight = 0.0
    move_rubbing(d, x, w, held, carried, load, gain, prescribed, h, rub)
    if rub * w.new_slip_angle < 0.0:
        rub = 0.0
        move_rubbing(d, x, w, held, carried, load, gain, prescribed, h, rub)
    if friction >= most and abs(w.end1 - w.end2) <= STOPPED * (abs(slip) + abs(w.end1)):
        w.slip_stopped = 1.0
        w.end2 = w.end1
        if slip == 0.0:
            w.new_slip_angle = w.foreseen = 0.0
            return
    if rub != 0.0 and friction > 0.0:
        lost = rub * w.new_slip_angle / h
        w.lost_journal = lost * min(1.0, journals / friction)
        w.lost_mesh = lost - w.lost_journal
