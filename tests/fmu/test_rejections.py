"""Test that invalid inputs and calls out of order are rejected with a message and without effect."""

import ctypes
import math
import re
from functools import partial

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2Discard, fmi2LastSuccessfulTime, fmi2Terminated
from rejected import REJECTED, assert_rejected, sentence

from inertia_module.common.errors import InertiaModuleError
from inertia_module.fmi.instance import Fmu
from inertia_module.fmi.loading import Log, callbacks_of
from inertia_module.interface.models import DRIVEN_SHAFT, INERTIA_MODULE
from inertia_module.interface.variables import BOOLEAN, PARAMETER, REAL
from inertia_module.model import Module
from tests.packed import files_of, with_content
from tests.system.programs import process

from .conftest import LEVELS, R1

# Valid inputs, also torque-driven.
GOOD = {INERTIA_MODULE: {**R1, "drive_torque": 20.0}, DRIVEN_SHAFT: {"hub_speed": 20.0, "load_torque": 3.0}}
STARTS = {
    INERTIA_MODULE: [{"drive": 0, "input_inertia": 0.2}, {"drive": 1, "input_inertia": 0.2}],
    DRIVEN_SHAFT: [{}],
}
BAD_VALUES = {"rad/s": (math.nan, -math.inf, 1e9), "N.m": (math.nan, -math.inf, 1e13, -1e13)}
BAD_STEPS = (0.0, -0.01, math.nan, math.inf, 1e9, 5e-324)
BAD_STEP = "communication step must be between 1e-30 and 1e+06 s (got {:.16g})"
PHASES = INSTANTIATED, INITIALIZING, STEPPING, TERMINATED, IN_ERROR = (
    *("instantiated", "in initialization mode", "initialized", "terminated"),
    "in error since initialization",
)
# Allowed phases of each call.
CALLS = {
    "doStep": ("after exitInitializationMode", {STEPPING}),
    "terminate": ("after exitInitializationMode", {STEPPING}),
    "setupExperiment": ("before enterInitializationMode", {INSTANTIATED}),
    "enterInitializationMode": ("directly after instantiation or reset", {INSTANTIATED}),
    "exitInitializationMode": ("after enterInitializationMode", {INITIALIZING}),
    "setting omega1": ("before terminate", set(PHASES[:3])),
    "setting balancer": ("before terminate", set(PHASES[:3])),
    "setting link2_inertia": ("before the end of initialization", set(PHASES[:2])),
}


def in_phase(instance, phase):
    """Bring an instance into a phase."""
    if phase == INSTANTIATED:
        return instance
    if phase == INITIALIZING:
        instance.fmu.setupExperiment()
        instance.fmu.enterInitializationMode()
    elif phase == IN_ERROR:
        in_phase(instance, INITIALIZING).set(**R1)
        speed = instance.get("input_speed")
        instance.set(imbalance_mass=-1.0)
        message = instance.rejection(instance.fmu.exitInitializationMode)
        assert message == "imbalance_mass must be between 0 and 100000 kg (got -1)"
        # Values can be read for debugging.
        assert (instance.get("imbalance_mass"), instance.get("input_speed")) == (-1.0, speed)
    else:
        instance.start(**R1)
        instance.step(0.1)
        if phase == TERMINATED:
            instance.fmu.terminate()
    return instance


def call(instance, name):
    what, _, variable = name.partition(" ")
    if what == "setting":
        instance.set(**{variable: 3.0})
    elif what == "doStep":
        instance.try_step(0.01)
    else:
        getattr(instance.fmu, what)()


def out_of_range(model):
    """Yield parameters of a model with values outside their range."""
    for variable in model.with_causality(PARAMETER):
        if variable.kind == REAL:
            too_far = (variable.minimum - 1.0, variable.maximum * 2.0 + 1.0)
            yield from ((variable, value) for value in (math.nan, math.inf, *too_far))
        elif variable.kind != BOOLEAN:  # A Boolean of FMI has two values.
            yield from ((variable, value) for value in (int(variable.minimum) - 1, int(variable.maximum) + 1))


# --- values ---


def test_parameter_out_of_range_is_reported_with_its_range(instance, model):
    for variable, value in out_of_range(model):
        instance.set(**{variable.name: value})
        assert instance.rejection(instance.start) == sentence(variable, value)
        instance.fmu.reset()
    instance.start()
    assert not instance.is_discarded(0.01)


def test_invalid_input_or_step_is_discarded_without_effect(instances, model):
    good = GOOD[model]
    for start in STARTS[model]:
        instance, undisturbed = (instances().start(**good, **start) for _ in range(2))
        bad = [(name, value) for name in good for value in BAD_VALUES[model.by_name[name].unit]]
        for name, value in [*bad, *((None, step) for step in BAD_STEPS)]:
            before = instance.all_values()
            instance.set(**({name: value} if name else {}))
            message = instance.rejection(partial(instance.try_step, 0.01 if name else value), fmi2Discard)
            assert message == (sentence(model.by_name[name], value) if name else BAD_STEP.format(value))
            instance.set(**good)
            assert instance.all_values() == before, f"{message}: values have changed"
            for each in (instance, undisturbed):
                each.step(0.1)
            assert instance.all_values() == undisturbed.all_values(), f"{message}: the next step is another"


def messages_of(*names_and_values):
    """Return a pattern of the messages about values of variables of the module."""
    message = "; ".join(sentence(INERTIA_MODULE.by_name[name], value) for name, value in names_and_values)
    return f"^{re.escape(message)}$"


BAD_PARAMETERS = {"z2": 0, "imbalance_mass": -1.0, "tolerance": 7.0}


@pytest.mark.parametrize(
    "values, message",
    [
        ({"inputs": {"omega1": math.nan}}, messages_of(("omega1", math.nan))),
        ({"parameters": BAD_PARAMETERS}, messages_of(*BAD_PARAMETERS.items())),
        *(
            ({"tolerance": n}, rf"^tolerance must be .* \(got {n:.16g}\)$")
            for n in (0.0, -1.0, math.nan, 1.0)
        ),
        ({"parameters": {"100%s%n": 1.0}}, "^InertiaModule.*.fmu: unknown variable '100%s%n'"),
        (
            {"start_time": 1.0, "stop_time": 0.5},
            r"^stop time must be at least the start time 1 s \(got 0.5\)$",
        ),
    ],
)
def test_all_invalid_start_values_are_reported_together(fmu_path, values, message):
    assert_rejected(message, Fmu, fmu_path, **values)


def test_inconsistent_parameters_are_rejected_with_the_message_of_the_model(instance):
    for parameters, _ in REJECTED["combinations"]:
        with pytest.raises(InertiaModuleError) as caught:
            Module("plain").start(**parameters)
        message = instance.rejection(lambda values=parameters: instance.start(**values))
        assert message == str(caught.value)
        instance.fmu.reset()
    instance.start()
    assert not instance.is_discarded(0.01)


def test_invalid_value_of_a_tunable_parameter_is_discarded_without_effect(instances):
    instance, undisturbed = (instances().start(**GOOD[INERTIA_MODULE]) for _ in range(2))
    for variable in (each for each in INERTIA_MODULE.variables if each.is_tunable):
        name, before = variable.name, instance.all_values()
        for value in (math.nan, math.inf, variable.minimum - 1.0, variable.maximum * 2.0):
            message = instance.rejection(partial(instance.set, **{"omega1": 7.0, name: value}), fmi2Discard)
            assert message == sentence(variable, value)
            assert instance.all_values() == before
        instance.set(**{name: before[name]})  # The variable is unchanged.
        for each in (instance, undisturbed):
            each.step(0.01)
        assert instance.all_values() == undisturbed.all_values()


def test_inconsistent_tunable_parameters_are_discarded(instances):
    instance, undisturbed = (
        instances().start(**GOOD[INERTIA_MODULE], **LEVELS["averaged, by torque"]) for _ in range(2)
    )
    before = instance.all_values()
    message = instance.rejection(partial(instance.set, omega1=50.0, balancer=0.3, windage=0.05), fmi2Discard)
    assert message.startswith(
        "windage must be 0 with fidelity = averaged (got 0.05). Windage requires fidelity 0"
    )
    assert instance.all_values() == before
    for each in (instance, undisturbed):
        each.step(0.1)
    assert instance.all_values() == undisturbed.all_values()


def test_outputs_unknown_references_and_wrong_types_are_rejected(instance):
    before = in_phase(instance, STEPPING).all_values()
    message = instance.rejection(lambda: instance.set(omega_out=77.0))
    assert message == "a variable to set must be an input or a parameter (omega_out is calculated)"
    z2, omega1 = (instance.references[name] for name in ("z2", "omega1"))
    real, integer = ("Float64", "Int32") if instance.is_fmi3 else ("Real", "Integer")
    for act, kind, reference, *values in (
        *(("get", real, 9999), ("get", real, z2), ("get", integer, omega1)),
        *(("set", real, 9999, [1.0]), ("set", real, z2, [1.0])),
    ):
        message = instance.rejection(partial(getattr(instance.fmu, act + kind), [reference], *values))
        assert message == (
            f"a value reference must belong to a variable of type {kind} in modelDescription.xml"
            f" (got {reference})"
        )
    assert instance.all_values() == before
    assert not instance.is_discarded(0.01)


@pytest.mark.parametrize("version", ["", "3"])
def test_shaft_rejects_the_state_of_a_module(instances_of, version):
    foreign = instances_of(f"InertiaModule{version}").start(**R1).saved()
    shaft = instances_of(f"DrivenShaft{version}").start(hub_speed=20.0)
    message = shaft.rejection(lambda: shaft.fmu.deSerializeFMUstate(foreign))
    assert "the state must be saved by this build, with " in message
    assert not shaft.is_discarded(0.01)


def test_work_without_end_is_an_error_and_no_hang(instance):
    instance.start(omega1=1e5, load_torque=0.0, output_freewheel=False, housing_freewheel=False)
    instance.step(1e-4)
    before = instance.all_values()
    assert instance.is_discarded(1e5)
    assert instance.all_values() == before
    assert not instance.is_discarded(1e-4)


# --- order of calls ---


@pytest.mark.parametrize("phase", PHASES)
def test_calls_out_of_order_are_rejected_without_effect_and_reset_restarts(instances, phase):
    instance = in_phase(instances(), phase)
    for name, (when, phases) in CALLS.items():
        if phase in phases or (instance.is_fmi3 and name == "setupExperiment"):
            continue  # FMI 3.0 has no such call.
        before = phase == INSTANTIATED or instance.all_values()
        message = instance.rejection(lambda called=name: call(instance, called))
        assert message == f"{name} is allowed only {when} (the instance is {phase})"
        assert phase == INSTANTIATED or instance.all_values() == before
    if phase == STEPPING:
        assert not instance.is_discarded(0.01)
    instance.fmu.reset()
    fresh, instance.time = instances(), 0.0
    for each in (instance, fresh):
        each.start(**R1).step(0.01)
    assert instance.all_values() == fresh.all_values()


def test_in_initialization_mode_outputs_follow_inputs_and_errors_can_be_corrected(instance):
    instance.set(omega2_start=1.0, omega_out_start=1.0, drive_angle_start=0.7)
    in_phase(instance, INITIALIZING)
    torques = []
    for speed in (50.0, 100.0):
        instance.set(omega1=speed, load_torque=10.0)
        torques.append(instance.get("mesh_torque"))
    assert torques[0] != torques[1]
    instance.set(imbalance_mass=-1.0)
    message = instance.rejection(lambda: instance.get("mesh_torque"), fmi2Discard)
    assert message == "imbalance_mass must be between 0 and 100000 kg (got -1)"
    instance.set(imbalance_mass=1.0)
    assert instance.get("mesh_torque") == torques[1]
    instance.fmu.exitInitializationMode()
    assert (instance.get("mesh_torque"), instance.get("omega_out")) == (torques[1], 1.0)
    assert not instance.is_discarded(0.01)


@pytest.mark.fmi2
def test_last_successful_time_is_the_beginning_of_a_discarded_step(instance):
    instance.start(**R1)
    instance.step(0.25)
    instance.set(omega1=math.nan)
    assert instance.is_discarded(0.1)
    assert instance.fmu.getRealStatus(fmi2LastSuccessfulTime) == 0.25
    terminated = ctypes.c_int(7)
    instance.fmu.fmi2GetBooleanStatus(instance.fmu.component, fmi2Terminated, ctypes.byref(terminated))
    assert terminated.value == 0
    instance.set(omega1=100.0)
    instance.step(0.1)
    assert instance.fmu.getRealStatus(fmi2LastSuccessfulTime) == pytest.approx(0.35)


# --- times ---


@pytest.mark.parametrize("begin", [0.0, 7.0])
def test_step_past_the_stop_time_is_an_error_without_effect(instances, begin):
    one, endless = instances(), instances()
    one.fmu.setupExperiment(startTime=begin, stopTime=begin + 0.3)
    endless.fmu.setupExperiment(startTime=begin)
    for instance in (one, endless):
        instance.time = begin
        instance.set(**R1)
        instance.fmu.enterInitializationMode()
        instance.fmu.exitInitializationMode()
        for _ in range(3):  # 3 · 0.1 exceeds 0.3 by a rounding error.
            instance.step(0.1)
    before = one.all_values()
    message = one.rejection(lambda: one.try_step(0.1))
    assert message == (
        f"a step must end at or before the stop time {begin + 0.3:.16g} s"
        f" (got a step of 0.1 s from {one.time:.16g} s)"
    )
    assert one.all_values() == before
    for instance in (one, endless):
        instance.step(1e-6)  # This step has the size of a rounding error of a host.
    assert one.all_values() == endless.all_values()
    endless.step(0.1)


def test_the_stop_time_is_part_of_the_state_and_forgotten_by_a_reset(instances):
    first, second = instances(), instances().start(omega1=100.0)
    first.fmu.setupExperiment(stopTime=0.1)
    first.fmu.enterInitializationMode()
    first.fmu.exitInitializationMode()
    second.restore(first.saved())
    for instance in (first, second):
        assert "at or before the stop time 0.1 s" in instance.rejection(
            lambda tried=instance: tried.try_step(0.2)
        )
    first.fmu.reset()
    first.start(omega1=100.0).step(0.2)


def test_jump_of_the_time_is_logged_once(instance):
    if not instance.is_native:
        pytest.skip("the Python FMU does not look at the time")
    instance.start(**R1)
    for time in (0.0, 7.0, 7.1, 3.0):
        instance.time = time
        instance.step(0.1)
    (message,) = instance.log.warnings + instance.log.errors
    assert (
        "communication point must be the time reached, 0.1 s, or the time of a saved state (got 7 s)"
        in message
    )


# --- log, invalid instances ---


def test_log_categories_select_messages(built):
    with Fmu(built / "InertiaModule.fmu", inputs=R1) as fmu:
        fmu.advance(0.01)
        assert fmu.messages == []
        fmu.set_logging(True, "logSteps")
        fmu.advance(0.01)
        assert fmu.messages[0].startswith("step to t = 0.02 s, length 0.01 s, contact_mode = ")
        fmu.set_logging(False)
        fmu.advance(0.01)
        assert len(fmu.messages) == 1


def test_unknown_log_category_is_rejected_without_effect(instance):
    message = instance.rejection(lambda: instance.fmu.setDebugLogging(False, ["logAll", "logGossip"]))
    assert message.startswith("a log category must be logStatusWarning, ")
    assert message.endswith("logAll (got logGossip)")


@pytest.mark.parametrize(
    "guid, name, message",
    [("{wrong}", "instance", "the GUID must match"), (None, "", "the instance name must not be empty")],
)
def test_instances_of_another_build_or_without_a_name_are_not_made(opened, guid, name, message):
    description, folder = opened("InertiaModule")
    fmu = FMU2Slave(
        guid=guid or description.guid,
        unzipDirectory=str(folder),
        modelIdentifier="InertiaModule",
        instanceName=name,
    )
    log = Log()
    with pytest.raises(Exception, match="nstantiate"):
        fmu.instantiate(callbacks=callbacks_of(log))
    assert message in log.errors[0]


# --- warnings: mechanisms that cannot be built, a deprecated value ---

CASES = {
    "overlap, planar": {"layout": 1, "satellites": 12},
    "overlap, bevel": {"satellites": 6},
    "imbalance, planar": {"layout": 1, "eccentricity": 0.04},
    "imbalance, bevel": {"a": 1.5},
    "both": {"layout": 1, "satellites": 12, "eccentricity": 0.04},
    "method that is no longer available": {"method": 1},
    "none": {},
}


@pytest.mark.parametrize("case", CASES)
def test_warnings_are_logged_at_each_start_as_warnings(instance, fmu_path, case):
    expected = Module("plain").start(**CASES[case]).warnings()
    assert bool(expected) == (case != "none")
    warnings, errors = instance.log.warnings, instance.log.errors
    instance.start(**CASES[case], omega1=100.0)
    instance.step(0.01)
    assert warnings == expected
    instance.fmu.reset()
    instance.start(**CASES[case])
    assert errors == []
    instance.fmu.reset()
    with pytest.raises(FMICallException):  # A rejected call logs no other category.
        instance.start(**CASES[case], imbalance_mass=-1.0)
    assert warnings == 2 * expected
    assert len(errors) == 1
    with Fmu(fmu_path, CASES[case], {"omega1": 100.0}) as fmu:
        fmu.advance(0.01)
        assert fmu.warnings == expected


def test_check_passes_warnings_on_without_a_problem(built, tmp_path):
    content = files_of(built / "InertiaModulePy.fmu")
    (table,) = (name for name in content if name.endswith("interface/variables.py"))
    assert b'evenly spaced", 1,' in content[table]
    # This start value cannot be built. The references in the FMU do not use it.
    content = {name: data for name, data in content.items() if not name.startswith("extra/")}
    content[table] = content[table].replace(b'evenly spaced", 1,', b'evenly spaced", 6,')
    path = with_content(tmp_path / "x.fmu", content)
    # Use a separate process: pythonfmu shares the code of FMUs that were loaded before.
    done = process("-m", "inertia_module", "check", path)
    (warning,) = Module("plain").start(satellites=6).warnings()
    assert done.stderr == f"warning: {warning}\n"
    assert "no problems found" in done.stdout
