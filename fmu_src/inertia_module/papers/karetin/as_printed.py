"""Karetin's equations (1)-(18), the stop mode, as the page prints them, errors included.

Two scans of the page were compared equation by equation: a transcription (scan 000) and a text layer
(scan 003), whose operators stand in the symbol font and can be read. They agree on every sign, factor and
bracket of (1)-(33); where they differ or leave something open, the function says what was taken.

Every function takes what its equation takes: numbers, arrays of shape (n,) or Series of time, and vectors
as three of these. So an equation can be judged alone, fed with exact values; printed_chain feeds each
with the printed results of the ones before. Lengths in m, angles in rad, times in s.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

# a number, an array of shape (n,) or a Series
Value = Any
Vector = tuple[Value, Value, Value]


def transmission_ratios(
    omega1: float, i: float, z2: float, z16: float, z17: float, z6: float
) -> tuple[float, float, float]:
    """Equation (1): (omega2, omega16, omega6), rad/s."""
    return (
        omega1 / i,
        omega1 * z2 / z16 * (1.0 - 1.0 / i),
        omega1 * z2 / z16 * z17 / z6 * (1.0 - 1.0 / i),
    )


class Factors(NamedTuple):
    """U1 to U6 of equation (2): U1, U5 and U6 are lengths, m, the others numbers."""

    U1: float
    U2: float
    U3: float
    U4: float
    U5: float
    U6: float


def factors(wheel_radius: float, phi: float, psi: float, chi: float, a: float, b: float, c: float) -> Factors:
    """The factors U1 to U6 of equation (2).

    Both scans print O_r Pi in U1. The text lists "the radii Q_r Pi and KPi and the heights O_r Q and QK":
    O_r is the centre of the base of wheel 17, so O_r Pi is its radius and "Q_r Pi" a misprint of it.
    """
    U1 = wheel_radius / np.sin(psi)
    U3 = a * np.sin(phi)
    return Factors(
        U1=U1,
        U2=b * np.cos(phi) * np.cos(phi + psi - np.pi / 2),
        U3=U3,
        U4=np.cos(psi),
        U5=U1 * (c * np.cos(psi) + b * np.cos(phi) * np.sin(phi + psi - np.pi / 2)),
        U6=U1 * U3 * np.sin(np.pi - chi),
    )


def position(u: Factors, drive: Value, satellite: Value, epsilon: float, gamma: float) -> Vector:
    """Equation (2): (x_D, y_D, z_D), of mixed units: U1 U5 U4 is an area.

    Args:
        u: factors.
        drive, satellite: omega16 t and omega6 t, rad.
        epsilon, gamma: offsets, rad.
    """
    B = np.pi - (satellite + epsilon)
    A = drive + gamma
    bracket = u.U2 + u.U5 * u.U4 * np.cos(B)
    return (
        u.U1 * (bracket * np.cos(A) + u.U3 * np.sin(B) * np.sin(A)),
        u.U1 * (bracket * np.sin(A) - u.U3 * np.sin(B) * np.cos(A)),
        u.U5 + u.U6 * np.cos(B),
    )


def radius(x: Value, y: Value, z: Value) -> Value:
    """Equation (3): r_D."""
    return np.sqrt(x * x + y * y + z * z)


def projections(x: Value, y: Value, z: Value) -> Vector:
    """Equation (4): (OH, OP, OF)."""
    return np.sqrt(x * x + y * y), np.sqrt(y * y + z * z), np.sqrt(x * x + z * z)


def angles(x: Value, y: Value, OP: Value, OF: Value) -> Vector:
    """Equation (5): (beta_H, beta_P, beta_F), rad, without the quadrant; beta_H fails at x = 0.

    Scan 000 loses the index of beta_P in the text, scan 003 has it.
    """
    return np.arctan(y / x), np.pi / 2 - np.arccos(y / OP), np.arccos(x / OF)


def angular_velocities(beta_H: Value, beta_P: Value, beta_F: Value) -> Vector:
    """Equation (6): rates of the three angles (Series), rad/s."""
    return beta_H.rate(), beta_P.rate(), beta_F.rate()


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


def modulus(v: Vector) -> Value:
    """Equations (12), (18), (25) and (33): modulus of a vector."""
    return np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def spin_of_drive(lam: Value, OQ: float) -> Vector:
    """Equation (13): omega_H as a vector, rad/s."""
    return 0.0, 0.0, lam * OQ


def coefficient_lambda(omega_H: Value, OQ: float) -> Value:
    """Equation (14): lambda, rad/(s m)."""
    return omega_H / OQ


def velocity_about_drive(lam: Value, D: Vector, OQ: float) -> Vector:
    """Equation (15): V_Oz, m/s."""
    return lam * (D[1] * OQ), -lam * (D[0] * OQ), 0.0 * lam


def modulus_about_drive(v: Vector) -> Value:
    """Equation (16): modulus of V_Oz, m/s."""
    return np.sqrt(v[0] * v[0] + v[1] * v[1])
