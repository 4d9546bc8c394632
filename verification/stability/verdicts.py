"""Verdicts on the extremes: runs in long and short steps, tightly and slightly changed, held to bounds.

The bounds are functions of the tolerance; docs/stability.md prints them. A cell of the map holds the verdict,
the power of ten below which all relative errors stayed, and why it is not exact: coarse enough to be the same
on any machine.
"""

from __future__ import annotations

import csv
import dataclasses
import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, Self

from matplotlib.figure import Figure as Picture
from matplotlib.patches import Patch

from inertia_module.common.colours import BLUE, GREEN, ORANGE, VERMILION
from inertia_module.common.errors import unknown
from inertia_module.fmi import results
from inertia_module.fmi.simulate import Progress
from inertia_module.kernel.codes import ELASTIC
from inertia_module.model import Module

from ..reference.geometry import shaft_frequency, swing_frequency
from . import motion as motions
from .extremes import Case, axes
from .motion import Figure, Figures, Make, Motion, Run, Segment

# relative rounding that adds up over a run
ROUNDING = 1e-12
# tolerances that the energy residual may come to, of the largest energy; more for each turn of the drives
ENERGY_TOLERANCES = 100.0
PER_TURN = 0.1
# accuracies, and effects of a change of the problem by a tolerance, that a result may be off
RESULT_ACCURACIES = 3.0
# no relative error is allowed to be larger, whatever accuracy is asked for: a looser bound would say nothing
LARGEST_ERROR = 0.1
# breach of what is never breached but for rounding (see Run.share)
BREACH = 1e-9
# right-hand sides for each communication step and for each radian of the highest harmonic (they grow slowly
# with the digits asked for, at eighth order)
STEP_WORK = 100.0
PHASE_WORK = 20.0
WORK_ORDER = 8.0
# the run the others are measured against: tighter by this, down to what doubles allow
TIGHTER = 1e-4
TIGHTEST = 1e-12

EXACT, SENSITIVE, DEGRADED, REJECTED, BROKEN = "exact", "sensitive", "degraded", "rejected", "broken"
COLOURS = {EXACT: GREEN, SENSITIVE: BLUE, DEGRADED: ORANGE, REJECTED: "#BBBBBB", BROKEN: VERMILION}
OUTCOMES = tuple(COLOURS)
# figures that compare two runs of one motion, and all that are relative errors
COMPARED = ("long against short steps", "error", "error, short steps")
RELATIVE = ("energy residual", "energy residual, short steps", *COMPARED)
HEADINGS = ("axis", "value", "layout", *(level.name for level in motions.LEVELS))
# below this errors are rounding
LEAST_POWER = -15
SEPARATOR = " | "


def energy_bound(accuracy: float, turns: float = 0.0) -> float:
    """Energy residual allowed, of the largest energy, after so many turns of the drives."""
    return min(LARGEST_ERROR, (ENERGY_TOLERANCES + PER_TURN * turns) * accuracy + ROUNDING)


def result_bound(accuracy: float, sensitivity: float) -> float:
    """Distance allowed between two runs of one motion, relative, as the accuracy asked for.

    The sensitivity is the distance that a change of the problem by the tolerance makes.
    """
    return min(LARGEST_ERROR, RESULT_ACCURACIES * (accuracy + sensitivity) + ROUNDING)


def work_bound(case: Case, found: Run) -> float:
    """Right-hand sides allowed for the phase and communication steps of a run."""
    motion = case.motion
    # what the shaft, freewheels that wind up and weights can swing through costs too
    swinging = swing_frequency(motion.__getitem__)
    if case.level.fidelity == ELASTIC:
        swinging += shaft_frequency(motion.__getitem__)
    phase = found.phase + swinging * sum(part.duration for part in motion.segments)
    digits = float(motion["tolerance"] ** (-1.0 / WORK_ORDER))
    return STEP_WORK * found.steps + PHASE_WORK * digits * (1.0 + phase)


@dataclass(frozen=True)
class Trial:
    """The runs of a case.

    Attributes:
        case: what was tried. long, short: in long communication steps and in many short ones.
        tight: at a far tighter tolerance (None if it is rejected).
        sensitivity: of the motion itself: largest distance from tight by relative changes of the tolerance's
            size (angle at the start, load, speed of link 1), as far as it takes to explain the other runs.
    """

    case: Case
    long: Run
    short: Run = field(default_factory=Run)
    tight: Run | None = None
    sensitivity: float = 0.0


def try_case(case: Case, make: Make = Module) -> Trial:
    """All runs of a case. Never raises."""
    motion = case.motion
    try:
        long = motions.run(motion, make)
        if long.refused:
            return Trial(case, long)
        short = motions.run(motion, make, case.split)
        tolerance = motion["tolerance"]
        precise = motion.changed(max_step=0.0, tolerance=max(TIGHTER * tolerance, TIGHTEST))
        tight = _tight(make, tuple(precise.parameters.items()), motion.segments)
        trial = Trial(case, long, short, None if tight.refused else tight)
        for beside in () if tight.refused or short.refused else precise.nudged(tolerance):
            if all(figure.holds for name, figure in figures_of(trial).items() if name in COMPARED):
                break
            changed = motions.run(beside, make)
            if not changed.refused:
                trial = replace(trial, sensitivity=max(trial.sensitivity, motions.distance(changed, tight)))
        return trial
    except Exception as error:  # whatever else it is, it is a finding
        return Trial(case, Run(broken=f"{type(error).__name__}: {error}"))


@lru_cache(maxsize=1)  # the methods of a fidelity, which come one after the other, share it
def _tight(make: Make, parameters: tuple[tuple[str, float], ...], segments: tuple[Segment, ...]) -> Run:
    """The run of a motion."""
    return motions.run(Motion(dict(parameters), segments), make)


@dataclass(frozen=True)
class Cell:
    """Verdict at one level: outcome, power of ten of the largest relative error (or None), and a reason."""

    outcome: str
    power: int | None = None
    reason: str = ""

    def __str__(self) -> str:
        size = "" if self.power is None else f"1e{self.power:+03d}"
        return SEPARATOR.join(part for part in (self.outcome, size, self.reason) if part)

    @classmethod
    def of(cls, text: str) -> Self:
        """The cell that was written so."""
        outcome, *rest = text.split(SEPARATOR)
        power = int(rest.pop(0)[2:]) if rest and rest[0].startswith("1e") else None
        return cls(outcome, power, SEPARATOR.join(rest))


@dataclass(frozen=True)
class Verdict:
    """Verdict on a case.

    Attributes:
        outcome: exact, sensitive, degraded, rejected or broken. reason: message, or which bound is missed by
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
        return list(motions.missed(self.figures))

    @property
    def cell(self) -> Cell:
        """The verdict, coarsely."""
        if self.outcome in (REJECTED, BROKEN):
            return Cell(self.outcome, None, cause(self.reason))
        power = math.ceil(math.log10(self.error)) if self.error else LEAST_POWER
        return Cell(self.outcome, max(LEAST_POWER, power), ", ".join(self.missed))

    def as_record(self) -> dict[str, Any]:
        """Plain dictionary with all figures and bounds."""
        case = self.case
        return {
            **{"axis": case.axis, "value": case.value, "layout": case.layout, "level": case.level.name},
            **{"verdict": self.outcome, "reason": self.reason},
            "figures": {name: dataclasses.asdict(figure) for name, figure in self.figures.items()},
        }


def cause(message: str) -> str:
    """Return the reason of a rejection: the sentence after the values, else the message without values."""
    reason = re.search(r"(?:\)\.|:) (.*?)(?:\. |[.;]?$|;)", message)
    return reason[1] if reason else message.partition(" (got ")[0]


def figures_of(trial: Trial) -> Figures:
    """Figures of a trial and their bounds, by name."""
    case, long, short, tight = trial.case, trial.long, trial.short, trial.tight
    result, energy = result_bound(case.accuracy, trial.sensitivity), energy_bound(case.accuracy)
    runs = ("", long), (", short steps", short)
    figures = {
        f"energy residual{how}": Figure(motions.relative(one.residual, one.energy), energy)
        for how, one in runs
    }
    figures["long against short steps"] = Figure(motions.distance(long, short), result)
    for name in (motions.SPEED, motions.TORQUE, motions.REGAINED):
        figures[name] = Figure(max(long.share(name), short.share(name)), BREACH)
    figures |= {f"work{how}": Figure(one.evaluations, work_bound(case, one)) for how, one in runs}
    if tight is not None:
        figures |= {f"error{how}": Figure(motions.distance(tight, one), result) for how, one in runs}
    return figures


def judge(trial: Trial) -> Verdict:
    """The verdict on a trial.

    Where runs differ and a change of the problem by the tolerance alone moves the end by more than
    LARGEST_ERROR, no method can say which is right: sensitive. An exception, a value that is not finite, a
    rejection in short steps only, or a rejected step that leaves the module changed or
    unusable is broken: a bug.
    """
    case, long, short = trial.case, trial.long, trial.short
    if long.broken:
        return Verdict(case, BROKEN, long.broken)
    if long.refused:
        return Verdict(case, REJECTED, long.refused)
    if short.refused:
        return Verdict(case, BROKEN, f"short steps: {short.refused}")
    if not (long.finite and short.finite):
        return Verdict(case, BROKEN, "an output is not finite")
    figures = figures_of(trial)
    reasons = motions.missed(figures)
    outcome = DEGRADED if reasons else EXACT
    if reasons and trial.sensitivity > LARGEST_ERROR and reasons.keys() <= set(COMPARED):
        outcome = SENSITIVE
    return Verdict(case, outcome, "; ".join(reasons.values()), figures)


def chosen_cases(only: str | None = None, quick: bool = False) -> list[Case]:
    """Cases of all axes, or of one alone, without those that take long if it is to be quick.

    Raises:
        ValueError: there is none of this name.
    """
    found = [case for axis, cases in axes().items() if only in (None, axis) for case in cases]
    if not found:
        raise ValueError(unknown("axis", only, axes()))
    return [case for case in found if not (quick and case.slow)]


def run_study(chosen: Sequence[Case], report: Progress = lambda done: None) -> list[Verdict]:
    """Verdicts on these cases, in their order; report is told how much is done (0 to 1)."""
    verdicts = []
    for number, case in enumerate(chosen, 1):
        verdicts.append(judge(try_case(case)))
        report(number / len(chosen))
    return verdicts


# --- the map: a row for each extreme and layout, a cell for each level ---


class Row(NamedTuple):
    """An extreme with its cells by name of the level (only those it says something about)."""

    axis: str
    value: str
    layout: str
    cells: dict[str, Cell]


def rows_of(verdicts: Iterable[Verdict]) -> list[Row]:
    """Rows of these verdicts, in their order."""
    rows: dict[tuple[str, str, str], Row] = {}
    for case, cell in ((verdict.case, verdict.cell) for verdict in verdicts):
        key = case.axis, case.value, case.layout
        rows.setdefault(key, Row(*key, {})).cells[case.level.name] = cell
    return list(rows.values())


def write_rows(path: Path, rows: Iterable[Row]) -> Path:
    """Write the rows as CSV, whole or not at all."""
    lines = ([*row[:3], *(row.cells.get(level.name, "") for level in motions.LEVELS)] for row in rows)
    return results.write_rows(path, HEADINGS, lines)


def read_rows(path: Path) -> list[Row]:
    """Rows that write_rows has written."""
    found = []
    for line in csv.DictReader(path.read_text().splitlines()):
        axis, value, layout = (line.pop(name) for name in HEADINGS[:3])
        found.append(Row(axis, value, layout, {name: Cell.of(text) for name, text in line.items() if text}))
    return found


def counts(rows: Sequence[Row]) -> dict[str, tuple[Counter[str], str]]:
    """For each level with a verdict: how many there are of each, and the largest error as a power of ten."""
    found = {}
    for name in HEADINGS[3:]:
        if cells := [row.cells[name] for row in rows if name in row.cells]:
            powers = [cell.power for cell in cells if cell.power is not None]
            largest = f"1e{max(powers):+03d}" if powers else "-"
            found[name] = Counter(cell.outcome for cell in cells), largest
    return found


def reasons(rows: Iterable[Row]) -> list[str]:
    """A line for each reason of a verdict that is not exact on an axis, with where it is given."""
    found: dict[tuple[str, ...], list[str]] = {}
    for row in rows:
        for level, cell in row.cells.items():
            if cell.outcome != EXACT:
                places = found.setdefault((row.axis, cell.outcome, cell.reason), [])
                places.append(f"{row.value} ({row.layout}, {level})")
    return [
        f"{axis}: {outcome}: {reason}. {len(places)} cases, such as {'; '.join(places[:6])}."
        for (axis, outcome, reason), places in found.items()
    ]


def summary(rows: Sequence[Row]) -> Picture:
    """Draw what came out of each axis, both layouts together: a bar for each level, parted by verdicts."""
    names = dict.fromkeys(row.axis for row in rows)
    levels = HEADINGS[3:]
    picture = Picture(figsize=(8.5, 1.0 + 0.24 * len(names)), dpi=120, layout="constrained")
    sheet = picture.subplots()
    for y, name in enumerate(names):
        for level, (found, _) in counts([row for row in rows if row.axis == name]).items():
            x, width = levels.index(level), 0.94 / found.total()
            left = x + 0.03
            for outcome in OUTCOMES:
                sheet.barh(y, width * found[outcome], left=left, color=COLOURS[outcome], height=0.84)
                left += width * found[outcome]
            told = f"{found[EXACT]} of {found.total()}"
            sheet.text(x + 0.5, y, told, ha="center", va="center", fontsize=6.5)
    sheet.set_xlim(0, len(levels))
    sheet.set_ylim(len(names) - 0.5, -0.5)
    sheet.set_xticks([x + 0.5 for x in range(len(levels))], levels)
    sheet.set_yticks(range(len(names)), list(names))
    sheet.xaxis.tick_top()
    sheet.tick_params(length=0, labelsize=8)
    sheet.spines[:].set_visible(False)
    handles = [Patch(color=colour, label=outcome) for outcome, colour in COLOURS.items()]
    picture.legend(handles=handles, loc="outside lower center", ncols=len(COLOURS), fontsize=8, frameon=False)
    return picture
