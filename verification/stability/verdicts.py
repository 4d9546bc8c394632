"""Verdicts on the extremes: each case runs several times, and its errors are compared with bounds.

The bounds are functions of the tolerance; stability.md contains them. A cell of the table contains the
verdict, the power of ten of the maximum relative error and the reason if the case is not exact. It is coarse
enough to be equal on all platforms.
"""

from __future__ import annotations

import csv
import dataclasses
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, NamedTuple, Self

from inertia_module.common.errors import unknown
from inertia_module.fmi import results
from inertia_module.fmi.simulate import Progress
from inertia_module.kernel.codes import ELASTIC
from inertia_module.model import Module

from ..reference.geometry import shaft_frequency, swing_frequency
from . import motion as motions
from .extremes import Case, axes
from .motion import Make, Metric, Metrics, Motion, Run, Segment

# relative round-off of a run
ROUNDING = 1e-12
# energy residual allowed, in tolerances of the maximum energy; increase per revolution of the pinion shaft
ENERGY_TOLERANCES = 100.0
TOLERANCES_PER_TURN = 0.1
# error of a result allowed, in multiples of accuracy and sensitivity
RESULT_FACTOR = 3.0
# maximum of all bounds of relative errors
LARGEST_ERROR = 0.1
# relative violation of a condition allowed (Run.relative_breach)
BREACH = 1e-9
# right-hand-side evaluations allowed per communication step and per radian; the latter increase with
# the digits by the order of the method
STEP_WORK = 100.0
PHASE_WORK = 20.0
METHOD_ORDER = 8.0
# factor and minimum of the tolerance of the tightened run
TIGHT_FACTOR = 1e-4
MIN_TOLERANCE = 1e-12

VERDICTS = EXACT, SENSITIVE, DEGRADED, REJECTED, BROKEN = (
    "exact",
    "sensitive",
    "degraded",
    "rejected",
    "broken",
)
# metrics that compare two runs of a motion, and all metrics that are relative errors
COMPARED = ("long against short steps", "error", "error, short steps")
RELATIVE = ("energy residual", "energy residual, short steps", *COMPARED)
HEADINGS = ("axis", "value", "layout", *(level.name for level in motions.LEVELS))
# power of ten of errors that are only round-off
MIN_POWER = -15
SEPARATOR = " | "


def energy_bound(accuracy: float, turns: float = 0.0) -> float:
    """Return the bound of the energy residual, relative to the maximum energy.

    Args:
        accuracy: requested relative accuracy.
        turns: revolutions of the pinion shaft.
    """
    return min(LARGEST_ERROR, (ENERGY_TOLERANCES + TOLERANCES_PER_TURN * turns) * accuracy + ROUNDING)


def result_bound(accuracy: float, sensitivity: float) -> float:
    """Return the bound of the relative distance between two runs of a motion.

    Args:
        accuracy: requested relative accuracy.
        sensitivity: distance that a change of the inputs by the tolerance causes.
    """
    return min(LARGEST_ERROR, RESULT_FACTOR * (accuracy + sensitivity) + ROUNDING)


def work_bound(case: Case, result: Run) -> float:
    """Return the bound of the right-hand-side evaluations of a run.

    The oscillations of an elastic shaft, of wind-up and of the weights add to the phase.

    Args:
        case: case of the run.
        result: the run.
    """
    motion = case.motion
    oscillation = swing_frequency(motion.__getitem__)
    if case.level.fidelity == ELASTIC:
        oscillation += shaft_frequency(motion.__getitem__)
    phase = result.phase + oscillation * sum(segment.duration for segment in motion.segments)
    digits = float(motion["tolerance"] ** (-1.0 / METHOD_ORDER))
    return STEP_WORK * result.steps + PHASE_WORK * digits * (1.0 + phase)


@dataclass(frozen=True)
class Trial:
    """The runs of a case.

    Attributes:
        case: the case.
        long: run in long communication steps.
        short: run in short communication steps.
        tight: run with a tightened tolerance; None if it is rejected.
        sensitivity: maximum distance between a run and the run with inputs changed by the tolerance;
            computed until it explains the differences between the other runs.
    """

    case: Case
    long: Run
    short: Run = field(default_factory=Run)
    tight: Run | None = None
    sensitivity: float = 0.0


def try_case(case: Case, make: Make = Module) -> Trial:
    """Run a case in all ways. Never raises.

    Args:
        case: the case.
        make: function that returns a new module.
    """
    motion = case.motion
    try:
        long = motions.run(motion, make)
        if long.rejection:
            return Trial(case, long)
        short = motions.run(motion, make, case.split)
        tolerance = motion["tolerance"]
        precise = motion.changed(max_step=0.0, tolerance=max(TIGHT_FACTOR * tolerance, MIN_TOLERANCE))
        tight = _tight(make, tuple(precise.parameters.items()), motion.segments)
        trial = Trial(case, long, short, None if tight.rejection else tight)
        if tight.rejection or short.rejection:
            return trial
        for run in (long, tight):
            run.include_maxima(short)
        for distance in _distances_of_changed_runs(precise, trial, make):
            if all(metric.holds for name, metric in metrics_of(trial).items() if name in COMPARED):
                break
            trial = replace(trial, sensitivity=max(trial.sensitivity, distance))
        return trial
    except Exception as error:  # every exception is a finding
        return Trial(case, Run(fault=f"{type(error).__name__}: {error}"))


def _distances_of_changed_runs(precise: Motion, trial: Trial, make: Make) -> Iterator[float]:
    """Yield distances that changes by the tolerance cause: inputs, then the speed of link 2 in each step.

    Args:
        precise: motion with the tightened tolerance.
        trial: runs of the case.
        make: function that returns a new module.
    """
    case, short, tight = trial.case, trial.short, trial.tight
    assert tight is not None
    tolerance = case.motion["tolerance"]
    runs = [(tight, partial(motions.run, perturbed, make)) for perturbed in precise.perturbed(tolerance)]
    for kick in (tolerance * short.speed, -tolerance * short.speed):
        runs.append((short, partial(motions.run, case.motion, make, case.split, kick=kick)))
    for unchanged, run in runs:
        changed = run()
        yield 0.0 if changed.rejection else motions.distance(changed, unchanged)


@lru_cache(maxsize=1)
def _tight(make: Make, parameters: tuple[tuple[str, float], ...], segments: tuple[Segment, ...]) -> Run:
    """Run a motion; the last run is cached.

    Args:
        make: function that returns a new module.
        parameters: names and values.
        segments: inputs.
    """
    return motions.run(Motion(dict(parameters), segments), make)


@dataclass(frozen=True)
class Cell:
    """Verdict of one fidelity level in the table.

    Attributes:
        outcome: one of VERDICTS.
        power: power of ten that exceeds the maximum relative error, or None.
        reason: reason if the case is not exact, or "".
    """

    outcome: str
    power: int | None = None
    reason: str = ""

    def __str__(self) -> str:
        error = "" if self.power is None else f"1e{self.power:+03d}"
        return SEPARATOR.join(part for part in (self.outcome, error, self.reason) if part)

    @classmethod
    def of(cls, text: str) -> Self:
        """Return the cell of a text.

        Args:
            text: string of a cell.
        """
        outcome, *parts = text.split(SEPARATOR)
        power = int(parts.pop(0)[2:]) if parts and parts[0].startswith("1e") else None
        return cls(outcome, power, SEPARATOR.join(parts))


@dataclass(frozen=True)
class Verdict:
    """Verdict on a case.

    Attributes:
        case: the case.
        outcome: one of VERDICTS.
        reason: message of the rejection or fault, or the violated bounds with their values.
        metrics: metrics by name.
    """

    case: Case
    outcome: str
    reason: str = ""
    metrics: Metrics = field(default_factory=dict)

    @property
    def error(self) -> float:
        """Maximum of the energy residuals and of the relative distances between the runs."""
        return max((self.metrics[name].value for name in RELATIVE if name in self.metrics), default=0.0)

    @property
    def violated(self) -> list[str]:
        """Names of the metrics that exceed their bounds."""
        return list(motions.violations(self.metrics))

    @property
    def cell(self) -> Cell:
        """Cell of the table."""
        if self.outcome in (REJECTED, BROKEN):
            return Cell(self.outcome, None, cause(self.reason))
        power = math.ceil(math.log10(self.error)) if self.error else MIN_POWER
        return Cell(self.outcome, max(MIN_POWER, power), ", ".join(self.violated))

    def as_record(self) -> dict[str, Any]:
        """Return a plain dictionary with all metrics and bounds."""
        case = self.case
        return {
            **{"axis": case.axis, "value": case.value, "layout": case.layout, "level": case.level.name},
            **{"verdict": self.outcome, "reason": self.reason},
            "metrics": {name: dataclasses.asdict(metric) for name, metric in self.metrics.items()},
        }


def cause(message: str) -> str:
    """Return the reason of a rejection: the sentence after the values, or the message without values.

    Args:
        message: message of the rejection.
    """
    reason = re.search(r"(?:\)\.|:) (.*?)(?:\. |[.;]?$|;)", message)
    return reason[1] if reason else message.partition(" (got ")[0]


def metrics_of(trial: Trial) -> Metrics:
    """Return the metrics of a trial by name.

    Args:
        trial: runs of a case.
    """
    case, long, short, tight = trial.case, trial.long, trial.short, trial.tight
    result, energy = result_bound(case.accuracy, trial.sensitivity), energy_bound(case.accuracy)
    runs = ("", long), (", short steps", short)
    metrics = {
        f"energy residual{suffix}": Metric(motions.relative(run.residual, run.energy), energy)
        for suffix, run in runs
    }
    metrics["long against short steps"] = Metric(motions.distance(long, short), result)
    for name in (motions.SPEED, motions.TORQUE, motions.REGAINED):
        metrics[name] = Metric(max(long.relative_breach(name), short.relative_breach(name)), BREACH)
    metrics |= {f"work{suffix}": Metric(run.evaluations, work_bound(case, run)) for suffix, run in runs}
    if tight is not None:
        metrics |= {f"error{suffix}": Metric(motions.distance(tight, run), result) for suffix, run in runs}
    return metrics


def judge(trial: Trial) -> Verdict:
    """Return the verdict on a trial.

    - exact: all bounds hold.
    - sensitive: the runs differ, and a change of the inputs by the tolerance changes the end by more than
      LARGEST_ERROR, so no method can decide which run is right.
    - degraded: another bound is violated.
    - rejected: the run in long steps is rejected.
    - broken: an exception, a value that is not finite, a rejection in short steps only, or a rejected step
      that changed the module.

    Args:
        trial: runs of a case.
    """
    case, long, short = trial.case, trial.long, trial.short
    if long.fault:
        return Verdict(case, BROKEN, long.fault)
    if long.rejection:
        return Verdict(case, REJECTED, long.rejection)
    if short.rejection:
        return Verdict(case, BROKEN, f"short steps: {short.rejection}")
    if not (long.is_finite and short.is_finite):
        return Verdict(case, BROKEN, "an output is not finite")
    metrics = metrics_of(trial)
    reasons = motions.violations(metrics)
    outcome = DEGRADED if reasons else EXACT
    if reasons and trial.sensitivity > LARGEST_ERROR and reasons.keys() <= set(COMPARED):
        outcome = SENSITIVE
    return Verdict(case, outcome, "; ".join(reasons.values()), metrics)


def chosen_cases(only: str | None = None, quick: bool = False) -> list[Case]:
    """Return the cases of one axis or of all axes.

    Args:
        only: name of the axis; None for all axes.
        quick: True to omit the slow cases.

    Raises:
        ValueError: no axis has this name.
    """
    cases = [case for axis, group in axes().items() if only in (None, axis) for case in group]
    if not cases:
        raise ValueError(unknown("axis", only, axes()))
    return [case for case in cases if not (quick and case.slow)]


def run_study(chosen: Sequence[Case], report: Progress = lambda done: None) -> list[Verdict]:
    """Return the verdicts on cases in their order.

    Args:
        chosen: cases.
        report: function that receives the completed fraction.
    """
    verdicts = []
    for number, case in enumerate(chosen, 1):
        verdicts.append(judge(try_case(case)))
        report(number / len(chosen))
    return verdicts


# --- the table: a row for each extreme and layout, a cell for each level ---


class Row(NamedTuple):
    """An extreme on one layout.

    Attributes:
        axis: name of the axis.
        value: name of the value.
        layout: layout.
        cells: cells by name of the fidelity level.
    """

    axis: str
    value: str
    layout: str
    cells: dict[str, Cell]


def rows_of(verdicts: Iterable[Verdict]) -> list[Row]:
    """Return the rows of verdicts in their order.

    Args:
        verdicts: verdicts on cases.
    """
    rows: dict[tuple[str, str, str], Row] = {}
    for case, cell in ((verdict.case, verdict.cell) for verdict in verdicts):
        key = case.axis, case.value, case.layout
        rows.setdefault(key, Row(*key, {})).cells[case.level.name] = cell
    return list(rows.values())


def write_rows(path: Path, rows: Iterable[Row]) -> Path:
    """Write rows as CSV atomically and return the path.

    Args:
        path: path of the file.
        rows: rows of the table.
    """
    lines = ([*row[:3], *(row.cells.get(level.name, "") for level in motions.LEVELS)] for row in rows)
    return results.write_rows(path, HEADINGS, lines)


def read_rows(path: Path) -> list[Row]:
    """Read the rows of a file.

    Args:
        path: path of a file by write_rows.
    """
    rows = []
    for line in csv.DictReader(path.read_text(encoding="utf-8").splitlines()):
        axis, value, layout = (line.pop(name) for name in HEADINGS[:3])
        rows.append(Row(axis, value, layout, {name: Cell.of(text) for name, text in line.items() if text}))
    return rows


def counts(rows: Iterable[Row]) -> list[tuple[Any, ...]]:
    """Return for each axis its name, the number of cases, of each of VERDICTS, and the maximum error.

    Args:
        rows: rows of the table.
    """
    cells: dict[str, list[Cell]] = {}
    for row in rows:
        cells.setdefault(row.axis, []).extend(row.cells.values())
    table = []
    for axis, group in cells.items():
        count = Counter(cell.outcome for cell in group)
        powers = [cell.power for cell in group if cell.power is not None]
        error = f"1e{max(powers):+03d}" if powers else ""
        table.append((axis, len(group), *(count[name] for name in VERDICTS), error))
    return table


def reasons(rows: Iterable[Row]) -> list[str]:
    """Return a line for each axis and reason of the cells that are not exact, with examples.

    Args:
        rows: rows of the table.
    """
    examples: dict[tuple[str, ...], list[str]] = {}
    for row in rows:
        for level, cell in row.cells.items():
            if cell.outcome != EXACT:
                names = examples.setdefault((row.axis, cell.outcome, cell.reason), [])
                names.append(f"{row.value} ({row.layout}, {level})")
    return [
        f"{axis}: {outcome}: {reason}. {len(names)} cases, such as {'; '.join(names[:6])}."
        for (axis, outcome, reason), names in examples.items()
    ]
