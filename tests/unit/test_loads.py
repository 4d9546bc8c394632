"""Forces of the imbalances on mount and bearing, accelerations, means with a jump."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import FREEWHEELS, LAYOUTS, SCENES, TWO_PI, advanced, drive_angle, motions, started, vector

from inertia_module.kernel.layout import imbalance

STEP_MEANS = ("mesh_torque_mean", "housing_torque_mean")
# greatest force, moment across Ox and about it of scene R1 at half the speed of link 1, by satellites
GREATEST = {1: (2928.0, 179.0, 106.0), 2: (2562.0, 256.0, 196.0), 3: (3844.0, 192.0, 124.0)}


@pytest.mark.parametrize("satellites", GREATEST)
def test_scene_r1_shakes_its_mount_as_much_as_computed_by_hand(compiled, satellites):
    module = started(
        compiled, SCENES["bevel"], fidelity=0, kinematic_ratio=0.5, load_torque=0.0, satellites=satellites
    )
    force = across = about = 0.0
    for _ in range(20000):
        advanced(module, TWO_PI * 20 / 100.0 / 20000)
        _, *moment = vector(module, "shaking_moment")
        force = max(force, math.hypot(*vector(module, "shaking_force")))
        across = max(across, math.hypot(*moment))
        about = max(about, abs(module["shaking_moment_x"]))
    assert (force, across, about) == pytest.approx(GREATEST[satellites], abs=0.6)


@pytest.mark.parametrize("satellites, modules", [(1, 1), (1, 3), (2, 1), (2, 3), (3, 3), (7, 1)])
@motions(levels=("kinematic", "rigid", "elastic", "timestepping"), added=("gears",), missing=())
def test_moment_about_the_axis_is_what_link_1_and_link_2_are_given(compiled, scene, satellites, modules):
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


@given(
    satellites=st.integers(1, 6),
    modules=st.integers(1, 5),
    start=st.floats(-10.0, 10.0),
    ratio=st.floats(-1.0, 2.0),
    ramp=st.floats(-1e3, 1e3),
)
@pytest.mark.parametrize("askew", LAYOUTS)
def test_forces_on_the_mount_are_the_sums_over_all_imbalances(
    compiled, askew, satellites, modules, start, ratio, ramp
):
    module = started(
        compiled,
        LAYOUTS[askew],
        fidelity=0,
        kinematic_ratio=ratio,
        satellites=satellites,
        modules=modules,
        drive_angle_start=start,
        omega1=50.0,
    )
    module.set_rates(omega1=ramp)
    module.advance(0.01)
    d, q, planar = module.derived, drive_angle(module), module["layout"] != 0
    omega1, alpha1 = module["input_speed"], ramp
    rate_q, rate2_q = d.k * (1.0 - ratio) * omega1, d.k * (1.0 - ratio) * alpha1
    along = np.array([1.0, 0.0, 0.0])
    force, moment, scale, arm = np.zeros(3), np.zeros(3), 0.0, 0.0
    for i in range(modules):
        for j in range(satellites):
            turned = TWO_PI * j / satellites
            r, r1, r2 = np.reshape(imbalance(d, q, turned), (3, 3))
            acceleration = (
                r2 * rate_q**2
                + r1 * rate2_q
                + 2.0 * omega1 * rate_q * np.cross(along, r1)
                + alpha1 * np.cross(along, r)
                + omega1**2 * np.cross(along, np.cross(along, r))
            )
            angle = module["input_angle"] + TWO_PI * i / modules + (turned if planar else 0.0)
            sine, cosine = math.sin(angle), math.cos(angle)
            fixed = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
            force -= module["imbalance_mass"] * fixed @ acceleration
            moment -= module["imbalance_mass"] * np.cross(fixed @ r, fixed @ acceleration)
            scale += module["imbalance_mass"] * float(np.linalg.norm(acceleration))
            arm = max(arm, float(np.linalg.norm(r)))
    assert vector(module, "shaking_force") == pytest.approx(list(force), abs=1e-11 * scale)
    assert vector(module, "shaking_moment") == pytest.approx(list(moment), abs=1e-11 * scale * arm)


@pytest.mark.parametrize("name", SCENES)
@given(jump=st.floats(-80.0, 80.0), before=st.floats(1e-3, 0.05), load=st.floats(0.0, 20.0))
def test_means_with_a_jump_are_those_with_a_steep_ramp(compiled, name, jump, before, load):
    duration, short, scene = 0.01, 1e-9, SCENES[name]
    at_once, steep = (advanced(started(compiled, scene, load_torque=load), before) for _ in range(2))
    advanced(at_once, duration, omega1=scene["omega1"] + jump)
    impulses = dict.fromkeys(STEP_MEANS, 0.0)
    for step, speed, rate in ((short, 0.0, jump / short), (duration - short, jump, 0.0)):
        steep.set(omega1=scene["omega1"] + speed)
        steep.set_rates(omega1=rate)
        steep.advance(step)
        impulses = {mean: value + step * steep[mean] for mean, value in impulses.items()}
    largest = max(abs(at_once[mean]) for mean in STEP_MEANS)
    for mean, impulse in impulses.items():
        assert impulse / duration == pytest.approx(at_once[mean], abs=1e-4 * largest)


@pytest.mark.parametrize("freewheels", FREEWHEELS)
@pytest.mark.parametrize("layout", SCENES)
def test_without_a_housing_freewheel_the_housing_takes_nothing(compiled, layout, freewheels):
    module = advanced(started(compiled, SCENES[layout], FREEWHEELS[freewheels]), 0.1)
    assert (module["housing_torque_mean"] > 0.0) == (module["housing_freewheel"] != 0.0)


@motions(levels=("kinematic", "averaged", "rigid", "elastic"), added=("ideal",), missing=())
def test_accelerations_are_the_rates_of_the_speeds(compiled, scene):
    module = advanced(started(compiled, scene, load_torque=3.0, drive_angle_start=1.0, tolerance=1e-12), 0.02)
    step, names = 1e-6, {"input_acceleration": "input_speed", "output_acceleration": "omega_out"}
    before = {name: module[speed] for name, speed in names.items()}
    found = {name: module[name] for name in names}
    advanced(module, step)
    for name, speed in names.items():
        middle = 0.5 * (found[name] + module[name])
        assert (module[speed] - before[name]) / step == pytest.approx(middle, rel=1e-4, abs=1e-2)


@motions(levels=("kinematic", "rigid", "elastic", "timestepping"), added=("ideal",), missing=())
@pytest.mark.parametrize("duration", [1e-3, 1e-2, 0.1])
def test_peak_on_the_bearing_is_that_of_all_instants(compiled, scene, duration):
    scene = scene | {"load_torque": 3.0, "drive_angle_start": 1.0}
    one, many = (advanced(started(compiled, scene), 0.03) for _ in range(2))
    advanced(one, duration)
    assert one["satellite_force"] == pytest.approx(one["imbalance_mass"] * one["imbalance_acceleration"])
    peak = many["satellite_force"]
    for _ in range(1000):
        advanced(many, duration / 1000)
        peak = max(peak, many["satellite_force"])
    assert 0.97 * peak <= one["satellite_force_peak"] <= 1.01 * peak


def test_peak_on_the_bearing_of_a_mean_motion_is_that_of_its_last_instant(compiled):
    module = advanced(started(compiled, SCENES["planar"], fidelity=1), 0.1)
    assert module["satellite_force_peak"] == module["satellite_force"]


@pytest.mark.parametrize("layout", SCENES)
def test_nothing_is_known_of_a_step_before_the_first(compiled, layout):
    module = started(compiled, SCENES[layout])
    for name in (*STEP_MEANS, "loss_power_mean", "output_angle", "output_turns"):
        assert module[name] == 0.0
    assert module["satellite_force_peak"] == module["satellite_force"] > 0.0
