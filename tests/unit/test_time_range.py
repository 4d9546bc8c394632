"""Test tables of a run: steps, tables outside the run, and suspicious times."""

import re

import numpy as np
import pytest
from rejected import assert_rejected
from test_scene import OPEN, TORQUE, changed, read

from inertia_module.common.csv_table import TableError
from inertia_module.common.errors import SceneError
from inertia_module.common.examples import example
from inertia_module.common.time_range import time_warnings
from inertia_module.driveline.sources import Table, evaluate
from inertia_module.fmi.results import Result
from inertia_module.scene import load_scene
from inertia_module.studies.measurement import measurement
from inertia_module.viewer.html import page_scene

EPOCH = 1.7e9
RECORD = np.linspace(0.0, 1.0, 101)


@pytest.mark.parametrize(
    ("times", "stop_time", "words"),
    [
        (
            EPOCH + RECORD,
            1.0,
            r"0 to 1 s \(got 1700000000 to 1700000001 s\): they look like seconds since 1970",
        ),
        (1000.0 * EPOCH + RECORD, 1.0, "they look like seconds since 1970"),
        (
            100.0 + RECORD,
            60.0,
            r"0 to 60 s \(got 100 to 101 s\): subtract 100 s from all times, or name their unit",
        ),
        (RECORD - 5.0, 1.0, r"0 to 1 s \(got -5 to -4 s\): name their unit"),
        (np.array([2.0, 3.0]), 1.0, "got 2 to 3 s"),
    ],
)
def test_table_outside_the_run_is_rejected_with_both_ranges(times, stop_time, words):
    with pytest.raises(TableError, match=f"times of rig.csv must be within the run, .*{words}"):
        time_warnings("rig.csv", times, [times], stop_time)


@pytest.mark.parametrize(
    ("times", "stop_time", "words"),
    [
        # Milliseconds without a unit.
        (
            60_000.0 * RECORD,
            60.0,
            "changes from 0 to 60000 s, .* 0 to 60 s, uses less than 1 % .* such as ms",
        ),
        (np.array([0.0, 5000.0]), 5.0, "changes from 0 to 5000 s"),
        (np.array([0.0, 5e-6]), 5.0, ""),
        (
            RECORD / 1000.0,
            1.0,
            "0 to 0.001 s, and is constant in 99.9 % of the run, 0 to 1 s: name their unit",
        ),
        (100.0 + 20.0 * RECORD, 120.0, "100 to 120 s, and is constant in 83.3 % .*: subtract 100 s"),
        (RECORD, 1.0, ""),
        (0.4 + RECORD, 1.0, ""),
        (RECORD, 1.9, ""),
        (RECORD - 0.5, 1.0, ""),
        # Points from a manual curve.
        (np.array([0.0, 1.0]), 60.0, ""),
        (np.array([50.0, 51.0]), 60.0, ""),
        (np.array([5.0, 5.0]), 60.0, ""),
        (np.array([7.0]), 1.0, ""),
        (np.array([0.5, 3.0, 7.0]), 1.0, ""),
    ],
)
def test_suspicious_times_cause_a_warning(times, stop_time, words):
    lines = time_warnings("rig.csv", times, [np.arange(times.size)], stop_time)
    assert len(lines) == bool(words)
    assert re.search(words, "".join(lines)), lines


def test_table_that_changes_within_the_run_or_just_after_it_has_no_warning():
    assert time_warnings("x", np.array([0.0, 3.0, 7.0]), [np.array([0.0, 0.0, 1.0])], 1.0) == []
    assert time_warnings("x", 1e5 * RECORD, [np.ones(RECORD.size)], 1.0) == []
    assert time_warnings("x", np.array([0.0, 1.0, 1e6]), [np.array([0.0, 1.0, 1.0])], 10.0) == []


# --- steps ---


def test_two_equal_points_are_a_step_from_which_on_the_later_value_holds():
    table = Table([0.0, 1.0, 1.0, 2.0], [0.0, 10.0, 20.0, 20.0])
    points = [-1.0, 0.5, np.nextafter(1.0, 0.0), 1.0, 1.5, 3.0]
    assert table(np.array(points)).tolist() == pytest.approx([0.0, 5.0, 10.0, 20.0, 20.0, 20.0], rel=1e-14)
    assert [evaluate(table, point) for point in points] == table(np.array(points)).tolist()
    assert evaluate(Table([0.0, 0.0], [1.0, 2.0]), 0.0) == 2.0


SPEED = 'kind = "constant"\nomega1 = 100'
STEPS = {
    "drive": (OPEN, SPEED, 'kind = "table"\ntime = [0, 0.5, 0.5]\nomega1 = [1, 2, 3]'),
    "load": (OPEN, "torque = 10", "torque_over_time = { time = [0, 0.5, 0.5], torque = [1, 2, 3] }"),
    "torque": (
        TORQUE,
        'kind = "torque"\ndrive_torque = "12 Nm"',
        'kind = "torque_table"\ntime = [0, 0.5, 0.5]\ndrive_torque = [1, 2, 3]',
    ),
}


@pytest.mark.parametrize("name", STEPS)
def test_a_step_is_read_in_each_table_of_a_scene(name):
    scene = read(changed(*STEPS[name]))
    signal = scene.load.one_signal() if name == "load" else scene.drive.signal()
    assert signal(np.array([0.0, 0.25, 0.5, 1.0])).tolist() == [1.0, 1.5, 3.0, 3.0]
    points = [signal["times"] for signal in page_scene(scene)["inputs"].values() if isinstance(signal, dict)]
    assert points == [[0.0, 0.5, 0.5]]


def test_road_may_have_a_step_but_torque_over_speed_may_not(tmp_path):
    (tmp_path / "road.csv").write_text("distance,slope\n0,0\n5,0\n5,0.1\n9,0.1\n")
    scene = load_scene(example("urban"), {"load.slope_over_distance.file": str(tmp_path / "road.csv")})
    assert scene.load.slope_over_distance.signal()(np.array([4.9, 5.0])).tolist() == [0.0, 0.1]
    (tmp_path / "map.csv").write_text("speed [rpm],torque\n0,20\n1000,30\n1000,40\n")
    words = "drive.full_load: speed must be strictly increasing .got 104.72 after 104.72"
    assert_rejected(
        words, load_scene, example("engine_launch"), {"drive.full_load": {"file": str(tmp_path / "map.csv")}}
    )


def test_two_rows_of_the_same_time_are_two_readings():
    columns = {
        "omega2": [1.0, 2.0, 3.0],
        "output_torque_mean": [1.0, 2.0, 3.0],
        "torque_peak": [1.0, 2.0, 3.0],
    }
    table = Result.from_columns({"time": [0.1, 0.2, 0.2], **columns})
    data = measurement(table, load_scene(example("reference")))
    assert data.counted.tolist() == [[True, False, True], [True, True, True], [True, False, False]]
    assert data.sensors["shift.time"].size == pytest.approx(0.1)


# --- scenes ---


def test_scene_rejects_a_table_outside_its_run_and_warns_of_suspicious_times(tmp_path):
    rows = "".join(f"{time};{time}\n" for time in range(100, 130))
    (tmp_path / "rig.csv").write_text(f"time;omega1\n{rows}")
    table = changed(OPEN, SPEED, 'kind = "table"\nfile = "rig.csv"')
    with pytest.raises(
        SceneError, match=r"times of drive \(rig.csv\) must be within the run, 0 to 1 s \(got 100"
    ):
        read(table, tmp_path)
    read(changed(table, "stop_time = 1", "stop_time = 130"), tmp_path)
    load = changed(OPEN, "torque = 10", "torque_over_time = { time = [2, 3], torque = [1, 2] }")
    with pytest.raises(SceneError, match=r"times of load.torque_over_time must be within the run"):
        read(load)


def test_a_scene_may_begin_with_a_byte_order_mark_and_must_be_in_utf_8(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_bytes(OPEN.encode("utf-8-sig"))
    assert load_scene(file).drive.omega1 == 100.0
    for code, line in (("latin-1", 2), ("utf-16", 1)):
        file.write_bytes(f"# R1\n# Prüfstand\n{OPEN}".encode(code))
        assert_rejected(rf"^cannot read .*scene.toml: line {line} is not UTF-8$", load_scene, file)


REMEDY = "starts an escape sequence. Write / instead of .*, or put the path in single quotes."


@pytest.mark.parametrize(
    ("path", "words"),
    [
        (r"C:\Users\me\rig.csv", f"line 3.*In double quotes a backslash {REMEDY}"),
        (r"data\rig.csv", f"file must be a path .got .*{REMEDY}"),
        (r"data\drive.csv", f"line 3.*{REMEDY}"),
        (r"C:\temp\new.csv", f"file must be a path .got .*{REMEDY}"),
        (r"D:\xrig.csv", f"line 3.*{REMEDY}"),
    ],
)
def test_a_path_of_windows_in_double_quotes_has_a_remedy(path, words):
    text = changed(OPEN, SPEED, f'kind = "table"\nfile = "{path}"')
    with pytest.raises(SceneError, match=words) as caught:
        read(text)
    assert "\n" not in str(caught.value)
