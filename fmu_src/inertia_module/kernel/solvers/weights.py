"""Gravity in a fixed step: the works of the weights are the change of their potential (docs/mechanics.md)."""

import math

from ..accumulate import copy
from ..general.satellites import weight_torques
from ..layout import imbalance
from ..links import kinetic_energy
from .link_step import SMALLEST_DIFFERENCE

# share of the kinetic energy that the speeds give back
UNFALLEN = 0.5


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


def begin_fall(d, x, w):
    """Keep what end_fall needs of the beginning of a step."""
    copy(w.fallen.numbers, x.numbers)
    w.weighed = 0.0


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
