"""Karetin's equations (1)-(33) as the page prints them, errors included.

Two scans of the page were compared equation by equation: a transcription (scan 000) and a text layer
(scan 003), whose operators stand in the symbol font and can be read. They agree on every sign, factor and
bracket; where they differ or leave something open, it is said here what was taken.

The formulas take numbers, arrays of shape (n,) or jets of time, and vectors of three of these. Lengths in m,
angles in rad, times in s.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..forms import Forms, Formulas
from ..jets import Jet, rate, value, vector
from .exact import exact, inputs
from .geometry import Geometry
from .motion import Motion


def printed(g: Geometry, motion: Motion, times: Any, name: str) -> NDArray[np.float64]:
    """A quantity of the page, all equations in a row, each fed with the printed results before it.

    Args:
        times: s, shape (n,). name: one of PRINTED.

    Returns:
        Shape (n,) or (3, n); where the page divides by zero it is not finite.

    Raises:
        ValueError: bad times, as the exact forms.
    """
    t = Jet(exact(g, motion, times).t, 1.0, 0.0)
    with np.errstate(all="ignore"):
        found: NDArray[np.float64] = value(getattr(Forms(PRINTED, **inputs(g, motion), t=t), name))
    return found


def factors(g: Geometry) -> tuple[float, ...]:
    """The factors U1 to U6 of equation (2): U1, U5 and U6 are lengths, m, the others numbers.

    Both scans print O_r Pi in U1. The text lists "the radii Q_r Pi and KPi and the heights O_r Q and QK":
    O_r is the centre of the base of wheel 17, so O_r Pi is its radius and "Q_r Pi" a misprint of it.
    """
    phi, psi = g.phi, g.psi
    U1, U3 = g.wheel_radius / np.sin(psi), g.a * np.sin(phi)
    U2 = g.b * np.cos(phi) * np.cos(phi + psi - np.pi / 2)
    U5 = U1 * (g.c * np.cos(psi) + g.b * np.cos(phi) * np.sin(phi + psi - np.pi / 2))
    return U1, U2, U3, np.cos(psi), U5, U1 * U3 * np.sin(np.pi - g.shaft_angle)


def position(factors: tuple[float, ...], A: Any, B: Any) -> Any:
    """Equation (2), A = omega16 t + gamma and B = omega6 t + epsilon; of mixed units: U1 U5 U4 is an area."""
    U1, U2, U3, U4, U5, U6 = factors
    cosine, sine = np.cos(np.pi - B), np.sin(np.pi - B)
    bracket = U2 + U5 * U4 * cosine
    return vector(
        U1 * (bracket * np.cos(A) + U3 * sine * np.sin(A)),
        U1 * (bracket * np.sin(A) - U3 * sine * np.cos(A)),
        U5 + U6 * cosine,
    )


def modulus(v: Any) -> Any:
    """Equations (3), (12), (18), (25) and (33)."""
    return np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def length(u: Any, v: Any) -> Any:
    """Equations (4), (16), (28) and (29), and within (30) and (31): length in a plane."""
    return np.sqrt(u * u + v * v)


def slope(v: Any, along: int, across: int) -> Any:
    """Equation (27), and k2 of (30), k3 of (31): infinite where the divisor is 0."""
    return -v[along] / v[across]


def foot(r: Any, along: int, across: int, k: Any) -> Any:
    """Equations (26), (30) and (31): (x_L, y_L), (z_M, y_M) and (z_N, what is printed as y_N)."""
    first = (r[along] + k * r[across]) / (k * k + 1.0)
    return vector(first, k * first)


def _speeds(e: Any) -> tuple[Any, Any, Any]:
    drive = e.omega1 * e.g.z2 / e.g.z16
    return e.omega1 / e.i, drive * (1.0 - 1.0 / e.i), drive * e.g.z17 / e.g.z6 * (1.0 - 1.0 / e.i)


def _angles(e: Any) -> Any:
    (x, y), (_, OP, OF) = (e.position[0], e.position[1]), (e.projections[n] for n in range(3))
    return vector(np.arctan(y / x), np.pi / 2 - np.arccos(y / OP), np.arccos(x / OF))


def _mu(e: Any) -> Any:
    OA, zA, OQ = modulus(e.centre_of_satellite), e.centre_of_satellite[2], e.g.OQ
    return e.omega6 / np.sqrt(OA * OA - 2.0 * zA * OQ + OQ * OQ)


def _about_satellite(e: Any) -> Any:
    AD, A, mu, zQ = e.arm_of_imbalance, e.centre_of_satellite, e.mu, e.g.OQ
    # the second row opens one bracket more than it closes, in both scans: the missing one is taken at its
    # end; the third row has no bracket after mu, which so multiplies the first product only
    return vector(
        mu * (AD[1] * (A[2] - zQ) - AD[2] * A[1]),
        -mu * (AD[0] * (A[2] - AD[2] * A[0])),
        mu * AD[0] * A[1] - AD[1] * A[0],
    )


def _about_drive(e: Any) -> Any:
    D, lambda_, OQ = e.position_in_link1, e.lambda_, e.g.OQ
    return vector(lambda_ * (D[1] * OQ), -lambda_ * (D[0] * OQ), 0.0)


def _about_centre(e: Any) -> Any:
    D, v = e.position_in_link1, e.v
    return vector(0.0, v * (D[0] * D[2]), v * (D[0] * D[1]))


def _turned_velocity(e: Any) -> Any:
    V = e.sum_of_three
    return vector(V[0], V[1] * np.sin(e.alpha), V[2] * np.cos(e.alpha))


def _foot_n(e: Any) -> Any:
    # to the letter N is at (0, k3 z_N, z_N); the arm V_ON takes an x_N that is never given
    z, y = (foot(e.position, 2, 0, slope(e.velocity, 2, 0))[n] for n in (0, 1))
    return vector(0.0, y, z)


PRINTED: Formulas = {
    # (1)
    "speeds": _speeds,
    "omega16": lambda e: e.speeds[1],
    "omega6": lambda e: e.speeds[2],
    # (2), (3)
    "A": lambda e: e.omega16 * e.t + e.g.gamma,
    "B": lambda e: e.omega6 * e.t + e.g.epsilon,
    "position_in_link1": lambda e: position(factors(e.g), e.A, e.B),
    "position": lambda e: e.position_in_link1,
    "radius": lambda e: modulus(e.position),
    # (4) to (6); (5) without the quadrant, fails at x = 0; the index of beta_P is in scan 003 only
    "projections": lambda e: vector(
        *(length(e.position[u], e.position[v]) for u, v in ((0, 1), (1, 2), (0, 2)))
    ),
    "angles": _angles,
    "angular_velocities": lambda e: rate(e.angles),
    # (7), (17)
    "velocity_in_link1": lambda e: e.about_satellite + e.about_drive,
    # A is not printed: by the text it turns with the drive about Oz at the height of U5; (8)
    "centre_of_satellite": lambda e: vector(
        e.g.across * np.cos(e.A), e.g.across * np.sin(e.A), factors(e.g)[4]
    ),
    "arm_of_imbalance": lambda e: e.position_in_link1 - e.centre_of_satellite,
    # (9), (10), (11) of mixed units, (12)
    "spin_of_satellite": lambda e: e.mu * e.centre_of_satellite,
    "mu": _mu,
    "about_satellite": _about_satellite,
    "speed_about_satellite": lambda e: modulus(e.about_satellite),
    # (13) to (16)
    "spin_of_drive": lambda e: vector(0.0, 0.0, e.lambda_ * e.g.OQ),
    "lambda_": lambda e: e.angular_velocities[0] / e.g.OQ,
    "about_drive": _about_drive,
    "speed_about_drive": lambda e: length(e.about_drive[0], e.about_drive[1]),
    # (18)
    "speed_in_link1": lambda e: modulus(e.velocity_in_link1),
    # (19)
    "swing_rate": lambda e: e.angular_velocities[1],
    "alpha": lambda e: (e.omega1 + e.swing_rate) * e.t,
    # (20), (21), (22); the page does not define omega_alpha of (21): by (19) it is taken as
    # omega1 + omega_P, to which (21) adds omega_P again; scan 000 writes v, scan 003 nu and upsilon
    "spin_of_link1": lambda e: vector(e.v * e.position_in_link1[0], 0.0, 0.0),
    "v": lambda e: (e.omega1 + e.swing_rate + e.swing_rate) / e.position_in_link1[0],
    "about_centre": _about_centre,
    # (23), (24), (25)
    "sum_of_three": lambda e: e.velocity_in_link1 + e.about_centre,
    "velocity": _turned_velocity,
    "speed": lambda e: modulus(e.velocity),
    # (26), (27), (28), (29), (30), (31)
    "foot_L": lambda e: foot(e.position, 0, 1, e.k1),
    "k1": lambda e: slope(e.velocity, 0, 1),
    "arm_L": lambda e: length(e.foot_L[0], e.foot_L[1]),
    "speed_L": lambda e: length(e.velocity[0], e.velocity[1]),
    "foot_M": lambda e: foot(e.position, 2, 1, slope(e.velocity, 2, 1)),
    "foot_N": _foot_n,
    # (32), of either mode, and (33)
    "acceleration_in_link1": lambda e: rate(e.velocity_in_link1),
    "acceleration": lambda e: rate(e.velocity),
    "acceleration_modulus": lambda e: modulus(e.acceleration),
}
