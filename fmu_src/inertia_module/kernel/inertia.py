"""Reduced inertia I, B, G of all imbalances and its exact derivatives in q (docs/mechanics.md)."""

from .layout import imbalance_at
from .sine import sine_cosine, sines_cosines


def reduced_inertia(d, q):
    """I = sum m (y^2 + z^2), B = sum m (y z' - z y'), G = sum m |r'|^2 + J16, and the satellite gears' own.

    The sums over the satellites of a module are closed: with two or more spread evenly B vanishes,
    with three or more the harmonics of A vanish from I. Modules are alike about the central axis.
    In the planar layout the drive turns about an axis parallel to the central one, so its own
    inertia J16 is carried by link 1 as well: it enters I and B as it enters G. What the turning gears add
    at every angle is in J1 and J16.

    Returns:
        (I, I', B, B', G, G') at the drive angle q, kg m^2 and kg m^2 per rad of q.
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
    spin = d.spin
    g = mass * (spin * sin_b * sin_b + pole * pole) + d.J16
    g1 = 2.0 * mass * s * sin_b * (spin * cos_b + pole * pole_arm)
    x, y, z, x1, y1, z1, _, y2, z2 = imbalance_at(d, sin_a, cos_a, sin_b, cos_b)
    if d.satellites > 2.0:
        i = mass * (0.5 * (x * x + y * y) + z * z)
        i1 = mass * (x * x1 + y * y1 + 2.0 * z * z1)
        return i, i1, 0.0, 0.0, g, g1
    i = mass * (y * y + z * z)
    i1 = 2.0 * mass * (y * y1 + z * z1)
    if d.bodies != 0.0:
        i += d.body_i * cos_a * cos_a
        i1 -= 2.0 * d.body_i * cos_a * sin_a
    if d.satellites > 1.0:
        return i, i1, 0.0, 0.0, g, g1
    b = mass * (y * z1 - z * y1)
    b1 = mass * (y * z2 - z * y2)
    if d.bodies != 0.0:
        b += d.body_b * cos_a
        b1 -= d.body_b * sin_a
    return i, i1, b, b1, g, g1
