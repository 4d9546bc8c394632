"""Motion under a drive and without one: the exact counterpart of equations (19) to (24).

With wheel 2 held one angle describes the mechanism. Its kinetic energy is J_red(alpha) theta'^2 / 2 with
theta = b alpha the angle of the carrier, and the inertia reduced to the carrier contains how wheel 1 and
the imbalance turn on it. The held wheel takes torque, so angular momentum about O is not conserved;
left alone, the mechanism keeps its energy. Arguments and results as in exact.
"""

from __future__ import annotations

import numpy as np

from .exact import Value, wheel_moment
from .mechanism import Mechanism


def reduced_inertia(m: Mechanism, alpha: Value) -> Value:
    """Inertia reduced to the carrier, kg m^2, for (19).

    J_carrier + J_wheel ((1 + b)/b)^2 + m D^2 (1 + (l/r)^2 - 2 (l/r) cos alpha).
    """
    ratio, turns = m.arm / m.r, m.centre_distance / m.r
    swing = (1.0 - ratio) ** 2 + 4.0 * ratio * np.sin(0.5 * alpha) ** 2
    return m.J_carrier + m.J_wheel * turns**2 + m.m * m.centre_distance**2 * swing


def reduced_inertia_limits(m: Mechanism) -> tuple[float, float]:
    """Largest (alpha = pi) and smallest (alpha = 0) reduced inertia, kg m^2, for (20)."""
    return float(reduced_inertia(m, np.pi)), float(reduced_inertia(m, 0.0))


def kinetic_energy(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Kinetic energy of all links, J, for (22) to (24)."""
    return 0.5 * reduced_inertia(m, alpha) * (m.b * omega) ** 2


def angular_momentum(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Angular momentum of all links about O, N m s.

    The paper takes J b omega with the J of (19), which leaves out that wheel 1 and the imbalance turn on
    the carrier.
    """
    b, D = m.b, m.centre_distance
    of_mass = D**2 * b + m.arm**2 * (1.0 + b) - D * m.arm * (1.0 + 2.0 * b) * np.cos(alpha)
    return omega * (m.J_carrier * b + m.J_wheel * (1.0 + b) + m.m * of_mass)


def drive_torque(m: Mechanism, alpha: Value, omega: Value, omega_rate: Value = 0.0) -> Value:
    """Torque the drive has to supply at the carrier (Lagrange), N m: J_red theta'' + J_red' theta'^2 / 2.

    At constant speed it is m D (1 + b) l omega^2 sin alpha = -(M + M1/b). A drive of wheel 1 against the
    carrier needs b times this torque. omega_rate is that of omega, rad/s^2.
    """
    # J_red' = dJ/dtheta = 2 m D^2 (l/r) sin(alpha) / b
    slope = m.m * m.centre_distance**2 * m.arm / m.r * m.b * np.sin(alpha)
    return reduced_inertia(m, alpha) * m.b * omega_rate + slope * omega**2


def wheel_torque(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Torque the held wheel 2 exerts on the rest about O at constant speed: M1 / b, N m."""
    return wheel_moment(m, alpha, omega) / m.b


def drive_power(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Power of the drive at constant speed, -(N1 + N), W: zero on average, nothing is gained over a cycle."""
    return drive_torque(m, alpha, omega) * m.b * omega


def speed_ratio(m: Mechanism) -> float:
    """omega_max / omega_min of the free, undriven mechanism, sqrt(J_red,max / J_red,min): corrects (21).

    Raises:
        ValueError: J_red,min = 0 (l = r and links without inertia), where the speed has no bound.
    """
    largest, smallest = reduced_inertia_limits(m)
    if smallest == 0.0:
        raise ValueError("arm must not be r without inertia of the links: the speed at the cusp has no bound")
    return float(np.sqrt(largest / smallest))


def free_omega(m: Mechanism, alpha: Value, omega_min: float) -> Value:
    """Speed of wheel 1 on the carrier in free motion, rad/s; omega_min at alpha = pi.

    Raises:
        ValueError: see speed_ratio.
    """
    return omega_min * speed_ratio(m) * np.sqrt(reduced_inertia(m, 0.0) / reduced_inertia(m, alpha))


def free_omega_rate(m: Mechanism, alpha: Value, omega: Value) -> Value:
    """Acceleration of wheel 1 on the carrier in free motion, rad/s^2.

    Raises:
        ValueError: see speed_ratio.
    """
    speed_ratio(m)
    return -drive_torque(m, alpha, omega) / (m.b * reduced_inertia(m, alpha))
