"""Where an imbalance is: position and its derivatives in q, in the frame of link 1, and its motion.

Source: Karetin (2020), equation 2, with U5 U4 put right to U3 cos(phi + psi); Lysenko, equation 1.
"""

import math

from .sine import sine_cosine, sines_cosines


def imbalance(d, q, turned):
    """An imbalance of module 0 in the frame of link 1, at the drive angle q, rad.

    Args:
        turned: angle of its satellite from satellite 0 about the axis of the drive, rad (bevel).

    Returns:
        (x, y, z, x', y', z', x'', y'', z''), m and m per rad of q to the power 1 and 2.
    """
    if d.planar != 0.0:
        sine, cosine = sine_cosine(q)
        y = d.radial * sine
        z = d.radial * cosine
        return 0.0, y, d.axial - z, 0.0, z, y, 0.0, -y, z
    sin_a, sin_b, cos_a, cos_b = sines_cosines(q + d.phase_a + turned, d.s * q + d.phase_b)
    return imbalance_at(d, sin_a, cos_a, sin_b, cos_b)


def imbalance_at(d, sin_a, cos_a, sin_b, cos_b):
    """An imbalance as above (bevel), by the sines and cosines of the angles A of its axis and B about it."""
    s = d.s
    radial = d.radial - d.radial_cos * cos_b
    tangential = -d.arm * sin_b
    radial1 = s * d.radial_cos * sin_b
    tangential1 = -s * d.arm * cos_b
    radial2 = s * s * d.radial_cos * cos_b
    tangential2 = s * s * d.arm * sin_b
    # components along and across the turning drive, differentiated with it
    along1 = radial1 - tangential
    across1 = tangential1 + radial
    along2 = radial2 - 2.0 * tangential1 - radial
    across2 = tangential2 + 2.0 * radial1 - tangential
    return (
        radial * cos_a - tangential * sin_a,
        radial * sin_a + tangential * cos_a,
        d.axial - d.axial_cos * cos_b,
        along1 * cos_a - across1 * sin_a,
        along1 * sin_a + across1 * cos_a,
        s * d.axial_cos * sin_b,
        along2 * cos_a - across2 * sin_a,
        along2 * sin_a + across2 * cos_a,
        s * s * d.axial_cos * cos_b,
    )


def to_fixed_frame(theta1, x, y, z):
    """Turn a vector of the frame of link 1 by theta1 about the central axis Ox."""
    sine = math.sin(theta1)
    cosine = math.cos(theta1)
    return x, y * cosine - z * sine, y * sine + z * cosine


def acceleration(place, omega1, alpha1, rate_q, rate2_q):
    """Absolute acceleration of an imbalance in the frame of link 1, m/s^2.

    r'' q'^2 + r' q'' + 2 w x r' q' + alpha x r + w x (w x r) with w along Ox; place: of imbalance().
    """
    _, y, z, x1, y1, z1, x2, y2, z2 = place
    square = rate_q * rate_q
    coriolis = 2.0 * omega1 * rate_q
    central = omega1 * omega1
    return (
        x2 * square + x1 * rate2_q,
        y2 * square + y1 * rate2_q - coriolis * z1 - alpha1 * z - central * y,
        z2 * square + z1 * rate2_q + coriolis * y1 + alpha1 * y - central * z,
    )


def imbalance_in_fixed_frame(d, q, theta1, omega1, alpha1, rate_q, rate2_q, turned):
    """Position, velocity and acceleration of an imbalance of module 0 in the fixed frame Oxyz.

    Args:
        turned: angle of its satellite from satellite 0, rad, about the axis of the drive (bevel) or Ox.

    Returns:
        nine doubles: position (m), velocity (m/s), acceleration (m/s^2).
    """
    if d.planar != 0.0:
        theta1 += turned
    place = imbalance(d, q, turned)
    x, y, z, x1, y1, z1, _, _, _ = place
    px, py, pz = to_fixed_frame(theta1, x, y, z)
    vx, vy, vz = to_fixed_frame(theta1, x1 * rate_q, y1 * rate_q - omega1 * z, z1 * rate_q + omega1 * y)
    ax, ay, az = acceleration(place, omega1, alpha1, rate_q, rate2_q)
    ax, ay, az = to_fixed_frame(theta1, ax, ay, az)
    return px, py, pz, vx, vy, vz, ax, ay, az
