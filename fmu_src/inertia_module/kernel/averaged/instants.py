"""Instants of the motion between switches by the integrals of its contact mode.

An instant is (omega1, omega2, alpha1, alpha2, omega2'', F, F'); t is the motion in hand (fields.TRAVEL).
"""

import math

from ..codes import DRIVING, FREE
from ..inertia import reduced_inertia
from ..links import angular_momentum, inertia_of_link1, kinetic_energy, motion

# square of a slip that is as good as none
LEAST_SQUARE = 1e-24


def take_integrals(d, t, omega1, omega2):
    """Set the integrals of the mode in hand by the speeds at t.q.

    Free: Jacobi's integral C = H r - I of the slip r = (omega1 - omega2)^2, H = J2 + k^2 G, with omega1
    constant; else 2 E and the angular momentum P. Link 2 of constant speed u: 2 (E - u P), and omega1 where
    it is given.
    """
    i, _, _, b, _, g, _, _ = reduced_inertia(d, t.q)
    slip = omega1 - omega2
    if d.by_torque == 0.0:
        t.energy = (d.J2 + d.k * d.k * g) * slip * slip - i
        return
    t.momentum = angular_momentum(d, t.q, omega1, omega2)
    if t.mode == FREE:
        t.energy = 2.0 * kinetic_energy(d, t.q, omega1, omega2, 0.0)
    else:
        phi = inertia_of_link1(d, i, b, g)
        t.energy = phi * slip * slip - (d.J1 + i + d.J2) * omega2 * omega2


def speeds_at(d, t, q, energy, momentum):
    """Speeds of both links by the integrals of the mode, and the square of the slip, < 0: there is none."""
    i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
    k = d.k
    own = d.J2 + k * k * g
    kept = t.omega3 if t.mode == DRIVING else 0.0
    d.map_evaluations += 1.0
    if d.by_torque == 0.0:
        if t.mode != FREE:
            return t.direction, kept, (t.direction - kept) * (t.direction - kept)
        square = (energy + i) / own
        return t.direction, t.direction * (1.0 - signed_root(square)), square
    if t.mode != FREE:
        square = (energy + (d.J1 + i + d.J2) * kept * kept) / inertia_of_link1(d, i, b, g)
        return kept + t.direction * signed_root(square), kept, square
    # 2 E = P^2 / a + (own - c^2 / a) slip^2 with the coefficients of omega1^2 and omega1 times the slip
    a = d.J1 + i + d.J2
    c = k * b - d.J2
    square = (energy - momentum * momentum / a) / (own - c * c / a)
    slip = t.direction * signed_root(square)
    omega1 = (momentum - c * slip) / a
    return omega1, omega1 - slip, square


def signed_root(square):
    """Root of the size of a square, with its sign."""
    return math.copysign(math.sqrt(abs(square)), square)


def integrals_after(d, t, here, angle):
    """The integrals so much drive angle further: the torque of link 1 adds M1 theta1 to E and M1 t to P."""
    if d.by_torque == 0.0 or t.prescribed == 0.0:
        return t.energy, t.momentum
    if t.mode != FREE:
        return t.energy + 2.0 * t.prescribed * angle / d.k, t.momentum
    # by the midpoint
    part = t.prescribed * angle / d.k
    slip = here[0] - here[1]
    energy = t.energy + part * here[0] / slip
    momentum = t.momentum + 0.5 * part / slip
    omega1, _, square = speeds_at(d, t, t.q + 0.5 * angle, energy, momentum)
    slip = t.direction * math.sqrt(max(square, LEAST_SQUARE))
    return t.energy + 2.0 * part * omega1 / slip, t.momentum + part / slip


def instant(d, t, q, omega1, omega2):
    """Accelerations and the torque that passes link 2, kept at its speed unless it is free."""
    d.map_evaluations += 1.0
    alpha1, alpha2, jerk2, torque, torque_rate, _, _ = motion(
        d, q, omega1, omega2, t.prescribed, t.mode != FREE, 0.0, 0.0, 0.0, 0.0
    )
    return omega1, omega2, alpha1, alpha2, jerk2, torque, torque_rate


def instant_after(d, t, here, length):
    """Instant so much angle travelled after this one, at t.q."""
    angle = t.direction * length
    energy, momentum = integrals_after(d, t, here, angle)
    omega1, omega2, _ = speeds_at(d, t, t.q + angle, energy, momentum)
    return instant(d, t, t.q + angle, omega1, omega2)
