"""Tables from CSV files as they come from rigs and spreadsheets: read right, or refused in a sentence."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from refused import REFUSED

from inertia_module.common.errors import Refused
from inertia_module.common.examples import example
from inertia_module.harness.results import Result, TableError
from inertia_module.harness.system import WiringError
from inertia_module.scene import SceneError, load_scene

TIMES, SPEEDS = [0.0, 0.5, 1.0], [100.0, 101.5, -2.5e-3]
SAME = tomllib.loads(Path(__file__).with_name("same_tables.toml").read_text(encoding="utf-8"))
BAD = [(text.encode(), words) for text, words in REFUSED["tables"]]
NO_UTF_8 = r"table\.csv must be a CSV file in UTF-8"
BAD += [("time,winkel [°]\n0,1\n".encode(code), NO_UTF_8) for code in ("latin-1", "utf-16")]


def read(folder, content):
    (folder / "table.csv").write_bytes(content)
    return Result.from_csv(folder / "table.csv")


def test_the_same_table_comes_out_of_every_way_to_write_it(tmp_path):
    for name, text in SAME.items():
        table = read(tmp_path, text.encode())
        found = (table.names, table.time.tolist(), table["omega1"].tolist(), table.units["time"])
        assert found == (["time", "omega1"], TIMES, SPEEDS, "s"), name


def test_a_table_that_could_be_misread_is_refused(tmp_path):
    for content, words in BAD:
        with pytest.raises(TableError, match=words) as refused:
            read(tmp_path, content)
        assert "\n" not in str(refused.value)


def test_columns_are_converted_to_the_units_asked_for():
    table = Result.from_columns({"time": [0.0], "speed": [30.0], "torque": [2.0]}, {"speed": "rpm"})
    turned = table.converted({"speed": "rad/s", "torque": "N.m"})
    assert turned["speed"] == pytest.approx([math.pi])
    assert turned.units == {"time": "s", "speed": "rad/s", "torque": "N.m"}
    assert table["speed"] == [30.0]
    with pytest.raises(TableError, match=r"speed \[rpm\] must be in N\.m .* rpm is not a unit for N\.m"):
        table.converted({"speed": "N.m"})


def test_what_was_written_is_read_back_to_the_bit(tmp_path):
    table = Result.from_columns({"time": np.arange(3.0), "x": [0.1, 1 / 3, 1e-300]}, {"x": "kg.m2"})
    read = Result.from_csv(table.to_csv(tmp_path / "table.csv"))
    assert {name: values.tolist() for name, values in read.columns.items()} == {
        name: values.tolist() for name, values in table.columns.items()
    }
    assert read.units == table.units


def test_a_road_over_distance_comes_from_a_file_without_a_time(tmp_path):
    (tmp_path / "road.csv").write_text("distance [km];slope [%]\n0;0\n0,5;4\n")
    of_file = {"load.slope_over_distance.file": str(tmp_path / "road.csv")}
    road = load_scene(example("urban"), of_file).load.slope_over_distance
    assert road.distance == [0.0, 500.0]
    assert road.slope == [0.0, 0.04]
    (tmp_path / "road.csv").write_text("way,slope\n0,0\n")
    with pytest.raises(SceneError, match=r"road\.csv must have a column distance \(there are way, slope\)"):
        load_scene(example("urban"), of_file)
    (tmp_path / "road.csv").write_text("distance [kg],slope\n0,0\n")
    with pytest.raises(SceneError, match=r"slope_over_distance\.distance.* is '0.0 kg': kg is not a unit"):
        load_scene(example("urban"), of_file)


def test_every_error_of_the_package_is_of_one_kind():
    from inertia_module.harness.simulate import FmuError

    for kind in (FmuError, TableError, WiringError, SceneError):
        assert issubclass(kind, Refused)
