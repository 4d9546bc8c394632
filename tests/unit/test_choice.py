"""The level of fidelity that is recommended: the cheapest measured one that meets the error, and why."""

import json
import math

import pytest

from inertia_module.fidelity.choice import NoneMeets, recommend
from inertia_module.fidelity.levels import Row


def row(fidelity, method, setting, wall_time, evaluations=1.0, failure="", **errors):
    return Row(fidelity, method, setting, 1.0, errors, wall_time, evaluations, None, failure)


AVERAGED = row("averaged", "", "map", 1.0, omega_out=4e-3, omega2=math.nan)
COARSE = row("rigid", "timestepping", "step 10 ms", 2.0, 10.0, omega_out=0.2, omega2=0.3)
FINE = row("rigid", "timestepping", "step 1 ms", 5.0, 100.0, omega_out=2e-3, omega2=8e-3)
LOOSE = row("rigid", "event", "tolerance 1e-03", 8.0, 50.0, omega_out=1e-4, omega2=5e-4)
TIGHT = row("rigid", "event", "tolerance 1e-09", 7.9, 90.0, omega_out=1e-9, omega2=2e-9)
ELASTIC = row("elastic", "event", "tolerance 1e-03", 30.0, 50.0, omega_out=1e-5, omega2=1e-5)
BROKEN = row("rigid", "event", "tolerance 1", math.nan, math.nan, "tolerance = 1 is refused")
PEER = row("peer", "LSODA", "rtol 1e-9", 0.01, omega_out=0.0, omega2=0.0)
ROWS = [AVERAGED, COARSE, FINE, LOOSE, TIGHT, ELASTIC, BROKEN, PEER]


@pytest.mark.parametrize(
    "error, wanted, expected",
    [
        (1e-2, ["omega_out"], AVERAGED),
        (1e-2, ["omega_out", "omega2"], FINE),
        (1e-3, ["omega_out"], LOOSE),
        (1e-6, ["omega_out"], TIGHT),
        (0.5, ["omega2"], COARSE),
        # never a peer
        (1.0, ["omega_out"], AVERAGED),
    ],
)
def test_the_cheapest_that_meets_the_error_is_recommended(error, wanted, expected):
    choice = recommend(ROWS, error, wanted)
    assert choice.row is expected
    assert choice.row.worst(wanted) <= error


def test_next_level_is_the_cheapest_of_a_higher_fidelity_that_meets_the_error_or_much_finer():
    choice = recommend(ROWS, 1e-2, ["omega_out"])
    assert (choice.following, choice.ratio) == (FINE, 5.0)
    assert recommend(ROWS, 1e-3, ["omega_out"]).following is ELASTIC
    rigid = [FINE, LOOSE]
    assert recommend(rigid, 1e-2, ["omega_out"]).following is LOOSE
    assert recommend(rigid, 1e-3, ["omega_out"]).following is None


def test_it_says_what_why_and_what_the_next_would_cost():
    text = "\n".join(recommend(ROWS, 1e-2, ["omega_out", "omega2"]).lines())
    assert "chosen: rigid, timestepping, step 1 ms: error 0.008 (omega2) where 0.01 was asked for" in text
    assert "not enough: averaged, map: it has no pulses, only their mean (omega2)" in text
    assert "not enough: rigid, timestepping, step 10 ms: error 0.3 (omega2)" in text
    assert "not enough: rigid, event, tolerance 1: tolerance = 1 is refused" in text
    assert "next level: elastic, event, tolerance 1e-03: error 1e-05" in text
    assert "6 times as long" in text


def test_it_can_be_written_for_machines():
    found = json.loads(json.dumps(recommend(ROWS, 1e-2, ["omega_out"]).as_dict(), allow_nan=False))
    assert found["chosen"]["fidelity"] == "averaged"
    assert found["next"]["cost"] == 5.0
    assert found["asked"] == {"error": 1e-2, "wanted": ["omega_out"]}


@pytest.mark.parametrize(
    "rows, error, wanted, words",
    [
        (
            ROWS,
            1e-12,
            "omega_out",
            r"1e-12 in omega_out is met by no level of .*tolerance 1e-09: error 1e-09",
        ),
        ([TIGHT], 1.0, "energy_in", "nothing is known of energy_in"),
        # what a level does not model comes before what is unknown
        ([TIGHT], 1.0, "energy_in shaft_twist", "it has no elastic shaft"),
        ([PEER], 1.0, "omega_out", "none was measured"),
    ],
)
def test_an_error_that_none_meets_is_refused_with_the_best(rows, error, wanted, words):
    with pytest.raises(NoneMeets, match=words):
        recommend(rows, error, wanted.split())
