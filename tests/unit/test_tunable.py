"""Test parameters that change between steps: the motion follows the equations with the new values."""

import pytest
from geometry import direct_sums, ratio
from rejected import assert_rejected
from scenes import FRICTION, SCENES, SHAFT, TUNED, advanced, motions, parameters, reference, started

from inertia_module.interface.models import DRIVEN_SHAFT
from inertia_module.model import DrivenShaft, Module
from verification.reference.cases import OMEGA1, OMEGA2, OMEGA4

ELASTIC = {"fidelity": 3, "output_inertia": 0.02, "shaft_damping": 0.05}
LOSSES = {
    **{"journal_friction": 2e-3, "housing_drag": 0.5, "housing_drag_viscous": 1e-3},
    **{"output_drag": 0.4, "output_drag_viscous": 2e-3},
}


def largest_energy(module):
    return max(abs(module[name]) for name in ("energy_in", "energy_out", "energy_stored"))


@motions(("rigid",), added=("ideal",), missing=())
@pytest.mark.parametrize(
    "output, tuned",
    [
        ({}, FRICTION),
        (ELASTIC, {**FRICTION, **SHAFT}),
        ({}, LOSSES),
        (LOSSES, dict.fromkeys(LOSSES, 0.0)),
    ],
    ids=["rigid", "elastic", "losses set in", "losses end"],
)
def test_motion_with_new_parameters_agrees_with_the_reference(compiled, scene, output, tuned):
    values = {**scene, **output}
    module = started(compiled, values, tolerance=1e-9)
    before, after = reference(values), reference({**values, **tuned})
    before.advance(0.023)
    advanced(module, 0.01, 0.013).set(**tuned)
    after.time, after.state = before.time, before.state
    after.set_torques(after.machine.torque, after.machine.load)
    after.advance(0.05)
    advanced(module, 0.01, 0.017)
    speeds = [module[name] for name in ("input_speed", "omega2", "omega_out")]
    assert speeds == pytest.approx(after.state[[OMEGA1, OMEGA2, OMEGA4]], abs=1e-7 * module["input_speed"])
    assert abs(module["energy_residual"]) < 1e-8 * largest_energy(module)


@motions(("rigid", "elastic"), added=("ideal",), missing=())
def test_rates_agree_with_the_following_motion(compiled, scene):
    module = advanced(started(compiled, scene, max_step=1e-5, tolerance=1e-11), 0.02)
    module.set(**FRICTION, **SHAFT)
    rates, h = module.rates(), 1e-6
    first = advanced(module, h).snapshot()
    second = advanced(module, h).snapshot()
    for name in ("omega2", "omega_out", "input_speed", "input_torque", "mesh_torque", "output_acceleration"):
        expected = (second[name] - first[name]) / h
        assert rates[name] == pytest.approx(expected, rel=1e-2, abs=1e-2 * abs(first[name])), name


def test_jump_of_the_prescribed_ratio_is_an_impulse(compiled):
    moment = 1e-13  # s; only the jump has an effect in this time
    p = parameters(fidelity=0, kinematic_ratio=0.3, drive_angle_start=1.0)
    module, k = started(compiled, p, omega1=100.0), ratio(p)
    i, _, b, _, g, _ = direct_sums(p, 1.0)
    for new, speed in ((0.8, 100.0), (0.8, 60.0), (-0.2, 90.0)):
        change, change2 = speed - module["input_speed"], new * speed - module["omega2"]
        held = module["omega2"]
        module.set(kinematic_ratio=new, omega1=speed)
        assert (module["omega2"], module.rates()["omega2"]) == (held, 0.0)
        advanced(module, moment)
        assert module["omega2"] == module["omega_out"] == new * speed
        slipped = k * (change - change2)
        passed = k * (b * change + g * slipped)
        driven = i * change + b * slipped + passed
        assert module["input_torque_mean"] * moment == pytest.approx(driven, rel=1e-7)
        carried = passed - p["link2_inertia"] * change2
        assert module["output_torque_mean"] * moment == pytest.approx(carried, rel=1e-7)
        assert abs(module["energy_residual"]) < 1e-12 * largest_energy(module)


def test_changed_shaft_agrees_with_a_new_shaft(compiled):
    tuned = {name: value for name, value in TUNED.items() if name in DRIVEN_SHAFT.by_name}
    shaft = advanced(DrivenShaft(compiled).start(hub_speed=50.0, load_torque=3.0), 0.02)
    shaft.set(**tuned)
    other = DrivenShaft(compiled).start(
        **tuned,
        hub_speed=50.0,
        load_torque=3.0,
        omega_out_start=shaft["omega_out"],
        twist_start=shaft["twist"],
    )
    for each in (shaft, other):
        advanced(each, 0.02, 0.013, hub_speed=57.0)
    for name in ("shaft_torque", "shaft_torque_mean", "omega_out", "driven_acceleration", "twist"):
        assert shaft[name] == pytest.approx(other[name], rel=1e-12), name
    assert abs(shaft["energy_residual"]) < 1e-12 * shaft["energy_in"]


def test_inconsistent_parameters_are_rejected_without_effect(compiled):
    driven = {**SCENES["bevel"], "drive": 1, "input_inertia": 0.1, "drive_torque": 20.0}
    module = advanced(started(compiled, driven, fidelity=1), 0.1)
    before = module.save()
    words = r"windage must be 0 with fidelity = averaged \(got 0.01\)"
    assert_rejected(words, module.set, omega1=50.0, balancer=0.3, windage=0.01)
    module.set(balancer=0.3)
    undisturbed = Module(compiled)
    undisturbed.restore(before)
    assert advanced(module, 0.1)["omega_out"] == advanced(undisturbed, 0.1)["omega_out"]
