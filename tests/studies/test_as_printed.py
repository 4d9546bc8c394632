"""Equations that are wrong in print give what the page prints: each against numbers worked out by hand.

The exact result stands beside it, so that nobody takes one for the other. Equations that are right are
compared with their exact forms (test_papers.py), and these with chains of bodies.
"""

import math
from math import pi, sqrt

import numpy as np
import pytest

from studies.papers import karetin, lysenko, stelmashchuk
from studies.papers.engine import Forms, in_time, rate, vector
from studies.papers.karetin import Geometry, exact, stop_mode
from studies.papers.stelmashchuk import REFERENCE, Criteria, response


def close(values):
    return pytest.approx(values, rel=1e-14, abs=1e-14)


# --- Karetin ---

DEGREE = pi / 180


def geometry(**parameters):
    """A geometry of simple numbers: phi = psi = 45 degrees, AD = QA = OQ = 1 m."""
    return Geometry(**({"z17": 20, "z6": 20, "shaft_angle": pi / 2, "wheel_radius": 1.0} | parameters))


D = {"x_D": 1.0, "y_D": 2.0, "z_D": 5.0}
# phi = psi = 45 degrees, a = b = c = 1
CONES = karetin.inputs(geometry(), stop_mode(1.0), 1.0)
AT_60 = CONES | {"A": pi / 3, "B": pi / 3}
KARETIN = {
    # 1/sin 45; cos 45 cos 0; sin 45; cos 45; U1 (cos 45 + 0); U1 U3 sin 90
    "(2) U1": (CONES, "U1", sqrt(2)),
    "(2) U2": (CONES, "U2", 1 / sqrt(2)),
    "(2) U3": (CONES, "U3", 1 / sqrt(2)),
    "(2) U4": (CONES, "U4", 1 / sqrt(2)),
    "(2) U5": (CONES, "U5", 1.0),
    "(2) U6": (CONES, "U6", 1.0),
    # cos(pi - 60) = -1/2, sin = sqrt(3)/2, and U2 - U5 U4/2 = 1/(2 sqrt 2):
    # x = sqrt 2 [1/(4 sqrt 2) + 3/(4 sqrt 2)] = 1, y = sqrt 2 [sqrt 3/(4 sqrt 2) - sqrt 3/(4 sqrt 2)] = 0
    "(2)": (AT_60, "position_in_link1", (1.0, 0.0, 0.5)),
    # satellite 20 + 40 degrees, drive 50 + 10 degrees: the same point as at 60 degrees
    "(2) offsets": (
        CONES | {"epsilon": 40 * DEGREE, "gamma": 10 * DEGREE, "omega16": 50 * DEGREE, "omega6": 20 * DEGREE},
        "position_in_link1",
        (1.0, 0.0, 0.5),
    ),
    # arctan(-1), pi/2 - arccos(1/sqrt 2), arccos(-1/sqrt 2)
    "(5)": ({"position": (-1.0, 1.0, -1.0)}, "angles", (-pi / 4, pi / 4, 3 * pi / 4)),
    "(9)": ({"mu": 2.0, "centre_of_satellite": np.array([1, 2, 3])}, "spin_of_satellite", (2, 4, 6)),
    # 2 (2*5 - 3*5) = -10; -2 (1 (6 - 3*4)) = 12; 2*1*5 - 2*4 = 2, exact are 2 (1, 2, 3) x (4, 5, 5)
    "(11)": (
        {"mu": 2.0, "OQ": 1.0, "arm_of_imbalance": (1.0, 2.0, 3.0), "centre_of_satellite": (4.0, 5.0, 6.0)},
        "about_satellite",
        (-10.0, 12.0, 2.0),
    ),
    "(14)": ({"angular_velocities": (6.0, 0.0, 0.0), "OQ": 2.0}, "lambda_", 3.0),
    # lambda OQ = 6 rad/s: r x omega, while omega x r = (-12, 6, 0)
    "(15)": (D | {"lambda_": 3.0, "OQ": 2.0}, "about_drive", (12.0, -6.0, 0.0)),
    # (100 + 5) * 2; the turn of link 1 is 200
    "(19)": ({"omega1": 100.0, "angular_velocities": (0.0, 5.0, 0.0), "t": 2.0}, "alpha", 210.0),
    # (105 + 5)/2, with omega_alpha = 100 + 5; exact omega1/x = 50
    "(21)": ({"omega1": 100.0, "swing_rate": 5.0, "position_in_link1": (2.0, 0.0, 0.0)}, "v", 55.0),
    # v x = 6 rad/s about Ox at y = 5, z = 7: omega x r = (0, -42, 30)
    "(22)": ({"v": 3.0, "position_in_link1": (2.0, 5.0, 7.0)}, "about_centre", (0.0, 42.0, 30.0)),
    # alpha = 30 degrees: (1, 2 sin, 4 cos), of length sqrt 14, while a turn keeps sqrt 21
    "(24)": ({"sum_of_three": (1.0, 2.0, 4.0), "alpha": pi / 6}, "velocity", (1.0, 1.0, 2.0 * sqrt(3))),
    # x = 1, z = 2, V_x = 2, V_z = -6: k3 = 3, z_N = (2 + 3*1)/10; the foot is (1.5, ., 0.5) in x and z
    "(31)": ({"position": (1.0, 9.0, 2.0), "velocity": (2.0, 9.0, -6.0)}, "foot_N", (0.0, 1.5, 0.5)),
}


@pytest.mark.parametrize(("known", "name", "found"), KARETIN.values(), ids=KARETIN)
def test_karetin_by_hand(known, name, found):
    assert getattr(Forms(karetin.PRINTED, **known), name) == close(found)


def test_karetin_exact_where_the_page_is_wrong():
    at_60 = exact(geometry(), stop_mode(1.0), [pi / 3])
    # x = cos + sin sin, y = sin - sin cos
    assert at_60.position[:, 0] == close((1.25, sqrt(3) / 4, 0.5))
    assert exact(geometry(), stop_mode(7.0), [0.0]).spin_of_satellite[:, 0] == close((-7.0, 0.0, 0.0))
    point, velocity = np.array([[-1.0, 1.0, -1.0]]).T, np.array([[0.0, 0.0, 1.0]]).T
    assert karetin.angles_of(point)[:, 0] == close((3 * pi / 4, 3 * pi / 4, -3 * pi / 4))
    assert karetin.angular_velocities_of(point, velocity)[:, 0] == close((0.0, -0.5, -0.5))
    feet = karetin.feet_of(np.array([[1.0, 9.0, 2.0]]).T, np.array([[2.0, 9.0, -6.0]]).T)
    assert feet[2, :, 0] == close((1.5, 0.0, 0.5))


def test_karetin_2_does_not_scale_with_the_size_of_the_mechanism():
    # wheel radius 2: U5 = 2, so U2 - U5 U4/2 = 0 and x = 2 sqrt 2 (3/4)/sqrt 2 = 3/2, not 2 times 1
    twice = karetin.inputs(geometry(wheel_radius=2.0), stop_mode(1.0), 1.0) | {"A": pi / 3, "B": pi / 3}
    assert Forms(karetin.PRINTED, **twice).position_in_link1 == close((1.5, -sqrt(3) / 2, 1.0))
    at = exact(geometry(wheel_radius=2.0), stop_mode(1.0), [pi / 3])
    assert at.position[:, 0] == close((2.5, sqrt(3) / 2, 1.0))


def test_karetin_6_and_32_are_rates():
    # D = (-1, 1, -1) rising with 1 m/s: OP = OF = sqrt(1 + z^2) shrinks, so arcsin(1/OP) and arccos(-1/OF)
    # grow with 1/2 rad/s; in truth D turns from -Oz to Oy and from -Ox away from Oz
    rising = vector(-1.0, 1.0, in_time(0.0) - 1.0)
    assert Forms(karetin.PRINTED, position=rising).angular_velocities == close([0.0, 0.5, 0.5])
    # V = (t^2, 3 t, 5) at t = 2
    t = in_time(2.0)
    assert Forms(karetin.PRINTED, velocity=vector(t * t, 3.0 * t, 5.0)).acceleration == close([4.0, 3.0, 0.0])


def test_a_rate_is_the_derivative():
    t = in_time(0.3)
    for found, right in (
        (np.sin(t), math.cos(0.3)),
        (np.sqrt(t), 0.5 / sqrt(0.3)),
        (np.sin(t) / t, math.cos(0.3) / 0.3 - math.sin(0.3) / 0.09),
        (np.arctan(t), 1 / 1.09),
        (np.arccos(t), -1 / sqrt(0.91)),
    ):
        assert rate(found) == close(right)


def test_karetins_chain_feeds_each_equation_with_the_ones_before():
    g, motion, t = geometry(c=1.5, b=1.2, epsilon=0.2), stop_mode(10.0), np.array([0.05, 0.31])
    cones = karetin.inputs(g, motion, t) | {"A": 10.0 * t, "B": 10.0 * t + 0.2}
    x, y, _ = Forms(karetin.PRINTED, **cones).position_in_link1
    np.testing.assert_allclose(karetin.printed(g, motion, t, "position")[0], x, rtol=1e-14)
    np.testing.assert_allclose(karetin.printed(g, motion, t, "angles")[0], np.arctan(y / x), rtol=1e-13)
    swing = karetin.printed(g, motion, t, "angular_velocities")[1]
    np.testing.assert_allclose(karetin.printed(g, motion, t, "alpha"), (10.0 + swing) * t, rtol=1e-14)
    h = 1e-5
    after, before = (karetin.printed(g, motion, t + step, "angles") for step in (h, -h))
    found = karetin.printed(g, motion, t, "angular_velocities")
    np.testing.assert_allclose(found, (after - before) / (2 * h), rtol=1e-5)


# --- Lysenko: R = 2 m, r = 1 m, so b = 1/2 and R(1 + b) = 3 m; l = 1 m, m = 2 kg, sum of J = 4 kg m2 ---

WHEEL = lysenko.Mechanism(R0=2.0, r=1.0, arm=1.0, m=2.0, J_carrier=3.0, J_wheel=1.0)
OMEGA, HALF = 10.0, math.sqrt(0.5)
# quantity, what the page gives by hand, angle alpha, speed omega; at 90 degrees rho = sqrt(10),
# sin b1 = 3/sqrt(10), cos b1 = 1/sqrt(10), delta = arctan(1/2), b1 - delta = 45 degrees
LYSENKO = {
    "(2), note": ("rho_of_note", math.sqrt(7.0), 2 * pi / 3, OMEGA),
    # 2 * 2 * 10 sqrt(4.5) * 5, from the speed of (7)
    "(5)": ("Fk", 200 * math.sqrt(4.5), pi / 2, OMEGA),
    "(7) at the cusp": ("V", 20.0, 0.0, OMEGA),
    "(8)": ("beta1", math.asin(3 / math.sqrt(10.0)), pi / 2, OMEGA),
    # sin b1 = 3 sin 60 / sqrt(7)
    "(8) at 60": ("beta1", math.asin(math.sqrt(27 / 28)), pi / 3, OMEGA),
    "(10)": ("M_of_forces", -1650.0, pi / 2, OMEGA),
    "(13) delta": ("delta", math.atan(0.5), pi / 2, OMEGA),
    "(13)": ("k1", HALF, pi / 2, OMEGA),
    # 3 sin(90 + 45)
    "(14)": ("k2", 3 * HALF, pi / 2, OMEGA),
    # 2 * 0.5 * 100 * (0.5 * 3 + 2 sqrt(4.5) sin 45): three times the exact 150
    "(15)": ("M1", 450.0, pi / 2, OMEGA),
    # -2 * 3 * 100 * (1.25 + sqrt(4.5) sin 135): exact are -1200
    "(16)": ("M", -1650.0, pi / 2, OMEGA),
    "(19)": ("J", 4.0 + 2 * 10, pi / 2, OMEGA),
    "(21)": ("omega_max", 2.0 * 36 / 12, 0.0, 2.0),
    "(22)": ("T1", 72.0, 0.0, 2.0),
    "(23)": ("T2", 216.0, 0.0, 2.0),
    "(24)": ("T2_of_T1", 216.0, 0.0, 2.0),
}


@pytest.mark.parametrize(("name", "found", "alpha", "omega"), LYSENKO.values(), ids=LYSENKO)
def test_lysenko_by_hand(name, found, alpha, omega):
    assert getattr(lysenko.printed(WHEEL, alpha, omega), name) == pytest.approx(found)


def test_lysenko_6():
    # V1 = l w = 3, V2 = rho b w = 4, beta = 60 deg: sqrt(9 + 16 - 24 cos 60)
    page = lysenko.printed(WHEEL, 0.0, 3.0, rho=8 / 3, beta1=2 * pi / 3)
    assert page.resultant == pytest.approx(math.sqrt(13.0))


def test_lysenko_exact_where_the_page_is_wrong():
    assert float(lysenko.exact(WHEEL, 0.0, OMEGA).V) == 0.0
    # the angle itself is beyond 90 deg
    assert float(lysenko.exact(WHEEL, pi / 3).beta1) == pytest.approx(pi - math.asin(math.sqrt(27 / 28)))
    at = lysenko.exact(WHEEL, pi / 2, OMEGA)
    assert (float(at.M1), float(at.M)) == pytest.approx((150.0, -1200.0))


def test_lysenko_15_and_16_follow_from_those_before_and_have_the_coriolis_force_of_the_absolute_speed():
    angle = np.linspace(-3.0, 9.0, 101)
    b, page, e = WHEEL.b, lysenko.printed(WHEEL, angle, OMEGA), lysenko.exact(WHEEL, angle, OMEGA)
    assert pytest.approx(page.M1_of_forces, abs=1e-11) == page.M1
    assert pytest.approx(page.M_of_forces, abs=1e-11) == page.M
    assert pytest.approx(3.0 * e.M1, abs=1e-10) == page.M1
    acute = np.abs(e.beta1) < pi / 2
    assert acute.any()
    assert page.M[acute] == pytest.approx((1 + 3 * b**2 / (1 + 2 * b)) * e.M[acute], abs=1e-10)


def test_lysenkos_arm_14_lacks_a_term_even_for_the_direction_the_page_takes():
    # the moment about O of a unit force at the imbalance, turned by b1 - delta from the arm of the wheel
    page, place = lysenko.printed(WHEEL, pi / 2, OMEGA), complex(lysenko.exact(WHEEL, pi / 2).place)
    turned = page.beta1 - page.delta
    arm = -lysenko.moment(place, -np.exp(1j * (pi / 2 + turned)))
    assert arm == pytest.approx(page.k2 - math.sin(turned))


# --- Stelmashchuk: nu^2 = 8 pi^2 and Pi = pi make nu0 = 4 pi^2, chi = 16 pi^4 + 16 pi^4 = 32 pi^4 and
# nu1 = sqrt(7) pi, hence nu0/chi = 1/(8 pi^2) = 1/nu^2 and nu0^2/chi = 1/2 ---

CRITERIA, NU1 = Criteria(nu=math.sqrt(8.0) * pi, Pi=pi), math.sqrt(7.0) * pi
STELMASHCHUK = {
    # from C = (0, 0), kappa2 = 1: a = 2.5 - 1/(2 pi), a' = 2, R0 = 2.5 - 1/(2 pi), R0' = 1.5
    # printed C1 = (2 + pi (a - R0))/nu1 - 1.5, the bracket closed too early; right is (2 - 1.5)/nu1
    "C III": ({"C_II": (0.0, 0.0)}, "C_III", (2 / NU1 - 1.5, 0.0)),
    # with B = 1, undefined on the page, instead of 2, R0 is smaller by kappa2
    "C III, B": ({"C_II": (0.0, 0.0), "B": 1.0}, "C_III", ((2 + pi) / NU1 - 1.5, 1.0)),
}


@pytest.mark.parametrize(("known", "name", "found"), STELMASHCHUK.values(), ids=STELMASHCHUK)
def test_stelmashchuk_by_hand(known, name, found):
    assert getattr(stelmashchuk.printed(CRITERIA, 1.0, **known), name) == close(found)


def test_stelmashchuk_5_without_the_particular_solution():
    s = stelmashchuk.printed(CRITERIA, 1.0)
    # kappa = 1/2 with C1 = 2, C2 = 0: e^(-pi/2) (2 sin(nu1/2) (pi^2 - 7 pi^2) - 2 pi nu1 2 cos(nu1/2))
    sine, cosine = math.sin(NU1 / 2), math.cos(NU1 / 2)
    expected = math.exp(-pi / 2) * (-12 * pi**2 * sine - 4 * pi * NU1 * cosine)
    assert float(s.replaced(kappa=0.5, C=(2.0, 0.0)).free_acceleration) == pytest.approx(expected)
    # kappa = 0 with C1 = C2 = 1: (pi^2 - 7 pi^2) - 2 pi nu1; the part itself and its rate: C2, nu1 C1 - Pi C2
    found = float(s.replaced(kappa=0.0, C=(1.0, 1.0)).free_acceleration)
    assert found == pytest.approx(-6 * pi**2 - 2 * pi * NU1)
    assert stelmashchuk.free_part(0.0, (3.0, 2.0), NU1, pi) == pytest.approx((2.0, 3 * NU1 - 2 * pi))


def test_second_derivative_of_the_particular_solution_has_four_pi_squared():
    s = stelmashchuk.printed(CRITERIA, 1.0)
    # 2 pi nu0/chi = 1/(4 pi); kappa = 1/4: (1/(4 pi)) 4 pi^2; kappa = 0: -(1/(4 pi)) 4 pi^2 pi, right is -pi
    assert float(s.replaced(kappa=0.25).particular_acceleration) == pytest.approx(pi)
    assert float(s.replaced(kappa=0.0).particular_acceleration) == pytest.approx(-(pi**2))
    # kappa = 0: free part with C1 = -0.5/nu1: -2 pi nu1 C1 = pi, and R'' = -pi^2; the mass really starts at 0
    assert float(stelmashchuk.acceleration(s, 0.0)) == pytest.approx(pi - pi**2)
    assert float(response(0.0, CRITERIA, 1.0).acceleration) == 0.0


def test_stelmashchuks_solution_is_exact_in_phase_2_and_wrong_elsewhere():
    kappa = np.linspace(0.0, 3.0, 301)
    page = stelmashchuk.acceleration(stelmashchuk.printed(REFERENCE, 1.0), kappa)
    right = response(kappa, REFERENCE, 1.0).acceleration
    second = (kappa > 0.5) & (kappa < 1.5)
    assert page[second] == pytest.approx(right[second], abs=1e-12)
    assert np.abs(page - right)[kappa < 0.5].max() > 1.0
    assert np.abs(page - right)[kappa > 1.5].max() > 50.0
