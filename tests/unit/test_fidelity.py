"""Test fidelity levels: measurements, choice of a level, printed table."""

import dataclasses
import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from rejected import assert_rejected

from inertia_module.common import files
from inertia_module.common.examples import example
from inertia_module.fidelity import levels, measure
from inertia_module.fidelity.choice import best_rows, choose, recommend
from inertia_module.fidelity.level_table import print_levels
from inertia_module.fidelity.levels import at_level, event_level
from inertia_module.fidelity.measure import run_in_process, window_errors
from inertia_module.fidelity.rows import Row
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
def cache(folder, monkeypatch):
    """Store the measurements of these tests in their own folder, so that each scene is measured once."""
    monkeypatch.setattr(measure, "cached", partial(files.cached, folder=folder))


# --- the scene ---


def test_fidelity_of_a_scene_can_be_replaced():
    rigid = SCENE.replaced(mechanism={"fidelity": "kinematic"}).with_fidelity("rigid")
    assert rigid.parameters()["fidelity"] == 2.0
    auto = rigid.with_fidelity("auto", 0.05)
    assert auto.chooses_fidelity
    assert auto.accuracy.error == 0.05
    assert_rejected(r"mechanism\.fidelity must be .* .got 'ideal'.", rigid.with_fidelity, "ideal")


def test_scene_with_fidelity_auto_cannot_run(tmp_path):
    assert_rejected("must be a named level .got 'auto'.*Choose one", run_scene, SCENE, tmp_path / "none.fmu")


# --- the levels of fidelity ---


def test_outputs_that_a_level_does_not_model_are_outputs_of_the_module_with_a_reason():
    for outputs in levels.NOT_MODELLED.values():
        assert set(outputs) <= set(COMPUTED) <= set(BY_NAME)
    averaged = levels.NOT_MODELLED[1]
    assert "no pulses" in averaged["output_torque"]
    assert "no pinion-shaft angle" in averaged["imbalance_acceleration"]
    assert not {"output_torque_mean", "omega_out"} & averaged.keys()


def test_level_replaces_the_settings_of_a_scene():
    fixed = {"fidelity": "rigid", "method": "timestepping", "max_step": "0.1 ms"}
    scene = at_level(SCENE.replaced(mechanism=fixed), event_level(2, 1e-6))
    assert scene.accuracy.tolerance == 1e-6
    assert not {"method", "max_step"} & scene.parameters().keys()


def test_driven_mass_is_rigid_with_the_hub_at_level_rigid():
    shaft = SCENE.replaced(mechanism={"driven_inertia": 0.3, "output_inertia": 0.1})
    rigid = at_level(shaft, event_level(2, 1e-6))
    assert rigid.parameters()["output_inertia"] == pytest.approx(0.1 + 0.3 + 0.2)
    elastic = at_level(shaft, event_level(3, 1e-6))
    assert elastic.parameters()["output_inertia"] == 0.1
    assert elastic.parameters()["driven_inertia"] == pytest.approx(0.3 + 0.2)
    assert levels.reference_level(shaft).fidelity == 3
    assert levels.reference_level(SCENE).fidelity == 2


# --- errors over windows ---


@pytest.mark.parametrize(
    "name, values, exact, window, expected",
    [
        # Averages of windows, not instantaneous values.
        ("omega_out", (2.0, 2.0, 0.0, 0.0), (0.0, 0.0, 2.0, 2.0), 0.4, 0.0),
        ("omega_out", (2.0, 2.0, 0.0, 0.0), (0.0, 0.0, 2.0, 2.0), 0.2, 1.0),
        # RMS of a pulsing output
        ("output_torque", (1.0, 1.0), (3.0, -1.0), 0.2, (math.sqrt(5.0) - 1.0) / 3.0),
        ("output_torque_mean", (1.0, 1.0), (3.0, -1.0), 0.2, 0.0),
        # Energies are relative to the input energy; evaluations measure cost, not accuracy.
        ("energy_residual", (0.5, 0.5), (0.0, 0.0), 0.2, 0.01),
        ("rhs_evaluations", (9.0, 9.0), (1.0, 1.0), 0.2, 0.0),
    ],
)
def test_errors_are_maximum_differences_over_windows(name, values, exact, window, expected):
    def record(steps):
        values = np.concatenate([[0.0], np.tile(steps, 5)])  # The start value, then the repeated steps.
        time = np.arange(values.size) * 0.1
        columns = {"time": time, "energy_in": np.full(values.size, 50.0), name: values}
        return Result.from_columns({**columns, "omega2": values})

    errors = window_errors(record(values), record(exact), window, 2)
    assert errors[name] == pytest.approx(expected)
    assert math.isnan(window_errors(record(values), record(exact), window, 1)["omega2"])


# --- the choice ---


def test_run_in_memory_equals_the_run_of_the_fmu(built):
    rigid = at_level(SCENE, event_level(2, 1e-8))
    record = run_in_process(rigid)
    fmu = run_scene(rigid, built / "InertiaModule.fmu").record
    for name in ("omega_out", "output_torque_mean", "load_torque"):
        assert record[name] == pytest.approx(fmu[name], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("first", ["omega_out", "imbalance_acceleration"])
def test_chosen_level_meets_the_error_in_all_outputs(first):
    chosen, choice = choose(SCENE.replaced(run={"outputs": [first, "output_torque_mean"]}))
    assert not chosen.chooses_fidelity
    fidelity = int(chosen.parameters()["fidelity"])
    exact = run_in_process(at_level(SCENE, event_level(2, 1e-12)))
    errors = window_errors(run_in_process(chosen), exact, 0.1, fidelity)
    assert choice.outputs == (first, "output_torque_mean")
    assert all(errors[name] <= 0.02 for name in choice.outputs)
    assert choice.row.wall_time > 0.0
    assert fidelity == 2 or first == "omega_out"


def test_measurements_are_cached_for_every_error_and_all_outputs(monkeypatch):
    first = measure.trial_rows(SCENE)

    def fail(*_):
        raise AssertionError("measured again")

    monkeypatch.setattr(measure, "run_in_process", fail)
    other = SCENE.replaced(accuracy={"error": "3 %"}, run={"outputs": ["output_torque_mean"]})
    second = measure.trial_rows(other)
    assert [row.label for row in second] == [row.label for row in first]
    assert [row.wall_time for row in second] == pytest.approx([row.wall_time for row in first], nan_ok=True)


def test_measurements_depend_on_the_mechanism():
    other = SCENE.replaced(mechanism={"imbalance_mass": 2})
    assert measure.dependencies(SCENE) != measure.dependencies(other)


def test_failed_run_has_an_infinite_error():
    rows = [row for row in measure.trial_rows(SCENE) if not row.failure]
    assert all(row.max_error(["omega_out"]) == row.errors["omega_out"] for row in rows)
    assert dataclasses.replace(rows[0], failure="no").max_error(["omega_out"]) == float("inf")


# --- losses ---


def test_level_that_rejects_the_losses_of_a_scene_is_not_chosen():
    lossy = SCENE.replaced(mechanism={"windage": 1e-4}, accuracy={"error": "100 %"})
    rows = measure.trial_rows(lossy)
    assert {row.level for row in rows if "must be" in row.failure} == {"averaged"}
    chosen, choice = choose(lossy)
    assert choice.row.level != "averaged"
    assert run_in_process(chosen).last()["time"] == pytest.approx(0.2)
    assert any(label.startswith("averaged") for label in choice.rejections)


def test_error_of_averaged_includes_ignored_weights():
    def averaged(scene):
        (row,) = (row for row in measure.trial_rows(scene) if row.level == "averaged")
        return row.errors["output_torque_mean"]

    assert averaged(SCENE.replaced(mechanism={"gravity": 1000.0})) > 3.0 * averaged(SCENE)


def test_measurements_depend_on_the_equations_of_losses(monkeypatch):
    patterns = []
    monkeypatch.setattr(measure, "sources", lambda *names: patterns.extend(names) or {})
    measure.dependencies(SCENE)
    assert any(Path("kernel/equations/motion.py").match(pattern) for pattern in patterns)


# --- recommendation: the cheapest measured level that meets the error, with reasons ---


def row(fidelity, method, setting, wall_time, evaluations=1.0, failure="", **errors):
    return Row(fidelity, method, setting, 1e-3, errors, wall_time, evaluations, 3.0, failure)


AVERAGED = row("averaged", "", "map", 1.0, omega_out=4e-3, omega2=math.nan)
COARSE = row("rigid", "", "tolerance 1e-01", 2.0, 10.0, omega_out=0.2, omega2=0.3)
FINE = row("rigid", "", "tolerance 1e-02", 5.0, 20.0, omega_out=2e-3, omega2=8e-3)
LOOSE = row("rigid", "", "tolerance 1e-03", 7.8, 50.0, omega_out=1e-4, omega2=5e-4)
TIGHT = row("rigid", "", "tolerance 1e-09", 7.9, 90.0, omega_out=1e-9, omega2=2e-9)
ELASTIC = row("elastic", "", "tolerance 1e-03", 30.0, 50.0, omega_out=1e-5, omega2=1e-5)
BROKEN = row("rigid", "", "tolerance 1", math.nan, math.nan, "tolerance = 1 is invalid")
PEER = row("peer", "LSODA", "rtol 1e-9", 0.01, omega_out=0.0, omega2=0.0)
ROWS = [AVERAGED, COARSE, FINE, LOOSE, TIGHT, ELASTIC, BROKEN, PEER]


@pytest.mark.parametrize(
    "error, outputs, expected",
    [
        (1e-2, ["omega_out"], AVERAGED),
        (1e-2, ["omega_out", "omega2"], FINE),
        # The error equals the limit.
        (4e-3, ["omega_out"], AVERAGED),
        (2e-3, ["omega_out"], FINE),
        (1e-3, ["omega_out"], LOOSE),
        (1e-6, ["omega_out"], TIGHT),
        (0.5, ["omega2"], COARSE),
        # Peers are never recommended.
        (1.0, ["omega_out"], AVERAGED),
    ],
)
def test_cheapest_level_that_meets_the_error_is_recommended(error, outputs, expected):
    choice = recommend(ROWS, error, outputs)
    assert choice.row is expected
    assert choice.row.max_error(outputs) <= error


def test_next_level_has_a_higher_fidelity_or_a_tenth_of_the_error():
    choice = recommend(ROWS, 1e-2, ["omega_out"])
    assert (choice.next_row, choice.ratio) == (FINE, 5.0)
    assert recommend(ROWS, 1e-3, ["omega_out"]).next_row is ELASTIC
    rigid = [FINE, LOOSE]
    assert recommend(rigid, 1e-2, ["omega_out"]).next_row is LOOSE
    assert recommend(rigid, 1e-3, ["omega_out"]).next_row is None
    half = row("rigid", "", "tolerance 5e-03", 6.0, 30.0, omega_out=1e-3)
    assert recommend([FINE, half], 1e-2, ["omega_out"]).next_row is None


def test_choice_prints_reasons_and_the_cost_of_the_next_level():
    text = "\n".join(recommend(ROWS, 1e-2, ["omega_out", "omega2"]).lines())
    assert "chosen: rigid, tolerance 1e-02: error 0.008 (omega2), requested 0.01" in text
    assert "rejected: averaged, map: it has no pulses, only their mean (omega2)" in text
    assert "rejected: rigid, tolerance 1e-01: error 0.3 (omega2)" in text
    assert (
        "rejected: rigid, tolerance 1: tolerance = 1 is invalid"
        in recommend([AVERAGED, BROKEN], 1e-2, ["omega_out"]).lines()
    )
    assert "next level: elastic, tolerance 1e-03: error 1e-05" in text
    assert "6 times the run time" in text


@pytest.mark.parametrize(
    "rows, error, outputs, words",
    [
        (
            ROWS,
            1e-12,
            "omega_out",
            "no fidelity level reaches error = 1e-12 in omega_out; best: .* error 1e-09",
        ),
        ([TIGHT], 1.0, "energy_in", "no reference for energy_in"),
        # Outputs that are not modelled precede outputs without a reference.
        ([TIGHT], 1.0, "energy_in shaft_twist", "it has no elastic shaft"),
        ([PEER], 1.0, "omega_out", "no level was measured"),
    ],
)
def test_unreachable_error_is_rejected_with_the_best_level(rows, error, outputs, words):
    assert_rejected(words, recommend, rows, error, outputs.split())


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


@pytest.mark.parametrize("outputs", [OUTPUTS[:1], OUTPUTS[:2], OUTPUTS[7:9], OUTPUTS])
def test_table_has_a_line_for_each_level_and_fits_the_terminal(outputs, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    print_levels("A scene", LEVELS, outputs)
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert not any("…" in line for line in lines)
    for level in ("averaged", "rigid", "elastic"):
        assert sum(line.startswith(level) for line in lines) == 1
    assert any("2.4e-05" in line and "1.6" in line for line in lines)
    assert not any("tolerance 1e-07" in line for line in lines)
    heading = next(" ".join(line.split()) for line in lines if line.startswith("fidelity level"))
    assert heading == "fidelity level setting error maximum in ms per s"
    assert any(outputs[0].split("_")[0] in line and line.rstrip().endswith("1.6") for line in lines)


def test_recommended_level_is_the_fastest_printed_level_that_meets_the_error():
    for error in (1e-2, 1e-4, 1e-8):
        printed = best_rows(LEVELS, error, OUTPUTS)
        choice = recommend(LEVELS, error, OUTPUTS)
        meeting = [row for row in printed if row.max_error(OUTPUTS) <= error]
        assert choice.row is min(meeting, key=lambda row: row.wall_time)


def test_level_that_does_not_meet_the_error_shows_its_most_accurate_setting():
    printed = best_rows(LEVELS, 1e-12, OUTPUTS)
    assert [row.setting for row in printed if row.fidelity == "rigid"] == ["tolerance 1e-07"]
