"""Test the mean motion if a ramp of the input speed crosses zero: a shaft at rest starts again."""

import pytest

from inertia_module.model import Module

PLANAR = {
    **{"layout": "planar", "sun_radius": 0.05, "satellite_radius": 0.03, "eccentricity": 0.02},
    **{"imbalance_mass": 0.8, "satellites": 3, "link2_inertia": 0.003, "output_inertia": 0.4},
}


@pytest.mark.parametrize("parameters, omega1", [({}, 100.0), (PLANAR, 120.0)], ids=["bevel", "planar"])
@pytest.mark.parametrize("load", [5.0, 6.0, 8.0, 10.0, 10.5, 12.5, 16.0])
@pytest.mark.parametrize("duration", [1.0, 10.0, 100.0])
def test_a_ramp_through_zero_takes_few_evaluations(compiled, parameters, omega1, load, duration):
    module = Module(compiled).start(**parameters, fidelity="averaged", omega1=omega1, load_torque=load)
    module.advance(0.1)
    module.set_rates(omega1=-2.0 * omega1 / duration)
    module.advance(duration)
    assert module["rhs_evaluations"] < 2000
    assert module["omega_out"] >= 0.0
