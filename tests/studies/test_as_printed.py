"""Equations that are wrong in print give what the page prints: each against numbers worked out by hand.

Equations that are right are compared with their exact forms (test_papers.py), these with chains of bodies.
"""

from math import asin, atan, cos, exp, pi, sin, sqrt

import numpy as np
import pytest

from studies.papers import karetin, lysenko, stelmashchuk
from studies.papers.engine import Forms, in_time, vector
from studies.papers.karetin import Geometry, stop_mode

# --- Karetin: phi = psi = 45 degrees, AD = QA = OQ = 1 m for a wheel of 1 m ---

DEGREE = pi / 180


def karetins(**known):
    return Forms(karetin.PRINTED, **known)


def cones(size=1.0, **known):
    wheels = Geometry(z17=20, z6=20, shaft_angle=pi / 2, wheel_radius=size)
    return karetins(**karetin.inputs(wheels, stop_mode(1.0), 1.0) | known)


D = {"x_D": 1.0, "y_D": 2.0, "z_D": 5.0}
AT_60, AS_60 = (
    {"A": pi / 3, "B": pi / 3},
    # satellite 20 + 40 degrees, drive 50 + 10 degrees
    {"epsilon": 40 * DEGREE, "gamma": 10 * DEGREE, "omega16": 50 * DEGREE, "omega6": 20 * DEGREE},
)
# D = (-1, 1, -1) rising with 1 m/s, and V = (t^2, 3 t, 5) at t = 2
RISING, T = vector(-1.0, 1.0, in_time(0.0) - 1.0), in_time(2.0)
KARETIN = {
    # U1 = sqrt 2, U2 = U3 = U4 = 1/sqrt 2, U5 = U6 = 1; cos(pi - 60) = -1/2, sin = sqrt(3)/2:
    # x = sqrt 2 [1/(4 sqrt 2) + 3/(4 sqrt 2)] = 1, y = sqrt 2 [sqrt 3/(4 sqrt 2) - sqrt 3/(4 sqrt 2)] = 0
    "(2)": (cones(**AT_60), "position_in_link1", (1.0, 0.0, 0.5)),
    "(2) offsets": (cones(**AS_60), "position_in_link1", (1.0, 0.0, 0.5)),
    # U5 = 2, so U2 - U5 U4/2 = 0 and x = 2 sqrt 2 (3/4)/sqrt 2 = 3/2: it does not scale with the mechanism
    "(2) twice as large": (cones(2.0, **AT_60), "position_in_link1", (1.5, -sqrt(3) / 2, 1.0)),
    # arctan(-1), pi/2 - arccos(1/sqrt 2), arccos(-1/sqrt 2)
    "(5)": (karetins(position=(-1.0, 1.0, -1.0)), "angles", (-pi / 4, pi / 4, 3 * pi / 4)),
    # OP = OF = sqrt(1 + z^2) shrinks, so arcsin(1/OP) and arccos(-1/OF) grow with 1/2 rad/s
    "(6)": (karetins(position=RISING), "angular_velocities", (0.0, 0.5, 0.5)),
    "(9)": (karetins(mu=2.0, centre_of_satellite=np.array([1, 2, 3])), "spin_of_satellite", (2, 4, 6)),
    # 2 (2*5 - 3*5) = -10; -2 (1 (6 - 3*4)) = 12; 2*1*5 - 2*4 = 2, exact are 2 (1, 2, 3) x (4, 5, 5)
    "(11)": (
        karetins(mu=2.0, OQ=1.0, arm_of_imbalance=(1.0, 2.0, 3.0), centre_of_satellite=(4.0, 5.0, 6.0)),
        "about_satellite",
        (-10.0, 12.0, 2.0),
    ),
    "(14)": (karetins(angular_velocities=(6.0, 0.0, 0.0), OQ=2.0), "lambda_", 3.0),
    # lambda OQ = 6 rad/s: r x omega, while omega x r = (-12, 6, 0)
    "(15)": (karetins(**D, lambda_=3.0, OQ=2.0), "about_drive", (12.0, -6.0, 0.0)),
    # (100 + 5) * 2; the turn of link 1 is 200
    "(19)": (karetins(omega1=100.0, angular_velocities=(0.0, 5.0, 0.0), t=2.0), "alpha", 210.0),
    # (105 + 5)/2, with omega_alpha = 100 + 5; exact omega1/x = 50
    "(21)": (karetins(omega1=100.0, swing_rate=5.0, position_in_link1=(2.0, 0.0, 0.0)), "v", 55.0),
    # v x = 6 rad/s about Ox at y = 5, z = 7: omega x r = (0, -42, 30)
    "(22)": (karetins(v=3.0, position_in_link1=(2.0, 5.0, 7.0)), "about_centre", (0.0, 42.0, 30.0)),
    # alpha = 30 degrees: (1, 2 sin, 4 cos), of length sqrt 14, while a turn keeps sqrt 21
    "(24)": (karetins(sum_of_three=(1.0, 2.0, 4.0), alpha=pi / 6), "velocity", (1.0, 1.0, 2.0 * sqrt(3))),
    # x = 1, z = 2, V_x = 2, V_z = -6: k3 = 3, z_N = (2 + 3*1)/10; the foot is (1.5, ., 0.5) in x and z
    "(31)": (karetins(position=(1.0, 9.0, 2.0), velocity=(2.0, 9.0, -6.0)), "foot_N", (0.0, 1.5, 0.5)),
    "(32)": (karetins(velocity=vector(T * T, 3.0 * T, 5.0)), "acceleration", (4.0, 3.0, 0.0)),
}

# --- Lysenko: R = 2 m, r = 1 m, so b = 1/2 and R(1 + b) = 3 m; l = 1 m, m = 2 kg, sum of J = 4 kg m2 ---

WHEEL, OMEGA = lysenko.Mechanism(R0=2.0, r=1.0, arm=1.0, m=2.0, J_carrier=3.0, J_wheel=1.0), 10.0
# at 90 degrees rho = sqrt(10), sin b1 = 3/sqrt(10), cos b1 = 1/sqrt(10), delta = arctan(1/2): 45 less
CUSP, RIGHT, SLOW = (lysenko.printed(WHEEL, *at) for at in ((0.0, OMEGA), (pi / 2, OMEGA), (0.0, 2.0)))
LYSENKO = {
    "(2), note": (lysenko.printed(WHEEL, 2 * pi / 3, OMEGA), "rho_of_note", sqrt(7.0)),
    # 2 * 2 * 10 sqrt(4.5) * 5, from the speed of (7)
    "(5)": (RIGHT, "Fk", 200 * sqrt(4.5)),
    # V1 = l w = 3, V2 = rho b w = 4, beta = 60 deg: sqrt(9 + 16 - 24 cos 60)
    "(6)": (lysenko.printed(WHEEL, 0.0, 3.0, rho=8 / 3, beta1=2 * pi / 3), "resultant", sqrt(13.0)),
    "(7) at the cusp": (CUSP, "V", 20.0),
    "(8)": (RIGHT, "beta1", asin(3 / sqrt(10.0))),
    # sin b1 = 3 sin 60 / sqrt(7)
    "(8) at 60": (lysenko.printed(WHEEL, pi / 3, OMEGA), "beta1", asin(sqrt(27 / 28))),
    "(10)": (RIGHT, "M_of_forces", -1650.0),
    "(13) delta": (RIGHT, "delta", atan(0.5)),
    "(13)": (RIGHT, "k1", sqrt(0.5)),
    # 3 sin(90 + 45)
    "(14)": (RIGHT, "k2", 3 * sqrt(0.5)),
    # 2 * 0.5 * 100 * (0.5 * 3 + 2 sqrt(4.5) sin 45): three times the exact 150
    "(15)": (RIGHT, "M1", 450.0),
    # -2 * 3 * 100 * (1.25 + sqrt(4.5) sin 135): exact are -1200
    "(16)": (RIGHT, "M", -1650.0),
    "(19)": (RIGHT, "J", 4.0 + 2 * 10),
    "(21)": (SLOW, "omega_max", 2.0 * 36 / 12),
    "(22)": (SLOW, "T1", 72.0),
    "(23)": (SLOW, "T2", 216.0),
    "(24)": (SLOW, "T2_of_T1", 216.0),
}

# --- Stelmashchuk: nu^2 = 8 pi^2 and Pi = pi make nu0 = 4 pi^2, chi = 16 pi^4 + 16 pi^4 = 32 pi^4 and
# nu1 = sqrt(7) pi, hence nu0/chi = 1/(8 pi^2) = 1/nu^2 and nu0^2/chi = 1/2 ---

NU1 = sqrt(7.0) * pi


def stelmashchuks(**known):
    return stelmashchuk.printed(stelmashchuk.Criteria(nu=sqrt(8.0) * pi, Pi=pi), 1.0, **known)


STELMASHCHUK = {
    # from C = (0, 0), kappa2 = 1: a = 2.5 - 1/(2 pi), a' = 2, R0 = 2.5 - 1/(2 pi), R0' = 1.5
    # printed C1 = (2 + pi (a - R0))/nu1 - 1.5, the bracket closed too early; right is (2 - 1.5)/nu1
    "C III": (stelmashchuks(C_II=(0.0, 0.0)), "C_III", (2 / NU1 - 1.5, 0.0)),
    # with B = 1, undefined on the page, instead of 2, R0 is smaller by kappa2
    "C III, B": (stelmashchuks(C_II=(0.0, 0.0), B=1.0), "C_III", ((2 + pi) / NU1 - 1.5, 1.0)),
    # without the particular solution: e^(-pi/2) (2 sin(nu1/2) (pi^2 - 7 pi^2) - 2 pi nu1 2 cos(nu1/2))
    "(5)": (
        stelmashchuks(kappa=0.5, C=(2.0, 0.0)),
        "free_acceleration",
        exp(-pi / 2) * (-12 * pi**2 * sin(NU1 / 2) - 4 * pi * NU1 * cos(NU1 / 2)),
    ),
    # (pi^2 - 7 pi^2) - 2 pi nu1
    "(5) at 0": (stelmashchuks(kappa=0.0, C=(1.0, 1.0)), "free_acceleration", -6 * pi**2 - 2 * pi * NU1),
    # 2 pi nu0/chi = 1/(4 pi); (1/(4 pi)) 4 pi^2, and at 0 -(1/(4 pi)) 4 pi^2 pi, right is -pi
    "R″": (stelmashchuks(kappa=0.25), "particular_acceleration", pi),
    "R″ at 0": (stelmashchuks(kappa=0.0), "particular_acceleration", -(pi**2)),
}
ALL = {
    f"{paper} {number}": row
    for paper, table in (("karetin", KARETIN), ("lysenko", LYSENKO), ("stelmashchuk", STELMASHCHUK))
    for number, row in table.items()
}


@pytest.mark.parametrize(("page", "name", "found"), ALL.values(), ids=ALL)
def test_by_hand(page, name, found):
    assert page[name] == pytest.approx(found, rel=1e-14, abs=1e-14)
