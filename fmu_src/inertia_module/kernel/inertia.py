"""Reduced inertia I, B, G of all imbalances and its derivatives in q in closed form (mechanics.md)."""

from .layout import bevel_imbalance_position
from .records import Constants, ReducedInertia
from .sine import sine_cosine, sines_cosines


def reduced_inertia(d: Constants, q: float) -> ReducedInertia:
    """Return the reduced inertia of imbalances, pinion shafts and satellite gears, and its derivatives in q.

        I = sum m (y^2 + z^2)        B = sum m (y z' - z y')        G = sum m |r'|^2 + J16

    - The sums over the evenly spaced satellites of a module have a closed form. B is 0 for two or more
      satellites; for three or more, I does not depend on the angle A.
    - All modules have the same I, B and G.
    - In the planar layout the pinion shaft is parallel to the central axis, so J16 is part of I, B and G.
    - The terms of the satellite gears that do not depend on q are part of J1 and J16 (parameters.py).

    Args:
        d: Constants.
        q: Pinion-shaft angle, rad.

    Returns:
        (I, I', B, B', G, G'): kg m^2 and kg m^2/rad.
    """
    mass = d.mass
    if d.planar != 0.0:
        arm = d.radial
        centre = d.axial
        swing = mass * arm * centre
        sine, cosine = sine_cosine(q)
        sine *= swing
        cosine *= swing
        own = mass * arm * arm + d.J16
        fixed = own + mass * centre * centre
        return fixed - 2.0 * cosine, 2.0 * sine, own - cosine, sine, own, 0.0
    s = d.s
    half = 0.5 * s * q + 0.5 * d.phase_b
    sin_a, cos_a = 0.0, 1.0
    if d.satellites > 2.0:
        sin_half, cos_half = sine_cosine(half)
    else:
        sin_half, sin_a, cos_half, cos_a = sines_cosines(half, q + d.phase_a)
    sin_b = 2.0 * sin_half * cos_half
    versed = 2.0 * sin_half * sin_half  # 1 - cos B, without cancellation at the rolling pole
    cos_b = 1.0 - versed
    pole_arm = d.pole_arm
    pole = d.pole_offset + pole_arm * versed
    spin = d.spin_square
    g = mass * (spin * sin_b * sin_b + pole * pole) + d.J16
    g1 = 2.0 * mass * s * sin_b * (spin * cos_b + pole * pole_arm)
    x, y, z, x1, y1, z1, _, y2, z2 = bevel_imbalance_position(d, sin_a, cos_a, sin_b, cos_b)
    if d.satellites > 2.0:
        i = mass * (0.5 * (x * x + y * y) + z * z)
        i1 = mass * (x * x1 + y * y1 + 2.0 * z * z1)
        return i, i1, 0.0, 0.0, g, g1
    i = mass * (y * y + z * z)
    i1 = 2.0 * mass * (y * y1 + z * z1)
    if d.gear_inertia != 0.0:
        i += d.gear_i * cos_a * cos_a
        i1 -= 2.0 * d.gear_i * cos_a * sin_a
    if d.satellites > 1.0:
        return i, i1, 0.0, 0.0, g, g1
    b = mass * (y * z1 - z * y1)
    b1 = mass * (y * z2 - z * y2)
    if d.gear_inertia != 0.0:
        b += d.gear_b * cos_a
        b1 -= d.gear_b * sin_a
    return i, i1, b, b1, g, g1
