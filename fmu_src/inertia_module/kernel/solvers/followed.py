"""Which of the shaft's own motion is resolved by the steps, and which is damped out.

An oscillation of rate Omega that pulses excite holds about (pulse rate / Omega)^2 of the energy of a pulse,
so one is followed up to Omega = pulse rate / sqrt(tolerance). Pulses make it swing with pulse rate / Omega of
their speed at most. One that swings further has been excited by a load and is followed whatever its rate.
"""

import math

from ..codes import DRIVING, HELD_DRIVING
from ..links import inertia_at_output, response


def hub_compliance(d, x, inertia2):
    """1/J of what the shaft torque accelerates: the hub, link 2 with it, or nothing."""
    if x.mode == HELD_DRIVING:
        return 0.0
    return 1.0 / (d.J3 + inertia2) if x.mode == DRIVING else 1.0 / d.J3


def shaft_frequency(d, compliance):
    """Angular frequency of the shaft between hub and driven mass, without damping, rad/s."""
    return math.sqrt(d.stiffness * (compliance + 1.0 / d.J4))


def slowest_rate(d, compliance):
    """Modulus of the slowest eigenvalue of the shaft, rad/s: a damped one may be slow though stiff."""
    mobility = compliance + 1.0 / d.J4
    half = 0.5 * d.damping * mobility
    square = d.stiffness * mobility
    if half * half <= square:
        return math.sqrt(square)
    return square / (half + math.sqrt(half * half - square))


def is_slow(d, compliance, pulse_rate):
    """Tell whether the shaft is too slow for what pulses excite of its own motion to be damped out."""
    return slowest_rate(d, compliance) ** 2 <= d.followed * pulse_rate * pulse_rate


def share_of_pulses(d):
    """How much of its own speed the mechanism can impart to link 2 and the hub, 0 to 1."""
    return response(d, d.J2 + d.J3) if d.F_by_alpha1 > 0.0 else 0.0


def swing_of_load(d, x, compliance, pulse_rate, fastest, rate_relative):
    """Amplitude of the relative speed the shaft swings with, rad/s, or 0 if pulses may have made it swing.

    Args:
        rate_relative: rate of omega3 - omega4 now, rad/s^2.
    """
    frequency = shaft_frequency(d, compliance)
    swing = max(abs(x.relative), abs(rate_relative) / frequency)
    pulses = share_of_pulses(d) * pulse_rate / frequency
    return swing if swing > max(d.tolerance, pulses) * fastest else 0.0


def is_stiff(d, x, omega1):
    """Tell whether the shaft is too stiff for its own motion to be followed, omega1 jumping to this value."""
    compliance = 1.0 / (d.J3 + inertia_at_output(d, x.q))
    shaft = max(abs(x.omega3), abs(x.omega3 - x.relative))
    speeds = max(max(abs(x.omega1), abs(omega1)), shaft)
    return not is_slow(d, compliance, widest_rate(d, speeds))


def widest_rate(d, fastest):
    """Rate of the pulses if their slip were the fastest speed around, rad/s."""
    return d.harmonic * d.k * fastest
