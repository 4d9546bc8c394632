"""The numbered equations of Karetin over a period of the general case: printed form, exact form.

Each printed form is fed with exact values of all it takes; (1) to (18) in the stop mode, (19) to (33) in
the dynamic mode.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..report import Equations
from ..series import Series
from . import as_printed as page
from . import exact
from .cases import DYNAMIC, GENERAL, STOP, Case, over_period
from .motion import transmission_ratios

G = GENERAL
W1 = DYNAMIC.omega1
# U1 to U6, and with U5 U4 put right
FACTORS = page.factors(G.wheel_radius, G.phi, G.psi, G.chi, G.a, G.b, G.c)
RIGHT_FACTORS = FACTORS._replace(U4=FACTORS.U3 * np.cos(G.chi) / FACTORS.U5)


def stop() -> Case:
    """The general case in the stop mode."""
    return over_period(G, STOP)


def dynamic() -> Case:
    """The general case in the dynamic mode."""
    return over_period(G, DYNAMIC)


def xyz(v: Any) -> Any:
    """Components of vectors of shape (n, 3)."""
    return tuple(v.T)


def position_series(case: Case) -> tuple[Series, Series, Series]:
    """(2) put right and turned by omega1 t, as series."""
    t, at = Series([case.t, 1.0, 0.0]), case.at
    x, y, z = page.position(RIGHT_FACTORS, at.omega16 * t, at.omega6 * t, G.epsilon, G.gamma)
    sine, cosine = np.sin(at.motion.carrier * t), np.cos(at.motion.carrier * t)
    return x, y * cosine - z * sine, y * sine + z * cosine


def angle_series(case: Case) -> tuple[Series, Series, Series]:
    """(5) put right, as series."""
    x, y, z = position_series(case)
    return np.arctan2(y, x), np.arctan2(y, z), np.arctan2(z, x)  # type: ignore[call-overload, no-any-return]


def swing_rate() -> Any:
    """Exact omega_P of D in link 1 in the dynamic mode, rad/s, shape (n,)."""
    y, z = dynamic().at.y, dynamic().at.z
    _, vy, vz = dynamic().k.velocity_in_link1.T
    return (z * vy - y * vz) / (y * y + z * z)


def _values(series: Any) -> tuple[Any, ...]:
    return tuple(u.value for u in series)


def _mu() -> Any:
    A = exact.centre_of_satellite(stop().at)
    return page.coefficient_mu(stop().at.omega6, exact.modulus(A), A[:, 2], G.OQ)


def _centre() -> Any:
    return xyz(exact.centre_of_satellite(stop().at))


def _arm() -> Any:
    return xyz(exact.arm_of_imbalance(stop().at))


def _ratio_of_drive() -> Any:
    """The exact lambda, omega16/OQ."""
    return np.full_like(stop().t, stop().at.omega16 / G.OQ)


def _sum_in_link1() -> tuple[Any, Any]:
    """The sum of (7) and (17), and the rate of the position."""
    total = page.sum_of_velocities(xyz(stop().k.about_satellite), xyz(stop().k.about_drive))
    return total, _values(page.rates(position_series(stop())))


def _sum_of_three() -> tuple[Any, Any]:
    """The sum of (23), in the fixed frame, and the rate of the position."""
    k = dynamic().k
    total = np.stack(page.sum_of_velocities(xyz(k.velocity_in_link1), xyz(k.about_centre)), axis=1)
    return xyz(exact.turned(dynamic().at, total)), _values(page.rates(position_series(dynamic())))


def _foot(number: int) -> tuple[Any, Any]:
    """Feet L, M, N printed and exact, in the order of the coordinates of their planes."""
    (u, v) = ((0, 1), (2, 1), (2, 0))[number]
    r, V = dynamic().k.position.T, dynamic().k.velocity.T
    # k1 = -V_x/V_y, k2 = -V_z/V_y, k3 = -V_z/V_x
    first, second = page.foot(r[u], r[v], page.slope(V[u], V[v]))
    right = dynamic().k.feet[:, 2 * number : 2 * number + 2].T
    return (first, second), (tuple(right) if number == 0 else tuple(right[::-1]))


def _foot_to_the_letter() -> tuple[Any, Any]:
    """N at (0, k3 z_N, z_N)."""
    (z, y), (right_z, right_x) = _foot(2)
    return (0.0, y, z), (right_x, 0.0, right_z)


EQUATIONS: Equations = {
    "(1)": lambda: (
        page.transmission_ratios(W1, 2.0, G.z2, G.z16, G.z17, G.z6),
        transmission_ratios(G, DYNAMIC),
    ),
    "(2)": lambda: (
        page.position(FACTORS, stop().at.omega16 * stop().t, stop().at.omega6 * stop().t, G.epsilon, G.gamma),
        xyz(stop().k.position),
    ),
    "(3)": lambda: (page.modulus(xyz(stop().k.position)), stop().k.radius),
    "(4)": lambda: (page.projections(*stop().k.position.T), xyz(stop().k.projections)),
    "(5)": lambda: (
        page.angles(*stop().k.position.T[:2], *stop().k.projections.T[1:]),
        xyz(stop().k.angles),
    ),
    "(6)": lambda: (_values(page.rates(angle_series(stop()))), xyz(stop().k.angular_velocities)),
    "(7)": _sum_in_link1,
    "(8)": lambda: (page.arm_of_imbalance(xyz(stop().k.position), _centre()), _arm()),
    "(9)": lambda: (page.spin_of_satellite(_mu(), _centre()), xyz(exact.spin_of_satellite(stop().at))),
    "(10)": lambda: (_mu(), stop().at.omega6 / G.QA),
    "(11)": lambda: (
        page.velocity_about_satellite(_mu(), _arm(), _centre(), G.OQ),
        xyz(stop().k.about_satellite),
    ),
    "(12)": lambda: (page.modulus(xyz(stop().k.about_satellite)), abs(stop().at.omega6) * G.AD),
    "(13)": lambda: (page.spin_of_drive(_ratio_of_drive(), G.OQ), (0.0, 0.0, stop().at.omega16)),
    "(14)": lambda: (
        page.coefficient_lambda(stop().k.angular_velocities[:, 0], G.OQ),
        _ratio_of_drive(),
    ),
    "(15)": lambda: (
        page.velocity_about_drive(_ratio_of_drive(), xyz(stop().k.position), G.OQ),
        xyz(stop().k.about_drive),
    ),
    "(16)": lambda: (page.length(*stop().k.about_drive.T[:2]), stop().k.speed_about_drive),
    "(17)": _sum_in_link1,
    "(18)": lambda: (page.modulus(xyz(stop().k.velocity_in_link1)), stop().k.speed),
    "(19)": lambda: (page.angle_of_turn(W1, swing_rate(), dynamic().t), W1 * dynamic().t),
    "(20)": lambda: (page.spin_of_turn(W1 / dynamic().at.x, dynamic().at.x), (W1, 0.0, 0.0)),
    # as v x_D, which (20) and (22) use: v itself has no largest value
    "(21)": lambda: (
        page.coefficient_v(W1 + swing_rate(), swing_rate(), dynamic().at.x) * dynamic().at.x,
        W1,
    ),
    "(22)": lambda: (
        page.velocity_about_centre(W1 / dynamic().at.x, *xyz(exact.position_in_link1(dynamic().at))),
        xyz(dynamic().k.about_centre),
    ),
    "(23)": _sum_of_three,
    "(24)": lambda: (
        page.turned_velocity(xyz(dynamic().k.velocity_in_link1 + dynamic().k.about_centre), W1 * dynamic().t),
        xyz(dynamic().k.velocity),
    ),
    "(25)": lambda: (page.modulus(xyz(dynamic().k.velocity)), dynamic().k.speed),
    "(26)": lambda: _foot(0),
    "(27)": lambda: (
        np.arctan(page.slope(*dynamic().k.velocity.T[:2])),
        np.arctan(dynamic().k.feet[:, 1] / dynamic().k.feet[:, 0]),
    ),
    "(28)": lambda: (page.length(*dynamic().k.feet.T[:2]), dynamic().k.arms[:, 0]),
    "(29)": lambda: (page.length(*dynamic().k.velocity.T[:2]), dynamic().k.plane_speeds[:, 0]),
    "(30)": lambda: _foot(1),
    "(31)": _foot_to_the_letter,
    "(32)": lambda: (
        _values(page.rates(page.rates(position_series(dynamic())))),
        xyz(dynamic().k.acceleration),
    ),
    "(33)": lambda: (page.modulus(xyz(dynamic().k.acceleration)), dynamic().k.acceleration_modulus),
}
