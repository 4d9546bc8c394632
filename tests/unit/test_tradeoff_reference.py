"""The converged reference can be trusted: a second method, which shares nothing with it, agrees."""

import numpy as np
import pytest
from scenes import PLANAR

from inertia_module.studies.canonical import Canonical
from inertia_module.studies.collocation import Collocation, tableau
from inertia_module.studies.reference import agreement
from inertia_module.studies.trajectory import Case, Unavailable

BEVEL = Case()
FLAT = Case(
    {name: value for name, value in PLANAR.items() if name not in ("omega1", "load_torque")},
    PLANAR["omega1"],
    PLANAR["load_torque"],
)


@pytest.mark.parametrize("case", [BEVEL, FLAT], ids=["bevel", "planar"])
def test_two_independent_methods_agree(case):
    found = agreement(case)
    assert found.omega_out < 1e-10
    assert found.events < 1e-10
    assert found.switches[0] == found.switches[1] > 100


def test_collocation_integrates_polynomials_of_its_order():
    nodes, weights, matrix = tableau()
    for power in range(2 * nodes.size):
        assert weights @ nodes**power == pytest.approx(1.0 / (power + 1), rel=1e-15)
    for power in range(nodes.size):
        assert matrix @ nodes**power == pytest.approx(nodes ** (power + 1) / (power + 1), rel=1e-14)


def test_collocation_turns_an_oscillator_to_rounding():
    end, _ = Collocation().step(lambda y: np.array([y[1], -y[0]]), np.array([0.0, 1.0], np.longdouble), 1.0)
    assert end.astype(float) == pytest.approx([np.sin(1.0), np.cos(1.0)], rel=1e-15)


@pytest.mark.parametrize(
    "case",
    [Case(load_torque=-1.0), Case(omega1=-1.0), Case({"output_freewheel": 0.0})],
    ids=["braking", "backwards", "no freewheel"],
)
def test_what_the_second_method_does_not_take_is_said(case):
    with pytest.raises(Unavailable, match="both freewheels"):
        Canonical(case)
