"""All printed equations in a row, each fed with the printed results before it: what the page computes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import as_printed, as_printed_dynamic
from .exact import checked_times
from .geometry import Geometry
from .motion import Motion, transmission_ratios
from .series import Series

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Printed:
    """The printed set at n times; where the page divides by zero it is not finite.

    Attributes:
        position: (2), m, shape (n, 3). angles: (5), rad, shape (n, 3).
        angular_velocities: (6), rad/s, shape (n, 3).
        stop_velocity, stop_acceleration: (17), m/s, and its rate, m/s^2, shape (n, 3).
        alpha: (19), rad, shape (n,).
        velocity, acceleration: (24), m/s, and (32), m/s^2, of the dynamic mode, shape (n, 3).
    """

    position: Array
    angles: Array
    angular_velocities: Array
    stop_velocity: Array
    stop_acceleration: Array
    alpha: Array
    velocity: Array
    acceleration: Array


def _values(components: Any, n: int) -> Array:
    columns = [u.value if isinstance(u, Series) else u for u in components]
    return np.stack([np.broadcast_to(column, n) for column in columns], axis=1)


def printed(geometry: Geometry, motion: Motion, t: ArrayLike) -> Printed:
    """The printed set at the times t.

    Args:
        geometry: of the mechanism.
        motion: speeds of its links.
        t: times, s, shape (n,).

    Raises:
        ValueError: bad times, as the exact forms.
    """
    times = checked_times(geometry, motion, t)
    with np.errstate(all="ignore"):
        return _chain(geometry, motion, Series([times, 1.0, 0.0]), len(times))


def _chain(g: Geometry, motion: Motion, t: Series, n: int) -> Printed:
    stop, dynamic = as_printed, as_printed_dynamic
    _, omega16, omega6 = transmission_ratios(g, motion)
    u = stop.factors(g.wheel_radius, g.phi, g.psi, g.chi, g.a, g.b, g.c)
    D = stop.position(u, omega16 * t, omega6 * t, g.epsilon, g.gamma)
    _, OP, OF = stop.projections(*D)
    beta = stop.angles(D[0], D[1], OP, OF)
    omega_H, omega_P, omega_F = stop.angular_velocities(*beta)
    # A is not printed: by the text it turns with the drive about Oz at the height of U5
    A = (g.across * np.cos(omega16 * t + g.gamma), g.across * np.sin(omega16 * t + g.gamma), u.U5)
    mu = stop.coefficient_mu(omega6, stop.modulus(A), u.U5, g.OQ)
    V_QA = stop.velocity_about_satellite(mu, stop.arm_of_imbalance(D, A), A, g.OQ)
    lam = stop.coefficient_lambda(omega_H, g.OQ)
    V_Oz = stop.velocity_about_drive(lam, D, g.OQ)
    V_sigma = stop.sum_of_velocities(V_QA, V_Oz)
    alpha = dynamic.angle_of_turn(motion.omega1, omega_P, t)
    v = dynamic.coefficient_v(motion.omega1 + omega_P, omega_P, D[0])
    V_Ox = dynamic.velocity_about_centre(v, D[0], D[1], D[2])
    V = dynamic.turned_velocity(stop.sum_of_velocities(V_sigma, V_Ox), alpha)
    return Printed(
        position=_values(D, n),
        angles=_values(beta, n),
        angular_velocities=_values((omega_H, omega_P, omega_F), n),
        stop_velocity=_values(V_sigma, n),
        stop_acceleration=_values(dynamic.acceleration(V_sigma), n),
        alpha=_values((alpha,), n)[:, 0],
        velocity=_values(V, n),
        acceleration=_values(dynamic.acceleration(V), n),
    )
