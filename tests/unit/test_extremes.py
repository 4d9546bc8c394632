"""The module at the extremes: each case of the map has the verdict that docs/stability.csv says."""

from pathlib import Path

import pytest

from inertia_module.studies.stability.axes import AXES, cases
from inertia_module.studies.stability.study import run_study
from inertia_module.studies.stability.table import read_rows, rows_of

TABLE = Path(__file__).parents[2] / "docs" / "stability.csv"


def key(row):
    return row.axis, row.value, row.layout


def documented():
    return {key(row): row for row in read_rows(TABLE)}


def extremes(quick):
    """Cases of one extreme on one layout, all rungs together."""
    found = {}
    for axis in AXES:
        for case in cases(axis, quick):
            found.setdefault((axis, case.extreme.value, case.layout), []).append(case)
    return found


QUICK = extremes(quick=True)


@pytest.mark.parametrize("extreme", QUICK, ids=", ".join)
def test_extreme_has_the_documented_verdict_on_every_rung(compiled, extreme):
    (row,) = rows_of(run_study(QUICK[extreme]))
    expected = documented()[extreme].cells
    assert row.cells.keys() == expected.keys()
    differing = {
        name: (str(cell), str(expected[name]))
        for name, cell in row.cells.items()
        if not cell.agrees_with(expected[name])
    }
    assert not differing


def test_every_extreme_is_documented_and_none_is_broken():
    rows = documented()
    assert rows.keys() == extremes(quick=False).keys()
    assert all(cell.word != "broken" for row in rows.values() for cell in row.cells.values())
