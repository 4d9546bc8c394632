"""Losses: their causes, the power of each, and the torques of gravity and windage.

A new speed-dependent loss needs its cause, torques and bounds here, and its rows in the table of variables.
"""

import math

from ..accumulate import TWO_PI
from ..links import friction_power
from ..records import Constants, Integrated, Machine, Position, State
from ..sine import sine_cosine
from .satellites import gravity_potential
from .states import ENGAGED_COMPLIANT, OVERRUNNING

# Endings of energy_lost_...: viscous friction of links, pinion shafts and output; elastic shaft; with losses
# also meshes, satellite bearings, freewheels, windage
CAUSES = ("viscous", "shaft", "mesh", "journal", "freewheel", "windage")
VISCOUS, SHAFT, MESH, JOURNAL, FREEWHEEL, WINDAGE = range(len(CAUSES))


def total_windage(d: Constants) -> float:
    """Return the windage coefficient of all satellites of all modules, kg m^2."""
    return d.windage * d.modules * d.satellites


def general_loss_coefficient(d: Constants) -> float:
    """Return the sum of the coefficients that require the general equations; 0 if there are none."""
    return d.mesh_loss + d.satellite_loss + d.journal_friction + d.weight + total_windage(d)


def add_loss_bounds(d: Constants) -> None:
    """Add windage to the bounds of the mesh torque by the squares of slip and speed (fields.CONSTANTS)."""
    reach = 1.0 + d.s
    d.F_by_slip += 4.0 * d.k * total_windage(d) * reach * reach * reach
    d.F_by_speed += 4.0 * d.k * total_windage(d) * reach


def applied_torques(
    d: Constants,
    x: State,
    m: Machine,
    position: Position,
) -> None:
    """Write the torques of gravity and windage on link 1 and q, N m, and the windage power, W, into ``m``.

    Args:
        d: Constants.
        x: State; the sign of the slip is read.
        m: Motion; ``applied1``, ``applied_q`` and ``lost[WINDAGE]`` are written.
        position: Of imbalance 0 (layout.imbalance_position), m and m/rad^n; read with gravity.
    """
    m.applied1 = m.applied_q = 0.0
    if d.weight != 0.0:
        _, m.applied1, m.applied_q = gravity_potential(d, position, m.theta1)
    m.lost[WINDAGE] = 0.0
    if d.windage != 0.0:
        slip = m.omega1 - m.omega2 if x.slip_sign != 0.0 else 0.0
        by_theta1, by_q, m.lost[WINDAGE] = windage_torques(d, m.q, m.omega1, d.k * slip)
        m.applied1 += by_theta1
        m.applied_q += by_q


def windage_torques(d: Constants, q: float, omega1: float, rate_q: float) -> tuple[float, float, float]:
    """Return the windage torques against link 1 and q, and the windage power.

    The air exerts the torque -c |w| w on each satellite, with its absolute angular velocity

        w = omega1 x + q' (z + s e)        e: axis of the satellite (losses.md, "Windage")

    In the planar layout w is omega1 + q' about the central axis.

    Args:
        d: Constants.
        q: Pinion-shaft angle, rad.
        omega1: Speed of link 1, rad/s.
        rate_q: q', rad/s.

    Returns:
        (torque on link 1, torque on q, power): N m, N m, W.
    """
    n_satellites = 1.0 if d.planar != 0.0 else d.satellites
    coefficient = total_windage(d) / n_satellites
    along = across = 1.0
    by_theta1 = by_q = power = 0.0
    for n in range(int(n_satellites)):
        if d.planar == 0.0:
            _, cos_a = sine_cosine(q + d.phase_a + TWO_PI * n / n_satellites)
            across = d.turn_across * cos_a
            along = d.turn_along
        # w . x and w . (z + s e)
        turn1 = omega1 + across * rate_q
        turn_q = across * omega1 + along * rate_q
        square = max(omega1 * turn1 + rate_q * turn_q, 0.0)
        speed = coefficient * math.sqrt(square)
        by_theta1 += speed * turn1
        by_q += speed * turn_q
        power += speed * square
    return by_theta1, by_q, power


def freewheel_power(d: Constants, x: State, m: Machine) -> float:
    """Return the power lost to drag and damping of both freewheels, W (never negative)."""
    slip = m.omega3 - m.omega2
    power = 0.0
    if x.housing_state == OVERRUNNING:
        power = -m.housing * m.omega2
    elif x.housing_state == ENGAGED_COMPLIANT:
        power = d.housing_damping * m.omega2 * m.omega2
    if x.output_state == OVERRUNNING:
        power -= m.output * slip
    elif x.output_state == ENGAGED_COMPLIANT:
        power += d.freewheel_damping * slip * slip
    return power


def write_loss_powers(d: Constants, x: State, m: Machine, rates: Integrated) -> None:
    """Write the power of each cause of loss into ``rates.lost``, W.

    Args:
        d: Constants.
        x: State; contact mode and signs are read.
        m: Motion after evaluate.
        rates: Record that is written (fields.INTEGRATED).
    """
    if d.elastic != 0.0:
        omega4 = m.omega3 - m.relative
        shaft = d.shaft_damping * m.relative * m.relative + d.driven_friction * omega4 * omega4
        # The work of the balancer at the hub speed is subtracted in advance.commit, which has its integral
        rates.lost[SHAFT] = shaft + d.balancer * d.J4 * m.alpha3 * m.relative
    if d.viscous != 0.0:
        rates.lost[VISCOUS] = friction_power(d, m.omega1, m.omega2, d.b2) + d.b3 * m.omega3 * m.omega3
    if d.losses != 0.0:
        slip = m.omega1 - m.omega2 if x.slip_sign != 0.0 else 0.0
        # |q'| up to the event, and smooth beyond it
        rate = x.slip_sign * d.k * slip
        rates.lost[MESH] = d.mesh_loss * x.flow_sign * m.mesh * slip + m.mesh_friction * rate
        rates.lost[JOURNAL] = m.journals * rate
        rates.lost[FREEWHEEL] = freewheel_power(d, x, m)
        rates.lost[WINDAGE] = m.lost[WINDAGE]
