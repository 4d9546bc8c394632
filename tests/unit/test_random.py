"""Random motions hold all invariants; where a module does not, that is found and made small."""

import csv
import hashlib
import itertools
import json
import math
import tomllib
from pathlib import Path

import pytest
from faulty import faulty, raising, showing
from scenes import PLAY, mechanism

from inertia_module.kernel.codes import ELASTIC, RIGID
from inertia_module.model import Module
from verification.stability import random_motions as campaign
from verification.stability.motion import LEVELS, Figure, Motion, Segment, run
from verification.stability.random_motions import (
    REFERENCE,
    VIRTUAL_WORK,
    Finding,
    Outcome,
    draw_motion,
    examine,
)

SEED = 1
EACH, WITH_REFERENCE = 8, 5
RIGID_LEVEL = next(level for level in LEVELS if level.fidelity == RIGID)


def motions(level, count, losses=False):
    """The first motions of a seed at this level."""
    drawn = (draw_motion(SEED, number, losses) for number in itertools.count())
    return list(itertools.islice((motion for motion in drawn if motion.level == level), count))


def found():
    """Motions that campaigns have found, with most switches, by what went wrong, or by seed and number."""
    place = Path(__file__).with_name("found.csv")
    with place.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            parts = [[float(number) for number in one.split()] for one in row["segments"].split(";")]
            # duration, omega1, load, slope, drive, steps
            segments = tuple(Segment(*part[:5], *map(int, part[5:])) for part in parts)
            yield pytest.param(Motion(mechanism(row["parameters"]), segments), 100, id=row["what"])
    for more, numbers in tomllib.loads(place.with_suffix(".toml").read_text(encoding="utf-8")).items():
        for seed, number in numbers:
            motion = draw_motion(seed, number, more != "ideal")
            if more != "play":
                motion = motion.changed(**dict.fromkeys(PLAY, 0.0))
            yield pytest.param(motion, 1000, id=f"{more}-{seed}-{number}")


@pytest.mark.parametrize("motion, switches", list(found()))
def test_what_was_found_stays_mended(compiled, motion, switches):
    finding = examine(motion, lambda: Module(compiled))
    assert not finding.failed, finding.figures
    assert not finding.refused
    # whose freewheels do not chatter
    assert run(motion, lambda: Module(compiled)).points[-1]["contact_switches"] < switches


def test_speeds_that_come_to_rest_at_once_are_not_followed_for_ever(compiled):
    assert 0.0 < run(draw_motion(1, 18441), lambda: Module(compiled)).evaluations < 3e4


@pytest.mark.parametrize("losses", [False, True], ids=["ideal", "losses"])
@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_random_motions_hold_all_invariants(compiled, level, losses, monkeypatch):
    for most in ("MOST_EVALUATIONS", "MOST_WITH_LOSSES"):
        monkeypatch.setattr(campaign, most, 3000)
    compared = 0
    for n, motion in enumerate(motions(level, EACH, losses)):
        finding = examine(motion, lambda: Module(compiled), without_reference=n >= WITH_REFERENCE)
        assert not finding.failed, (finding.figures, motion.as_dict())
        assert not finding.refused or (losses and "self-locking" in finding.refused), motion.as_dict()
        assert len(finding.figures) >= 3 or finding.refused
        compared += bool({REFERENCE, VIRTUAL_WORK} & finding.figures.keys())
    assert compared >= 1 or level.fidelity not in (RIGID, ELASTIC)


@pytest.mark.parametrize("losses, digest", [(False, "e423be8c96e129cf"), (True, "ae3a8ef773cdd18f")])
def test_number_of_a_seed_is_the_motion_that_the_documentation_counts(losses, digest):
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
    "invariant, asked, planted",
    [
        ("Th, Tc >= 0", "", PULLING),
        (REFERENCE, "", faulty(told=lambda p: {"imbalance_mass": 1.001 * p.get("imbalance_mass", 1.0)})),
        ("restored state", "", faulty(after_restore=lose_digits)),
        ("long and short steps", "", faulty(add_to_the_shaft)),
        ("speed scaling", "", SLOWER_ABOVE_50),
        ("finite", "", showing(input_torque_mean=math.nan)),
        ("OverflowError: too large", "", raising(OverflowError("too large"))),
        (VIRTUAL_WORK, "mesh_efficiency", faulty(told=less_lost)),
        ("lost energy regained", "journal_friction", REGAINING),
        ("torque or slip is 0", "housing_drag", DRAGGING),
    ],
)
def test_planted_failure_is_found(planted, asked, invariant):
    chosen = motions(RIGID_LEVEL, 40 if asked else 12, losses=bool(asked))
    chosen = [motion for motion in chosen if not asked or asked in motion.parameters][:15]
    without_reference = invariant not in (REFERENCE, VIRTUAL_WORK)
    assert any(invariant in examine(motion, planted, without_reference).failed for motion in chosen)


def test_failure_is_shrunk_to_what_it_needs():
    motion = next(
        m for m in motions(RIGID_LEVEL, 60) if examine(m, PULLING, True).causes[:1] == ["Th, Tc >= 0"]
    )
    small = campaign.shrunk(motion, "Th, Tc >= 0", PULLING)
    assert "Th, Tc >= 0" in examine(small, PULLING, True).failed
    assert not examine(small, without_reference=True).failed
    (segment,) = small.segments
    assert segment.load < 0.0
    assert len(small.parameters) < len(motion.parameters) / 3


def test_stopped_campaign_goes_on_behind_what_it_has_kept(tmp_path):
    whole = campaign.run_random(6, SEED, tmp_path)
    (kept,) = tmp_path.iterdir()
    lines = kept.read_text().splitlines(keepends=True)
    assert [json.loads(line)["number"] for line in lines] == list(range(6))
    # stopped while it wrote the fourth; the third is marked, to tell it from one that is made again
    lines[2] = lines[2].replace(f'"level": "{whole[2].level}"', '"level": "kept"')
    kept.write_text("".join(lines[:3]) + lines[3][:20])
    again = campaign.run_random(5, SEED, tmp_path)
    assert again[2].level == "kept"
    assert [*again[:2], *again[3:]] == [*whole[:2], *whole[3:5]]
    assert len(kept.read_text().splitlines()) == 5
    assert campaign.run_random(4, SEED, tmp_path) == again[:4]


def test_rows_tell_the_figure_next_to_its_bound_or_furthest_over_it():
    figures = [
        Figure(1e-3, 1.0),
        Figure(1e-6, 1e-7),
        Figure(2e-6, 2e-5, explained=True),
        Figure(1.0, math.inf),
    ]
    outcomes = [Outcome(number, "averaged", Finding({"error": one})) for number, one in enumerate(figures)]
    row, long, refused = campaign.rows_of(outcomes)
    assert row == ("averaged", "error", 4, 1, 1, 1, "1e-06", "1e-07", 1)
    assert (long[1:6], refused[1:6]) == (("within the work limit", 4, 0, 0, 0), ("accepted", 4, 0, 0, 0))
