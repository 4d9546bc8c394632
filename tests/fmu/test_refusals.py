"""Bad input never gets in: refused with a message, no crash, nothing lost."""

import functools
import math

import pytest

from inertia_module.contract.models import INERTIA_MODULE
from inertia_module.harness.fmu import Fmu, FmuError

from .conftest import sentence

DO_STEP = "doStep must come after exitInitializationMode"
# parameters that do not go together, and what the sentence says of them
TOGETHER = [
    ({"link2_inertia": 0.0}, ("link2_inertia must be above 0 by", "drive_inertia = 0", "a = 1")),
    ({"link2_inertia": 0.0, "a": 0.7, "b": 0.7}, ("link2_inertia must", "a = 0.7")),
    ({"link2_inertia": 0.0, "imbalance_mass": 0.0}, ("imbalance_mass = 0 link2_inertia must",)),
    ({"layout": 1, "link2_inertia": 0.0, "eccentricity": 0.0}, ("eccentricity = 0", "link2_inertia must")),
    ({"omega2_start": -1.0}, ("with the housing freewheel omega2_start must be at least 0, is -1",)),
    (
        {"omega2_start": 2.0, "omega_out_start": 1.0},
        ("with the output freewheel omega_out_start must be at least omega2_start = 2, is 1",),
    ),
    (
        {"output_freewheel": False, "omega_out_start": 1.0},
        ("without the output freewheel omega_out_start must be omega2_start = 0, is 1",),
    ),
    ({"drive": 1}, ("with drive = 1 (torque) input_inertia", "must be above 0 by", "is 0: ")),
    (
        {"drive": 1, "fidelity": 0, "input_inertia": 1.0},
        ("with drive = 1 (torque) fidelity must be 1 (averaged), 2 (rigid) or 3 (elastic), is 0 ",),
    ),
    (
        {"fidelity": 1, "housing_freewheel": False},
        ("with fidelity = 1 (averaged) housing_freewheel and output_freewheel must both be 1, are 0 and 1",),
    ),
]


def test_parameter_out_of_range_is_named_with_what_is_allowed(instance):
    instance.check_range_of_parameters(INERTIA_MODULE)


def test_all_bad_parameters_are_named_at_once(fmu_path):
    bad = {"z2": 0, "imbalance_mass": -1.0, "tolerance": 7.0}
    with pytest.raises(FmuError) as caught:
        Fmu(fmu_path, bad)
    expected = [sentence(INERTIA_MODULE.by_name[name], value) for name, value in bad.items()]
    assert str(caught.value).split("; ") == expected


def test_parameters_that_do_not_go_together_are_refused(instance):
    for parameters, parts in TOGETHER:
        said = instance.refusal(lambda values=parameters: instance.start(**values))
        for part in parts:
            assert part in said, parameters
        instance.fmu.reset()
    instance.start()
    assert not instance.is_discarded(0.01)


def test_refused_parameters_make_every_step_refused_until_reset(instance):
    assert "imbalance_mass must be between 0 and 1000000000 kg, is -1" in instance.refusal(
        lambda: instance.start(imbalance_mass=-1.0)
    )
    for _ in range(2):
        said = instance.refusal(lambda: instance.try_step(0.01))
        assert said == f"{DO_STEP}, the instance is in error since initialization"
    instance.fmu.reset()
    instance.start(omega1=100.0)
    assert not instance.is_discarded(0.01)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan, 1.0])
def test_bad_tolerance_of_the_experiment_is_refused(fmu_path, tolerance):
    with pytest.raises(FmuError, match=f"tolerance must be .*, is {tolerance:.16g}"):
        Fmu(fmu_path, tolerance=tolerance)


BAD_INPUTS = [
    ("omega1", math.nan),
    ("omega1", -math.inf),
    ("omega1", 1e9),
    ("load_torque", math.nan),
    ("load_torque", 1e13),
    ("drive_torque", math.nan),
    ("drive_torque", -1e13),
]


@pytest.mark.parametrize("drive", [0, 1])
def test_bad_input_or_step_is_discarded_and_nothing_is_lost(instances, drive):
    good = {"omega1": 100.0, "load_torque": 10.0, "drive_torque": 20.0}
    one, undisturbed = (instances().start(**good, drive=drive, input_inertia=0.2) for _ in range(2))
    one.check_bad_input_and_step(undisturbed, INERTIA_MODULE, good, BAD_INPUTS)


@pytest.mark.parametrize("begin", [0.0, 7.0])
def test_a_step_past_the_stop_time_is_an_error_and_nothing_is_lost(instances, begin):
    one, endless = instances(), instances()
    one.fmu.setupExperiment(startTime=begin, stopTime=begin + 0.3)
    endless.fmu.setupExperiment(startTime=begin)
    for instance in (one, endless):
        instance.time = begin
        instance.set(omega1=100.0, load_torque=10.0)
        instance.fmu.enterInitializationMode()
        instance.fmu.exitInitializationMode()
        for _ in range(3):  # 3 · 0.1 is more than 0.3 by a rounding
            instance.step(0.1)
    before = one.all_values()
    said = one.refusal(lambda: one.try_step(0.1))
    assert said == (
        f"a step must end at the stop time {begin + 0.3:.16g} s at the latest,"
        f" is one of 0.1 s from {one.time:.16g} s"
    )
    assert one.all_values() == before
    one.step(1e-6)  # a host's rounding
    endless.step(1e-6)
    assert one.all_values() == endless.all_values()
    endless.step(0.1)


def test_the_stop_time_is_part_of_the_state_and_forgotten_by_a_reset(instances):
    one, other = instances(), instances().start(omega1=100.0)
    one.fmu.setupExperiment(stopTime=0.1)
    one.fmu.enterInitializationMode()
    one.fmu.exitInitializationMode()
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(one.fmu.serializeFMUstate(one.fmu.getFMUstate())))
    for instance in (one, other):
        assert "stop time 0.1 s at the latest" in instance.refusal(lambda tried=instance: tried.try_step(0.2))
    one.fmu.reset()
    one.start(omega1=100.0).step(0.2)


def test_a_stop_time_before_the_start_time_is_refused(fmu_path):
    with pytest.raises(FmuError, match=r"^stop time must be at least the start time 1 s, is 0.5$"):
        Fmu(fmu_path, start_time=1.0, stop_time=0.5)


def test_bad_input_at_the_end_of_initialisation_is_refused(fmu_path):
    with pytest.raises(FmuError, match=r"^omega1 must be between -1000000 and 1000000 rad/s, is nan$"):
        Fmu(fmu_path, inputs={"omega1": math.nan})


def test_work_without_end_is_an_error_and_no_hang(instance):
    instance.start(omega1=1e6, load_torque=0.0, output_freewheel=False, housing_freewheel=False)
    instance.step(1e-4)
    before = instance.all_values()
    assert instance.is_discarded(1e5)
    assert instance.all_values() == before
    assert not instance.is_discarded(1e-4)


def test_steps_out_of_order_are_refused(instance):
    def refused():
        return f"{DO_STEP}, the instance is" in instance.refusal(lambda: instance.try_step(0.01))

    assert refused()
    instance.fmu.setupExperiment()
    assert refused()
    instance.fmu.enterInitializationMode()
    assert refused()
    instance.fmu.exitInitializationMode()
    assert not instance.is_discarded(0.01)
    instance.fmu.terminate()
    assert refused()


def test_end_of_initialisation_without_its_beginning_is_refused(instance):
    message = instance.refusal(instance.fmu.exitInitializationMode)
    assert message == (
        "exitInitializationMode must come after enterInitializationMode, the instance is instantiated"
    )
    assert DO_STEP in instance.refusal(lambda: instance.try_step(0.01))


def test_parameters_cannot_change_after_initialisation(instance):
    instance.start(omega1=100.0)
    message = instance.refusal(lambda: instance.set(link2_inertia=3.0))
    assert (
        message
        == "setting link2_inertia must come before the end of initialization, the instance is initialized"
    )
    assert instance.get("link2_inertia") == 0.005
    assert not instance.is_discarded(0.01)


def test_outputs_cannot_be_set(instance):
    instance.start(omega1=100.0)
    instance.step(0.1)
    value = instance.get("omega_out")
    message = instance.refusal(lambda: instance.set(omega_out=77.0))
    assert message == "a variable that is set must be an input or a parameter, omega_out is calculated"
    assert instance.get("omega_out") == value


def test_unknown_references_and_wrong_types_are_refused(instance):
    instance.start(omega1=100.0)
    z2, omega1 = (instance.references[name] for name in ("z2", "omega1"))
    real, integer = ("Float64", "Int32") if instance.is_fmi3 else ("Real", "Integer")
    for act, kind, *arguments in (
        ("get", real, [9999]),
        ("get", real, [z2]),
        ("get", integer, [omega1]),
        ("set", real, [9999], [1.0]),
        ("set", real, [z2], [1.0]),
    ):
        call = functools.partial(getattr(instance.fmu, f"{act}{kind}"), *arguments)
        assert instance.refusal(call) == (
            f"a value reference must be that of a variable of type {kind} in modelDescription.xml,"
            f" is {arguments[0][0]}"
        )
    assert not instance.is_discarded(0.01)


def test_percent_signs_in_messages_survive(fmu_path):
    with pytest.raises(FmuError, match=r"^100%s%n must be a variable of "):
        Fmu(fmu_path, {"100%s%n": 1.0})
