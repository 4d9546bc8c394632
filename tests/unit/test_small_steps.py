import pytest
from scenes import FREEWHEELS, SCENES, advanced, started

MOTION = ["omega2", "omega_out", "drive_angle", "input_angle", "input_torque", "energy_stored"]
WORK = ["energy_in", "energy_out"]


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("freewheels", ["both freewheels", "no freewheel"])
@pytest.mark.parametrize("before", [0.0035, 0.012, 0.02])
def test_hundred_thousand_tiny_steps_are_one_step(compiled, scene, freewheels, before):
    one = advanced(started(compiled, SCENES[scene], FREEWHEELS[freewheels], tolerance=1e-13), before)
    many = advanced(started(compiled, SCENES[scene], FREEWHEELS[freewheels], tolerance=1e-13), before)
    one.advance(1e-4)
    for _ in range(100_000):
        many.advance(1e-9)
    for name in MOTION:
        assert many[name] == pytest.approx(one[name], rel=1e-12, abs=1e-14), name
    for name in WORK:
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
