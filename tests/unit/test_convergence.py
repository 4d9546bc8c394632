"""The error follows `tolerance`, and nothing else: neither the communication step nor the method."""

import math
from functools import cache

import numpy as np
import pytest
from scenes import FREEWHEELS, SCENES, advanced, drive_angle, reference, started

TOLERANCES = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]
DURATION = 1.0


@pytest.fixture(params=SCENES)
def scene(request):
    return request.param


@cache
def speed_at_the_end(kernel, scene, tolerance, step=DURATION):
    module = started(kernel, SCENES[scene], tolerance=tolerance)
    return advanced(module, *[step] * round(DURATION / step))["omega_out"]


def error(kernel, scene, tolerance, step=DURATION):
    exact = speed_at_the_end(kernel, scene, 1e-13)
    return abs(speed_at_the_end(kernel, scene, tolerance, step) - exact) / exact


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_error_stays_within_three_tolerances(compiled, scene, tolerance):
    assert error(compiled, scene, tolerance) <= 3.0 * tolerance


def test_error_falls_in_proportion_to_tolerance(compiled, scene):
    errors = [error(compiled, scene, tolerance) for tolerance in TOLERANCES]
    slope, _ = np.polyfit(np.log(TOLERANCES), np.log(errors), 1)
    assert 0.8 < slope < 1.2


@pytest.mark.parametrize("step", [1e-4, 1e-3, 0.01, 0.1, 0.5])
@pytest.mark.parametrize("tolerance", [1e-5, 1e-7, 1e-9])
def test_result_does_not_depend_on_the_communication_step(compiled, scene, tolerance, step):
    assert error(compiled, scene, tolerance, step) <= 3.0 * tolerance


@pytest.mark.parametrize("freewheels", FREEWHEELS)
@pytest.mark.parametrize("input_hold", [0, 1], ids=["constant", "linear"])
def test_energy_audit_closes_under_a_varying_input(compiled, scene, freewheels, input_hold):
    module = started(compiled, SCENES[scene], FREEWHEELS[freewheels], input_hold=input_hold, tolerance=1e-10)
    turned = 0.0
    for n in range(200):
        omega1 = SCENES[scene]["omega1"] * (1.0 + 0.5 * math.sin(0.1 * n))
        advanced(module, 0.005, omega1=omega1)
        turned = max(turned, abs(module["energy_in"]))
        assert abs(module["energy_residual"]) < 1e-8 * turned
    assert module["energy_lost"] == 0.0


def test_linear_input_hold_converges_to_the_smooth_input(compiled, scene):
    def final_speed(step):
        module = started(compiled, SCENES[scene], input_hold=1, tolerance=1e-10)
        for n in range(round(0.5 / step)):
            advanced(module, step, omega1=SCENES[scene]["omega1"] * (1.0 + 0.2 * math.sin(6.0 * n * step)))
        return module["omega_out"]

    exact = final_speed(2e-5)
    coarse, fine = (abs(final_speed(step) - exact) for step in (4e-3, 1e-3))
    assert fine < coarse / 8.0  # second order: a sixteenth


@pytest.mark.parametrize("duration", [0.05, 0.3])
def test_independent_integrator_gives_the_same_motion(kernel, duration):
    angle, _, _, _, omega2, omega3, *_ = reference(SCENES["bevel"], duration).state
    module = advanced(started(kernel, SCENES["bevel"], tolerance=1e-12), duration)
    assert module["omega2"] == pytest.approx(omega2, rel=1e-9)
    assert module["omega_out"] == pytest.approx(omega3, rel=1e-9)
    assert drive_angle(module) == pytest.approx(angle, rel=1e-9)
