"""Counterparts of equations (1) to (18), closed and finite everywhere, for a steady omega.

The frame turns with the carrier, O to O1 is its first axis. e points from O1 to the imbalance S, at the
angle pi + alpha; the imbalance is nearest to O at alpha = 0. Inertia forces at constant omega:

    F1 = m l omega^2 e,  F2 = m b^2 omega^2 OS,  Fk = 2 m b omega (l omega) e,  sum = -m a

Fk takes the speed l omega relative to the carrier, and as the carrier turns in the same sense it lies
along e, in line with F1. What a changing omega adds is in motion.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import as_printed
from .mechanism import Mechanism

Array = NDArray[np.float64]

# equations (1) and (3) are right as they stand
epicycloid = as_printed.epicycloid
relative_force = as_printed.relative_force


def _sine(alpha: ArrayLike) -> Array:
    result: Array = np.sin(np.asarray(alpha, dtype=np.float64))
    return result


def _versed(alpha: ArrayLike) -> Array:
    """1 - cos alpha, without cancellation at the cusp."""
    result: Array = 2.0 * np.sin(0.5 * np.asarray(alpha, dtype=np.float64)) ** 2
    return result


def position(mechanism: Mechanism, alpha: ArrayLike) -> tuple[Array, Array]:
    """S from O along and across the carrier, m, each of the shape (n,) of alpha, rad."""
    along = mechanism.centre_distance - mechanism.arm + mechanism.arm * _versed(alpha)
    return along, -mechanism.arm * _sine(alpha)


def rho(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Distance OS, equation (2) with phi = alpha, m, shape (n,) of alpha, rad."""
    return np.hypot(*position(mechanism, alpha))


def carrier_force(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Equation (4), N, shape (n,) of alpha, rad; omega in rad/s."""
    rate = mechanism.b * np.asarray(omega, dtype=np.float64)
    return mechanism.m * rho(mechanism, alpha) * rate**2


def coriolis_force(mechanism: Mechanism, omega: float) -> float:
    """Coriolis force 2 m b omega (l omega), the same at every angle, N; correction of equation (5)."""
    return 2.0 * mechanism.m * mechanism.b * mechanism.arm * omega**2


def speed(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Absolute speed of S, m/s, shape (n,) of alpha, rad; correction of equations (6) and (7).

    The wheel turns about the point where it touches wheel 2: (1 + b) omega times the distance of S from
    it, which has no quadrant to lose and is zero at the cusp of l = r.
    """
    r, arm = mechanism.r, mechanism.arm
    distance = np.hypot(r - arm + arm * _versed(alpha), arm * _sine(alpha))
    return (1.0 + mechanism.b) * np.abs(np.asarray(omega, dtype=np.float64)) * distance


def beta1(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Angle at S from O1 S to O S by atan2, rad, -pi to pi, shape (n,); correction of equation (8)."""
    D, arm = mechanism.centre_distance, mechanism.arm
    return np.arctan2(D * _sine(alpha), arm - D + D * _versed(alpha))


def delta(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Angle from V to V2 by atan2, rad, -pi to pi, shape (n,) of alpha, rad; correction in (13).

    V2 is the speed b omega OS of turning with the carrier. Where S stands still it has no meaning and
    is 0 or pi.
    """
    b, D, arm = mechanism.b, mechanism.centre_distance, mechanism.arm
    # V1 x V2 and (V1 + V2) . V2 over b omega^2
    along_v1 = arm * (arm - D + D * _versed(alpha))
    return np.arctan2(arm * D * _sine(alpha), along_v1 + b * rho(mechanism, alpha) ** 2)


def n1(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Arm of F1 about O, equation (11), and of the Coriolis force, correction of (14): m, shape (n,)."""
    return mechanism.centre_distance * _sine(alpha)


def n2(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Arm of F2 about O1, equation (12), m, shape (n,) of alpha, rad; about O it has none.

    Raises:
        ValueError: l = D, where S passes through O and F2 has no direction.
    """
    if mechanism.arm == mechanism.centre_distance:
        raise ValueError(f"arm = {mechanism.arm} is refused: allowed is arm != R0 + r for the arm of F2")
    return mechanism.centre_distance * mechanism.arm * _sine(alpha) / rho(mechanism, alpha)


def wheel_moment(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Moment of the inertia forces about O1: m b^2 omega^2 l R0 (1 + b) sin alpha; corrects (9), (15).

    F1 and Fk pass through O1, so F2 alone is left. It is what wheel 1 is turned by; the held wheel 2
    keeps it in balance with the force M1 / r at the teeth.

    Args:
        mechanism: dimensions. alpha: rad, shape (n,). omega: rad/s.

    Returns:
        N m, shape (n,), positive in the sense of omega.
    """
    rate = mechanism.b * np.asarray(omega, dtype=np.float64)
    return mechanism.m * rate**2 * mechanism.arm * mechanism.centre_distance * _sine(alpha)


def carrier_moment(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Moment of the inertia forces about O: -m R0 (1 + b)(1 + 2 b) l omega^2 sin alpha; corrects (10), (16).

    F2 passes through O. It is the moment all that acts from outside, drive and held wheel, has to balance.

    Args:
        mechanism: dimensions. alpha: rad, shape (n,). omega: rad/s.

    Returns:
        N m, shape (n,), positive in the sense of omega.
    """
    square = np.asarray(omega, dtype=np.float64) ** 2
    return (
        -mechanism.m
        * mechanism.centre_distance
        * (1.0 + 2.0 * mechanism.b)
        * mechanism.arm
        * square
        * _sine(alpha)
    )


def pin_moment(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Moment about O of the inertia forces moved to O1: M - M1 = -m R0 (1 + b)^3 l omega^2 sin alpha.

    The other reading of (10): what the pin O1 does to the carrier, less the force of the teeth. With it
    -F2 n2 is right, and so is k2 for the direction the paper takes, but not the power (18), which then
    needs the absolute speed (1 + b) omega of the wheel beside it in (17).

    Args:
        mechanism: dimensions. alpha: rad, shape (n,). omega: rad/s.

    Returns:
        N m, shape (n,), positive in the sense of omega.
    """
    square = np.asarray(omega, dtype=np.float64) ** 2
    return (
        -mechanism.m
        * mechanism.centre_distance
        * (1.0 + mechanism.b) ** 2
        * mechanism.arm
        * square
        * _sine(alpha)
    )


def wheel_power(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Power M1 omega of the inertia forces in the turning about O1, W, shape (n,); corrects (17)."""
    return wheel_moment(mechanism, alpha, omega) * np.asarray(omega, dtype=np.float64)


def carrier_power(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Power M b omega of the inertia forces in the turning about O, W, shape (n,); corrects (18).

    N1 + N is all the inertia forces do: at constant speed minus the power of the drive.
    """
    return carrier_moment(mechanism, alpha, omega) * mechanism.b * np.asarray(omega, dtype=np.float64)
