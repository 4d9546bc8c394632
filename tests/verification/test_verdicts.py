"""Test that the study gives a module with a planted fault a bad verdict and names the fault."""

import math
from dataclasses import replace

import pytest
from faulty import faulty, raising, showing
from scenes import REFERENCE

from inertia_module.common.errors import ParameterError
from inertia_module.kernel import engine
from inertia_module.model import Module
from verification.stability import verdicts
from verification.stability.extremes import Case
from verification.stability.motion import LEVELS, Motion, Run, Segment

LEVEL = next(level for level in LEVELS if level.name == "rigid")
SEGMENT = Segment(0.05, REFERENCE["omega1"], REFERENCE["load_torque"])
CASE = Case("ordinary", "R1", "bevel", Motion(LEVEL.values, (SEGMENT,)), split=10)


def reject_short_steps(module, step_size):
    if step_size < 0.01:
        raise ParameterError("communication step is rejected: too short")


@pytest.fixture(scope="module")
def sound():
    """Return the trial of a sound module."""
    return verdicts.try_case(CASE)


def test_sound_module_at_ordinary_values_is_exact(sound):
    verdict = verdicts.judge(sound)
    assert (verdict.outcome, verdict.reason) == ("exact", "")
    assert 0.0 < verdict.error < 1e-4


@pytest.mark.parametrize(
    "planted, outcome, reason",
    [
        # Neither a result nor a valid rejection
        (showing(input_torque=math.nan), "broken", "not finite"),
        (showing(imbalance_acceleration_z=math.inf), "broken", "not finite"),
        (raising(ZeroDivisionError("float division by zero")), "broken", "ZeroDivisionError"),
        (raising(OverflowError("too large")), "broken", "OverflowError"),
        (faulty(reject_short_steps), "broken", "short steps"),
        (raising(ParameterError("omega1 is rejected: for no reason")), "broken", "changed the state"),
        # A violated bound, which the verdict names
        (showing(energy_residual=1.0), "degraded", "energy residual"),
        (showing(omega2=-1e-3), "degraded", "0 <= omega2 <= omega3"),
        (showing(housing_torque=-1.0), "degraded", "Th, Tc >= 0"),
        (showing(output_torque=-1.0), "degraded", "Th, Tc >= 0"),
        (showing(rhs_evaluations=1e7), "degraded", "work"),
        (showing(omega_out=lambda module, step: step), "degraded", "long against short steps"),
        # An error of all step sizes, which only the tightened run shows
        (
            showing(energy_out=lambda m, _: m["energy_out"] * (1.0 + 1e5 * m["tolerance"])),
            "degraded",
            "error",
        ),
    ],
)
def test_verdict_names_the_planted_fault(planted, outcome, reason):
    verdict = verdicts.judge(verdicts.try_case(CASE, planted))
    assert verdict.outcome == outcome
    assert reason in verdict.reason


def test_rejection_is_a_verdict_with_its_reason(monkeypatch):
    at_start = verdicts.judge(verdicts.try_case(replace(CASE, motion=CASE.motion.changed(link2_inertia=0.0))))
    assert at_start.outcome == "rejected"
    assert "link2_inertia must be above 1e-12 of the maximum " in at_start.reason
    assert verdicts.cause(at_start.reason).startswith("The inertia at link 2 vanishes")
    # After a rejected step the module continues; a small limit of evaluations in plain Python makes it fast
    monkeypatch.setattr(engine, "MAX_EVALUATIONS", 1e4)
    too_long = Motion(LEVEL.values, (Segment(1e4, 1e5, 1e7),))
    rejected = verdicts.judge(verdicts.try_case(replace(CASE, motion=too_long), lambda: Module("plain")))
    assert rejected.outcome == "rejected"
    assert "requires more than 5e7 right-hand-side evaluations" in rejected.reason


def test_bounds_scale_with_the_tolerance_and_have_a_maximum():
    assert verdicts.energy_bound(1e-8) < 1e-4 * verdicts.energy_bound(1e-3)
    assert verdicts.result_bound(1e-9, 0.0) < 1e-4 * verdicts.result_bound(1e-3, 0.0)
    assert verdicts.result_bound(1e-6, 1e-3) > 100.0 * verdicts.result_bound(1e-6, 0.0)
    more, less = (verdicts.work_bound(CASE, Run(phase=phase, steps=1)) for phase in (200.0, 100.0))
    assert more < 2.1 * less
    for accuracy in (1e-13, 1e-6, 0.005, 0.02, 0.1):
        assert verdicts.energy_bound(accuracy) <= 0.1
        assert all(
            verdicts.result_bound(accuracy, sensitivity) <= 0.1 for sensitivity in (0.0, 1e-6, 1.0, 10.0)
        )


def changed_end(trial, **changes):
    """Return the trial with another end of its tight run, and other fields."""
    end = {**trial.tight.end, "omega_out": trial.tight.end["omega_out"] + 0.5 * trial.tight.speed}
    return replace(trial, tight=replace(trial.tight, end=end), **changes)


@pytest.mark.parametrize("sensitivity, outcome", [(0.0, "degraded"), (0.05, "degraded"), (1.3, "sensitive")])
def test_runs_that_differ_are_sensitive_only_if_the_motion_is(sound, sensitivity, outcome):
    verdict = verdicts.judge(changed_end(sound, sensitivity=sensitivity))
    assert verdict.outcome == outcome
    assert verdict.error > 0.1
    assert "error" in verdict.reason


def test_sensitive_motion_is_exact_if_all_runs_agree_and_must_satisfy_the_energy_balance(sound):
    assert verdicts.judge(replace(sound, sensitivity=1.3)).outcome == "exact"
    leaking = replace(sound.long, residual=0.5 * sound.long.energy)
    assert verdicts.judge(changed_end(sound, sensitivity=1.3, long=leaking)).outcome == "degraded"


def test_the_table_reads_back(tmp_path):
    rows = verdicts.rows_of(verdicts.run_study(verdicts.chosen_cases("output locked")[:6]))
    assert verdicts.read_rows(verdicts.write_rows(tmp_path / "table.csv", rows)) == rows
