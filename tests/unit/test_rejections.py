"""Test that invalid numbers are rejected with name, value and allowed range."""

import math

import pytest
from rejected import REJECTED, rejection, sentence
from scenes import ENGINE, advanced, started

from inertia_module.interface import variables
from inertia_module.interface.variables import BY_NAME, LOCAL, OUTPUT, PARAMETER, with_causality
from inertia_module.model import DrivenShaft, Module

NO_NUMBERS = (math.nan, math.inf, -math.inf)


def bad_values(variable):
    """Return values just outside the range of a variable, and values that are no numbers."""
    yield from NO_NUMBERS
    if variable.kind in (variables.INTEGER, variables.ENUMERATION, variables.BOOLEAN):
        yield from (0.5, 1.5, -1)
    if variable.kind == variables.BOOLEAN:
        yield 2
    if variable.minimum is not None:
        yield from (variable.minimum - 1, math.nextafter(variable.minimum, -math.inf))
    if variable.maximum is not None:
        yield from (variable.maximum + 1, math.nextafter(variable.maximum, math.inf), 1e300)


@pytest.mark.parametrize("instance_type", [Module, DrivenShaft])
def test_parameter_out_of_range_is_rejected_with_name_value_and_range(instance_type):
    for variable in instance_type.model.with_causality(PARAMETER):
        module = instance_type("plain")
        before = module.save()
        for value in bad_values(variable):
            message = rejection(module.start, **{variable.name: value})
            assert message == sentence(variable, value)
            assert module.save() == before, f"{variable.name} = {value} changes something"
        assert module.start().started, variable.name


@pytest.mark.parametrize("instance_type", [Module, DrivenShaft])
def test_input_out_of_range_is_rejected_and_the_next_step_works(instance_type):
    inputs = list(instance_type.model.with_causality(variables.INPUT))
    module = advanced(instance_type("plain").start(**{inputs[0].name: 100.0}), 0.01)
    for variable in inputs:
        for value in bad_values(variable):
            assert rejection(module.set, **{variable.name: value}) == sentence(variable, value)
    module.advance(0.01)
    assert module["energy_in"] > 0.0


@pytest.mark.parametrize("name", ["omega1", "load_torque", "drive_torque"])
def test_kernel_rejects_unchecked_inputs(compiled, name):
    engine = ENGINE if name == "drive_torque" else {}
    module = advanced(started(compiled, engine, omega1=100.0, load_torque=10.0), 0.01)
    good, good_value = module.save(), module[name]
    undisturbed = advanced(module, 0.01).save()
    for value in (*NO_NUMBERS, 1e13, -1e300):
        expected = sentence(BY_NAME[name], value)
        module.restore(good)
        setattr(module.inputs, name, value)
        assert rejection(module.advance, 0.01) == expected
        setattr(module.inputs, name, good_value)
        assert advanced(module, 0.01).save() == undisturbed, f"after {name} = {value}"
        unstarted = Module(compiled)
        setattr(unstarted.inputs, name, value)
        assert rejection(unstarted.start, **engine) == expected


def test_invalid_step_is_rejected_and_the_next_step_works(compiled):
    module = advanced(started(compiled, omega1=100.0), 0.01)
    for step in (0.0, -0.0, -1e-3, *NO_NUMBERS, 1.001e6, 1e300, 0.99e-30, 1e-300, 5e-324):
        expected = f"communication step must be between 1e-30 and 1e+06 s (got {step:.16g})"
        assert rejection(module.advance, step) == expected
    assert advanced(module, 1e-30, 1e-3)["energy_in"] > 0.0


@pytest.mark.parametrize("name", ["omega1", "drive_torque"])
def test_too_large_rate_of_an_input_is_rejected_with_its_unit(name):
    variable = BY_NAME[name]
    module = started("plain", ENGINE, drive=int(name == "drive_torque"), **{name: 100.0})
    for rate in (1e16, math.nan, math.inf):
        module.set_rates(**{name: rate})
        message = f"the rate of {name} must keep {name} {variable.allowed} over 0.01 s (got {rate:.16g}"
        assert rejection(module.advance, 0.01) == f"{message} {variable.unit}/s from {name} = 100)"


def test_parameters_but_the_tunable_are_fixed_once_the_module_has_started():
    module = started("plain")
    for variable in with_causality(PARAMETER):
        if not variable.is_tunable:
            message = rejection(module.set, **{variable.name: variable.start})
            reason = f"is not tunable and must be set before start() (got {variable.start})"
            assert message == f"{variable.name} {reason}"


def test_calls_before_the_start_are_rejected_without_effect():
    module = Module("plain")
    before = module.save()
    assert rejection(module.advance, 0.01) == "call start() before advance()"
    assert rejection(module.rates) == "call start() before rates()"
    for name in ("omega3", "Omega1", "", *(v.name for v in with_causality(OUTPUT, LOCAL))):
        message = rejection(module.set, **{name: 1.0})
        assert message.startswith(f"unknown parameter or input {name!r}; "), name
    # A single bad value rejects all values.
    message = rejection(module.set, omega1=3.0, modules=2, tolerance=7.0, satellites=3)
    assert message == sentence(BY_NAME["tolerance"], 7.0)
    assert module.save() == before
    assert rejection(Module("fast").start) == "kernel must be auto, compiled or plain (got 'fast')"


def test_invalid_combination_is_rejected_with_name_value_and_range(compiled):
    for values, expected in REJECTED["combinations"]:
        module = Module(compiled)
        message = rejection(module.start, **values)
        assert expected in message, values
        assert " must " in message, values
        assert not module.started, values
        good = {name: BY_NAME[name].start for name in values}
        assert module.start(**good).started, values


def test_valid_combination_runs(compiled):
    for values in REJECTED["sound"]:
        module = advanced(started(compiled, values, omega1=100.0, load_torque=1.0), 0.02, 0.02)
        assert abs(module["energy_residual"]) < 1e-5 * (1.0 + abs(module["energy_in"])), values


def test_start_and_ends_of_each_range_are_within_it():
    module = Module("plain")
    for variable in with_causality(PARAMETER, variables.INPUT):
        assert variable.kind == variables.REAL or variable.start == int(variable.start)
        ends = (False, True) if variable.kind == variables.BOOLEAN else (variable.minimum, variable.maximum)
        for value in (variable.start, *ends):
            assert variable.accepts(value), variable.name
            module.set(**{variable.name: value})
            assert module[variable.name] == value, variable.name
