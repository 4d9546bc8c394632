"""Motion of the imbalance D by closed form: Karetin, equations (2), (7)-(25), (32), (33), put right.

Two frames: that of link 1, which carries OQ on its z axis, and the fixed frame Oxyz. They differ by the
turn theta = omega1 t about Ox; in the paper's stop mode they are one. Everything is vectorised over time:
times of shape (n,) give points and vectors of shape (n, 3), laid out by component.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .geometry import Geometry
from .motion import Motion, transmission_ratios
from .phase import Times, Turning

Array = NDArray[np.float64]


def vectors(x: Array, y: Array, z: Array) -> Array:
    """Vectors, shape (n, 3), of components of shape (n,), each component in one piece of memory."""
    whole = np.empty((3, len(x)))
    whole[0], whole[1], whole[2] = x, y, z
    return whole.T


def modulus(v: Array) -> Array:
    """Length of vectors: equations (3), (12), (16), (18), (25) and (33).

    Args:
        v: shape (n, 3), any unit.

    Returns:
        shape (n,), same unit.
    """
    square = v[:, 0] * v[:, 0]
    square += v[:, 1] * v[:, 1]
    square += v[:, 2] * v[:, 2]
    result: Array = np.sqrt(square, out=square)
    return result


@dataclass(frozen=True)
class Configuration:
    """Where the links stand: all that the formulas need, every sine and cosine taken once.

    Attributes:
        geometry, motion: of the mechanism. omega16, omega6: speeds of equation (1), rad/s.
        sin_a, cos_a: of the angle A = omega16 t + gamma of the drive in link 1, shape (n,).
        sin_b, cos_b: of the angle B = omega6 t + epsilon of the satellite on the drive, shape (n,).
        sin_theta, cos_theta: of the angle of the frame that carries OQ about Ox, shape (n,).
        x, y, z: D in that frame, m, shape (n,): equation (2).
    """

    geometry: Geometry
    motion: Motion
    omega16: float
    omega6: float
    sin_a: Array
    cos_a: Array
    sin_b: Array
    cos_b: Array
    sin_theta: Array
    cos_theta: Array
    x: Array
    y: Array
    z: Array


def checked_times(geometry: Geometry, motion: Motion, t: ArrayLike) -> Array:
    """The times as doubles.

    Raises:
        ValueError: not of shape (n,), not finite, or so long that doubles no longer resolve an angle.
    """
    times = np.asarray(t, dtype=np.float64)
    if times.ndim != 1:
        raise ValueError(f"t of shape {times.shape} is refused: allowed is shape (n,)")
    longest = min(turning.longest_time for turning in turnings(geometry, motion))
    refused = ~(np.abs(times) <= longest) | ~np.isfinite(times)
    if refused.any():
        value = times[refused][0]
        raise ValueError(f"t = {value:.16g} is refused: allowed is from {-longest:.16g} to {longest:.16g} s")
    return times


def turnings(geometry: Geometry, motion: Motion) -> tuple[Turning, Turning, Turning]:
    """Angles A of the drive, B of the satellite and theta of the frame that carries OQ."""
    drive = motion.drive_rate(geometry)
    return (
        Turning.at(drive, geometry.gamma),
        Turning.at(geometry.satellite_ratio * drive, geometry.epsilon),
        Turning.at(Fraction(motion.carrier)),
    )


def configuration(geometry: Geometry, motion: Motion, t: ArrayLike) -> Configuration:
    """Angles of the links and the place of D in the frame that carries OQ.

    Equation (2) with U5 U4 put right to U3 cos(chi). Right to 1e-15 of the reach for all times
    accepted: the angles are reduced without losing digits.

    Args:
        geometry: of the mechanism.
        motion: speeds of its links.
        t: times, s, shape (n,).

    Raises:
        ValueError: bad times, see checked_times.
    """
    times = Times.of(checked_times(geometry, motion, t))
    a, b, theta = (turning.angle(times) for turning in turnings(geometry, motion))
    _, omega16, omega6 = transmission_ratios(geometry, motion)
    g = geometry
    sine, cosine = np.sin(g.shaft_angle), np.cos(g.shaft_angle)
    sin_a, cos_a, sin_b, cos_b = np.sin(a), np.cos(a), np.sin(b), np.cos(b)
    radial = g.across - (g.AD * cosine) * cos_b
    tangential = -g.AD * sin_b
    return Configuration(
        g,
        motion,
        omega16,
        omega6,
        sin_a,
        cos_a,
        sin_b,
        cos_b,
        np.sin(theta),
        np.cos(theta),
        radial * cos_a - tangential * sin_a,
        radial * sin_a + tangential * cos_a,
        g.height - (g.AD * sine) * cos_b,
    )


def turned(at: Configuration, v: Array) -> Array:
    """Vectors of the frame that carries OQ in the fixed frame: what (24) should be, Rx(theta) v.

    Args:
        at: configuration at n times.
        v: shape (n, 3), any unit.

    Returns:
        shape (n, 3), same unit.
    """
    y, z = v[:, 1], v[:, 2]
    return vectors(v[:, 0], y * at.cos_theta - z * at.sin_theta, y * at.sin_theta + z * at.cos_theta)


def position_in_link1(at: Configuration) -> Array:
    """D in the frame that carries OQ, m, shape (n, 3): equation (2), the stop mode."""
    return vectors(at.x, at.y, at.z)


def position(at: Configuration) -> Array:
    """D in the fixed frame, m, shape (n, 3): equation (2), turned by theta in the dynamic mode."""
    return turned(at, position_in_link1(at))


def centre_of_satellite(at: Configuration) -> Array:
    """Point A, foot of D on the axis of the satellite, in the frame that carries OQ, m, shape (n, 3)."""
    g = at.geometry
    return vectors(g.across * at.cos_a, g.across * at.sin_a, np.full_like(at.x, g.height))


def arm_of_imbalance(at: Configuration) -> Array:
    """Vector AD in the frame that carries OQ, m, shape (n, 3): equation (8).

    Written out rather than as a difference, so that it is exact however short AD is against QA.
    """
    g = at.geometry
    along = -(g.AD * np.cos(g.shaft_angle)) * at.cos_b
    across = -g.AD * at.sin_b
    return vectors(
        along * at.cos_a - across * at.sin_a,
        along * at.sin_a + across * at.cos_a,
        -(g.AD * np.sin(g.shaft_angle)) * at.cos_b,
    )


def spin_of_satellite(at: Configuration) -> Array:
    """Vector omega6 of the satellite on the drive, rad/s, shape (n, 3): equations (9), (10) put right.

    It points from A to Q, against what (9) prints, and there is no division: it exists also for QA = 0.
    """
    sine, cosine = np.sin(at.geometry.shaft_angle), np.cos(at.geometry.shaft_angle)
    return vectors(
        -(at.omega6 * sine) * at.cos_a,
        -(at.omega6 * sine) * at.sin_a,
        np.full_like(at.x, at.omega6 * cosine),
    )


def velocity_about_satellite(at: Configuration) -> Array:
    """V_QA = omega6 x AD in the frame that carries OQ, m/s, shape (n, 3): equation (11) put right."""
    g = at.geometry
    speed = at.omega6 * g.AD
    along = (speed * np.cos(g.shaft_angle)) * at.sin_b
    across = -speed * at.cos_b
    return vectors(
        along * at.cos_a - across * at.sin_a,
        along * at.sin_a + across * at.cos_a,
        (speed * np.sin(g.shaft_angle)) * at.sin_b,
    )


def velocity_about_drive(at: Configuration) -> Array:
    """V_Oz = omega16 x r in the frame that carries OQ, m/s, shape (n, 3): (13)-(15) put right."""
    return vectors(-at.omega16 * at.y, at.omega16 * at.x, np.zeros_like(at.x))


def velocity_about_centre(at: Configuration) -> Array:
    """V_Ox = omega1 x r in the frame that carries OQ, m/s, shape (n, 3): (20)-(22) put right."""
    speed = at.motion.carrier
    return vectors(np.zeros_like(at.x), -speed * at.z, speed * at.y)


def velocity_in_link1(at: Configuration) -> Array:
    """V_D Sigma of the stop mode: against the frame that carries OQ, m/s, shape (n, 3): (7), (17)."""
    return velocity_about_satellite(at) + velocity_about_drive(at)


def velocity(at: Configuration) -> Array:
    """Absolute velocity of D in the fixed frame, m/s, shape (n, 3): (23) and (24) put right."""
    return turned(at, velocity_in_link1(at) + velocity_about_centre(at))


def acceleration(at: Configuration) -> Array:
    """Absolute acceleration of D in the fixed frame, m/s^2, shape (n, 3): equation (32) in closed form.

    Of the satellite, of the drive and of link 1 each the centripetal part, between them the Coriolis
    parts: omega6^2 AD'' + 2 omega16 x V_QA + omega16 x V_Oz + 2 omega1 x V_D Sigma + omega1 x V_Ox.
    """
    return turned(at, acceleration_in_link1(at, velocity_about_satellite(at)))


def acceleration_in_link1(at: Configuration, about_satellite: Array) -> Array:
    """Absolute acceleration along the axes of the frame that carries OQ, m/s^2, shape (n, 3).

    Args:
        at: configuration at n times.
        about_satellite: V_QA there, m/s, shape (n, 3).
    """
    g, w16, w1 = at.geometry, at.omega16, at.motion.carrier
    central = at.omega6 * at.omega6 * g.AD
    along = (central * np.cos(g.shaft_angle)) * at.cos_b
    across = central * at.sin_b
    vx, vy, vz = about_satellite.T
    twice, square, frame = 2.0 * w16, w16 * w16, w1 * w1
    return vectors(
        along * at.cos_a - across * at.sin_a - twice * vy - square * at.x,
        along * at.sin_a + across * at.cos_a + twice * vx - (square + frame) * at.y - (2.0 * w1) * vz,
        (central * np.sin(g.shaft_angle)) * at.cos_b + (2.0 * w1) * (vy + w16 * at.x) - frame * at.z,
    )
