"""Motion of the imbalance D by closed form: Karetin, equations (2)-(33), put right.

Two frames: that of link 1, which carries OQ on its z axis, and the fixed frame Oxyz. They differ by the
turn theta = omega1 t about Ox; in the paper's stop mode they are one.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import projections
from .geometry import Geometry
from .motion import Motion, transmission_ratios
from .phase import Times, Turning
from .projections import vectors

Array = NDArray[np.float64]


def modulus(v: Array) -> Array:
    """Length of vectors of shape (n, 3): equations (3), (12), (16), (18), (25) and (33)."""
    result: Array = np.sqrt((v * v).sum(axis=1))
    return result


def _modulus_of(name: str) -> cached_property[Array]:
    return cached_property(lambda self: modulus(getattr(self, name)))


def turnings(geometry: Geometry, motion: Motion) -> tuple[Turning, Turning, Turning]:
    """Angles A of the drive, B of the satellite and theta of the frame that carries OQ."""
    drive = motion.drive_rate(geometry)
    return (
        Turning.at(drive, geometry.gamma),
        Turning.at(geometry.satellite_ratio * drive, geometry.epsilon),
        Turning.at(Fraction(motion.carrier)),
    )


def checked_times(geometry: Geometry, motion: Motion, t: ArrayLike) -> Array:
    """The times as doubles.

    Raises:
        ValueError: not of shape (n,), not finite, or so long that doubles no longer resolve an angle.
    """
    times = np.asarray(t, dtype=np.float64)
    if times.ndim != 1:
        raise ValueError(f"t must be of shape (n,), is of shape {times.shape}")
    longest = min(turning.longest_time for turning in turnings(geometry, motion))
    wrong = times[~(np.abs(times) <= longest) | ~np.isfinite(times)]
    if wrong.size:
        raise ValueError(f"t must be from {-longest:.16g} to {longest:.16g} s, is {wrong[0]:.16g}")
    return times


class Kinematics:
    """All of Karetin's quantities at n times; each is worked out when it is first asked for.

    Right to 1e-15 of the reach for all times accepted: the angles are reduced without losing digits.

    Args:
        geometry: of the mechanism. motion: speeds of its links. t: times, s, shape (n,).

    Attributes:
        t: times, s, shape (n,). omega16, omega6: speeds of equation (1), rad/s.

    Vectors are of shape (n, 3), lengths of shape (n,); in SI units.

    Raises:
        ValueError: bad times, see checked_times.
    """

    def __init__(self, geometry: Geometry, motion: Motion, t: ArrayLike) -> None:
        self.geometry, self.motion = geometry, motion
        self.t = checked_times(geometry, motion, t)
        times = Times.of(self.t)
        a, b, theta = (turning.angle(times) for turning in turnings(geometry, motion))
        _, self.omega16, self.omega6 = transmission_ratios(geometry, motion)
        self._sin_a, self._cos_a, self._sin_b, self._cos_b = np.sin(a), np.cos(a), np.sin(b), np.cos(b)
        self._sin_theta, self._cos_theta = np.sin(theta), np.cos(theta)
        self._sine, self._cosine = np.sin(geometry.shaft_angle), np.cos(geometry.shaft_angle)

    def turned(self, v: Array) -> Array:
        """Vectors of the frame that carries OQ in the fixed frame: what (24) should be, Rx(theta) v."""
        x, y, z = v.T
        return vectors(
            x, y * self._cos_theta - z * self._sin_theta, y * self._sin_theta + z * self._cos_theta
        )

    def _with_drive(self, radial: Array | float, tangential: Array | float, along: Array | float) -> Array:
        """Vectors of the drive, by its angle A, in the frame that carries OQ."""
        return vectors(
            radial * self._cos_a - tangential * self._sin_a,
            radial * self._sin_a + tangential * self._cos_a,
            along,
        )

    # --- in the frame that carries OQ ---

    @cached_property
    def position_in_link1(self) -> Array:
        """D, m: equation (2), with U5 U4 put right to U3 cos(chi)."""
        g = self.geometry
        radial = g.across - (g.AD * self._cosine) * self._cos_b
        return self._with_drive(radial, -g.AD * self._sin_b, g.height - (g.AD * self._sine) * self._cos_b)

    @property
    def centre_of_satellite(self) -> Array:
        """Point A, foot of D on the axis of the satellite, m."""
        return self._with_drive(self.geometry.across, 0.0, self.geometry.height)

    @property
    def arm_of_imbalance(self) -> Array:
        """Vector AD, m: equation (8); not as a difference, so exact however short it is against QA."""
        arm = -self.geometry.AD
        along, across = (arm * self._cosine) * self._cos_b, (arm * self._sine) * self._cos_b
        return self._with_drive(along, arm * self._sin_b, across)

    @property
    def spin_of_satellite(self) -> Array:
        """Vector omega6 of the satellite on the drive, rad/s: (9), (10) put right.

        It points from A to Q, against what (9) prints, and there is no division: it exists for QA = 0.
        """
        return self._with_drive(-self.omega6 * self._sine, 0.0, self.omega6 * self._cosine)

    @cached_property
    def about_satellite(self) -> Array:
        """V_QA = omega6 x AD, m/s: equation (11) put right."""
        speed = self.omega6 * self.geometry.AD
        along, across = (speed * self._cosine) * self._sin_b, (speed * self._sine) * self._sin_b
        return self._with_drive(along, -speed * self._cos_b, across)

    @cached_property
    def about_drive(self) -> Array:
        """V_Oz = omega16 x r, m/s: (13)-(15) put right."""
        x, y, _ = self.position_in_link1.T
        return vectors(-self.omega16 * y, self.omega16 * x, 0.0)

    @cached_property
    def about_centre(self) -> Array:
        """V_Ox = omega1 x r, m/s: (20)-(22) put right."""
        _, y, z = self.position_in_link1.T
        return vectors(0.0, -self.motion.carrier * z, self.motion.carrier * y)

    @cached_property
    def velocity_in_link1(self) -> Array:
        """V_D Sigma of the stop mode, against the frame that carries OQ, m/s: (7), (17)."""
        return self.about_satellite + self.about_drive

    @property
    def _acceleration_in_link1(self) -> Array:
        """Absolute acceleration, m/s^2.

        Of the satellite, of the drive and of link 1 each the centripetal part, between them the Coriolis
        parts: omega6^2 AD + 2 omega16 x V_QA + omega16 x V_Oz + 2 omega1 x V_D Sigma + omega1 x V_Ox.
        """
        w16, w1 = self.omega16, self.motion.carrier
        x, y, z = self.position_in_link1.T
        vx, vy, vz = self.about_satellite.T
        ax, ay, az = -self.omega6 * self.omega6 * self.arm_of_imbalance.T
        return vectors(
            ax - 2.0 * w16 * vy - w16 * w16 * x,
            ay + 2.0 * w16 * vx - (w16 * w16 + w1 * w1) * y - 2.0 * w1 * vz,
            az + 2.0 * w1 * (vy + w16 * x) - w1 * w1 * z,
        )

    # --- in the fixed frame ---

    @cached_property
    def position(self) -> Array:
        """r_D, m: equation (2), turned by theta in the dynamic mode."""
        return self.turned(self.position_in_link1)

    @cached_property
    def velocity(self) -> Array:
        """Absolute velocity, m/s: (23) and (24) put right."""
        return self.turned(self.velocity_in_link1 + self.about_centre)

    @cached_property
    def acceleration(self) -> Array:
        """Absolute acceleration, m/s^2: equation (32) in closed form."""
        return self.turned(self._acceleration_in_link1)

    @cached_property
    def projections(self) -> Array:
        """OH, OP, OF, m: equation (4)."""
        return projections.projections(self.position)

    @cached_property
    def angles(self) -> Array:
        """beta_H, beta_P, beta_F, rad: equation (5) put right."""
        return projections.angles(self.position)

    @cached_property
    def angular_velocities(self) -> Array:
        """omega_H, omega_P, omega_F, rad/s: equation (6) in closed form."""
        return projections.angular_velocities(self.position, self.velocity)

    @cached_property
    def feet(self) -> Array:
        """x_L, y_L, y_M, z_M, x_N, z_N, m, shape (n, 6): (26), (30), (31)."""
        return projections.feet(self.position, self.velocity)

    @cached_property
    def arms(self) -> Array:
        """OL, OM, ON, m: (28), (30), (31)."""
        return projections.arms(self.feet)

    @cached_property
    def plane_speeds(self) -> Array:
        """V on xOy, yOz and xOz, m/s: (29), (30), (31)."""
        return projections.projections(self.velocity)

    # --- lengths, SI units: (3), (12), (16), of V_Ox, (18), (25) and (33) ---

    radius = _modulus_of("position")
    speed_about_satellite = _modulus_of("about_satellite")
    speed_about_drive = _modulus_of("about_drive")
    speed_about_centre = _modulus_of("about_centre")
    speed_in_link1 = _modulus_of("velocity_in_link1")
    speed = _modulus_of("velocity")
    acceleration_modulus = _modulus_of("acceleration")


# all of the set
NAMES = tuple(name for name, value in vars(Kinematics).items() if isinstance(value, cached_property))
