"""Method `timestepping`: fixed steps, complementarity of impulses, no search for events."""

import math

import numpy as np
import pytest
from energy_runs import COMBINATIONS, ROUNDING, largest_gain
from hypothesis import given
from hypothesis import strategies as st
from scenes import DRIVEN, ELASTIC, FREEWHEELS, SCENES, advanced, started

OUTPUTS = {"rigid": {}, "elastic": ELASTIC}


@pytest.fixture(params=SCENES)
def scene(request):
    return SCENES[request.param]


@pytest.fixture(params=OUTPUTS)
def output(request):
    return OUTPUTS[request.param]


@pytest.mark.parametrize("scenes", [SCENES, DRIVEN], ids=["by speed", "by torque"])
@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("freewheels", FREEWHEELS)
@pytest.mark.parametrize("step", [0.02, 0.05, 0.2, 0.5])
def test_many_pulses_in_a_step_make_no_energy(compiled, scenes, layout, output, freewheels, step):
    module = started(compiled, scenes[layout], output, FREEWHEELS[freewheels], method=1, load_torque=0.0)
    least = 0.0
    energy = module["energy_stored"]
    for _ in range(100):
        module.advance(step)
        energy = max(energy, abs(module["energy_in"]), module["energy_stored"])
        assert module["energy_residual"] >= least - ROUNDING * energy
        least = max(least, module["energy_residual"])


@pytest.mark.parametrize("combination", COMBINATIONS, ids=", ".join)
@pytest.mark.parametrize("seed", range(12))
def test_no_random_run_makes_energy(compiled, combination, seed):
    assert largest_gain(seed, combination, compiled) < ROUNDING


def test_mean_output_torque_is_within_two_percent_at_steps_of_a_millisecond(compiled, scene, output):
    exact = advanced(started(compiled, scene, output, tolerance=1e-8), 1.0)["output_torque_mean"]
    module = started(compiled, scene, output, method=1)
    mean = 0.0
    for _ in range(1000):
        advanced(module, 1e-3)
        mean += 1e-3 * module["output_torque_mean"]
    assert mean == pytest.approx(exact, rel=0.02)


def test_error_falls_at_first_order_or_better(compiled, scene, output):
    exact = advanced(started(compiled, scene, output, tolerance=1e-10), 0.5)["omega_out"]
    steps = [1e-3, 2.5e-4, 6.25e-5, 1.5625e-5]
    errors = []
    for step in steps:
        module = started(compiled, scene, output, method=1, max_step=step)
        errors.append(abs(advanced(module, 0.5)["omega_out"] - exact))
    slope, _ = np.polyfit(np.log(steps), np.log(errors), 1)
    assert slope > 0.85


@pytest.mark.parametrize("omega1", [1e-3, 1.0, 100.0, 1e5])
@pytest.mark.parametrize("count", [1, 7, 1000])
def test_no_step_takes_more_than_two_evaluations(kernel, scene, output, omega1, count):
    module = started(kernel, scene, output, method=1, max_step=1e-3, omega1=omega1)
    advanced(module, count * 1e-3)
    assert count <= module["rhs_evaluations"] <= 2 * count


def test_without_max_step_a_communication_step_is_one_step(kernel, scene, output):
    module = advanced(started(kernel, scene, output, method=1), 0.1)
    assert module["rhs_evaluations"] <= 2


@given(
    step=st.floats(-6.0, 3.0).map(lambda exponent: 10.0**exponent),
    speeds=st.lists(st.floats(-1e5, 1e5), min_size=3, max_size=12),
    load=st.floats(-1e3, 1e3),
    input_hold=st.sampled_from([0, 1]),
    layout=st.sampled_from(sorted(SCENES)),
    fidelity=st.sampled_from(sorted(OUTPUTS)),
)
def test_coarse_steps_never_break(step, speeds, load, input_hold, layout, fidelity):
    module = started("auto", SCENES[layout], OUTPUTS[fidelity], method=1, input_hold=input_hold)
    for speed in speeds:
        advanced(module, step, omega1=speed, load_torque=load)
        values = module.snapshot()
        assert all(math.isfinite(value) for value in values.values())
        assert values["omega2"] >= 0.0
        assert values["omega_hub"] >= values["omega2"]
        assert values["output_torque_mean"] >= 0.0


def test_a_coarse_step_gives_no_more_speed_than_the_input_has(compiled, scene):
    module = started(compiled, scene, method=1, load_torque=0.0)
    for step in (0.1, 1.0, 10.0, 1000.0):
        advanced(module, *[step] * 100)
        assert module["omega_out"] < 3.0 * scene["omega1"]


@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_every_set_of_freewheels_agrees_with_the_event_method(compiled, scene, freewheels):
    values = [
        started(compiled, scene, FREEWHEELS[freewheels], method=method, max_step=1e-5) for method in (0, 1)
    ]
    event, fixed = (advanced(module, 0.1) for module in values)
    for name in ("omega2", "omega_out", "output_torque_mean", "energy_in"):
        assert fixed[name] == pytest.approx(event[name], rel=2e-3, abs=1e-3), name


@pytest.mark.parametrize("scenes", [SCENES, DRIVEN], ids=["by speed", "by torque"])
@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("steps", [1, 100, 3000])
def test_contact_switches_are_those_of_the_event_method_at_any_communication_step(
    compiled, scenes, layout, steps
):
    events = advanced(started(compiled, scenes[layout]), 0.3)
    fixed = started(compiled, scenes[layout], method=1, max_step=1e-4)
    advanced(fixed, *[0.3 / steps] * steps)
    assert fixed["contact_switches"] == events["contact_switches"] > 20


@pytest.mark.parametrize("scenes", [SCENES, DRIVEN], ids=["by speed", "by torque"])
@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_communication_steps_make_no_contact_switches(compiled, scenes, layout, output, freewheels):
    counts = []
    for steps in (1, 16, 256):
        module = started(compiled, scenes[layout], output, FREEWHEELS[freewheels], method=1, max_step=2**-9)
        counts.append(advanced(module, *[0.5 / steps] * steps)["contact_switches"])
    assert counts[0] == counts[1] == counts[2]


def test_energy_audit_shows_the_error_and_closes_with_the_step(compiled, scene):
    residuals = []
    for step in (1e-3, 1e-4, 1e-5):
        module = advanced(started(compiled, scene, method=1, max_step=step), 0.5)
        residuals.append(abs(module["energy_residual"]) / module["energy_in"])
    assert residuals[0] < 0.02
    assert residuals[2] < 0.02 * residuals[0]


def test_a_linear_input_is_followed(compiled, scene):
    results = []
    for method in (0, 1):
        module = started(compiled, scene, method=method, input_hold=1, max_step=2e-5, input_inertia=0.1)
        for n in range(60):
            advanced(module, 5e-3, omega1=scene["omega1"] * (1.0 + 0.3 * math.sin(0.2 * n)))
        results.append([module[name] for name in ("omega_out", "energy_in", "input_torque_mean")])
    assert results[1] == pytest.approx(results[0], rel=2e-3)


def test_too_many_steps_are_given_up_before_they_begin(compiled):
    from inertia_module.memory import Refused

    module = started(compiled, SCENES["bevel"], method=1, max_step=1e-7)
    before = module.save()
    with pytest.raises(Refused, match="communication step = 100 s is abandoned"):
        module.advance(100.0)
    assert module.save() == before
