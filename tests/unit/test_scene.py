"""Test scene files: their values in SI units, and a line for each error."""

import math
import re
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from rejected import assert_rejected

from inertia_module.common.errors import SceneError
from inertia_module.common.units import number_of, parse_unit
from inertia_module.interface.variables import PARAMETER, with_causality
from inertia_module.scene import load_scene
from inertia_module.scene.export_plan import scene_plan
from inertia_module.scene.reading import scene_text
from inertia_module.scene.run import initial_values
from inertia_module.scene.schema import Mechanism

EXAMPLES = Path(__file__).parents[2] / "examples"
# Scenes that tests modify.
BASES = {file.stem: file.read_text() for file in Path(__file__).with_name("bases").iterdir()}
OPEN, CLOSED, TORQUE = (BASES[name] for name in ("open", "closed", "torque"))
VEHICLE = 'kind = "vehicle"\nmass = 900\nwheel_radius = 0.3\nfinal_drive = 3'
ENGINE = (EXAMPLES / "engine_launch.toml").read_text()


def read(text, folder=None):
    with TemporaryDirectory() as own:
        (file := Path(folder or own) / "scene.toml").write_text(text)
        return load_scene(file)


def changed(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


# --- units ---


QUANTITIES = tomllib.loads(Path(__file__).with_name("quantities.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("value, unit, expected", QUANTITIES["rows"])
def test_quantities_in_si(value, unit, expected):
    assert number_of(value, unit) == pytest.approx(expected, rel=1e-15)


UNFIT = ["3 rad/s", "3 furlong", "m", True, None, "1e999 m", math.inf, "nan", [1], "3 m m", "3 //"]


@pytest.mark.parametrize(("value", "unit"), [*((value, "m") for value in UNFIT), ("3 rad", "rad/s")])
def test_rejected_quantities(value, unit):
    with pytest.raises(ValueError, match=r"\w"):
        number_of(value, unit)


def test_dimension_of_a_compound_unit():
    assert parse_unit("N.m.s/rad") == (1.0, {"kg": 1, "m": 2, "s": -1, "rad": -1})


# --- good scenes ---


@pytest.mark.parametrize("name", ["reference", "engine_launch", "planar", "real_machine", "urban"])
def test_a_scene_as_text_and_checked_again_is_the_same_scene(name):
    scene = load_scene(EXAMPLES / f"{name}.toml")
    assert read(scene_text(scene)).tables == scene.tables
    context = {"folder": EXAMPLES, "vehicle": scene.load.kind == "vehicle"}
    assert type(scene).model_validate(scene.model_dump(exclude_none=True), context=context) == scene


def test_reference_example_is_r1():
    scene = load_scene(EXAMPLES / "reference.toml")
    assert scene.parameters() == {}
    assert (scene.drive.signal(), scene.load.torque, scene.run.stop_time) == (100.0, 10.0, 1.0)


def test_urban_example_adds_the_car_to_the_output_inertia():
    scene = load_scene(EXAMPLES / "urban.toml")
    assert scene.parameters()["output_inertia"] == pytest.approx(0.05 + 900.0 * (0.29 / 4.0) ** 2)
    assert scene.parameters()["layout"] == 1.0
    assert scene.cycle.duration == scene.run.stop_time
    assert scene.measured == "vehicle_speed"


@pytest.mark.parametrize(("key", "value", "number"), QUANTITIES["mechanism"])
def test_mechanism_takes_names_switches_and_units(key, value, number):
    assert getattr(Mechanism.model_validate({key: value}), key) == pytest.approx(number)


def test_every_parameter_is_a_key():
    names = {v.name for v in with_causality(PARAMETER)} - {"tolerance"}
    assert set(Mechanism.model_fields) == names | {"satellite"}


@pytest.mark.parametrize(
    ("drive", "file", "points"),
    [
        ('"ramp"\ninitial = "0 rpm"\nfinal = 100\nstart = "1 s"\nduration = 4', "", {1: 0, 3: 50, 9: 100}),
        ('"table"\ntime = [0, "1000 ms"]\nomega1 = [0, "60 rpm"]', "", {0.5: math.pi}),
        (
            '"table"\nfile = "drive.csv"',
            "time [ms],omega1 [rpm]\n0,0\n1000,60\n",
            {0.5: math.pi, 2: math.tau},
        ),
        ('"torque_table"\ntime = ["0 s", "500 ms"]\ndrive_torque = [0, "20 N.m"]', "", {0.25: 10}),
        ('"torque_table"\nfile = "drive.csv"', "time [ms],drive_torque [kNm]\n0,0\n500,0.02\n", {0.25: 10}),
    ],
)
def test_drives_over_time_are_linear_between_their_points(tmp_path, drive, file, points):
    (tmp_path / "drive.csv").write_text(file)
    (tmp_path / "scene.toml").write_text(changed(TORQUE, TORQUE.split("[")[1], f"drive]\nkind = {drive}\n"))
    scene = load_scene(tmp_path / "scene.toml")
    for each in (scene, scene.replaced(run={"stop_time": 0.1})):
        signal = each.drive.signal()
        assert {time: signal(time) for time in points} == pytest.approx(points)


def test_speed_under_control_has_the_unit_of_its_load(tmp_path):
    assert read(CLOSED).controller.reference.speed == pytest.approx(10.0)
    shaft = changed(changed(CLOSED, VEHICLE, 'kind = "shaft"\ninertia = 1'), "36 km/h", "600 rpm")
    scene = read(changed(shaft, "[run]", 'integral_gain = "2 1/s"\n[run]'))
    assert scene.measured == "omega_out"
    assert scene.controller.integral_gain == 2.0
    a_way = read(changed(CLOSED, "[run]", 'integral_gain = "2 rad/m/s"\n[run]'))
    assert a_way.controller.integral_gain == 2.0
    assert scene.controller.reference.speed == pytest.approx(20.0 * math.pi)
    (tmp_path / "wanted.csv").write_text("time [min],speed [km/h]\n0,0\n1,36\n")
    filed = changed(CLOSED, 'kind = "constant", speed = "36 km/h"', 'kind = "table", file = "wanted.csv"')
    assert read(filed, tmp_path).controller.reference.signal()(30.0) == pytest.approx(5.0)


def test_slope_over_distance_replaces_the_constant_slope():
    hill = "[load.slope_over_distance]\ndistance = [0, 100]\nslope = [0, '10 %']"
    load = read(CLOSED + hill).built_load.system
    signals = dict(zip(load.output_labels, load.output(0.0, [50.0], [0.0, 0.0]), strict=True))
    assert signals["slope_torque"] == pytest.approx(0.1 * 900.0 * 9.80665 * math.sin(math.atan(0.05)))


@pytest.mark.parametrize("open_one", ["housing_freewheel", "output_freewheel"])
def test_car_rolls_back_without_a_freewheel(open_one):
    """Uphill and at rest the rolling resistance holds the car; it does not push it down."""
    uphill = changed(CLOSED, VEHICLE, VEHICLE + '\nslope = "1 %"\nrolling_resistance = 0.02')
    for mechanism, torque in (("", 0.01 + 0.02), (f"[mechanism]\n{open_one} = false", 0.0)):
        load = read(uphill + mechanism).built_load.system
        held = load.output(0.0, [0.0], [0.0, 0.0])[0]
        assert held == pytest.approx(torque * 0.1 * 900.0 * 9.80665, rel=1e-3, abs=1e-9)


# --- torque-driven scenes ---


def test_a_torque_sets_the_drive_and_the_start():
    scene = read(TORQUE)
    assert scene.parameters() == {"input_inertia": 0.2, "drive": 1.0}
    start = {"drive_torque": 12.0, "omega1": pytest.approx(20.0 * math.pi), "load_torque": 10.0}
    assert initial_values(scene)[1] == start
    assert initial_values(read(changed(TORQUE, '\nomega1 = "600 rpm"', "")))[1]["omega1"] == 0.0
    assert read(TORQUE + '\ndrive = "torque"').parameters() == scene.parameters()
    assert read(OPEN + '[mechanism]\ndrive = "speed"').parameters()["drive"] == 0.0


def test_an_engine_is_a_torque_of_its_map_and_carries_its_rotor():
    drive = {"throttle": 0.5, "throttle_over_time": None, "omega1": 100.0}
    scene = load_scene(EXAMPLES / "engine_launch.toml").replaced(drive=drive)
    low, high = scene.drive.torque_map().limits(100.0)
    values, inputs = initial_values(scene)
    assert inputs["drive_torque"] == pytest.approx(0.5 * (low + high))
    assert (inputs["omega1"], values["input_inertia"], values["drive"]) == (100.0, 0.15, 1.0)


def test_governor_step_includes_the_inertia_of_link_1():
    stiff = changed(ENGINE, 'gain = "3 N.m.s/rad"', 'gain = "30 N.m.s/rad"')
    heavier = read(changed(stiff, 'layout = "planar"', 'layout = "planar"\ninput_inertia = 0.16'))
    assert heavier.parameters()["input_inertia"] == pytest.approx(0.31)


def test_a_map_from_files_with_other_speeds_is_the_same_map(tmp_path):
    (tmp_path / "full.csv").write_text("speed [rpm],torque [N.m]\n0,20\n1000,30\n2000,36\n3000,32\n")
    begin, end = ENGINE.index("[drive.full_load]"), ENGINE.index("[drive.drag]")
    with_file = ENGINE[:begin] + '[drive.full_load]\nfile = "full.csv"\n' + ENGINE[end:]
    assert read(with_file, tmp_path).drive.torque_map() == read(ENGINE).drive.torque_map()
    four, eight = 'speed = ["0 rpm", "1000 rpm", "2000 rpm", ', 'torque = ["6 N.m", "8 N.m", "10 N.m", '
    coarse = changed(
        with_file, f'{four}"3000 rpm"]\n{eight}', 'speed = ["0 rpm", "3000 rpm"]\ntorque = ["6 N.m", '
    )
    limits = read(coarse, tmp_path).drive.torque_map().limits
    assert limits(150.0 * np.pi) == pytest.approx((-14.0, 32.0))
    assert limits(50.0 * np.pi) == pytest.approx((-10.0, 33.0))


# --- bad scenes ---

BASES |= {
    "empty": "",
    "engine": ENGINE,
    "still": changed(changed(CLOSED, VEHICLE, 'kind = "torque"\ntorque = 1'), '"36 km/h"', "3"),
}
# Scenes with a change or an addition, and the words of the error.
REJECTED = Path(__file__).with_name("rejected_scenes.txt").read_text(encoding="utf-8")


@pytest.mark.parametrize("change, words", re.findall(r"(.+)\n    (.+)\n", REJECTED))
def test_error_line_names_key_value_and_range(change, words):
    base, old, new = re.fullmatch(r"(\w+)(?:: (.*) =>| \+) ?(.*)", change.replace("\\n", "\n"), re.S).groups()
    text = changed(BASES[base], old, new) if old else BASES[base].replace("[run]", f"{new}\n[run]") or new
    with pytest.raises(SceneError) as caught:
        read(text)
    line = str(caught.value).removeprefix("scene.toml: ")
    assert "\n" not in line
    assert re.match(".*".join(re.escape(part.strip()) for part in words.split("...")), line), line


def test_bad_scene_file_is_named(tmp_path):
    file = tmp_path / "scene.toml"
    assert_rejected(r"^cannot read .*scene.toml: no such file or directory$", load_scene, file)
    file.write_text(OPEN + "[mechanism]\nz2 = 0")
    allowed = r"must be a whole number between 5 and 1000 \(got 0\)"
    assert_rejected(f"^scene.toml: mechanism.z2 {allowed}$", load_scene, file)


@pytest.mark.parametrize("name", ["housing_stiffness", "freewheel_stiffness"])
def test_compliant_freewheels_are_not_exported_as_rigid(name):
    scene = read(OPEN + f'[mechanism]\nfidelity = "elastic"\n{name} = 6000')
    assert_rejected(rf"^mechanism.{name} must be 0 for an export \(got 6000\)\. ", scene_plan, scene)
    assert scene_plan(read(OPEN + f"[mechanism]\n{name} = 6000")).part("module").values[name] == 6000.0
