"""The printed equations give what the page prints: each against numbers worked out by hand.

Where the page is wrong the exact result stands beside it, so that nobody takes one for the other.
"""

import math
from math import pi, sqrt

import numpy as np
import pytest
from karetin_cases import geometry

from inertia_module.papers.karetin import Kinematics, stop_mode
from inertia_module.papers.karetin import as_printed as page
from inertia_module.papers.karetin import projections as right
from inertia_module.papers.karetin.as_printed import printed
from inertia_module.papers.series import Series


def close(values):
    return pytest.approx(values, rel=1e-14, abs=1e-14)


def cones(wheel_radius):
    """Factors for phi = psi = 45 degrees, a = b = c = 1."""
    return page.factors(wheel_radius, pi / 4, pi / 4, pi / 2, 1.0, 1.0, 1.0)


def test_equation_1():
    # omega16 = 90 * 30/20 * (1 - 1/3) = 90, omega6 = 90 * 40/10 = 360
    assert page.transmission_ratios(90.0, 3.0, 30, 20, 40, 10) == close((30.0, 90.0, 360.0))


def test_equation_2_factors():
    # U1 = 1/sin 45, U2 = cos 45 cos 0, U3 = sin 45, U4 = cos 45, U5 = U1 (cos 45 + 0), U6 = U1 U3 sin 90
    assert cones(1.0) == close((sqrt(2), 1 / sqrt(2), 1 / sqrt(2), 1 / sqrt(2), 1.0, 1.0))


def test_equation_2():
    # at 60 degrees cos(pi - 60) = -1/2, sin = sqrt(3)/2, and U2 - U5 U4/2 = 1/(2 sqrt 2):
    # x = sqrt 2 [1/(4 sqrt 2) + 3/(4 sqrt 2)] = 1, y = sqrt 2 [sqrt 3/(4 sqrt 2) - sqrt 3/(4 sqrt 2)] = 0
    angle = pi / 3
    assert page.position(cones(1.0), angle, angle, 0.0, 0.0) == close((1.0, 0.0, 0.5))
    # exact: x = cos + sin sin = 5/4, y = sin - sin cos = sqrt(3)/4
    at = Kinematics(geometry(), stop_mode(1.0), [angle])
    assert at.position[0] == close((1.25, sqrt(3) / 4, 0.5))


def test_equation_2_does_not_scale_with_the_size_of_the_mechanism():
    # wheel radius 2: U5 = 2, so U2 - U5 U4/2 = 0 and x = 2 sqrt 2 (3/4)/sqrt 2 = 3/2, not 2 times 1
    angle = pi / 3
    assert page.position(cones(2.0), angle, angle, 0.0, 0.0) == close((1.5, -sqrt(3) / 2, 1.0))
    at = Kinematics(geometry(wheel_radius=2.0), stop_mode(1.0), [angle])
    assert at.position[0] == close((2.5, sqrt(3) / 2, 1.0))


def test_equation_2_offsets():
    # satellite 20 + 40 degrees, drive 50 + 10 degrees: the same point as at 60 degrees
    u, degree = cones(1.0), pi / 180
    assert page.position(u, 50 * degree, 20 * degree, 40 * degree, 10 * degree) == close((1.0, 0.0, 0.5))


def test_equation_3():
    assert page.modulus((2.0, 3.0, 6.0)) == close(7.0)


def test_equation_4():
    assert page.projections(3.0, 4.0, 12.0) == close((5.0, sqrt(160.0), sqrt(153.0)))


def test_equation_5():
    # D = (-1, 1, -1): arctan(-1), pi/2 - arccos(1/sqrt 2), arccos(-1/sqrt 2)
    assert page.angles(-1.0, 1.0, sqrt(2), sqrt(2)) == close((-pi / 4, pi / 4, 3 * pi / 4))
    found = right.angles(np.array([[-1.0, 1.0, -1.0]]))[0]
    assert found == close((3 * pi / 4, 3 * pi / 4, -3 * pi / 4))


def test_equation_6():
    # D = (-1, 1, -1) rising with 1 m/s: OP = OF = sqrt(1 + z^2) shrinks, so arcsin(1/OP) and arccos(-1/OF)
    # grow with 1/2 rad/s; in truth D turns from -Oz to Oy and from -Ox away from Oz
    D = (Series([-1.0, 0.0]), Series([1.0, 0.0]), Series([-1.0, 1.0]))
    _, OP, OF = page.projections(*D)
    rates = page.rates(page.angles(D[0], D[1], OP, OF))
    assert [rate.value for rate in rates] == close([0.0, 0.5, 0.5])
    found = right.angular_velocities(np.array([[-1.0, 1.0, -1.0]]), np.array([[0.0, 0.0, 1.0]]))[0]
    assert found == close((0.0, -0.5, -0.5))


def test_equations_7_and_17():
    assert page.sum_of_velocities((1.0, 2.0, 3.0), (10.0, 20.0, 30.0)) == (11.0, 22.0, 33.0)


def test_equation_8():
    assert page.arm_of_imbalance((1.0, 2.0, 3.0), (5.0, 5.0, 5.0)) == (-4.0, -3.0, -2.0)


def test_equation_9():
    assert page.spin_of_satellite(2.0, (1.0, 2.0, 3.0)) == (2.0, 4.0, 6.0)
    # exact at the start: from A = (1, 0, 1) to Q = (0, 0, 1), not from O to A
    at = Kinematics(geometry(), stop_mode(7.0), [0.0])
    assert at.spin_of_satellite[0] == close((-7.0, 0.0, 0.0))
    assert page.spin_of_satellite(7.0, (1.0, 0.0, 1.0)) == close((7.0, 0.0, 7.0))


def test_equation_10():
    # A = (3, 0, 5), OQ = 1: 34 - 2*5*1 + 1 = 25
    assert page.coefficient_mu(10.0, sqrt(34.0), 5.0, 1.0) == close(2.0)


def test_equation_11():
    # AD = (1, 2, 3), A = (4, 5, 6), zQ = 1, mu = 2:
    # 2 (2*5 - 3*5) = -10; -2 (1 (6 - 3*4)) = 12; 2*1*5 - 2*4 = 2
    velocity = page.velocity_about_satellite(2.0, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 1.0)
    assert velocity == close((-10.0, 12.0, 2.0))
    # exact: AD x (A - Q) mu = 2 (1, 2, 3) x (4, 5, 5) = (-10, 14, -6)


def test_equations_12_18_25_and_33():
    assert page.modulus((2.0, 3.0, 6.0)) == close(7.0)


def test_equation_13():
    assert page.spin_of_drive(3.0, 2.0) == close((0.0, 0.0, 6.0))


def test_equation_14():
    assert page.coefficient_lambda(6.0, 2.0) == close(3.0)


def test_equation_15():
    # lambda OQ = 6 rad/s at D = (1, 2, 5): r x omega, while omega x r = (-12, 6, 0)
    assert page.velocity_about_drive(3.0, (1.0, 2.0, 5.0), 2.0) == close((12.0, -6.0, 0.0))


def test_equation_16():
    assert page.length(3.0, -4.0) == close(5.0)


def test_equation_19():
    # (100 + 5) * 2; the turn of link 1 is 200
    assert page.angle_of_turn(100.0, 5.0, 2.0) == close(210.0)


def test_equation_20():
    assert page.spin_of_turn(3.0, 2.0) == close((6.0, 0.0, 0.0))


def test_equation_21():
    # (105 + 5)/2, with omega_alpha = 100 + 5; exact omega1/x = 50
    assert page.coefficient_v(105.0, 5.0, 2.0) == close(55.0)


def test_equation_22():
    # v x = 6 rad/s about Ox at y = 5, z = 7: omega x r = (0, -42, 30)
    assert page.velocity_about_centre(3.0, 2.0, 5.0, 7.0) == close((0.0, 42.0, 30.0))


def test_equation_23():
    assert page.sum_of_velocities((1.0, 2.0, 3.0), (0.0, 42.0, 30.0)) == (1.0, 44.0, 33.0)


def test_equation_24():
    # alpha = 30 degrees: (1, 2 sin, 4 cos), shorter than V, while a turn keeps its length
    shown = page.turned_velocity((1.0, 2.0, 4.0), pi / 6)
    assert shown == close((1.0, 1.0, 2.0 * sqrt(3)))
    assert page.modulus(shown) == close(sqrt(14.0))
    assert page.modulus((1.0, sqrt(3) - 2.0, 1.0 + 2.0 * sqrt(3))) == close(sqrt(21.0))


def test_position_of_the_dynamic_mode_as_the_text_has_it():
    assert page.turned_position(3.0, 2.0, pi / 6) == close((3.0, 1.0, sqrt(3)))


def test_equation_26():
    # (3 + 2*4)/5 = 2.2
    assert page.foot(3.0, 4.0, 2.0) == close((2.2, 4.4))


def test_equation_27():
    assert page.slope(6.0, -3.0) == close(2.0)


def test_equation_28():
    assert page.length(3.0, 4.0) == close(5.0)


def test_equation_29():
    assert page.length(3.0, 4.0) == close(5.0)


def test_equation_30():
    # y = 1, z = 2, V_y = 2, V_z = -6: k2 = 6/2 = 3, z_M = (2 + 3*1)/10
    assert page.slope(-6.0, 2.0) == close(3.0)
    assert page.foot(2.0, 1.0, 3.0) == close((0.5, 1.5))
    assert page.length(1.5, 0.5) == close(sqrt(2.5))


def test_equation_31_names_y_what_is_x():
    # x = 1, z = 2, V_x = 2, V_z = -6: k3 = 6/2 = 3, z_N = (2 + 3*1)/10; the foot is (1.5, ., 0.5) in x and z
    assert page.foot(2.0, 1.0, page.slope(-6.0, 2.0)) == close((0.5, 1.5))
    feet = right.feet(np.array([[1.0, 9.0, 2.0]]), np.array([[2.0, 9.0, -6.0]]))[0]
    assert feet[4:] == close((1.5, 0.5))


def test_equation_32():
    # V = (t^2, 3 t, 5) at t = 2: rate (4, 3, 0)
    t = Series([2.0, 1.0])
    rates = page.rates((t * t, 3.0 * t, 0.0 * t + 5.0))
    assert [rate.value for rate in rates] == [4.0, 3.0, 0.0]


def test_series_are_taylor_series():
    """Of exp(sin t)-like compositions: against derivatives by hand at t = 0.3."""
    t = Series([0.3, 1.0, 0.0])
    sine, cosine = math.sin(0.3), math.cos(0.3)
    assert np.sin(t).c == close([sine, cosine, -sine / 2])
    assert np.cos(t).c == close([cosine, -sine, -cosine / 2])
    assert np.sqrt(t).c == close([sqrt(0.3), 0.5 / sqrt(0.3), -0.125 * 0.3**-1.5])
    assert (1.0 / t).c == close([1 / 0.3, -1 / 0.09, 1 / 0.027])
    assert np.arctan(t).c == close([math.atan(0.3), 1 / 1.09, -0.3 / 1.09**2])
    assert np.arccos(t).c == close([math.acos(0.3), -1 / sqrt(0.91), -0.5 * 0.3 * 0.91**-1.5])
    assert (-t - 2.0).c == close([-2.3, -1.0, 0.0])
    assert (t * t).rate().c == close([0.6, 2.0])


def test_the_printed_chain_feeds_each_equation_with_the_ones_before():
    g, motion, t = geometry(c=1.5, b=1.2, epsilon=0.2), stop_mode(10.0), np.array([0.05, 0.31])
    shown = printed(g, motion, t)
    u = page.factors(1.0, pi / 4, pi / 4, pi / 2, 1.0, 1.2, 1.5)
    x, y, _ = page.position(u, 10.0 * t, 10.0 * t, 0.2, 0.0)
    np.testing.assert_allclose(shown.position[:, 0], x, rtol=1e-14)
    np.testing.assert_allclose(shown.angles[:, 0], np.arctan(y / x), rtol=1e-13)
    np.testing.assert_allclose(shown.alpha[:, 0], (10.0 + shown.angular_velocities[:, 1]) * t, rtol=1e-14)


@pytest.mark.parametrize("name", ["stop_velocity", "velocity"])
def test_rates_of_the_printed_chain_are_those_of_its_values(name):
    g, motion, t = geometry(c=1.5, b=1.2, epsilon=0.2), stop_mode(10.0), np.array([0.05, 0.31])
    h = 1e-5
    after, before = (getattr(printed(g, motion, t + step), name) for step in (h, -h))
    rate = getattr(printed(g, motion, t), name.replace("velocity", "acceleration"))
    np.testing.assert_allclose(rate, (after - before) / (2 * h), rtol=1e-5)
