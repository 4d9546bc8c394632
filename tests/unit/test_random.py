"""Random motions hold all invariants; where a module does not, that is found and made small."""

import itertools
import json
import math

import pytest
from random_found import FOUND

from inertia_module.common.errors import Refused
from inertia_module.kernel.codes import ELASTIC, EVENT, KINEMATIC, RIGID
from inertia_module.memory import Module
from studies.stability import random_checks, random_study
from studies.stability.case import LEVELS, Segment
from studies.stability.random_checks import (
    AS_TORQUE,
    REFERENCE,
    VIRTUAL_WORK,
    Finding,
    examine,
)
from studies.stability.random_motions import FRICTIONS, Motion, draw_motion
from studies.stability.random_outcomes import Outcome, as_line, read_outcomes
from studies.stability.random_study import (
    cause,
    findings,
    rows_of,
    run_random,
    shrunk,
    try_number,
)
from studies.stability.verdict import Figure

SEED = 1
EACH, WITH_REFERENCE = 30, 4
RIGID_EVENT = next(level for level in LEVELS if (level.fidelity, level.method) == (RIGID, EVENT))


@pytest.mark.parametrize("found", FOUND)
def test_what_was_found_stays_mended(kernel, found):
    parameters, segments = FOUND[found]
    motion = Motion(parameters, tuple(Segment(*segment) for segment in segments))
    finding = examine(motion, lambda: Module(kernel), without_reference=kernel == "plain")
    assert not finding.failed, finding.figures
    assert not finding.refused


def motions(level, count, losses=False):
    """The first motions of a seed at this level."""
    drawn = (draw_motion(SEED, number, losses) for number in itertools.count())
    return list(itertools.islice((motion for motion in drawn if motion.level == level), count))


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_random_motions_hold_all_invariants(compiled, level, monkeypatch):
    monkeypatch.setattr(random_checks, "MOST_EVALUATIONS", 3000)
    for n, motion in enumerate(motions(level, EACH if compiled == "compiled" else 2)):
        finding = examine(motion, lambda: Module(compiled), without_reference=n >= WITH_REFERENCE)
        assert not finding.failed, (finding.figures, motion.as_dict())
        assert not finding.refused, motion.as_dict()
        assert len(finding.figures) >= 3


def test_motion_is_that_of_its_seed_and_number_and_of_its_dictionary():
    motion = draw_motion(SEED, 7)
    assert draw_motion(SEED, 7) == motion != draw_motion(SEED, 8)
    assert draw_motion(SEED + 1, 7) != motion
    assert Motion.of(motion.as_dict()) == motion


def test_share_of_the_motions_has_friction_but_none_averaged():
    drawn = [draw_motion(SEED, number) for number in range(400)]
    rough = [motion for motion in drawn if any(motion[name] for name in FRICTIONS)]
    assert 0.15 < len(rough) / len(drawn) < 0.35
    assert {motion.level.fidelity for motion in rough} == {KINEMATIC, RIGID, ELASTIC}
    for name in FRICTIONS:
        assert any(motion[name] > 0.0 for motion in rough)


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_random_motions_with_losses_hold_all_invariants(compiled, level, monkeypatch):
    monkeypatch.setattr(random_checks, "MOST_WITH_LOSSES", 3000)
    drawn = ((number, draw_motion(SEED, number, losses=True)) for number in itertools.count())
    here = (one for one in drawn if one[1].level == level)
    compared = 0
    for n, (number, motion) in enumerate(itertools.islice(here, EACH if compiled == "compiled" else 2)):
        finding = examine(motion, lambda: Module(compiled), without_reference=n >= WITH_REFERENCE)
        assert not finding.failed, (number, finding.figures, motion.as_dict())
        assert not finding.refused or "the meshes jam" in finding.refused, (number, motion.as_dict())
        compared += VIRTUAL_WORK in finding.figures
    assert compared >= 1 or level.method != EVENT or level.fidelity not in (RIGID, ELASTIC)


def test_losses_are_drawn_last_and_each_is_drawn():
    with_them = [draw_motion(SEED, number, losses=True) for number in range(400)]
    for number, motion in enumerate(with_them):
        ideal = draw_motion(SEED, number)
        assert motion.segments == ideal.segments
        assert ideal.parameters.items() <= motion.parameters.items()
    drawn = {name for motion in with_them for name, value in motion.parameters.items() if value}
    assert drawn >= {*AS_TORQUE, "mesh_efficiency", "satellite_mesh_efficiency", "journal_friction"}
    assert drawn >= {"housing_stiffness", "freewheel_stiffness", "satellite_inertia"}
    for name in ("mesh_efficiency", "housing_drag", "gravity"):
        assert 0.2 < sum(name in motion.parameters for motion in with_them) / len(with_them) < 0.7


class Lossless(Module):
    """Its meshes lose a little less than they are told to."""

    def start(self, **values):
        return super().start(**values | {"mesh_efficiency": 1.0 - 0.999 * (1.0 - values["mesh_efficiency"])})


class Regaining(Module):
    """What its journals have lost shrinks."""

    def advance(self, step_size):
        super().advance(step_size)
        self.outputs.energy_lost_journal *= -1.0


class Undragged(Module):
    """The torque of its housing freewheel is without its drag."""

    def advance(self, step_size):
        super().advance(step_size)
        self.outputs.housing_torque += self["housing_drag"]


@pytest.mark.parametrize(
    ("planted", "asked", "invariant"),
    [
        (Lossless, "mesh_efficiency", VIRTUAL_WORK),
        (Regaining, "journal_friction", "lost energy regained"),
        (Undragged, "housing_drag", "torque or slip is 0"),
    ],
)
def test_planted_failure_of_losses_is_found(planted, asked, invariant):
    chosen = [motion for motion in motions(RIGID_EVENT, 40, losses=True) if asked in motion.parameters][:15]
    found = (examine(motion, planted, invariant != VIRTUAL_WORK).failed for motion in chosen)
    assert any(invariant in failed for failed in found)


def test_stopped_campaign_goes_on_behind_what_it_has_kept(tmp_path):
    whole = run_random(10, SEED, tmp_path)
    (kept,) = tmp_path.iterdir()
    lines = kept.read_text().splitlines(keepends=True)
    assert [json.loads(line)["number"] for line in lines] == list(range(10))
    # stopped while it wrote the fourth; the third is marked, to tell it from one that is made again
    lines[2] = lines[2].replace(f'"level": "{whole[2].level}"', '"level": "kept"')
    kept.write_text("".join(lines[:3]) + lines[3][:20])
    again = run_random(9, SEED, tmp_path)
    assert again[2].level == "kept"
    assert [*again[:2], *again[3:]] == [*whole[:2], *whole[3:9]]
    assert len(kept.read_text().splitlines()) == 9
    assert run_random(4, SEED, tmp_path) == again[:4]


def test_kept_outcome_is_the_same_outcome(tmp_path):
    explained = Figure(0.1 + 0.2, math.inf, explained=True)
    motion = draw_motion(SEED, 3).as_dict()
    outcomes = [
        Outcome(0, "averaged", Finding({"finite": Figure(0.0, 0.0), REFERENCE: explained}, long=True)),
        Outcome(1, "kinematic", Finding(refused="it takes too long"), motion),
    ]
    (tmp_path / "kept").write_text("".join(map(as_line, outcomes)))
    assert read_outcomes(tmp_path / "kept") == outcomes


def test_motion_that_takes_long_is_run_once_and_counted(monkeypatch):
    motion = motions(RIGID_EVENT, 1)[0]
    often = set(examine(motion).figures)
    assert {"restored state", "long and short steps", REFERENCE} < often
    monkeypatch.setattr(random_checks, "LONGEST", 1.0)
    finding = examine(motion)
    assert finding.long
    assert {"finite", "energy residual"} <= set(finding.figures) < often - {"restored state", REFERENCE}
    (row,) = (row for row in rows_of([Outcome(7, motion.level.name, finding)]) if row[1] == "not long")
    assert row[2:] == (1, 0, 0, 1, "", "", 7)


class Pulling(Module):
    """Its housing freewheel pulls where the load drives the output."""

    def advance(self, step_size):
        super().advance(step_size)
        if self["load_torque"] < 0.0:
            self.outputs.housing_torque = -1.0


class Heavier(Module):
    """Its imbalances are heavier than they are told to be."""

    def start(self, **values):
        return super().start(**values | {"imbalance_mass": 1.001 * values.get("imbalance_mass", 1.0)})


class Forgetful(Module):
    """A restored state has lost digits of the drive angle."""

    def restore(self, *saved):
        super().restore(*saved)
        self.state.q *= 1.0 + 1e-12


class Stepwise(Module):
    """Every step adds the same to the speed of the output."""

    def advance(self, step_size):
        super().advance(step_size)
        self.state.omega3 += 1e-3
        self.outputs.omega_out = self.state.omega3


class Preferring(Module):
    """Its output turns a little slower where link 1 is faster than 50 rad/s."""

    def advance(self, step_size):
        super().advance(step_size)
        if abs(self["omega1"]) > 50.0:
            self.outputs.omega_out *= 0.999


class Numberless(Module):
    """Its mean input torque is no number."""

    def advance(self, step_size):
        super().advance(step_size)
        self.outputs.input_torque_mean = math.nan


@pytest.mark.parametrize(
    ("planted", "invariant"),
    [
        (Pulling, "Th, Tc >= 0"),
        (Heavier, REFERENCE),
        (Forgetful, "restored state"),
        (Stepwise, "long and short steps"),
        (Preferring, "scaling by the speed"),
        (Numberless, "finite"),
    ],
)
def test_planted_failure_is_found(planted, invariant):
    found = (examine(motion, planted, invariant != REFERENCE).failed for motion in motions(RIGID_EVENT, 12))
    assert any(invariant in failed for failed in found)


def test_failure_is_shrunk_to_what_it_needs():
    motion = next(m for m in motions(RIGID_EVENT, 60) if cause(examine(m, Pulling, True)) == "Th, Tc >= 0")
    small = shrunk(motion, "Th, Tc >= 0", Pulling)
    assert "Th, Tc >= 0" in examine(small, Pulling, True).failed
    assert not examine(small, without_reference=True).failed
    (segment,) = small.segments
    assert segment.load < 0.0
    assert segment.omega1 == segment.drive == segment.slope == 0.0
    assert len(small.parameters) < len(motion.parameters) / 3


def test_refusals_are_counted_by_their_sentence_and_are_no_failures(monkeypatch):
    class Refusing(Module):
        def advance(self, step_size):
            if step_size > 1e-6:
                raise Refused(f"communication step = {step_size} s is abandoned: too long")
            super().advance(step_size)

    monkeypatch.setattr(random_study, "TRIES", 20)
    outcomes = [try_number(SEED, number, Refusing) for number in (1, 3)]
    kinds = findings(outcomes)
    assert sum(kind["count"] for kind in kinds) == 2
    assert {kind["what"] for kind in kinds} == {"communication step = # s is abandoned: too long"}
    refused = [row for row in rows_of(outcomes) if row[1] == "not refused"]
    assert sum(row[5] for row in refused) == 2
    assert not any(outcome.finding.failed for outcome in outcomes)


def test_exception_is_a_failure():
    class Broken(Module):
        def advance(self, step_size):
            raise ZeroDivisionError("float division by zero")

    assert examine(draw_motion(SEED, 1), Broken).failed == ["ZeroDivisionError: float division by zero"]
