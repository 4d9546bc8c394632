"""The converged kernel agrees with the independent reference; a run has errors, a cost, or why it failed."""

import dataclasses
import math

import pytest

from inertia_module.fidelity import trials
from inertia_module.fidelity.trials import Level, Row, event
from inertia_module.fmi.results import write_figure
from inertia_module.model import Module
from verification import trade
from verification.reference.motion import Reference

CASE = trade.Case(stop_time=0.1, points=100)
STEPS = [0.1, 0.01]
LOSSES = {"mesh_efficiency": 0.97, "journal_friction": 1e-3, "housing_drag": 0.1, "gravity": 9.81}
# the case, and how many switches of the freewheels it has at least
CASES = {
    "bevel": (trade.Case(stop_time=0.2, points=20), 20),
    "elastic": (trade.Case({**trade.R1_ELASTIC.parameters, "fidelity": 3}, stop_time=0.2, points=20), 10),
    "losses": (trade.Case(LOSSES, stop_time=0.1, points=20), 10),
}


@pytest.fixture(scope="module")
def reference():
    return trade.converged(CASE)


@pytest.fixture(scope="module")
def rows(reference):
    levels = [event(2, tolerance) for tolerance in (1e-4, 1e-6, 1e-8)]
    return trade.measure(CASE, reference, levels, steps=STEPS)


def test_every_level_is_measured_in_every_communication_step(rows):
    assert [(row.setting, row.communication_step) for row in rows] == [
        (f"tolerance {tolerance}", step) for step in STEPS for tolerance in ("1e-04", "1e-06", "1e-08")
    ]
    assert all(row.wall_time > 0.0 and row.evaluations > 0 and row.switches > 5 for row in rows)


def test_errors_follow_the_tolerance_and_the_reference_has_none_against_itself(rows, reference):
    for coarse, fine in ((rows[0], rows[2]), (rows[3], rows[5])):
        for name, least in fine.errors.items():
            assert 0.0 <= least < 1e-6
            assert least < coarse.errors[name] < 1e-2
    assert set(trade.errors(reference, reference).values()) == {0.0}


REFUSED = [
    (Level(2, "tolerance 1", {"tolerance": 1.0}), 0.1, "tolerance must be between 1e-12 and 0.01 (got 1)"),
    (Level(2, "backwards", {"max_step": -1.0}), 0.1, "max_step must be between 0 and 1000000 s (got -1)"),
    (event(2, 1e-6), 0.03, "must be an integer fraction of 0.1 s (got 0.03 s)"),
]


@pytest.fixture(scope="module")
def failed(reference):
    return [trade.measure(CASE, reference, [level], steps=[step])[0] for level, step, _ in REFUSED]


def test_refused_settings_and_steps_are_rows_with_the_reason(failed, tmp_path):
    written = trials.write_rows(tmp_path / "rows.csv", failed).read_text()
    for row, (_, _, words) in zip(failed, REFUSED, strict=True):
        assert words in row.failure
        assert math.isnan(row.wall_time)
        assert row.worst(["omega_out_final"]) == math.inf
        assert words in written


def test_peers_are_measured_by_the_same_errors(reference):
    def off_by(share):
        return lambda case: dataclasses.replace(
            reference, motion=reference.motion * (1.0 + share), wall_time=0.2
        )

    peers = [("somebody", "loose", off_by(1e-3)), ("somebody", "tight", off_by(1e-6))]
    loose, tight = trade.measure(CASE, reference, [], peers)
    assert (loose.fidelity, loose.method, loose.setting) == ("peer", "somebody", "loose")
    assert loose.errors["omega_out_final"] == pytest.approx(1e-3, rel=1e-9)
    assert tight.errors["omega_out_worst"] == pytest.approx(1e-6, rel=1e-6)
    assert loose.wall_time == pytest.approx(2.0)


def test_a_rigid_output_is_measured_against_the_elastic_one_with_the_same_inertia():
    parameters = {"output_inertia": 0.3, "driven_inertia": 0.2, "shaft_stiffness": 1e7, "shaft_damping": 10.0}
    case = dataclasses.replace(CASE, parameters=parameters)
    (row,) = trade.measure(case, trade.converged(case), [event(2, 1e-8)], steps=[0.1])
    assert row.errors["omega_out_final"] < 1e-3


def test_rows_are_read_back_as_they_were_written(rows, failed, tmp_path):
    *found, last = trials.read_rows(trials.write_rows(tmp_path / "rows.csv", [*rows, failed[0]]))
    assert found == rows
    assert (last.label, last.failure) == (failed[0].label, failed[0].failure)
    assert last.worst(["omega_out_worst"]) == math.inf


def test_plots_show_all_runs_by_level_but_those_that_failed(failed, tmp_path):
    errors = {3.0: 1e-3, 1.0: 1e-1, 2.0: 1e-1, 0.5: 0.0}
    measured = [Row("rigid", "", "", 1.0, {"e": e}, cost, 9.0) for cost, e in errors.items()]
    refused = Row("rigid", "", "", 1.0, {"e": 1e-9}, wall_time=0.1, failure="refused")
    peers = [Row("peer", f"LSODA, clutch {n}", "", 1.0, {"e": 1e-4}, 5.0, 7.0) for n in (1, 2)]
    figure = trials.work_precision([*measured, refused, *failed, *peers], ["e"], "some rows")
    times, sides = figure.axes
    for drawn, ours, theirs in ((times, [3e3, 1e3, 2e3], [5e3] * 2), (sides, [9.0] * 3, [7.0] * 2)):
        assert [line.get_label() for line in drawn.lines] == ["rigid", "LSODA"]
        assert [line.get_xdata().tolist() for line in drawn.lines] == [ours, theirs]
        assert drawn.lines[0].get_ydata() == pytest.approx([1e-3, 1e-1, 1e-1])
    assert write_figure(tmp_path / "plot.png", figure).stat().st_size > 10_000


@pytest.mark.parametrize("name", CASES)
def test_two_independent_methods_agree_and_switch_at_the_same_times(name):
    case, least = CASES[name]
    parameters = {"fidelity": 2, **case.parameters}
    second, speeds = Reference(parameters, case.omega1, case.load_torque), []
    for time in case.times:
        second.advance(time)
        speeds.append(second.omega_out)
    first = trade.converged(case)
    assert first.omega_out == pytest.approx(speeds, abs=1e-10 * max(speeds))
    assert first.switches == len(second.switches) >= least
    inputs = {"omega1": case.omega1, "load_torque": case.load_torque}
    module, now = Module().start(**parameters, **inputs, tolerance=trade.TOLERANCE), 0.0
    for number, switch in enumerate(second.switches):
        for time, switched in ((switch - 1e-10, number), (switch + 1e-10, number + 1)):
            module.advance(time - now)
            assert module["contact_switches"] == switched
            now = time
