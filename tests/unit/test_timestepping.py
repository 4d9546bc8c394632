"""Method `timestepping`: fixed steps, complementarity of impulses, no search for events."""

import itertools
import math
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import (
    ACCOUNTS,
    ALL_LOSSES,
    DRIVEN,
    DRIVES,
    ELASTIC,
    FREEWHEELS,
    LOSSES,
    MEANS,
    SCENES,
    WIND_UP,
    advanced,
    motions,
    passed,
    started,
)

from inertia_module.memory import Refused

OUTPUTS = {"rigid": {}, "elastic": ELASTIC}
SPEEDS = ("input_speed", "omega2", "omega_hub", "omega_out")
# gravity acts with one module only, and shows with one heavy imbalance
HEAVY = {"modules": 1, "satellites": 1, "imbalance_mass": 3.0}
FIXED_STEPS = ("timestepping", "elastic-timestepping")


# what rounding may make in a run, of the largest energy there was
ROUNDING = 1e-11
ENERGIES = ("energy_stored", "energy_in", "energy_out", "energy_lost")
COMBINATIONS = list(itertools.product(FREEWHEELS, DRIVES, OUTPUTS))


def exponential(dice, low, high):
    """A number between 10**low and 10**high."""
    return 10.0 ** dice.uniform(low, high)


def mechanism(dice):
    """Parameters of either layout, of any proportions that can be stepped."""
    return {
        "layout": dice.choice([0, 0, 1]),
        "satellites": dice.randint(1, 4),
        "modules": dice.randint(1, 3),
        "z17": dice.randint(15, 60),
        "shaft_angle": dice.uniform(0.5, 2.5),
        **{name: dice.choice([1.0, dice.uniform(0.2, 2.0)]) for name in "abc"},
        "epsilon": dice.uniform(-7.0, 7.0),
        "gamma": dice.uniform(-7.0, 7.0),
        "eccentricity": dice.uniform(0.001, 0.05),
        "imbalance_mass": exponential(dice, -1.0, 1.0),
        "drive_inertia": dice.choice([0.0, exponential(dice, -5.0, -2.0)]),
        "input_inertia": exponential(dice, -3.0, 1.0),
        "link2_inertia": exponential(dice, -3.0, -1.0),
        "output_inertia": exponential(dice, -3.0, 1.0),
        "driven_inertia": exponential(dice, -2.0, 1.0),
        "shaft_stiffness": exponential(dice, 1.0, 6.0),
        "shaft_damping": dice.choice([0.0, exponential(dice, -3.0, 1.0)]),
        "driven_friction": dice.choice([0.0, exponential(dice, -3.0, 0.0)]),
        "balancer": dice.choice([0.0, 0.0, dice.uniform(-0.5, 0.5)]),
        "drive_angle_start": dice.uniform(-7.0, 7.0),
    }


def losses(dice):
    """Losses by load and drag of any size, some of them absent, and gravity."""
    drawn = {
        "mesh_efficiency": dice.uniform(0.5, 1.0),
        "satellite_mesh_efficiency": dice.uniform(0.9, 1.0),
        "journal_friction": exponential(dice, -4.0, -1.0),
        "housing_drag": exponential(dice, -3.0, 1.0),
        "housing_drag_viscous": exponential(dice, -4.0, 0.0),
        "output_drag": exponential(dice, -3.0, 1.0),
        "output_drag_viscous": exponential(dice, -4.0, 0.0),
        "drive_friction": exponential(dice, -3.0, 0.0),
        "link2_friction": exponential(dice, -3.0, 0.0),
        "gravity": dice.choice([9.81, 1000.0]),
    }
    return {name: value for name, value in drawn.items() if dice.random() < 0.6}


def largest_gain(kernel, seed, combination, lossy):
    """Largest energy that a step, or all of the run, made out of nothing, of the largest energy there was.

    Each step lets the drive turn by 0.03 to 30 rad at the first speed of link 1; speed, torque, load change.
    """
    freewheels, drive, output = combination
    dice = random.Random(seed)
    speed = exponential(dice, 0.0, 3.0)
    values = mechanism(dice) | {
        "method": 1,
        "fidelity": 3 if output == "elastic" else 2,
        "drive": float(drive == "torque"),
    }
    values |= {"input_hold": dice.choice([0, 1]), "omega1": dice.choice([-speed, speed])}
    if lossy:
        values |= losses(dice)
    module = started(kernel, values, FREEWHEELS[freewheels])
    step = exponential(dice, -1.5, 1.5) / (float(module.derived.k) * speed)
    # what changes the speed of link 1, or of the output shaft, by up to three times that in a step
    torque = exponential(dice, -3.0, 0.5) * values["input_inertia"] * speed / step
    load = exponential(dice, -3.0, 0.5) * values["output_inertia"] * speed / step
    energy = module["energy_stored"]
    last = gain = 0.0
    for _ in range(20):
        module.set(
            omega1=dice.choice([module["omega1"], dice.uniform(-speed, speed)]),
            drive_torque=dice.uniform(-torque, torque),
            load_torque=dice.choice([0.0, dice.uniform(-load, load)]),
        )
        for _ in range(20):
            module.advance(step)
            energy = max(energy, *(abs(module[name]) for name in ENERGIES))
            residual = module["energy_residual"]
            gain = max(gain, last - residual, -residual)
            last = residual
    assert all(math.isfinite(value) for value in module.snapshot().values())
    return gain / energy


@pytest.fixture(params=SCENES)
def scene(request):
    return SCENES[request.param]


@pytest.fixture(params=OUTPUTS)
def output(request):
    return OUTPUTS[request.param]


@motions(levels=FIXED_STEPS)
def test_fixed_steps_come_to_what_events_say(compiled, scene):
    exact = advanced(started(compiled, scene, method=0, max_step=0.0, tolerance=1e-9), 0.05)
    energy, errors = passed(exact), []
    for step in (8e-4, 5e-5):
        module = advanced(started(compiled, scene, max_step=step), 0.05)
        errors.append(max(abs(module[name] - exact[name]) for name in SPEEDS) / exact["input_speed"])
        assert module["energy_residual"] > -1e-12 * energy
        for name in ACCOUNTS:
            assert abs(module[name] - exact[name]) < 1e-3 * energy, name
            assert (module[name] == 0.0) == (exact[name] == 0.0), name
        assert module["energy_lost_viscous"] == pytest.approx(exact["energy_lost_viscous"], rel=1e-3)
    for name in (*MEANS[:4], "energy_in"):
        assert module[name] == pytest.approx(exact[name], rel=1e-4, abs=1e-2), name
    # of second order, down to what the position of a switch within its step leaves
    assert errors[1] < max(errors[0] / 50.0, 3e-6)
    assert errors[1] < 2e-5


@motions(levels=FIXED_STEPS, added=("ideal",))
def test_many_pulses_in_a_step_make_no_energy(compiled, scene):
    for step in (0.02, 0.05, 0.2, 0.5):
        module = started(compiled, scene, max_step=0.0, load_torque=0.0)
        least, energy = 0.0, module["energy_stored"]
        for _ in range(100):
            module.advance(step)
            energy = max(energy, abs(module["energy_in"]), module["energy_stored"])
            assert module["energy_residual"] >= least - ROUNDING * energy
            least = max(least, module["energy_residual"])


@pytest.mark.parametrize("combination", COMBINATIONS, ids=lambda names: "-".join(names).replace(" ", "-"))
def test_no_random_run_makes_energy(compiled, combination):
    for seed in range(12):
        assert largest_gain(compiled, seed, combination, lossy=False) < ROUNDING, seed
        assert seed % 2 or largest_gain(compiled, seed, combination, lossy=True) < ROUNDING, seed


@pytest.mark.parametrize("step", [1e-4, 1e-2, 1.0])
@pytest.mark.parametrize("size", [1e-12, 1.0, 1e3])
@pytest.mark.parametrize("drive", DRIVES)
def test_no_friction_makes_energy_in_steps_of_any_length(compiled, drive, output, size, step):
    for name in LOSSES["viscous"]:
        one = started(compiled, DRIVES[drive]["bevel"], output, {name: size}, method=1)
        for load in (10.0, -10.0, 3.0):
            advanced(one, step, load_torque=load)
            assert one["energy_residual"] > -2.5e-11 * passed(one)
            assert one["energy_lost_viscous"] >= 0.0


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


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("losses", [*LOSSES, "all"])
def test_error_of_fixed_steps_falls_with_the_square_where_nothing_switches(compiled, drive, layout, losses):
    values = ALL_LOSSES if losses == "all" else LOSSES[losses]
    # link 2 alone, far from both freewheels
    apart = DRIVES[drive][layout] | HEAVY | values | {"omega2_start": 60.0, "omega_out_start": 1000.0}
    exact = advanced(started(compiled, apart, tolerance=1e-12), 0.01)["omega2"]
    coarse, fine = (
        abs(advanced(started(compiled, apart, method=1, max_step=step), 0.01)["omega2"] - exact)
        for step in (2e-4, 5e-5)
    )
    assert fine == pytest.approx(coarse / 16.0, rel=0.3)


def test_a_step_takes_at_most_two_evaluations(compiled, scene, output):
    # without max_step a communication step is one step
    assert advanced(started(compiled, scene, output, method=1), 0.1)["rhs_evaluations"] <= 2
    for omega1 in (1e-3, 1.0, 100.0, 1e5):
        for count in (1, 7, 1000):
            module = started(compiled, scene, output, method=1, max_step=1e-3, omega1=omega1)
            advanced(module, count * 1e-3)
            assert count <= module["rhs_evaluations"] <= 2 * count


@given(
    step=st.floats(-6.0, 3.0).map(lambda exponent: 10.0**exponent),
    speeds=st.lists(st.floats(-1e5, 1e5), min_size=3, max_size=12),
    load=st.floats(-1e3, 1e3),
    input_hold=st.sampled_from([0, 1]),
    layout=st.sampled_from(sorted(SCENES)),
    fidelity=st.sampled_from(sorted(OUTPUTS)),
)
def test_coarse_steps_never_break(compiled, step, speeds, load, input_hold, layout, fidelity):
    module = started(compiled, SCENES[layout], OUTPUTS[fidelity], method=1, input_hold=input_hold)
    for speed in speeds:
        advanced(module, step, omega1=speed, load_torque=load)
        values = module.snapshot()
        assert all(math.isfinite(value) for value in values.values())
        assert values["omega_hub"] >= values["omega2"] >= 0.0
        assert values["output_torque_mean"] >= 0.0


def test_a_coarse_step_gives_no_more_speed_than_the_input_has(compiled, scene):
    module = started(compiled, scene, method=1, load_torque=0.0)
    for step in (0.1, 1.0, 10.0, 1000.0):
        advanced(module, *[step] * 100)
        assert module["omega_out"] < 3.0 * scene["omega1"]


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("layout", SCENES)
def test_contact_switches_are_those_of_the_event_method_at_any_communication_step(compiled, drive, layout):
    values = DRIVES[drive][layout]
    events = advanced(started(compiled, values), 0.3)
    for steps in (1, 100, 3000):
        fixed = started(compiled, values, method=1, max_step=1e-4)
        advanced(fixed, *[0.3 / steps] * steps)
        assert fixed["contact_switches"] == events["contact_switches"] > 20


@motions(levels=FIXED_STEPS, added=("ideal",))
def test_communication_steps_make_no_contact_switches(compiled, scene):
    modules = [advanced(started(compiled, scene, max_step=2**-9), *[0.5 / n] * n) for n in (1, 16, 256)]
    assert len({module["contact_switches"] for module in modules}) == 1


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


def test_drag_of_the_housing_freewheel_stops_link_2_and_holds_it(compiled):
    """Without imbalance link 2 coasts down under constant drag; a push below the drag does not start it."""
    values = {"imbalance_mass": 0.0, "omega_out_start": 10.0, "link2_inertia": 0.5, "omega2_start": 1.0}
    values |= {"housing_drag": 2.0, "output_drag": 1.0}
    module = advanced(started(compiled, values, method=1, max_step=1e-3), 0.2)
    assert module["omega2"] == pytest.approx(1.0 - 0.2 * (2.0 - 1.0) / 0.5, rel=1e-9)
    advanced(module, 0.5)
    assert module["omega2"] == 0.0
    assert module["housing_torque_mean"] < 0.0


def test_pendulum_falls_from_rest_as_by_events(compiled):
    values = {**DRIVEN["bevel"], **HEAVY, "gravity": 9.81, "drive_angle_start": 2.5, "input_inertia": 0.02}
    values |= {"omega1": 0.0, "load_torque": 0.0, "drive_torque": 0.0}
    exact = advanced(started(compiled, values, tolerance=1e-9), 1.0)
    assert abs(exact["input_speed"]) > 0.1
    errors = []
    for step in (2e-3, 2.5e-4):
        module = advanced(started(compiled, values, method=1, max_step=step), 1.0)
        errors.append(abs(module["input_speed"] - exact["input_speed"]))
        assert module["energy_residual"] > -1e-12 * passed(module)
    assert errors[1] < min(0.25 * errors[0], 1e-4)


def test_what_fixed_steps_cannot_do_is_refused(compiled):
    sentence = "with method = 1 .timestepping. housing_stiffness and freewheel_stiffness must be 0"
    for name in ("housing_stiffness", "freewheel_stiffness"):
        with pytest.raises(Refused, match=sentence):
            started(compiled, fidelity=3, method=1, **{name: WIND_UP[name]})
    module = started(compiled, SCENES["bevel"], method=1, max_step=1e-7)
    before = module.save()
    with pytest.raises(Refused, match="communication step = 100 s is abandoned"):
        module.advance(100.0)
    assert module.save() == before
