"""Test event location: known roots of indicators on the dense output and by the equations of motion."""

import math

import pytest
from scenes import SCENES, advanced, started

from inertia_module.interface.records import record_type
from inertia_module.kernel import tableau
from inertia_module.kernel.events import guards, location
from inertia_module.kernel.fields import WORKSPACE

H = 0.1


def step_with_indicator(rate, start, which=guards.HOUSING):
    """Return the records of a step H in which an indicator has this rate over time and this start value."""
    module = started("plain", SCENES["bevel"], omega2_start=5.0, omega_out_start=10.0)
    w = record_type(WORKSPACE)()
    w.step, w.pair = H, tableau.DOP853_ROW
    indicator = w.indicators[which]
    nodes = tableau.NODES[: tableau.N_STAGES]
    for n, node in enumerate(nodes):
        indicator.rate[n] = rate(H * node)
    for n in range(len(nodes)):
        indicator.value[n] = start + H * tableau.weighted_sum(n, n, indicator.rate) if n else start
    tableau.fit_dense_output(H, indicator.rate, indicator.dense)
    return module.derived, module.state, w


@pytest.mark.parametrize("root", [1e-4, 0.013, 0.05, 0.0999])
def test_root_of_a_falling_speed_is_located(root):
    d, x, w = step_with_indicator(lambda t: -2.0, 2.0 * root)
    zero = 1e-13
    sigma = location.first_fall(d, x, w, guards.HOUSING, zero)
    assert sigma * H == pytest.approx(root, abs=4e-13)
    assert -3.0 * zero <= 2.0 * root - 2.0 * sigma * H <= 0.0


def test_first_of_several_roots_is_located():
    """cos(40 t) falls through zero at pi / 80 and again at 5 pi / 80, beyond the step."""
    d, x, w = step_with_indicator(lambda t: -40.0 * math.sin(40.0 * t), 1.0)
    sigma = location.first_fall(d, x, w, guards.HOUSING, 1e-13)
    assert sigma * H == pytest.approx(math.pi / 80.0, rel=1e-3)
    assert guards.fitted_guard(x, w, guards.HOUSING, sigma) == pytest.approx(-2e-13, abs=1.01e-13)


@pytest.mark.parametrize("minimum", [1e-6, 0.1])
def test_speed_that_stays_positive_has_no_event(minimum):
    d, x, w = step_with_indicator(lambda t: 800.0 * (t - 0.05), 1.0 + minimum)
    assert location.first_fall(d, x, w, guards.HOUSING, 1e-13) == -1.0


def test_dip_wider_than_two_samples_is_located():
    """(t - 0.05)^2 - (H / 12)^2 falls below zero between two of its roots."""
    root = 0.05 - H / 12.0
    d, x, w = step_with_indicator(lambda t: 2.0 * (t - 0.05), 0.05**2 - (H / 12.0) ** 2)
    sigma = location.first_fall(d, x, w, guards.HOUSING, 1e-15)
    assert sigma * H == pytest.approx(root, rel=1e-9)


def test_lowest_point_is_that_of_the_parabola():
    assert location.lowest_point(1.3**2, 0.3**2, 0.7**2) == pytest.approx(0.3)
    assert location.lowest_point(1.0, 0.5, 0.2) == 0.0


def test_dip_within_a_fifth_of_the_step_is_located():
    """(t - 0.01) (t - 0.03) (t + 0.05) is positive at the middle and at both ends of the step."""
    d, x, w = step_with_indicator(lambda t: 3.0 * t * t + 0.02 * t - 0.0017, 1.5e-5)
    assert location.first_fall(d, x, w, guards.HOUSING, 1e-15) * H == pytest.approx(0.01, rel=1e-6)


@pytest.mark.parametrize("root", [0.4, 0.5, 0.6])
def test_torque_falls_at_the_root_of_the_equations_near_the_root_of_the_dense_output(root, monkeypatch):
    d, x, w = step_with_indicator(lambda t: 0.0, 1.0)
    monkeypatch.setattr(guards, "is_speed", lambda x, which: False)
    monkeypatch.setattr(location, "fitted_guard", lambda x, w, which, sigma: 0.5 - sigma)
    monkeypatch.setattr(location, "exact_guard", lambda d, x, w, which, sigma: root - sigma)
    sigma = location.fall_between(d, x, w, guards.OUTPUT, 1e-12, 0.0, 0.5, 1.0, -0.5)
    assert sigma == pytest.approx(root, abs=4e-12)


def test_indicator_far_from_zero_or_growing_has_no_event():
    _, x, w = step_with_indicator(lambda t: -2.0, 10.0)
    assert guards.is_clear(x, w, guards.HOUSING)
    _, x, w = step_with_indicator(lambda t: 2.0, 0.0)
    assert guards.is_clear(x, w, guards.HOUSING)
    _, x, w = step_with_indicator(lambda t: -2.0, 0.1)
    assert not guards.is_clear(x, w, guards.HOUSING)


def test_speeds_and_torques_satisfy_the_conditions_of_the_freewheels(compiled, scene):
    """After each step no slip is negative, and no freewheel torque is negative beyond round-off."""
    module = started(compiled, scene, tolerance=1e-9)
    for _ in range(50):
        advanced(module, 1e-3)
        slip = module["omega_hub"] - module["omega2"]
        assert module["omega2"] >= 0.0
        assert slip >= 0.0
        assert module["housing_torque"] >= -1e-9 * abs(module["mesh_torque"])
        assert module["output_torque"] >= -1e-9 * abs(module["mesh_torque"])
