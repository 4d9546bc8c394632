"""Each equation of Lysenko as printed against a number worked out by hand from the page.

R = 2 m, r = 1 m, so b = 1/2 and R(1 + b) = 3 m; l = 1 m, m = 2 kg, sum of J = 4 kg m2, w = 10 rad/s.
At alpha = 90 deg: rho = sqrt(10), sin b1 = 3/sqrt(10), cos b1 = 1/sqrt(10), b1 - delta = 45 deg.
"""

import math

import numpy as np
import pytest

from studies.papers.lysenko.as_printed import printed
from studies.papers.lysenko.exact import exact
from studies.papers.lysenko.mechanism import Mechanism

MECHANISM = Mechanism(R0=2.0, r=1.0, arm=1.0, m=2.0, J_carrier=3.0, J_wheel=1.0)
RIGHT_ANGLE = math.pi / 2
OMEGA = 10.0
ROOT_HALF = math.sqrt(0.5)


@pytest.fixture
def page():
    """Everything the page computes at the right angle."""
    return printed(MECHANISM, RIGHT_ANGLE, OMEGA)


def test_equation_1():
    # X = 3 cos 45 - cos 135 = 4/sqrt(2), Y = 3 sin 45 - sin 135 = 2/sqrt(2)
    x, y = printed(MECHANISM, RIGHT_ANGLE, OMEGA).epicycloid
    assert (float(x), float(y)) == pytest.approx((4 * ROOT_HALF, 2 * ROOT_HALF))


def test_equation_2():
    # sqrt(9 + 1 - 6 cos 60)
    assert printed(MECHANISM, math.pi / 3, OMEGA).rho == pytest.approx(math.sqrt(7.0))


def test_note_on_equation_2():
    assert printed(MECHANISM, 2 * math.pi / 3, OMEGA).rho_of_note == pytest.approx(math.sqrt(7.0))


def test_equation_3():
    assert pytest.approx(200.0) == printed(MECHANISM, 0.0, OMEGA).F1


def test_equation_4(page):
    # 2 sqrt(10) / 4 * 100
    assert pytest.approx(50 * math.sqrt(10.0)) == page.F2


def test_equation_5(page):
    # 2 * 2 * 10 sqrt(4.5) * 5, from the speed of (7)
    assert page.Fk == pytest.approx(200 * math.sqrt(4.5))


def test_equation_6():
    # V1 = l w = 3, V2 = rho b w = 4, beta = 60 deg: sqrt(9 + 16 - 24 cos 60)
    assert printed(MECHANISM, 0.0, 3.0, rho=8 / 3, beta1=2 * math.pi / 3).resultant == pytest.approx(
        math.sqrt(13.0)
    )


def test_equation_7(page):
    # 10 sqrt(1 + 10/4 + 2 sqrt(10)/2 / sqrt(10))
    assert pytest.approx(10 * math.sqrt(4.5)) == page.V
    # at the cusp l w + rho b w, as b1 comes out zero; the imbalance really stands still
    assert pytest.approx(20.0) == printed(MECHANISM, 0.0, OMEGA).V
    assert float(exact(MECHANISM, 0.0, OMEGA).V) == 0.0


def test_equation_8(page):
    assert page.beta1 == pytest.approx(math.asin(3 / math.sqrt(10.0)))
    # alpha = 60 deg: sin b1 = 3 sin 60 / sqrt(7), the angle itself is beyond 90 deg
    beta1 = printed(MECHANISM, math.pi / 3, OMEGA).beta1
    assert beta1 == pytest.approx(math.asin(math.sqrt(27 / 28)))
    assert float(exact(MECHANISM, math.pi / 3).beta1) == pytest.approx(math.pi - beta1)


def test_equation_9(page):
    # F2 n2 + Fk k1 = 150 + 300
    assert page.M1_of_forces == pytest.approx(450.0)


def test_equation_10(page):
    # -F1 n1 - F2 n2 - Fk k2 = -600 - 150 - 900
    assert page.M_of_forces == pytest.approx(-1650.0)


def test_equation_11(page):
    assert page.n1 == pytest.approx(3.0)


def test_equation_12(page):
    assert page.n2 == pytest.approx(3 / math.sqrt(10.0))


def test_equation_13(page):
    # delta = arcsin(3 / (sqrt(10) sqrt(4.5))) = arctan(1/2), b1 = arctan 3: the difference is 45 deg
    assert page.delta == pytest.approx(math.atan(0.5))
    assert page.k1 == pytest.approx(ROOT_HALF)


def test_equation_14(page):
    # 3 sin(90 + 45)
    assert page.k2 == pytest.approx(3 * ROOT_HALF)


def test_equation_15(page):
    # 2 * 0.5 * 100 * (0.5 * 3 + 2 sqrt(4.5) sin 45): three times the exact 150
    assert pytest.approx(450.0) == page.M1
    assert pytest.approx(150.0) == exact(MECHANISM, RIGHT_ANGLE, OMEGA).M1


def test_equation_16(page):
    # -2 * 3 * 100 * (1.25 + sqrt(4.5) sin 135): exact are -1200
    assert pytest.approx(-1650.0) == page.M
    assert pytest.approx(-1200.0) == exact(MECHANISM, RIGHT_ANGLE, OMEGA).M


def test_equation_17(page):
    assert pytest.approx(4500.0) == page.N1


def test_equation_18(page):
    assert pytest.approx(-8250.0) == page.N


def test_equation_19(page):
    assert pytest.approx(4 + 2 * 10) == page.J


def test_equation_20():
    assert printed(MECHANISM, 0.0, 1.0).J_limits == pytest.approx((4 + 2 * 16, 4 + 2 * 4))


def test_equation_21():
    assert printed(MECHANISM, 0.0, 2.0).omega_max == pytest.approx(2.0 * 36 / 12)


def test_equation_22():
    assert pytest.approx(72.0) == printed(MECHANISM, 0.0, 2.0).T1


def test_equation_23():
    assert pytest.approx(216.0) == printed(MECHANISM, 0.0, 2.0).T2


def test_equation_24():
    assert printed(MECHANISM, 0.0, 2.0).T2_of_T1 == pytest.approx(216.0)


def test_equations_15_and_16_follow_from_those_before_as_the_page_says():
    page = printed(MECHANISM, np.linspace(-3.0, 9.0, 101), OMEGA)
    assert pytest.approx(page.M1_of_forces, abs=1e-11) == page.M1
    assert pytest.approx(page.M_of_forces, abs=1e-11) == page.M


def test_printed_moments_have_the_coriolis_force_of_the_absolute_speed():
    angle = np.linspace(-3.0, 9.0, 101)
    b, page = MECHANISM.b, printed(MECHANISM, angle, OMEGA)
    assert pytest.approx(3.0 * exact(MECHANISM, angle, OMEGA).M1, abs=1e-10) == page.M1
    acute = np.abs(exact(MECHANISM, angle).beta1) < math.pi / 2
    assert acute.any()
    right = exact(MECHANISM, angle, OMEGA).M
    assert page.M[acute] == pytest.approx((1 + 3 * b**2 / (1 + 2 * b)) * right[acute], abs=1e-10)


def test_arm_14_lacks_a_term_even_for_the_direction_the_page_takes(page):
    # the moment about O of a unit force at the imbalance, turned by b1 - delta from the arm of the wheel
    place = complex(exact(MECHANISM, RIGHT_ANGLE).place)
    turned = page.beta1 - page.delta
    force = -np.exp(1j * (RIGHT_ANGLE + turned))
    arm = -(place.real * force.imag - place.imag * force.real)
    assert arm == pytest.approx(page.k2 - math.sin(turned))


def test_printed_form_refuses_an_imbalance_that_passes_through_the_centre():
    with pytest.raises(ValueError, match=r"^arm must not be R0 \+ r .*, is 3\.0"):
        _ = printed(Mechanism(2.0, 1.0, 3.0, 1.0), np.array([0.0, 1.0]), OMEGA).beta1
