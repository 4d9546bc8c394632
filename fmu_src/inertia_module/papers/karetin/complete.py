"""All of Karetin's quantities at once, (2)-(33), for many times."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import exact
from .geometry import Geometry
from .motion import Motion
from .projections import angles, angular_velocities, arms, feet, projections

Array = NDArray[np.float64]

# so many times at once that what is needed of them stays in the cache of the processor
BLOCK = 4096


@dataclass(frozen=True)
class Kinematics:
    """The exact set at n times, in the fixed frame unless said otherwise; shape (n, 3) or (n,).

    Attributes:
        position, radius: r_D and its length, m: (2), (3).
        projections: OH, OP, OF, m: (4).
        angles: beta_H, beta_P, beta_F, rad: (5).
        angular_velocities: omega_H, omega_P, omega_F, rad/s: (6).
        about_satellite, about_drive, about_centre: V_QA, V_Oz, V_Ox along the axes of the frame that
            carries OQ, m/s: (11), (15), (22).
        speed_about_satellite, speed_about_drive, speed_about_centre: their moduli, m/s: (12), (16).
        velocity_in_link1, speed_in_link1: V_D Sigma in that frame, m/s: (17), (18).
        velocity, speed: the absolute velocity, m/s: (24), (25).
        feet: x_L, y_L, y_M, z_M, x_N, z_N, m, shape (n, 6): (26), (30), (31).
        arms: OL, OM, ON, m: (28), (30), (31).
        plane_speeds: V on xOy, yOz and xOz, m/s: (29), (30), (31).
        acceleration, acceleration_modulus: m/s^2: (32), (33).
    """

    position: Array
    radius: Array
    projections: Array
    angles: Array
    angular_velocities: Array
    about_satellite: Array
    about_drive: Array
    about_centre: Array
    speed_about_satellite: Array
    speed_about_drive: Array
    speed_about_centre: Array
    velocity_in_link1: Array
    speed_in_link1: Array
    velocity: Array
    speed: Array
    feet: Array
    arms: Array
    plane_speeds: Array
    acceleration: Array
    acceleration_modulus: Array


NAMES = tuple(field.name for field in fields(Kinematics))


def kinematics(geometry: Geometry, motion: Motion, t: ArrayLike) -> Kinematics:
    """The exact set at the times t.

    Args:
        geometry: of the mechanism.
        motion: speeds of its links.
        t: times, s, shape (n,).

    Raises:
        ValueError: times that are not of shape (n,), not finite or too long, with what is allowed.
    """
    times = exact.checked_times(geometry, motion, t)
    whole: dict[str, Array] = {}
    for begin in range(0, max(len(times), 1), BLOCK):
        part = _block(geometry, motion, times[begin : begin + BLOCK])
        for name in NAMES:
            values = getattr(part, name)
            if begin == 0:
                whole[name] = np.empty((*values.shape[1:], len(times))).T
            whole[name][begin : begin + BLOCK] = values
    return Kinematics(**whole)


def _block(geometry: Geometry, motion: Motion, t: Array) -> Kinematics:
    at = exact.configuration(geometry, motion, t)
    r = exact.position(at)
    about_satellite = exact.velocity_about_satellite(at)
    about_drive = exact.velocity_about_drive(at)
    about_centre = exact.velocity_about_centre(at)
    in_link1 = about_satellite + about_drive
    v = exact.turned(at, in_link1 + about_centre)
    a = exact.turned(at, exact.acceleration_in_link1(at, about_satellite))
    foot = feet(r, v)
    return Kinematics(
        position=r,
        radius=exact.modulus(r),
        projections=projections(r),
        angles=angles(r),
        angular_velocities=angular_velocities(r, v),
        about_satellite=about_satellite,
        about_drive=about_drive,
        about_centre=about_centre,
        speed_about_satellite=exact.modulus(about_satellite),
        speed_about_drive=exact.modulus(about_drive),
        speed_about_centre=exact.modulus(about_centre),
        velocity_in_link1=in_link1,
        speed_in_link1=exact.modulus(in_link1),
        velocity=v,
        speed=exact.modulus(v),
        feet=foot,
        arms=arms(foot),
        plane_speeds=projections(v),
        acceleration=a,
        acceleration_modulus=exact.modulus(a),
    )
