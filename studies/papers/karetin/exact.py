"""Motion of the imbalance D by closed form: Karetin, equations (1)-(33), put right.

Two frames: that of link 1, which carries OQ on its z axis, and the fixed frame Oxyz. They differ by the
turn theta = omega1 t about Ox; in the paper's stop mode they are one. Vectors are of shape (3, n), lengths
of shape (n,), in SI units: right to 1e-15 of the reach of the mechanism for all times accepted.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..forms import Forms, Formulas
from ..jets import vector
from . import projections
from .geometry import Geometry
from .motion import Motion, angle_turned, exact_rates, transmission_ratios


def inputs(g: Geometry, motion: Motion) -> dict[str, Any]:
    """What both tables of formulas take: mechanism, motion, omega1 and i = omega1/omega2 of (1)."""
    i = motion.omega1 / motion.omega2 if motion.omega2 else np.inf
    return {"g": g, "motion": motion, "omega1": motion.omega1, "i": i}


def exact(g: Geometry, motion: Motion, t: ArrayLike) -> Forms:
    """The exact forms at times, s, shape (n,).

    Raises:
        ValueError: times of another shape, not finite, or too long for the angles: see angle_turned.
    """
    times = np.asarray(t, dtype=np.float64)
    if times.ndim != 1:
        raise ValueError(f"t must be of shape (n,), is of shape {times.shape}")
    drive, satellite = exact_rates(g, motion)
    turns = {"A": (drive, g.gamma), "B": (satellite, g.epsilon), "theta": (Fraction(motion.carrier), 0.0)}
    known = {name: angle_turned(*turn, times) for name, turn in turns.items()}
    waves = {f"{f.__name__}_{name}": f(angle) for name, angle in known.items() for f in (np.sin, np.cos)}
    return Forms(EXACT, **inputs(g, motion), t=times, **known, **waves)


def modulus(v: Any) -> Any:
    """Length of vectors of shape (3, n)."""
    return np.sqrt((v * v).sum(axis=0))


def turned(e: Any, v: Any) -> Any:
    """Vectors of the frame that carries OQ in the fixed frame: what (24) should be, Rx(theta) v."""
    (x, y, z), sine, cosine = v, e.sin_theta, e.cos_theta
    return vector(x, y * cosine - z * sine, y * sine + z * cosine)


def _with_drive(e: Any, radial: Any, tangential: Any, along: Any) -> Any:
    """Vectors of the drive, by its angle A, in the frame that carries OQ."""
    sine, cosine = e.sin_A, e.cos_A
    return vector(radial * cosine - tangential * sine, radial * sine + tangential * cosine, along)


def _with_satellite(e: Any, along: Any, across: Any) -> Any:
    """Vectors across the axis of the satellite: along the line from its axis to Q's side, and across it."""
    sine, cosine = np.sin(e.g.shaft_angle), np.cos(e.g.shaft_angle)
    return _with_drive(e, along * cosine, across, along * sine)


def _acceleration(e: Any) -> Any:
    """Centripetal of satellite, drive and link 1, between them the parts of Coriolis, turned."""
    w16, w1 = e.omega16, e.motion.carrier
    (x, y, z), (vx, vy, vz) = e.position_in_link1, e.about_satellite
    coriolis = vector(-2.0 * w16 * vy, 2.0 * w16 * vx - 2.0 * w1 * vz, 2.0 * w1 * (vy + w16 * x))
    central = vector(-w16 * w16 * x, -(w16 * w16 + w1 * w1) * y, -w1 * w1 * z)
    return turned(e, -e.omega6 * e.omega6 * e.arm_of_imbalance + coriolis + central)


EXACT: Formulas = {
    # (1)
    "speeds": lambda e: transmission_ratios(e.g, e.motion),
    "omega16": lambda e: e.speeds[1],
    "omega6": lambda e: e.speeds[2],
    # in the frame that carries OQ: D, (2) with U5 U4 put right to U3 cos(chi); A; AD, (8), not as a
    # difference, so exact however short it is against QA
    "position_in_link1": lambda e: e.centre_of_satellite + e.arm_of_imbalance,
    "centre_of_satellite": lambda e: _with_drive(e, e.g.across, 0.0, e.g.height),
    "arm_of_imbalance": lambda e: _with_satellite(e, -e.g.AD * e.cos_B, -e.g.AD * e.sin_B),
    # (9), (10) put right: from A to Q, against what (9) prints
    "spin_of_satellite": lambda e: _with_drive(
        e, -e.omega6 * np.sin(e.g.shaft_angle), 0.0, e.omega6 * np.cos(e.g.shaft_angle)
    ),
    "mu": lambda e: e.omega6 / e.g.QA,
    # (11), (12) put right: V_QA = omega6 x AD
    "about_satellite": lambda e: e.omega6 * _with_satellite(e, e.g.AD * e.sin_B, -e.g.AD * e.cos_B),
    "speed_about_satellite": lambda e: modulus(e.about_satellite),
    # (13) to (16) put right: V_Oz = omega16 x r
    "spin_of_drive": lambda e: vector(0.0, 0.0, np.full_like(e.t, e.omega16)),
    "lambda_": lambda e: np.full_like(e.t, e.omega16 / e.g.OQ),
    "about_drive": lambda e: e.omega16 * vector(-e.position_in_link1[1], e.position_in_link1[0], 0.0),
    "speed_about_drive": lambda e: modulus(e.about_drive),
    # (7), (17), (18): V_D Sigma of the stop mode, against the frame that carries OQ
    "velocity_in_link1": lambda e: e.about_satellite + e.about_drive,
    "speed_in_link1": lambda e: modulus(e.velocity_in_link1),
    # (19) put right; the rate of beta_P of D in link 1, omega_P, which is not to be counted
    "alpha": lambda e: e.omega1 * e.t,
    "swing_rate": lambda e: projections.angular_velocities(e.position_in_link1, e.velocity_in_link1)[1],
    # (20) to (22) put right: V_Ox = omega1 x r
    "spin_of_link1": lambda e: vector(np.full_like(e.t, e.motion.carrier), 0.0, 0.0),
    "v": lambda e: e.motion.carrier / e.position_in_link1[0],
    "about_centre": lambda e: e.motion.carrier * vector(0.0, -e.position_in_link1[2], e.position_in_link1[1]),
    "speed_about_centre": lambda e: modulus(e.about_centre),
    # (23); and in the fixed frame (2), (3), (24), (25), (32) in closed form, (33)
    "sum_of_three": lambda e: e.velocity_in_link1 + e.about_centre,
    "position": lambda e: turned(e, e.position_in_link1),
    "radius": lambda e: modulus(e.position),
    "velocity": lambda e: turned(e, e.sum_of_three),
    "speed": lambda e: modulus(e.velocity),
    "acceleration": _acceleration,
    "acceleration_modulus": lambda e: modulus(e.acceleration),
    # (4), (5), (6)
    "projections": lambda e: projections.projections(e.position),
    "angles": lambda e: projections.angles(e.position),
    "angular_velocities": lambda e: projections.angular_velocities(e.position, e.velocity),
    # (26) to (31): x_L, y_L, y_M, z_M, x_N, z_N, shape (6, n); OL, OM, ON; V on xOy, yOz, xOz
    "feet": lambda e: projections.feet(e.position, e.velocity),
    "arms": lambda e: projections.lengths(e.feet),
    "plane_speeds": lambda e: projections.projections(e.velocity),
    "foot_L": lambda e: e.feet[:2],
    "k1": lambda e: -e.velocity[0] / e.velocity[1],
    "arm_L": lambda e: e.arms[0],
    "speed_L": lambda e: e.plane_speeds[0],
    "foot_M": lambda e: e.feet[[3, 2]],
    "foot_N": lambda e: vector(e.feet[4], 0.0, e.feet[5]),
}
