"""Test derivatives of inputs and outputs of the native FMUs with finite differences."""

import math
from itertools import product

import pytest
from scenes import ELASTIC, TUNED

from inertia_module.model import Module

from .conftest import BY_TORQUE, R1
from .conftest import LEVELS as ALL_LEVELS

FLAVOURS = ("InertiaModule", "InertiaModule3")
START = {**R1, "drive_torque": 20.0}
LEVELS = {
    **{name: settings for name, settings in ALL_LEVELS.items() if "losses" not in name},
    "stiff": {**ELASTIC, "shaft_stiffness": 1e8},
    "stiff, by torque": {**ELASTIC, "shaft_stiffness": 1e8, **BY_TORQUE},
}
for name in ("averaged", "averaged, by torque"):
    LEVELS[name] = LEVELS[name] | {"omega_out_start": 5.0}
KNOWNS = ("omega1", "load_torque", "drive_torque")
UNKNOWNS = ("omega2", "omega_out", "input_speed", "input_torque_mean", "output_torque_mean")


@pytest.fixture(params=LEVELS)
def level(request):
    return LEVELS[request.param]


# Levels without a stiff shaft, which oscillates.
@pytest.fixture(params=[name for name in LEVELS if not name.startswith("stiff")])
def followed(request):
    return LEVELS[request.param]


def outputs_after(instances, settings, h, inputs, names, tolerance=1e-12):
    """Return the outputs after some steps; the last step sets inputs or tunable parameters."""
    instance = instances().start(tolerance=tolerance, **START | settings)
    for _ in range(4):
        instance.step(0.01)
    instance.set(**inputs)
    instance.step(h)
    return [instance.get(name) for name in names]


# FMI 3.0 uses the same core; the tests below cover its own calls.
@pytest.mark.fmi2
def test_directional_derivative_is_the_derivative_of_the_last_step(instances, level):
    instance, exact = (instances().start(tolerance=n, **START, **level) for n in (1e-6, 1e-12))
    for each in (instance, exact):
        for _ in range(4):
            each.step(0.01)
    states = [each.fmu.getFMUstate() for each in (instance, exact)]
    for h, variable in product((1e-3, 0.05), KNOWNS):
        delta, ends = 1e-4 * START[variable], []
        for change in (delta, -delta):
            exact.fmu.setFMUstate(states[1])
            exact.set(**{variable: START[variable] + change})
            exact.try_step(h)
            ends.append([exact.get(name) for name in UNKNOWNS])
        instance.fmu.setFMUstate(states[0])
        instance.try_step(h)
        derivatives = instance.directional(UNKNOWNS, (variable,), (1.0,))
        for name, derivative, high, low in zip(UNKNOWNS, derivatives, *ends, strict=True):
            expected = (high - low) / (2.0 * delta)
            stiff = level.get("shaft_stiffness") == 1e8
            # A stiff shaft oscillates: a tenfold delta changes the difference of omega2 by omega2 / omega1.
            scale = max(abs(expected), (0.2 if stiff else 1e-3) * abs(high) / START[variable])
            # The reference starts its last step from a state of another tolerance. The phase of a stiff shaft
            # therefore differs.
            stiff_share = 5e-2 if variable == "drive_torque" else 1e-2
            share = stiff_share if stiff else 2e-3
            assert derivative == pytest.approx(expected, abs=share * scale + 1e-9), (name, variable, h)


def test_directional_derivative_uses_the_tuned_value(instances):
    tuned = {"link2_friction": 0.05, "output_friction": 0.2}
    before, after = (instances().start(tolerance=1e-6, **START) for _ in range(2))
    for instance in (before, after):
        for _ in range(4):
            instance.step(0.01)
    before.set(**tuned)
    for instance in (before, after):
        instance.step(0.02)
    after.set(**tuned)
    derivatives = [instance.directional(UNKNOWNS, ("omega1",), (1.0,)) for instance in (before, after)]
    assert derivatives[0] == pytest.approx(derivatives[1], rel=1e-4)


# Values of tunable parameters. A loss that is 0 can only increase.
TUNABLE = {
    "rigid": dict.fromkeys(("windage", "housing_drag"), 0.0) | {"journal_friction": 1e-3},
    "elastic with losses, by torque": TUNED | {"windage": 1e-4, "freewheel_damping": 1.0},
    # Each map with losses takes seconds.
    "averaged": {"link2_friction": 0.01, "output_friction": 0.01},
    "kinematic": {"kinematic_ratio": 0.3},
}


@pytest.mark.parametrize("level", TUNABLE)
def test_directional_derivative_by_a_tunable_parameter_equals_a_difference_of_runs(instances, level):
    settings = ALL_LEVELS[level] | TUNABLE[level]
    instance, alone = (instances().start(tolerance=1e-6, **START | settings) for _ in range(2))
    for parameter in TUNABLE[level]:  # At the start.
        instance.directional(UNKNOWNS, (parameter,), (1.0,))
    for h in (0.01, 0.01, 0.01, 0.01, 0.02):
        for each in (instance, alone):
            each.step(h)
        assert instance.all_values() == alone.all_values()
    for parameter, value in TUNABLE[level].items():
        derivatives = instance.directional(UNKNOWNS, (parameter,), (1.0,))
        delta = 1e-3 * value or 1e-6
        ends = value + delta, value - delta * (value > 0.0)
        above, below = (outputs_after(instances, settings, 0.02, {parameter: end}, UNKNOWNS) for end in ends)
        for name, derivative, high, low in zip(UNKNOWNS, derivatives, above, below, strict=True):
            expected = (high - low) / (ends[0] - ends[1])
            assert derivative == pytest.approx(expected, rel=2e-3, abs=1e-6 + 1e-9 * abs(high) / delta), name
    for each in (instance, alone):
        each.step(0.01)
    assert instance.all_values() == alone.all_values()


def test_directional_derivatives_are_linear_in_the_direction(instance):
    instance.start(tolerance=1e-6, **START)
    instance.step(0.02)
    by_speed = instance.directional(UNKNOWNS, ("omega1",), (1.0,))
    by_load = instance.directional(UNKNOWNS, ("load_torque",), (1.0,))
    together = instance.directional(UNKNOWNS, ("omega1", "load_torque"), (3.0, -2.0))
    for first, second, total in zip(by_speed, by_load, together, strict=True):
        assert total == pytest.approx(
            3.0 * first - 2.0 * second, rel=1e-4, abs=1e-6 * (abs(first) + abs(second))
        )


def test_derivatives_do_not_change_the_run(instances, level):
    watched, alone = (instances().start(tolerance=1e-6, **START, **level) for _ in range(2))
    for n in range(10):
        for each in (watched, alone):
            each.set(omega1=100.0 + n, drive_torque=20.0 + n)
            each.step(0.013)
        watched.directional(UNKNOWNS, KNOWNS, (1.0, 1.0, 1.0))
        watched.rates("omega2", "input_torque")
        assert watched.all_values() == alone.all_values()


def check_rates(plant, rates, h, rel):
    """Check that rates of outputs agree with differences over two short steps."""
    rows = []
    for _ in range(3):
        rows.append(plant.snapshot())
        plant.advance(h)
    for name, rate in rates.items():
        first, second, third = (row[name] for row in rows)
        expected = (4.0 * second - 3.0 * first - third) / (2.0 * h)
        assert rate == pytest.approx(expected, rel=rel, abs=1e-9 * (1.0 + abs(first)) / h), name


# Speed of link 1, torque on it and load. Under a pulling load link 1 is at rest or already turns.
STANDING = {
    f"link 1 {state}, load {load:g}": {"omega1": speed, "drive_torque": torque, "load_torque": load}
    for state, speed, torque in (("turns", 100.0, 20.0), ("starts", 0.0, 20.0), ("rests", 0.0, 0.0))
    for load in (-5.0, 0.0, 5.0)
    if (state, load) != ("starts", -5.0)
}


@pytest.mark.parametrize("state", [*STANDING, "in a pulse"])
def test_rates_of_outputs_agree_with_the_next_step(compiled, followed, state, instances_of):
    """Test a shaft at rest, and the middle of a pulse, far from a switch."""
    no_rate = ("_mean", "_peak", "output_angle", "output_turns")
    for angle in (0.0, 3.15):
        settings = followed | STANDING.get(state, START)
        settings |= {"drive_angle_start": angle, "omega_out_start": 0.0}
        module = Module(compiled).start(tolerance=1e-10, **settings)
        if state not in STANDING:
            module.advance(0.005)
        rates = module.rates()
        speeds = {"input_flange_angle": module["input_speed"], "output_turns": 0.0}
        speeds |= dict.fromkeys(("output_flange_angle", "output_angle"), module["omega_out"])
        assert rates.items() >= speeds.items()
        check_rates(module, {n: rate for n, rate in rates.items() if not n.endswith(no_rate)}, 1e-6, 1e-4)
    if followed["fidelity"] != 1 or state not in STANDING:  # The map is slow.
        for identifier in FLAVOURS:
            instance = instances_of(identifier).start(tolerance=1e-10, **settings)
            if state not in STANDING:
                instance.step(0.005)
            assert dict(zip(rates, instance.rates(*rates), strict=True)) == rates


@pytest.mark.parametrize("load", [0.05, 0.5, 5.0])
def test_rate_of_the_output_speed_in_lock_up_follows_from_the_load(instances, followed, load):
    if followed["fidelity"] < 2:
        pytest.skip("only pulses lock up")
    # The output freewheel is at the limit of slip: even the shortest trial step may contain a switch.
    locked = {"omega2_start": 100.0, "omega_out_start": 100.0, "load_torque": load, "drive_torque": 0.0}
    instance = instances().start(tolerance=1e-10, **START | followed | locked)
    carried = 0.5 if followed["fidelity"] == 3 else 0.505
    assert instance.rates("omega_out")[0] == pytest.approx(-load / carried, rel=0.05)


@pytest.mark.fmi2
@pytest.mark.parametrize("hold", [0, 1])
def test_rate_of_an_input_applies_to_a_single_step(instances, hold):
    once, again = (instances().start(**START, input_hold=hold) for _ in range(2))
    for each in (once, again):
        each.set_rates(omega1=50.0)
        each.step(0.01)
        each.set(omega1=100.5)
    again.set_rates(omega1=0.0)
    for each in (once, again):
        each.step(0.01)
    is_constant = once.all_values() == again.all_values()
    assert is_constant == (hold == 0)


@pytest.mark.fmi2
@pytest.mark.parametrize("name", ["omega1", "drive_torque"])
@pytest.mark.parametrize("rate", [math.nan, math.inf, 1e15])
def test_absurd_rates_are_discarded(instance, name, rate):
    instance.start(**START, **BY_TORQUE)
    before = instance.all_values()
    instance.set_rates(**{name: rate})
    assert instance.is_discarded(0.01)
    assert instance.all_values() == before
    instance.set_rates(**{name: 0.0})
    assert not instance.is_discarded(0.01)


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda i: i.directional(("omega1",), ("omega1",), (1.0,)), "must belong to an output (got "),
        (
            lambda i: i.directional(("omega2",), ("omega2",), (1.0,)),
            "to an input or a tunable parameter (got ",
        ),
        # This known can change only at the start.
        (lambda i: i.directional(("omega2",), ("a",), (1.0,)), "to an input or a tunable parameter (got "),
        (
            lambda i: i.directional(("omega2",), ("omega1",), (math.nan,)),
            "a number of a direction must be 0 or between 1e-100 and 1e100 in magnitude (got nan",
        ),
        (
            lambda i: i.directional(("omega2",), ("omega1",), (1e308,)),
            "a number of a direction must be 0 or between 1e-100 and 1e100 in magnitude (got 1e+308",
        ),
        (lambda i: i.rates("omega2", order=2), "order of a derivative of omega2 must be 1 (got 2"),
        (lambda i: i.rates("energy_in"), "must belong to an output (got "),
        (lambda i: i.set_rates(omega2=1.0), "must belong to an input (got "),
        (lambda i: i.set_rates(order=2, omega1=1.0), "order of a derivative of omega1 must be 1 (got 2"),
    ],
)
def test_missing_derivatives_are_rejected(instance, call, words):
    instance.start(**START)
    instance.step(0.01)
    assert words in instance.rejection(lambda: call(instance))
