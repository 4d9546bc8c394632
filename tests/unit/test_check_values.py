"""Check values agreed with an independent multibody engine; the error follows `tolerance` alone."""

import math

import numpy as np
import pytest
from scenes import ELASTIC, SCENES, advanced, drive_angle, started

TOLERANCES = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]
DURATION = 1.0
CHECKED = (
    *("contact_mode", "omega2", "omega_out", "input_torque", "mesh_torque", "output_torque"),
    *("housing_torque", "output_torque_mean", "imbalance_acceleration"),
)
# by time, s: these and the angle of the drive
REFERENCE_VALUES = {
    0.01: (
        *(2, 0.969128517, 0.969128517, 163.43277665, 22.45225325, 22.32896361, 0, 58.4564258, 2931.116196),
        0.995538603,
    ),
    0.1: (
        *(0, 0, 3.447176379, -169.30697594, -95.49415258, 0, 95.49415258, 27.2358819, 5285.153822),
        9.887230876,
    ),
    1.0: (
        *(2, 17.968063040, 17.968063040, 15.48585376, 50.41231783, 50.01219587, 0, 18.98403152),
        *(1063.437762, 93.434013810),
    ),
}


@pytest.mark.parametrize("time", REFERENCE_VALUES)
def test_reference_scene_has_its_check_values(compiled, time):
    module = advanced(started(compiled, SCENES["bevel"], tolerance=1e-9), time)
    found = [*(module[name] for name in CHECKED), drive_angle(module)]
    assert found == pytest.approx(REFERENCE_VALUES[time], rel=1e-6, abs=0.0)


def test_planar_scene_has_its_check_values(compiled):
    module = advanced(started(compiled, SCENES["planar"], tolerance=1e-9), 1.0)
    assert module["omega2"] == module["omega_out"] == pytest.approx(51.243199463, rel=1e-6)
    assert drive_angle(module) == pytest.approx(175.782853305, rel=1e-6)


def test_elastic_scene_has_its_check_values(compiled):
    module = advanced(started(compiled, SCENES["bevel"], ELASTIC, tolerance=1e-11), 1.0)
    assert module["omega_hub"] == pytest.approx(3.908460340, abs=2e-8)
    assert module["omega_out"] == pytest.approx(16.766411224, abs=2e-9)
    assert module["shaft_twist"] == pytest.approx(-1.550114589e-3, abs=1e-9)


def test_reference_scene_switches_125_times_in_its_first_second(compiled):
    assert advanced(started(compiled, SCENES["bevel"]), 1.0)["contact_switches"] == 125


def test_error_falls_in_proportion_to_tolerance_and_stays_within_three_in_any_steps(compiled, scene):
    def speed(tolerance, step=DURATION):
        module = started(compiled, scene, tolerance=tolerance)
        return advanced(module, *[step] * round(DURATION / step))["omega_out"]

    exact = speed(1e-13)
    for step in (DURATION, 0.1, 1e-3):
        errors = [abs(speed(tolerance, step) - exact) / exact for tolerance in TOLERANCES]
        slope, _ = np.polyfit(np.log(TOLERANCES), np.log(errors), 1)
        assert step < DURATION or 0.8 < slope < 1.2
        for tolerance, found in zip(TOLERANCES, errors, strict=True):
            assert found <= 3.0 * tolerance, step


def test_linear_input_hold_converges_to_the_smooth_input(compiled, scene):
    def final_speed(step):
        module = started(compiled, scene, input_hold=1, tolerance=1e-10)
        for n in range(round(0.5 / step)):
            advanced(module, step, omega1=scene["omega1"] * (1.0 + 0.2 * math.sin(6.0 * n * step)))
        return module["omega_out"]

    exact = final_speed(1e-4)
    coarse, fine = (abs(final_speed(step) - exact) for step in (4e-3, 1e-3))
    assert fine < coarse / 8.0  # second order: a sixteenth
