"""Fidelity averaged where the torque of link 1 is given: link 1 swings within a pulse, light or heavy."""

import itertools
import math

import numpy as np
import pytest
from scenes import DRIVEN, PLANAR, SCENES, advanced, started

from inertia_module.loops import interface_inertia

AVERAGED = {"fidelity": 1, "drive": 1}
HEAVY = {"drive": 1, "omega1": 100.0, "drive_torque": 4.0, "load_torque": 5.0, "output_inertia": 5.0}
# where link 1 has next to no inertia of its own and the last ratio of the map is many times 1
LIGHT = {
    "layout": 1,
    "sun_radius": 0.03,
    "satellite_radius": 0.09,
    "eccentricity": 0.03,
    "omega_out_start": 100.0,
}


def mechanism_of(layout):
    return {name: value for name, value in SCENES[layout].items() if name not in ("omega1", "load_torque")}


def audit(module, bound):
    energies = abs(module["energy_in"]) + abs(module["energy_out"]) + module["energy_stored"]
    assert abs(module["energy_residual"]) <= bound * energies
    assert all(math.isfinite(value) for value in module.snapshot().values())


def mean_speeds(values):
    module = started("auto", values)
    found = []
    for n in range(200):
        advanced(module, 0.01)
        if n >= 100:
            found.append((module["input_speed"], module["omega_out"]))
    return np.mean(found, axis=0)


@pytest.mark.parametrize("layout", SCENES)
@pytest.mark.parametrize("share", [0.1, 1.0, 10.0])
def test_mean_speeds_are_those_of_the_pulses_however_light_link_1_is(layout, share):
    mechanism = mechanism_of(layout) | HEAVY
    inertia = share * interface_inertia(mechanism_of(layout)).greatest
    values = {**mechanism, "input_inertia": inertia}
    averaged = mean_speeds({**values, "fidelity": 1})
    # the energy that the rigid module starts with depends on where its drive starts
    angles = 2.0 * math.pi * np.arange(12) / 12.0
    rigid = np.mean([mean_speeds({**values, "drive_angle_start": angle}) for angle in angles], axis=0)
    assert averaged == pytest.approx(rigid, rel=0.02)


@pytest.mark.parametrize("load", [0.0, 10.0])
@pytest.mark.parametrize("layout", SCENES)
def test_behind_an_engine_of_great_inertia_the_motion_is_that_at_its_speed(layout, load):
    mechanism = mechanism_of(layout)
    given = started("auto", mechanism, fidelity=1, omega1=100.0, load_torque=load)
    driven = started(
        "auto", mechanism, AVERAGED, omega1=100.0, load_torque=load, input_inertia=1e5, drive_torque=0.0
    )
    for _ in range(20):
        for module in (given, driven):
            advanced(module, 0.1)
        assert driven["omega_out"] == pytest.approx(given["omega_out"], rel=2e-3, abs=0.02)


@pytest.mark.parametrize("output", [0.002, 0.02])
@pytest.mark.parametrize("torque", [-5.0, 0.5])
@pytest.mark.parametrize("inertia", [1e-3, 0.01, 0.1])
@pytest.mark.parametrize("link2", [1e-6, 1e-3])
def test_no_energy_comes_from_nowhere_behind_a_light_link_1(link2, inertia, torque, output):
    light = {"input_inertia": inertia, "link2_inertia": link2, "output_inertia": output}
    module = started("auto", AVERAGED, LIGHT, light, omega1=10.0, load_torque=0.0, drive_torque=torque)
    for _ in range(200):
        advanced(module, 1e-3)
        audit(module, 1e-4)
    assert abs(module["input_speed"]) < 10.0 + abs(torque) * 0.2 / inertia + 100.0 * output / inertia


COMING_DOWN = {"input_inertia": 0.2, "output_inertia": 0.1, "omega_out_start": 60.0, "omega1": 60.0}
COMING_UP = {"input_inertia": 0.02, "omega_out_start": 120.0, "omega1": 100.0, "drive_torque": 20.0}


@pytest.mark.parametrize(
    "values",
    [{**COMING_DOWN, "load_torque": 20.0, "drive_torque": 0.0}, {**COMING_UP, "load_torque": 10.0}],
    ids=["down", "up"],
)
def test_shaft_passes_ratio_1(values):
    module = started("auto", AVERAGED, values)
    for _ in range(100):
        advanced(module, 0.01)
        audit(module, 1e-4)
    assert module["contact_switches"] >= 1


@pytest.mark.parametrize("layout", DRIVEN)
@pytest.mark.parametrize("inertia", [1e-3, 0.01, 0.2])
def test_torque_that_alternates_about_ratio_1_is_followed(layout, inertia):
    values = {"input_inertia": inertia, "omega1": 60.0, "omega_out_start": 60.0, "output_inertia": 0.05}
    module = started("auto", DRIVEN[layout], AVERAGED, values, load_torque=2.0)
    for torque, step in itertools.product([8.0, -8.0, 3.0, 0.0] * 3, [1e-3, 0.02]):
        advanced(module, step, drive_torque=torque)
        audit(module, 1e-4)


@pytest.mark.parametrize("drive", [0, 1])
@pytest.mark.parametrize("omega1", [0.0, 50.0])
@pytest.mark.parametrize(
    "nothing",
    [{"imbalance_mass": 0.0}, {"a": 0.0, "satellites": 3}, {**PLANAR, "eccentricity": 0.0}],
    ids=["no mass", "no arm", "no eccentricity"],
)
def test_module_that_passes_no_torque_is_followed(nothing, omega1, drive):
    values = {"input_inertia": 0.1, "drive_torque": 1.0, "load_torque": 10.0}
    module = started("auto", nothing, values, fidelity=1, drive=drive, omega1=omega1)
    for _ in range(10):
        advanced(module, 0.05)
        assert all(math.isfinite(value) for value in module.snapshot().values())
    assert module["omega_out"] == module["output_torque_mean"] - 10.0 == 0.0


@pytest.mark.parametrize("load", [-5.0, 0.0, 5.0])
@pytest.mark.parametrize("torque", [-20.0, 0.0, 20.0])
def test_start_from_rest(load, torque):
    module = started("auto", AVERAGED, omega1=0.0, input_inertia=0.1, load_torque=load, drive_torque=torque)
    for _ in range(20):
        advanced(module, 0.01)
        audit(module, 1e-4)
    assert module["input_speed"] * torque >= 0.0
    assert (module["input_speed"] != 0.0) == (torque != 0.0)


@pytest.mark.parametrize("drive_torque", [500.0, -500.0])
def test_light_shaft_keeps_up_with_a_drive_that_changes_at_little_cost(drive_torque):
    values = {"omega1": 100.0, "input_inertia": 1.0, "output_inertia": 1e-6, "load_torque": 1.0}
    module = started("auto", AVERAGED, values)
    advanced(module, 0.05)
    before = module["rhs_evaluations"]
    advanced(module, 0.1, drive_torque=drive_torque)
    assert abs(module["omega1"] - module["input_speed"]) > 30.0
    assert module["output_torque"] == pytest.approx(1.0, rel=1e-2)
    assert module["rhs_evaluations"] - before < 2000


def test_lock_up_makes_no_energy_where_the_output_was_faster_than_a_light_link_1():
    mechanism = {
        "satellites": 5,
        "imbalance_mass": 80.0,
        "z2": 33,
        "z17": 40,
        "z6": 50,
        "a": 0.64293,
        "c": 0.0,
    }
    values = {"wheel_radius": 0.2, "input_inertia": 2e-4, "output_inertia": 1e-3, "tolerance": 1e-9}
    module = started("auto", AVERAGED, mechanism, values, omega1=3.4835, load_torque=59.438)
    advanced(module, 0.38778)
    advanced(module, 0.042248, load_torque=2.1151, drive_torque=10.263)
    assert module["omega_out"] == pytest.approx(module["input_speed"], rel=1e-9)
    audit(module, 1e-9)
