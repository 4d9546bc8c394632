"""Karetin's equations (19)-(33), the dynamic mode, as the page prints them, errors included.

On the scans and on arguments see as_printed. Equations (23), (25) and (33) have the form of (17) and
(18): as_printed.sum_of_velocities and as_printed.modulus.
"""

from __future__ import annotations

import numpy as np

from .as_printed import Value, Vector


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
    return v * x_alpha, 0.0, 0.0


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


def foot_L(x: Value, y: Value, k1: Value) -> tuple[Value, Value]:  # noqa: N802
    """Equation (26): (x_L, y_L), m."""
    x_L = (x + k1 * y) / (k1 * k1 + 1.0)
    return x_L, k1 * x_L


def slope_k1(Vx: Value, Vy: Value) -> Value:
    """Equation (27): k1; infinite where V_y is 0."""
    return -Vx / Vy


def arm_OL(x_L: Value, y_L: Value) -> Value:  # noqa: N802
    """Equation (28): OL, m. The page calls it V_OL, modulus of a vector: it is a length."""
    return np.sqrt(x_L * x_L + y_L * y_L)


def speed_on_xy(Vx: Value, Vy: Value) -> Value:
    """Equation (29): modulus of V on xOy, m/s."""
    return np.sqrt(Vx * Vx + Vy * Vy)


def plane_yz(y: Value, z: Value, Vy: Value, Vz: Value) -> dict[str, Value]:
    """Equation (30): foot M, k2, arm OM (printed V_OM), m, and modulus of V on yOz, m/s."""
    k2 = -Vz / Vy
    z_M = (z + k2 * y) / (k2 * k2 + 1.0)
    y_M = k2 * z_M
    return {
        "z_M": z_M,
        "y_M": y_M,
        "k2": k2,
        "V_OM": np.sqrt(y_M * y_M + z_M * z_M),
        "V_yz": np.sqrt(Vy * Vy + Vz * Vz),
    }


def plane_xz(x: Value, z: Value, Vx: Value, Vz: Value) -> dict[str, Value]:
    """Equation (31): foot N, k3, arm ON (printed V_ON), m, and modulus of V on xOz, m/s.

    k3 z_N is printed as y_N (scan 000: y_N alpha), yet V_ON takes an x_N that is never given: the arm
    is taken with the value printed as y_N.
    """
    k3 = -Vz / Vx
    z_N = (z + k3 * x) / (k3 * k3 + 1.0)
    y_N = k3 * z_N
    return {
        "z_N": z_N,
        "y_N": y_N,
        "k3": k3,
        "V_ON": np.sqrt(y_N * y_N + z_N * z_N),
        "V_xz": np.sqrt(Vx * Vx + Vz * Vz),
    }


def acceleration(V: Vector) -> Vector:
    """Equation (32): rates of the components of V (Series), m/s^2."""
    return V[0].rate(), V[1].rate(), V[2].rate()
