"""Test that random machines pass all checks, and that the checks find planted faults."""

import hashlib
import itertools
import json
import math
import tomllib
from pathlib import Path

import pytest
from faulty import faulty, raising, showing

from inertia_module.kernel.codes import ELASTIC, RIGID
from inertia_module.model import Module
from verification.stability import random_motions as campaign
from verification.stability.motion import LEVELS, Metric, Motion, run
from verification.stability.random_motions import REFERENCE, Finding, Row, draw_motion, examine

SEED = 1
EACH, WITH_REFERENCE = 8, 5
RIGID_LEVEL = next(level for level in LEVELS if level.fidelity == RIGID)


def motions(level, count, losses=False):
    """Return the first motions of a seed at this level."""
    drawn = (draw_motion(SEED, number, losses) for number in itertools.count())
    return list(itertools.islice((motion for motion in drawn if motion.level == level), count))


def fixed_failures():
    """Return machines on which something failed, by failure, with the largest number of switching events.

    The file contains the machines and not the seeds, because a change of the draws changes all machines.
    """
    text = Path(__file__).with_name("fixed_failures.toml").read_text(encoding="utf-8")
    for group in tomllib.loads(text)["failures"]:
        for number, machine in enumerate(group["machines"], 1):
            name = f"{group['failure']} {number}"
            marks = pytest.mark.slow if machine.pop("is_slow", False) else ()
            yield pytest.param(Motion.of(machine), group["max_switches"], id=name, marks=marks)


@pytest.mark.parametrize("motion, switches", list(fixed_failures()))
def test_fixed_failures_stay_fixed(compiled, motion, switches):
    finding = examine(motion, lambda: Module(compiled))
    assert not finding.failed, finding.metrics
    assert not finding.rejection
    # The freewheels of these machines do not chatter.
    assert run(motion, lambda: Module(compiled)).points[-1]["contact_switches"] < switches


def test_immediate_stop_of_both_speeds_terminates(compiled):
    (motion, *_) = next(row.values for row in fixed_failures() if row.id.endswith("come to rest at once 1"))
    assert 0.0 < run(motion, lambda: Module(compiled)).evaluations < 3e4


@pytest.mark.parametrize("losses", [False, True], ids=["ideal", "losses"])
@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_random_machines_satisfy_all_checks(compiled, level, losses, monkeypatch):
    monkeypatch.setattr(campaign, "MAX_EVALUATIONS", 3000)
    compared = 0
    for n, motion in enumerate(motions(level, EACH, losses)):
        finding = examine(motion, lambda: Module(compiled), with_reference=n < WITH_REFERENCE)
        assert not finding.failed, (finding.metrics, motion.as_dict())
        assert not finding.rejection or (losses and "self-locking" in finding.rejection), motion.as_dict()
        assert len(finding.metrics) >= 3 or finding.rejection
        compared += REFERENCE in finding.metrics
    assert compared >= 1 or level.fidelity not in (RIGID, ELASTIC)


@pytest.mark.parametrize("losses, digest", [(False, "808215367f5ad801"), (True, "97262800290e7a71")])
def test_seed_and_number_determine_the_machine(losses, digest):
    drawn = [draw_motion(seed, number, losses) for seed in (1, 2) for number in range(50)]
    text = json.dumps([motion.as_dict() for motion in drawn])
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == digest
    assert [Motion.of(motion.as_dict()) for motion in drawn] == drawn


def add_to_the_shaft(module, _):
    module.state.omega3 += 1e-3
    module.outputs.omega_out = module.state.omega3


def lose_digits(module):
    module.state.q *= 1.0 + 1e-12


def less_lost(values):
    return {"mesh_efficiency": 1.0 - 0.999 * (1.0 - values["mesh_efficiency"])}


PULLING = showing(housing_torque=lambda m, _: -1.0 if m["load_torque"] < 0.0 else m["housing_torque"])
REGAINING = showing(energy_lost_journal=lambda m, _: -m["energy_lost_journal"])
DRAGGING = showing(housing_torque=lambda m, _: m["housing_torque"] + m["housing_drag"])
SLOWER_ABOVE_50 = showing(omega_out=lambda m, _: m["omega_out"] * (0.999 if abs(m["omega1"]) > 50.0 else 1.0))


@pytest.mark.parametrize(
    "invariant, parameter, planted",
    [
        ("Th, Tc >= 0", "", PULLING),
        (
            REFERENCE,
            "",
            faulty(change_start=lambda p: {"imbalance_mass": 1.001 * p.get("imbalance_mass", 1.0)}),
        ),
        ("restored state", "", faulty(after_restore=lose_digits)),
        ("long and short steps", "", faulty(add_to_the_shaft)),
        ("speed scaling", "", SLOWER_ABOVE_50),
        ("finite", "", showing(input_torque_mean=math.nan)),
        ("OverflowError: too large", "", raising(OverflowError("too large"))),
        (REFERENCE, "mesh_efficiency", faulty(change_start=less_lost)),
        ("lost energy regained", "journal_friction", REGAINING),
        ("torque or slip is 0", "housing_drag", DRAGGING),
    ],
)
def test_planted_failure_is_found(planted, parameter, invariant):
    chosen = motions(RIGID_LEVEL, 40 if parameter else 12, losses=bool(parameter))
    chosen = [motion for motion in chosen if not parameter or parameter in motion.parameters][:15]
    assert any(invariant in examine(motion, planted, invariant == REFERENCE).failed for motion in chosen)


def test_counts_contain_verdicts_and_errors_of_each_level():
    rows = [
        Row(0, "rigid", "bevel", "speed", "exact", "1.0e-12", ""),
        Row(1, "rigid", "planar", "torque", "degraded", "3.0e-06", REFERENCE),
        Row(2, "rigid", "planar", "torque", "rejected", "", "omega1 must be smaller"),
    ]
    (rigid,) = (row for row in campaign.counts(rows) if row[0] == "rigid")
    assert rigid == ("rigid", 3, 1, 0, 1, 1, 0, 2, "2e-06", "3e-06")


@pytest.mark.parametrize(
    "metric, verdict",
    [
        (Metric(1e-12, 1e-7), "exact"),
        (Metric(1e-6, 1e-5, is_explained=True), "sensitive"),
        (Metric(1.0, math.inf), "sensitive"),
        (Metric(1e-6, 1e-7), "degraded"),
    ],
)
def test_verdict_depends_on_error_and_sensitivity(metric, verdict):
    assert Finding({REFERENCE: metric}).verdict == verdict


def test_rows_read_back(tmp_path):
    rows = [Row(0, "rigid", "bevel", "speed", "exact", "1.0e-12", "")]
    assert campaign.read_rows(campaign.write_rows(tmp_path / "random.csv", rows)) == rows
