"""Levels of fidelity: measured for a scene, recommended, chosen where it says "auto", and printed."""

import dataclasses
import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from refused import assert_refused

from inertia_module.common import files
from inertia_module.common.examples import example
from inertia_module.fidelity import trials
from inertia_module.fidelity.trials import Row, event, recommend, run_in_process, window_errors
from inertia_module.fmi.simulate import Result
from inertia_module.interface.variables import BY_NAME, COMPUTED
from inertia_module.scene import load_scene, run_scene

SCENE = load_scene(example("reference")).replaced(
    mechanism={"fidelity": "auto"},
    load={"kind": "shaft", "torque": None, "inertia": "0.2 kg.m2", "viscous_friction": "0.1 N.m.s/rad"},
    accuracy={"tolerance": None, "error": "2 %", "window": "0.1 s"},
    run={
        "stop_time": "0.2 s",
        "communication_step": "5 ms",
        "outputs": ["omega_out", "output_torque_mean"],
    },
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("measurements")


@pytest.fixture(autouse=True)
def kept(folder, monkeypatch):
    """Measurements of these tests are kept in a folder of their own: each scene is measured once."""

    monkeypatch.setattr(trials, "kept", partial(files.kept, folder=folder))


# --- the scene ---


def test_another_fidelity_can_be_asked_for():
    rigid = SCENE.replaced(mechanism={"fidelity": "kinematic"}).with_fidelity("rigid")
    assert rigid.parameters()["fidelity"] == 2.0
    auto = rigid.with_fidelity("auto", 0.05)
    assert auto.chooses_fidelity
    assert auto.accuracy.error == 0.05
    assert_refused(r"mechanism\.fidelity must be .* .got 'ideal'.", rigid.with_fidelity, "ideal")


def test_a_scene_is_not_run_before_its_fidelity_is_chosen(tmp_path):
    assert_refused("must be a named level .got 'auto'.*Choose one", run_scene, SCENE, tmp_path / "none.fmu")


# --- the levels of fidelity ---


def test_names_that_a_level_lacks_are_those_of_the_module_and_have_a_reason():
    for lacking in trials.NOT_MODELLED.values():
        assert set(lacking) <= set(COMPUTED) <= set(BY_NAME)
    averaged = trials.NOT_MODELLED[1]
    assert "no pulses" in averaged["output_torque"]
    assert "no pinion-shaft angle" in averaged["imbalance_acceleration"]
    assert not {"output_torque_mean", "omega_out"} & averaged.keys()


def test_a_level_takes_the_place_of_the_settings_of_a_scene():
    fixed = {"fidelity": "rigid", "method": "timestepping", "max_step": "0.1 ms"}
    found = trials.at_level(SCENE.replaced(mechanism=fixed), event(2, 1e-6))
    assert found.accuracy.tolerance == 1e-6
    assert not {"method", "max_step"} & found.parameters().keys()


def test_a_driven_mass_is_rigid_with_the_hub_where_there_is_no_shaft():
    shaft = SCENE.replaced(mechanism={"driven_inertia": 0.3, "output_inertia": 0.1})
    rigid = trials.at_level(shaft, event(2, 1e-6))
    assert rigid.parameters()["output_inertia"] == pytest.approx(0.1 + 0.3 + 0.2)
    elastic = trials.at_level(shaft, event(3, 1e-6))
    assert elastic.parameters()["output_inertia"] == 0.1
    assert elastic.parameters()["driven_inertia"] == pytest.approx(0.3 + 0.2)
    assert trials.reference_level(shaft).fidelity == 3
    assert trials.reference_level(SCENE).fidelity == 2


# --- errors over windows ---


@pytest.mark.parametrize(
    "name, ours, exact, window, expected",
    [
        # by the window and not by the instant
        ("omega_out", (2.0, 2.0, 0.0, 0.0), (0.0, 0.0, 2.0, 2.0), 0.4, 0.0),
        ("omega_out", (2.0, 2.0, 0.0, 0.0), (0.0, 0.0, 2.0, 2.0), 0.2, 1.0),
        # what pulses by its RMS too
        ("output_torque", (1.0, 1.0), (3.0, -1.0), 0.2, (math.sqrt(5.0) - 1.0) / 3.0),
        ("output_torque_mean", (1.0, 1.0), (3.0, -1.0), 0.2, 0.0),
        # energies by the energy in; evaluations are a matter of cost
        ("energy_residual", (0.5, 0.5), (0.0, 0.0), 0.2, 0.01),
        ("rhs_evaluations", (9.0, 9.0), (1.0, 1.0), 0.2, 0.0),
    ],
)
def test_errors_are_largest_differences_over_windows(name, ours, exact, window, expected):
    def record(steps):
        values = np.concatenate([[0.0], np.tile(steps, 5)])  # the start, and what is repeated
        time = np.arange(values.size) * 0.1
        columns = {"time": time, "energy_in": np.full(values.size, 50.0), name: values}
        return Result.from_columns({**columns, "omega2": values})

    found = window_errors(record(ours), record(exact), window, 2)
    assert found[name] == pytest.approx(expected)
    assert math.isnan(window_errors(record(ours), record(exact), window, 1)["omega2"])


# --- the choice ---


def test_the_module_in_process_is_the_plant_of_the_same_loop(built):
    rigid = trials.at_level(SCENE, event(2, 1e-8))
    ours = run_in_process(rigid)
    fmu = run_scene(rigid, built / "InertiaModule.fmu").record
    for name in ("omega_out", "output_torque_mean", "load_torque"):
        assert ours[name] == pytest.approx(fmu[name], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("first", ["omega_out", "imbalance_acceleration"])
def test_the_chosen_level_meets_the_error_in_all_outputs_and_has_them(first):
    chosen, choice = trials.choose(SCENE.replaced(run={"outputs": [first, "output_torque_mean"]}))
    assert not chosen.chooses_fidelity
    fidelity = int(chosen.parameters()["fidelity"])
    exact = run_in_process(trials.at_level(SCENE, event(2, 1e-12)))
    errors = window_errors(run_in_process(chosen), exact, 0.1, fidelity)
    assert choice.wanted == (first, "output_torque_mean")
    assert all(errors[name] <= 0.02 for name in choice.wanted)
    assert choice.row.wall_time > 0.0
    assert fidelity == 2 or first == "omega_out"


def test_measurements_are_kept_whatever_error_and_outputs_are_asked_for(monkeypatch):
    first = trials.trial_rows(SCENE)

    def fail(*_):
        raise AssertionError("measured again")

    monkeypatch.setattr(trials, "run_in_process", fail)
    other = SCENE.replaced(accuracy={"error": "3 %"}, run={"outputs": ["output_torque_mean"]})
    again = trials.trial_rows(other)
    assert [row.label for row in again] == [row.label for row in first]
    assert [row.wall_time for row in again] == pytest.approx([row.wall_time for row in first], nan_ok=True)


def test_another_mechanism_is_measured_anew():
    other = SCENE.replaced(mechanism={"imbalance_mass": 2})
    assert trials.measured_from(SCENE) != trials.measured_from(other)


def test_a_scene_is_measured_in_longer_steps_too(monkeypatch):
    levels = list(trials.all_levels(False))[::4]
    monkeypatch.setattr(trials, "all_levels", lambda *_, **__: levels)
    short = SCENE.replaced(run={"stop_time": 0.05})
    rows = trials.measured_rows(short)
    assert {row.communication_step for row in rows} == {0.005, 0.05}
    done = [row for row in rows if not row.failure]
    assert all(row.worst(["omega_out"]) == row.errors["omega_out"] for row in done)
    assert dataclasses.replace(done[0], failure="no").worst(["omega_out"]) == float("inf")


# --- losses ---


def test_level_that_refuses_the_losses_of_a_scene_is_not_chosen():
    refusing = "averaged"
    lossy = SCENE.replaced(mechanism={"windage": 1e-4}, accuracy={"error": "100 %"})
    rows = trials.trial_rows(lossy)
    assert {row.level for row in rows if "must be" in row.failure} == {refusing}
    chosen, choice = trials.choose(lossy)
    assert choice.row.level != refusing
    assert run_in_process(chosen).last()["time"] == pytest.approx(0.2)
    # what refuses and might be cheaper is told with the sentence
    assert any(label.startswith(refusing) for label in choice.passed)


def test_weights_that_averaged_leaves_out_are_in_its_error():
    def averaged(scene):
        (row,) = (row for row in trials.trial_rows(scene) if row.level == "averaged")
        return row.errors["output_torque_mean"]

    assert averaged(SCENE.replaced(mechanism={"gravity": 1000.0})) > 3.0 * averaged(SCENE)


def test_measurements_are_made_anew_where_the_equations_of_losses_change(monkeypatch):
    named = []
    monkeypatch.setattr(trials, "sources", lambda *patterns: named.extend(patterns) or {})
    trials.measured_from(SCENE)
    assert any(Path("kernel/equations/motion.py").match(pattern) for pattern in named)


# --- the recommendation: the cheapest measured level that meets the error, and why ---


def row(fidelity, method, setting, wall_time, evaluations=1.0, failure="", **errors):
    return Row(fidelity, method, setting, 1e-3, errors, wall_time, evaluations, 3.0, failure)


AVERAGED = row("averaged", "", "map", 1.0, omega_out=4e-3, omega2=math.nan)
COARSE = row("rigid", "", "tolerance 1e-01", 2.0, 10.0, omega_out=0.2, omega2=0.3)
FINE = row("rigid", "", "tolerance 1e-02", 5.0, 20.0, omega_out=2e-3, omega2=8e-3)
LOOSE = row("rigid", "", "tolerance 1e-03", 7.8, 50.0, omega_out=1e-4, omega2=5e-4)
TIGHT = row("rigid", "", "tolerance 1e-09", 7.9, 90.0, omega_out=1e-9, omega2=2e-9)
ELASTIC = row("elastic", "", "tolerance 1e-03", 30.0, 50.0, omega_out=1e-5, omega2=1e-5)
BROKEN = row("rigid", "", "tolerance 1", math.nan, math.nan, "tolerance = 1 is refused")
PEER = row("peer", "LSODA", "rtol 1e-9", 0.01, omega_out=0.0, omega2=0.0)
ROWS = [AVERAGED, COARSE, FINE, LOOSE, TIGHT, ELASTIC, BROKEN, PEER]


@pytest.mark.parametrize(
    "error, wanted, expected",
    [
        (1e-2, ["omega_out"], AVERAGED),
        (1e-2, ["omega_out", "omega2"], FINE),
        # met to the digit
        (4e-3, ["omega_out"], AVERAGED),
        (2e-3, ["omega_out"], FINE),
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
    assert "chosen: rigid, tolerance 1e-02: error 0.008 (omega2), requested 0.01" in text
    assert "rejected: averaged, map: it has no pulses, only their mean (omega2)" in text
    assert "rejected: rigid, tolerance 1e-01: error 0.3 (omega2)" in text
    assert (
        "rejected: rigid, tolerance 1: tolerance = 1 is refused"
        in recommend([AVERAGED, BROKEN], 1e-2, ["omega_out"]).lines()
    )
    assert "next level: elastic, tolerance 1e-03: error 1e-05" in text
    assert "6 times the run time" in text


@pytest.mark.parametrize(
    "rows, error, wanted, words",
    [
        (
            ROWS,
            1e-12,
            "omega_out",
            "no fidelity level reaches error = 1e-12 in omega_out; best: .* error 1e-09",
        ),
        ([TIGHT], 1.0, "energy_in", "no reference for energy_in"),
        # what a level does not model comes before what is unknown
        ([TIGHT], 1.0, "energy_in shaft_twist", "it has no elastic shaft"),
        ([PEER], 1.0, "omega_out", "no level was measured"),
    ],
)
def test_an_error_that_none_meets_is_refused_with_the_best(rows, error, wanted, words):
    assert_refused(words, recommend, rows, error, wanted.split())


# --- on a terminal ---

OUTPUTS = (
    *("omega2", "omega_out", "input_torque", "mesh_torque", "output_torque", "housing_torque"),
    *("input_torque_mean", "output_torque_mean", "imbalance_acceleration_x", "contact_mode"),
)
LEVELS = [
    row("averaged", "", "map", 0.1e-3, **dict.fromkeys(OUTPUTS, math.nan)),
    row("rigid", "", "tolerance 1e-03", 1.60e-3, 50.0, **dict.fromkeys(OUTPUTS, 2.4e-5)),
    row("rigid", "", "tolerance 1e-07", 1.58e-3, 90.0, **dict.fromkeys(OUTPUTS, 2.4e-9)),
    row("elastic", "", "tolerance 1e-03", 1.42e-1, 50.0, **dict.fromkeys(OUTPUTS, 2.4e-5)),
]


@pytest.mark.parametrize("wanted", [OUTPUTS[:1], OUTPUTS[:2], OUTPUTS[7:9], OUTPUTS])
def test_trade_has_a_line_for_each_level_and_fits_the_terminal(wanted, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    trials.print_levels("A scene", LEVELS, wanted)
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert not any("…" in line for line in lines)
    for level in ("averaged", "rigid", "elastic"):
        assert sum(line.startswith(level) for line in lines) == 1
    assert any("2.4e-05" in line and "1.6" in line for line in lines)
    assert not any("tolerance 1e-07" in line for line in lines)
    heading = next(" ".join(line.split()) for line in lines if line.startswith("fidelity level"))
    assert heading == "fidelity level setting error maximum in ms per s"
    assert any(wanted[0].split("_")[0] in line and line.rstrip().endswith("1.6") for line in lines)


def test_recommended_level_is_the_fastest_of_those_printed_that_meet_the_error():
    for error in (1e-2, 1e-4, 1e-8):
        printed = trials.at_levels(LEVELS, error, OUTPUTS)
        choice = recommend(LEVELS, error, OUTPUTS)
        meeting = [row for row in printed if row.worst(OUTPUTS) <= error]
        assert choice.row is min(meeting, key=lambda row: row.wall_time)


def test_level_that_does_not_meet_the_error_shows_its_most_accurate_setting():
    printed = trials.at_levels(LEVELS, 1e-12, OUTPUTS)
    assert [row.setting for row in printed if row.fidelity == "rigid"] == ["tolerance 1e-07"]
