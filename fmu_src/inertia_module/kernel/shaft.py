"""The elastic shaft behind the output freewheel, and the driven mass at its end (docs/mechanics.md).

Ts = c delta + d (omega3 - omega4)        J4 omega4' = Ts - f omega4 - T_load + beta J4 omega3'
"""

import math

from .equations.states import LOCKED, WOUND
from .links import inertia_at_output


def stored_in_shaft(d, x):
    """Energy of the driven mass and the twist, J."""
    omega4 = x.omega3 - x.relative
    return 0.5 * d.J4 * omega4 * omega4 + 0.5 * d.stiffness * x.twist * x.twist


def shaft_frequency(d, compliance):
    """Angular frequency of the shaft between hub and driven mass, without damping, rad/s.

    Args:
        compliance: 1/J of what the shaft torque accelerates besides the driven mass.
    """
    return math.sqrt(d.stiffness * (compliance + 1.0 / d.J4))


def fastest_own_rate(d, x):
    """Bound of the rate at which shaft, springs and what friction brakes move by themselves, rad/s."""
    link2 = max(d.J2, 1e-300)
    hub = 1.0 / (d.J3 + d.J2 if x.output_state == LOCKED else d.J3)
    if x.housing_state == LOCKED and x.output_state == LOCKED:
        hub = 0.0
    rate = max(shaft_frequency(d, hub), d.damping * (hub + 1.0 / d.J4))
    rate = max(rate, d.friction / d.J4, d.b3 / d.J3, (d.b2 + d.k * d.k * d.bq) / link2)
    if x.housing_state == WOUND:
        rate = max(rate, math.sqrt(d.housing_stiffness / link2), d.housing_damping / link2)
    if x.output_state == WOUND:
        mobility = 1.0 / link2 + 1.0 / d.J3
        rate = max(rate, math.sqrt(d.freewheel_stiffness * mobility), d.freewheel_damping * mobility)
    return rate


def slowest_rate(d, compliance):
    """Modulus of the slowest eigenvalue of the shaft, rad/s: a damped one may be slow though stiff."""
    mobility = compliance + 1.0 / d.J4
    half = 0.5 * d.damping * mobility
    square = d.stiffness * mobility
    if half * half <= square:
        return math.sqrt(square)
    return square / (half + math.sqrt(half * half - square))


def is_stiff(d, x, omega1):
    """Tell whether the shaft is too stiff for its own motion to matter, omega1 jumping to this value.

    An oscillation of the rate Omega that pulses excite holds about (pulse rate / Omega)^2 of the energy of a
    pulse: one of less than the tolerance does not.
    """
    fastest = max(abs(x.omega1), abs(omega1), abs(x.omega3), abs(x.omega3 - x.relative))
    pulse_rate = d.harmonic * d.k * fastest
    rate = slowest_rate(d, 1.0 / (d.J3 + inertia_at_output(d, x.q)))
    return d.tolerance * rate * rate > pulse_rate * pulse_rate
