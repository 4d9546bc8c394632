"""The kernel in the page computes what the native FMU computes, and says what that says."""

import numpy as np
import pytest
from tests.unit.scenes import DRIVEN, ELASTIC, SCENES

from inertia_module.contract.variable import LOCAL, OUTPUT
from inertia_module.contract.variables import with_causality
from inertia_module.harness.fmu import Fmu, FmuError

INPUTS = ("omega1", "load_torque", "drive_torque")
READ = [variable.name for variable in with_causality(OUTPUT, LOCAL)]
LOSSES = {
    **{"mesh_efficiency": 0.98, "satellite_mesh_efficiency": 0.98, "journal_friction": 2e-5, "gravity": 9.81},
    **{"housing_drag": 0.3, "output_drag": 0.3, "input_friction": 2e-3, "output_friction": 2e-3},
}
LEVELS = {
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.4},
    "averaged": {"fidelity": 1},
    "rigid": {"fidelity": 2},
    "elastic": ELASTIC,
    "fixed steps": {"fidelity": 2, "method": 1, "max_step": 1e-4},
    "losses": LOSSES,
}
CASES = {
    f"{layout}, {level}, {drive}": {**scene, **values}
    for drive, scenes in (("speed", SCENES), ("torque", DRIVEN))
    for layout, scene in scenes.items()
    for level, values in LEVELS.items()
    if (level, drive) != ("kinematic", "torque")
}
STEP, STEPS = 1e-3, 400


def options(values):
    """What simulate takes, from parameters and inputs in one."""
    parameters = {name: float(value) for name, value in values.items() if name not in INPUTS}
    inputs = {name: values[name] for name in INPUTS if name in values}
    return {"parameters": parameters, "inputs": inputs, "step": STEP, "steps": STEPS, "outputs": READ}


def native(built, given):
    """The same run in the native FMU: rows of READ."""
    with Fmu(built / "InertiaModule.fmu", given["parameters"], given["inputs"]) as fmu:
        rows = [fmu.read(READ)]
        for _ in range(given["steps"]):
            fmu.advance(given["step"])
            rows.append(fmu.read(READ))
    return dict(zip(READ, np.array(rows).T, strict=True))


@pytest.mark.parametrize("case", CASES)
def test_simulate_is_the_native_fmu_in_every_output(still, built, case):
    given = options(CASES[case])
    expected, found = native(built, given), still.simulate(given)
    assert found["time"] == pytest.approx([n * STEP for n in range(STEPS + 1)], abs=0.0, rel=1e-15)
    off = {
        name: np.abs(np.array(found[name]) - values).max() / max(np.abs(values).max(), 1.0)
        for name, values in expected.items()
    }
    assert {name: error for name, error in off.items() if not error <= 1e-9} == {}


BAD = {
    "out of range": {"tolerance": 7.0, "a": -1.0},
    "no number": {"imbalance_mass": float("nan")},
    "no whole teeth": {"z2": 0},
    "together": {"link2_inertia": 0.0, "imbalance_mass": 1e-9},
    "a bad start": {"omega2_start": -3.25},
    "an input": {"omega1": 1e300},
    "an input that is tiny elsewhere": {"load_torque": -1.25e-7, "drive_torque": float("inf")},
}


@pytest.mark.parametrize("case", BAD)
def test_bad_value_gives_the_sentence_of_the_native_fmu(still, built, case):
    given = options(BAD[case])
    with pytest.raises(FmuError) as refused:
        native(built, given)
    assert still.simulate(given) == str(refused.value)
