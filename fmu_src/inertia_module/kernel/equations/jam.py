"""Tell whether the meshes would jam: friction that grows faster with a torque than what the torque can do.

Where the losses are large and links light, no motion, or more than one, agrees with the loads.
"""

import math

from ..derive import TWO_PI
from ..inertia import reduced_inertia
from ..layout import imbalance
from .satellites import AS_THEY_ARE, spin_torques

# angles in one turn at which it is looked at, for each of its highest harmonics; turns looked at
ANGLES = 64


def jams(d):
    """Tell whether the equations have no single solution at some angle, for some signs of the loads.

    With the speed given only the loss of the mesh 17-6 can do it, by the angle B of the satellite alone.
    """
    if d.satellite_loss == 0.0 and (d.by_torque == 0.0 or d.mesh_loss == 0.0):
        return False
    if d.by_torque == 0.0:
        return jams_between(d, 0.0, TWO_PI / d.s, 2.0 * ANGLES)
    # of many turns those that are so many places of B apart
    places = float(math.ceil(d.period_turns / ANGLES))
    apart = places * turns_to_next_place(d)
    for n in range(int(math.ceil(d.period_turns / places))):
        begin = TWO_PI * (n * apart % d.period_turns)
        if jams_between(d, begin, TWO_PI, ANGLES * d.harmonic):
            return True
    return False


def turns_to_next_place(d):
    """Turns of the drive after which the angle B, at its beginning, is one place further.

    Over a period B stands at so many even places as the period has turns, once at each: n z17/z6 turns.
    """
    ahead = float(math.floor(d.s * d.period_turns + 0.5))
    turns = 1.0
    while turns * ahead % d.period_turns > 1.0:
        turns += 1.0
    return turns


def jams_between(d, begin, length, count):
    """Tell whether they jam at one of so many angles of the drive from begin on, rad."""
    for n in range(int(count)):
        q = begin + length * n / count
        i, _, b, _, g, _ = reduced_inertia(d, q)
        by_alpha1 = by_rate2 = 0.0
        if d.satellite_loss != 0.0:
            # at large accelerations: what they add to the loads of all satellites
            place = imbalance(d, q, 0.0)
            _, _, by_alpha1, by_rate2 = spin_torques(d, q, place, 0.0, 0.0, 0.0, 1e150, AS_THEY_ARE)
        for flow in (-1.0, 1.0):
            for way in (-1.0, 1.0):
                if jams_at(
                    d, i, b + way * by_alpha1, g + way * by_rate2, b, d.k / (1.0 - flow * d.mesh_loss)
                ):
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
