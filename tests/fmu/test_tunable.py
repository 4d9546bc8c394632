"""Parameters that the description calls tunable change between steps; bad values change nothing."""

import math

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Discard
from fmpy.validation import validate_fmu

from inertia_module.contract.models import INERTIA_MODULE
from inertia_module.harness.fmu import Fmu, FmuError
from inertia_module.harness.loading import messages_of_others
from inertia_module.harness.simulate import drive

from .conftest import sentence

TUNED = {
    **{"input_friction": 0.02, "drive_friction": 0.01, "link2_friction": 0.05, "output_friction": 0.2},
    **{"shaft_damping": 0.4, "driven_friction": 0.1, "balancer": 0.5, "kinematic_ratio": 0.7},
}
TUNABLE = [variable.name for variable in INERTIA_MODULE.variables if variable.is_tunable]
START = {"omega1": 100.0, "load_torque": 10.0}
LEVELS = {
    "kinematic": {"fidelity": 0, "kinematic_ratio": 0.3},
    "rigid": {"fidelity": 2},
    "fixed steps": {"fidelity": 2, "method": 1, "max_step": 1e-3},
    "elastic": {"fidelity": 3, "output_inertia": 0.02},
    "by torque": {"fidelity": 2, "drive": 1, "input_inertia": 0.3, "drive_torque": 20.0},
}


@pytest.fixture(params=LEVELS)
def level(request):
    return START | LEVELS[request.param]


def tune(instance, **values):
    """Set Real variables in one call."""
    set_reals = instance.fmu.setFloat64 if instance.is_fmi3 else instance.fmu.setReal
    set_reals([instance.references[name] for name in values], list(values.values()))


def run(instance, *steps):
    for step in steps:
        instance.step(step)
    return instance.all_values()


def discarded(action):
    """The message of a call that is answered by fmi2Discard."""
    with messages_of_others() as messages, pytest.raises(FMICallException) as caught:
        action()
    assert caught.value.status == fmi2Discard
    return "; ".join(messages)


def test_description_says_what_is_tunable(fmu_path, description):
    tunable = [v for v in description.modelVariables if v.variability == "tunable"]
    assert [v.name for v in tunable] == TUNABLE
    assert TUNED.keys() <= set(TUNABLE)
    assert {v.causality for v in tunable} == {"parameter"}
    assert validate_fmu(str(fmu_path)) == []


def test_parameter_tuned_before_the_first_step_acts_as_a_start_value(instances, level):
    # but for the ratio: its change after the start is a jump of the speed
    tuned = TUNED | {"kinematic_ratio": level.get("kinematic_ratio", 0.0)}
    later = instances().start(**level)
    tune(later, **tuned)
    assert run(later, 0.01, 0.02) == run(instances().start(**(level | tuned)), 0.01, 0.02)


def test_outputs_hold_the_last_step_and_the_next_one_feels_the_parameters(instances, level):
    tuned, undisturbed = instances().start(**level), instances().start(**level)
    before = run(tuned, 0.01, 0.013)
    assert run(undisturbed, 0.01, 0.013) == before
    tune(tuned, **TUNED)
    assert tuned.all_values() == before | TUNED
    after, other = run(tuned, 0.01), run(undisturbed, 0.01)
    assert after["omega_out"] != pytest.approx(other["omega_out"], rel=1e-4)


def test_energies_balance_while_parameters_change(instances, level):
    instance = instances().start(**level)
    values = instance.all_values()
    start = {name: values[name] for name in TUNED}
    for n in range(20):
        tune(instance, **(TUNED if n % 2 else start))
        values = run(instance, 0.01)
        energies = [abs(values[name]) for name in ("energy_in", "energy_out", "energy_stored")]
        share = 5e-2 if values["method"] else 1e-5  # fixed steps lose some, and say so
        assert abs(values["energy_residual"]) < share * max(energies)
    assert values["energy_lost"] > 0.0


def test_state_holds_the_tuned_parameters(instances, level):
    instance, other = instances().start(**level), instances()
    run(instance, 0.01)
    tune(instance, **TUNED)
    kept = instance.fmu.getFMUstate()
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(instance.fmu.serializeFMUstate(kept)))
    first = run(instance, 0.013, 0.007)
    tune(instance, **dict.fromkeys(TUNED, 0.3))
    run(instance, 0.01)
    instance.fmu.setFMUstate(kept)
    assert run(instance, 0.013, 0.007) == first
    assert run(other, 0.013, 0.007) == first
    instance.fmu.freeFMUstate(kept)


@pytest.mark.parametrize("name", TUNABLE)
def test_bad_value_is_discarded_with_a_sentence_and_nothing_changes(instances, name):
    variable = INERTIA_MODULE.by_name[name]
    instance, undisturbed = (instances().start(**START) for _ in range(2))
    for value in (math.nan, math.inf, variable.minimum - 1.0, variable.maximum * 2.0):
        before = run(instance, 1e-3)
        said = discarded(lambda bad=value: tune(instance, omega1=7.0, **{name: bad}))
        assert said == sentence(variable, value)
        assert instance.all_values() == before == run(undisturbed, 1e-3)
    tune(instance, **{name: before[name]})  # no change
    assert run(instance, 0.01) == run(undisturbed, 0.01)


def test_parameters_that_do_not_go_together_are_discarded(instances):
    driven = {**START, **LEVELS["by torque"], "fidelity": 1}
    instance, undisturbed = (instances().start(**driven) for _ in range(2))
    before = run(instance, 0.1)
    said = discarded(lambda: tune(instance, omega1=50.0, balancer=0.3, link2_friction=0.05))
    assert said.startswith(
        "with fidelity = 1 (averaged) and drive = 1 (torque) losses must be off, are input_friction = 0, "
    )
    assert "link2_friction = 0.05" in said
    assert instance.all_values() == before == run(undisturbed, 0.1)
    assert run(instance, 0.1) == run(undisturbed, 0.1)


def test_nothing_is_tuned_after_the_end(instance):
    instance.start(**START)
    instance.fmu.terminate()
    said = instance.refusal(lambda: instance.set(balancer=0.5))
    assert said == "setting balancer must come before terminate, the instance is terminated"


def test_harness_sets_them_by_name_with_units(fmu_path):
    with Fmu(fmu_path) as fmu:
        fmu.advance(0.01)
        fmu.set(load_torque=3.0, driven_friction="0.1 N.m.s/rad")
        assert fmu.read(("load_torque", "driven_friction")) == (3.0, 0.1)
        with pytest.raises(FmuError, match=r"^balancer must be between -10 and 10, is 11$"):
            fmu.set(load_torque=5.0, driven_friction=0.2, balancer=11.0)
        assert fmu.read(("load_torque", "driven_friction", "balancer")) == (3.0, 0.1, 0.0)


def test_column_of_a_table_tunes_them(fmu_path):
    table = {"time": [0.0, 0.049, 0.05, 0.1], "omega1": 100.0, "load_torque": 10.0}
    tuned = drive(fmu_path, {**table, "output_friction": [0.0, 0.0, 0.5, 0.5]}, 0.1, 0.01)["omega_out"]
    plain = drive(fmu_path, table, 0.1, 0.01)["omega_out"]
    assert tuned[:6].tolist() == plain[:6].tolist()
    assert all(tuned[6:] < plain[6:])
