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
from .cases import DYNAMIC, GENERAL, STOP, over_period
from .exact import Kinematics, modulus
from .motion import transmission_ratios


def xyz(v: Any) -> Any:
    """Components of vectors of shape (n, 3)."""
    return tuple(v.T)


G, W1 = GENERAL, DYNAMIC.omega1
S, M = STOPPED, MOVING = over_period(G, STOP), over_period(G, DYNAMIC)
W6, W16 = S.omega6, S.omega16
# of the stop mode: D, A, AD, mu and lambda
R, A, AD = xyz(S.position), xyz(S.centre_of_satellite), xyz(S.arm_of_imbalance)
MU = page.coefficient_mu(W6, modulus(S.centre_of_satellite), A[2], G.OQ)
LAMBDA = np.full_like(S.t, W16 / G.OQ)
# of the dynamic mode: D in link 1 and in the fixed frame, V in link 1 with V_Ox, V and a
XL, YL, ZL = M.position_in_link1.T
r, V, a = xyz(M.position), xyz(M.velocity), xyz(M.acceleration)
V_OMEGA = M.velocity_in_link1 + M.about_centre
# U1 to U6, and with U5 U4 put right
FACTORS = page.factors(G.wheel_radius, G.phi, G.psi, G.chi, G.a, G.b, G.c)
RIGHT_FACTORS = FACTORS._replace(U4=FACTORS.U3 * np.cos(G.chi) / FACTORS.U5)


def position_series(case: Kinematics) -> tuple[Series, Series, Series]:
    """(2) put right and turned by omega1 t, as series."""
    t = Series([case.t, 1.0, 0.0])
    x, y, z = page.position(RIGHT_FACTORS, case.omega16 * t, case.omega6 * t, G.epsilon, G.gamma)
    sine, cosine = np.sin(case.motion.carrier * t), np.cos(case.motion.carrier * t)
    return x, y * cosine - z * sine, y * sine + z * cosine


def angle_series(case: Kinematics) -> tuple[Series, Series, Series]:
    """(5) put right, as series."""
    x, y, z = position_series(case)
    return np.arctan2(y, x), np.arctan2(y, z), np.arctan2(z, x)  # type: ignore[call-overload, no-any-return]


def swing_rate() -> Any:
    """Exact omega_P of D in link 1 in the dynamic mode, rad/s, shape (n,)."""
    _, vy, vz = M.velocity_in_link1.T
    return (ZL * vy - YL * vz) / (YL * YL + ZL * ZL)


def _values(series: Any) -> tuple[Any, ...]:
    return tuple(u.value for u in series)


def _sum_in_link1() -> tuple[Any, Any]:
    """The sum of (7) and (17), and the rate of the position."""
    total = page.sum_of_velocities(xyz(S.about_satellite), xyz(S.about_drive))
    return total, _values(page.rates(position_series(S)))


def _sum_of_three() -> tuple[Any, Any]:
    """The sum of (23), in the fixed frame, and the rate of the position."""
    total = page.sum_of_velocities(xyz(M.velocity_in_link1), xyz(M.about_centre))
    return xyz(M.turned(np.stack(total, axis=1))), _values(page.rates(position_series(M)))


def _foot(u: int, v: int) -> Any:
    """Foot in the plane of two coordinates; k1 = -V_x/V_y, k2 = -V_z/V_y, k3 = -V_z/V_x."""
    return page.foot(r[u], r[v], page.slope(V[u], V[v]))


EQUATIONS: Equations = {
    "(1)": lambda: (
        page.transmission_ratios(W1, 2.0, G.z2, G.z16, G.z17, G.z6),
        transmission_ratios(G, DYNAMIC),
    ),
    "(2)": lambda: (page.position(FACTORS, W16 * S.t, W6 * S.t, G.epsilon, G.gamma), R),
    "(3)": lambda: (page.modulus(R), S.radius),
    "(4)": lambda: (page.projections(*R), xyz(S.projections)),
    "(5)": lambda: (page.angles(R[0], R[1], *S.projections.T[1:]), xyz(S.angles)),
    "(6)": lambda: (_values(page.rates(angle_series(S))), xyz(S.angular_velocities)),
    "(7)": _sum_in_link1,
    "(8)": lambda: (page.arm_of_imbalance(R, A), AD),
    "(9)": lambda: (page.spin_of_satellite(MU, A), xyz(S.spin_of_satellite)),
    "(10)": lambda: (MU, W6 / G.QA),
    "(11)": lambda: (page.velocity_about_satellite(MU, AD, A, G.OQ), xyz(S.about_satellite)),
    "(12)": lambda: (page.modulus(xyz(S.about_satellite)), W6 * G.AD),
    "(13)": lambda: (page.spin_of_drive(LAMBDA, G.OQ), (0.0, 0.0, W16)),
    "(14)": lambda: (page.coefficient_lambda(S.angular_velocities[:, 0], G.OQ), LAMBDA),
    "(15)": lambda: (page.velocity_about_drive(LAMBDA, R, G.OQ), xyz(S.about_drive)),
    "(16)": lambda: (page.length(*S.about_drive.T[:2]), S.speed_about_drive),
    "(17)": _sum_in_link1,
    "(18)": lambda: (page.modulus(xyz(S.velocity_in_link1)), S.speed),
    "(19)": lambda: (page.angle_of_turn(W1, swing_rate(), M.t), W1 * M.t),
    "(20)": lambda: (page.spin_of_turn(W1 / XL, XL), (W1, 0.0, 0.0)),
    # as v x_D, which (20) and (22) use: v itself has no largest value
    "(21)": lambda: (page.coefficient_v(W1 + swing_rate(), swing_rate(), XL) * XL, W1),
    "(22)": lambda: (page.velocity_about_centre(W1 / XL, XL, YL, ZL), xyz(M.about_centre)),
    "(23)": _sum_of_three,
    "(24)": lambda: (page.turned_velocity(xyz(V_OMEGA), W1 * M.t), xyz(M.velocity)),
    "(25)": lambda: (page.modulus(V), M.speed),
    "(26)": lambda: (_foot(0, 1), xyz(M.feet[:, :2])),
    "(27)": lambda: (np.arctan(page.slope(V[0], V[1])), np.arctan(M.feet[:, 1] / M.feet[:, 0])),
    "(28)": lambda: (page.length(*M.feet.T[:2]), M.arms[:, 0]),
    "(29)": lambda: (page.length(V[0], V[1]), M.plane_speeds[:, 0]),
    "(30)": lambda: (_foot(2, 1), (M.feet[:, 3], M.feet[:, 2])),
    # to the letter: N at (0, k3 z_N, z_N)
    "(31)": lambda: ((0.0, *_foot(2, 0)[::-1]), (M.feet[:, 4], 0.0, M.feet[:, 5])),
    "(32)": lambda: (_values(page.rates(page.rates(position_series(M)))), xyz(M.acceleration)),
    "(33)": lambda: (page.modulus(a), M.acceleration_modulus),
}
