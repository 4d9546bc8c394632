"""Test tables from CSV files of rigs and spreadsheets: correct values, or a one-sentence error."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from rejected import REJECTED

from inertia_module.common.errors import InertiaModuleError, SceneError
from inertia_module.common.examples import example
from inertia_module.fmi.results import Result, TableError
from inertia_module.scene import load_scene

TIMES, SPEEDS = [0.0, 0.5, 1.0], [100.0, 101.5, -2.5e-3]
SAME = tomllib.loads(Path(__file__).with_name("same_tables.toml").read_text(encoding="utf-8"))
BAD = REJECTED["tables"]


def read(folder, content):
    (folder / "table.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    return Result.from_csv(folder / "table.csv")


def test_all_formats_of_a_table_give_the_same_result(tmp_path):
    for name, text in SAME.items():
        table = read(tmp_path, text)
        content = (table.names, table.time.tolist(), table["omega1"].tolist(), table.units["time"])
        assert content == (["time", "omega1"], TIMES, SPEEDS, "s"), name


def test_ambiguous_table_is_rejected(tmp_path):
    for content, words in BAD:
        with pytest.raises(TableError, match=words) as rejected:
            read(tmp_path, content)["omega1"]
        assert "\n" not in str(rejected.value)


# Cells of a column omega1; separator; the numbers, or words of the error and its line.
ONE_MEANING = [
    # Groups of three digits and decimals in a comma-separated file.
    (["900", '"1,200"'], ",", [900.0, 1200.0]),
    (['"1,200.5"', "-900.25"], ",", [1200.5, -900.25]),
    (['"1,234,567"', "0"], ",", [1234567.0, 0.0]),
    (["0.5", "1.200"], ",", [0.5, 1.2]),
    (["101.500", "1.200"], ",", [101.5, 1.2]),
    (["12000", "1.200"], ",", [12000.0, 1.2]),
    (["900", "1.2e3"], ",", [900.0, 1200.0]),
    # Decimal commas, and digit groups that are valid only with them.
    (["0,5", "1,200"], ";", [0.5, 1.2]),
    (["1.234,5", "1.200"], ";", [1234.5, 1200.0]),
    (["1.234.567", "900"], ";", [1234567.0, 900.0]),
    (["1,234,567", "900"], ";", [1234567.0, 900.0]),
    (["1,200.5", "900"], ";", [1200.5, 900.0]),
    (["1,5e-3", "-2"], "\t", [0.0015, -2.0]),
    # Signs that are never decimal signs.
    (["1 200", "900"], ";", [1200.0, 900.0]),
    (["1\u00a0200,5", "900"], ";", [1200.5, 900.0]),
    (["1\u202f200.5", "900"], ",", [1200.5, 900.0]),
    (["1\u2009200", "12 345"], "\t", [1200.0, 12345.0]),
    (["1'200", "900"], ";", [1200.0, 900.0]),
    (["1’200.5", "900"], ",", [1200.5, 900.0]),
    (["1_000", "900"], ",", [1000.0, 900.0]),
    (["−5", " 7 "], ",", [-5.0, 7.0]),
    (["true", "False"], ",", [1.0, 0.0]),
]
NO_MEANING = [
    (["900", "1.200"], ",", 3, "got '1.200'\\)\\. Write 1.2 or 1200\\."),
    (["900", "1.200"], ";", 3, "got '1.200'\\)\\. Write 1.2 or 1200\\."),
    (["1,200", "900"], ";", 2, "got '1,200'\\)\\. Write 1.2 or 1200\\."),
    (["0", "1.200", "2.400"], "\t", 3, "got '1.200'\\)\\. Write 1.2 or 1200\\."),
    (
        ["900", '"12,5"'],
        ",",
        3,
        r"got '12,5'\). In this file commas separate columns and .* Write 12.5, or separate .* semicolons",
    ),
    (['"0,5"', '"1,200"'], ",", 2, r"got '0,5'\).* Write 0.5, or separate columns by semicolons\."),
    (['"0,500"', '"1,200"'], ",", 2, r"got '0,500'\).* Write 0.5, or separate columns by semicolons\."),
    (
        ['"1,200"', "1200"],
        ",",
        3,
        r"written like '1,200' in line 2 \(got '1200'\)\. '1,200' can mean 1200 or 1.2\.",
    ),
    (['"1.234,5"', "1"], ",", 2, r"got '1.234,5'\).* Write 1234.5, or separate columns by semicolons\."),
    (["1.5", "1,5"], ";", 3, r"written like '1.5' in line 2 \(got '1,5'\)$"),
    (["1 200.5", "1 200,5"], ";", 3, r"written like '1 200.5' in line 2 \(got '1 200,5'\)$"),
    (["1 200", "1'200"], ";", 3, r"written like '1 200' in line 2 \(got "),
    (["1_0", "900"], ",", 2, r"a finite number \(got '1_0'\)$"),
    (["1 20", "900"], ";", 2, r"a finite number \(got '1 20'\)$"),
    (["1.23.456", "900"], ";", 2, r"a finite number \(got '1.23.456'\)$"),
    (["1e999", "900"], ",", 2, r"a finite number \(got '1e999'\)$"),
    (["١٢", "900"], ",", 2, r"a finite number \(got '١٢'\)$"),
    (["5 %", "900"], ",", 2, r"a finite number \(got '5 %'\)$"),
    (["0x10", "900"], ",", 2, r"a finite number \(got '0x10'\)$"),
    (["true", "2"], ",", 2, r"a finite number \(got 'true'\)$"),
]


def written(cells, separator, times=None):
    rows = [f"{n if times is None else times}{separator}{cell}" for n, cell in enumerate(cells)]
    return "\n".join([f"time{separator}omega1", *rows])


@pytest.mark.parametrize(("cells", "separator", "numbers"), ONE_MEANING)
def test_unambiguous_numbers_are_read(tmp_path, cells, separator, numbers):
    assert read(tmp_path, written(cells, separator))["omega1"].tolist() == numbers


@pytest.mark.parametrize(("cells", "separator", "line", "words"), NO_MEANING)
def test_numbers_with_no_or_two_meanings_are_rejected_with_their_line(
    tmp_path, cells, separator, line, words
):
    table = read(tmp_path, written(cells, separator))
    with pytest.raises(TableError, match=rf"table\.csv line {line}: omega1 must be .*{words}"):
        table["omega1"]


@pytest.mark.parametrize(
    ("time", "cells", "numbers"),
    [
        # If the form of the column agrees, the time column decides.
        ("0,5", ["900", "1.200"], [900.0, 1200.0]),
        ("0.5", ["900", "1.200"], [900.0, 1.2]),
        ("0.5", ["900", "1,200"], [900.0, 1200.0]),
        ("0,5", ["900", "1,200"], [900.0, 1.2]),
        ("0.5", ["1.300", "1.200"], [1.3, 1.2]),
        ("0,5", ["1.300", "1.200"], None),
        ("0.5", ["1,300", "1,200"], None),
        # Three decimals in each row.
        ("1", ["1.300", "1.200"], [1.3, 1.2]),
        ("1", ["1,300", "1,200"], [1.3, 1.2]),
        ("1.500", ["1.300", "1.200"], [1.3, 1.2]),
        ("1.500", ["900", "1.200"], None),
    ],
)
@pytest.mark.parametrize("separator", [";", "\t"])
def test_other_columns_decide_between_decimals_and_groups(tmp_path, separator, time, cells, numbers):
    table = read(tmp_path, written(cells, separator, time))
    if numbers is None:
        with pytest.raises(TableError, match="omega1 must be a number with one meaning"):
            table["omega1"]
    else:
        assert table["omega1"].tolist() == numbers


# Files that contain more than a table.
MORE = {
    "comments": "# rig 3\ntime,omega1\n% at 20 °C\n0,100\n// pause\n0.5,101.5\n1,-2.5e-3\n# end\n",
    "headings as a comment": "# time,omega1\n0,100\n0.5,101.5\n1,-2.5e-3\n",
    "lines above the headings": "Rig 3\nDate,2024-01-01\n\ntime,omega1\n0,100\n0.5,101.5\n1,-2.5e-3\n",
    "a time of day above the headings": "time,12:30\ntime,omega1,x\n0,100,\n0.5,101.5,\n1,-2.5e-3,\n",
    "separator in the first line": "sep=;\ntime;omega1\n0;100\n0,5;101,5\n1;-2,5e-3\n",
    "a separator of its own": "sep=|\ntime|omega1\n0|100\n0,5|101,5\n1|-2,5e-3\n",
    "a row of units": "time;omega1\nms;rad/s\n0;100\n500;101,5\n1000;-2,5e-3\n",
    "a row of units in brackets": "time,omega1\n[s],[rad/s]\n0,100\n0.5,101.5\n1,-2.5e-3\n",
    "units in both places": "time [s],omega1\ns,rad/s\n0,100\n0.5,101.5\n1,-2.5e-3\n",
    "separators at the end": "time;omega1;\n0;100;\n0,5;101,5;\n1;-2,5e-3;\n",
    "separators at the end of the rows alone": "time;omega1\n0;100;;\n0,5;101,5;\n1;-2,5e-3\n;;\n",
    "text, Booleans, empty cells": (
        'time,note,omega1,valve,heat\n0,start,100,true,\n0.5,,101.5,false,20\n1,"a, b",-2.5e-3,TRUE,n/a\n'
    ),
    "a column of two names": "time,x,x,omega1\n0,1,2,100\n0.5,a,b,101.5\n1,,,-2.5e-3\n",
    "a unit that nobody knows": "time,x [blink],omega1\n0,1,100\n0.5,1,101.5\n1,1,-2.5e-3\n",
    "dates and decimal commas": "time;date;omega1\n0;1.1.24;100\n0,5;1.1.24;101,5\n1;2.1.24;-2,5e-3\n",
    "short rows": "time,omega1,note\n0,100\n0.5,101.5,x\n1,-2.5e-3\n",
    "blanks behind commas": 'time, omega1\n0, 100\n0.5, "101.5"\n1, -2.5e-3\n',
    "lines that end with CR": "time,omega1\r0,100\r0.5,101.5\r1,-2.5e-3\r",
}


@pytest.mark.parametrize("name", MORE)
def test_unused_columns_do_not_reject_a_file(tmp_path, name):
    table = read(tmp_path, MORE[name])
    assert table.time.tolist() == TIMES
    assert table["omega1"].tolist() == SPEEDS


@pytest.mark.parametrize("code", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_texts_in_other_codes_are_read(tmp_path, code):
    table = read(tmp_path, "time [µs],Öl,angle [°]\n0,kühl,90\n1,heiß,180\n".encode(code))
    assert table.time.tolist() == [0.0, 1e-6]
    assert table.converted({"angle": "rad"})["angle"] == pytest.approx([math.pi / 2.0, math.pi])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"PK\x03\x04\0\0", r"cannot read .*table\.csv: not a text file\. Save the table as CSV\.$"),
        ("", r"cannot read .*table\.csv: no headings and no numbers$"),
        ("\n \n", "no headings and no numbers"),
        ("# rig\n", "no headings and no numbers"),
        (
            "0,100\n1,101\n",
            r"table\.csv: missing column 'time'; available: 0, 100 \(headings from line 1\)$",
        ),
        ("Rig\n\ntimes,omega1\n0,1\n", r"missing column 'time'; available: Rig \(headings from line 1\)$"),
        (
            "time,omega1\ns,rpm\nDouble,Double\n0,1\n",
            r"line 3: time must be a finite number \(got 'Double'\)$",
        ),
        ("# a\ntime,omega1\nseconds,rpm\n0,1\n", r"line 3: time must be a finite number \(got 'seconds'\)$"),
        (
            "time [s],omega1\nms,rpm\n0,1\n",
            r"line 2: the unit of time must be s, as in .* \(got ms\)$",
        ),
        ("time,omega1\n0,1\n00:01.5,2\n", r"line 3: time must be a finite number \(got '00:01.5'\)$"),
        (
            "# a\n\ntime,omega1\n# b\n0,1\n\n2,1\n1.5,1\n",
            r"line 8: time must not decrease \(got 1.5 after 2\)$",
        ),
        ("time,time\n0,1\n", r"time must be the name of one column \(got columns 1 and 2\)"),
    ],
)
def test_a_file_without_a_table_over_time_is_rejected_with_the_line(tmp_path, content, words):
    with pytest.raises(TableError, match=words):
        read(tmp_path, content)


def test_requested_column_without_numbers_is_an_error(tmp_path):
    table = read(tmp_path, "# rig\ntime,omega1,x,x\n0,100,1,2\n1,,1,2\n")
    assert table.names == ["time"]
    with pytest.raises(TableError, match=r"table\.csv line 4: omega1 must be a finite number \(got ''\)$"):
        table["omega1"]
    with pytest.raises(
        TableError, match=r"table\.csv: x must be the name of one column \(got columns 3 and 4\)"
    ):
        table["x"]


def test_columns_are_converted_to_the_requested_units():
    table = Result.from_columns({"time": [0.0], "speed": [30.0], "torque": [2.0]}, {"speed": "rpm"})
    turned = table.converted({"speed": "rad/s", "torque": "N.m"})
    assert turned["speed"] == pytest.approx([math.pi])
    assert turned.units == {"time": "s", "speed": "rad/s", "torque": "N.m"}
    assert table["speed"] == [30.0]
    with pytest.raises(TableError, match=r"speed must be in N\.m or a compatible unit: incompatible .*'rpm'"):
        table.converted({"speed": "N.m"})


def test_tables_survive_writing_and_reading_exactly(tmp_path):
    table = Result.from_columns({"time": np.arange(3.0), "x": [0.1, 1 / 3, 1e-300]}, {"x": "kg.m2"})
    read = Result.from_csv(table.to_csv(tmp_path / "table.csv"))
    assert {name: values.tolist() for name, values in read.columns.items()} == {
        name: values.tolist() for name, values in table.columns.items()
    }
    assert read.units == table.units


def test_road_over_distance_is_read_from_a_file_without_time(tmp_path):
    (tmp_path / "road.csv").write_text("distance [km];slope [%]\n0;0\n0,5;4\n")
    of_file = {"load.slope_over_distance.file": str(tmp_path / "road.csv")}
    road = load_scene(example("urban"), of_file).load.slope_over_distance
    assert road.distance == [0.0, 500.0]
    assert road.slope == [0.0, 0.04]
    (tmp_path / "road.csv").write_text("way,slope\n0,0\n")
    with pytest.raises(SceneError, match=r"road\.csv: missing column 'distance'; available: way, slope"):
        load_scene(example("urban"), of_file)
    (tmp_path / "road.csv").write_text("# road\ndistance [kg],slope\n0,0\n")
    words = r"road\.csv line 3: load\.slope_over_distance\.distance .* \(got '0.0 kg'\): incompatible unit"
    with pytest.raises(SceneError, match=words):
        load_scene(example("urban"), of_file)
    (tmp_path / "road.csv").write_text("road 7\n\ndistance,slope\nkm,%\n0,0\n1,2\n0.5,3\n")
    with pytest.raises(SceneError, match=r"road\.csv line 7: distance must not decrease \(got 0.5 after 1\)"):
        load_scene(example("urban"), of_file)
    with pytest.raises(SceneError, match=r"cannot read .*roads.road\.csv: .*\. Write / instead of"):
        load_scene(example("urban"), {"load.slope_over_distance.file": "roads\\road.csv"})


def test_errors_of_the_package_have_a_common_base():
    from inertia_module.fmi.simulate import FmuError

    for kind in (FmuError, TableError, SceneError):
        assert issubclass(kind, InertiaModuleError)
