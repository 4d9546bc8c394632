"""Torques of a motion that is prescribed, by the general equations of motion (docs/mechanics.md)."""

import math

from ..layout import imbalance
from ..links import torques
from .satellites import AS_THEY_ARE, spin_torques, weight_torques


def prescribed_torques(d, q, theta1, omega1, alpha1, omega2, alpha2):
    """Torques of this motion into d.machine: drive, mesh, housing, and journals and spun that resist q, N m.

    The inverse dynamics of the ideal machine with what acts on q besides; links 1 and 2 that turn together
    lose nothing at each other.
    """
    m = d.machine
    k = d.k
    slip = omega1 - omega2
    rate2_q = k * (alpha1 - alpha2)
    sign = math.copysign(1.0, slip) if slip != 0.0 else 0.0
    place = imbalance(d, q, 0.0)
    m.journals, mesh, by_alpha1, by_rate2 = spin_torques(
        d, q, place, omega1, k * slip, alpha1, rate2_q, AS_THEY_ARE
    )
    m.spun = mesh + by_alpha1 * alpha1 + by_rate2 * rate2_q
    _, m.weight1, m.weight_q = weight_torques(d, place, theta1)
    drive, ideal = torques(d, q, omega1, alpha1, omega2, alpha2)
    m.torque = ideal / k + m.weight_q + sign * (m.journals + m.spun)
    flow = math.copysign(abs(sign), m.torque * sign)
    m.mesh = k * m.torque / (1.0 - flow * d.mesh_loss)
    m.drive = drive - ideal + m.weight1 + m.mesh
    m.housing = 0.0
    if d.housing != 0.0 and omega2 > 0.0:
        m.housing = -d.housing_drag - d.housing_drag_viscous * omega2
