"""What is lost over very long runs stays within the bound that the documentation gives."""

import pytest
from scenes import ELASTIC, PLANAR

from inertia_module.memory import Module

# the residual over the largest energy: tolerances at once, and for each turn of link 1 and of the drives
AT_ONCE = 100.0
PER_TURN = 0.1


KINDS = {
    "bevel": {},
    "planar": PLANAR,
    "no housing freewheel": {"housing_freewheel": 0},
    "heavy output": {"output_inertia": 500.0},
    "elastic": ELASTIC,
}


RUNS = [(0, -100.0, 0.0), (0, 100.0, 0.0), (0, 30.0, 3.0), (1, -100.0, 0.0), (1, 100.0, 0.0)]
# without it a load runs away with both links
CASES = [(kind, *run) for kind in KINDS for run in RUNS if kind != "no housing freewheel" or run[2] == 0.0]


@pytest.mark.parametrize("kind, drive, omega1, load", CASES)
def test_residual_of_long_runs_grows_with_the_turns_and_no_faster(kind, drive, omega1, load):
    inputs = {"omega1": omega1, "load_torque": load}
    module = Module("auto").start(**{**KINDS[kind], **inputs}, drive=drive, input_inertia=0.2)
    largest = 0.0
    for _ in range(5):
        module.advance(20.0 if kind == "elastic" else 100.0)
        moved = (module["energy_in"], module["energy_out"], module["energy_lost"], module["energy_stored"])
        largest = max(largest, *map(abs, moved))
        turns = abs(module["drive_turns"]) + abs(module["input_turns"])
        bound = (AT_ONCE + PER_TURN * turns) * module["tolerance"]
        assert abs(module["energy_residual"]) <= bound * largest
    assert turns > 300.0
