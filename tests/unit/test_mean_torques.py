import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import FREEWHEELS, SCENES, TWO_PI, advanced, started, vector

from inertia_module.kernel.averaged.run import impulse_with_work

SINGLE = {"satellites": 1, "imbalance_mass": 0.8, "link2_inertia": 0.004, "output_inertia": 0.3}
JUMPS = st.floats(-150.0, 150.0)
LOADS = st.floats(-20.0, 20.0)
DURATIONS = st.floats(1e-4, 0.1)


@pytest.fixture(scope="module", params=SCENES)
def scene(request):
    return SCENES[request.param] | SINGLE


def momentum(module):
    """Angular momentum of imbalance and link 2 about the central axis."""
    _, y, z = vector(module, "imbalance")
    _, vy, vz = vector(module, "imbalance_velocity")
    return module["imbalance_mass"] * (y * vz - z * vy) + module["link2_inertia"] * module["omega2"]


def impulses(module, jump, load, duration):
    """Changes of the momentum and of the shaft's speed over a step, and the impulses of M1 and Tc."""
    before, speed = momentum(module), module["omega_out"]
    advanced(module, duration, omega1=module["omega1"] + jump, load_torque=load)
    return (
        momentum(module) - before,
        module["omega_out"] - speed,
        module["input_torque_mean"] * duration,
        module["output_torque_mean"] * duration,
    )


@pytest.mark.parametrize("input_hold", [0, 1], ids=["constant", "linear"])
@given(jump=JUMPS, load=LOADS, duration=DURATIONS)
def test_mean_output_torque_speeds_up_the_shaft_against_the_load(
    compiled, scene, input_hold, jump, load, duration
):
    module = advanced(started(compiled, scene, input_hold=input_hold), 0.02)
    _, gain, _, output = impulses(module, jump, load, duration)
    gained = SINGLE["output_inertia"] * gain
    assert output == pytest.approx(gained + load * duration, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("input_hold", [0, 1], ids=["constant", "linear"])
@given(jump=JUMPS, load=LOADS, duration=DURATIONS)
def test_mean_input_torque_is_what_changes_the_momentum(compiled, scene, input_hold, jump, load, duration):
    free = FREEWHEELS["no housing freewheel"]
    module = advanced(started(compiled, scene, free, input_hold=input_hold), 0.02)
    change, _, driven, output = impulses(module, jump, load, duration)
    assert driven - output == pytest.approx(change, rel=1e-9, abs=1e-11)


@given(jump=JUMPS, ratio=st.floats(-0.5, 1.5), duration=DURATIONS)
def test_prescribed_motion_takes_its_torques_from_the_momentum(compiled, scene, jump, ratio, duration):
    module = advanced(started(compiled, scene, fidelity=0, kinematic_ratio=ratio, input_hold=1), 0.02)
    change, _, driven, output = impulses(module, jump, 0.0, duration)
    scale = abs(driven) + abs(output) + abs(change)
    assert driven - output == pytest.approx(change, abs=1e-9 * scale + 1e-11)


@given(jump=JUMPS, load=LOADS, duration=DURATIONS)
def test_housing_only_ever_pushes_link_2_forwards(compiled, scene, jump, load, duration):
    module = advanced(started(compiled, scene), 0.02)
    change, _, driven, output = impulses(module, jump, load, duration)
    assert change - (driven - output) > -1e-11


@pytest.mark.parametrize("ramp", [0.0, 700.0], ids=["constant", "ramp"])
@pytest.mark.parametrize("fidelity", [0, 2])
def test_means_and_peak_are_those_of_the_torques_at_each_instant(compiled, scene, fidelity, ramp):
    duration, steps = 0.05, 4000
    one, many = (started(compiled, scene, fidelity=fidelity, kinematic_ratio=0.4) for _ in range(2))
    one.set_rates(omega1=ramp)
    one.advance(duration)
    names = ["input_torque", "output_torque"]
    sums = dict.fromkeys(names, 0.0)
    squares = peak = 0.0
    for _ in range(steps):
        sums = {name: value + 0.5 * many[name] for name, value in sums.items()}
        many.set_rates(omega1=ramp)
        many.advance(duration / steps)
        many.set(omega1=many["omega1"] + ramp * duration / steps)
        sums = {name: value + 0.5 * many[name] for name, value in sums.items()}
        squares += many["output_torque"] ** 2
        peak = max(peak, abs(many["output_torque"]))
    largest = max(abs(one["input_torque_mean"]), abs(one["output_torque_mean"]))
    for name in names:
        assert sums[name] / steps == pytest.approx(one[f"{name}_mean"], abs=1e-3 * largest)
    ripple = (squares / steps - one["output_torque_mean"] ** 2) ** 0.5
    assert one["torque_ripple"] == pytest.approx(ripple, rel=1e-3)
    # looked at in the stages of the steps alone
    assert 0.95 * peak <= one["torque_peak"] <= 1.001 * peak


@pytest.mark.parametrize("fidelity", [0, 2, 3])
@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_ramp_has_its_angle_and_its_work_closes_the_audit(compiled, scene, freewheels, fidelity):
    module = started(
        compiled, scene, FREEWHEELS[freewheels], fidelity=fidelity, load_torque=3.0, tolerance=1e-9
    )
    for step in (1e-3, 0.03, 0.06):
        module.set_rates(omega1=700.0)
        module.advance(step)
        module.set(omega1=module["omega1"] + 700.0 * step)
        turnover = max(abs(module[name]) for name in ("energy_in", "energy_out", "energy_stored"))
        assert abs(module["energy_residual"]) < 1e-7 * turnover
    time, start = 0.091, scene["omega1"]
    angle = module["input_angle"] + TWO_PI * module["input_turns"]
    assert angle == pytest.approx(time * (start + 0.5 * 700.0 * time), rel=1e-12)


def test_input_goes_on_as_over_the_last_step_where_it_is_held_so(kernel, scene):
    module = advanced(started(kernel, scene, input_hold=1, omega1=90.0), 0.02)
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


@pytest.mark.parametrize("name", SCENES)
def test_mean_input_torque_while_a_ramp_comes_up_to_the_load(compiled, name):
    one, many = (started(compiled, SCENES[name], load_torque=100.0, tolerance=1e-9) for _ in range(2))
    one.set_rates(omega1=700.0)
    one.advance(0.05)
    means = []
    for n in range(200):
        many.set(omega1=SCENES[name]["omega1"] + 700.0 * 0.05 / 200 * n)
        many.set_rates(omega1=700.0)
        many.advance(0.05 / 200)
        means.append(many["input_torque_mean"])
    assert one["omega_out"] > 0.0
    assert one["input_torque_mean"] == pytest.approx(sum(means) / 200, rel=1e-7)


@pytest.mark.parametrize("alpha1", [0.0, 20.0, 100.0, -150.0, -200.0, -500.0])
def test_constant_torque_over_a_part_of_the_mean_motion_has_its_impulse_at_any_ramp(alpha1):
    time, omega1, torque = 0.5, 50.0, 7.0
    work = torque * (omega1 + 0.5 * alpha1 * time) * time
    assert impulse_with_work(time, omega1, alpha1, work, torque, torque) == pytest.approx(torque * time)
