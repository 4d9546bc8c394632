"""The turning of the satellite gears: inertia Ja about their own axes, Jt across (docs/mechanics.md, Bodies).

Of the energy of a gear's rotation what is the same at every angle is added to J1 and J16, so that only what
goes with the azimuth A of its axis is left to the reduced inertia.
"""

import math


def add_bodies(p, d):
    """Set what the gears add to J1, J16, I, B and the bounds of |F|; the rest of d is there.

    T = Jt |w|^2 / 2 + (Ja - Jt) (w e)^2 / 2 with w = omega1 x + q' (z + s e), e the axis of the gear. In the
    planar layout it is parallel to the central one.
    """
    d.bodies = 0.0
    d.body_i = 0.0
    d.body_b = 0.0
    number = p.modules * p.satellites
    own = number * p.satellite_inertia
    across = number * p.satellite_transverse_inertia
    if d.planar != 0.0:
        across = 0.0
    if own + across == 0.0:
        return
    if d.planar == 0.0:
        d.bodies = 1.0
        sine = math.sin(p.shaft_angle)
        cosine = math.cos(p.shaft_angle)
        spin = d.s + cosine
        d.J1 += across
        # the sum of cos^2 A in I is half their number for three or more, that of cos A in B 0 for two or more
        if d.paired != 0.0:
            d.body_i = (own - across) * sine * sine
        else:
            d.J1 += 0.5 * (own - across) * sine * sine
        if d.single != 0.0:
            d.body_b = sine * (across * cosine - own * spin)
        own = own * spin * spin + across * sine * sine
    d.J16 += own
    d.F_by_speed += d.k * abs(d.body_i)
    d.F_by_alpha1 += d.k * (abs(d.body_b) + (1.0 + d.k) * own)


def momentum_rate(p, omega1, alpha1, rate_q, rate2_q, azimuth):
    """Rate of the angular momentum of one gear's rotation in the frame of link 1, N m (bevel).

    L = Jt v + h e with v = omega1 x + q' z of the drive, h = Jt s q' + (Ja - Jt) (w e) and e' = v x e.

    Args:
        p: parameters. omega1, alpha1: of link 1. rate_q, rate2_q: q' and q''. azimuth: A of its axis, rad.
    """
    sine = math.sin(p.shaft_angle)
    axial = math.cos(p.shaft_angle)
    along = -sine * math.cos(azimuth)
    across = -sine * math.sin(azimuth)
    own = p.satellite_inertia
    transverse = p.satellite_transverse_inertia
    spin = own * (p.z17 / p.z6 + axial) - transverse * axial
    h = spin * rate_q + (own - transverse) * along * omega1
    h_rate = spin * rate2_q + (own - transverse) * (along * alpha1 - across * rate_q * omega1)
    return (
        transverse * alpha1 + h_rate * along - h * rate_q * across,
        -transverse * omega1 * rate_q + h_rate * across + h * (rate_q * along - omega1 * axial),
        transverse * rate2_q + h_rate * axial + h * omega1 * across,
    )
