"""Each formula of Stelmashchuk as printed against a number worked out by hand from the page.

nu^2 = 8 pi^2 and Pi = pi make nu0 = 4 pi^2, chi = 16 pi^4 + 16 pi^4 = 32 pi^4 and nu1 = sqrt(7) pi, hence
nu0/chi = 1/(8 pi^2) = 1/nu^2 and nu0^2/chi = 1/2.
"""

import math

import numpy as np
import pytest

from studies.papers.stelmashchuk import as_printed
from studies.papers.stelmashchuk.criteria import Criteria
from studies.papers.stelmashchuk.exact import response
from studies.papers.stelmashchuk.oscillation import constants

PI = math.pi
CRITERIA = Criteria(nu=math.sqrt(8.0) * PI, Pi=PI)
NU1 = math.sqrt(7.0) * PI
REFERENCE = Criteria(8.0, 0.5)


@pytest.fixture
def s():
    return as_printed.printed(CRITERIA, 1.0)


def test_abbreviations(s):
    assert (s.nu0, s.chi, s.nu1) == pytest.approx((4 * PI**2, 32 * PI**4, NU1))


def test_equation_5_without_the_particular_solution(s):
    # kappa = 1/2 with C1 = 2, C2 = 0: e^(-pi/2) (2 sin(nu1/2) (pi^2 - 7 pi^2) - 2 pi nu1 2 cos(nu1/2))
    sine, cosine = math.sin(NU1 / 2), math.cos(NU1 / 2)
    expected = math.exp(-PI / 2) * (-12 * PI**2 * sine - 4 * PI * NU1 * cosine)
    assert float(as_printed.free_acceleration(s, 0.5, (2.0, 0.0))) == pytest.approx(expected)
    # kappa = 0 with C1 = C2 = 1: (pi^2 - 7 pi^2) - 2 pi nu1
    assert float(as_printed.free_acceleration(s, 0.0, (1.0, 1.0))) == pytest.approx(-6 * PI**2 - 2 * PI * NU1)


def test_free_part_and_its_rate(s):
    # kappa = 0: C2 and nu1 C1 - Pi C2
    assert [float(value) for value in as_printed.free_part(s, 0.0, (3.0, 2.0))] == pytest.approx(
        [2.0, 3 * NU1 - 2 * PI]
    )


def test_second_derivative_of_the_particular_solution_has_four_pi_squared(s):
    # 2 pi nu0/chi = 1/(4 pi); kappa = 1/4: (1/(4 pi)) 4 pi^2; kappa = 0: -(1/(4 pi)) 4 pi^2 pi, right is -pi
    assert float(as_printed.particular_acceleration(s, 0.25)) == pytest.approx(PI)
    assert float(as_printed.particular_acceleration(s, 0.0)) == pytest.approx(-(PI**2))


def test_constants_of_phase_1(s):
    # R0 = 2 pi (1/(8 pi^2) - 1/(8 pi^2)) = 0, R0' = 1/2
    assert pytest.approx((-0.5 / NU1, 0.0), abs=1e-16) == s.C_I


def test_constants_of_phase_2(s):
    # from C = (0, 0): a = 0.5 - 2 pi (2/(8 pi^2)) = 0.5 - 1/(2 pi), a' = 1.5
    # C2 = a + 4 pi/(8 pi^2) - 0.5 = 0, C1 = (1.5 - 2)/nu1
    assert pytest.approx((-0.5 / NU1, 0.0), abs=1e-15) == s.given(C_I=(0.0, 0.0)).C_II


def test_constants_of_phase_3_have_the_bracket_closed_too_early(s):
    # from C = (0, 0), kappa2 = 1: a = 2.5 - 1/(2 pi), a' = 2, R0 = 2.5 - 1/(2 pi), R0' = 1.5
    # printed C1 = (2 + pi (a - R0))/nu1 - 1.5; right is (2 - 1.5)/nu1
    assert pytest.approx((2 / NU1 - 1.5, 0.0), abs=1e-15) == s.given(C_II=(0.0, 0.0)).C_III


def test_undefined_b_enters_the_constants_of_phase_3(s):
    # R0 = 0.5 + B kappa2 - ...: with B = 1 instead of 2 it is smaller by kappa2
    assert s.given(C_II=(0.0, 0.0), B=1.0).C_III[1] == pytest.approx(1.0)


def test_constants_of_phase_4(s):
    # from C = (0, 0): a = 1 + 2 kappa2 - 2 pi (1/(8 pi^2) - 1/(8 pi^2)), a' = 1 - 1/2
    assert pytest.approx((0.5 / NU1, 0.0), abs=1e-15) == s.given(C_III=(0.0, 0.0)).C_IV


def test_whole_printed_solution_starts_with_its_own_numbers():
    # kappa = 0: free part with C1 = -0.5/nu1: -2 pi nu1 C1 = pi, and R'' = -pi^2; the mass really starts at 0
    assert float(as_printed.acceleration(as_printed.printed(CRITERIA, 1.0), 0.0)) == pytest.approx(PI - PI**2)
    assert float(response(0.0, CRITERIA, 1.0).acceleration) == 0.0


def test_only_the_two_misprints_part_printed_from_exact():
    s = as_printed.printed(REFERENCE, 1.0)
    right = constants(REFERENCE, 1.0)
    assert pytest.approx(right[0], rel=1e-12) == s.C_I
    assert pytest.approx(right[1], rel=1e-12) == s.given(C_I=right[0]).C_II
    assert pytest.approx(right[3], rel=1e-12) == s.given(C_III=right[2]).C_IV
    third = s.given(C_II=right[1]).C_III
    R0_rate = 1 + s.nu0**2 / s.chi
    inside = third[0] + R0_rate - R0_rate / s.nu1
    assert (inside, third[1]) == pytest.approx(right[2], rel=1e-12)


def test_printed_solution_is_exact_in_phase_2_and_wrong_elsewhere():
    kappa = np.linspace(0.0, 3.0, 301)
    printed = as_printed.acceleration(as_printed.printed(REFERENCE, 1.0), kappa)
    exact = response(kappa, REFERENCE, 1.0).acceleration
    second = (kappa > 0.5) & (kappa < 1.5)
    assert printed[second] == pytest.approx(exact[second], abs=1e-12)
    assert np.abs(printed - exact)[kappa < 0.5].max() > 1.0
    assert np.abs(printed - exact)[kappa > 1.5].max() > 50.0


@pytest.mark.parametrize("nu, Pi", [(4.4, 5.0), (8.0, 8.0), (2 * PI, 0.0)])
def test_what_the_printed_form_does_not_cover_is_refused(nu, Pi):
    with pytest.raises(ValueError, match="the printed form covers Pi < nu without resonance only"):
        as_printed.printed(Criteria(nu, Pi), 1.0)
