"""Scene files: what they mean in SI, and one line for each thing that can be wrong."""

import math
from pathlib import Path

import pytest

from inertia_module.common.units import parse_unit, to_si
from inertia_module.harness.simulate import Result
from inertia_module.scene import SceneError, load_scene, read_scene, run_scene

EXAMPLES = Path(__file__).parents[2] / "examples"
OPEN = """
[drive]
kind = "constant"
omega1 = 100
[load]
kind = "torque"
torque = 10
[run]
stop_time = 1
communication_step = 0.01
"""
CLOSED = """
[drive]
kind = "controlled"
[load]
kind = "vehicle"
mass = 900
wheel_radius = 0.3
final_drive = 3
[controller]
kind = "pi"
proportional_gain = 100
reference = { kind = "constant", speed = "36 km/h" }
[run]
stop_time = 1
communication_step = 0.01
"""
COUPLED = OPEN.replace('kind = "torque"\ntorque = 10', 'kind = "shaft"\ninertia = 0.5')


def read(text, folder=Path()):
    return read_scene(text, folder)


# --- units ---


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (3, "rad/s", 3.0),
        ("90 deg", "rad", math.pi / 2),
        ("3000 rpm", "rad/s", 100.0 * math.pi),
        ("2 rev/s", "rad/s", 4.0 * math.pi),
        ("5 ms", "s", 0.005),
        ("50 km/h", "m/s", 50.0 / 3.6),
        ("1.5e2 mm", "m", 0.15),
        ("20 kg m^2", "kg.m2", 20.0),
        ("2 kNm", "N.m", 2000.0),
        ("3 N*m*s/rad", "N.m.s/rad", 3.0),
        ("5 %", "1", 0.05),
        ("7 1/s", "1/s", 7.0),
        ("-.5", "N.m", -0.5),
        ("4 kg/s", "N.s/m", 4.0),
    ],
)
def test_quantities_in_si(value, unit, expected):
    assert to_si(value, unit) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("value", "unit"),
    [
        ("3 m", "rad/s"),
        ("3 rad", "rad/s"),
        ("3 furlong", "m"),
        ("m", "m"),
        (True, "m"),
        (None, "m"),
        ("1e999 m", "m"),
        (math.inf, "m"),
        ("nan", "m"),
        ([1], "m"),
        ("3 m m", "m"),
        ("3 //", "m"),
    ],
)
def test_quantities_refused(value, unit):
    with pytest.raises(ValueError, match=r"\w"):
        to_si(value, unit)


def test_dimension_of_a_compound_unit():
    assert parse_unit("N.m.s/rad") == (1.0, {"kg": 1, "m": 2, "s": -1, "rad": -1})


# --- good scenes ---


@pytest.mark.parametrize("name", ["reference", "planar", "urban"])
def test_examples_come_back_the_same(name):
    """Checked once, a scene in SI units is checked again without a change."""
    scene = load_scene(EXAMPLES / f"{name}.toml")
    context = {"folder": EXAMPLES, "measured": scene.measured}
    again = type(scene).model_validate(scene.model_dump(exclude_none=True), context=context)
    assert again == scene


def test_reference_example_is_r1():
    scene = load_scene(EXAMPLES / "reference.toml")
    assert scene.parameters() == {}
    assert scene.drive.signal() == 100.0
    assert scene.load.torque == 10.0
    assert scene.run.stop_time == 1.0


def test_urban_example_adds_the_car_to_the_output_inertia():
    scene = load_scene(EXAMPLES / "urban.toml")
    assert scene.parameters()["output_inertia"] == pytest.approx(0.05 + 900.0 * (0.29 / 4.0) ** 2)
    assert scene.parameters()["layout"] == 1.0
    assert scene.cycle.duration == scene.run.stop_time
    assert scene.measured == "vehicle_speed"


def test_mechanism_takes_names_switches_and_units():
    scene = read(
        OPEN
        + '[mechanism]\nlayout = "planar"\nhousing_freewheel = false\nsun_radius = "60 mm"\nsatellites = 3'
    )
    assert scene.parameters() == {
        "layout": 1.0,
        "housing_freewheel": 0.0,
        "sun_radius": 0.06,
        "satellites": 3.0,
    }


def test_drive_kinds():
    def signal(drive):
        return read(OPEN.replace('kind = "constant"\nomega1 = 100', drive)).drive.signal()

    ramp = signal('kind = "ramp"\ninitial = "0 rpm"\nfinal = 100\nstart = "1 s"\nduration = 4')
    assert [ramp(time) for time in (0.0, 1.0, 3.0, 9.0)] == [0.0, 0.0, 50.0, 100.0]
    table = signal('kind = "table"\ntime = [0, "1000 ms"]\nomega1 = [0, "60 rpm"]')
    assert table(0.5) == pytest.approx(math.pi)


def test_table_from_a_csv_file_with_units(tmp_path):
    (tmp_path / "drive.csv").write_text("time [ms],omega1 [rpm]\n0,0\n1000,60\n")
    drive = 'kind = "table"\nfile = "drive.csv"'
    text = OPEN.replace('kind = "constant"\nomega1 = 100', drive)
    assert read(text, tmp_path).drive.signal()(1.0) == pytest.approx(2.0 * math.pi)
    (tmp_path / "scene.toml").write_text(text)
    assert load_scene(tmp_path / "scene.toml").drive.time == [0.0, 1.0]


def test_speed_under_control_has_the_unit_of_its_load():
    assert read(CLOSED).controller.reference.speed == pytest.approx(10.0)
    shaft = CLOSED.replace(
        'kind = "vehicle"\nmass = 900\nwheel_radius = 0.3\nfinal_drive = 3', 'kind = "shaft"\ninertia = 1'
    ).replace("36 km/h", "600 rpm")
    scene = read(shaft)
    assert scene.measured == "omega_out"
    assert scene.controller.reference.speed == pytest.approx(20.0 * math.pi)


# --- bad scenes ---


def changed(text, old, new):
    assert old in text
    return text.replace(old, new)


CONSTANT = 'kind = "constant"\nomega1 = 100'
VEHICLE = 'kind = "vehicle"\nmass = 900\nwheel_radius = 0.3\nfinal_drive = 3'
CLOSED_TORQUE = changed(
    changed(CLOSED, VEHICLE, 'kind = "torque"\ntorque = 1'), 'speed = "36 km/h" }', "speed = 3 }"
)
BAD = {
    "unknown table": (OPEN + "[gearbox]\nratio = 3", "gearbox", "{'ratio': 3}", "mechanism, drive, load"),
    "unknown key": (
        OPEN + "[mechanism]\nsatelites = 3",
        "mechanism.satelites",
        "3",
        "did you mean satellites",
    ),
    "misspelt needed key": (
        changed(OPEN, "omega1", "omega_1"),
        "drive.omega_1",
        "100",
        "mean omega1?",
    ),
    "key of another kind": (
        OPEN.replace('"constant"', '"ramp"'),
        "drive.omega1",
        "100",
        "must not be given with drive.kind = 'ramp', it belongs to kind 'constant' or 'table'",
    ),
    "decimal comma": (
        changed(OPEN, "omega1 = 100", "omega1 = '1,5 rpm'"),
        "drive.omega1",
        "'1,5 rpm'",
        "no commas",
    ),
    "decimal comma without quotes": (
        changed(OPEN, "omega1 = 100", "omega1 = 1,5"),
        "TOML",
        "line",
        "no commas",
    ),
    "missing key": (changed(OPEN, "omega1 = 100", ""), "drive.omega1", "missing", "must be given"),
    "missing kind": (changed(OPEN, CONSTANT, ""), "drive.kind", "missing", "'constant', 'ramp'"),
    "unknown kind": (
        changed(OPEN, "constant", "steady"),
        "drive.kind",
        "'steady'",
        "'constant', 'ramp'",
    ),
    "wrong unit": (changed(OPEN, "= 100", '= "100 m"'), "drive.omega1", "'100 m'", "rad/s"),
    "unknown unit": (changed(OPEN, "= 100", '= "9 knots"'), "drive.omega1", "'9 knots'", "rad/s"),
    "no number": (changed(OPEN, "= 100", '= "fast"'), "drive.omega1", "'fast'", "a number"),
    "no quantity": (changed(OPEN, "= 100", "= true"), "drive.omega1", "True", "a number"),
    "not finite": (changed(OPEN, "= 100", "= nan"), "drive.omega1", "nan", "a number of at least"),
    "out of range": (
        OPEN + '[mechanism]\nshaft_angle = "200 deg"',
        "shaft_angle",
        "'200 deg'",
        "3.1415",
    ),
    "not whole": (OPEN + "[mechanism]\nz2 = 2.5", "mechanism.z2", "2.5", "a whole number between 1 and"),
    "unknown item": (
        OPEN + '[mechanism]\nlayout = "flat"',
        "mechanism.layout",
        "'flat'",
        "0 (bevel)",
    ),
    "no switch": (OPEN + "[mechanism]\nhousing_freewheel = 2", "housing_freewheel", "2", "true or false"),
    "singular": (OPEN + "[mechanism]\nlink2_inertia = 0", "link2_inertia", "is 0", "must be above 0"),
    "tolerance": (
        OPEN + "[accuracy]\ntolerance = 1",
        "accuracy.tolerance",
        "is 1",
        "of at least 1e-13 and of at most 0.1",
    ),
    "negative time": (changed(OPEN, "stop_time = 1", "stop_time = -1"), "run.stop_time", "-1", "above 0"),
    "broken steps": (
        changed(OPEN, "stop_time = 1", "stop_time = 1.005"),
        "run.stop_time",
        "1.005",
        "whole number",
    ),
    "unknown output": (OPEN + 'outputs = ["omga2"]', "run.outputs", "'omga2'", "did you mean omega2?"),
    "no output": (OPEN + "outputs = []", "run.outputs", "[]", "at least one"),
    "table not rising": (
        changed(OPEN, CONSTANT, 'kind = "table"\ntime = [0, 1, 1]\nomega1 = [1, 2, 3]'),
        "drive: time, omega1",
        "1 comes after 1",
        "points of a table must increase",
    ),
    "table uneven": (
        changed(OPEN, CONSTANT, 'kind = "table"\ntime = [0, 1]\nomega1 = [1]'),
        "drive: time, omega1",
        "2 points and 1 values",
        "one value a point",
    ),
    "no file": (
        changed(OPEN, CONSTANT, 'kind = "table"\nfile = "no.csv"'),
        "drive",
        "no.csv",
        "must be a CSV file",
    ),
    "file and columns": (
        changed(OPEN, CONSTANT, 'kind = "table"\nfile = "no.csv"\ntime = [0]'),
        "drive",
        "file",
        "give either 'file' or 'time' and 'omega1', not both",
    ),
    "controlled by none": (
        changed(OPEN, CONSTANT, 'kind = "controlled"'),
        "drive.kind",
        "controlled",
        "[controller]",
    ),
    "controller unused": (
        changed(CLOSED, 'kind = "controlled"', 'kind = "constant"\nomega1 = 1'),
        "drive.kind",
        "'constant'",
        "'controlled'",
    ),
    "no torque": (
        changed(OPEN, "torque = 10", ""),
        "load",
        "neither",
        "one of torque and torque_over_time must be given",
    ),
    "negative mass": (changed(CLOSED, "mass = 900", "mass = -1"), "load.mass", "-1", "above 0"),
    "speed of another kind": (changed(CLOSED, "36 km/h", "600 rpm"), "reference.speed", "'600 rpm'", "m/s"),
    "unknown cycle": (
        changed(CLOSED, 'kind = "constant", speed = "36 km/h"', 'kind = "cycle", cycle = "WLTC"'),
        "controller.reference.cycle",
        "'WLTC'",
        "there are ECE R15",
    ),
    "limits": (
        changed(CLOSED, "proportional_gain", "minimum = 5\nmaximum = 2\nproportional_gain"),
        "controller: minimum",
        "is 5",
        "must be below maximum = 2",
    ),
    "brake without vehicle": (
        changed(CLOSED_TORQUE, "speed = 3 }", "speed = 3 }\nbrake = { gain = 1, maximum = 1 }"),
        "controller.brake",
        "'torque'",
        "load.kind must be 'vehicle'",
    ),
    "step too long": (
        changed(COUPLED, "inertia = 0.5", "inertia = 0.5\ncoupling = { stiffness = 1e6 }"),
        "run.communication_step",
        "0.01",
        "the step must be shorter",
    ),
    "no table": ("drive = 4\nload = 3\nrun = 2", "drive", "is 4", "must be a table"),
    "no TOML": ("drive = ", "TOML", "", ""),
}


@pytest.mark.parametrize(("text", "key", "value", "allowed"), BAD.values(), ids=BAD)
def test_one_line_names_key_value_and_what_is_allowed(text, key, value, allowed):
    with pytest.raises(SceneError) as caught:
        read(text)
    line = str(caught.value)
    assert "\n" not in line
    for part in (key, value, allowed):
        assert part in line


def test_missing_scene_file_is_one_line(tmp_path):
    with pytest.raises(SceneError, match=r"none.toml must be a scene file \(TOML\): No such file"):
        load_scene(tmp_path / "none.toml")


def test_bad_scene_file_is_named(tmp_path):
    (tmp_path / "bad.toml").write_text(OPEN + "[mechanism]\nz2 = 0")
    with pytest.raises(
        SceneError, match=r"^bad.toml: mechanism.z2 must be a whole number between 1 and 1000000, is 0$"
    ):
        load_scene(tmp_path / "bad.toml")


# --- runs ---


@pytest.fixture(scope="module")
def fmu(built):
    return built / "InertiaModule.fmu"


def test_run_leaves_the_wanted_columns_and_the_numbers(fmu):
    text = OPEN.replace("stop_time = 1", "stop_time = 0.2") + 'outputs = ["omega2", "contact_mode"]'
    seen = []
    result = run_scene(read(text), fmu, seen.append)
    assert isinstance(result.table, Result)
    assert result.table.names == ["time", "omega2", "contact_mode", "load_torque", "omega1"]
    assert len(result.table) == 21
    assert seen[-1] == 1.0
    summary = result.summary
    assert set(summary) == set(result.units)
    assert summary["energy_residual_relative"] < 1e-5
    assert summary["energy_in"] == pytest.approx(
        summary["energy_out"] + summary["energy_stored_gain"], rel=1e-5
    )
    assert summary["contact_switches"] > 0
    assert summary["rhs_evaluations"] > 0


def test_controlled_run_tells_how_well_it_follows(fmu):
    text = CLOSED.replace("stop_time = 1", "stop_time = 5").replace(
        'kind = "constant", speed = "36 km/h"', 'kind = "table", time = [0, 5], speed = [0, 2]'
    )
    text = text.replace("proportional_gain = 100", "proportional_gain = 500")
    result = run_scene(read(text + "[mechanism]\nsatellites = 3"), fmu)
    assert result.units["tracking_error_rms"] == "km/h"
    assert 0.1 < result.summary["tracking_error_rms"] < result.summary["tracking_error_maximum"] < 3.0
    assert result.summary["distance"] == pytest.approx(5.0, rel=0.2)


def test_energy_of_a_car_behind_an_elastic_shaft(fmu):
    """Only resistances of the car's own motion count: in = rolling + what still moves."""
    coupled = "final_drive = 3\ncoupling = { stiffness = 2000, damping = 20 }"
    text = CLOSED.replace("final_drive = 3", coupled).replace("stop_time = 1", "stop_time = 2")
    result = run_scene(read(text + "[mechanism]\nsatellites = 3\noutput_inertia = 0.5"), fmu)
    summary = result.summary
    moving = 0.5 * 900.0 * result.table["vehicle_speed"][-1] ** 2
    assert moving > 100.0
    assert summary["energy_out"] > moving + summary["energy_rolling"]
    assert summary["energy_rolling"] == pytest.approx(0.01 * 900 * 9.80665 * summary["distance"], rel=0.02)


@pytest.mark.parametrize("name", ["engine_launch", "planar", "real_machine", "urban"])
def test_a_scene_as_text_is_the_same_scene(name):
    from inertia_module.scene.reading import scene_text

    scene = load_scene(Path("examples") / f"{name}.toml")
    assert read(scene_text(scene)).tables == scene.tables


@pytest.mark.parametrize(("step", "coarse"), [("0.01", True), ("0.001", False)])
def test_rows_too_far_apart_for_the_pulses_are_dots_and_mean_torques_no_curves(fmu, step, coarse):
    from inertia_module.figures.scenes import scene_figure

    figure = scene_figure(run_scene(read(OPEN.replace("0.01", step)), fmu))
    lines = {line.get_label(): line for axes in figure.axes for line in axes.lines}
    assert ("link 2 ω2, at instants" in lines) is coarse
    assert ("output freewheel" in lines) is not coarse
    if coarse:
        assert lines["link 2 ω2, at instants"].get_linestyle() == "None"


def test_figures_of_both_kinds_are_drawn(fmu, tmp_path):
    from inertia_module.figures.scenes import scene_figure

    for name, text in {
        "open": OPEN,
        "closed": CLOSED,
        "short": OPEN.replace("e = 1\n", "e = 0.01\n"),
    }.items():
        path = tmp_path / f"{name}.png"
        scene_figure(run_scene(read(text), fmu)).savefig(path)
        assert path.stat().st_size > 10_000
