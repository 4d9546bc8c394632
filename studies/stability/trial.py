"""One trial of an extreme: runs in long steps, in many short ones, tightly and slightly changed; a verdict.

The bounds are functions of the tolerance; docs/stability.md prints them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import lru_cache

from inertia_module.contract.variable import LARGEST_STEP
from inertia_module.kernel.codes import ELASTIC, EVENT, KINEMATIC, TIMESTEPPING
from inertia_module.memory import Module

from ..reference.geometry import shaft_frequency, swing_frequency
from .extremes import Case
from .motion import Make, Motion, Run, Segment, distance, relative, run

# relative rounding that adds up over a run
ROUNDING = 1e-12
# tolerances that the energy residual may come to, of the largest energy
ENERGY_TOLERANCES = 100.0
# accuracies, and effects of a change of the problem by a tolerance, that a result may be off
RESULT_ACCURACIES = 3.0
# no relative error is allowed to be larger, whatever accuracy is asked for: a looser bound would say nothing
LARGEST_ERROR = 0.1
# breach of a freewheel, of the largest torque or speed
BREACH = 1e-9
# right-hand sides for each communication step, for each radian of the highest harmonic (by events: they grow
# slowly with the digits asked for, at eighth order) and for each internal step of timestepping
STEP_WORK = 100.0
PHASE_WORK = 20.0
WORK_ORDER = 8.0
FIXED_STEP_WORK = 10.0
# the run the others are measured against: tighter by this, down to what doubles allow
TIGHTER = 1e-4
TIGHTEST = 1e-13
# rad of the highest harmonic in a step of method timestepping
FIXED_PHASE = 0.1

EXACT, SENSITIVE, DEGRADED, REFUSED, BROKEN = "exact", "sensitive", "degraded", "refused", "broken"
OUTCOMES = (EXACT, SENSITIVE, DEGRADED, REFUSED, BROKEN)
# figures that compare two runs of one motion, and all that are relative errors
COMPARED = ("long against short steps", "error", "error, short steps")
RELATIVE = ("energy residual", "energy residual, short steps", *COMPARED)


@dataclass(frozen=True)
class Figure:
    """One measured figure and the bound it is held to; explained: the motion's own sensitivity widened it."""

    value: float
    bound: float
    explained: bool = False

    @property
    def holds(self) -> bool:
        """True within the bound (not for NaN)."""
        return self.value <= self.bound


Figures = dict[str, Figure]


def energy_bound(accuracy: float) -> float:
    """Energy residual allowed, of the largest energy."""
    return min(LARGEST_ERROR, ENERGY_TOLERANCES * accuracy + ROUNDING)


def result_bound(accuracy: float, sensitivity: float) -> float:
    """Distance allowed between two runs of one motion, relative.

    Args:
        accuracy: asked for, relative.
        sensitivity: distance that a change of the problem by the tolerance makes.
    """
    return min(LARGEST_ERROR, RESULT_ACCURACIES * (accuracy + sensitivity) + ROUNDING)


def work_bound(case: Case, phase: float, steps: int, fixed_steps: int) -> float:
    """Right-hand sides allowed for a phase (rad), communication steps and internal steps of timestepping."""
    motion = case.motion
    if case.level.method == TIMESTEPPING:
        return STEP_WORK * steps + FIXED_STEP_WORK * fixed_steps
    # what the shaft, freewheels that wind up and weights can swing through costs too
    swinging = swing_frequency(motion.__getitem__)
    if case.level.fidelity == ELASTIC:
        swinging += shaft_frequency(motion.__getitem__)
    phase += swinging * sum(part.duration for part in motion.segments)
    digits = float(motion["tolerance"] ** (-1.0 / WORK_ORDER))
    return STEP_WORK * steps + PHASE_WORK * digits * (1.0 + phase)


@dataclass(frozen=True)
class Trial:
    """The runs of a case.

    Attributes:
        case: what was tried. long, short: in long communication steps and in many short ones.
        tight: at a far tighter tolerance, by events (None where it is refused).
        sensitivity: of the motion itself: largest distance from tight that a relative change by the
            tolerance in the angle at the start, in the load or in the speed of link 1 makes.
    """

    case: Case
    long: Run
    short: Run | None = None
    tight: Run | None = None
    sensitivity: float = 0.0


def try_case(case: Case, make: Make = Module) -> Trial:
    """All runs of a case. Never raises.

    Args:
        make: makes a module not started yet.
    """
    motion = case.motion
    try:
        if case.level.method == TIMESTEPPING and "max_step" not in motion.parameters:
            motion = motion.changed(max_step=fixed_step(motion, make()))
        long = run(motion, make)
        if long.refused:
            return Trial(case, long)
        short = run(motion, make, case.split)
        precise = motion.parameters | {"method": EVENT, "max_step": 0.0}
        return Trial(case, long, short, *_precise(make, tuple(precise.items()), motion.segments))
    except Exception as error:  # whatever else it is, it is a finding
        return Trial(case, Run(broken=f"{type(error).__name__}: {error}"))


def fixed_step(motion: Motion, module: Module) -> float:
    """Step of method timestepping, s; 0 at rest without weights.

    FIXED_PHASE of the highest harmonic at the fastest input and of the swing of link 2 on weights.
    """
    motion.changed(fidelity=KINEMATIC, method=EVENT).started(module)
    rate = float(module.derived.harmonic * module.derived.k) * max(part.fastest for part in motion.segments)
    rate += swing_frequency(module.__getitem__)
    return min(FIXED_PHASE / rate, LARGEST_STEP) if rate > 1e-300 else 0.0


@lru_cache(maxsize=1)  # the methods of a fidelity, which come one after the other, share it
def _precise(
    make: Make, parameters: tuple[tuple[str, float], ...], segments: tuple[Segment, ...]
) -> tuple[Run | None, float]:
    """The tight run, or None where it is refused, and the sensitivity of the motion (see Trial)."""
    asked = Motion(dict(parameters), segments)
    tolerance = asked["tolerance"]
    precise = asked.changed(tolerance=max(TIGHTER * tolerance, TIGHTEST))
    tight = run(precise, make)
    if tight.refused:
        return None, 0.0
    changed = [run(beside, make) for beside in precise.nudged(tolerance)]
    return tight, max((distance(run, tight) for run in changed if not run.refused), default=0.0)


@dataclass(frozen=True)
class Verdict:
    """Verdict on a case.

    Attributes:
        outcome: exact, sensitive, degraded, refused or broken. reason: message, or which bound is missed by
            how much.
        figures: by name, measured and allowed.
    """

    case: Case
    outcome: str
    reason: str = ""
    figures: Figures = field(default_factory=dict)

    @property
    def error(self) -> float:
        """Largest relative error seen: energy residual, long against short, against the tight run."""
        return max((self.figures[name].value for name in RELATIVE if name in self.figures), default=0.0)

    @property
    def missed(self) -> list[str]:
        """Names of the figures beyond their bounds."""
        return [name for name, figure in self.figures.items() if not figure.holds]


def cause(message: str) -> str:
    """Reason of a refusal, without the values and what is allowed."""
    found = re.search(r": ([^;]*)", message)
    return found.group(1).strip() if found else message.partition(", are ")[0]


def measure(trial: Trial, short: Run) -> Figures:
    """All figures of a trial that ran through, by name."""
    case, long, tight = trial.case, trial.long, trial.tight
    result = result_bound(case.accuracy, trial.sensitivity)
    runs = {"": long, ", short steps": short}

    def worst(name: str, scale: str) -> float:
        return max(relative(getattr(run, name), getattr(run, scale)) for run in runs.values())

    figures = {}
    for suffix, found in runs.items():
        residual = relative(found.residual, found.energy)
        figures[f"energy residual{suffix}"] = Figure(residual, energy_bound(case.accuracy))
    figures["long against short steps"] = Figure(distance(long, short), result)
    figures["speed against a freewheel"] = Figure(worst("reversal", "speed"), BREACH)
    figures["torque against a freewheel"] = Figure(worst("pull", "torque"), BREACH)
    figures["lost energy regained"] = Figure(worst("regained", "energy"), BREACH)
    for suffix, found in runs.items():
        allowed = work_bound(case, found.phase, found.steps, found.fixed_steps)
        figures[f"work{suffix}"] = Figure(found.evaluations, allowed)
    if tight is not None:
        figures |= {f"error{suffix}": Figure(distance(tight, one), result) for suffix, one in runs.items()}
    return figures


def judge(trial: Trial) -> Verdict:
    """The verdict on a trial.

    Where runs differ and a change of the problem by the tolerance alone moves the end by more than
    LARGEST_ERROR, no method can say which is right: sensitive. An exception, a value that is not finite, a
    refusal in short steps of what long ones did, or a refused step that leaves the module changed or
    unusable is broken: a bug.
    """
    case, long, short = trial.case, trial.long, trial.short
    if long.broken:
        return Verdict(case, BROKEN, long.broken)
    if long.refused:
        return Verdict(case, REFUSED, long.refused)
    if short is None or short.refused:
        return Verdict(case, BROKEN, "short steps: " + (short.refused if short else "not run"))
    if not (long.finite and short.finite):
        return Verdict(case, BROKEN, "an output is not finite")
    figures = measure(trial, short)
    missed = {name: figure for name, figure in figures.items() if not figure.holds}
    outcome = DEGRADED if missed else EXACT
    if missed and trial.sensitivity > LARGEST_ERROR and set(missed) <= set(COMPARED):
        outcome = SENSITIVE
    reasons = [f"{name} {figure.value:.0e}, bound {figure.bound:.0e}" for name, figure in missed.items()]
    return Verdict(case, outcome, "; ".join(reasons), figures)
