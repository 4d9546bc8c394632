"""Test the converged kernel against the independent reference, and the rows of successful and failed runs."""

import dataclasses
import math

import pytest

from benchmarks import trade_off
from inertia_module.fidelity import rows as table
from inertia_module.fidelity.levels import Level, event_level
from inertia_module.fidelity.rows import Row
from inertia_module.fmi.results import write_figure
from inertia_module.model import Module
from inertia_module.plots.fidelity import work_precision
from verification.reference.motion import Reference

CASE = trade_off.Case(stop_time=0.1, points=100)
STEPS = [0.1, 0.01]
LOSSES = {"mesh_efficiency": 0.97, "journal_friction": 1e-3, "housing_drag": 0.1, "gravity": 9.81}
# case, and its minimum number of contact switches
CASES = {
    "bevel": (trade_off.Case(stop_time=0.2, points=20), 20),
    "elastic": (
        trade_off.Case({**trade_off.R1_ELASTIC.parameters, "fidelity": 3}, stop_time=0.2, points=20),
        10,
    ),
    "losses": (trade_off.Case(LOSSES, stop_time=0.1, points=20), 10),
}


@pytest.fixture(scope="module")
def reference():
    return trade_off.converged(CASE)


@pytest.fixture(scope="module")
def rows(reference):
    levels = [event_level(2, tolerance) for tolerance in (1e-4, 1e-6, 1e-8)]
    return trade_off.measure(CASE, reference, levels, steps=STEPS)


def test_every_level_is_measured_with_every_communication_step(rows):
    assert [(row.setting, row.communication_step) for row in rows] == [
        (f"tolerance {tolerance}", step) for step in STEPS for tolerance in ("1e-04", "1e-06", "1e-08")
    ]
    assert all(row.wall_time > 0.0 and row.evaluations > 0 and row.switches > 5 for row in rows)


def test_errors_follow_the_tolerance_and_the_reference_has_zero_error(rows, reference):
    for coarse, fine in ((rows[0], rows[2]), (rows[3], rows[5])):
        for name, error in fine.errors.items():
            assert 0.0 <= error < 1e-6
            assert error < coarse.errors[name] < 1e-2
    assert set(trade_off.errors(reference, reference).values()) == {0.0}


INVALID = [
    (Level(2, "tolerance 1", {"tolerance": 1.0}), 0.1, "tolerance must be between 1e-12 and 0.01 (got 1)"),
    (Level(2, "backwards", {"max_step": -1.0}), 0.1, "max_step must be between 0 and 1000000 s (got -1)"),
    (event_level(2, 1e-6), 0.03, "must be an integer fraction of 0.1 s (got 0.03 s)"),
]


@pytest.fixture(scope="module")
def failed(reference):
    return [trade_off.measure(CASE, reference, [level], steps=[step])[0] for level, step, _ in INVALID]


def test_invalid_settings_and_steps_give_rows_with_the_reason(failed, tmp_path):
    written = table.write_rows(tmp_path / "rows.csv", failed).read_text()
    for row, (_, _, words) in zip(failed, INVALID, strict=True):
        assert words in row.failure
        assert math.isnan(row.wall_time)
        assert row.max_error(["omega_out_final"]) == math.inf
        assert words in written


def test_peers_have_the_same_errors_as_levels(reference):
    def integrator(relative_error):
        return lambda case: dataclasses.replace(
            reference, motion=reference.motion * (1.0 + relative_error), wall_time=0.2
        )

    peers = [("LSODA", "loose", integrator(1e-3)), ("LSODA", "tight", integrator(1e-6))]
    loose, tight = trade_off.measure(CASE, reference, [], peers)
    assert (loose.fidelity, loose.method, loose.setting) == ("peer", "LSODA", "loose")
    assert loose.errors["omega_out_final"] == pytest.approx(1e-3, rel=1e-9)
    assert tight.errors["omega_out_worst"] == pytest.approx(1e-6, rel=1e-6)
    assert loose.wall_time == pytest.approx(2.0)


def test_rigid_level_of_an_elastic_case_has_the_same_total_inertia():
    parameters = {"output_inertia": 0.3, "driven_inertia": 0.2, "shaft_stiffness": 1e7, "shaft_damping": 10.0}
    case = dataclasses.replace(CASE, parameters=parameters)
    (row,) = trade_off.measure(case, trade_off.converged(case), [event_level(2, 1e-8)], steps=[0.1])
    assert row.errors["omega_out_final"] < 1e-3


def test_rows_survive_writing_and_reading(rows, failed, tmp_path):
    *read, last = table.read_rows(table.write_rows(tmp_path / "rows.csv", [*rows, failed[0]]))
    assert read == rows
    assert (last.label, last.failure) == (failed[0].label, failed[0].failure)
    assert last.max_error(["omega_out_worst"]) == math.inf


def test_diagram_shows_successful_runs_by_level(failed, tmp_path):
    errors = {3.0: 1e-3, 1.0: 1e-1, 2.0: 1e-1, 0.5: 0.0}
    measured = [Row("rigid", "", "", 1.0, {"e": e}, cost, 9.0) for cost, e in errors.items()]
    invalid = Row("rigid", "", "", 1.0, {"e": 1e-9}, wall_time=0.1, failure="invalid")
    peers = [Row("peer", f"LSODA, clutch {n}", "", 1.0, {"e": 1e-4}, 5.0, 7.0) for n in (1, 2)]
    figure = work_precision([*measured, invalid, *failed, *peers], ["e"], "some rows")
    times, sides = figure.axes
    for axes, module_costs, peer_costs in (
        (times, [3e3, 1e3, 2e3], [5e3] * 2),
        (sides, [9.0] * 3, [7.0] * 2),
    ):
        assert [line.get_label() for line in axes.lines] == ["rigid", "LSODA"]
        assert [line.get_xdata().tolist() for line in axes.lines] == [module_costs, peer_costs]
        assert axes.lines[0].get_ydata() == pytest.approx([1e-3, 1e-1, 1e-1])
    assert write_figure(tmp_path / "plot.png", figure).stat().st_size > 10_000


@pytest.mark.parametrize("name", CASES)
def test_two_independent_methods_agree_and_switch_at_the_same_times(name):
    case, min_switches = CASES[name]
    parameters = {"fidelity": 2, **case.parameters}
    reference, speeds = Reference(parameters, case.omega1, case.load_torque), []
    for time in case.times:
        reference.advance(time)
        speeds.append(reference.omega_out)
    kernel = trade_off.converged(case)
    assert kernel.omega_out == pytest.approx(speeds, abs=1e-10 * max(speeds))
    assert kernel.switches == len(reference.switches) >= min_switches
    inputs = {"omega1": case.omega1, "load_torque": case.load_torque}
    module, now = Module().start(**parameters, **inputs, tolerance=trade_off.TOLERANCE), 0.0
    for number, switch in enumerate(reference.switches):
        for time, switched in ((switch - 1e-10, number), (switch + 1e-10, number + 1)):
            module.advance(time - now)
            assert module["contact_switches"] == switched
            now = time
