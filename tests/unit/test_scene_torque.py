"""Scenes whose drive gives a torque: what they mean, what they refuse, and what a run of one leaves."""

import math
from pathlib import Path

import numpy as np
import pytest

from inertia_module.fidelity.levels import all_levels
from inertia_module.fidelity.trials import measure_scene, run_in_process
from inertia_module.figures.scenes import scene_figure
from inertia_module.scene import SceneError, load_scene, read_scene, run_scene
from inertia_module.scene.run import start_of

EXAMPLES = Path(__file__).parents[2] / "examples"
DRIVE = 'kind = "torque"\ndrive_torque = "12 Nm"\nomega1 = "600 rpm"'
SCENE = f"""
[mechanism]
input_inertia = 0.2
[drive]
{DRIVE}
[load]
kind = "torque"
torque = 5
[run]
stop_time = 0.5
communication_step = 0.01
"""
TABLE = SCENE.replace(
    DRIVE, 'kind = "torque_table"\ntime = ["0 s", "500 ms"]\ndrive_torque = [0, "20 N.m"]\nomega1 = 50'
)


def read(text, folder=Path()):
    return read_scene(text, folder)


@pytest.fixture(scope="module")
def fmu(built):
    return built / "InertiaModule.fmu"


def test_the_scene_sets_the_drive_and_the_start():
    scene = read(SCENE)
    assert scene.parameters() == {"input_inertia": 0.2, "drive": 1.0}
    _, _, inputs = start_of(scene)
    assert inputs == {
        "drive_torque": 12.0,
        "omega1": pytest.approx(20.0 * math.pi),
        "load_torque": 5.0,
    }
    assert start_of(read(SCENE.replace('\nomega1 = "600 rpm"', "")))[2]["omega1"] == 0.0


def test_a_torque_over_time_is_linear_between_its_points(tmp_path):
    scene = read(TABLE)
    assert scene.drive.signal()(0.25) == pytest.approx(10.0)
    assert start_of(scene)[2] == {"drive_torque": 0.0, "omega1": 50.0, "load_torque": 5.0}
    (tmp_path / "torque.csv").write_text("time [ms],drive_torque [kNm]\n0,0\n500,0.02\n")
    text = SCENE.replace(DRIVE, 'kind = "torque_table"\nfile = "torque.csv"')
    assert read(text, tmp_path).drive.signal()(0.25) == pytest.approx(10.0)


def test_its_own_drive_may_be_said_again():
    assert read(SCENE.replace("input_inertia = 0.2", 'input_inertia = 0.2\ndrive = "torque"')).parameters()
    speed = SCENE.replace(DRIVE, 'kind = "constant"\nomega1 = 10')
    given = read(speed.replace("input_inertia = 0.2", 'drive = "speed"')).parameters()
    assert given["drive"] == 0.0


@pytest.mark.parametrize(
    "old, new, words",
    [
        ('drive_torque = "12 Nm"', "", ["drive.drive_torque", "missing"]),
        ('"12 Nm"', '"12 N"', ["drive.drive_torque", "'12 N'", "N.m"]),
        ('"12 Nm"', "nan", ["drive.drive_torque", "nan", "a number of at least"]),
        ('"600 rpm"', '"600 m/s"', ["drive.omega1", "'600 m/s'", "rad/s"]),
        ("drive_torque =", "torque =", ["drive.torque", "did you mean drive_torque?"]),
        (
            "input_inertia = 0.2",
            "",
            ["mechanism", "input_inertia", "is 0", "drive = 1 (torque)", "must be above 0"],
        ),
        (
            "input_inertia = 0.2",
            'input_inertia = 0.2\ndrive = "speed"',
            ["with drive.kind = 'torque' mechanism.drive must be 'torque'", "is 'speed'"],
        ),
        (
            "input_inertia = 0.2",
            'input_inertia = 0.2\nfidelity = "kinematic"\nkinematic_ratio = 0.5',
            ["mechanism", "fidelity must be 1 (averaged)", "is 0", "drive = 1 (torque)"],
        ),
        (DRIVE, 'kind = "torque_table"\ntime = [0, 1]\ndrive_torque = [1]', ["drive", "time, drive_torque"]),
    ],
)
def test_what_cannot_be_is_one_line(old, new, words):
    assert old in SCENE
    with pytest.raises(SceneError) as refused:
        read(SCENE.replace(old, new))
    line = str(refused.value)
    assert "\n" not in line
    for word in words:
        assert word in line


def test_a_drive_of_speed_refuses_a_module_that_takes_torque():
    text = SCENE.replace(DRIVE, 'kind = "constant"\nomega1 = 10')
    with pytest.raises(
        SceneError, match=r"with drive.kind = 'constant' mechanism.drive must be 'speed', .* is 'torque'"
    ):
        read(text.replace("input_inertia = 0.2", 'drive = "torque"'))


def test_run_tells_the_speed_and_the_torque_and_draws_both(fmu, tmp_path):
    result = run_scene(read(TABLE), fmu)
    table, summary = result.table, result.summary
    assert table["drive_torque"][-1] == 20.0
    assert table["input_speed"][0] == 50.0
    assert "omega1" not in table
    assert summary["omega1_maximum"] == table["input_speed"].max()
    assert summary["energy_residual_relative"] < 1e-6
    # held over each step
    mean = np.average(table["drive_torque"][:-1])
    assert summary["input_torque_mean"] == pytest.approx(mean, rel=1e-9)
    figure = scene_figure(result)
    labels = [text.get_text() for axes in figure.axes for text in axes.get_legend().get_texts()]
    assert {"input ω1", "drive"} <= set(labels)
    figure.savefig(tmp_path / "plot.png")


def test_example_speeds_up_a_flywheel_while_the_motor_sags(fmu):
    scene = load_scene(EXAMPLES / "engine.toml")
    short = scene.replaced(run={"stop_time": 2.2, "communication_step": 2e-3})
    table = run_scene(short, fmu).table
    assert table["input_speed"][0] == pytest.approx(200.0)
    assert table["omega_out"][-1] > 100.0
    assert table["input_speed"].min() < 120.0


def test_the_same_in_process_and_at_the_levels_it_can_have(fmu):
    scene = read(TABLE)
    found = run_in_process(scene)
    assert found.record["omega_out"][-1] == pytest.approx(
        run_scene(scene, fmu).table["omega_out"][-1], rel=1e-9
    )
    assert found.module_time > 0.0
    (kinematic,) = (level for level in all_levels(False) if level.fidelity_name == "kinematic")
    (row,) = measure_scene(scene, [kinematic])
    assert "fidelity must be 1 (averaged), 2 (rigid) or 3 (elastic), is 0" in row.failure
    assert "drive = 1" in row.failure


# --- under control ---

CONTROLLED = """
[mechanism]
input_inertia = 0.2
satellites = 3
[drive]
kind = "controlled_torque"
omega1 = 80
[load]
kind = "vehicle"
mass = 100
wheel_radius = 0.3
final_drive = 3
[controller]
kind = "pi_torque"
proportional_gain = "20 N.m.s/m"
integral_gain = 2
minimum = "-10 N.m"
maximum = "20 N.m"
reference = { kind = "constant", speed = "36 km/h" }
[run]
stop_time = 25
communication_step = 0.01
"""


def test_a_controller_commands_the_torque_within_its_limits(fmu, tmp_path):
    scene = read(CONTROLLED)
    assert scene.parameters()["drive"] == 1.0
    assert start_of(scene)[2]["omega1"] == 80.0
    result = run_scene(scene, fmu)
    torque = result.table["drive_torque"]
    assert torque.max() == 20.0
    assert torque.min() >= -10.0
    assert np.abs(result.table["vehicle_speed"][-500:] - 10.0).max() < 0.15
    assert result.summary["energy_residual_relative"] < 1e-5
    path = tmp_path / "plot.png"
    scene_figure(result).savefig(path)
    assert path.stat().st_size > 10_000


@pytest.mark.parametrize(
    "old, new, words",
    [
        ('minimum = "-10 N.m"', "", ["controller.minimum", "missing"]),
        ('"20 N.m"', '"20 rad/s"', ["controller.maximum", "'20 rad/s'", "N.m"]),
        ('"20 N.m"', '"-30 N.m"', ["minimum must be below maximum = -30, is -10"]),
        ('"20 N.m.s/m"', '"20 rad/m"', ["controller.proportional_gain", "'20 rad/m'", "N.s"]),
        (
            'kind = "controlled_torque"\nomega1 = 80',
            'kind = "controlled"',
            ["with controller.kind = 'pi_torque' drive.kind must be 'controlled_torque', is 'controlled'"],
        ),
        (
            'kind = "pi_torque"',
            'kind = "pid"',
            ["controller.kind must be one of 'pi', 'pi_torque', is 'pid'"],
        ),
    ],
)
def test_a_controller_of_the_torque_that_cannot_be_is_one_line(old, new, words):
    assert old in CONTROLLED
    with pytest.raises(SceneError) as refused:
        read(CONTROLLED.replace(old, new))
    for word in words:
        assert word in str(refused.value)
