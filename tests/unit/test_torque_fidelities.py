"""A torque drives link 1 in every fidelity and method: each against a reference, and what they share."""

import math

import pytest
from scenes import DRIVEN, ELASTIC, FREEWHEELS, SCENES, TWO_PI, advanced, drive_angle, reference, started

from inertia_module.memory import Module
from studies.reference.cases import WOUND

SHAFT = {**ELASTIC, "driven_friction": 0.02, "balancer": 0.3}
VARIANTS = {
    "rigid": {},
    "rigid, timestepping": {"method": 1, "max_step": 1e-3},
    "elastic": SHAFT,
    "elastic, timestepping": {**SHAFT, "method": 1, "max_step": 1e-3},
    "averaged": {"fidelity": 1},
}
AT_REST = {"omega1": 0.0, "drive_torque": 0.0}
HEAVY = {"input_inertia": 5.0, "omega1": 120.0, "tolerance": 1e-8}
STATES = ["input_speed", "omega2", "omega_hub", "omega_out", "drive_angle", "input_angle", "energy_in"]


@pytest.fixture(params=SCENES)
def scene(request):
    return DRIVEN[request.param]


@pytest.fixture(params=VARIANTS)
def variant(request):
    return VARIANTS[request.param]


def input_angle(module):
    return module["input_angle"] + TWO_PI * module["input_turns"]


@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_course_with_an_elastic_shaft_is_that_of_lagranges_equations_under_scipy(scene, freewheels):
    values = {**scene, **SHAFT, **FREEWHEELS[freewheels]}
    exact = reference(values, 0.04)
    module = advanced(started("auto", values, tolerance=1e-12), 0.04)
    speeds = [module[name] for name in ("input_speed", "omega2", "omega_hub", "omega_out")]
    found = [drive_angle(module), input_angle(module), module["shaft_twist"], *speeds]
    assert found == pytest.approx(exact.state[:WOUND], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_stiff_shaft_and_light_driven_mass_are_the_rigid_output(scene, freewheels):
    values = {**scene, **FREEWHEELS[freewheels], "tolerance": 1e-8}
    rigid = advanced(started("auto", values), 0.1)
    hub = rigid["output_inertia"]
    stiff = started(
        "auto",
        values,
        fidelity=3,
        output_inertia=0.999 * hub,
        driven_inertia=0.001 * hub,
        shaft_stiffness=1e7,
        shaft_damping=10.0,
    )
    advanced(stiff, 0.1)
    for name in STATES:
        assert stiff[name] == pytest.approx(rigid[name], rel=1e-4, abs=1e-4), name


@pytest.mark.parametrize("output", [{}, SHAFT], ids=["rigid", "elastic"])
@pytest.mark.parametrize("freewheels", ["both freewheels", "no freewheel"])
def test_timestepping_comes_to_the_course_between_events_as_its_steps_shrink(scene, output, freewheels):
    values = {**scene, **output, **FREEWHEELS[freewheels]}
    exact = advanced(started("auto", values, tolerance=1e-9), 0.1)
    errors = []
    for step in (1e-3, 2.5e-4, 6.25e-5):
        module = advanced(started("auto", values, method=1, max_step=step), 0.1)
        errors.append(max(abs(module[name] - exact[name]) for name in ("input_speed", "omega_out")))
    # of order 2; of order 1 in single speeds, where the moment of a switch counts
    falls = 0.5 if freewheels == "both freewheels" else 0.08
    assert errors[1] < falls * errors[0]
    assert errors[2] < falls * errors[1]
    assert errors[2] < 1e-3 * exact["input_speed"]


def test_mean_motion_is_that_of_the_pulses_behind_a_heavy_engine(scene):
    averaged = started("auto", scene, HEAVY, fidelity=1)
    rigid = started("auto", scene, HEAVY)
    energy = averaged["energy_stored"]
    torque = averaged["drive_torque"]
    for _ in range(4):
        for module in (averaged, rigid):
            module.advance(0.5)
        assert averaged["input_speed"] == pytest.approx(rigid["input_speed"], rel=2e-2)
        assert averaged["omega_out"] == pytest.approx(rigid["omega_out"], rel=5e-2, abs=1.0)
        assert averaged["energy_in"] == pytest.approx(torque * input_angle(averaged), rel=1e-12)
        assert abs(averaged["energy_residual"]) < 1e-5 * energy
        assert averaged["input_torque"] == pytest.approx(torque, abs=1e-9 * energy)


@pytest.mark.parametrize("fidelity", [2, 3], ids=["rigid", "elastic"])
@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_energy_audit_closes_between_events(scene, freewheels, fidelity):
    values = {**scene, **(SHAFT if fidelity == 3 else {}), **FREEWHEELS[freewheels], "balancer": 0.0}
    module = started("auto", values, tolerance=1e-9)
    energies = module["energy_stored"]
    for n in range(10):
        advanced(module, 0.01, drive_torque=[15.0, -30.0][n % 2])
        energies = max(energies, abs(module["energy_in"]), module["energy_stored"])
        assert abs(module["energy_residual"]) < 1e-8 * energies
        assert module["energy_lost"] >= 0.0
    assert (module["energy_lost"] > 0.0) == (fidelity == 3)


def test_mean_torque_and_work_are_those_of_the_torque_given(scene, variant):
    module = started("auto", scene, variant)
    for step in (1e-3, 0.01, 0.03):
        module.advance(step)
        assert module["input_torque_mean"] == pytest.approx(module["drive_torque"], rel=1e-14)
    assert module["energy_in"] == pytest.approx(module["drive_torque"] * input_angle(module), rel=1e-12)


def test_restored_state_runs_on_to_the_same_bits(scene, variant):
    module = advanced(started("auto", scene, variant), 0.01, 0.003)
    saved = module.save()
    end = advanced(module, 0.02, drive_torque=-4.0).save()
    other = Module("auto")
    other.restore(saved)
    assert advanced(other, 0.02, drive_torque=-4.0).save() == end


def test_speed_given_is_without_effect_after_the_start(scene, variant):
    one, other = (advanced(started("auto", scene, variant), 0.01) for _ in range(2))
    other.set(omega1=-3.0)
    for module in (one, other):
        advanced(module, 0.02)
    assert bytes(one.state) == bytes(other.state)
    assert bytes(one.outputs) == bytes(other.outputs)


@pytest.mark.parametrize("load", [0.0, 10.0])
@pytest.mark.parametrize("step", [1e-9, 1.0, 10.0])
def test_standstill_without_torque_stays(scene, variant, load, step):
    # an elastic shaft takes up the load, behind a freewheel that keeps link 2 where it is
    module = advanced(started("auto", scene, variant, AT_REST, load_torque=load), step)
    names = ["input_speed", "omega2", "input_angle", "energy_in"]
    if module["fidelity"] != 3:
        names += ["omega_out", "energy_stored"]
    assert [module[name] for name in names] == [0.0] * len(names)
    assert all(math.isfinite(value) for value in module.snapshot().values())


def test_torque_starts_and_turns_round_the_engine(scene, variant):
    module = advanced(started("auto", scene, variant, omega1=0.0, drive_torque=5.0), *[0.02] * 10)
    assert module["input_speed"] > 1.0
    advanced(module, *[0.02] * 20, drive_torque=-5.0)
    assert module["input_speed"] < -1.0


@pytest.mark.parametrize("fidelity", [1, 2, 3])
def test_many_steps_are_one(scene, fidelity):
    values = {**scene, **(SHAFT if fidelity == 3 else {}), "fidelity": fidelity, "tolerance": 1e-10}
    one = advanced(started("auto", values), 0.05)
    many = advanced(started("auto", values), *[1e-3] * 50)
    for name in STATES:
        assert many[name] == pytest.approx(one[name], rel=1e-7, abs=1e-7), name
