"""Resistance to the spin of the satellites, friction in their journals and in the mesh with wheel 17.

Where losses are large and links light, no motion, or more than one, agrees with the loads: meshes jam.
"""

import math

from ..accumulate import TWO_PI
from ..inertia import reduced_inertia
from ..layout import acceleration, imbalance
from ..sine import sine_cosine

# angles in one turn at which it is looked at, for each of its highest harmonics; of more turns as many angles
ANGLES = 64
# satellites at most whose torques' signs are followed: bits of one number, set where negative
MANY = 50
# in place of that number: signs as the torques have them
AS_THEY_ARE = -1.0


def inertia_at(d, place):
    """Part of inertia.reduced_inertia for motion.evaluate, of one bevel imbalance whose place is known."""
    _, y, z, x1, y1, z1, x2, y2, z2 = place
    mass = d.mass
    return (
        mass * (y * y + z * z),
        2.0 * mass * (y * y1 + z * z1),
        mass * (y * z1 - z * y1),
        mass * (y * z2 - z * y2),
        mass * (x1 * x1 + y1 * y1 + z1 * z1) + d.J16,
        2.0 * mass * (x1 * x2 + y1 * y2 + z1 * z2),
    )


def spin_torques(d, q, first, omega1, rate_q, alpha1, rate2_q, signs):
    """Torque that resists q, whatever its sign, by the loads of all satellites (docs/mechanics.md, "Losses").

    Journals: coefficient times radius, times m |a| without what alpha1 and q'' add to a, times the spin s.
    Mesh 17-6: its loss times s |tau6|, tau6 = m a . dr/dB, linear in the accelerations.

    Args:
        first: place of the first imbalance (layout.imbalance).
        q, omega1, rate_q, alpha1, rate2_q: motion of link 1 and the drives.
        signs: of all tau6, or AS_THEY_ARE at these accelerations.

    Returns:
        (journals, mesh, mesh by alpha1, mesh by q''): N m, and kg m^2; mesh is what remains without both.
        Left in d.machine: the signs, and what each satellite adds, N m.
    """
    journals = 0.0
    rest = 0.0
    by_alpha1 = 0.0
    by_rate2 = 0.0
    told = signs
    found = 0.0
    bit = 1.0
    number = 1.0 if d.planar != 0.0 else d.satellites
    mass = d.mass / number
    share = mass * d.satellite_loss
    for n in range(int(number)):
        place = imbalance(d, q, TWO_PI * n / number) if n > 0 else first
        px, y, z, x1, y1, z1, _, _, _ = place
        ax, ay, az = acceleration(place, omega1, 0.0, rate_q, 0.0)
        journals += math.sqrt(ax * ax + ay * ay + az * az)
        # s dr/dB = r' - dr/dA
        spin_x = x1 + y
        spin_y = y1 - px
        own = ax * spin_x + ay * spin_y + az * z1
        with_alpha1 = y * z1 - z * spin_y
        with_rate2 = x1 * spin_x + y1 * spin_y + z1 * z1
        torque = own + with_alpha1 * alpha1 + with_rate2 * rate2_q
        negative = torque < 0.0
        if signs != AS_THEY_ARE:
            half = math.floor(0.5 * told)
            negative = told != 2.0 * half
            told = half
        sign = -1.0 if negative else 1.0
        found += bit if negative else 0.0
        bit *= 2.0
        if n < MANY:
            d.machine.spun_by[n] = share * sign * torque
        rest += sign * own
        by_alpha1 += sign * with_alpha1
        by_rate2 += sign * with_rate2
    d.machine.spin_signs = found
    return d.journal_friction * d.s * mass * journals, share * rest, share * by_alpha1, share * by_rate2


def with_sign_changed(signs, n):
    """Change the sign of satellite n in the number that holds all."""
    # not 2.0**n, which compiled would ask for one more function of the C library
    bit = 1.0
    for _ in range(n):
        bit += bit
    return signs + (bit if math.floor(signs / bit) % 2.0 == 0.0 else -bit)


def weight_torques(d, place, theta1):
    """Potential energy of the imbalances and its derivatives in theta1 and q: J, N m (gravity along -Oz).

    Args:
        place: of the first imbalance (layout.imbalance). theta1: angle of link 1, rad.
    """
    _, y, z, _, y1, z1, _, _, _ = place
    if d.satellites > 1.0:
        # of several satellites what turns with the drives balances; in the planar layout all of it does
        y = y1 = 0.0
        if d.planar != 0.0:
            z = z1 = 0.0
    sine, cosine = sine_cosine(theta1)
    return (
        d.weight * (y * sine + z * cosine),
        d.weight * (y * cosine - z * sine),
        d.weight * (y1 * sine + z1 * cosine),
    )


def jams(d):
    """Tell whether the equations have no single solution at some angle, for some signs of the loads.

    With the speed given only the loss of the mesh 17-6 can do it, by the angle B of the satellite alone.
    """
    if d.satellite_loss == 0.0 and (d.by_torque == 0.0 or d.mesh_loss == 0.0):
        return False
    if d.by_torque == 0.0:
        return jams_within(d, TWO_PI / d.s, 2.0 * ANGLES)
    return jams_within(d, d.period, ANGLES * d.harmonic * min(d.period_turns, ANGLES))


def jams_within(d, length, count):
    """Tell whether they jam at one of so many angles of the drive, spread evenly over a length, rad."""
    for n in range(int(count)):
        q = length * n / count
        i, _, b, _, g, _ = reduced_inertia(d, q)
        by_alpha1 = by_rate2 = 0.0
        if d.satellite_loss != 0.0:
            # at large accelerations: what they add to the loads of all satellites
            place = imbalance(d, q, 0.0)
            _, _, by_alpha1, by_rate2 = spin_torques(d, q, place, 0.0, 0.0, 0.0, 1e150, AS_THEY_ARE)
        for signs in range(4):
            flow = -1.0 if signs < 2 else 1.0
            way = -1.0 if signs % 2 == 0 else 1.0
            passed = d.k / (1.0 - flow * d.mesh_loss)
            if jams_at(d, i, b + way * by_alpha1, g + way * by_rate2, b, passed):
                return True
    return False


def jams_at(d, i, b_q, g, b, passed):
    """Tell whether they jam at one angle and for some signs: see motion.accelerate_links."""
    k = d.k
    own2 = d.J2 + (0.0 if d.output != 0.0 else d.J3)
    if not own2 + passed * k * g > 0.0:
        return True
    if d.by_torque == 0.0:
        return False
    own1 = d.J1 + i
    phi = own1 + k * b + passed * (b_q + k * g)
    return not (phi > 0.0 and own2 * phi + passed * k * (own1 * g - b * b_q) > 0.0)
