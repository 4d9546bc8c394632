"""Inertia, momentum and energy of links 1 and 2, scales of torques and speeds, and the elastic shaft.

The elastic shaft connects the hub of the output freewheel (omega3) with the driven mass (omega4):

    Ts = c delta + d (omega3 - omega4)        J4 omega4' = Ts - f omega4 - T_load + beta J4 omega3'
"""

import math

from .equations.states import ENGAGED_COMPLIANT, LOCKED
from .inertia import reduced_inertia
from .records import Constants, State


def prescribed_at_input(d: Constants, x: State) -> float:
    """Return the prescribed quantity at link 1: its torque M1, N m, or its acceleration alpha1, rad/s^2."""
    return x.drive_torque if d.by_torque != 0.0 else x.alpha1


def torque_scale(d: Constants, omega1: float, alpha1: float, rate_q: float, prescribed: float) -> float:
    """Return an upper bound of |F| at these speeds, N m, the scale of torques."""
    reach = d.F_by_alpha1
    scale = 0.5 * (d.F_by_slip * rate_q * rate_q + d.F_by_speed * omega1 * omega1) + reach * abs(alpha1)
    scale += d.k * d.bq * abs(rate_q)
    if d.by_torque != 0.0 and reach > 0.0:
        scale += abs(prescribed) * reach / (reach + d.J1)
    return scale


def friction_power(d: Constants, omega1: float, omega2: float, friction: float) -> float:
    """Return the power of viscous friction at links 1 and 2 and the pinion shafts, W."""
    rate_q = d.k * (omega1 - omega2)
    return d.b1 * omega1 * omega1 + d.bq * rate_q * rate_q + friction * omega2 * omega2


def response(d: Constants, inertia: float) -> float:
    """Return the fraction of its own speed that the mechanism can impart to a link of this inertia, 0 to 1.

    It is the scale of an error of the link's speed (events.error).
    """
    mechanism = d.F_by_alpha1
    return mechanism / (mechanism + inertia) if mechanism > 0.0 else 1.0


def inertia_of_link1(d: Constants, i: float, b: float, g: float) -> float:
    """Return Phi = J1 + I + 2 k B + k^2 G, the inertia at the input shaft while link 2 is held, kg m^2."""
    return d.J1 + i + d.k * (2.0 * b + d.k * g)


def inertia_at_input(d: Constants, q: float) -> float:
    """Return the inertia at the input shaft while link 2 is held, at an angle of the pinion shaft.

    Args:
        d: Constants.
        q: Pinion-shaft angle, rad.

    Returns:
        Phi, kg m^2.
    """
    i, _, b, _, g, _ = reduced_inertia(d, q)
    return inertia_of_link1(d, i, b, g)


def inertia_of_link2(d: Constants, i: float, b: float, g: float) -> float:
    """Return the effective inertia of link 2, kg m^2.

    It is J2 + k^2 G if the speed of link 1 is prescribed, and J2 + k^2 G - N^2 / Phi if its torque is.
    """
    k = d.k
    if d.by_torque == 0.0:
        return d.J2 + k * k * g
    return d.J2 + k * k * ((d.J1 + i) * g - b * b) / inertia_of_link1(d, i, b, g)


def momentum_of_links(d: Constants, i: float, b: float, omega1: float, omega2: float) -> float:
    """Return the angular momentum of links 1 and 2 and the imbalances, N m s."""
    return (d.J1 + i) * omega1 + b * d.k * (omega1 - omega2) + d.J2 * omega2


def energy_of_links(d: Constants, i: float, b: float, g: float, omega1: float, omega2: float) -> float:
    """Return the kinetic energy of links 1 and 2 and the imbalances, J."""
    rate_q = d.k * (omega1 - omega2)
    links = 0.5 * ((d.J1 + i) * omega1 * omega1 + d.J2 * omega2 * omega2)
    return links + (b * omega1 + 0.5 * g * rate_q) * rate_q


def kinetic_energy(d: Constants, q: float, omega1: float, omega2: float, omega3: float) -> float:
    """Return the kinetic energy of links 1 and 2, the imbalances and J3, J."""
    i, _, b, _, g, _ = reduced_inertia(d, q)
    return energy_of_links(d, i, b, g, omega1, omega2) + 0.5 * d.J3 * omega3 * omega3


def shaft_frequency(d: Constants, compliance: float) -> float:
    """Return the angular frequency of the shaft between hub and driven mass without damping, rad/s.

    Args:
        d: Constants.
        compliance: 1/J of the parts that the shaft torque accelerates besides the driven mass.
    """
    return math.sqrt(d.shaft_stiffness * (compliance + 1.0 / d.J4))


def fastest_own_rate(d: Constants, x: State) -> float:
    """Return an upper bound of the natural frequencies and decay rates of the elastic parts, rad/s."""
    link2 = max(d.J2, 1e-300)
    hub = 1.0 / (d.J3 + d.J2 if x.output_state == LOCKED else d.J3)
    if x.housing_state == LOCKED and x.output_state == LOCKED:
        hub = 0.0
    rate = max(shaft_frequency(d, hub), d.shaft_damping * (hub + 1.0 / d.J4))
    rate = max(rate, d.driven_friction / d.J4, d.b3 / d.J3, (d.b2 + d.k * d.k * d.bq) / link2)
    if x.housing_state == ENGAGED_COMPLIANT:
        rate = max(rate, math.sqrt(d.housing_stiffness / link2), d.housing_damping / link2)
    if x.output_state == ENGAGED_COMPLIANT:
        mobility = 1.0 / link2 + 1.0 / d.J3
        rate = max(rate, math.sqrt(d.freewheel_stiffness * mobility), d.freewheel_damping * mobility)
    return rate


def fastest_rate(d: Constants, x: State) -> float:
    """Return an upper bound of the angular frequency of pulses, shaft and springs, rad/s."""
    pulses = d.harmonic * d.k * (abs(x.omega1) + abs(x.omega2))
    return pulses + fastest_own_rate(d, x) if d.elastic != 0.0 else pulses


def slowest_rate(d: Constants, compliance: float) -> float:
    """Return the modulus of the slowest eigenvalue of the shaft, rad/s.

    A shaft with strong damping has a slow eigenvalue although it is stiff.

    Args:
        d: Constants.
        compliance: 1/J of the parts that the shaft torque accelerates besides the driven mass.
    """
    mobility = compliance + 1.0 / d.J4
    half = 0.5 * d.shaft_damping * mobility
    square = d.shaft_stiffness * mobility
    if half * half <= square:
        return math.sqrt(square)
    return square / (half + math.sqrt(half * half - square))
