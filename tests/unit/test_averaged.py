"""Fidelity averaged: the mean motion of the output shaft."""

import math

import pytest
from scenes import FREEWHEELS, SCENES, advanced, started

from inertia_module.kernel import codes
from inertia_module.memory import Module, Refused

AVERAGED = {"fidelity": 1}


def averaged(kernel, layout, **values):
    return started(kernel, SCENES[layout], AVERAGED, values)


def audit(module, bound=1e-5):
    scale = abs(module["energy_in"]) + abs(module["energy_out"]) + abs(module["energy_stored"])
    assert abs(module["energy_residual"]) <= bound * scale


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("omega1", [100.0, -100.0])
def test_mean_speed_stays_within_half_a_percent_of_omega1_of_the_rigid_module(compiled, layout, omega1):
    heavy = {"omega1": omega1, "load_torque": 8.0, "output_inertia": 20.0}
    mean, rigid = (started(compiled, SCENES[layout], heavy, fidelity=fidelity) for fidelity in (1, 2))
    for _ in range(20):
        advanced(mean, 4.0)
        advanced(rigid, 4.0)
        assert mean["omega_out"] == pytest.approx(rigid["omega_out"], abs=0.005 * abs(omega1))
    audit(mean)


@pytest.mark.parametrize("layout", SCENES)
def test_energy_taken_in_while_the_input_changes_is_the_mean_of_the_rigid_module(compiled, layout):
    heavy = {
        "omega1": 60.0,
        "load_torque": 4.0,
        "output_inertia": 20.0,
        "input_hold": 1,
        "input_inertia": 0.05,
    }
    mean, rigid = (started(compiled, SCENES[layout], heavy, fidelity=fidelity) for fidelity in (1, 2))
    start = rigid["energy_stored"] - mean["energy_stored"]  # the rigid one starts at one angle
    for n in range(1, 401):
        for module in (mean, rigid):
            advanced(module, 0.05, omega1=60.0 + 0.1 * n)
    means = []
    for module in (mean, rigid):
        total = 0.0
        for _ in range(2000):
            total += advanced(module, 1.3e-3)["energy_in"]
        means.append(total / 2000)
    assert means[1] + start == pytest.approx(means[0], rel=2e-3)
    assert mean["energy_out"] == pytest.approx(rigid["energy_out"], rel=5e-3)
    audit(mean)


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("load", [0.0, 3.0, -5.0, 20.0])
@pytest.mark.parametrize("input_hold", [0, 1])
def test_one_long_step_equals_many_short_ones(compiled, layout, load, input_hold):
    long, short = (
        averaged(compiled, layout, load_torque=load, input_hold=input_hold, tolerance=1e-8) for _ in range(2)
    )
    advanced(long, 5.0)
    advanced(short, *[0.01] * 500)
    assert long["omega_out"] == pytest.approx(short["omega_out"], rel=1e-6, abs=1e-6)
    assert long["energy_in"] == pytest.approx(short["energy_in"], rel=1e-6, abs=1e-4)
    audit(long)
    audit(short)


@pytest.mark.parametrize("layout", SCENES)
def test_error_follows_the_tolerance(compiled, layout):
    def final(tolerance):
        return advanced(averaged(compiled, layout, tolerance=tolerance, load_torque=5.0), 3.0)

    exact = final(1e-12)["omega_out"]
    for tolerance in (1e-3, 1e-5, 1e-7, 1e-9):
        module = final(tolerance)
        assert module["omega_out"] == pytest.approx(exact, rel=10.0 * tolerance)
        audit(module, 3.0 * tolerance)


def test_unloaded_shaft_comes_up_to_link_1_and_locks(compiled):
    module = averaged(compiled, "planar", load_torque=2.0)
    advanced(module, 60.0)
    assert module["omega_out"] == module["omega1"] == module["omega2"]
    assert module["output_torque"] == 2.0
    assert module["torque_ripple"] == 0.0
    assert module["housing_torque"] == 0.0
    assert module["input_torque"] == 2.0
    switches = module["contact_switches"]
    advanced(module, *[0.5] * 20)
    assert module["contact_switches"] == switches
    audit(module)


@pytest.mark.parametrize("input_hold", [0, 1])
def test_locked_shaft_follows_the_input_while_the_mechanism_holds_the_torque(compiled, input_hold):
    module = advanced(averaged(compiled, "planar", load_torque=2.0, input_hold=input_hold), 60.0)
    for n in range(1, 101):
        advanced(module, 0.01, omega1=120.0 + 0.5 * n)
    if input_hold == 0:
        assert module["omega_out"] == module["omega1"]
    assert module["omega_out"] == pytest.approx(170.0, abs=0.6)
    assert module["output_torque_mean"] == pytest.approx(2.0 + 0.4 * 50.0, rel=1e-6)
    audit(module)


def test_locked_shaft_slips_under_a_load_beyond_the_lock_up_torque(compiled):
    module = advanced(averaged(compiled, "planar", load_torque=2.0), 60.0)
    advanced(module, 0.05, load_torque=2000.0)
    assert module["omega_out"] < 120.0
    audit(module)


def test_overrunning_shaft_leaves_the_input_behind_and_comes_back(compiled):
    module = advanced(averaged(compiled, "planar", load_torque=2.0), 60.0)
    advanced(module, 1.0, load_torque=-4.0)
    assert module["omega_out"] == pytest.approx(120.0 + 4.0 / 0.4, rel=1e-12)
    assert module["output_torque"] == 0.0
    advanced(module, 10.0, load_torque=2.0)
    assert module["omega_out"] == 120.0
    audit(module)


@pytest.mark.parametrize("layout", SCENES)
def test_load_above_the_stall_torque_keeps_the_shaft_at_rest(compiled, layout):
    stall = averaged(compiled, layout, load_torque=0.0)["output_torque"]
    module = averaged(compiled, layout, load_torque=1.001 * stall)
    advanced(module, 10.0)
    assert module["omega_out"] == 0.0
    assert module["contact_mode"] == 3.0
    assert module["output_torque"] == module["housing_torque"] == 1.001 * stall
    assert module["mesh_torque"] == 0.0
    advanced(module, 1.0, load_torque=0.999 * stall)
    assert module["omega_out"] > 0.0
    audit(module)


@pytest.mark.parametrize("layout", SCENES)
def test_shaft_is_braked_to_rest_and_stays_there(compiled, layout):
    module = advanced(averaged(compiled, layout), 2.0)
    advanced(module, 5.0, load_torque=200.0)
    assert module["omega_out"] == 0.0
    assert module["energy_stored"] == pytest.approx(averaged(compiled, layout)["energy_stored"], rel=1e-12)
    audit(module)


@pytest.mark.parametrize("layout", SCENES)
def test_light_shaft_settles_where_the_mean_torque_is_the_load_at_little_cost(compiled, layout):
    load = 0.5 * averaged(compiled, layout)["output_torque"]
    light = averaged(compiled, layout, output_inertia=1e-9, load_torque=load)
    advanced(light, 0.01)
    assert light["output_torque"] == pytest.approx(load, rel=1e-5)
    assert light["rhs_evaluations"] < 500
    before = light["rhs_evaluations"]
    for n in range(100):
        advanced(light, 0.01, omega1=SCENES[layout]["omega1"] * (1.0 + 0.001 * n))
        assert light["output_torque"] == pytest.approx(load, rel=1e-4)
    assert light["rhs_evaluations"] - before < 100 * 200
    audit(light, 1e-4)


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("input_hold", [0, 1])
def test_input_passes_through_zero_and_back(compiled, layout, input_hold):
    module = averaged(compiled, layout, input_hold=input_hold, output_inertia=2.0, load_torque=1.0)
    for n in range(1, 41):
        advanced(module, 0.1, omega1=SCENES[layout]["omega1"] * math.cos(0.1 * math.pi * n))
        audit(module)
    assert module["omega_out"] > 0.0


@pytest.mark.parametrize("layout", SCENES)
def test_linear_input_through_zero_within_a_step_is_that_of_many_steps(compiled, layout):
    long, short = (
        averaged(compiled, layout, input_hold=1, output_inertia=2.0, load_torque=1.0, tolerance=1e-9)
        for _ in range(2)
    )
    for module in (long, short):
        advanced(module, 1.0)
        advanced(module, 1e-3, omega1=module["omega1"] - 0.1)  # from here on 100 rad/s^2 downwards
    start = long["omega1"]
    advanced(long, 1.0, omega1=start - 0.1)
    for n in range(1000):
        advanced(short, 1e-3, omega1=start - 0.1 * (n + 1))
    assert long["omega_out"] == pytest.approx(short["omega_out"], rel=1e-4)
    audit(long)


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("omega1", [1e-9, -1e-9, 1e-3, 1e5, -1e5])
@pytest.mark.parametrize("inertia", [1e-9, 1e9])
@pytest.mark.parametrize("load", [0.0, 1e9, -1e9, 1e-12])
def test_extremes_stay_finite(compiled, layout, omega1, inertia, load):
    module = averaged(compiled, layout, omega1=omega1, output_inertia=inertia, load_torque=load)
    for step in (1e-9, 1e-3, 1.0):
        advanced(module, step)
    for value in module.snapshot().values():
        assert math.isfinite(value)
    assert module["omega_out"] >= 0.0
    assert module["rhs_evaluations"] < 1e5
    audit(module, 1e-4)


def test_very_long_steps_cost_little(compiled):
    module = advanced(averaged(compiled, "bevel", load_torque=2.0), 1000.0, 1000.0)
    assert module["rhs_evaluations"] < 2000
    assert module["output_torque"] == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize("layout", SCENES)
def test_saved_and_restored_module_goes_on_as_it_was(kernel, layout):
    module = advanced(averaged(kernel, layout), 0.5)
    other = started(kernel)
    other.restore(module.save())
    advanced(module, 0.3, 0.2, omega1=80.0)
    advanced(other, 0.3, 0.2, omega1=80.0)
    assert other.save() == module.save()


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("freewheels", [name for name in FREEWHEELS if name != "both freewheels"])
def test_without_both_freewheels_it_is_refused(kernel, layout, freewheels):
    with pytest.raises(
        Refused, match=r"^with fidelity = 1 \(averaged\) housing_freewheel and output_freewheel must both"
    ):
        averaged(kernel, layout, **FREEWHEELS[freewheels])


def test_method_is_ignored_for_there_is_no_switching_to_locate(compiled):
    event, timestepping = (advanced(averaged(compiled, "planar", method=n), 1.0) for n in (0, 1))
    assert event["omega_out"] == timestepping["omega_out"]


def test_no_imbalance_gives_no_torque(compiled):
    module = advanced(averaged(compiled, "bevel", imbalance_mass=0.0, load_torque=0.0), 1.0)
    assert module["omega_out"] == 0.0
    assert module["output_torque"] == 0.0


@pytest.mark.parametrize("load", [5.0, 0.0, -5.0])
def test_no_imbalance_takes_no_input_torque_while_link_1_rests(kernel, load):
    module = averaged(kernel, "bevel", imbalance_mass=0.0, omega1=0.0, load_torque=load)
    assert module["input_torque"] == 0.0
    assert advanced(module, 0.1)["input_torque"] == 0.0


@pytest.mark.parametrize("layout", SCENES)
def test_checking_parameters_builds_no_map(layout):
    module = Module("plain")
    module.check(**SCENES[layout], fidelity=1)
    assert module.derived.map_ready == module.derived.forward.count == 0.0
    assert not module.started
    with pytest.raises(Refused, match="fidelity = 1"):
        module.check(housing_freewheel=False)


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("input_hold", [0, 1])
def test_both_kernels_give_the_same_mean_motion(compiled, layout, input_hold):
    def driven(kernel):
        module = averaged(kernel, layout, input_hold=input_hold)
        omega1 = module["omega1"]
        for n in range(25):
            advanced(module, 0.02 + 0.01 * (n % 3), omega1=omega1 * (1.0 + 0.4 * math.sin(0.7 * n)))
        advanced(module, 0.2, omega1=-0.5 * omega1, load_torque=-3.0)
        return advanced(module, 0.2, 0.1, omega1=0.0).snapshot()

    plain, fast = driven("plain"), driven(compiled)
    for name, value in plain.items():
        assert fast[name] == pytest.approx(value, rel=1e-9, abs=1e-9), name


@pytest.mark.parametrize("fidelity", [0, 1, 2, 3])
def test_a_step_without_late_outputs_and_those_afterwards_are_a_whole_step(kernel, fidelity):
    whole, parts = (started(kernel, SCENES["planar"], fidelity=fidelity) for _ in range(2))
    advanced(whole, 0.01, 0.01)
    late = [variable.name for variable in parts.model.variables if variable.late]
    before = [parts[name] for name in late]
    for _ in range(2):
        assert parts.call(codes.STEP_ONLY, 0.01) == 0
    assert [parts[name] for name in late] == before
    for name in set(parts.model.by_name) - set(late):
        assert parts[name] == whole[name], name
    assert parts.call(codes.OUTPUTS, 0.0) == 0
    assert parts.save() == whole.save()


def test_shaft_that_starts_at_the_end_of_the_map_comes_to_rest_within_one_step(kernel):
    values = {"fidelity": 1, "a": 0.3, "b": 0.7, "omega1": 0.0, "load_torque": 1e4, "omega_out_start": 1.58}
    module = started(kernel, values)
    module.set_rates(omega1=76.0)
    module.advance(0.013)
    assert module["omega_out"] == 0.0
    assert module["rhs_evaluations"] < 1e4
