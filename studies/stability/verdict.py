"""From the runs of a trial to a verdict: exact, sensitive, degraded, refused; anything else is broken."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from .bounds import BREACH, LARGEST_ERROR, energy_bound, result_bound, work_bound
from .case import Case
from .trial import Trial, distance, relative

EXACT = "exact"
SENSITIVE = "sensitive"
DEGRADED = "degraded"
REFUSED = "refused"
BROKEN = "broken"
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
        """Whether it is within its bound (NaN is not)."""
        return self.value <= self.bound


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
    figures: dict[str, Figure] = field(default_factory=dict)

    @property
    def error(self) -> float:
        """Largest relative error seen: energy residual, long against short, against the tight run."""
        return max((self.figures[name].value for name in RELATIVE if name in self.figures), default=0.0)

    @property
    def missed(self) -> list[str]:
        """Names of the figures beyond their bounds."""
        return [name for name, figure in self.figures.items() if not figure.holds]


def cause(message: str) -> str:
    """What a refusal says is wrong, without the values and what is allowed."""
    found = re.search(r": ([^;]*)", message)
    return found.group(1).strip() if found else message.partition(", are ")[0]


def measure(trial: Trial) -> dict[str, Figure]:
    """All figures of a trial that ran through, by name."""
    case, long, tight = trial.case, trial.long, trial.tight
    assert trial.short is not None
    result = result_bound(case.accuracy, trial.sensitivity)
    runs = {"": long, ", short steps": trial.short}
    figures = {}
    for suffix, run in runs.items():
        residual = relative(run.residual, run.energy)
        figures[f"energy residual{suffix}"] = Figure(residual, energy_bound(case.accuracy))
    figures["long against short steps"] = Figure(distance(long, trial.short), result)
    for scale, breach in (("speed", "reversal"), ("torque", "pull")):
        worst = max(relative(getattr(run, breach), getattr(run, scale)) for run in runs.values())
        figures[f"{scale} against a freewheel"] = Figure(worst, BREACH)
    worst = max(relative(run.regained, run.energy) for run in runs.values())
    figures["lost energy regained"] = Figure(worst, BREACH)
    for suffix, run in runs.items():
        allowed = work_bound(case, run.phase, run.steps, run.fixed_steps)
        figures[f"work{suffix}"] = Figure(run.evaluations, allowed)
    if tight is not None:
        figures |= {f"error{suffix}": Figure(distance(tight, run), result) for suffix, run in runs.items()}
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
    figures = measure(trial)
    missed = {name: figure for name, figure in figures.items() if not figure.holds}
    outcome = DEGRADED if missed else EXACT
    if missed and trial.sensitivity > LARGEST_ERROR and set(missed) <= set(COMPARED):
        outcome = SENSITIVE
    reasons = [f"{name} {figure.value:.0e}, bound {figure.bound:.0e}" for name, figure in missed.items()]
    return Verdict(case, outcome, "; ".join(reasons), figures)
