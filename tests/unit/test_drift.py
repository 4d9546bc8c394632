"""What is lost over very long runs and in many tiny steps stays within what the documentation gives."""

import pytest
from scenes import ELASTIC, FREEWHEELS, PLANAR, SCENES, advanced, started

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
def test_residual_of_long_runs_grows_with_the_turns_and_no_faster(compiled, kind, drive, omega1, load):
    inputs = {"omega1": omega1, "load_torque": load}
    module = started(compiled, KINDS[kind], inputs, drive=drive, input_inertia=0.2)
    largest = 0.0
    for _ in range(5):
        module.advance(20.0 if kind == "elastic" else 100.0)
        moved = (module["energy_in"], module["energy_out"], module["energy_lost"], module["energy_stored"])
        largest = max(largest, *map(abs, moved))
        turns = abs(module["drive_turns"]) + abs(module["input_turns"])
        bound = (AT_ONCE + PER_TURN * turns) * module["tolerance"]
        assert abs(module["energy_residual"]) <= bound * largest
    assert turns > 300.0


@pytest.mark.parametrize("freewheels, before", [("both freewheels", 0.012), ("no freewheel", 0.02)])
def test_hundred_thousand_tiny_steps_are_one_step(compiled, freewheels, before):
    scene = SCENES["bevel"] | FREEWHEELS[freewheels]
    one, many = (advanced(started(compiled, scene, tolerance=1e-13), before) for _ in range(2))
    one.advance(1e-4)
    for _ in range(100_000):
        many.advance(1e-9)
    for name in ("omega2", "omega_out", "drive_angle", "input_angle", "input_torque", "energy_stored"):
        # the torque is a difference of many N m: two parts in 1e15 of them
        assert many[name] == pytest.approx(one[name], rel=1e-12, abs=2e-13), name
    for name in ("energy_in", "energy_out"):
        assert many[name] == pytest.approx(one[name], rel=1e-11, abs=1e-14), name
    assert many["contact_switches"] == one["contact_switches"]


def test_steps_below_the_resolution_of_the_speed_add_up_too(compiled):
    # each step changes the speed of the shaft by less than a rounding error of it
    module = started(compiled, omega1=0.0, load_torque=1e-3, omega_out_start=1000.0)
    for _ in range(100_000):
        module.advance(1e-12)
    lost = 1e-3 * 1e-7 / module["output_inertia"]
    assert 1000.0 - module["omega_out"] == pytest.approx(lost, abs=2e-13)
    assert module["energy_out"] == pytest.approx(1e-3 * 1e-7 * 1000.0, rel=1e-12)
