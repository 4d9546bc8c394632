"""Parameters that the description calls tunable change between steps; bad values change nothing."""

import math

from fmpy.fmi2 import fmi2Discard

from inertia_module.contract.models import INERTIA_MODULE
from inertia_module.harness.simulate import drive

from .conftest import LEVELS, R1, sentence

TUNABLE = [variable.name for variable in INERTIA_MODULE.variables if variable.is_tunable]
START = {**R1, "drive_torque": 20.0}


def tune(instance, **values):
    """Set Real variables in one call."""
    set_reals = instance.fmu.setFloat64 if instance.is_fmi3 else instance.fmu.setReal
    set_reals([instance.references[name] for name in values], list(values.values()))


def run(instance, *steps):
    for step in steps:
        instance.step(step)
    return instance.all_values()


def test_bad_value_is_discarded_with_a_sentence_and_nothing_changes(instances):
    instance, undisturbed = (instances().start(**START) for _ in range(2))
    for name in TUNABLE:
        variable = INERTIA_MODULE.by_name[name]
        for value in (math.nan, math.inf, variable.minimum - 1.0, variable.maximum * 2.0):
            before = run(instance, 1e-3)
            bad = {"omega1": 7.0, name: value}
            said = instance.refusal(lambda values=bad: tune(instance, **values), fmi2Discard)
            assert said == sentence(variable, value)
            assert instance.all_values() == before == run(undisturbed, 1e-3)
        tune(instance, **{name: before[name]})  # no change
        assert run(instance, 0.01) == run(undisturbed, 0.01)


def test_parameters_that_do_not_go_together_are_discarded(instances):
    instance, undisturbed = (instances().start(**START, **LEVELS["averaged, by torque"]) for _ in range(2))
    before = run(instance, 0.1)
    changes = {"omega1": 50.0, "balancer": 0.3, "link2_friction": 0.05}
    said = instance.refusal(lambda: tune(instance, **changes), fmi2Discard)
    assert said.startswith(
        "with fidelity = 1 (averaged) and drive = 1 (torque) losses must be off, are input_friction = 0, "
    )
    assert "link2_friction = 0.05" in said
    assert instance.all_values() == before == run(undisturbed, 0.1)
    assert run(instance, 0.1) == run(undisturbed, 0.1)


def test_column_of_a_table_tunes_them(fmu_path):
    table = {"time": [0.0, 0.049, 0.05, 0.1], **R1}
    tuned = drive(fmu_path, {**table, "output_friction": [0.0, 0.0, 0.5, 0.5]}, 0.1, 0.01)["omega_out"]
    plain = drive(fmu_path, table, 0.1, 0.01)["omega_out"]
    assert tuned[:6].tolist() == plain[:6].tolist()
    assert all(tuned[6:] < plain[6:])
