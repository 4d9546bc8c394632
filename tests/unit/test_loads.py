"""Test forces of the imbalances on mount and bearing, accelerations, and means and peaks over a step."""

import pytest
from scenes import SCENES, TWO_PI, advanced, motions, started

STEP_MEANS = ("mesh_torque_mean", "housing_torque_mean")


@pytest.mark.parametrize("satellites, modules", [(1, 1), (1, 3), (2, 1), (2, 3), (3, 3), (7, 1)])
@motions(levels=("kinematic", "rigid", "elastic"), added=("gears",), missing=())
def test_moment_about_the_axis_is_the_sum_of_external_torques(compiled, scene, satellites, modules):
    several = {"satellites": satellites, "modules": modules, "drive_inertia": 0.003, "drive_angle_start": 1.0}
    module = started(compiled, scene, several, omega1=60.0)
    for step in (0.0, 0.003, 0.01):
        if step:
            module.set_rates(omega1=0.0 if module["drive"] else 500.0)
            module.advance(step)
        own = module["input_inertia"] * module["input_acceleration"]
        given_to_both = module["input_torque"] - own - module["mesh_torque"]
        largest = max(abs(module["input_torque"]), abs(module["mesh_torque"]), abs(own))
        assert module["shaking_moment_x"] == pytest.approx(-given_to_both, abs=1e-11 * largest)


@motions(levels=("kinematic", "averaged", "rigid", "elastic"), added=("ideal",), missing=())
def test_accelerations_are_the_rates_of_the_speeds(compiled, scene):
    module = advanced(started(compiled, scene, load_torque=3.0, drive_angle_start=1.0, tolerance=1e-12), 0.02)
    step, names = 1e-6, {"input_acceleration": "input_speed", "output_acceleration": "omega_out"}
    before = {name: module[speed] for name, speed in names.items()}
    accelerations = {name: module[name] for name in names}
    advanced(module, step)
    for name, speed in names.items():
        middle = 0.5 * (accelerations[name] + module[name])
        assert (module[speed] - before[name]) / step == pytest.approx(middle, rel=1e-4, abs=1e-2)


@motions(levels=("kinematic", "rigid", "elastic"), added=("ideal",), missing=())
@pytest.mark.parametrize("duration", [1e-3, 1e-2, 0.1])
def test_peak_on_the_bearing_is_the_maximum_over_the_step(compiled, scene, duration):
    scene = scene | {"load_torque": 3.0, "drive_angle_start": 1.0}
    single, many = (advanced(started(compiled, scene), 0.03) for _ in range(2))
    advanced(single, duration)
    assert single["satellite_force"] == pytest.approx(
        single["imbalance_mass"] * single["imbalance_acceleration"]
    )
    peak = many["satellite_force"]
    for _ in range(1000):
        advanced(many, duration / 1000)
        peak = max(peak, many["satellite_force"])
    assert 0.99 * peak <= single["satellite_force_peak"] <= 1.01 * peak


def test_peak_on_the_bearing_of_averaged_is_its_last_value(compiled):
    module = advanced(started(compiled, SCENES["planar"], fidelity=1), 0.1)
    assert module["satellite_force_peak"] == module["satellite_force"]


def test_step_outputs_are_zero_before_the_first_step(compiled, scene):
    module = started(compiled, scene)
    for name in (*STEP_MEANS, "loss_power_mean", "output_angle", "output_turns"):
        assert module[name] == 0.0
    assert module["satellite_force_peak"] == module["satellite_force"] > 0.0


@motions(levels=("kinematic", "averaged", "rigid", "elastic"), added=("ideal", "friction"), missing=())
def test_means_and_peak_agree_with_instantaneous_torques(compiled, scene):
    duration, steps = 0.04, 1600
    scene = scene | {"load_torque": 3.0, "drive_angle_start": 1.0, "tolerance": 1e-10}
    single, many = (started(compiled, scene) for _ in range(2))
    ramp = 0.0 if scene.get("drive") else 700.0
    single.set_rates(omega1=ramp)
    single.advance(duration)
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
        squares += 0.5 * (begin[3] ** 2 + many["output_torque"] ** 2) / steps
        peak = max(peak, abs(many["output_torque"]))
    turned = means.pop("omega_out") * duration
    if scene.get("drive"):
        means.pop("input_torque")  # The input torque is the drive torque.
    for name, mean in means.items():
        assert single[f"{name}_mean"] == pytest.approx(mean, abs=2e-3 * largest), name
    # The error of the mean motion is 1e-4 of the largest speed.
    error = {"rel": 2e-3 if single["fidelity"] == 1 else 1e-3, "abs": 1e-5}
    assert single["output_angle"] + TWO_PI * single["output_turns"] == pytest.approx(turned, **error)
    assert single["output_flange_angle"] == pytest.approx(turned, **error)
    assert single["loss_power_mean"] * duration == pytest.approx(single["energy_lost"], rel=1e-12)
    if single["fidelity"] != 1:
        ripple = max(0.0, squares - single["output_torque_mean"] ** 2) ** 0.5
        assert single["torque_ripple"] == pytest.approx(ripple, rel=2e-3)
        # Peaks are sampled only in the stages of the steps.
        assert 0.95 * peak <= single["torque_peak"] <= 1.001 * peak


def test_peak_of_a_pulse_excludes_the_time_after_its_end(compiled):
    for angle in (1.0, 1.8, 2.3):
        scene = SCENES["bevel"] | {"drive_angle_start": angle, "load_torque": 0.0, "tolerance": 1e-3}
        single, many = (started(compiled, scene) for _ in range(2))
        single.advance(0.01)
        peak = 0.0
        for _ in range(200):
            many.advance(5e-5)
            peak = max(peak, abs(many["output_torque"]))
        assert 0.95 * peak <= single["torque_peak"] <= 1.05 * peak


def test_linear_input_hold_extrapolates_the_last_step(compiled, scene):
    module = advanced(started(compiled, scene, input_hold=1, omega1=90.0), 0.02)
    advanced(module, 0.01, omega1=93.0)
    assert module["input_speed"] == pytest.approx(93.0 + 3.0 * 0.01 / 0.02, rel=1e-14)
