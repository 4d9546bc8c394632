"""A broken module gets a bad verdict: whatever goes wrong at an extreme, the study sees it."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import pytest
from scenes import REFERENCE

from inertia_module.memory import Module, Refused
from studies.stability.bounds import energy_bound, result_bound, work_bound
from studies.stability.case import LEVELS, Case, Extreme, Segment
from studies.stability.study import chosen_cases, run_study
from studies.stability.table import read_rows, rows_of, write_cases, write_rows
from studies.stability.trial import try_case
from studies.stability.verdict import cause, judge

TABLE = Path(__file__).parents[2] / "docs" / "stability.csv"
LEVEL = next(level for level in LEVELS if level.name == "rigid, event")
SEGMENT = Segment(0.05, REFERENCE["omega1"], REFERENCE["load_torque"])
CASE = Case("ordinary", "bevel", LEVEL, Extreme("R1", {}, (SEGMENT,), split=10))


class Faulty(Module):
    """A module with one fault, which shows in the outputs after each step."""

    def __init__(self, fault):
        super().__init__()
        self.fault = fault

    def advance(self, step_size):
        super().advance(step_size)
        self.fault(self, step_size)


def output(name, value):
    def fault(module, _):
        setattr(module.outputs, name, value)

    return fault


def omega_out_by_step(module, step_size):
    module.outputs.omega_out = step_size


def raises(error):
    def fault(module, _):
        raise error

    return fault


def refuses_short_steps(module, step_size):
    if step_size < 0.01:
        raise Refused("communication step is refused: too short")


def changes_the_state_and_refuses(module, _):
    raise Refused("omega1 is refused: for no reason")


def verdict(fault, case=CASE):
    return judge(try_case(case, lambda: Faulty(fault)))


def test_sound_module_at_ordinary_values_is_exact():
    found = verdict(lambda module, step: None)
    assert (found.outcome, found.reason) == ("exact", "")
    assert 0.0 < found.error < 1e-4


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        (output("input_torque", math.nan), "not finite"),
        (output("imbalance_acceleration_z", math.inf), "not finite"),
        (raises(ZeroDivisionError("float division by zero")), "ZeroDivisionError"),
        (raises(OverflowError("too large")), "OverflowError"),
        (refuses_short_steps, "short steps"),
        (changes_the_state_and_refuses, "changed the state"),
    ],
)
def test_what_is_neither_result_nor_clean_refusal_is_broken(fault, reason):
    found = verdict(fault)
    assert found.outcome == "broken"
    assert reason in found.reason


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        (output("energy_residual", 1.0), "energy residual"),
        (output("omega2", -1e-3), "speed against a freewheel"),
        (output("housing_torque", -1.0), "torque against a freewheel"),
        (output("output_torque", -1.0), "torque against a freewheel"),
        (output("rhs_evaluations", 1e7), "work"),
        (omega_out_by_step, "long against short steps"),
    ],
)
def test_missed_bound_degrades_and_is_named(fault, reason):
    found = verdict(fault)
    assert found.outcome == "degraded"
    assert reason in found.reason


def test_error_that_all_step_sizes_share_shows_against_the_tight_run():
    def fault(module, _):
        module.outputs.energy_out *= 1.0 + 1e5 * module["tolerance"]

    found = verdict(fault)
    assert found.outcome == "degraded"
    assert "error" in found.reason


def test_refusal_at_the_start_is_a_verdict_with_the_reason():
    found = verdict(
        lambda module, step: None,
        replace(CASE, extreme=replace(CASE.extreme, parameters={"link2_inertia": 0.0})),
    )
    assert found.outcome == "refused"
    assert "link2_inertia must be above 0 by more than rounding, is 0" in found.reason
    assert cause(found.reason).startswith("the inertia behind link 2 vanishes")


def test_step_that_is_given_up_is_a_refusal_for_the_module_goes_on():
    segments = (Segment(1e4, 1e6, 1e12),)
    found = judge(try_case(replace(CASE, extreme=Extreme("too long", {}, segments))))
    assert found.outcome == "refused"
    assert "abandoned" in found.reason


def test_bounds_follow_the_tolerance():
    assert energy_bound(1e-8) < 1e-4 * energy_bound(1e-3)
    assert result_bound(1e-9, 0.0) < 1e-4 * result_bound(1e-3, 0.0)
    assert result_bound(1e-6, 1e-3) > 100.0 * result_bound(1e-6, 0.0)
    assert work_bound(CASE, 200.0, 1, 0) < 2.1 * work_bound(CASE, 100.0, 1, 0)


@pytest.mark.parametrize("accuracy", [1e-13, 1e-6, 0.005, 0.02, 0.1])
@pytest.mark.parametrize("sensitivity", [0.0, 1e-6, 1.0, 10.0])
def test_no_bound_is_so_wide_that_a_run_cannot_miss_it(accuracy, sensitivity):
    assert energy_bound(accuracy) <= 0.1
    assert result_bound(accuracy, sensitivity) <= 0.1


def changed_end(trial, **changes):
    """The trial with another end of its tight run, and other fields."""
    end = {**trial.tight.end, "omega_out": trial.tight.end["omega_out"] + 0.5 * trial.tight.speed}
    return replace(trial, tight=replace(trial.tight, end=end), **changes)


@pytest.mark.parametrize("sensitivity, outcome", [(0.0, "degraded"), (0.05, "degraded"), (1.3, "sensitive")])
def test_runs_that_differ_are_sensitive_only_where_no_method_can_tell(sensitivity, outcome):
    trial = changed_end(try_case(CASE), sensitivity=sensitivity)
    found = judge(trial)
    assert found.outcome == outcome
    assert found.error > 0.1
    assert "error" in found.reason


def test_sensitive_motion_does_not_excuse_an_open_energy_balance():
    trial = try_case(CASE)
    leaking = replace(trial.long, residual=0.5 * trial.long.energy)
    assert judge(changed_end(trial, sensitivity=1.3, long=leaking)).outcome == "degraded"


def test_sensitive_motion_on_which_all_runs_agree_is_exact():
    assert judge(replace(try_case(CASE), sensitivity=1.3)).outcome == "exact"


def test_no_cell_of_the_map_is_called_exact_with_an_error_above_a_tenth():
    exact = [cell for row in read_rows(TABLE) for cell in row.cells.values() if cell.outcome == "exact"]
    assert len(exact) > 2000
    assert max(cell.power for cell in exact) <= -1


def test_table_reads_back_as_it_was_written(tmp_path):
    chosen = chosen_cases("output locked")
    rows = rows_of(run_study(chosen[:6]))
    assert read_rows(write_rows(tmp_path / "table.csv", rows)) == rows


def test_every_figure_and_bound_is_written(tmp_path):
    verdicts = run_study([CASE])
    with write_cases(tmp_path / "cases.csv", verdicts).open() as stream:
        (line,) = csv.DictReader(stream)
    for name, figure in verdicts[0].figures.items():
        assert float(line[name]) == figure.value
        assert float(line[f"{name}, bound"]) == figure.bound


def test_unknown_axis_is_refused_with_those_there_are():
    with pytest.raises(
        ValueError, match=r"axis must be one of the map, is weather \(there are input speed, .*\)"
    ):
        chosen_cases("weather")
