"""Test that steps, rates and states with unbounded work are rejected at once."""

import math
import time

import pytest
from rejected import rejection
from scenes import advanced, motions, started

from inertia_module.kernel.inputs import MIN_STEP
from inertia_module.model import INVALID_STATE, DrivenShaft, Module

AT_ONCE = 0.2  # s of CPU time; an interrupted step takes some seconds
TOO_SHORT = (5e-324, 1e-300, 0.99 * MIN_STEP)


@pytest.fixture(autouse=True)
def quick():
    """Check that all calls of a test together take little CPU time."""
    begin = time.process_time()
    yield
    assert time.process_time() - begin < 10.0 * AT_ONCE


def rejected_at_once(call, *arguments):
    """Return the message of a rejected call."""
    begin = time.process_time()
    sentence = rejection(call, *arguments)
    assert time.process_time() - begin < AT_ONCE
    return sentence


@motions(missing=())
def test_a_step_too_short_and_a_rate_too_large_are_rejected_at_once(compiled, scene):
    module = advanced(started(compiled, scene), 1e-3)
    before = module.save()
    for step in TOO_SHORT:
        expected = f"communication step must be between 1e-30 and 1e+06 s (got {step:.16g})"
        assert rejected_at_once(module.advance, step) == expected
    for name in ("omega1", "load_torque", "drive_torque"):
        for rate in (1e308, -1e200, math.inf, math.nan):
            for step in (MIN_STEP, 1e-9, 1e-3, 1e6):
                module.set_rates(**{name: rate})
                assert f"the rate of {name} must keep {name}" in rejected_at_once(module.advance, step)
                module.restore(before)
    advanced(module, MIN_STEP, 1e-3)


@motions(missing=(), drives=("speed",), added=("ideal",))
def test_linearly_extrapolated_speed_must_stay_within_its_limits(compiled, scene):
    module = advanced(started(compiled, scene, input_hold=1), 1e-3, MIN_STEP)
    module.set(omega1=module["omega1"] + 1.0)
    before = module.save()
    sentence = rejected_at_once(module.advance, 1e-3)
    assert sentence.startswith("omega1 must stay between -100000 and 100000 rad/s over")
    assert module.save() == before
    advanced(module, MIN_STEP, 1e-3)


def test_linearly_extrapolated_hub_speed_must_stay_within_its_limits(compiled):
    shaft = advanced(DrivenShaft(compiled).start(hub_speed=50.0, input_hold=1), 1e-3, 1e-9, hub_speed=50.0)
    shaft.set(hub_speed=50.1)
    assert "hub_speed must stay between" in rejected_at_once(shaft.advance, 0.1)
    advanced(shaft, 1e-9, 0.1)


@pytest.mark.parametrize("fidelity", [0, 2, 3])
def test_step_with_too_many_internal_steps_is_rejected_at_once(compiled, fidelity):
    module = started(compiled, omega1=100.0, load_torque=10.0, fidelity=fidelity, max_step=1e-300)
    assert "it requires more than 5e7 right-hand-side evaluations" in rejected_at_once(module.advance, 1e-3)


# --- states ---


NUMBERS = (math.inf, -math.inf, math.nan, 1e308, -1.0, 0.5)


@pytest.mark.parametrize("number", NUMBERS)
def test_constants_of_a_state_are_evaluated_again(compiled, number):
    for model, fields in (
        (DrivenShaft, ("fast_rate", "slow_rate", "damping_rate", "step")),
        (Module, ("satellites", "harmonic", "k")),
    ):
        good, other = (advanced(model(compiled).start(), 1e-3) for _ in range(2))
        for field in fields:
            setattr(good.derived, field, number)
        other.restore(good.save())
        assert number not in [getattr(other.derived, field) for field in fields]
        twin = advanced(model(compiled).start(), 1e-3, 0.02)
        assert advanced(other, 0.02).snapshot() == twin.snapshot()


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("field", ["tau6_signs", "mode"])
def test_state_with_an_invalid_enumeration_is_rejected(compiled, field, number):
    module = advanced(started(compiled, omega1=100.0, mesh_efficiency=0.98), 1e-3)
    setattr(module.state, field, number)
    saved = module.save()
    assert rejected_at_once(Module(compiled).restore, saved) == INVALID_STATE


def test_state_with_invalid_combinations_of_parameters_is_rejected(compiled):
    module = advanced(started(compiled, omega1=100.0), 1e-3)
    module.parameters.omega2_start = 1.0  # The value exceeds the speed of the output shaft.
    assert rejected_at_once(Module(compiled).restore, module.save()) == INVALID_STATE
