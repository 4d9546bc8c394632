"""Motion under a drive and without one: the exact counterpart of equations (19) to (24).

With wheel 2 held one angle describes the mechanism. Its kinetic energy is J_red(alpha) theta'^2 / 2 with
theta = b alpha the angle of the carrier, and the inertia reduced to the carrier contains how wheel 1 and
the imbalance turn on it. The held wheel takes up torque, so angular momentum about O is not conserved;
left alone, the mechanism keeps its energy.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .exact import wheel_moment
from .mechanism import Mechanism

Array = NDArray[np.float64]


def _constant_inertia(mechanism: Mechanism) -> float:
    # wheel 1 turns (1 + b)/b times as fast as the carrier
    return mechanism.J_carrier + mechanism.J_wheel * (mechanism.centre_distance / mechanism.r) ** 2


def reduced_inertia(mechanism: Mechanism, alpha: ArrayLike) -> Array:
    """Inertia reduced to the carrier: J + m D^2 (1 + (l/r)^2 - 2 (l/r) cos alpha), kg m^2; for (19).

    Args:
        mechanism: dimensions. alpha: rad, shape (n,).

    Returns:
        Shape (n,). J = J_carrier + J_wheel ((1 + b)/b)^2.
    """
    ratio = mechanism.arm / mechanism.r
    half = np.sin(0.5 * np.asarray(alpha, dtype=np.float64))
    swing = (1.0 - ratio) ** 2 + 4.0 * ratio * half**2
    result: Array = _constant_inertia(mechanism) + mechanism.m * mechanism.centre_distance**2 * swing
    return result


def reduced_inertia_limits(mechanism: Mechanism) -> tuple[float, float]:
    """Largest (alpha = pi) and smallest (alpha = 0) reduced inertia, kg m^2; for (20)."""
    largest, smallest = reduced_inertia(mechanism, np.array([np.pi, 0.0]))
    return float(largest), float(smallest)


def kinetic_energy(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Kinetic energy of all links, J, shape (n,) of alpha, rad; omega of wheel 1 on the carrier, rad/s."""
    carrier = mechanism.b * np.asarray(omega, dtype=np.float64)
    return 0.5 * reduced_inertia(mechanism, alpha) * carrier**2


def angular_momentum(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Angular momentum of all links about O, N m s, shape (n,) of alpha, rad; omega in rad/s.

    The paper takes J b omega with the J of (19), which leaves out that wheel 1 and the imbalance turn on
    the carrier.
    """
    b, D, arm, m = mechanism.b, mechanism.centre_distance, mechanism.arm, mechanism.m
    rate = np.asarray(omega, dtype=np.float64)
    of_links = mechanism.J_carrier * b + mechanism.J_wheel * (1.0 + b)
    of_mass = D**2 * b + arm**2 * (1.0 + b) - D * arm * (1.0 + 2.0 * b) * np.cos(alpha)
    result: Array = rate * (of_links + m * of_mass)
    return result


def drive_torque(
    mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike, omega_rate: ArrayLike = 0.0
) -> Array:
    """Torque the drive has to supply at the carrier (Lagrange): J_red theta'' + J_red' theta'^2 / 2.

    At constant speed it is m R0 (1 + b)^2 l omega^2 sin alpha = -(M + M1/b).

    Args:
        mechanism: dimensions. alpha: rad, shape (n,). omega, omega_rate: of wheel 1 on the carrier,
            rad/s and rad/s^2.

    Returns:
        N m, shape (n,). A drive of wheel 1 against the carrier needs b times this torque.
    """
    b, D = mechanism.b, mechanism.centre_distance
    square = np.asarray(omega, dtype=np.float64) ** 2
    # J_red' = dJ/dtheta = 2 m D^2 (l/r) sin(alpha) / b
    slope = mechanism.m * D**2 * mechanism.arm / mechanism.r * b * np.sin(np.asarray(alpha, dtype=np.float64))
    result: Array = (
        reduced_inertia(mechanism, alpha) * b * np.asarray(omega_rate, dtype=np.float64) + slope * square
    )
    return result


def wheel_torque(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Torque the held wheel 2 exerts on the rest about O at constant speed: M1 / b, N m, shape (n,)."""
    return wheel_moment(mechanism, alpha, omega) / mechanism.b


def drive_power(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Power of the drive at constant speed, -(N1 + N), W, shape (n,) of alpha, rad; omega in rad/s.

    It is m R0 (1 + b)^2 b l omega^3 sin alpha: zero on average, so nothing is gained over a cycle.
    """
    return drive_torque(mechanism, alpha, omega) * mechanism.b * np.asarray(omega, dtype=np.float64)


def speed_ratio(mechanism: Mechanism) -> float:
    """omega_max / omega_min of the free, undriven mechanism, sqrt(J_red,max / J_red,min); for (21).

    Raises:
        ValueError: J_red,min = 0 (l = r and links without inertia), where the speed has no bound.
    """
    largest, smallest = reduced_inertia_limits(mechanism)
    if smallest == 0.0:
        raise ValueError(
            "arm = r without inertia of the links is refused: the speed at the cusp has no bound"
        )
    return float(np.sqrt(largest / smallest))


def free_omega(mechanism: Mechanism, alpha: ArrayLike, omega_min: float) -> Array:
    """Speed of wheel 1 on the carrier in free motion, rad/s, shape (n,) of alpha, rad; for (21).

    Args:
        mechanism: dimensions. alpha: rad, shape (n,). omega_min: the lowest speed, at alpha = pi, rad/s.

    Raises:
        ValueError: see speed_ratio.
    """
    speed_ratio(mechanism)
    largest, _ = reduced_inertia_limits(mechanism)
    result: Array = omega_min * np.sqrt(largest / reduced_inertia(mechanism, alpha))
    return result


def free_omega_rate(mechanism: Mechanism, alpha: ArrayLike, omega: ArrayLike) -> Array:
    """Acceleration of wheel 1 on the carrier in free motion, rad/s^2, shape (n,) of alpha, rad.

    Raises:
        ValueError: see speed_ratio.
    """
    speed_ratio(mechanism)
    return -drive_torque(mechanism, alpha, omega) / (mechanism.b * reduced_inertia(mechanism, alpha))
