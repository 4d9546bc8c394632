"""Position of an imbalance and its derivatives in q in the frame of link 1, and its motion.

Source: Karetin (2020), equation 2, with U5 U4 corrected to U3 cos(phi + psi); Lysenko, equation 1.
"""

import math

from .records import Constants, Position
from .sine import sine_cosine, sines_cosines


def imbalance_position(d: Constants, q: float, azimuth: float) -> Position:
    """Return the position of an imbalance of module 0 in the frame of link 1, and its derivatives in q.

    Args:
        d: Constants.
        q: Pinion-shaft angle, rad.
        azimuth: Angle of the satellite from satellite 0 about the pinion shaft, rad (bevel layout only).

    Returns:
        (x, y, z, x', y', z', x'', y'', z''): m, m/rad and m/rad^2.
    """
    if d.planar != 0.0:
        sine, cosine = sine_cosine(q)
        y = d.radial * sine
        z = d.radial * cosine
        return 0.0, y, d.axial - z, 0.0, z, y, 0.0, -y, z
    sin_a, sin_b, cos_a, cos_b = sines_cosines(q + d.phase_a + azimuth, d.s * q + d.phase_b)
    return bevel_imbalance_position(d, sin_a, cos_a, sin_b, cos_b)


def bevel_imbalance_position(
    d: Constants, sin_a: float, cos_a: float, sin_b: float, cos_b: float
) -> Position:
    """Return the position of a bevel imbalance and its derivatives in q from two angles.

    A is the angle of the satellite axis about the pinion shaft, B the angle of the imbalance about that axis:
    A' = 1, B' = s. The radial and tangential components rotate with A.

    Args:
        d: Constants.
        sin_a: Sine of A.
        cos_a: Cosine of A.
        sin_b: Sine of B.
        cos_b: Cosine of B.

    Returns:
        (x, y, z, x', y', z', x'', y'', z''): m, m/rad and m/rad^2.
    """
    s = d.s
    radial = d.radial - d.radial_cos * cos_b
    tangential = -d.arm * sin_b
    radial1 = s * d.radial_cos * sin_b
    tangential1 = -s * d.arm * cos_b
    radial2 = s * s * d.radial_cos * cos_b
    tangential2 = s * s * d.arm * sin_b
    # First and second derivatives along the rotating axes
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


def to_fixed_frame(theta1: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Rotate a vector of the frame of link 1 by ``theta1``, rad, about the central axis Ox."""
    sine = math.sin(theta1)
    cosine = math.cos(theta1)
    return x, y * cosine - z * sine, y * sine + z * cosine


def imbalance_acceleration(
    position: Position,
    omega1: float,
    alpha1: float,
    rate_q: float,
    rate2_q: float,
) -> tuple[float, float, float]:
    """Return the absolute acceleration of an imbalance in the frame of link 1, m/s^2.

        a = r'' q'^2 + r' q'' + 2 w x r' q' + alpha x r + w x (w x r)        w, alpha: of link 1, along Ox

    Args:
        position: Result of imbalance_position, m and m/rad^n.
        omega1: Speed of link 1, rad/s.
        alpha1: Acceleration of link 1, rad/s^2.
        rate_q: q', rad/s.
        rate2_q: q'', rad/s^2.
    """
    _, y, z, x1, y1, z1, x2, y2, z2 = position
    square = rate_q * rate_q
    coriolis = 2.0 * omega1 * rate_q
    central = omega1 * omega1
    return (
        x2 * square + x1 * rate2_q,
        y2 * square + y1 * rate2_q - coriolis * z1 - alpha1 * z - central * y,
        z2 * square + z1 * rate2_q + coriolis * y1 + alpha1 * y - central * z,
    )


def imbalance_motion(
    d: Constants,
    q: float,
    theta1: float,
    omega1: float,
    alpha1: float,
    rate_q: float,
    rate2_q: float,
    azimuth: float,
) -> Position:
    """Return position, velocity and acceleration of an imbalance of module 0 in the fixed frame Oxyz.

    Args:
        d: Constants.
        q: Pinion-shaft angle, rad.
        theta1: Angle of link 1, rad.
        omega1: Speed of link 1, rad/s.
        alpha1: Acceleration of link 1, rad/s^2.
        rate_q: q', rad/s.
        rate2_q: q'', rad/s^2.
        azimuth: Angle of the satellite from satellite 0 about the pinion shaft (bevel) or Ox (planar), rad.

    Returns:
        Nine doubles: position (m), velocity (m/s), acceleration (m/s^2).
    """
    if d.planar != 0.0:
        theta1 += azimuth
    position = imbalance_position(d, q, azimuth)
    x, y, z, x1, y1, z1, _, _, _ = position
    px, py, pz = to_fixed_frame(theta1, x, y, z)
    vx, vy, vz = to_fixed_frame(theta1, x1 * rate_q, y1 * rate_q - omega1 * z, z1 * rate_q + omega1 * y)
    ax, ay, az = imbalance_acceleration(position, omega1, alpha1, rate_q, rate2_q)
    ax, ay, az = to_fixed_frame(theta1, ax, ay, az)
    return px, py, pz, vx, vy, vz, ax, ay, az
