"""Where a torque drives link 1: limits that are known in closed form, standstill, refusals."""

import math
import re

import numpy as np
import pytest
from geometry import direct_derivatives, ratio
from scenes import DRIVEN, FREEWHEELS, SCENES, TWO_PI, advanced, drive_angle, parameters, started

from inertia_module.contract.variables import BY_NAME
from inertia_module.memory import Module, Refused

FREE = {"housing_freewheel": False, "output_freewheel": False}
STALL = {"load_torque": 1e6}
DEAD = ["input_speed", "omega2", "omega_out", "input_angle", "mesh_torque", "energy_in", "energy_stored"]
TORQUES = ["mesh_torque", "output_torque", "housing_torque", "output_torque_mean"]


@pytest.fixture(params=SCENES)
def scene(request):
    return DRIVEN[request.param]


def inertias(module):
    """(I, B, G) at the present angle, from positions."""
    p = {name: int(module[name]) if name == "satellites" else module[name] for name in parameters()}
    return direct_derivatives(p, drive_angle(module))[:, 0]


def held_inertia(module):
    """J1 + I + 2 k B + k^2 G, what the input turns while link 2 is held."""
    i, b, g = inertias(module)
    k = ratio(module)
    return module["input_inertia"] + i + 2.0 * k * b + k * k * g


def angular_momentum(module):
    """That of all links about the central axis, the output shaft included."""
    i, b, _ = inertias(module)
    slip = ratio(module) * (module["input_speed"] - module["omega2"])
    links = (module["input_inertia"] + i) * module["input_speed"] + b * slip
    return links + module["link2_inertia"] * module["omega2"] + module["output_inertia"] * module["omega_out"]


@pytest.mark.parametrize("time", [0.01, 0.1])
@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_engine_of_immense_inertia_keeps_its_speed(scene, freewheels, time):
    values = {**scene, **FREEWHEELS[freewheels], "tolerance": 1e-10}
    heavy = advanced(started("auto", values, input_inertia=1e9), time)
    given = advanced(started("auto", values, drive=0), time)
    assert heavy["input_speed"] == pytest.approx(given["omega1"], rel=1e-8)
    for name in ("omega2", "omega_out", "drive_angle", "energy_out", *TORQUES):
        assert heavy[name] == pytest.approx(given[name], rel=1e-6, abs=1e-6), name
    assert heavy["contact_mode"] == given["contact_mode"]
    assert heavy["contact_switches"] == given["contact_switches"]


def test_speed_made_by_the_torque_asks_for_that_torque_when_given(scene):
    # the course of input_speed, in ramps of a step: the mean torque of a step is then that of the drive
    errors = []
    for step in (1e-3, 2.5e-4):
        driven = started("auto", scene, tolerance=1e-10)
        follower = started("auto", scene, drive=0, tolerance=1e-10)
        largest = 0.0
        for _ in range(round(0.05 / step)):
            before = driven["input_speed"]
            driven.advance(step)
            follower.set(omega1=before)
            follower.set_rates(omega1=(driven["input_speed"] - before) / step)
            follower.advance(step)
            for name in ("input_speed", "omega2", "omega_out"):
                largest = max(largest, abs(follower[name] - driven[name]))
        errors.append(largest)
        assert follower["energy_in"] == pytest.approx(driven["energy_in"], rel=2.0 * step / 1e-3)
    assert errors[1] < 0.1 * errors[0] < 0.1


@pytest.mark.parametrize("omega1", [100.0, -100.0])
def test_nothing_drives_and_nothing_holds_conserves_energy_and_angular_momentum(scene, omega1):
    module = started("auto", scene, FREE, tolerance=1e-12, omega1=omega1, drive_torque=0.0, load_torque=0.0)
    energy, momentum = module["energy_stored"], angular_momentum(module)
    lowest = highest = module["input_speed"]
    for _ in range(20):
        module.advance(0.013)
        assert module["energy_stored"] == pytest.approx(energy, rel=1e-11)
        assert angular_momentum(module) == pytest.approx(momentum, rel=1e-11)
        lowest, highest = min(lowest, module["input_speed"]), max(highest, module["input_speed"])
    assert highest - lowest > 1.0
    assert module["energy_in"] == module["energy_out"] == 0.0


@pytest.mark.parametrize("torque", [0.0, 3.0, -3.0])
def test_stalled_module_is_a_flywheel_of_changing_inertia(scene, torque):
    # 1/2 Phi omega1^2 gains what the torque does, whatever way link 1 turns
    module = started("auto", scene, STALL, drive_torque=torque, tolerance=1e-11)
    energy = 0.5 * held_inertia(module) * module["input_speed"] ** 2
    for _ in range(25):
        module.advance(0.0171)
        angle = module["input_angle"] + TWO_PI * module["input_turns"]
        speed = math.sqrt(2.0 * (energy + torque * angle) / held_inertia(module))
        assert module["input_speed"] == pytest.approx(speed, rel=1e-9)
        assert module["omega2"] == module["omega_out"] == 0.0
        assert drive_angle(module) == pytest.approx(ratio(module) * angle, rel=1e-12)
    assert module["contact_mode"] == 3
    assert module["contact_switches"] == 0
    assert module["output_torque_mean"] == pytest.approx(1e6, rel=1e-14)


@pytest.mark.parametrize("torque", [12.0, -12.0])
def test_torque_starts_a_stalled_module_from_standstill(scene, torque):
    module = started("auto", scene, STALL, omega1=0.0, drive_torque=torque, tolerance=1e-11)
    for step in (1e-9, 1e-4, 0.05, 0.4):
        module.advance(step)
        angle = module["input_angle"] + TWO_PI * module["input_turns"]
        assert module["input_speed"] * torque > 0.0
        energy = 0.5 * held_inertia(module) * module["input_speed"] ** 2
        assert energy == pytest.approx(torque * angle, rel=1e-9)
    assert abs(angle) > 1.0


@pytest.mark.parametrize("freewheels", FREEWHEELS)
def test_engine_is_braked_and_turned_round(scene, freewheels):
    module = started("auto", scene, FREEWHEELS[freewheels], omega1=40.0, drive_torque=-90.0, tolerance=1e-10)
    energies = module["energy_stored"]
    for _ in range(40):
        module.advance(0.01)
        energies = max(energies, module["energy_stored"], abs(module["energy_in"]))
        assert abs(module["energy_residual"]) < 1e-9 * energies
        if module["housing_freewheel"]:
            assert module["omega2"] >= 0.0
    assert module["input_speed"] < -10.0


@pytest.mark.parametrize("omega2", [0.0, 5.0])
def test_motion_without_freewheels_runs_backwards_in_time(scene, omega2):
    first = {"omega1": 80.0, "omega2_start": omega2, "omega_out_start": omega2, "drive_angle_start": 0.3}
    there = advanced(started("auto", scene, FREE, first, tolerance=1e-12), 0.2)
    back = started(
        "auto",
        scene,
        FREE,
        tolerance=1e-12,
        omega1=-there["input_speed"],
        omega2_start=-there["omega2"],
        omega_out_start=-there["omega2"],
        drive_angle_start=drive_angle(there),
    )
    advanced(back, 0.2)
    found = [-back["input_speed"], -back["omega2"], -back["omega_out"], drive_angle(back)]
    assert found == pytest.approx(list(first.values()), abs=1e-8)
    assert back["energy_in"] == pytest.approx(-there["energy_in"], rel=1e-9)


@pytest.mark.parametrize("load", [0.0, 10.0])
@pytest.mark.parametrize("step", [1e-9, 1e-3, 1.0, 1e6])
def test_standstill_without_torque_stays(kernel, scene, load, step):
    module = started(kernel, scene, omega1=0.0, drive_torque=0.0, load_torque=load)
    advanced(module, step, step)
    assert [module[name] for name in DEAD] == [0.0] * len(DEAD)
    assert module["output_torque"] == module["housing_torque"] == module["output_torque_mean"] == load
    assert module["input_torque_mean"] == 0.0
    assert module["contact_switches"] == 0


def test_negative_load_pulls_the_shaft_away_from_an_engine_at_rest(kernel, scene):
    values = {"omega1": 0.0, "drive_torque": 0.0, "load_torque": -5.0}
    module = advanced(started(kernel, scene, values), 0.3, 0.7)
    assert module["omega_out"] == pytest.approx(5.0 / module["output_inertia"], rel=1e-13)
    assert module["input_speed"] == module["omega2"] == module["output_torque"] == 0.0


def test_shaft_comes_to_rest_and_the_engine_turns_on(scene):
    module = advanced(started("auto", scene), 0.3)
    assert module["omega_out"] > 0.0
    advanced(module, 3.0, load_torque=1e3)
    assert module["omega2"] == module["omega_out"] == 0.0
    assert module["input_speed"] > 0.0
    assert module["contact_mode"] == 3


def test_drive_torque_past_the_checks_is_refused_and_the_next_good_step_works(kernel, scene):
    module = advanced(started(kernel, scene), 0.01)
    saved, good = module.save(), module["drive_torque"]
    undisturbed = advanced(module, 0.01).save()
    for torque in (math.nan, math.inf, -math.inf, 1e13, -1e300):
        module.restore(saved)
        state = bytes(module.state), bytes(module.outputs)
        module.inputs.drive_torque = torque
        expected = f"drive_torque must be {BY_NAME['drive_torque'].allowed}, is {torque:.16g}"
        with pytest.raises(Refused, match=f"^{re.escape(expected)}$"):
            module.advance(0.01)
        assert (bytes(module.state), bytes(module.outputs)) == state, torque
        assert advanced(module, 0.01, drive_torque=good).save() == undisturbed, torque


def test_rate_that_makes_an_absurd_drive_torque_is_refused(kernel, scene):
    module = advanced(started(kernel, scene), 0.01)
    state = bytes(module.state), bytes(module.outputs)
    allowed = BY_NAME["drive_torque"].allowed
    for rate in (math.nan, math.inf, 1e16):
        module.set_rates(drive_torque=rate)
        expected = f"the rate of drive_torque must keep it {allowed} over 0.01 s, is {rate:.16g} N.m/s from "
        with pytest.raises(
            Refused, match=f"^{re.escape(expected)}drive_torque = {module['drive_torque']:g}$"
        ):
            module.advance(0.01)
        assert (bytes(module.state), bytes(module.outputs)) == state, rate
    module.set_rates(drive_torque=1.0)
    assert advanced(module, 0.01)["energy_in"] != 0.0


@pytest.mark.parametrize(
    ("name", "value"), [("input_inertia", 0.0), ("input_inertia", 1e-20), ("fidelity", 0)]
)
def test_drive_by_torque_needs_an_inertia_and_equations_of_motion(kernel, scene, name, value):
    module = Module(kernel)
    with pytest.raises(
        Refused, match=rf"^with drive = 1 \(torque\) {name}.* must be .*, is {value:.16g}\b.*: "
    ):
        module.start(**{**scene, name: value})
    assert not module.started
    assert module.start(**{**scene, name: started(kernel, scene)[name]}).started


@pytest.mark.parametrize("name", ["fidelity", "input_inertia"])
def test_what_drive_by_torque_cannot_have_drive_by_speed_can(scene, name):
    assert np.isfinite(advanced(started("auto", scene, {name: 0}, drive=0), 0.01)["energy_in"])
