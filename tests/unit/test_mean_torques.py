"""Means, peaks and impulses of the torques over a step, with jumps and ramps of link 1."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import FREEWHEELS, SCENES, TWO_PI, advanced, momentum, motions, started

from inertia_module.kernel.averaged.run import impulse_with_work

SINGLE = {"satellites": 1, "imbalance_mass": 0.8, "link2_inertia": 0.004, "output_inertia": 0.3}
JUMPS = st.floats(-150.0, 150.0)
LOADS = st.floats(-20.0, 20.0)
DURATIONS = st.floats(1e-4, 0.1)


@pytest.fixture(scope="module", params=SCENES)
def scene(request):
    return SCENES[request.param] | SINGLE


def momentum_not_passed_on(module, jump, load, duration):
    """Change of the momentum of imbalance and link 2 less the impulses of M1 and Tc, and what is rounding."""
    before = momentum(module)
    advanced(module, duration, omega1=module["omega1"] + jump, load_torque=load)
    driven, output = (module[f"{name}_torque_mean"] * duration for name in ("input", "output"))
    change = momentum(module) - before
    size = abs(change) + (abs(driven) + abs(output)) * (module["fidelity"] == 0)
    return change - (driven - output), 1e-9 * size + 1e-11


@pytest.mark.parametrize("input_hold", [0, 1], ids=["constant", "linear"])
@given(jump=JUMPS, load=LOADS, duration=DURATIONS, ratio=st.floats(-0.5, 1.5))
def test_impulses_are_what_changes_the_momentum(compiled, scene, input_hold, jump, load, duration, ratio):
    """All of it comes from M1 and Tc, or from a housing that only pushes forwards."""
    free, prescribed = FREEWHEELS["no housing freewheel"], {"fidelity": 0, "kinematic_ratio": ratio}
    for values in (free, prescribed, {}):
        module = advanced(started(compiled, scene, values, input_hold=input_hold), 0.02)
        missing, tiny = momentum_not_passed_on(module, jump, 0.0 if values is prescribed else load, duration)
        assert missing > -tiny
        assert missing < tiny or not values


@motions(
    levels=("kinematic", "averaged", "rigid", "elastic", "timestepping"),
    added=("ideal", "friction"),
    missing=(),
)
def test_means_and_peak_are_those_of_the_torques_at_each_instant(compiled, scene):
    duration, steps = 0.04, 3200
    scene = scene | {"load_torque": 3.0, "drive_angle_start": 1.0, "tolerance": 1e-10}
    one, many = (started(compiled, scene) for _ in range(2))
    ramp = 0.0 if scene.get("drive") else 700.0
    one.set_rates(omega1=ramp)
    one.advance(duration)
    names = ("input_torque", "mesh_torque", "housing_torque", "output_torque", "omega_out")
    means, largest, squares, peak = dict.fromkeys(names, 0.0), 0.0, 0.0, 0.0
    for n in range(steps):
        begin = [many[name] for name in names]
        many.set(omega1=scene["omega1"] + ramp * duration * n / steps)
        many.set_rates(omega1=ramp)
        many.advance(duration / steps)
        for name, value in zip(names, begin, strict=True):
            means[name] += 0.5 * (value + many[name]) / steps
        largest = max(largest, abs(many["mesh_torque"]), abs(many["input_torque"]))
        squares += many["output_torque"] ** 2 / steps
        peak = max(peak, abs(many["output_torque"]))
    turned = means.pop("omega_out") * duration
    if scene.get("drive"):
        means.pop("input_torque")  # it is that of the drive
    for name, mean in means.items():
        assert one[f"{name}_mean"] == pytest.approx(mean, abs=2e-3 * largest), name
    assert one["output_angle"] + TWO_PI * one["output_turns"] == pytest.approx(turned, rel=1e-3, abs=1e-5)
    assert one["output_flange_angle"] == pytest.approx(turned, rel=1e-3, abs=1e-5)
    assert one["loss_power_mean"] * duration == pytest.approx(one["energy_lost"], rel=1e-12)
    if one["fidelity"] != 1 and not one["method"]:
        ripple = max(0.0, squares - one["output_torque_mean"] ** 2) ** 0.5
        assert one["torque_ripple"] == pytest.approx(ripple, rel=1e-3)
        # looked at in the stages of the steps alone
        assert 0.95 * peak <= one["torque_peak"] <= 1.001 * peak


def test_input_goes_on_as_over_the_last_step_where_it_is_held_so(compiled, scene):
    module = advanced(started(compiled, scene, input_hold=1, omega1=90.0), 0.02)
    advanced(module, 0.01, omega1=93.0)
    assert module["input_speed"] == pytest.approx(93.0 + 3.0 * 0.01 / 0.02, rel=1e-14)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_peak_of_a_pulse_that_ends_within_a_long_step_is_of_the_pulse_alone(compiled, name, tolerance):
    long_steps = advanced(started(compiled, SCENES[name], tolerance=tolerance), 0.05)
    fine, peak = started(compiled, SCENES[name]), 0.0
    for _ in range(2000):
        fine.advance(2.5e-5)
        peak = max(peak, fine["output_torque"])
    assert long_steps["torque_peak"] == pytest.approx(peak, rel=0.02)


@pytest.mark.parametrize("alpha1", [0.0, 20.0, 100.0, -150.0, -200.0, -500.0])
def test_constant_torque_over_a_part_of_the_mean_motion_has_its_impulse_at_any_ramp(alpha1):
    time, omega1, torque = 0.5, 50.0, 7.0
    work = torque * (omega1 + 0.5 * alpha1 * time) * time
    assert impulse_with_work(time, omega1, alpha1, work, torque, torque) == pytest.approx(torque * time)
