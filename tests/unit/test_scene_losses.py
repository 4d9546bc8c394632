"""A scene of a machine with losses: keys, efficiency, losses by cause, forces, and their panels."""

import math
from pathlib import Path

import numpy as np
import pytest

from inertia_module.contract.variable import PARAMETER
from inertia_module.contract.variables import BY_NAME, LOSSES, with_causality
from inertia_module.figures.losses import losses
from inertia_module.figures.scenes import scene_figure
from inertia_module.harness.results import Result
from inertia_module.harness.steady import SteadyMachine
from inertia_module.scene import SceneError, load_scene, read_scene, run_scene
from inertia_module.scene.run import above_stall, scene_plan
from inertia_module.scene.summary import SUMMARISED, forces, summarise

EXAMPLES = Path(__file__).parents[2] / "examples"
SCENE = """
[drive]
kind = "constant"
omega1 = "100 rad/s"
[load]
kind = "torque"
torque = "10 N.m"
[run]
stop_time = "0.5 s"
communication_step = "1 ms"
outputs = ["omega2", {outputs}]
[mechanism]
{mechanism}
"""
FORCES = ("satellite_force", "satellite_force_peak", "shaking_force_x", "shaking_force_y", "shaking_force_z")
FRICTION = "input_friction = 0.005\noutput_friction = 0.02"


def read(tmp_path, mechanism="", outputs=()):
    listed = ", ".join(f'"{name}"' for name in outputs)
    return read_scene(SCENE.format(mechanism=mechanism, outputs=listed), tmp_path)


@pytest.fixture(scope="module")
def fmu(built):
    return built / "InertiaModule.fmu"


def table(**last):
    """A table of two rows, all zeros but what is given for the second."""
    columns = {name: np.array([0.0, last.get(name, 0.0)]) for name in (*SUMMARISED, "load_torque", *last)}
    return Result.from_columns({"time": np.array([0.0, 1.0]), **columns})


def labels(figure):
    panels = [axes for axes in figure.axes if axes.get_legend() is not None]
    return {text.get_text() for axes in panels for text in axes.get_legend().get_texts()}


# --- keys ---


@pytest.mark.parametrize(
    "key, value, number",
    [
        ("mesh_efficiency", '"98 %"', 0.98),
        ("journal_friction", '"0.02 mm"', 2e-5),
        ("housing_drag", '"0.3 Nm"', 0.3),
        ("gravity", '"9.81 m/s2"', 9.81),
        ("satellite_inertia", '"500 g.m2"', 0.5),
        ("input_friction", '"2 N.m.s/rad"', 2.0),
    ],
)
def test_losses_are_keys_of_the_mechanism_with_units(tmp_path, key, value, number):
    # the mechanism by itself: whether all of it can be integrated together is another question
    from inertia_module.scene.mechanism import Mechanism

    assert getattr(Mechanism.model_validate({key: value.strip('"')}), key) == pytest.approx(number)


def test_an_efficiency_out_of_its_range_is_one_line(tmp_path):
    with pytest.raises(
        SceneError, match=r"^mechanism.mesh_efficiency must be between 0.1 and 1, is '120 %'$"
    ):
        read(tmp_path, 'mesh_efficiency = "120 %"')


def test_every_parameter_is_a_key():
    from inertia_module.scene.mechanism import Mechanism

    assert set(Mechanism.model_fields) == {v.name for v in with_causality(PARAMETER)} - {"tolerance"}


@pytest.mark.parametrize("name", ["housing_stiffness", "freewheel_stiffness"])
def test_freewheels_that_wind_up_are_not_exported_as_rigid_ones(tmp_path, name):
    scene = read(tmp_path, f'fidelity = "elastic"\n{name} = 6000')
    with pytest.raises(SceneError, match=f"^mechanism.{name} must be 0 for an export, is 6000: "):
        scene_plan(scene)
    assert scene_plan(read(tmp_path, f"{name} = 6000")).part("module").values[name] == 6000.0


# --- summary ---


def standing(load, **columns):
    """A run at whose end the shaft rests."""
    given = {"omega1": [100.0] * 3, "load_torque": [load] * 3, "omega_out": [3.0, 0.0, 0.0], **columns}
    return Result.from_columns({"time": [0.0, 1.0, 2.0], **given})


def test_load_above_stall_is_told():
    stall = SteadyMachine({}).at(100.0, 0.0).output_torque
    said = above_stall(standing(stall + 1.0), {})["load_torque"]
    assert said == f"is above stall: {stall + 1.0:.4g} N.m, the mechanism gives {stall:.4g} N.m at 100 rad/s"
    assert not above_stall(standing(stall - 1.0), {})
    assert not above_stall(standing(stall + 1.0, omega_out=[3.0, 2.0, 1.0]), {})
    assert not above_stall(standing(stall + 1.0, brake_torque=[0.0, 0.0, 5.0]), {})
    assert not above_stall(standing(stall + 1.0, omega1=[0.0] * 3), {})
    assert not above_stall(standing(stall + 1.0), {"output_freewheel": 0.0})


@pytest.mark.parametrize(
    "energies, efficiency",
    [
        ({"energy_in": 100.0, "energy_out": 60.0, "energy_stored": 20.0, "energy_lost": 20.0}, 0.8),
        # a load that drives, motion used up, a drive that takes: put in is what came in
        ({"energy_in": -30.0, "energy_out": -50.0, "energy_stored": 10.0, "energy_lost": 10.0}, 0.8),
        ({"energy_out": 15.0, "energy_stored": -20.0, "energy_lost": 5.0}, 0.75),
        ({"energy_in": 7.0, "energy_lost": 7.0}, 0.0),
        ({"energy_in": 7.0, "energy_out": 7.0}, 1.0),
        # a balancer gives more than is lost; nothing moves
        ({"energy_in": 7.0, "energy_out": 9.0, "energy_lost": -2.0}, None),
        ({}, None),
    ],
)
def test_efficiency_is_what_is_not_lost_of_all_put_in(energies, efficiency):
    found = summarise(table(**energies), None, None, 1.0)
    assert ("efficiency" in found) == (efficiency is not None)
    if efficiency is not None:
        assert found["efficiency"].value == pytest.approx(efficiency, rel=1e-15)


@pytest.mark.parametrize("name", LOSSES)
def test_each_loss_is_told_where_there_is_one(name):
    told = summarise(table(energy_in=10.0, energy_lost=2.0, **{name: 2.0}), None, None, 1.0)
    assert [key for key in told if key in LOSSES] == [name]
    assert told[name] == (2.0, "J")
    assert list(losses(table(**{name: 2.0}))) == [name.removeprefix("energy_lost_")]


def test_parts_of_the_loss_add_up():
    assert len(LOSSES) == 5
    assert all(BY_NAME[name].unit == "J" for name in LOSSES)


def test_forces_are_magnitudes_of_what_is_recorded():
    one = table(satellite_force=5.0, shaking_force_x=2.0, shaking_force_y=-3.0, shaking_force_z=6.0)
    assert {name: values[-1] for name, values in forces(one).items()} == {
        "satellite_force": 5.0,
        "shaking_force": 7.0,
    }
    found = summarise(one, None, None, 1.0)
    assert found["shaking_force_peak"] == (7.0, "N")
    assert found["shaking_force_rms"].value == pytest.approx(7.0 / math.sqrt(2.0))
    assert "shaking_moment_peak" not in found
    # two of three components are no force, and what is 0 throughout is not known
    assert not forces(table(shaking_force_x=2.0, shaking_force_y=1.0))
    assert not forces(table(satellite_force=0.0))
    # nor is what three satellites leave of 3 kN by rounding
    balanced = table(satellite_force=3e3, shaking_force_x=0.0, shaking_force_y=3e-12, shaking_force_z=-4e-12)
    assert list(forces(balanced)) == ["satellite_force"]


def test_peak_between_the_points_wins():
    found = summarise(table(satellite_force=5.0, satellite_force_peak=8.0), None, None, 1.0)
    assert found["satellite_force_peak"] == (8.0, "N")


# --- runs ---


def test_losses_of_a_run_add_up_and_are_drawn(fmu, tmp_path):
    result = run_scene(read(tmp_path, FRICTION, FORCES), fmu)
    numbers = result.summary
    assert numbers["energy_lost_viscous"] == numbers["energy_lost"] > 0.0
    kept = numbers["energy_out"] + numbers["energy_stored_gain"]
    assert numbers["efficiency"] == pytest.approx(kept / numbers["energy_in"], rel=1e-5)
    assert numbers["satellite_force_peak"] >= result.table["satellite_force"].max()
    assert numbers["satellite_force_rms"] < numbers["satellite_force_peak"]
    assert not set(LOSSES) & set(result.table.names)
    figure = scene_figure(result)
    assert {"on the satellite's bearing", "on the mount", "viscous", "lost"} <= labels(figure)
    assert len(figure.axes) == 12
    # the power lost, drawn over the end of the run, is that of the table
    lost = next(axes for axes in figure.axes if axes.get_ylabel() == "lost [W]" and axes.get_xlim()[0] > 0.3)
    power = np.diff(result.record["energy_lost"]) / 1e-3
    assert lost.lines[0].get_ydata() == pytest.approx(power[-lost.lines[0].get_ydata().size :])


def test_an_ideal_module_has_no_panels_of_losses(fmu, tmp_path):
    result = run_scene(read(tmp_path, outputs=["imbalance_acceleration"]), fmu)
    assert result.summary["efficiency"] == 1.0
    figure = scene_figure(result)
    assert len(figure.axes) == 8
    assert figure.get_figheight() == 9.0
    assert not {"lost", "viscous", "on the mount"} & labels(figure)


def test_a_car_with_friction_shows_where_its_energy_went(fmu, tmp_path):
    text = """
[drive]
kind = "controlled"
[load]
kind = "vehicle"
mass = 900
wheel_radius = 0.3
final_drive = 3
[controller]
kind = "pi"
proportional_gain = 500
reference = { kind = "table", time = [0, 5], speed = [0, 2] }
[run]
stop_time = 5
communication_step = 0.01
[mechanism]
satellites = 3
input_friction = 0.05
"""
    result = run_scene(read_scene(text, tmp_path), fmu)
    figure = scene_figure(result)
    assert len(figure.axes) == 5
    assert {"lost", "viscous"} <= labels(figure)


# --- the examples of real machines ---

REAL = ("real_machine", "real_bevel")


def test_examples_have_every_loss_body_and_weight():
    names = [variable.name for variable in with_causality(PARAMETER)]
    lossy = names[names.index("input_friction") : names.index("gravity") + 1]
    # what only the elastic output has
    lossy = [name for name in lossy if not name.endswith(("_stiffness", "_damping"))]
    given = {name for example in REAL for name in load_scene(EXAMPLES / f"{example}.toml").parameters()}
    assert set(lossy) <= given


@pytest.mark.parametrize("example", REAL)
def test_examples_lose_to_every_cause_but_the_shaft_and_balance(fmu, example):
    scene = load_scene(EXAMPLES / f"{example}.toml").replaced(run={"stop_time": 0.5})
    result = run_scene(scene, fmu)
    numbers = result.summary
    assert {name for name in LOSSES if name in numbers} == set(LOSSES) - {"energy_lost_shaft"}
    assert all(numbers[name] > 0.0 for name in LOSSES if name in numbers)
    total = sum(numbers[name] for name in LOSSES if name in numbers)
    assert total == pytest.approx(numbers["energy_lost"], rel=1e-12)
    assert numbers["energy_residual_relative"] < 1e-6
    assert 0.3 < numbers["efficiency"] < 1.0
    assert {"mesh", "journal", "freewheel", "viscous"} <= labels(scene_figure(result))
