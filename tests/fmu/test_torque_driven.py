"""The module driven by torque: input_speed answers drive_torque, omega1 is only the start."""

import math

import pytest

BY_TORQUE = {"drive": 1, "input_inertia": 0.3}
START = {"omega1": 100.0, "load_torque": 10.0, "drive_torque": 30.0, **BY_TORQUE}


def test_speed_at_the_start_is_omega1_which_then_counts_no_more(instances):
    plain, moved = (instances().start(tolerance=1e-9, **START) for _ in range(2))
    assert plain.get("input_speed") == 100.0
    for n in range(20):
        moved.set(omega1=-7.0 * n)
        for one in (plain, moved):
            one.step(0.01)
    names = [name for name in plain.references if name != "omega1"]
    assert [plain.get(name) for name in names] == [moved.get(name) for name in names]
    assert plain.get("input_speed") != 100.0


def test_with_drive_speed_input_speed_is_what_omega1_has_come_to(instance):
    instance.start(omega1=100.0, drive_torque=30.0)
    assert instance.get("input_speed") == 100.0
    instance.set(omega1=80.0)
    assert instance.get("input_speed") == 100.0
    instance.step(0.01)
    assert instance.get("input_speed") == 80.0
    if instance.takes_rates:
        instance.set_rates(omega1=50.0)
        instance.step(0.1)
        assert instance.get("input_speed") == pytest.approx(85.0, rel=1e-12)


def test_without_an_imbalance_it_is_an_inertia_under_a_torque(instance):
    """Nothing worth mentioning is passed on: J1 alone answers."""
    light = {"imbalance_mass": 1e-12, "load_torque": 0.0}
    instance.start(tolerance=1e-10, **{**START, **light})
    for _ in range(10):
        instance.step(0.05)
    assert instance.get("input_speed") == pytest.approx(100.0 + 30.0 / 0.3 * 0.5, rel=1e-9)
    turned = instance.get("input_angle") + 2.0 * math.pi * instance.get("input_turns")
    assert turned == pytest.approx(100.0 * 0.5 + 0.5 * 100.0 * 0.25, rel=1e-9)


def test_its_energy_is_the_torque_times_the_angle(instance):
    instance.start(tolerance=1e-9, **START)
    work = angle = 0.0
    for n in range(100):
        torque = 30.0 + 20.0 * math.sin(n)
        instance.set(drive_torque=torque)
        instance.step(0.01)
        now = instance.get("input_angle") + 2.0 * math.pi * instance.get("input_turns")
        work += torque * (now - angle)
        angle = now
        assert instance.get("input_torque_mean") == pytest.approx(torque, rel=1e-12)
    assert instance.get("energy_in") == pytest.approx(work, rel=1e-10)
    assert abs(instance.get("energy_residual")) < 1e-7 * work


def test_a_pulse_slows_link_1_down_and_a_heavier_one_less(instances):
    swings = []
    for inertia in (0.1, 1.0):
        instance = instances().start(tolerance=1e-8, **{**START, "input_inertia": inertia})
        speeds = []
        for _ in range(200):
            instance.step(1e-3)
            speeds.append(instance.get("input_speed"))
        swings.append(max(speeds) - min(speeds))
    assert swings[0] > 3.0 * swings[1] > 0.0


def test_a_rate_of_the_torque_counts_by_its_mean(instances):
    rising, held = (instances().start(tolerance=1e-9, **START) for _ in range(2))
    if not rising.is_native:
        pytest.skip("the Python FMU takes no derivatives of inputs")
    for n in range(50):
        rising.set(drive_torque=30.0 + n)
        rising.set_rates(drive_torque=100.0)
        held.set(drive_torque=30.0 + n + 0.5)
        for one in (rising, held):
            one.step(0.01)
    for name in ("input_speed", "omega_out", "energy_in", "drive_angle"):
        assert rising.get(name) == pytest.approx(held.get(name), rel=1e-12)


@pytest.mark.parametrize("rate", [math.nan, 1e15])
def test_an_absurd_rate_of_the_torque_is_discarded(instance, rate):
    instance.start(**START)
    if not instance.is_native:
        pytest.skip("the Python FMU takes no derivatives of inputs")
    before = instance.all_values()
    instance.set_rates(drive_torque=rate)
    assert instance.is_discarded(0.01)
    assert instance.all_values() == before
    instance.set_rates(drive_torque=0.0)
    assert not instance.is_discarded(0.01)
