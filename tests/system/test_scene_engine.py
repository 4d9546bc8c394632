"""An engine as drive of a scene: held to the Python engine of loops; governors; what is refused."""

from pathlib import Path

import numpy as np
import pytest

from inertia_module import loops
from inertia_module.fidelity.trials import run_in_process
from inertia_module.figures.scenes import scene_figure
from inertia_module.harness.fmu import Fmu
from inertia_module.loops import Engine, EngineMap, Governor, TorqueDrivenEngine, torque_driven
from inertia_module.scene import SceneError, load_scene, read_scene, run_scene
from inertia_module.scene.run import start_of
from inertia_module.scene.summary import summarise

EXAMPLE = Path(__file__).parents[2] / "examples" / "engine_launch.toml"
TOP_SPEED = 250.0


@pytest.fixture(scope="module")
def fmu(built):
    return built / "InertiaModule.fmu"


def full_throttle(stop_time=6.0, step=0.01, integral_gain=12.0):
    """The example, throttle open from the start, engine at idle."""
    governor = {"top_speed": TOP_SPEED, "idle": 80.0, "proportional_gain": 3.0}
    return load_scene(EXAMPLE).replaced(
        drive={
            "throttle": 1.0,
            "throttle_over_time": None,
            "governor": {**governor, "integral_gain": integral_gain},
        },
        run={"stop_time": stop_time, "communication_step": step},
    )


def by_python(scene, fmu):
    """The same launch by the engine of loops, its governor asked for the top speed."""
    step = scene.run.communication_step
    limits = EngineMap(
        tuple(np.array([0.0, 1000.0, 2000.0, 3000.0]) * np.pi / 30.0),
        (20.0, 30.0, 36.0, 32.0),
        (6.0, 8.0, 10.0, 14.0),
    )
    governor = Governor(3.0, scene.drive.governor.integral_gain, step)
    engine = Engine(0.15, limits, governor, TOP_SPEED, 80.0)
    car = loops.vehicle_load(step, mass=900.0, wheel_radius=0.29, final_drive=4.0, drag_area=0.65)
    sources = [
        loops.source(name, value, step) for name, value in (("omega1", TOP_SPEED), ("brake_force", 0.0))
    ]
    surroundings = loops.connect([*sources, car.system])
    mechanism = {"layout": 1, "sun_radius": 0.1, "satellite_radius": 0.06, "eccentricity": 0.04}
    mechanism |= {"imbalance_mass": 0.3, "satellites": 3, "link2_inertia": 0.01}
    parameters = torque_driven({**mechanism, "output_inertia": 0.05 + car.rigid_inertia}, 0.15)
    start = {**loops.initial_inputs(surroundings), "omega1": 80.0}
    with Fmu(fmu, parameters, start, tolerance=1e-7) as started:
        plant = TorqueDrivenEngine(started, engine)
        outputs = ("input_speed", "omega_out", "engine_torque")
        return loops.ClosedLoop(plant, surroundings, outputs).run(scene.run.stop_time)


def test_without_integral_the_launch_is_that_of_the_python_engine_to_rounding(fmu):
    scene = full_throttle(integral_gain=0.0)
    table, expected = run_scene(scene, fmu).record, by_python(scene, fmu)
    assert expected["input_speed"].max() > TOP_SPEED  # the governor had something to do
    for name in ("input_speed", "omega_out", "vehicle_speed"):
        assert np.abs(table[name] - expected[name]).max() < 1e-6 * expected[name].max(), name
    assert table["drive_torque"][:-1] == pytest.approx(expected["engine_torque"][1:], abs=1e-5)


def test_with_integral_it_differs_by_the_sample_the_integral_is_ahead(fmu):
    """The scene's controllers count the sample in hand, the Python engine counts it for the next one."""
    scene = full_throttle()
    table, expected = run_scene(scene, fmu).record, by_python(scene, fmu)
    apart = np.abs(table["vehicle_speed"] - expected["vehicle_speed"]).max()
    assert 0.0 < apart < 1e-3 * expected["vehicle_speed"].max()


def test_with_the_throttle_closed_the_engine_idles(fmu):
    """The module asks for torque only to turn link 2 and the car: the governor of the idle speed gives it."""
    scene = full_throttle(8.0).replaced(drive={"throttle": 0.0, "omega1": 150.0})
    table = run_scene(scene, fmu).record
    drag = scene.drive.torque_map().limits(150.0)[0]
    assert table["drive_torque"][0] == pytest.approx(drag)
    settled = table.time > 6.0
    assert table["input_speed"][settled].mean() == pytest.approx(80.0, rel=0.03)


def test_half_throttle_is_half_way_between_drag_and_full_load():
    scene = full_throttle().replaced(drive={"throttle": 0.5, "omega1": 100.0})
    low, high = scene.drive.torque_map().limits(100.0)
    _, values, inputs = start_of(scene)
    assert inputs["drive_torque"] == pytest.approx(0.5 * (low + high))
    assert (inputs["omega1"], values["input_inertia"], values["drive"]) == (100.0, 0.15, 1.0)


def test_a_map_from_files_with_other_speeds_is_the_same_map(tmp_path):
    (tmp_path / "full.csv").write_text("speed [rpm],torque [N.m]\n0,20\n1000,30\n2000,36\n3000,32\n")
    text = EXAMPLE.read_text()
    begin, end = text.index("[drive.full_load]"), text.index("[drive.drag]")
    with_file = text[:begin] + '[drive.full_load]\nfile = "full.csv"\n' + text[end:]
    found = read_scene(with_file, tmp_path).drive.torque_map()
    assert found == load_scene(EXAMPLE).drive.torque_map()
    speeds = 'speed = ["0 rpm", "1000 rpm", "2000 rpm", "3000 rpm"]'
    four = speeds + '\ntorque = ["6 N.m", "8 N.m", "10 N.m", "14 N.m"]'
    assert four in with_file
    two = 'speed = ["0 rpm", "3000 rpm"]\ntorque = ["6 N.m", "14 N.m"]'
    coarse = with_file.replace(four, two)
    assert read_scene(coarse, tmp_path).drive.torque_map().limits(150.0 * np.pi) == pytest.approx(
        (-14.0, 32.0)
    )
    low, high = read_scene(coarse, tmp_path).drive.torque_map().limits(50.0 * np.pi)
    assert (low, high) == pytest.approx((-10.0, 33.0))


@pytest.mark.parametrize(
    "old, new, words",
    [
        ('torque = ["20 N.m"', 'torque = ["-20 N.m"', ["drive.full_load.torque", "'-20 N.m'", "at least 0"]),
        ('speed = ["0 rpm", "1000', 'speed = ["1500 rpm", "1000', ["drive.full_load", "must increase"]),
        (
            'throttle = ["0 %", "100 %"]',
            'throttle = ["0 %", "110 %"]',
            ["throttle", "'110 %'", "of at most 1"],
        ),
        ('inertia = "0.15 kg.m2"\n', "", ["drive.inertia must be given, is missing"]),
        (
            'inertia = "0.15 kg.m2"\n',
            'inertia = 0.15\nthrottle = "50 %"\n',
            ["throttle_over_time", "both are"],
        ),
        (
            'idle = "800 rpm"',
            'idle = "2500 rpm"',
            ["drive.governor", "idle must be below top_speed = 251.327"],
        ),
        (
            'gain = "3 N.m.s/rad"',
            'gain = "30 N.m.s/rad"',
            ["communication_step", "at most", "0.005 s", "0.01 s"],
        ),
        ('layout = "planar"', 'layout = "planar"\ndrive = "speed"', ["mechanism.drive must be 'torque'"]),
        ('times_to = ["25 km/h"', 'times_to = ["50 kg"', ["load.times_to", "'50 kg'", "m/s"]),
    ],
)
def test_what_cannot_be_is_one_line(old, new, words):
    text = EXAMPLE.read_text()
    assert old in text
    with pytest.raises(SceneError) as refused:
        read_scene(text.replace(old, new, 1), EXAMPLE.parent)
    line = str(refused.value)
    assert "\n" not in line
    for word in words:
        assert word in line


# --- times to a speed ---


def test_example_says_how_soon_the_car_is_up_to_speed(fmu):
    result = run_scene(
        load_scene(EXAMPLE).replaced(load={"times_to": ["25 km/h", "50 km/h", "100 km/h"]}), fmu
    )
    table, numbers = result.record, result.summary
    for speed in (25.0, 50.0):
        time = numbers[f"time_to_{speed:g}_kmh"]
        assert np.interp(time, table.time, table["vehicle_speed"]) * 3.6 == pytest.approx(speed, rel=2e-3)
    assert numbers["time_to_25_kmh"] < numbers["time_to_50_kmh"]
    assert "time_to_100_kmh" not in numbers
    fastest = table["vehicle_speed"].max() * 3.6
    assert result.remarks == {"time_to_100_kmh": f"is not reached: {fastest:.4g} km/h is the most"}
    assert numbers["energy_residual_relative"] < 1e-7
    heading = scene_figure(result).axes[0].get_title(loc="left")
    assert f"25 km/h in {numbers['time_to_25_kmh']:.3g} s" in heading


def test_times_count_from_the_last_standstill(fmu):
    record = run_scene(full_throttle(2.0), fmu).record
    speed = np.interp(record.time, [0.0, 0.5, 1.0, 1.5, 2.0], [3.0, 0.0, 0.0, 10.0, 20.0])
    changed = type(record)({**record.columns, "vehicle_speed": speed}, record.units)
    found = summarise(changed, None, None, 1.0, [2.0, 10.0, 15.0, 30.0])
    times = {name: found[name].value for name in found if name.startswith("time_to_")}
    assert times == {"time_to_36_kmh": pytest.approx(0.5), "time_to_54_kmh": pytest.approx(0.75)}


def test_in_process_it_is_the_same_launch(fmu):
    scene = full_throttle(2.0)
    found, expected = run_in_process(scene).record, run_scene(scene, fmu).record
    assert found["vehicle_speed"] == pytest.approx(expected["vehicle_speed"], rel=1e-9)
