"""A torque drives link 1: its course, its works, and what a host can rely on."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import DRIVEN, ENGINE, FREEWHEELS, SCENES, TWO_PI, advanced, drive_angle, reference, started

from inertia_module.memory import Module
from studies.reference.cases import OMEGA4

MOTION = ["input_speed", "omega2", "omega_out", "input_angle", "drive_angle", "energy_stored"]
WORKS = ["energy_in", "energy_out"]
STEPS = st.lists(st.floats(1e-4, 0.02), min_size=1, max_size=8)
TORQUES = st.one_of(st.sampled_from([0.0, 15.0, -15.0]), st.floats(-60.0, 60.0))


@pytest.fixture(params=SCENES)
def scene(request):
    return DRIVEN[request.param]


@pytest.fixture(params=FREEWHEELS)
def freewheels(request):
    return FREEWHEELS[request.param]


def input_angle(module):
    return module["input_angle"] + TWO_PI * module["input_turns"]


def turnover(module):
    """Energy that a relative error of the audit refers to."""
    return max(abs(module[name]) for name in ("energy_in", "energy_out", "energy_stored"))


def assert_same(one, other, names, rel):
    for name in names:
        assert one[name] == pytest.approx(other[name], rel=rel, abs=rel), name


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["forwards", "backwards"])
def test_course_is_that_of_lagranges_equations_under_scipy(scene, freewheels, sign):
    values = {**scene, **freewheels, "omega1": sign * 100.0, "drive_torque": sign * scene["drive_torque"]}
    exact = reference(values, 0.05)
    module = advanced(started("auto", values, tolerance=1e-12), 0.05)
    found = [drive_angle(module), input_angle(module), 0.0, *(module[name] for name in MOTION[:3])]
    assert found == pytest.approx(exact.state[:OMEGA4], rel=1e-9, abs=1e-9)
    assert module["contact_switches"] == len(exact.switches)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-9, 1e-12])
def test_energy_audit_closes_under_a_torque_that_changes(scene, freewheels, tolerance):
    module = started("auto", scene, freewheels, tolerance=tolerance)
    energies = turnover(module)
    for n in range(12):
        advanced(module, 0.01, drive_torque=[15.0, 40.0, -30.0][n % 3], load_torque=[10.0, -5.0][n % 2])
        energies = max(energies, turnover(module))
        assert abs(module["energy_residual"]) <= (10.0 * tolerance + 1e-13) * energies
    assert module["energy_lost"] == 0.0


def test_work_of_a_constant_torque_is_torque_times_angle(scene, freewheels):
    module = advanced(started("auto", scene, freewheels), 0.013, *[1e-3] * 20, 0.21)
    assert module["energy_in"] == pytest.approx(module["drive_torque"] * input_angle(module), rel=1e-13)


@given(torque=TORQUES, step=st.floats(1e-9, 0.05))
def test_input_torque_is_the_drive_torque_in_every_mode(torque, step):
    for freewheels in FREEWHEELS.values():
        module = advanced(started("auto", DRIVEN["bevel"], freewheels), 0.02, step, drive_torque=torque)
        turning = module["energy_stored"] + abs(module["mesh_torque"]) + abs(torque)
        assert module["input_torque"] == pytest.approx(torque, abs=1e-12 * turning)
        assert module["input_torque_mean"] == pytest.approx(torque, rel=1e-14)


def test_torque_with_a_rate_counts_by_its_mean_over_the_step(kernel, scene):
    ramp, mean = (started(kernel, scene, drive_torque=10.0) for _ in range(2))
    ramp.set_rates(drive_torque=400.0, load_torque=-100.0)
    advanced(ramp, 0.05)
    advanced(mean, 0.05, drive_torque=20.0, load_torque=mean["load_torque"] - 2.5)
    assert bytes(ramp.state) == bytes(mean.state)
    assert bytes(ramp.outputs) == bytes(mean.outputs)


@given(steps=STEPS)
def test_sum_over_many_steps_is_that_of_one_long_step(steps):
    for scene in DRIVEN.values():
        one = advanced(started("auto", scene, tolerance=1e-11), sum(steps))
        many = advanced(started("auto", scene, tolerance=1e-11), *steps)
        assert_same(many, one, MOTION + WORKS, 1e-9)
        assert many["contact_switches"] == one["contact_switches"]


def test_thousand_tiny_steps_are_one_step(scene, freewheels):
    one, many = (advanced(started("auto", scene, freewheels, tolerance=1e-13), 0.02) for _ in range(2))
    one.advance(1e-6)
    for _ in range(1000):
        many.advance(1e-9)
    assert_same(many, one, MOTION + WORKS, 1e-12)


def test_error_follows_the_tolerance(scene):
    exact = advanced(started("auto", scene, tolerance=1e-13), 0.3)
    for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
        module = advanced(started("auto", scene, tolerance=tolerance), 0.3)
        for name in ("input_speed", "omega_out"):
            assert module[name] == pytest.approx(exact[name], rel=10.0 * tolerance)


@given(before=STEPS, after=STEPS, torque=TORQUES)
def test_restored_state_runs_on_to_the_same_bits(before, after, torque):
    module = advanced(started("auto", DRIVEN["bevel"]), *before)
    saved = module.save()
    advanced(module, *after, drive_torque=torque)
    end = module.save()
    for other in (module, Module("auto")):
        other.restore(saved)
        assert other.save() == saved
        assert advanced(other, *after, drive_torque=torque).save() == end


def test_speed_given_is_without_effect_after_the_start(kernel, scene):
    one, other = (advanced(started(kernel, scene), 0.01) for _ in range(2))
    other.set(omega1=-3.0)
    other.set_rates(omega1=1e4)
    for module in (one, other):
        advanced(module, 0.05)
    assert bytes(one.state) == bytes(other.state)
    assert bytes(one.outputs) == bytes(other.outputs)


@pytest.mark.parametrize("fidelity", [0, 1, 2, 3])
def test_torque_given_is_without_effect_where_the_speed_is(scene, fidelity):
    values = {**scene, "drive": 0, "fidelity": fidelity}
    one, other = (started("auto", values, drive_torque=torque) for torque in (0.0, -1e6))
    for module in (one, other):
        advanced(module, 0.01)
    other.set_rates(drive_torque=1e5)
    for module in (one, other):
        advanced(module, 0.02)
    assert bytes(one.outputs) == bytes(other.outputs)
    assert one["input_speed"] == one["omega1"]


def test_speed_at_the_start_is_that_given(kernel, scene):
    module = started(kernel, scene, omega1=-37.0)
    assert module["input_speed"] == -37.0
    assert module["energy_in"] == module["energy_residual"] == 0.0
    assert started(kernel, scene, ENGINE, omega1=0.0)["input_speed"] == 0.0
