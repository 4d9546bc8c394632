"""Loads of the satellites in a fixed step: gravity, and the friction of meshes and journals.

The works of the weights are the change of their potential. Friction is one torque against the slip of links 1
and 2, by the loads of the step itself (docs/mechanics.md).
"""

import math

from ..accumulate import copy
from ..equations.satellites import AS_THEY_ARE, spin_torques, weight_torques
from ..layout import imbalance
from ..links import kinetic_energy
from .link_step import SMALLEST_DIFFERENCE

# share of the kinetic energy that the speeds give back
UNFALLEN = 0.5
# share of a change of friction that it does not cause itself, at least: meshes that jam are refused
NOT_ITS_OWN = 0.1


def mesh_impulse(d, x, w, h):
    """Impulse that the mesh passes to link 2 in the step that w has found: what link 1 does not keep."""
    put_in = x.drive_torque * h if d.by_torque != 0.0 else w.impulse1
    before = (d.J1 + x.i) * x.omega1 + d.k * x.b * (x.omega1 - x.omega2)
    after = (d.J1 + w.end_i) * w.end1 + d.k * w.end_b * (w.end1 - w.end2)
    return put_in - (after - before) - d.b1 * w.angle1 - h * w.weight1


def find_friction(d, x, w, h):
    """Take from the step that w has found what its loads resist its slip with, w.friction, N m.

    All is linear in it but for signs, so the step before and this one tell where it is its own cause.
    """
    k = d.k
    journals = spun = 0.0
    if d.journal + d.satellite_loss > 0.0:
        alpha1 = (w.end1 - x.omega1) / h
        rate2_q = k * ((w.end1 - w.end2) - (x.omega1 - x.omega2)) / h
        q = x.q + 0.5 * k * w.new_slip_angle
        mean1 = x.omega1 + 0.5 * h * alpha1
        journals, spun, by_alpha1, by_rate2 = spin_torques(
            d, q, imbalance(d, q, 0.0), mean1, k * w.new_slip_angle / h, alpha1, rate2_q, AS_THEY_ARE
        )
        spun = k * (journals + spun + by_alpha1 * alpha1 + by_rate2 * rate2_q)
    mesh = mesh_impulse(d, x, w, h) / h
    change = w.friction - w.friction_before
    by_spun = by_mesh = more = 0.0
    if change != 0.0 and w.slip_stopped == 0.0:
        by_spun = (spun - w.spun) / change
        by_mesh = (mesh - w.mesh) / change
    for sign in (1.0, -1.0):
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
    here, by_theta1, by_q = weight_torques(d, imbalance(d, x.q, 0.0), theta1)
    angle = d.k * w.far_angle
    there, far_by_theta1, _ = weight_torques(d, imbalance(d, x.q + angle, 0.0), theta1)
    w.weight1 = 0.5 * (by_theta1 + far_by_theta1)
    if half != 0.0:
        w.weight1 *= math.sin(half) / half
    w.weight_slip = d.k * by_q
    if abs(angle) > SMALLEST_DIFFERENCE:
        w.weight_slip = (there - here) / w.far_angle * math.cos(half)


def potential(d, x):
    """Potential energy of the imbalances, J."""
    value, _, _ = weight_torques(d, imbalance(d, x.q, 0.0), x.theta1)
    return value


def end_fall(d, x, w):
    """Take from the speeds what the weights have worked more than they have fallen.

    That happens only with the torque of link 1 given, for its angle is not known beforehand. Where that is
    much of what moves the step ends where it began, at rest.
    """
    gained = potential(d, x) - potential(d, w.fallen) - w.weighed
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
