"""Karetin's equations (1)-(33) as the page prints them, errors included.

Two scans of the page were compared equation by equation: a transcription (scan 000) and a text layer
(scan 003), whose operators stand in the symbol font and can be read. They agree on every sign, factor and
bracket; where they differ or leave something open, the function says what was taken.

Every function takes what its equation takes: numbers, arrays of shape (n,) or Series of time, and vectors
as three of these. So an equation can be judged alone, fed with exact values; ``printed`` feeds each with
the printed results of the ones before. Lengths in m, angles in rad, times in s.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..series import Series
from .exact import checked_times
from .geometry import Geometry
from .motion import Motion
from .motion import transmission_ratios as exact_ratios

# a number, an array of shape (n,) or a Series
Value = Any
Vector = tuple[Value, Value, Value]


def transmission_ratios(
    omega1: float, i: float, z2: float, z16: float, z17: float, z6: float
) -> tuple[float, float, float]:
    """Equation (1): (omega2, omega16, omega6), rad/s."""
    drive = omega1 * z2 / z16
    return omega1 / i, drive * (1.0 - 1.0 / i), drive * z17 / z6 * (1.0 - 1.0 / i)


class Factors(NamedTuple):
    """U1 to U6 of equation (2): U1, U5 and U6 are lengths, m, the others numbers."""

    U1: float
    U2: float
    U3: float
    U4: float
    U5: float
    U6: float


def factors(wheel_radius: float, phi: float, psi: float, chi: float, a: float, b: float, c: float) -> Factors:
    """The factors of equation (2).

    Both scans print O_r Pi in U1. The text lists "the radii Q_r Pi and KPi and the heights O_r Q and QK":
    O_r is the centre of the base of wheel 17, so O_r Pi is its radius and "Q_r Pi" a misprint of it.
    """
    U1, U3 = wheel_radius / np.sin(psi), a * np.sin(phi)
    U2 = b * np.cos(phi) * np.cos(phi + psi - np.pi / 2)
    U5 = U1 * (c * np.cos(psi) + b * np.cos(phi) * np.sin(phi + psi - np.pi / 2))
    return Factors(U1, U2, U3, np.cos(psi), U5, U1 * U3 * np.sin(np.pi - chi))


def position(u: Factors, drive: Value, satellite: Value, epsilon: float, gamma: float) -> Vector:
    """Equation (2): (x_D, y_D, z_D), of mixed units: U1 U5 U4 is an area.

    drive, satellite: omega16 t and omega6 t, rad; epsilon, gamma: offsets, rad.
    """
    B, A = np.pi - (satellite + epsilon), drive + gamma
    bracket = u.U2 + u.U5 * u.U4 * np.cos(B)
    return (
        u.U1 * (bracket * np.cos(A) + u.U3 * np.sin(B) * np.sin(A)),
        u.U1 * (bracket * np.sin(A) - u.U3 * np.sin(B) * np.cos(A)),
        u.U5 + u.U6 * np.cos(B),
    )


def modulus(v: Vector) -> Value:
    """Equations (3), (12), (18), (25) and (33): modulus of a vector."""
    return np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def length(u: Value, v: Value) -> Value:
    """Equations (4), (16), (28) and (29), and within (30) and (31): length in a plane."""
    return np.sqrt(u * u + v * v)


def projections(x: Value, y: Value, z: Value) -> Vector:
    """Equation (4): (OH, OP, OF)."""
    return length(x, y), length(y, z), length(x, z)


def angles(x: Value, y: Value, OP: Value, OF: Value) -> Vector:
    """Equation (5): (beta_H, beta_P, beta_F), rad, without the quadrant; beta_H fails at x = 0.

    Scan 000 loses the index of beta_P in the text, scan 003 has it.
    """
    return np.arctan(y / x), np.pi / 2 - np.arccos(y / OP), np.arccos(x / OF)


def rates(v: Vector) -> Vector:
    """Equations (6), of the angles, and (32), of the velocity: rates of three Series."""
    return v[0].rate(), v[1].rate(), v[2].rate()


def sum_of_velocities(one: Vector, other: Vector) -> Vector:
    """Equations (7) and (17): V_D Sigma of V_QA and V_Oz; also (23): V_D Omega of V_D Sigma and V_Ox."""
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


def arm_of_imbalance(D: Vector, A: Vector) -> Vector:
    """Equation (8): AD."""
    return D[0] - A[0], D[1] - A[1], D[2] - A[2]


def spin_of_satellite(mu: Value, A: Vector) -> Vector:
    """Equation (9): omega6, rad/s."""
    return mu * A[0], mu * A[1], mu * A[2]


def coefficient_mu(omega6: float, OA: Value, zA: Value, OQ: float) -> Value:
    """Equation (10): mu, rad/(s m)."""
    return omega6 / np.sqrt(OA * OA - 2.0 * zA * OQ + OQ * OQ)


def velocity_about_satellite(mu: Value, AD: Vector, A: Vector, zQ: float) -> Vector:
    """Equation (11): V_QA, of mixed units.

    The second row opens one bracket more than it closes, in both scans: the missing one is taken at its
    end. The third row has no bracket after mu, which so multiplies the first product only.
    """
    return (
        mu * (AD[1] * (A[2] - zQ) - AD[2] * A[1]),
        -mu * (AD[0] * (A[2] - AD[2] * A[0])),
        mu * AD[0] * A[1] - AD[1] * A[0],
    )


def spin_of_drive(lam: Value, OQ: float) -> Vector:
    """Equation (13): omega_H as a vector, rad/s."""
    return 0.0 * lam, 0.0 * lam, lam * OQ


def coefficient_lambda(omega_H: Value, OQ: float) -> Value:
    """Equation (14): lambda, rad/(s m)."""
    return omega_H / OQ


def velocity_about_drive(lam: Value, D: Vector, OQ: float) -> Vector:
    """Equation (15): V_Oz, m/s."""
    return lam * (D[1] * OQ), -lam * (D[0] * OQ), 0.0 * lam


def angle_of_turn(omega1: float, omega_P: Value, t: Value) -> Value:
    """Equation (19): alpha, rad."""
    return (omega1 + omega_P) * t


def turned_position(x: Value, OP: Value, alpha: Value) -> Vector:
    """(x, y, z) of D_alpha, m: no equation; the text takes x unchanged and y, z from OP and alpha.

    Sine for y and cosine for z, as in (24) and as beta_P is measured from Oz.
    """
    return x, OP * np.sin(alpha), OP * np.cos(alpha)


def spin_of_turn(v: Value, x_alpha: Value) -> Vector:
    """Equation (20): omega_alpha as a vector, rad/s."""
    return v * x_alpha, 0.0 * v, 0.0 * v


def coefficient_v(omega_alpha: Value, omega_P: Value, x_alpha: Value) -> Value:
    """Equation (21): v, rad/(s m); infinite where x is 0.

    The page does not define omega_alpha. By (19) it is taken as omega1 + omega_P, to which (21) adds
    omega_P again. Scan 000 writes v, scan 003 nu and upsilon.
    """
    return (omega_alpha + omega_P) / x_alpha


def velocity_about_centre(v: Value, x_alpha: Value, yP: Value, zP: Value) -> Vector:
    """Equation (22): V_Ox, m/s; no minus in either scan."""
    return 0.0 * v, v * (x_alpha * zP), v * (x_alpha * yP)


def turned_velocity(V: Vector, alpha: Value) -> Vector:
    """Equation (24): V of D_alpha Omega_alpha, m/s."""
    return V[0], V[1] * np.sin(alpha), V[2] * np.cos(alpha)


def slope(along: Value, across: Value) -> Value:
    """Equation (27), and k2 of (30), k3 of (31): -along/across; infinite where the divisor is 0."""
    return -along / across


def foot(along: Value, across: Value, k: Value) -> tuple[Value, Value]:
    """Equations (26), (30) and (31): (x_L, y_L), (z_M, y_M) and (z_N, what is printed as y_N), m.

    The arm V_ON of (31) takes an x_N that is never given: it is taken as what is printed as y_N.
    """
    first = (along + k * across) / (k * k + 1.0)
    return first, k * first


class Printed(NamedTuple):
    """What the page computes at n times; where it divides by zero it is not finite.

    Attributes:
        position: (2), m, shape (n, 3). angles: (5), rad. angular_velocities: (6), rad/s.
        stop_velocity, stop_acceleration: (17), m/s, and its rate, m/s^2.
        alpha: (19), rad, shape (n, 1).
        velocity, acceleration: (24), m/s, and (32), m/s^2, of the dynamic mode.
    """

    position: NDArray[np.float64]
    angles: NDArray[np.float64]
    angular_velocities: NDArray[np.float64]
    stop_velocity: NDArray[np.float64]
    stop_acceleration: NDArray[np.float64]
    alpha: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]


def printed(g: Geometry, motion: Motion, times: ArrayLike) -> Printed:
    """All printed equations in a row, each fed with the printed results before it.

    Raises:
        ValueError: bad times, as the exact forms.
    """
    seconds = checked_times(g, motion, times)
    t = Series([seconds, 1.0, 0.0])
    _, omega16, omega6 = exact_ratios(g, motion)
    with np.errstate(all="ignore"):
        u = factors(g.wheel_radius, g.phi, g.psi, g.chi, g.a, g.b, g.c)
        D = position(u, omega16 * t, omega6 * t, g.epsilon, g.gamma)
        _, OP, OF = projections(*D)
        beta = angles(D[0], D[1], OP, OF)
        omega = rates(beta)
        # A is not printed: by the text it turns with the drive about Oz at the height of U5
        A = (g.across * np.cos(omega16 * t + g.gamma), g.across * np.sin(omega16 * t + g.gamma), u.U5)
        mu = coefficient_mu(omega6, modulus(A), u.U5, g.OQ)
        V_QA = velocity_about_satellite(mu, arm_of_imbalance(D, A), A, g.OQ)
        V_Oz = velocity_about_drive(coefficient_lambda(omega[0], g.OQ), D, g.OQ)
        V_sigma = sum_of_velocities(V_QA, V_Oz)
        alpha = angle_of_turn(motion.omega1, omega[1], t)
        v = coefficient_v(motion.omega1 + omega[1], omega[1], D[0])
        V_Ox = velocity_about_centre(v, D[0], D[1], D[2])
        V = turned_velocity(sum_of_velocities(V_sigma, V_Ox), alpha)
        chain = (D, beta, omega, V_sigma, rates(V_sigma), (alpha,), V, rates(V))
        return Printed(*(np.stack([u.value + 0.0 * seconds for u in vector], axis=1) for vector in chain))
