"""Tables from CSV files as they come from rigs and spreadsheets: read right, or refused in a sentence."""

import math

import numpy as np
import pytest

from inertia_module.common.errors import Refused
from inertia_module.common.examples import example
from inertia_module.harness.results import Result, TableError
from inertia_module.harness.wires import WiringError
from inertia_module.scene import SceneError, load_scene

TIMES, SPEEDS = [0.0, 0.5, 1.0], [100.0, 101.5, -2.5e-3]
SAME = {
    "commas": "time,omega1\n0,100\n0.5,101.5\n1,-2.5e-3\n",
    "semicolons": "time;omega1\n0;100\n0.5;101.5\n1;-2.5e-3\n",
    "decimal commas": "time;omega1\n0;100\n0,5;101,5\n1;-2,5e-3\n",
    "tabs": "time\tomega1\n0\t100\n0,5\t101,5\n1\t-2,5e-3\n",
    "decimal commas in quotes": 'time,omega1\n0,100\n"0,5","101,5"\n1,"-2,5e-3"\n',
    "units in brackets": "time [s];omega1 [rad/s]\n0;100\n0,5;101,5\n1;-2,5e-3\n",
    "units in round brackets": "time (s);omega1 (rad/s)\n0;100\n0,5;101,5\n1;-2,5e-3\n",
    "time in ms": "time [ms],omega1\n0,100\n500,101.5\n1000,-2.5e-3\n",
    "byte mark, blanks, empty lines": "\ufeff\n time , omega1 \r\n0,100\r\n\r\n0.5,101.5\r\n1,-2.5e-3",
}
BAD = {
    "both signs": ("time;omega1\n0;1.5\n1;1,5\n", "must have decimal points or decimal commas, has both"),
    "thousands": ("time;omega1\n0;1.234,5\n", "must have decimal points or decimal commas, has both"),
    "decimal commas that part columns": (
        "time,omega1\n0,100\n0,5,101,5\n",
        "line 3 must have 2 cells, .* has 4",
    ),
    "a name twice": ("time,omega1,omega1\n0,1,2\n", "column 3 must have a name of its own, is 'omega1'"),
    "no name": ("time;omega1;\n0;1;\n", "column 3 must have a name of its own, is ''"),
    "no number": ("time,omega1\n\n0,fast\n", "line 3: omega1 must be a finite number, is 'fast'"),
    "an empty cell": ("time,omega1\n0,\n", "line 2: omega1 must be a finite number, is ''"),
    "no number at all": (
        "time,omega1\n0,1\n\n1,nan\n",
        r"table\.csv line 4: omega1 must be a finite .*, is 'nan'",
    ),
    "no end": ("time;omega1\n0;-inf\n", r"table\.csv line 2: omega1 must be a finite number, is '-inf'"),
    "time in metres": ("time [m],omega1\n0,1\n", r"time \[m\] must be in s or in a unit of the same kind"),
    "time in a unit nobody knows": ("time [blink],omega1\n0,1\n", "blink is an unknown unit"),
    "time that goes back": (
        "time [ms],omega1\n2,1\n1,1\n",
        r"table\.csv: time must not go back, is 0.001 in row 1",
    ),
    "a heading only": ("time,omega1\n", "at least one row of numbers"),
    "no time": ("t,omega1\n0,1\n", "columns must include time .there are t, omega1"),
    "Latin letters": ("time,winkel [°]\n0,1\n".encode("latin-1"), r"table\.csv must be a CSV file in UTF-8"),
    "two bytes a letter": ("time,x\n0,1\n".encode("utf-16"), r"table\.csv must be a CSV file in UTF-8"),
}


def read(folder, content):
    (folder / "table.csv").write_bytes(content)
    return Result.from_csv(folder / "table.csv")


def test_the_same_table_comes_out_of_every_way_to_write_it(tmp_path):
    for name, text in SAME.items():
        table = read(tmp_path, text.encode())
        found = (table.names, table.time.tolist(), table["omega1"].tolist(), table.units["time"])
        assert found == (["time", "omega1"], TIMES, SPEEDS, "s"), name


def test_a_table_that_could_be_misread_is_refused(tmp_path):
    for text, words in BAD.values():
        with pytest.raises(TableError, match=words) as refused:
            read(tmp_path, text if isinstance(text, bytes) else text.encode())
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
