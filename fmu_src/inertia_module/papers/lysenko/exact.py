"""Counterparts of equations (1) to (18), closed and finite everywhere, for a steady omega.

The frame turns with the carrier, O to O1 is its first axis. e points from O1 to the imbalance S, at the
angle pi + alpha; the imbalance is nearest to O at alpha = 0. Inertia forces at constant omega:

    F1 = m l omega^2 e,  F2 = m b^2 omega^2 OS,  Fk = 2 m b omega (l omega) e,  sum = -m a

Fk takes the speed l omega relative to the carrier, and as the carrier turns in the same sense it lies
along e, in line with F1. What a changing omega adds is in motion.

alpha in rad, omega in rad/s, numbers or arrays of shape (n,); so are the results, in SI units. Moments are
positive in the sense of omega.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .mechanism import Mechanism

# a number or an array of shape (n,)
Value = Any


def _versed(alpha: Value) -> Value:
    """1 - cos alpha, without cancellation at the cusp."""
    return 2.0 * np.sin(0.5 * alpha) ** 2


def epicycloid(m: Mechanism, phi: Value) -> tuple[Value, Value]:
    """X, Y of the imbalance in the fixed frame, m: (1), right as it stands."""
    D, carrier, wheel = m.centre_distance, m.b * phi, (1.0 + m.b) * phi
    return D * np.cos(carrier) - m.arm * np.cos(wheel), D * np.sin(carrier) - m.arm * np.sin(wheel)


def position(m: Mechanism, alpha: Value) -> tuple[Value, Value]:
    """S from O along and across the carrier, m."""
    return m.centre_distance - m.arm + m.arm * _versed(alpha), -m.arm * np.sin(alpha)


def rho(m: Mechanism, alpha: Value) -> Value:
    """Distance OS, m: (2) with phi = alpha."""
    return np.hypot(*position(m, alpha))


def relative_force(m: Mechanism, omega: Value) -> Value:
    """F1, N: (3), right as it stands."""
    return m.m * m.arm * omega**2


def carrier_force(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """F2, N: (4)."""
    return m.m * rho(m, alpha) * (m.b * omega) ** 2


def coriolis_force(m: Mechanism, omega: Value) -> Value:
    """Fk = 2 m b omega (l omega), the same at every angle, N: corrects (5)."""
    return 2.0 * m.m * m.b * m.arm * omega**2


def speed(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Absolute speed of S, m/s: (6), (7).

    The wheel turns about the point where it touches wheel 2: (1 + b) omega times the distance of S from
    it, which has no quadrant to lose and is zero at the cusp of l = r.
    """
    distance = np.hypot(m.r - m.arm + m.arm * _versed(alpha), m.arm * np.sin(alpha))
    return (1.0 + m.b) * np.abs(omega) * distance


def beta1(m: Mechanism, alpha: Value) -> Value:
    """Angle at S from O1 S to O S by atan2, -pi to pi, rad: corrects (8)."""
    D = m.centre_distance
    return np.arctan2(D * np.sin(alpha), m.arm - D + D * _versed(alpha))


def delta(m: Mechanism, alpha: Value) -> Value:
    """Angle from V to V2 = b omega OS by atan2, -pi to pi, rad: corrects (13); no meaning where V = 0."""
    D = m.centre_distance
    # V1 x V2 and (V1 + V2) . V2 over b omega^2
    along_v1 = m.arm * (m.arm - D + D * _versed(alpha))
    return np.arctan2(m.arm * D * np.sin(alpha), along_v1 + m.b * rho(m, alpha) ** 2)


def n1(m: Mechanism, alpha: Value) -> Value:
    """Arm of F1 about O, (11), and of the Coriolis force, correction of (14): m."""
    return m.centre_distance * np.sin(alpha)


def n2(m: Mechanism, alpha: Value) -> Value:
    """Arm of F2 about O1, (12), m; about O it has none.

    Raises:
        ValueError: l = D, where S passes through O and F2 has no direction.
    """
    if m.arm == m.centre_distance:
        raise ValueError(f"arm must not be R0 + r for F2 to have an arm, is {m.arm}")
    return m.centre_distance * m.arm * np.sin(alpha) / rho(m, alpha)


def wheel_moment(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Moment of the inertia forces about O1, m b^2 omega^2 l D sin alpha, N m: corrects (15).

    F1 and Fk pass through O1, so F2 alone is left. It is what wheel 1 is turned by; the held wheel 2
    keeps it in balance with the force M1 / r at the teeth.
    """
    return m.m * (m.b * omega) ** 2 * m.arm * m.centre_distance * np.sin(alpha)


def carrier_moment(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Moment of the inertia forces about O, -m D (1 + 2 b) l omega^2 sin alpha, N m: corrects (10), (16).

    F2 passes through O. It is the moment all that acts from outside, drive and held wheel, has to balance.
    """
    return -m.m * m.centre_distance * (1.0 + 2.0 * m.b) * m.arm * omega**2 * np.sin(alpha)


def pin_moment(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Moment about O of the inertia forces moved to O1: M - M1 = -m D (1 + b)^2 l omega^2 sin alpha, N m.

    The other reading of (10): what the pin O1 does to the carrier, less the force of the teeth. With it
    -F2 n2 is right, and so is k2 for the direction the paper takes, but not the power (18), which then
    needs the absolute speed (1 + b) omega of the wheel beside it in (17).
    """
    return -m.m * m.centre_distance * (1.0 + m.b) ** 2 * m.arm * omega**2 * np.sin(alpha)


def wheel_power(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Power M1 omega of the inertia forces in the turning about O1, W: (17)."""
    return wheel_moment(m, alpha, omega) * omega


def carrier_power(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Power M b omega of the inertia forces in the turning about O, W: (18).

    N1 + N is all the inertia forces do: at constant speed minus the power of the drive.
    """
    return carrier_moment(m, alpha, omega) * m.b * omega
