"""Whether the meshes would jam: friction that grows faster with a torque than what the torque can do.

Where the losses are large and links light, no motion, or more than one, agrees with the loads.
"""

from ..inertia import reduced_inertia
from ..layout import imbalance
from .satellites import spin_torques

# angles in one period of the motion at which it is looked at, for each of its highest harmonics
ANGLES = 64


def jams(d):
    """Whether the equations of motion have no single solution at some angle, for some signs of the loads."""
    if d.mesh_loss + d.satellite_loss == 0.0:
        return False
    count = int(ANGLES * d.harmonic * d.period_turns)
    for n in range(count):
        q = d.period * n / count
        i, _, _, b, _, g, _, _ = reduced_inertia(d, q)
        by_alpha1 = by_rate2 = 0.0
        if d.satellite_loss != 0.0:
            # at large accelerations: what they add to the loads of all satellites
            place = imbalance(d, q, 0.0)
            _, _, by_alpha1, by_rate2 = spin_torques(d, q, place, 0.0, 0.0, 0.0, 1e150, True)
        for flow in (-1.0, 1.0):
            for way in (-1.0, 1.0):
                if jams_at(
                    d, i, b + way * by_alpha1, g + way * by_rate2, b, d.k / (1.0 - flow * d.mesh_loss)
                ):
                    return True
    return False


def jams_at(d, i, b_q, g, b, passed):
    """The same at one angle and for some signs: see motion.accelerate_links."""
    k = d.k
    own2 = d.J2 + (0.0 if d.output != 0.0 else d.J3)
    if not own2 + passed * k * g > 0.0:
        return True
    if d.by_torque == 0.0:
        return False
    own1 = d.J1 + i
    phi = own1 + k * b + passed * (b_q + k * g)
    return not (phi > 0.0 and own2 * phi + passed * k * (own1 * g - b * b_q) > 0.0)
