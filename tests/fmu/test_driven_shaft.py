"""DrivenShaft.fmu as an importer sees it: values, refusals, states."""

import math

import pytest

from inertia_module.contract.models import DRIVEN_SHAFT
from inertia_module.harness.fmu import Fmu, FmuError
from inertia_module.memory import DrivenShaft

FLAVOURS = ("DrivenShaft", "DrivenShaft3")
GOOD = {"hub_speed": 20.0, "load_torque": 3.0}
BAD_INPUTS = [("hub_speed", math.nan), ("hub_speed", 1e9), ("load_torque", -math.inf)]


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
    for one in (model, instance):
        one.set(shaft_damping=0.7, driven_friction=0.2, balancer=0.3)
    assert instance.all_values() == model.snapshot()
    drive(instance, instance.step)
    drive(model, model.advance)
    assert instance.all_values() == model.snapshot()


def test_parameter_out_of_range_is_named_with_what_is_allowed(instance):
    instance.check_range_of_parameters(DRIVEN_SHAFT)


def test_bad_input_or_step_is_discarded_and_nothing_is_lost(instances):
    one, undisturbed = (instances().start(**GOOD) for _ in range(2))
    one.check_bad_input_and_step(undisturbed, DRIVEN_SHAFT, GOOD, BAD_INPUTS)


def test_bad_input_at_the_end_of_initialisation_is_refused(fmu_path):
    with pytest.raises(FmuError, match=r"^hub_speed must be between .* rad/s, is nan$"):
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
    assert "the state must be one saved by this build, of " in message
    assert not instance.is_discarded(0.01)
