"""Test journals of results that survive a killed process, and their tables."""

import csv
import math

import pytest
from rejected import assert_rejected

from inertia_module.studies.evaluation import Batch, Evaluator, Row, Task, write_tables

pytest.importorskip("distributed")
ROWS = [
    Row({"drive.omega1": 10.0}, {"energy_in": 0.1 + 0.2, "efficiency": 1.0}, 1e-3),
    Row({"drive.omega1": 20.0}, {}, 2e-3, "the module says no"),
    Row({"drive.omega1": 30.0}, {"energy_in": 5.0}, math.pi),
]
POINTS = [row.point for row in ROWS]


def evaluator(folder, name="one"):
    return Evaluator(Task(b"", {"name": name}, None), folder)


def test_stored_rows_are_exact_and_a_truncated_row_is_missing(tmp_path):
    first = evaluator(tmp_path)
    first.add_batch(Batch(ROWS[:1], {"energy_in": "J"}))
    first.add_batch(Batch(ROWS[1:2], {}))
    assert evaluator(tmp_path)(POINTS[:2]) == ROWS[:2]
    first.path.write_bytes(first.path.read_bytes()[:-5])
    again = evaluator(tmp_path)
    assert again.units == {"energy_in": "J"}
    assert again.missing([*POINTS, *POINTS]) == POINTS[1:]
    again.add_batch(Batch(ROWS[1:], {}))
    assert evaluator(tmp_path)(POINTS) == ROWS


def test_results_of_another_task_are_not_mixed_in(tmp_path):
    evaluator(tmp_path)
    assert_rejected("another scene", evaluator, tmp_path, "other")


def test_tables_have_units_and_omit_missing_columns(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    files = write_tables(tmp_path, "sweep", ROWS, {"energy_in": "J", "drive.omega1": "rad/s"})
    table = parquet.read_table(files["parquet"])
    assert table.column_names == ["drive.omega1", "energy_in", "efficiency", "cost", "refused"]
    assert table["energy_in"].to_pylist() == [0.1 + 0.2, None, 5.0]
    assert table.schema.field("energy_in").metadata == {b"unit": b"J"}
    heading, *lines = csv.reader(files["csv"].open())
    assert heading == ["drive.omega1 [rad/s]", "energy_in [J]", "efficiency", "cost [s]", "refused"]
    assert lines[1] == ["20.0", "", "", "0.002", "the module says no"]
    assert float(lines[0][1]) == 0.1 + 0.2
