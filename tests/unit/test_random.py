"""Random motions hold all invariants; where a module does not, that is found and made small."""

import itertools
import math

import pytest

from inertia_module.common.errors import Refused
from inertia_module.kernel.codes import EVENT, RIGID
from inertia_module.memory.instances import Module
from inertia_module.studies.stability import random_checks, random_study
from inertia_module.studies.stability.case import LEVELS, Segment
from inertia_module.studies.stability.random_checks import REFERENCE, examine
from inertia_module.studies.stability.random_motions import Motion, draw_motion
from inertia_module.studies.stability.random_study import cause, findings, rows_of, shrunk, try_number

SEED = 1
EACH, WITH_REFERENCE = 30, 4
RIGID_EVENT = next(level for level in LEVELS if (level.fidelity, level.method) == (RIGID, EVENT))


BEVEL = {"satellites": 4, "z6": 80, "b": 0.8, "wheel_radius": 0.3, "shaft_angle": 1.0}
JOINED = {"housing_freewheel": 0, "output_freewheel": 0}
# what a campaign has found: parameters, and segments (duration, omega1, load, slope, drive)
FOUND = {
    "shaft swung by a load": (
        {"fidelity": 3, "output_inertia": 60.0, "driven_inertia": 1e-3, "tolerance": 5e-5},
        [(2.0, 0.0, 1.0)],
    ),
    "shaft swung by a load taken off": (
        {"fidelity": 3, "output_inertia": 8e-4, "shaft_stiffness": 6e3},
        [(2.0, 0.0, 0.2), (2.0, 0.0, 0.0)],
    ),
    "undamped shaft swung by a load": (
        {"fidelity": 3, "output_inertia": 4e-4, "shaft_damping": 0.0, "tolerance": 4e-9},
        [(0.012, 0.0, -1.0)],
    ),
    "shaft without pulses": (
        {"fidelity": 3, "imbalance_mass": 0.0, "shaft_stiffness": 8e5},
        [(0.02, -0.2, 0.05)],
    ),
    "jump of a swinging shaft": (
        {"fidelity": 3, **BEVEL, **JOINED, "shaft_stiffness": 14695000.0, "tolerance": 2e-9},
        [(0.0069986, 0.0, 0.0, -4.0), (0.011583, 0.10526, 0.00010081, 7.7782)],
    ),
    "prescribed ramp from rest": (
        {
            **{"fidelity": 0, "kinematic_ratio": -1.0, "tolerance": 3e-10},
            **{"layout": 1, "sun_radius": 0.09, "satellite_radius": 0.14, "eccentricity": 0.1},
        },
        [(0.3, 0.0, 0.0, -7.0)],
    ),
    "averaged at a small tolerance": (
        {
            **{"fidelity": 1, "drive": 1, "input_inertia": 6e-4, "tolerance": 1e-10},
            **{"output_inertia": 20.0, "z17": 20, "b": 0.01, "wheel_radius": 0.05},
        },
        [(0.6, 0.0, -0.02, 0.0, 0.02)],
    ),
}


@pytest.mark.parametrize("found", FOUND)
def test_what_was_found_stays_mended(kernel, found):
    parameters, segments = FOUND[found]
    motion = Motion(parameters, tuple(Segment(*segment) for segment in segments))
    finding = examine(motion, lambda: Module(kernel), without_reference=kernel == "plain")
    assert not finding.failed, finding.figures
    assert not finding.refused


def motions(level, count):
    """The first motions of a seed at this level."""
    drawn = (draw_motion(SEED, number) for number in itertools.count())
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
                raise Refused(f"communication step = {step_size} s is given up: too long")
            super().advance(step_size)

    monkeypatch.setattr(random_study, "TRIES", 20)
    outcomes = [try_number(SEED, number, Refusing) for number in (1, 3)]
    kinds = findings(outcomes)
    assert sum(kind["count"] for kind in kinds) == 2
    assert {kind["what"] for kind in kinds} == {"communication step = # s is given up: too long"}
    refused = [row for row in rows_of(outcomes) if row[1] == "not refused"]
    assert sum(row[4] for row in refused) == 2
    assert not any(outcome.finding.failed for outcome in outcomes)


def test_exception_is_a_failure():
    class Broken(Module):
        def advance(self, step_size):
            raise ZeroDivisionError("float division by zero")

    assert examine(draw_motion(SEED, 1), Broken).failed == ["ZeroDivisionError: float division by zero"]
