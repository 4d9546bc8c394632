"""Test the printed forms of wrong equations with numbers computed by hand.

test_papers.py compares right equations with their exact forms. Other tests compare exact forms with chains of
rotated bodies.
"""

import math
import tomllib
from math import pi, sqrt
from pathlib import Path

import pytest

from papers import karetin, lysenko, stelmashchuk
from papers.engine import Forms, in_time, vector
from papers.karetin import Geometry, stop_mode

# --- Karetin: phi = psi = 45 degrees, AD = QA = OQ = 1 m for a wheel of 1 m ---

DEGREE = pi / 180


def karetin_forms(**values):
    return Forms(karetin.PRINTED, **values)


def cones(size=1.0, **values):
    wheels = Geometry(z17=20, z6=20, shaft_angle=pi / 2, wheel_radius=size)
    return karetin_forms(**karetin.inputs(wheels, stop_mode(1.0), 1.0) | values)


D = {"x_D": 1.0, "y_D": 2.0, "z_D": 5.0}
AT_60, AS_60 = (
    {"A": pi / 3, "B": pi / 3},
    # satellite 20 + 40 degrees, pinion shaft 50 + 10 degrees
    {"epsilon": 40 * DEGREE, "gamma": 10 * DEGREE, "omega16": 50 * DEGREE, "omega6": 20 * DEGREE},
)
# D = (-1, 1, -1) rising with 1 m/s, and V = (t^2, 3 t, 5) at t = 2
RISING, T = vector(-1.0, 1.0, in_time(0.0) - 1.0), in_time(2.0)

# --- Lysenko: R = 2 m, r = 1 m, so b = 1/2 and R(1 + b) = 3 m; l = 1 m, m = 2 kg, sum of J = 4 kg m2 ---

WHEEL, OMEGA = lysenko.Mechanism(R0=2.0, r=1.0, arm=1.0, m=2.0, J_carrier=3.0, J_wheel=1.0), 10.0
# at 90 degrees rho = sqrt(10), sin b1 = 3/sqrt(10), cos b1 = 1/sqrt(10), delta = arctan(1/2): 45 less
CUSP, RIGHT, SLOW = (lysenko.printed(WHEEL, *at) for at in ((0.0, OMEGA), (pi / 2, OMEGA), (0.0, 2.0)))

# --- Stelmashchuk: nu^2 = 8 pi^2 and Pi = pi make nu0 = 4 pi^2, chi = 16 pi^4 + 16 pi^4 = 32 pi^4 and
# nu1 = sqrt(7) pi, hence nu0/chi = 1/(8 pi^2) = 1/nu^2 and nu0^2/chi = 1/2 ---

NU1 = sqrt(7.0) * pi


def stelmashchuk_forms(**values):
    return stelmashchuk.printed(stelmashchuk.Criteria(nu=sqrt(8.0) * pi, Pi=pi), 1.0, **values)


# rows by paper: number, printed forms, name of a quantity, formula of its value
TABLE = tomllib.loads(Path(__file__).with_name("as_printed.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("forms", "name", "value"),
    [pytest.param(*row, id=f"{paper} {number}") for paper, rows in TABLE.items() for number, *row in rows],
)
def test_printed_form_has_the_value_computed_by_hand(forms, name, value):
    scope = vars(math) | globals()
    assert eval(forms, scope)[name] == pytest.approx(eval(value, scope), rel=1e-14, abs=1e-14)
