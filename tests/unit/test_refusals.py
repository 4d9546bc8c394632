"""Bad numbers never get in: each is refused by name, with its value and what is allowed."""

import math
import re
from operator import attrgetter

import pytest
from scenes import advanced, started

from inertia_module.module import Module, Refused
from inertia_module.variables import (
    BOOLEAN,
    BY_NAME,
    ENUMERATION,
    INPUT,
    INTEGER,
    LOCAL,
    OUTPUT,
    PARAMETER,
    REAL,
    with_causality,
)


def bad_values(variable):
    """What lies just outside the range of a variable, and what is no number at all."""
    yield from (math.nan, math.inf, -math.inf)
    if variable.kind in (INTEGER, ENUMERATION, BOOLEAN):
        yield from (0.5, 1.5, -1)
    if variable.kind == BOOLEAN:
        yield 2
    if variable.minimum is not None:
        yield from (variable.minimum - 1, math.nextafter(variable.minimum, -math.inf))
    if variable.maximum is not None:
        yield from (variable.maximum + 1, math.nextafter(variable.maximum, math.inf), 1e300)


def message(name, value):
    """Pattern of the whole message: name, value and what is allowed."""
    allowed = BY_NAME[name].allowed
    return "^" + re.escape(f"{name} = {value:.16g} is refused: allowed is {allowed}") + "$"


def cases(*causalities):
    return [
        pytest.param(variable.name, value, id=f"{variable.name}={value:g}")
        for variable in with_causality(*causalities)
        for value in bad_values(variable)
    ]


@pytest.mark.parametrize(("name", "value"), cases(PARAMETER))
def test_parameter_out_of_its_range_is_refused_by_name_value_and_range(name, value):
    module = Module("plain")
    before = module.save()
    with pytest.raises(Refused, match=message(name, value)):
        module.start(**{name: value})
    assert module.save() == before
    module.start()


@pytest.mark.parametrize(("name", "value"), cases(INPUT))
def test_input_out_of_its_range_is_refused_and_the_next_good_step_works(name, value):
    module = advanced(started("plain", omega1=100.0), 0.01)
    saved = module.save()
    with pytest.raises(Refused, match=message(name, value)):
        module.set(**{name: value})
    assert module.save() == saved
    module.advance(0.01)
    assert module["energy_in"] > 0.0


@pytest.mark.parametrize("name", ["omega1", "load_torque"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e13, -1e300])
def test_kernel_itself_refuses_inputs_that_come_past_the_checks(kernel, name, value):
    module = advanced(started(kernel, omega1=100.0, load_torque=10.0), 0.01)
    good = module.save()
    setattr(module.inputs, name, value)
    state, outputs = bytes(module.state), bytes(module.outputs)
    with pytest.raises(Refused, match=message(name, value)):
        module.advance(0.01)
    assert (bytes(module.state), bytes(module.outputs)) == (state, outputs)
    fresh = started(kernel)
    fresh.restore(good)
    setattr(module.inputs, name, fresh[name])
    assert advanced(module, 0.01).save() == advanced(fresh, 0.01).save()
    unstarted = Module(kernel)
    setattr(unstarted.inputs, name, value)
    with pytest.raises(Refused, match=message(name, value)):
        unstarted.start()


@pytest.mark.parametrize("step", [0.0, -0.0, -1e-3, math.nan, math.inf, -math.inf, 1.001e6, 1e300])
def test_bad_step_is_refused_and_the_next_good_one_works(kernel, step):
    module = advanced(started(kernel, omega1=100.0), 0.01)
    saved = module.save()
    with pytest.raises(Refused, match=r"^communication step = .* refused: allowed is above 0 up to 1e\+06 s"):
        module.advance(step)
    assert module.save() == saved
    assert advanced(module, 5e-324, 1e-3)["energy_in"] > 0.0


@pytest.mark.parametrize("name", ["omega3", "Omega1", "", *(v.name for v in with_causality(OUTPUT, LOCAL))])
def test_what_is_no_parameter_or_input_cannot_be_set(name):
    with pytest.raises(Refused, match=f"^{name} is refused: no such parameter or input; allowed are omega1"):
        Module("plain").set(**{name: 1.0})


def test_one_bad_value_keeps_all_others_out():
    module = Module("plain")
    before = module.save()
    with pytest.raises(Refused, match="tolerance = 7 is refused"):
        module.set(omega1=3.0, modules=2, tolerance=7.0, satellites=3)
    assert module.save() == before


@pytest.mark.parametrize("variable", with_causality(PARAMETER), ids=attrgetter("name"))
def test_parameters_are_fixed_once_the_module_has_started(variable):
    with pytest.raises(Refused, match=f"^{variable.name} = .*fixed once the module has started"):
        started("plain").set(**{variable.name: variable.start})


def test_step_before_the_start_is_refused():
    with pytest.raises(Refused, match="has not been started"):
        Module("plain").advance(0.01)


def test_unknown_kernel_is_refused():
    with pytest.raises(Refused, match="allowed is auto, compiled or plain"):
        Module("fast").start()


NO_RECTIFIER = [
    {"fidelity": 1, "housing_freewheel": False},
    {"fidelity": 1, "output_freewheel": False},
    {"fidelity": 1, "housing_freewheel": False, "output_freewheel": False},
]
SINGULAR = [
    {"link2_inertia": 0.0},
    {"link2_inertia": 0.0, "a": 0.7, "b": 0.7, "epsilon": 1.0},
    {"link2_inertia": 1e-20},
    {"link2_inertia": 0.0, "imbalance_mass": 0.0, "a": 2.0},
    {"link2_inertia": 0.0, "layout": 1, "eccentricity": 0.0},
]
STARTS = [
    {"omega2_start": -1.0, "omega_out_start": 5.0},
    {"omega2_start": 2.0, "omega_out_start": 1.0},
    {"omega2_start": 2.0, "omega_out_start": 3.0, "output_freewheel": False},
]


@pytest.mark.parametrize("values", NO_RECTIFIER + SINGULAR + STARTS, ids=str)
def test_combination_that_cannot_be_is_refused_by_name_value_and_what_is_allowed(kernel, values):
    module = Module(kernel)
    with pytest.raises(Refused, match="refused") as refused:
        module.start(**values)
    message = str(refused.value)
    assert "allowed is" in message
    name, value = next(iter(values.items()))
    assert f"{name} = {value:.16g}" in message
    assert not module.started
    good = {
        variable.name: variable.start for variable in with_causality(PARAMETER) if variable.name in values
    }
    assert module.start(**good).started


@pytest.mark.parametrize(
    "values",
    [
        {"link2_inertia": 0.0, "drive_inertia": 1e-4},
        {"link2_inertia": 0.0, "a": 0.9},
        {"link2_inertia": 0.0, "output_freewheel": False},
        {"link2_inertia": 0.0, "layout": 1},
        {"link2_inertia": 0.0, "fidelity": 0},
        {"fidelity": 0, "omega2_start": -5.0},
        {"omega2_start": -1.0, "housing_freewheel": False},
        {"omega2_start": 2.0, "omega_out_start": 2.0, "output_freewheel": False},
        {"imbalance_mass": 0.0},
    ],
    ids=str,
)
def test_combination_that_is_sound_runs(kernel, values):
    module = advanced(started(kernel, values, omega1=100.0, load_torque=1.0), 0.02, 0.02)
    assert abs(module["energy_residual"]) < 1e-5 * (1.0 + abs(module["energy_in"]))


@pytest.mark.parametrize("variable", with_causality(PARAMETER), ids=attrgetter("name"))
@pytest.mark.parametrize("end", ["minimum", "maximum"])
def test_ends_of_each_range_are_within_it(variable, end):
    value = getattr(variable, end)
    if variable.kind == BOOLEAN:
        value = end == "maximum"
    module = Module("plain")
    module.set(**{variable.name: value})
    assert module[variable.name] == value


def test_defaults_are_within_their_ranges():
    for variable in with_causality(PARAMETER, INPUT):
        assert variable.accepts(variable.start)
        assert variable.kind == REAL or variable.start == int(variable.start)


@pytest.mark.parametrize("inputs", [{"omega1": 1e5}, {"omega1": -1e6, "load_torque": 1e12}])
def test_work_without_end_is_an_error_and_no_hang(compiled, inputs):
    module = started(compiled, inputs)
    with pytest.raises(Refused, match="given up"):
        advanced(module, 1e4, **inputs)
    assert advanced(module, 1e-6, omega1=100.0, load_torque=10.0)["rhs_evaluations"] < 1000
