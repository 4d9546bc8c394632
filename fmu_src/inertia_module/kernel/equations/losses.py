"""Losses: their causes, the power that each takes, and the torques of those that go by speeds alone (air).

One more of these is its cause, its torques and its bounds here, and its rows in the table of variables.
"""

import math

from ..accumulate import TWO_PI
from ..links import friction_power
from ..sine import sine_cosine
from .satellites import weight_torques
from .states import OPEN, WOUND

# what energy_lost_... of the table of variables is lost to: viscous friction of links, drives and output; the
# elastic shaft; and of a machine with losses the meshes; journals of the satellites; freewheels; the air
CAUSES = ("viscous", "shaft", "mesh", "journal", "freewheel", "windage")
VISCOUS, SHAFT, MESH, JOURNAL, FREEWHEEL, WINDAGE = range(len(CAUSES))


def windage_in_all(d):
    """Coefficient of the air for all satellites together, kg m^2."""
    return d.windage * d.modules * d.satellites


def by_load(d):
    """Sum of the coefficients of losses that the general equations alone have: 0 without any."""
    return d.mesh_loss + d.satellite_loss + d.journal_friction + d.weight + windage_in_all(d)


def add_to_bounds(d):
    """Add what such losses add to the bounds of |F| by the squares of slip and speed (fields.CONSTANTS)."""
    reach = 1.0 + d.s
    d.F_by_slip += 4.0 * d.k * windage_in_all(d) * reach * reach * reach
    d.F_by_speed += 4.0 * d.k * windage_in_all(d) * reach


def outer_torques(d, x, m, place):
    """Write the torques of weights and air against link 1 and q into m, N m, and the power of the air, W.

    Args:
        place: of the first imbalance (layout.imbalance), where there are weights.
    """
    m.weight1 = m.weight_q = 0.0
    if d.weight != 0.0:
        _, m.weight1, m.weight_q = weight_torques(d, place, m.theta1)
    m.lost[WINDAGE] = 0.0
    if d.windage != 0.0:
        slip = m.omega1 - m.omega2 if x.slip_sign != 0.0 else 0.0
        by_theta1, by_q, m.lost[WINDAGE] = windage_torques(d, m.q, m.omega1, d.k * slip)
        m.weight1 += by_theta1
        m.weight_q += by_q


def windage_torques(d, q, omega1, rate_q):
    """Torques with which the air resists link 1 and q, N m, and the power that it takes, W.

    On each satellite -windage |w| w, with w = omega1 x + q' (z + s e) its absolute angular velocity and e its
    axis (docs/mechanics.md, "Losses"); in the planar layout it is omega1 + q' about the central axis.
    """
    number = 1.0 if d.planar != 0.0 else d.satellites
    share = windage_in_all(d) / number
    along = across = 1.0
    by_theta1 = by_q = power = 0.0
    for n in range(int(number)):
        if d.planar == 0.0:
            _, cos_a = sine_cosine(q + d.phase_a + TWO_PI * n / number)
            across = d.turn_across * cos_a
            along = d.turn_along
        turn1 = omega1 + across * rate_q
        turn_q = across * omega1 + along * rate_q
        square = max(omega1 * turn1 + rate_q * turn_q, 0.0)
        speed = share * math.sqrt(square)
        by_theta1 += speed * turn1
        by_q += speed * turn_q
        power += speed * square
    return by_theta1, by_q, power


def power_of_freewheels(d, x, m):
    """Power that drag and damping of both freewheels take, W, never below 0."""
    slip = m.omega3 - m.omega2
    lost = 0.0
    if x.housing_state == OPEN:
        lost = -m.housing * m.omega2
    elif x.housing_state == WOUND:
        lost = d.housing_damping * m.omega2 * m.omega2
    if x.output_state == OPEN:
        lost -= m.output * slip
    elif x.output_state == WOUND:
        lost += d.freewheel_damping * slip * slip
    return lost


def write_powers_lost(d, x, m, rates, lossy):
    """Write the powers that the causes of losses take of the motion in m, after evaluate, into rates, W."""
    if d.elastic != 0.0:
        omega4 = m.omega3 - m.relative
        shaft = d.shaft_damping * m.relative * m.relative + d.driven_friction * omega4 * omega4
        # (less what the balancer would do at the speed of the hub, whose integral advance.commit knows)
        rates.lost[SHAFT] = shaft + d.balancer * d.J4 * m.alpha3 * m.relative
    if d.viscous != 0.0:
        rates.lost[VISCOUS] = friction_power(d, m.omega1, m.omega2, d.b2) + d.b3 * m.omega3 * m.omega3
    if lossy:
        slip = m.omega1 - m.omega2 if x.slip_sign != 0.0 else 0.0
        # of one sign up to the event, and smooth beyond it
        turned = x.slip_sign * d.k * slip
        rates.lost[MESH] = d.mesh_loss * x.flow_sign * m.mesh * slip + m.spun * turned
        rates.lost[JOURNAL] = m.journals * turned
        rates.lost[FREEWHEEL] = power_of_freewheels(d, x, m)
        rates.lost[WINDAGE] = m.lost[WINDAGE]
