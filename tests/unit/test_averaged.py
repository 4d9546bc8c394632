"""Test fidelity averaged: mean motion of the output shaft with prescribed speed or torque of link 1."""

import itertools
import math

import pytest
from rejected import assert_rejected
from scenes import DRIVEN, MECHANISMS, PLANAR, SCENES, advanced, passed, started

from inertia_module.kernel.inertia import reduced_inertia
from inertia_module.model import Module

AVERAGED = {"fidelity": 1}
BY_TORQUE = {"fidelity": 1, "drive": 1}
# Link 1 has almost no inertia. The last ratio of the map exceeds 1 many times.
LIGHT = {
    "layout": 1,
    "sun_radius": 0.03,
    "satellite_radius": 0.09,
    "eccentricity": 0.03,
    "omega_out_start": 100.0,
}


def averaged(kernel, scene, **values):
    return started(kernel, scene, AVERAGED, values)


def audit(module, bound=1e-5):
    assert abs(module["energy_residual"]) <= bound * passed(module)
    assert all(math.isfinite(value) for value in module.snapshot().values())


@pytest.mark.parametrize("omega1", [100.0, -100.0])
def test_mean_speed_stays_within_half_a_percent_of_omega1_of_the_rigid_module(compiled, scene, omega1):
    heavy = {"omega1": omega1, "load_torque": 8.0, "output_inertia": 20.0}
    mean, rigid = (started(compiled, scene, heavy, fidelity=fidelity) for fidelity in (1, 2))
    for _ in range(20):
        advanced(mean, 4.0)
        advanced(rigid, 4.0)
        assert mean["omega_out"] == pytest.approx(rigid["omega_out"], abs=0.005 * abs(omega1))
    audit(mean)


def test_energy_taken_in_while_the_input_changes_is_the_mean_of_the_rigid_module(compiled, scene):
    heavy = {
        "omega1": 60.0,
        "load_torque": 4.0,
        "output_inertia": 20.0,
        "input_hold": 1,
        "input_inertia": 0.05,
    }
    mean, rigid = (started(compiled, scene, heavy, fidelity=fidelity) for fidelity in (1, 2))
    start = rigid["energy_stored"] - mean["energy_stored"]  # The rigid module starts at a single angle.
    for n in range(1, 401):
        for module in (mean, rigid):
            advanced(module, 0.05, omega1=60.0 + 0.1 * n)
    means = []
    for module in (mean, rigid):
        total = 0.0
        for _ in range(2000):
            total += advanced(module, 1.3e-3)["energy_in"]
        means.append(total / 2000)
    assert means[1] + start == pytest.approx(means[0], rel=2e-3)
    assert mean["energy_out"] == pytest.approx(rigid["energy_out"], rel=5e-3)
    audit(mean)


@pytest.mark.parametrize("load", [0.0, 3.0, -5.0, 20.0])
@pytest.mark.parametrize("ramp", [0.0, -60.0], ids=["constant", "through zero"])
def test_long_step_equals_many_short_steps(compiled, scene, load, ramp):
    long, short = (averaged(compiled, scene, load_torque=load, tolerance=1e-8) for _ in range(2))
    start = long["omega1"]
    for module, steps in ((long, 1), (short, 250)):
        for n in range(steps):
            module.set(omega1=start + 5.0 * ramp * n / steps)
            module.set_rates(omega1=ramp)
            module.advance(5.0 / steps)
        audit(module)
    assert long["omega_out"] == pytest.approx(short["omega_out"], rel=5e-4, abs=1e-6)
    assert long["energy_in"] == pytest.approx(short["energy_in"], rel=2e-3, abs=1e-4)


@pytest.fixture(params=[0, 1], ids=["held", "extrapolated"])
def locked(request, compiled):
    """Return the planar machine in lock-up, with its input held or extrapolated."""
    return advanced(averaged(compiled, SCENES["planar"], load_torque=2.0, input_hold=request.param), 60.0)


def test_shaft_at_the_speed_of_link_1_is_locked_up(locked):
    switches = locked["contact_switches"]
    advanced(locked, *[0.5] * 20)
    assert locked["omega_out"] == locked["omega1"] == locked["omega2"]
    assert locked["output_torque"] == locked["input_torque"] == 2.0
    assert locked["torque_ripple"] == locked["housing_torque"] == 0.0
    assert locked["contact_switches"] == switches
    audit(locked)


def test_locked_shaft_follows_the_input_while_the_mechanism_holds_the_torque_and_slips_beyond(locked):
    for n in range(1, 101):
        advanced(locked, 0.01, omega1=120.0 + 0.5 * n)
    assert locked["omega_out"] == locked["omega1"] or locked["input_hold"]
    assert locked["omega_out"] == pytest.approx(170.0, abs=0.6)
    assert locked["output_torque_mean"] == pytest.approx(2.0 + 0.4 * 50.0, rel=1e-6)
    audit(locked)
    advanced(locked, 0.05, omega1=170.0, load_torque=2000.0)
    assert locked["omega_out"] < 170.0
    audit(locked)


def test_oscillation_about_lock_up_is_accurate_with_few_evaluations(compiled):
    swinging = [
        averaged(
            compiled,
            SCENES["planar"],
            load_torque=2.0,
            input_hold=1,
            tolerance=tolerance,
            omega_out_start=119.0,
        )
        for tolerance in (1e-7, 1e-11)
    ]
    for n in range(60):
        for module in swinging:
            advanced(module, 0.01, omega1=119.0 + (-1.0) ** n * (0.2 + 0.01 * n))
        actual, expected = swinging
        assert actual["omega_out"] == pytest.approx(expected["omega_out"], rel=1e-8)
        assert actual["input_torque_mean"] == pytest.approx(expected["input_torque_mean"], abs=1e-5)
    assert actual["contact_switches"] >= 50
    assert actual["rhs_evaluations"] < 60 * 16
    audit(actual)


def test_shaft_overruns_the_input_and_locks_up_again(locked):
    advanced(locked, 1.0, load_torque=-4.0)
    assert locked["omega_out"] == pytest.approx(120.0 + 4.0 / 0.4, rel=1e-12)
    assert locked["output_torque"] == 0.0
    advanced(locked, 10.0, load_torque=2.0)
    assert locked["omega_out"] == 120.0
    audit(locked)


def test_load_above_the_stall_torque_keeps_the_shaft_at_rest_and_brakes_it_to_rest(compiled, scene):
    stall = averaged(compiled, scene, load_torque=0.0)["output_torque"]
    module = averaged(compiled, scene, load_torque=1.001 * stall)
    stored = module["energy_stored"]
    advanced(module, 10.0)
    assert module["omega_out"] == 0.0
    assert module["contact_mode"] == 3.0
    assert module["output_torque"] == module["housing_torque"] == 1.001 * stall
    assert module["mesh_torque"] == 0.0
    advanced(module, 1.0, load_torque=0.999 * stall)
    assert module["omega_out"] > 0.0
    advanced(module, 2.0, load_torque=scene["load_torque"])
    advanced(module, 5.0, load_torque=200.0)
    assert module["omega_out"] == 0.0
    assert module["energy_stored"] == pytest.approx(stored, rel=1e-12)
    audit(module)


def test_light_shaft_settles_at_the_load_at_low_cost(compiled, scene):
    load = 0.5 * averaged(compiled, scene)["output_torque"]
    light = averaged(compiled, scene, output_inertia=1e-9, load_torque=load)
    advanced(light, 0.01)
    assert light["output_torque"] == pytest.approx(load, rel=1e-5)
    assert light["rhs_evaluations"] < 800
    before = light["rhs_evaluations"]
    for n in range(100):
        advanced(light, 0.01, omega1=scene["omega1"] * (1.0 + 0.001 * n))
        assert light["output_torque"] == pytest.approx(load, rel=1e-4)
    assert light["rhs_evaluations"] - before < 100 * 200
    audit(light, 1e-4)


@pytest.mark.parametrize("input_hold", [0, 1])
def test_input_passes_through_zero_and_back(compiled, scene, input_hold):
    module = averaged(compiled, scene, input_hold=input_hold, output_inertia=2.0, load_torque=1.0)
    for n in range(1, 41):
        advanced(module, 0.1, omega1=scene["omega1"] * math.cos(0.1 * math.pi * n))
        audit(module)
    assert module["omega_out"] > 0.0


def test_very_long_steps_cost_little(compiled):
    module = advanced(averaged(compiled, SCENES["bevel"], load_torque=2.0), 1000.0, 1000.0)
    assert module["rhs_evaluations"] < 2000
    assert module["output_torque"] == pytest.approx(2.0, rel=1e-6)


def test_checking_parameters_builds_no_map(scene):
    module = Module("plain")
    module.check(**scene, fidelity=1)
    assert module.derived.map_ready == module.derived.forward.end == 0.0
    assert not module.started
    assert_rejected(
        r"must both be 1 \(true\) with fidelity = averaged", module.check, housing_freewheel=False
    )


def test_shaft_that_starts_at_the_end_of_the_map_stops_within_a_step(compiled):
    values = {"fidelity": 1, "a": 0.3, "b": 0.7, "omega1": 0.0, "load_torque": 1e4, "omega_out_start": 1.58}
    module = started(compiled, values)
    module.set_rates(omega1=76.0)
    module.advance(0.013)
    assert module["omega_out"] == 0.0
    assert module["rhs_evaluations"] < 1e4


@pytest.mark.parametrize("load", [0.0, 10.0])
@pytest.mark.parametrize("layout", SCENES)
def test_motion_with_a_large_input_inertia_agrees_with_constant_speed(compiled, layout, load):
    mechanism = MECHANISMS[layout]
    speed_driven = started(compiled, mechanism, fidelity=1, omega1=100.0, load_torque=load)
    driven = started(
        "auto", mechanism, BY_TORQUE, omega1=100.0, load_torque=load, input_inertia=1e5, drive_torque=0.0
    )
    for _ in range(20):
        for module in (speed_driven, driven):
            advanced(module, 0.1)
        assert driven["omega_out"] == pytest.approx(speed_driven["omega_out"], rel=2e-3, abs=0.02)


LIGHT_INPUTS = [
    {**LIGHT, "omega1": 10.0, "link2_inertia": link2, "input_inertia": inertia, "output_inertia": output}
    for link2, inertia, output in itertools.product((1e-6, 1e-3), (0.12, 0.5), (0.002, 0.02))
]
FROM_REST = [{"input_inertia": 0.1, "load_torque": load} for load in (-5.0, 0.0, 5.0)]
# Link 1 rests and the shaft turns: it brakes at once, reverses behind a light shaft, or has no torque.
AHEAD = [
    ({"load_torque": 1e4, "omega2_start": 5.0, "omega_out_start": 5.0}, 15.0),
    ({"load_torque": 10.0, "omega_out_start": 20.0, "output_inertia": 1e-5}, -15.0),
    ({"load_torque": 10.0, "omega_out_start": 0.5, "input_inertia": 1.0}, 0.0),
]
# Speeds up to a ratio of 1 and above.
UP = {"input_inertia": 0.08, "omega_out_start": 120.0, "omega1": 100.0, "load_torque": 10.0}
DOWN = {"input_inertia": 0.2, "omega_out_start": 60.0, "omega1": 60.0, "load_torque": 20.0}
ABOUT = {"output_inertia": 0.05, "omega_out_start": 60.0, "omega1": 60.0, "load_torque": 2.0}
# Parameters and start values, and the sequence of torques.
BY_AN_ENGINE = [
    *((values, [torque]) for values in LIGHT_INPUTS for torque in (-5.0, 0.5)),
    *((values, [torque]) for values in FROM_REST for torque in (-20.0, 0.0, 20.0)),
    *(({**scene, "omega1": 0.0, **ahead}, [torque]) for scene in DRIVEN.values() for ahead, torque in AHEAD),
    *((UP, [20.0]), ({**DOWN, "output_inertia": 0.1}, [0.0])),
    *(
        ({**scene, **ABOUT, "input_inertia": inertia}, [8.0, -8.0, 3.0, 0.0] * 3)
        for scene in DRIVEN.values()
        for inertia in (0.13, 0.2, 1.0)
    ),
]


@pytest.mark.parametrize("values, torques", BY_AN_ENGINE)
def test_torque_driven_module_conserves_energy(compiled, values, torques):
    module = started(compiled, BY_TORQUE, values, drive_torque=torques[0])
    largest = abs(module["input_speed"]) + 100.0 * module["output_inertia"] / module["input_inertia"]
    steps = [1e-3, 0.02] if len(torques) > 1 else [1e-7] + [1e-3] * 100 + [0.01] * 100
    for torque, step in itertools.product(torques, steps):
        advanced(module, step, drive_torque=torque)
        audit(module, 1e-4)
        assert module["input_torque"] == pytest.approx(torque, rel=1e-6, abs=1e-9)
        largest += abs(torque) * step / module["input_inertia"]
        assert abs(module["input_speed"]) < largest
    if not values.get("omega1"):
        assert module["input_speed"] * torque > 0.0 or abs(module["input_speed"]) < 1e-9
    assert module["contact_switches"] > 0 or values is not UP


@pytest.mark.parametrize("drive", [0, 1])
@pytest.mark.parametrize("omega1", [0.0, 50.0])
@pytest.mark.parametrize(
    "parameters",
    [{"imbalance_mass": 0.0}, {"a": 0.0, "satellites": 3}, {**PLANAR, "eccentricity": 0.0}],
    ids=["no mass", "no arm", "no eccentricity"],
)
def test_module_without_torque_is_simulated(compiled, parameters, omega1, drive):
    values = {"input_inertia": 0.1, "drive_torque": 1.0, "load_torque": 10.0}
    module = started(compiled, parameters, values, fidelity=1, drive=drive, omega1=omega1)
    for _ in range(10):
        advanced(module, 0.05)
        assert all(math.isfinite(value) for value in module.snapshot().values())
    assert module["omega_out"] == module["output_torque_mean"] - 10.0 == 0.0
    assert drive or omega1 or module["input_torque"] == 0.0


@pytest.mark.parametrize("drive_torque", [500.0, -500.0])
def test_light_shaft_follows_a_changing_drive_at_low_cost(compiled, drive_torque):
    values = {"omega1": 100.0, "input_inertia": 1.0, "output_inertia": 1e-6, "load_torque": 1.0}
    module = started(compiled, BY_TORQUE, values)
    advanced(module, 0.05)
    before = module["rhs_evaluations"]
    advanced(module, 0.1, drive_torque=drive_torque)
    assert abs(module["omega1"] - module["input_speed"]) > 30.0
    assert module["output_torque"] == pytest.approx(1.0, rel=1e-2)
    assert module["rhs_evaluations"] - before < 2000


@pytest.mark.parametrize("layout", SCENES)
def test_by_torque_a_link_1_lighter_than_five_imbalances_is_rejected(layout):
    mechanism = MECHANISMS[layout]
    d = Module("plain").start(**mechanism).derived
    largest = max(reduced_inertia(d, d.period * n / 20000)[0] for n in range(20000))
    module = Module("plain")
    module.check(**mechanism, **BY_TORQUE, input_inertia=5.001 * largest)
    assert_rejected("^input_inertia must be at least 5 times", module.check, input_inertia=4.999 * largest)
    module.check(drive=0)
