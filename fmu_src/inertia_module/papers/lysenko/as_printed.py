"""Equations (1) to (24) as the page has them, errors kept: for comparison only, use exact for numbers.

The paper writes R for R0 and uses phi and alpha for one angle, that of wheel 1 relative to the carrier:
(1) and (2) with phi, the rest with alpha. omega is its rate. Kept: the absolute speed in the Coriolis
force, arcsin for angles beyond a right one, the arms about O of forces moved to O1, and conservation of
angular momentum. What divides by rho raises ValueError where the imbalance passes through O (l = R0 + r).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .mechanism import Mechanism

Array = NDArray[np.float64]


def _arcsin(sine: Array) -> Array:
    # rounding alone can carry a sine past one: |D sin alpha| <= rho always
    return np.arcsin(np.clip(sine, -1.0, 1.0))


def epicycloid(mechanism: Mechanism, phi: ArrayLike) -> tuple[Array, Array]:
    """Equation (1): X, Y of the imbalance, m, each of the shape (n,) of phi, rad."""
    b, D, arm = mechanism.b, mechanism.centre_distance, mechanism.arm
    angle = np.asarray(phi, dtype=np.float64)
    x = D * np.cos(b * angle) - arm * np.cos((1.0 + b) * angle)
    y = D * np.sin(b * angle) - arm * np.sin((1.0 + b) * angle)
    return x, y


def rho(mechanism: Mechanism, phi: ArrayLike) -> Array:
    """Equation (2): distance of the imbalance from O, m, of the shape (n,) of phi, rad."""
    D, arm = mechanism.centre_distance, mechanism.arm
    square = D**2 + arm**2 - 2.0 * D * arm * np.cos(np.asarray(phi, dtype=np.float64))
    # rounding alone can make the square negative
    result: Array = np.sqrt(np.maximum(square, 0.0))
    return result


def _divisor(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Distance rho, for (8), (12) and (13), which divide by it.

    Raises:
        ValueError: it is zero somewhere: l = R0 + r, and S at O.
    """
    distance = rho(mechanism, alpha)
    if not np.all(distance > 0.0):
        raise ValueError(f"arm = {mechanism.arm} is refused: allowed is arm != R0 + r, (8) divides by rho")
    return distance


def phi_of_note(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """The note under (2), phi = b alpha, rad; it contradicts (1), (2) and (8) and is used nowhere here."""
    return mechanism.b * np.asarray(alpha, dtype=np.float64)


def relative_force(mechanism: Mechanism, omega: float) -> float:
    """Equation (3): force of inertia from the turning about O1, N; omega in rad/s."""
    return mechanism.m * mechanism.arm * omega**2


def carrier_force(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (4): force of inertia from the turning about O, N, shape (n,) of alpha; omega in rad/s."""
    return mechanism.m * rho(mechanism, alpha) * mechanism.b**2 * omega**2


def coriolis_force(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (5): Coriolis force with the speed V, N, shape (n,) of alpha, rad; omega in rad/s."""
    return 2.0 * mechanism.m * speed(mechanism, alpha, omega) * mechanism.b * omega


def resultant_speed(V1: ArrayLike, V2: ArrayLike, beta: ArrayLike) -> Array:
    """Equation (6): resultant of two speeds, m/s, that make the angle pi - beta, rad; shape (n,)."""
    one, two = np.asarray(V1, dtype=np.float64), np.asarray(V2, dtype=np.float64)
    result: Array = np.sqrt(one**2 + two**2 - 2.0 * one * two * np.cos(beta))
    return result


def speed(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (7): speed of the imbalance, m/s, shape (n,) of alpha, rad; omega in rad/s."""
    return omega * _speed_arm(mechanism, alpha)


def _speed_arm(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """The root of (7), V / omega, m."""
    arm, reach = mechanism.arm, rho(mechanism, alpha) * mechanism.b
    result: Array = np.sqrt(arm**2 + reach**2 + 2.0 * arm * reach * np.cos(beta1(mechanism, alpha)))
    return result


def beta1(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Equation (8): angle at the imbalance by arcsin, rad, never beyond pi/2, shape (n,) of alpha, rad."""
    angle = np.asarray(alpha, dtype=np.float64)
    return _arcsin(mechanism.centre_distance * np.sin(angle) / _divisor(mechanism, angle))


def wheel_moment_of_forces(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (9): moment about O1 from forces and arms, N m, shape (n,) of alpha, rad."""
    F_2, F_k = carrier_force(mechanism, alpha, omega), coriolis_force(mechanism, alpha, omega)
    return F_2 * n2(mechanism, alpha) + F_k * k1(mechanism, alpha)


def carrier_moment_of_forces(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (10): moment about O from forces and arms, N m, shape (n,) of alpha, rad."""
    F_2, F_k = carrier_force(mechanism, alpha, omega), coriolis_force(mechanism, alpha, omega)
    first = -relative_force(mechanism, omega) * n1(mechanism, alpha)
    return first - F_2 * n2(mechanism, alpha) - F_k * k2(mechanism, alpha)


def n1(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Equation (11): arm of F1 about O, m, shape (n,) of alpha, rad."""
    result: Array = mechanism.centre_distance * np.sin(np.asarray(alpha, dtype=np.float64))
    return result


def n2(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Equation (12): arm of F2 about O1, in (10) about O as well, m, shape (n,) of alpha, rad."""
    angle = np.asarray(alpha, dtype=np.float64)
    result: Array = mechanism.centre_distance * mechanism.arm * np.sin(angle) / _divisor(mechanism, angle)
    return result


def delta(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """The angle of (13), between V and V2 by arcsin, rad, shape (n,) of alpha, rad."""
    angle = np.asarray(alpha, dtype=np.float64)
    sine = mechanism.arm * mechanism.centre_distance * np.sin(angle)
    return _arcsin(sine / (_divisor(mechanism, angle) * _speed_arm(mechanism, angle)))


def k1(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Equation (13): arm of the Coriolis force about O1, m, shape (n,) of alpha, rad."""
    result: Array = mechanism.arm * np.sin(beta1(mechanism, alpha) - delta(mechanism, alpha))
    return result


def k2(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Equation (14): arm of the Coriolis force about O, m, shape (n,) of alpha, rad."""
    angle = np.asarray(alpha, dtype=np.float64)
    turned = angle + beta1(mechanism, angle) - delta(mechanism, angle)
    result: Array = mechanism.centre_distance * np.sin(turned)
    return result


def wheel_moment(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (15): moment about O1 on wheel 1, N m, shape (n,) of alpha, rad; omega in rad/s."""
    b, arm = mechanism.b, mechanism.arm
    angle = np.asarray(alpha, dtype=np.float64)
    turned = np.sin(beta1(mechanism, angle) - delta(mechanism, angle))
    bracket = b * mechanism.centre_distance * np.sin(angle) + 2.0 * _speed_arm(mechanism, angle) * turned
    result: Array = mechanism.m * b * arm * omega**2 * bracket
    return result


def carrier_moment(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (16): moment about O on the carrier, N m, shape (n,) of alpha, rad; omega in rad/s."""
    b, arm = mechanism.b, mechanism.arm
    angle = np.asarray(alpha, dtype=np.float64)
    turned = np.sin(angle + beta1(mechanism, angle) - delta(mechanism, angle))
    bracket = arm * (1.0 + b**2) * np.sin(angle) + 2.0 * b * _speed_arm(mechanism, angle) * turned
    result: Array = -mechanism.m * mechanism.centre_distance * omega**2 * bracket
    return result


def wheel_power(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (17): power M1 omega on wheel 1, W, shape (n,) of alpha, rad; omega in rad/s."""
    return wheel_moment(mechanism, alpha, omega) * omega


def carrier_power(mechanism: Mechanism, alpha: ArrayLike, omega: float) -> Array:
    """Equation (18): power M b omega on the carrier, W, shape (n,) of alpha, rad; omega in rad/s."""
    return carrier_moment(mechanism, alpha, omega) * mechanism.b * omega


def moment_of_inertia(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Equation (19): moment of inertia about O, kg m^2, shape (n,) of alpha, rad."""
    return mechanism.constant_inertia + mechanism.m * rho(mechanism, alpha) ** 2


def inertia_limits(mechanism: Mechanism) -> tuple[float, float]:
    """Equation (20): (J_max, J_min), kg m^2."""
    D, arm, constant = mechanism.centre_distance, mechanism.arm, mechanism.constant_inertia
    return constant + mechanism.m * (D + arm) ** 2, constant + mechanism.m * (D - arm) ** 2


def omega_max(mechanism: Mechanism, omega_min: float) -> float:
    """Equation (21): highest from lowest speed by conservation of angular momentum, rad/s."""
    largest, smallest = inertia_limits(mechanism)
    return omega_min * largest / smallest


def energy_farthest(mechanism: Mechanism, omega_min: float) -> float:
    """Equation (22): kinetic energy at the largest rho, J; omega_min in rad/s."""
    return 0.5 * inertia_limits(mechanism)[0] * omega_min**2


def energy_nearest(mechanism: Mechanism, omega_max: float) -> float:
    """Equation (23): kinetic energy at the smallest rho, J; omega_max in rad/s."""
    return 0.5 * inertia_limits(mechanism)[1] * omega_max**2


def energy_nearest_of_farthest(mechanism: Mechanism, T1: float) -> float:
    """Equation (24): kinetic energy at the smallest rho from that at the largest, J."""
    largest, smallest = inertia_limits(mechanism)
    return T1 * largest / smallest
