"""DrivenShaft.fmu as an importer sees it: values, refusals, states."""

import math

import pytest

from inertia_module.instance import DriveError, Fmu
from inertia_module.model import DRIVEN_SHAFT
from inertia_module.module import DrivenShaft
from inertia_module.variables import PARAMETER

FLAVOURS = ("DrivenShaft",)
GOOD = {"hub_speed": 20.0, "load_torque": 3.0}
REALS = [v for v in DRIVEN_SHAFT.with_causality(PARAMETER) if v.kind == "Real"]
OUT_OF_RANGE = [
    *((v.name, math.nan) for v in REALS),
    *((v.name, math.inf) for v in REALS),
    *((v.name, v.minimum - 1.0) for v in REALS),
    *((v.name, v.maximum * 2.0 + 1.0) for v in REALS),
    ("input_hold", 2),
    ("input_hold", -1),
]
BAD_INPUTS = [
    ({"hub_speed": math.nan}, 0.01, "hub_speed = nan"),
    ({"hub_speed": 1e9}, 0.01, "hub_speed = 1000000000"),
    ({"load_torque": -math.inf}, 0.01, "load_torque = -inf"),
    ({}, 0.0, "communication step = 0 s"),
    ({}, math.nan, "communication step = nan s"),
    ({}, 1e9, "communication step = 1000000000 s"),
]


def drive(target, step, n=30, first=0):
    for i in range(first, first + n):
        target.set(hub_speed=20.0 + 3.0 * (i % 4), load_torque=3.0 - 0.2 * i)
        step(0.01 + 0.001 * (i % 3))


@pytest.mark.parametrize("settings", [{}, {"input_hold": 1, "balancer": 1.0, "driven_friction": 0.4}])
def test_fmu_gives_the_bits_of_the_model_in_memory(instance, settings):
    model = DrivenShaft().start(**GOOD, **settings)
    drive(model, model.advance)
    instance.start(**GOOD, **settings)
    drive(instance, instance.step)
    assert instance.all_values() == model.snapshot()


@pytest.mark.parametrize("name, value", OUT_OF_RANGE)
def test_parameter_out_of_range_is_named_with_what_is_allowed(fmu_path, name, value):
    with pytest.raises(DriveError) as caught:
        Fmu(fmu_path, {name: value})
    message = str(caught.value)
    assert f"{name} = {value:.16g}" in message
    assert "allowed is" in message


@pytest.mark.parametrize("inputs, h, words", BAD_INPUTS)
def test_bad_input_or_step_is_discarded_and_nothing_is_lost(instances, inputs, h, words, capfd):
    instance = instances().start(**GOOD)
    undisturbed = instances().start(**GOOD)
    for one in (instance, undisturbed):
        one.step(0.1)
    before = instance.all_values()
    instance.set(**inputs)
    assert instance.is_discarded(h)
    instance.set(**GOOD)
    assert instance.all_values() == before
    for one in (instance, undisturbed):
        one.step(0.1)
    assert instance.all_values() == undisturbed.all_values()
    out = capfd.readouterr().out
    assert words in out
    assert "allowed is" in out


def test_bad_input_at_the_end_of_initialisation_is_refused(fmu_path):
    with pytest.raises(DriveError, match=r"hub_speed = nan is refused: allowed is from"):
        Fmu(fmu_path, inputs={"hub_speed": math.nan})


def test_tolerance_of_the_experiment_is_accepted_and_changes_nothing(instances):
    with_one = instances().start(tolerance=1e-3, **GOOD)
    without = instances().start(**GOOD)
    for one in (with_one, without):
        one.step(0.1)
    assert with_one.all_values() == without.all_values()


def test_restored_state_runs_on_with_the_same_bits(instances):
    instance = instances().start(**GOOD, input_hold=1, balancer=0.7, driven_friction=0.1)
    drive(instance, instance.step)
    saved = instance.fmu.getFMUstate()
    serialised = instance.fmu.serializeFMUstate(saved)
    drive(instance, instance.step, first=30)
    first = instance.all_values()
    instance.fmu.setFMUstate(saved)
    drive(instance, instance.step, first=30)
    assert instance.all_values() == first
    instance.fmu.freeFMUstate(saved)
    second = instances()
    second.fmu.setFMUstate(second.fmu.deSerializeFMUstate(serialised))
    drive(second, second.step, first=30)
    assert second.all_values() == first


def test_state_of_a_module_is_refused(instance, built):
    instance.start(**GOOD)
    with Fmu(built / "InertiaModule.fmu", inputs={"omega1": 100.0}) as module:
        foreign = module.save()
    message = instance.refusal(lambda: instance.fmu.deSerializeFMUstate(foreign))
    assert "bytes is refused: allowed is one saved by this build" in message
    assert not instance.is_discarded(0.01)
