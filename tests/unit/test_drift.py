"""Errors of the energy do not add up over a hundred thousand pulses."""

import pytest
from scenes import FREEWHEELS, REFERENCE, advanced, started

# energy residual over the largest energy, at tolerance 1e-6
WITH_JACOBI, WITHOUT = 3e-5, 1e-4
LONG = {
    "thrown": ({}, WITH_JACOBI),
    "thrown, loaded": ({"load_torque": 1.0}, WITH_JACOBI),
    "heavy output": ({"output_inertia": 500.0}, WITH_JACOBI),
    "elastic": ({"fidelity": 3, "shaft_damping": 0.1}, WITHOUT),
    "torque given": ({"drive": 1, "input_inertia": 0.5}, WITHOUT),
}


@pytest.mark.parametrize("omega1", [100.0, -100.0])
@pytest.mark.parametrize("freewheels", FREEWHEELS)
@pytest.mark.parametrize("values, bound", LONG.values(), ids=LONG)
def test_energy_residual_of_a_long_run_is_within_its_bound(compiled, values, bound, freewheels, omega1):
    scene = {**REFERENCE, "omega1": omega1, "load_torque": 0.0, **values}
    module = started(compiled, scene, FREEWHEELS[freewheels])
    largest = module["energy_stored"]
    for _ in range(5):
        advanced(module, 40.0)
        largest = max(largest, *(abs(module[f"energy_{name}"]) for name in ("in", "out", "stored")))
    assert abs(module["energy_residual"]) < bound * largest
