"""The printed equations give what the page prints: each against numbers worked out by hand.

Where the page is wrong the exact result stands beside it, so that nobody takes one for the other.
"""

import math
from math import pi, sqrt

import numpy as np
import pytest
from karetin_cases import geometry

from studies.papers.forms import Forms
from studies.papers.jets import Jet, rate, vector
from studies.papers.karetin import exact, stop_mode
from studies.papers.karetin import projections as right
from studies.papers.karetin.as_printed import (
    PRINTED,
    factors,
    foot,
    length,
    modulus,
    position,
    printed,
)


def close(values):
    return pytest.approx(values, rel=1e-14, abs=1e-14)


def cones(wheel_radius):
    """Factors for phi = psi = 45 degrees, a = b = c = 1."""
    return factors(geometry(wheel_radius=wheel_radius))


def page(**known):
    """What the page makes of quantities by name."""
    return Forms(PRINTED, **known)


def column(*components):
    """A vector at one time."""
    return np.array([components], dtype=float).T


def test_equation_1():
    # omega16 = 90 * 30/20 * (1 - 1/3) = 90, omega6 = 90 * 40/10 = 360
    assert page(omega1=90.0, i=3.0, g=geometry(z2=30, z16=20, z17=40, z6=10)).speeds == close(
        (30.0, 90.0, 360.0)
    )


def test_equation_2_factors():
    # U1 = 1/sin 45, U2 = cos 45 cos 0, U3 = sin 45, U4 = cos 45, U5 = U1 (cos 45 + 0), U6 = U1 U3 sin 90
    assert cones(1.0) == close((sqrt(2), 1 / sqrt(2), 1 / sqrt(2), 1 / sqrt(2), 1.0, 1.0))


def test_equation_2():
    # at 60 degrees cos(pi - 60) = -1/2, sin = sqrt(3)/2, and U2 - U5 U4/2 = 1/(2 sqrt 2):
    # x = sqrt 2 [1/(4 sqrt 2) + 3/(4 sqrt 2)] = 1, y = sqrt 2 [sqrt 3/(4 sqrt 2) - sqrt 3/(4 sqrt 2)] = 0
    angle = pi / 3
    assert position(cones(1.0), angle, angle) == close((1.0, 0.0, 0.5))
    # exact: x = cos + sin sin = 5/4, y = sin - sin cos = sqrt(3)/4
    at = exact(geometry(), stop_mode(1.0), [angle])
    assert at.position[:, 0] == close((1.25, sqrt(3) / 4, 0.5))


def test_equation_2_does_not_scale_with_the_size_of_the_mechanism():
    # wheel radius 2: U5 = 2, so U2 - U5 U4/2 = 0 and x = 2 sqrt 2 (3/4)/sqrt 2 = 3/2, not 2 times 1
    angle = pi / 3
    assert position(cones(2.0), angle, angle) == close((1.5, -sqrt(3) / 2, 1.0))
    at = exact(geometry(wheel_radius=2.0), stop_mode(1.0), [angle])
    assert at.position[:, 0] == close((2.5, sqrt(3) / 2, 1.0))


def test_equation_2_offsets():
    # satellite 20 + 40 degrees, drive 50 + 10 degrees: the same point as at 60 degrees
    degree = pi / 180
    g = geometry(epsilon=40 * degree, gamma=10 * degree)
    found = page(g=g, omega16=50 * degree, omega6=20 * degree, t=1.0).position_in_link1
    assert found == close((1.0, 0.0, 0.5))


def test_equation_3():
    assert page(position=(2.0, 3.0, 6.0)).radius == close(7.0)


def test_equation_4():
    assert page(position=(3.0, 4.0, 12.0)).projections == close((5.0, sqrt(160.0), sqrt(153.0)))


def test_equation_5():
    # D = (-1, 1, -1): arctan(-1), pi/2 - arccos(1/sqrt 2), arccos(-1/sqrt 2)
    assert page(position=(-1.0, 1.0, -1.0)).angles == close((-pi / 4, pi / 4, 3 * pi / 4))
    found = right.angles(column(-1.0, 1.0, -1.0))[:, 0]
    assert found == close((3 * pi / 4, 3 * pi / 4, -3 * pi / 4))


def test_equation_6():
    # D = (-1, 1, -1) rising with 1 m/s: OP = OF = sqrt(1 + z^2) shrinks, so arcsin(1/OP) and arccos(-1/OF)
    # grow with 1/2 rad/s; in truth D turns from -Oz to Oy and from -Ox away from Oz
    D = (Jet(-1.0, 0.0), Jet(1.0, 0.0), Jet(-1.0, 1.0))
    assert page(position=D).angular_velocities.value == close([0.0, 0.5, 0.5])
    found = right.angular_velocities(column(-1.0, 1.0, -1.0), column(0.0, 0.0, 1.0))[:, 0]
    assert found == close((0.0, -0.5, -0.5))


def test_equations_7_and_17():
    parts = page(about_satellite=np.array([1.0, 2.0, 3.0]), about_drive=np.array([10.0, 20.0, 30.0]))
    assert parts.velocity_in_link1.tolist() == [11.0, 22.0, 33.0]


def test_equation_8():
    points = page(position_in_link1=np.array([1.0, 2.0, 3.0]), centre_of_satellite=np.array([5.0, 5.0, 5.0]))
    assert points.arm_of_imbalance.tolist() == [-4.0, -3.0, -2.0]


def test_equation_9():
    spin = page(mu=2.0, centre_of_satellite=np.array([1.0, 2.0, 3.0])).spin_of_satellite
    assert spin.tolist() == [2.0, 4.0, 6.0]
    # exact at the start: from A = (1, 0, 1) to Q = (0, 0, 1), not from O to A
    at = exact(geometry(), stop_mode(7.0), [0.0])
    assert at.spin_of_satellite[:, 0] == close((-7.0, 0.0, 0.0))
    spin = page(mu=7.0, centre_of_satellite=np.array([1.0, 0.0, 1.0])).spin_of_satellite
    assert spin == close((7.0, 0.0, 7.0))


def test_equation_10():
    # A = (3, 0, 5), OQ = 1: 34 - 2*5*1 + 1 = 25
    assert page(omega6=10.0, centre_of_satellite=(3.0, 0.0, 5.0), g=geometry()).mu == close(2.0)


def test_equation_11():
    # AD = (1, 2, 3), A = (4, 5, 6), zQ = 1, mu = 2:
    # 2 (2*5 - 3*5) = -10; -2 (1 (6 - 3*4)) = 12; 2*1*5 - 2*4 = 2
    arms = {"arm_of_imbalance": (1.0, 2.0, 3.0), "centre_of_satellite": (4.0, 5.0, 6.0)}
    assert page(mu=2.0, g=geometry(), **arms).about_satellite == close((-10.0, 12.0, 2.0))
    # exact: AD x (A - Q) mu = 2 (1, 2, 3) x (4, 5, 5) = (-10, 14, -6)


def test_equations_12_18_25_and_33():
    v = (2.0, 3.0, 6.0)
    assert modulus(v) == close(7.0)
    assert (
        page(about_satellite=v).speed_about_satellite
        == page(velocity_in_link1=v).speed_in_link1
        == close(7.0)
    )
    assert page(velocity=v).speed == page(acceleration=v).acceleration_modulus == close(7.0)


def test_equation_13():
    assert page(lambda_=3.0, g=geometry(c=2.0)).spin_of_drive == close((0.0, 0.0, 6.0))


def test_equation_14():
    assert page(angular_velocities=(6.0, 0.0, 0.0), g=geometry(c=2.0)).lambda_ == close(3.0)


def test_equation_15():
    # lambda OQ = 6 rad/s at D = (1, 2, 5): r x omega, while omega x r = (-12, 6, 0)
    assert page(lambda_=3.0, position_in_link1=(1.0, 2.0, 5.0), g=geometry(c=2.0)).about_drive == close(
        (12.0, -6.0, 0.0)
    )


def test_equation_16():
    assert page(about_drive=(3.0, -4.0, 0.0)).speed_about_drive == close(5.0)


def test_equation_19():
    # (100 + 5) * 2; the turn of link 1 is 200
    assert page(omega1=100.0, angular_velocities=(0.0, 5.0, 0.0), t=2.0).alpha == close(210.0)


def test_equation_20():
    assert page(v=3.0, position_in_link1=(2.0, 0.0, 0.0)).spin_of_link1 == close((6.0, 0.0, 0.0))


def test_equation_21():
    # (105 + 5)/2, with omega_alpha = 100 + 5; exact omega1/x = 50
    assert page(omega1=100.0, swing_rate=5.0, position_in_link1=(2.0, 0.0, 0.0)).v == close(55.0)


def test_equation_22():
    # v x = 6 rad/s about Ox at y = 5, z = 7: omega x r = (0, -42, 30)
    assert page(v=3.0, position_in_link1=(2.0, 5.0, 7.0)).about_centre == close((0.0, 42.0, 30.0))


def test_equation_23():
    parts = page(velocity_in_link1=np.array([1.0, 2.0, 3.0]), about_centre=np.array([0.0, 42.0, 30.0]))
    assert parts.sum_of_three.tolist() == [1.0, 44.0, 33.0]


def test_equation_24():
    # alpha = 30 degrees: (1, 2 sin, 4 cos), shorter than V, while a turn keeps its length
    shown = page(sum_of_three=(1.0, 2.0, 4.0), alpha=pi / 6).velocity
    assert shown == close((1.0, 1.0, 2.0 * sqrt(3)))
    assert modulus(shown) == close(sqrt(14.0))
    assert modulus((1.0, sqrt(3) - 2.0, 1.0 + 2.0 * sqrt(3))) == close(sqrt(21.0))


def test_equation_26():
    # (3 + 2*4)/5 = 2.2
    assert page(position=(3.0, 4.0, 0.0), k1=2.0).foot_L == close((2.2, 4.4))


def test_equation_27():
    assert page(velocity=(6.0, -3.0, 0.0)).k1 == close(2.0)


def test_equation_28():
    assert page(foot_L=(3.0, 4.0)).arm_L == close(5.0)


def test_equation_29():
    assert page(velocity=(3.0, 4.0, 0.0)).speed_L == close(5.0)


def test_equation_30():
    # y = 1, z = 2, V_y = 2, V_z = -6: k2 = 6/2 = 3, z_M = (2 + 3*1)/10
    assert page(position=(9.0, 1.0, 2.0), velocity=(9.0, 2.0, -6.0)).foot_M == close((0.5, 1.5))
    assert length(1.5, 0.5) == close(sqrt(2.5))


def test_equation_31_names_y_what_is_x():
    # x = 1, z = 2, V_x = 2, V_z = -6: k3 = 6/2 = 3, z_N = (2 + 3*1)/10; the foot is (1.5, ., 0.5) in x and z
    assert foot((1.0, 9.0, 2.0), 2, 0, 3.0) == close((0.5, 1.5))
    assert page(position=(1.0, 9.0, 2.0), velocity=(2.0, 9.0, -6.0)).foot_N == close((0.0, 1.5, 0.5))
    feet = right.feet(column(1.0, 9.0, 2.0), column(2.0, 9.0, -6.0))[:, 0]
    assert feet[4:] == close((1.5, 0.5))


def test_equation_32():
    # V = (t^2, 3 t, 5) at t = 2: rate (4, 3, 0)
    t = Jet(2.0, 1.0)
    found = page(velocity=vector(t * t, 3.0 * t, 5.0)).acceleration
    assert found.value.tolist() == [4.0, 3.0, 0.0]


def test_jets_carry_out_the_rules_of_differentiation():
    """Against derivatives by hand at t = 0.3."""
    t = Jet(0.3, 1.0, 0.0)
    sine, cosine = math.sin(0.3), math.cos(0.3)
    assert np.sin(t).orders == close((sine, cosine, -sine))
    assert np.cos(t).orders == close((cosine, -sine, -cosine))
    assert np.sqrt(t).orders == close((sqrt(0.3), 0.5 / sqrt(0.3), -0.25 * 0.3**-1.5))
    assert (1.0 / t).orders == close((1 / 0.3, -1 / 0.09, 2 / 0.027))
    assert (np.sin(t) / t).orders[2] == close(-sine / 0.3 - 2 * cosine / 0.09 + 2 * sine / 0.027)
    assert np.arctan(t).orders == close((math.atan(0.3), 1 / 1.09, -0.6 / 1.09**2))
    assert np.arccos(t).orders == close((math.acos(0.3), -1 / sqrt(0.91), -0.3 * 0.91**-1.5))
    assert (-t - 2.0).orders == close((-2.3, -1.0, 0.0))
    assert rate(t * t).orders == close((0.6, 2.0))


def test_a_jet_has_as_many_rates_as_the_shortest_it_is_made_of():
    assert len((Jet(0.3, 1.0, 0.0) * Jet(0.5, 1.0)).orders) == 2
    assert len(vector(Jet(0.3, 1.0, 0.0), Jet(0.5, 1.0), 7.0).orders) == 2


def test_the_printed_chain_feeds_each_equation_with_the_ones_before():
    g, motion, t = geometry(c=1.5, b=1.2, epsilon=0.2), stop_mode(10.0), np.array([0.05, 0.31])
    x, y, _ = position(factors(g), 10.0 * t, 10.0 * t + 0.2)
    np.testing.assert_allclose(printed(g, motion, t, "position")[0], x, rtol=1e-14)
    np.testing.assert_allclose(printed(g, motion, t, "angles")[0], np.arctan(y / x), rtol=1e-13)
    swing = printed(g, motion, t, "angular_velocities")[1]
    np.testing.assert_allclose(printed(g, motion, t, "alpha"), (10.0 + swing) * t, rtol=1e-14)


@pytest.mark.parametrize("name", ["velocity_in_link1", "velocity"])
def test_rates_of_the_printed_chain_are_those_of_its_values(name):
    g, motion, t = geometry(c=1.5, b=1.2, epsilon=0.2), stop_mode(10.0), np.array([0.05, 0.31])
    h = 1e-5
    after, before = (printed(g, motion, t + step, name) for step in (h, -h))
    found = printed(g, motion, t, name.replace("velocity", "acceleration"))
    np.testing.assert_allclose(found, (after - before) / (2 * h), rtol=1e-5)
