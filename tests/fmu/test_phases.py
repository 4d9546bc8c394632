"""Phases of an instance, what the host can ask about a step, and the log."""

import math

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Discard, fmi2LastSuccessfulTime, fmi2Terminated

from inertia_module.harness.fmu import Fmu
from inertia_module.harness.loading import messages_of_others

GOOD = {"omega1": 100.0, "load_torque": 10.0}


def test_outputs_can_be_read_in_initialization_mode_and_follow_the_inputs(instance):
    instance.fmu.setupExperiment()
    instance.set(omega2_start=1.0, omega_out_start=1.0, drive_angle_start=0.7)
    instance.fmu.enterInitializationMode()
    torques = []
    for speed in (50.0, 100.0):
        instance.set(omega1=speed, load_torque=10.0)
        torques.append(instance.get("mesh_torque"))
    assert torques[0] != torques[1]
    instance.fmu.exitInitializationMode()
    assert instance.get("mesh_torque") == torques[1]
    assert instance.get("omega_out") == 1.0


def test_values_refused_in_initialization_mode_can_be_mended_there(instance):
    instance.fmu.setupExperiment()
    instance.set(omega1=100.0, imbalance_mass=-1.0)
    instance.fmu.enterInitializationMode()
    with messages_of_others() as messages, pytest.raises(FMICallException) as caught:
        instance.get("mesh_torque")
    assert caught.value.status == fmi2Discard
    assert messages == ["imbalance_mass must be between 0 and 1000000000 kg, is -1"]
    instance.set(imbalance_mass=1.0)
    assert math.isfinite(instance.get("mesh_torque"))
    instance.fmu.exitInitializationMode()
    assert not instance.is_discarded(0.01)


@pytest.mark.parametrize(
    "call",
    ["enterInitializationMode", "setupExperiment"],
)
def test_initialization_happens_once(instance, call):
    instance.start(**GOOD)
    if instance.is_fmi3 and call == "setupExperiment":
        pytest.skip("FMI 3.0 has no such call")
    action = getattr(instance.fmu, call)
    said = instance.refusal(action)
    assert said.startswith(f"{call} must come ")
    assert said.endswith(", the instance is initialized")


@pytest.mark.fmi2
def test_last_successful_time_is_the_beginning_of_a_discarded_step(instance):
    instance.start(**GOOD)
    instance.step(0.25)
    instance.set(omega1=math.nan)
    assert instance.is_discarded(0.1)
    assert instance.real_status(fmi2LastSuccessfulTime) == 0.25
    assert instance.boolean_status(fmi2Terminated) is False
    instance.set(omega1=100.0)
    instance.step(0.1)
    assert instance.real_status(fmi2LastSuccessfulTime) == pytest.approx(0.35)


def test_after_terminate_values_are_read_and_nothing_is_set(instance):
    instance.start(**GOOD)
    instance.step(0.1)
    before = instance.all_values()
    instance.fmu.terminate()
    assert "the instance is terminated" in instance.refusal(lambda: instance.set(omega1=50.0))
    assert "setting link2_inertia must come" in instance.refusal(lambda: instance.set(link2_inertia=1.0))
    assert "the instance is terminated" in instance.refusal(lambda: instance.try_step(0.1))
    assert "terminate must come after" in instance.refusal(instance.fmu.terminate)
    assert instance.all_values() == before


def test_after_an_error_values_are_read_for_debugging_and_nothing_is_set(instance):
    instance.fmu.setupExperiment()
    instance.set(**GOOD)
    instance.fmu.enterInitializationMode()
    speed = instance.get("input_speed")
    instance.set(imbalance_mass=-1.0)
    assert "imbalance_mass must be " in instance.refusal(instance.fmu.exitInitializationMode)
    assert (instance.get("imbalance_mass"), instance.get("input_speed")) == (-1.0, speed)
    assert set(instance.all_values()) == set(instance.references)
    for action in (lambda: instance.set(omega1=50.0), instance.fmu.terminate):
        assert "in error since initialization" in instance.refusal(action)
    assert "doStep must come after exitInitializationMode" in instance.refusal(lambda: instance.try_step(0.1))
    assert instance.get("omega1") == GOOD["omega1"]


def test_a_host_whose_time_jumps_is_told_so_once(instance):
    if not instance.is_native:
        pytest.skip("the Python FMU does not look at the time")
    instance.start(**GOOD)
    with messages_of_others() as messages:
        instance.step(0.1)
        instance.time = 7.0
        instance.step(0.1)
        instance.step(0.1)
        instance.time = 3.0
        instance.step(0.1)
    assert len(messages) == 1
    assert (
        "communication point must be the time reached, 0.1 s, or that of a saved state, is 7 s" in messages[0]
    )


def test_log_categories_choose_what_is_said(built):
    with Fmu(built / "InertiaModule.fmu", inputs=GOOD) as fmu:
        fmu.advance(0.01)
        assert fmu.messages == []
        fmu.set_logging(True, "logSteps")
        fmu.advance(0.01)
        assert fmu.messages[0].startswith("step to 0.02 s by 0.01 s, contact_mode = ")
        fmu.set_logging(False)
        fmu.advance(0.01)
        assert len(fmu.messages) == 1


def test_unknown_log_category_is_refused_and_changes_nothing(instance):
    said = instance.refusal(lambda: instance.fmu.setDebugLogging(False, ["logAll", "logGossip"]))
    assert said.startswith("a log category must be logStatusWarning, ")
    assert said.endswith("logAll, is logGossip")


@pytest.mark.parametrize(
    "guid, name, said",
    [("{wrong}", "instance", "the GUID must be that"), (None, "", "the instance name must not be empty")],
)
def test_instances_of_another_build_or_without_a_name_are_not_made(built, guid, name, said):
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    path = str(built / "InertiaModule.fmu")
    description = read_model_description(path)
    fmu = FMU2Slave(
        guid=guid or description.guid,
        unzipDirectory=extract(path),
        modelIdentifier="InertiaModule",
        instanceName=name,
    )
    with messages_of_others() as messages, pytest.raises(Exception, match="nstantiate"):
        fmu.instantiate()
    assert said in messages[0]
