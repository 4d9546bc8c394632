"""From the runs of a trial to a verdict: exact, sensitive, degraded, refused; anything else is broken."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from .bounds import BREACH, LARGEST_ERROR, accuracy_of, energy_bound, result_bound, work_bound
from .case import Case
from .trial import Run, Trial, distance

EXACT = "exact"
SENSITIVE = "sensitive"
DEGRADED = "degraded"
REFUSED = "refused"
BROKEN = "broken"
WORDS = (EXACT, SENSITIVE, DEGRADED, REFUSED, BROKEN)
# figures that compare two runs of one motion, and all that are relative errors
COMPARED = ("long against short steps", "error", "error, short steps")
RELATIVE = ("energy residual", "energy residual, short steps", *COMPARED)


@dataclass(frozen=True)
class Figure:
    """One measured figure and the bound it is held to."""

    value: float
    bound: float

    @property
    def holds(self) -> bool:
        """Whether it is within its bound (a value that is no number is not)."""
        return self.value <= self.bound


@dataclass(frozen=True)
class Verdict:
    """Verdict on a case.

    Attributes:
        word: exact, sensitive, degraded, refused or broken. reason: message, or which bound is missed by
            how much.
        figures: by name, measured and allowed.
    """

    case: Case
    word: str
    reason: str = ""
    figures: dict[str, Figure] = field(default_factory=dict)

    @property
    def error(self) -> float:
        """Largest relative error seen: energy residual, long against short, against the tight run."""
        return max((self.figures[name].value for name in RELATIVE if name in self.figures), default=0.0)


def cause(message: str) -> str:
    """What a refusal says is wrong, without the values and what is allowed."""
    found = re.search(r": ([^;]*)", message)
    return found.group(1).strip() if found else message


def measure(trial: Trial) -> dict[str, Figure]:
    """All figures of a trial that ran through, by name."""
    case, long, short, tight = trial.case, trial.long, trial.short, trial.tight
    assert short is not None
    accuracy = accuracy_of(case)
    energy = energy_bound(accuracy)
    result = result_bound(accuracy, trial.sensitivity)
    figures = {
        "energy residual": Figure(_part(long.residual, long.energy), energy),
        "energy residual, short steps": Figure(_part(short.residual, short.energy), energy),
        "long against short steps": Figure(distance(long, short), result),
        "speed against a freewheel": Figure(_worst(long, short, "reversal", "speed"), BREACH),
        "torque against a freewheel": Figure(_worst(long, short, "pull", "torque"), BREACH),
        "work": _work(case, long),
        "work, short steps": _work(case, short),
    }
    if tight is not None:
        figures["error"] = Figure(distance(tight, long), result)
        figures["error, short steps"] = Figure(distance(tight, short), result)
    return figures


def _part(value: float, whole: float) -> float:
    if value == 0.0:
        return 0.0
    return value / whole if whole > 0.0 else math.inf


def _worst(long: Run, short: Run, name: str, scale: str) -> float:
    return max(_part(getattr(run, name), getattr(run, scale)) for run in (long, short))


def _work(case: Case, run: Run) -> Figure:
    return Figure(run.evaluations, work_bound(case, run.phase, run.steps, run.fixed_steps))


def judge(trial: Trial) -> Verdict:
    """The verdict on a trial.

    Where runs differ and a change of the problem by the tolerance alone moves the end by more than
    LARGEST_ERROR, no method can tell which is right: sensitive. An exception, a number that is none, a
    refusal in short steps of what long ones did, or a refused step that leaves the module changed or
    unusable is broken: a bug.
    """
    case, long, short = trial.case, trial.long, trial.short
    if trial.exception:
        return Verdict(case, BROKEN, trial.exception)
    if long.broken:
        return Verdict(case, BROKEN, long.broken)
    if long.refused:
        return Verdict(case, REFUSED, long.refused)
    if short is None or short.refused:
        return Verdict(case, BROKEN, "short steps: " + (short.refused if short else "not run"))
    if not (long.finite and short.finite):
        return Verdict(case, BROKEN, "an output is not finite")
    figures = measure(trial)
    missed = {name: figure for name, figure in figures.items() if not figure.holds}
    word = DEGRADED if missed else EXACT
    if missed and trial.sensitivity > LARGEST_ERROR and set(missed) <= set(COMPARED):
        word = SENSITIVE
    reasons = [f"{name} {figure.value:.0e}, bound {figure.bound:.0e}" for name, figure in missed.items()]
    return Verdict(case, word, "; ".join(reasons), figures)
