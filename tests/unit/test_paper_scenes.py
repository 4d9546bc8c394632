"""Test scenes of the papers against the exact forms, and scenes of a shaft alone."""

import math
from dataclasses import astuple
from pathlib import Path

import numpy as np
import pytest
from rejected import REJECTED, assert_rejected

from inertia_module.plots.scenes import scene_figure
from inertia_module.scene import load_any_scene, load_scene, run_scene, run_shaft_scene
from papers.karetin import Geometry, dynamic_mode, exact
from papers.lysenko import EXAMPLE
from papers.lysenko import exact as lysenko_at
from papers.stelmashchuk import Criteria, response
from tests.system.programs import assert_one_line_error, command, stdout_of

PAPERS = Path(__file__).parents[2] / "examples" / "papers"
SHAFT = PAPERS / "stelmashchuk_stepping.toml"


# --- the papers ---


# A mechanism without symmetry.
ASKEW = {"z17": 41, "shaft_angle": 1.1, "a": 0.7, "b": 1.4, "c": 0.5, "epsilon": 0.4, "gamma": -1.3}


@pytest.mark.parametrize("name, i", [("karetin_stop", math.inf), ("karetin_dynamic", 2.0)])
@pytest.mark.parametrize("shape", [{}, ASKEW], ids=["as printed", "askew"])
def test_karetins_modes_move_the_imbalance_as_the_exact_form(built, name, i, shape):
    scene = load_scene(PAPERS / f"{name}.toml").replaced(mechanism=shape)
    result = run_scene(scene, built / "InertiaModule.fmu")
    table = result.table
    forms = exact(Geometry(**{"z17": 40, "z6": 20, **shape}), dynamic_mode(100.0, i), table.time)
    for column, expected in (
        ("imbalance", forms.position),
        ("imbalance_velocity", forms.velocity),
        ("imbalance_acceleration", forms.acceleration),
    ):
        there = np.array([table[f"{column}_{axis}"] for axis in "xyz"])
        assert np.abs(there - expected).max() < 1e-10 * np.abs(expected).max()
    scene_figure(result)


def test_free_wheel_of_lysenko_oscillates_at_constant_energy(built):
    scene = load_scene(PAPERS / "lysenko_wheel.toml")
    values = scene.parameters()
    lengths = "sun_radius", "satellite_radius", "eccentricity"
    masses = "imbalance_mass", "input_inertia", "drive_inertia"
    assert [values[name] for name in (*lengths, *masses)] == pytest.approx(astuple(EXAMPLE))
    table = run_scene(scene, built / "InertiaModule.fmu").table
    speed, energy = table["input_speed"], table["energy_stored"]
    assert np.ptp(energy) < 1e-9 * energy[0]
    # Rows are 1 ms apart, so the minimum speed is close to a row and the maximum is the start.
    assert speed[0] / speed.min() == pytest.approx(lysenko_at(EXAMPLE, 0.0).speed_ratio, rel=1e-4)


def test_stelmashchuks_scene_gives_his_motion(built):
    scene = load_any_scene(SHAFT)
    table = run_shaft_scene(scene, built / "DrivenShaft.fmu").table
    T, angle = scene.drive.T, scene.drive.angle
    motion = response(table.time / T, Criteria(8.0, 0.5), 1.0)
    assert table["omega_out"] * T / angle == pytest.approx(motion.velocity, abs=1e-4)
    assert table["twist"] / angle == pytest.approx(-motion.twist, abs=1e-4)
    # The balancer uses the slope of the previous step: a delay of 3/2 steps in a wave of 4 pi^2.
    late = 1.5 * 4.0 * math.pi**2 * scene.run.communication_step / T
    assert table["driven_acceleration"] * T**2 / angle == pytest.approx(motion.acceleration, abs=1.01 * late)


# --- a shaft alone ---


@pytest.mark.parametrize("sign", [1, -1])
def test_hub_by_table_with_a_load(built, sign):
    turned = {"kind": "table", "time": [0, 1], "hub_speed": [0, f"{60 * sign} rpm"]}
    keys = {"drive": turned, "load": {"kind": "torque", "torque": f"{2 * sign} N.m"}}
    keys["shaft"] = {"driven_inertia": 0.2, "shaft_damping": 5, "input_hold": "linear"}
    keys["run"] = {"stop_time": 1, "communication_step": 0.01, "outputs": ["twist"]}
    result = run_shaft_scene(load_any_scene(SHAFT, keys), built / "DrivenShaft.fmu")
    assert result.table.names == ["time", "hub_speed", "load_torque", "twist"]
    assert result.table["hub_speed"][-1] == pytest.approx(sign * 2.0 * math.pi)
    # At the end the shaft transmits the load and the torque that accelerates the mass.
    torque = 2.0 + 0.2 * 2.0 * math.pi
    assert result.record["shaft_torque"][-1] == pytest.approx(sign * torque, rel=0.02)
    assert result.summary["shaft_torque_peak"] == np.abs(result.record["shaft_torque"]).max()
    assert result.summary["energy_residual_relative"] < 1e-12


@pytest.mark.parametrize("key, value, line", REJECTED["shaft_scenes"])
def test_error_is_a_line(key, value, line):
    assert_rejected(f"^{SHAFT.name}: {line}", load_any_scene, SHAFT, {key: value})


def test_shaft_scene_is_not_a_module_scene():
    assert_rejected(r"unknown key 'shaft'; available: title, ", load_scene, SHAFT)
    message = "error: --fidelity, --error and --view require a scene of the module"
    assert_one_line_error(command("run", SHAFT, "--fidelity", "rigid"), message)


def test_command_runs_a_shaft(built, tmp_path):
    stdout_of("run", SHAFT, "--fmu", built / "DrivenShaft.fmu", "-o", tmp_path / "out")
    assert {file.name for file in (tmp_path / "out").iterdir()} == {"table.csv", "summary.json", "plot.png"}
