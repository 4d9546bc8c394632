"""Module and shaft as two FMUs, coupled by schemes, against the elastic module in one piece."""

import math

import pytest

from inertia_module.cosimulation.shaft import SHAFT_SCHEMES, CoupledShaft
from inertia_module.instance import Fmu
from inertia_module.studies.coupling import shafts


@pytest.mark.parametrize(
    "name, order",
    [
        ("mean, jacobi", 1.0),
        ("mean, module first", 1.0),
        ("instant, module first, derivatives", 2.0),
        ("implicit", 2.0),
    ],
)
def test_two_fmus_tend_to_the_elastic_module_with_the_order_of_the_scheme(built, name, order):
    paths = built / "InertiaModule.fmu", built / "DrivenShaft.fmu"
    expected = shafts.one_piece(400.0, paths[0], 0.3)
    errors = [
        shafts.shaft_trial(400.0, name, SHAFT_SCHEMES[name], step, expected, paths).driven_error
        for step in (5e-4, 1e-4)
    ]
    assert math.log(errors[0] / errors[1]) / math.log(5.0) > 0.8 * order


def test_recommended_shaft_coupling_loses_no_energy_where_the_mean_torque_makes_some(built):
    paths = built / "InertiaModule.fmu", built / "DrivenShaft.fmu"
    expected = shafts.one_piece(400.0, paths[0], 0.3)
    found = {
        name: shafts.shaft_trial(400.0, name, SHAFT_SCHEMES[name], 1e-3, expected, paths)
        for name in ("mean, jacobi", "instant, module first, derivatives")
    }
    assert found["mean, jacobi"].bond_error < -0.1
    assert abs(found["instant, module first, derivatives"].bond_error) < 1e-3
    assert found["instant, module first, derivatives"].driven_error < 2e-3


def test_hub_and_shaft_at_different_speeds_are_refused(built):
    with (
        Fmu(built / "InertiaModule.fmu", {"omega_out_start": 5.0}, {"omega1": 100.0}) as module,
        Fmu(built / "DrivenShaft.fmu", {}, {"hub_speed": 0.0}) as shaft,
        pytest.raises(
            ValueError, match="hub_speed = 0 rad/s is refused: allowed is the module's omega_out = 5"
        ),
    ):
        CoupledShaft(module, shaft, SHAFT_SCHEMES["implicit"])
