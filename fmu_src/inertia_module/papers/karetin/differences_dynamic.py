"""Worst difference over a period of each printed equation (19)-(33) from the exact, fed with exact values."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import as_printed, as_printed_dynamic
from .cases import DYNAMIC, GENERAL, Case, over_period
from .differences import worst
from .series import Series

Array = NDArray[np.float64]

G = GENERAL


def _dynamic() -> Case:
    return over_period(GENERAL, DYNAMIC)


def angle_of_turn() -> float:
    """Of (19), omega_P that of the stop mode at the speed of the drive."""
    case = _dynamic()
    printed = as_printed_dynamic.angle_of_turn(DYNAMIC.omega1, _swing_rate(case), case.t)
    return worst([printed], [DYNAMIC.omega1 * case.t])


def _swing_rate(case: Case) -> Array:
    """Exact omega_P of D in link 1, rad/s, shape (n,)."""
    y, z = case.at.y, case.at.z
    _, vy, vz = case.k.velocity_in_link1.T
    rate: Array = (z * vy - y * vz) / (y * y + z * z)
    return rate


def spin_of_turn() -> float:
    """Of (20), with the exact coefficient omega1/x."""
    case = _dynamic()
    printed = as_printed_dynamic.spin_of_turn(DYNAMIC.omega1 / case.at.x, case.at.x)
    return worst(printed, (DYNAMIC.omega1, 0.0, 0.0))


def coefficient_v() -> float:
    """Of (21) as v x_D, which (20) and (22) use: v itself has no largest value."""
    case = _dynamic()
    omega_P = _swing_rate(case)
    printed = as_printed_dynamic.coefficient_v(DYNAMIC.omega1 + omega_P, omega_P, case.at.x) * case.at.x
    return worst([printed], [DYNAMIC.omega1])


def velocity_about_centre() -> float:
    """Of (22), with the exact coefficient omega1/x."""
    case = _dynamic()
    at = case.at
    printed = as_printed_dynamic.velocity_about_centre(DYNAMIC.omega1 / at.x, at.x, at.y, at.z)
    return worst(printed, case.k.about_centre.T)


def sum_with_centre() -> float:
    """Of (23)."""
    k = _dynamic().k
    printed = as_printed.sum_of_velocities(tuple(k.velocity_in_link1.T), tuple(k.about_centre.T))
    return worst(printed, (k.velocity_in_link1 + k.about_centre).T)


def turned_velocity() -> float:
    """Of (24), with the exact angle."""
    case = _dynamic()
    before = case.k.velocity_in_link1 + case.k.about_centre
    printed = as_printed_dynamic.turned_velocity(tuple(before.T), DYNAMIC.omega1 * case.t)
    return worst(printed, case.k.velocity.T)


def speed() -> float:
    """Of (25)."""
    k = _dynamic().k
    return worst([as_printed.modulus(tuple(k.velocity.T))], [k.speed])


def _feet(number: int) -> tuple[Case, Array]:
    k = _dynamic().k
    return _dynamic(), k.feet[:, 2 * number : 2 * number + 2]


def foot_L() -> float:  # noqa: N802
    """Of (26), (27)."""
    case, foot = _feet(0)
    x, y, _ = case.k.position.T
    slope = as_printed_dynamic.slope_k1(case.k.velocity[:, 0], case.k.velocity[:, 1])
    return worst(as_printed_dynamic.foot_L(x, y, slope), foot.T)


def arm_OL() -> float:  # noqa: N802
    """Of (28)."""
    case, foot = _feet(0)
    return worst([as_printed_dynamic.arm_OL(*foot.T)], [case.k.arms[:, 0]])


def speed_on_xy() -> float:
    """Of (29)."""
    k = _dynamic().k
    return worst([as_printed_dynamic.speed_on_xy(k.velocity[:, 0], k.velocity[:, 1])], [k.plane_speeds[:, 0]])


def foot_M() -> float:  # noqa: N802
    """Of (30)."""
    case, foot = _feet(1)
    _, y, z = case.k.position.T
    _, vy, vz = case.k.velocity.T
    printed = as_printed_dynamic.plane_yz(y, z, vy, vz)
    return worst((printed["y_M"], printed["z_M"]), foot.T)


def foot_N() -> float:  # noqa: N802
    """Of (31) to the letter: N at (0, k3 z_N, z_N)."""
    case, foot = _feet(2)
    x, _, z = case.k.position.T
    vx, _, vz = case.k.velocity.T
    printed = as_printed_dynamic.plane_xz(x, z, vx, vz)
    return worst((0.0, printed["y_N"], printed["z_N"]), (foot[:, 0], 0.0, foot[:, 1]))


def acceleration() -> float:
    """Of (32), the rate of the exact velocity by series, from the closed form."""
    case = _dynamic()
    velocity = [component.rate() for component in position_series(case)]
    printed = as_printed_dynamic.acceleration((velocity[0], velocity[1], velocity[2]))
    return worst([u.value for u in printed], case.k.acceleration.T)


def position_series(case: Case) -> tuple[Series, Series, Series]:
    """Equation (2) put right and turned by omega1 t, as series."""
    t = Series([case.t, 1.0, 0.0])
    u = as_printed.factors(G.wheel_radius, G.phi, G.psi, G.chi, G.a, G.b, G.c)
    right = u._replace(U4=u.U3 * np.cos(G.chi) / u.U5)
    at = case.at
    x, y, z = as_printed.position(right, at.omega16 * t, at.omega6 * t, G.epsilon, G.gamma)
    sine, cosine = np.sin(DYNAMIC.omega1 * t), np.cos(DYNAMIC.omega1 * t)
    return x, y * cosine - z * sine, y * sine + z * cosine


def acceleration_modulus() -> float:
    """Of (33)."""
    k = _dynamic().k
    return worst([as_printed.modulus(tuple(k.acceleration.T))], [k.acceleration_modulus])
