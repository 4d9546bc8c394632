"""Check values of the reference and the planar scene, agreed with an independent multibody engine."""

import pytest
from scenes import SCENES, advanced, drive_angle, started

TOLERANCE = 1e-9
REFERENCE_VALUES = {
    0.01: {
        "contact_mode": 2,
        "omega2": 0.969128517,
        "omega_out": 0.969128517,
        "input_torque": 163.43277665,
        "mesh_torque": 22.45225325,
        "output_torque": 22.32896361,
        "housing_torque": 0,
        "output_torque_mean": 58.4564258,
        "imbalance_acceleration": 2931.116196,
    },
    0.1: {
        "contact_mode": 0,
        "omega2": 0,
        "omega_out": 3.447176379,
        "input_torque": -169.30697594,
        "mesh_torque": -95.49415258,
        "output_torque": 0,
        "housing_torque": 95.49415258,
        "output_torque_mean": 27.2358819,
        "imbalance_acceleration": 5285.153822,
    },
    1.0: {
        "contact_mode": 2,
        "omega2": 17.968063040,
        "omega_out": 17.968063040,
        "input_torque": 15.48585376,
        "mesh_torque": 50.41231783,
        "output_torque": 50.01219587,
        "housing_torque": 0,
        "output_torque_mean": 18.98403152,
        "imbalance_acceleration": 1063.437762,
    },
}
REFERENCE_ANGLES = {0.01: 0.995538603, 0.1: 9.887230876, 1.0: 93.434013810}


@pytest.fixture(params=SCENES)
def scene(request):
    return SCENES[request.param]


@pytest.mark.parametrize("time", REFERENCE_VALUES)
def test_reference_scene_has_its_check_values(kernel, time):
    module = advanced(started(kernel, SCENES["bevel"], tolerance=TOLERANCE), time)
    expected = REFERENCE_VALUES[time]
    found = {name: module[name] for name in expected}
    assert found == pytest.approx(expected, rel=1e-6, abs=0.0)
    assert drive_angle(module) == pytest.approx(REFERENCE_ANGLES[time], rel=1e-6)


def test_planar_scene_has_its_check_values(kernel):
    module = advanced(started(kernel, SCENES["planar"], tolerance=TOLERANCE), 1.0)
    assert module["omega2"] == module["omega_out"] == pytest.approx(51.243199463, rel=1e-6)
    assert drive_angle(module) == pytest.approx(175.782853305, rel=1e-6)


def test_reference_scene_switches_125_times_in_its_first_second(kernel):
    assert advanced(started(kernel, SCENES["bevel"]), 1.0)["contact_switches"] == 125


def test_mean_of_many_steps_is_the_mean_of_one(kernel, scene):
    one = advanced(started(kernel, scene, tolerance=TOLERANCE), 0.4)
    many = started(kernel, scene, tolerance=TOLERANCE)
    sums = {"input_torque_mean": 0.0, "output_torque_mean": 0.0}
    for _ in range(80):
        many.advance(0.005)
        for name in sums:
            sums[name] += many[name] / 80
    for name, mean in sums.items():
        assert mean == pytest.approx(one[name], rel=1e-7)
