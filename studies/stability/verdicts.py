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
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Self

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Picture
from matplotlib.patches import Patch

from inertia_module.common.colours import BLUE, GREEN, ORANGE, VERMILION
from inertia_module.common.errors import did_you_mean
from inertia_module.common.terminal import terminal
from inertia_module.contract.variables import LARGEST_STEP
from inertia_module.harness import results
from inertia_module.harness.simulate import Progress
from inertia_module.kernel.codes import ELASTIC, EVENT, KINEMATIC, TIMESTEPPING
from inertia_module.memory import Module

from ..reference.geometry import shaft_frequency, swing_frequency
from .extremes import MECHANISMS, Case, axes
from .motion import LEVELS, Figure, Figures, Make, Motion, Run, Segment, distance, run

# relative rounding that adds up over a run
ROUNDING = 1e-12
# tolerances that the energy residual may come to, of the largest energy
ENERGY_TOLERANCES = 100.0
# accuracies, and effects of a change of the problem by a tolerance, that a result may be off
RESULT_ACCURACIES = 3.0
# no relative error is allowed to be larger, whatever accuracy is asked for: a looser bound would say nothing
LARGEST_ERROR = 0.1
# breach of a freewheel, of the largest torque or speed; of what in Run.shares
BREACH = 1e-9
BREACHES = {
    "speed against a freewheel": "reversal",
    "torque against a freewheel": "pull",
    "lost energy regained": "regained",
}
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
COLOURS = {EXACT: GREEN, SENSITIVE: BLUE, DEGRADED: ORANGE, REFUSED: "#BBBBBB", BROKEN: VERMILION}
OUTCOMES = tuple(COLOURS)
# figures that compare two runs of one motion, and all that are relative errors
COMPARED = ("long against short steps", "error", "error, short steps")
RELATIVE = ("energy residual", "energy residual, short steps", *COMPARED)
HEADINGS = ("axis", "value", "layout", *(level.name for level in LEVELS))
# below this errors are rounding
LEAST_POWER = -15
SEPARATOR = " | "


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


def work_bound(case: Case, found: Run) -> float:
    """Right-hand sides allowed for the phase, communication steps and internal steps of a run."""
    motion = case.motion
    if case.level.method == TIMESTEPPING:
        return STEP_WORK * found.steps + FIXED_STEP_WORK * found.fixed_steps
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
        tight: at a far tighter tolerance, by events (None where it is refused).
        sensitivity: of the motion itself: largest distance from tight by relative changes of the tolerance's
            size (angle at the start, load, speed of link 1), as far as it takes to explain the other runs.
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
            # by the highest harmonic at the fastest input and the swing of link 2 on weights; 0 at rest
            module = motion.changed(fidelity=KINEMATIC, method=EVENT).started(make())
            fastest = max(part.fastest for part in motion.segments)
            rate = float(module.derived.harmonic * module.derived.k) * fastest
            rate += swing_frequency(module.__getitem__)
            motion = motion.changed(max_step=min(FIXED_PHASE / rate, LARGEST_STEP) if rate > 1e-300 else 0.0)
        long = run(motion, make)
        if long.refused:
            return Trial(case, long)
        short = run(motion, make, case.split)
        tolerance = motion["tolerance"]
        precise = motion.changed(method=EVENT, max_step=0.0, tolerance=max(TIGHTER * tolerance, TIGHTEST))
        tight = _tight(make, tuple(precise.parameters.items()), motion.segments)
        trial = Trial(case, long, short, None if tight.refused else tight)
        for beside in () if tight.refused or short.refused else precise.nudged(tolerance):
            if all(figure.holds for name, figure in measure(trial, short).items() if name in COMPARED):
                break
            changed = run(beside, make)
            if not changed.refused:
                trial = replace(trial, sensitivity=max(trial.sensitivity, distance(changed, tight)))
        return trial
    except Exception as error:  # whatever else it is, it is a finding
        return Trial(case, Run(broken=f"{type(error).__name__}: {error}"))


@lru_cache(maxsize=1)  # the methods of a fidelity, which come one after the other, share it
def _tight(make: Make, parameters: tuple[tuple[str, float], ...], segments: tuple[Segment, ...]) -> Run:
    """The run of a motion."""
    return run(Motion(dict(parameters), segments), make)


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

    @property
    def cell(self) -> Cell:
        """The verdict, coarsely."""
        if self.outcome in (REFUSED, BROKEN):
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
    """Reason of a refusal, without the values and what is allowed."""
    found = re.search(r": ([^;]*)", message)
    return found.group(1).strip() if found else message.partition(", are ")[0]


def measure(trial: Trial, short: Run) -> Figures:
    """All figures of a trial that ran through, by name."""
    case, long, tight = trial.case, trial.long, trial.tight
    result, energy = result_bound(case.accuracy, trial.sensitivity), energy_bound(case.accuracy)
    runs = {"": long, ", short steps": short}
    figures = {f"energy residual{told}": Figure(one.shares["residual"], energy) for told, one in runs.items()}
    figures["long against short steps"] = Figure(distance(long, short), result)
    for name, part in BREACHES.items():
        figures[name] = Figure(max(long.shares[part], short.shares[part]), BREACH)
    for told, one in runs.items():
        figures[f"work{told}"] = Figure(one.evaluations, work_bound(case, one))
    if tight is not None:
        figures |= {f"error{told}": Figure(distance(tight, one), result) for told, one in runs.items()}
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


def chosen_cases(only: str | None = None, quick: bool = False) -> list[Case]:
    """Cases of all axes, or of one.

    Args:
        only: name of an axis. quick: leave out those that take long.

    Raises:
        ValueError: there is none of this name.
    """
    if only is not None and only not in axes():
        raise ValueError(f"axis must be one of the map, is {only} {did_you_mean(only, axes())}")
    chosen = [only] if only else axes()
    return [case for axis in chosen for case in axes()[axis] if not (quick and case.slow)]


def run_study(chosen: Sequence[Case], report: Progress = lambda done: None) -> list[Verdict]:
    """Verdicts on these cases, in their order; report is told how much is done (0 to 1)."""
    verdicts: list[Verdict] = []
    for case in chosen:
        verdicts.append(judge(try_case(case)))
        report(len(verdicts) / len(chosen))
    return verdicts


# --- the map: a row for each extreme and layout, a cell for each level ---


@dataclass(frozen=True)
class Row:
    """An extreme with its cells by name of the level (only those it says something about)."""

    axis: str
    value: str
    layout: str
    cells: dict[str, Cell]


def rows_of(verdicts: Iterable[Verdict]) -> list[Row]:
    """Rows of these verdicts, in their order."""
    rows: dict[tuple[str, str, str], dict[str, Cell]] = {}
    for verdict in verdicts:
        case = verdict.case
        rows.setdefault((case.axis, case.value, case.layout), {})[case.level.name] = verdict.cell
    return [Row(*key, cells) for key, cells in rows.items()]


def write_rows(path: Path, rows: Iterable[Row]) -> Path:
    """Write the rows as CSV, whole or not at all."""
    lines = (
        [row.axis, row.value, row.layout, *(row.cells.get(name, "") for name in HEADINGS[3:])] for row in rows
    )
    return results.write_rows(path, HEADINGS, lines)


def read_rows(path: Path) -> list[Row]:
    """Rows that write_rows has written."""
    _, *lines = csv.reader(path.read_text().splitlines())
    names = HEADINGS[3:]
    return [
        Row(
            axis,
            value,
            layout,
            {name: Cell.of(text) for name, text in zip(names, texts, strict=True) if text},
        )
        for axis, value, layout, *texts in lines
    ]


def write_cases(path: Path, verdicts: Sequence[Verdict]) -> Path:
    """Write a row for each case with every figure and its bound, as CSV, whole or not at all."""
    rows = []
    for record in (verdict.as_record() for verdict in verdicts):
        for name, figure in record.pop("figures").items():
            record |= {name: figure["value"], f"{name}, bound": figure["bound"]}
        rows.append(record)
    heads = list(dict.fromkeys(head for row in rows for head in row))
    return results.write_rows(path, heads, ([row.get(head, "") for head in heads] for row in rows))


def by_axis(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """Rows of each axis."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row.axis, []).append(row)
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
    """A line for each reason of a verdict that is not exact, with where it is given."""
    found: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        for level, cell in row.cells.items():
            if cell.outcome != EXACT:
                places = found.setdefault((cell.outcome, cell.reason), [])
                places.append(f"{row.value} ({row.layout}, {level})")
    return [
        f"{outcome}: {reason}. "
        + ("; ".join(places) if len(places) <= 6 else f"{len(places)} cases, the first: {places[0]}")
        + "."
        for (outcome, reason), places in found.items()
    ]


def print_rows(rows: Sequence[Row]) -> None:
    """Print a line for each axis and level of fidelity, below them what is not exact, and the counts."""
    from rich import box
    from rich.table import Column, Table

    console = terminal()
    for axis, here in by_axis(rows).items():
        counted = counts(here)
        outcomes = [name for name in OUTCOMES if any(count[name] for count, _ in counted.values())]
        columns = (Column(name, justify="right", no_wrap=True) for name in (*outcomes, "error up to"))
        first = Column("level of fidelity", no_wrap=True)
        table = Table(first, *columns, box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
        for level, (count, largest) in counted.items():
            table.add_row(level, *(str(count[name]) for name in outcomes), largest)
        console.print(f"\n{axis}", style="bold")
        console.print(table)
        for line in reasons(here):
            console.print(f"- {line}")
    total = sum((count for count, _ in counts(rows).values()), Counter[str]())
    console.print("\n" + ", ".join(f"{total[name]} {name}" for name in OUTCOMES))


# --- drawn ---

LAYOUTS_AND_LEVELS = [f"{mechanism.layout}, {level.name}" for mechanism in MECHANISMS for level in LEVELS]
# sheets side by side, so that the picture is no ribbon
SHEETS = 3
# what is drawn of a place: verdicts, and a text upon them
Drawn = Mapping[str, tuple[Counter[str], str]]


def _draw(sheet: Axes, rows: Sequence[Drawn], columns: Sequence[str], height: int, **text: Any) -> None:
    """Draw rows downwards: bars in columns, parted by verdicts, with texts upon them."""
    for y, row in enumerate(rows):
        for x, column in enumerate(columns):
            found, told = row.get(column, (Counter[str](), ""))
            left = x + 0.03
            for outcome in sorted(found, key=OUTCOMES.index):
                width = 0.94 * found[outcome] / found.total()
                sheet.barh(y, width, left=left, color=COLOURS[outcome], height=0.84)
                left += width
            sheet.text(x + 0.5, y, told, ha="center", va="center", **text)
    sheet.set_xlim(0, len(columns))
    sheet.set_ylim(height - 0.5, -0.5)
    sheet.set_xticks([x + 0.5 for x in range(len(columns))], columns)
    sheet.xaxis.tick_top()
    sheet.tick_params(length=0)
    sheet.spines[:].set_visible(False)


def _with_legend(picture: Picture) -> Picture:
    handles = [Patch(color=colour, label=outcome) for outcome, colour in COLOURS.items()]
    picture.legend(handles=handles, loc="outside lower center", ncols=len(COLOURS), fontsize=8, frameon=False)
    return picture


def verdict_map(rows: Sequence[Row]) -> Picture:
    """Draw every extreme: colours are verdicts, numbers powers of ten of the largest relative error.

    Args:
        rows: of rows_of or read_rows.
    """
    extremes: dict[tuple[str, str], dict[str, tuple[Counter[str], str]]] = {}
    for row in rows:
        drawn = extremes.setdefault((row.axis, row.value), {})
        for level, cell in row.cells.items():
            power = "" if cell.power is None else str(cell.power)
            drawn[f"{row.layout}, {level}"] = Counter([cell.outcome]), power
    sheets = SHEETS if len(extremes) > 60 else 1
    height = -(-len(extremes) // sheets)
    picture = Picture(figsize=(5.2 * sheets, 2.2 + 0.17 * height), dpi=120, layout="constrained")
    names = list(extremes)
    for n, sheet in enumerate(picture.subplots(1, sheets, squeeze=False)[0]):
        here = names[n * height : (n + 1) * height]
        _draw(sheet, [extremes[name] for name in here], LAYOUTS_AND_LEVELS, height, fontsize=5, color="white")
        for y, (axis, value) in enumerate(here):
            sheet.text(len(LAYOUTS_AND_LEVELS) + 0.15, y, value, ha="left", va="center", fontsize=6)
            if y == 0 or here[y - 1][0] != axis:
                sheet.axhline(y - 0.5, color="black", linewidth=0.6)
                label = {"ha": "right", "va": "center", "fontsize": 6.5, "fontweight": "bold"}
                sheet.text(-0.15, y, f"{axis}: ", **label)
        sheet.tick_params("x", rotation=90, labelsize=6)
        sheet.set_yticks([])
    return _with_legend(picture)


def summary(rows: Sequence[Row]) -> Picture:
    """Draw what came out of each axis, both layouts together: a bar for each level, parted by verdicts.

    Args:
        rows: of rows_of or read_rows.
    """
    names = by_axis(rows)
    picture = Picture(figsize=(8.5, 1.0 + 0.24 * len(names)), dpi=120, layout="constrained")
    drawn = [
        {level: (count, f"{count[EXACT]} of {count.total()}") for level, (count, _) in counts(here).items()}
        for here in names.values()
    ]
    sheet = picture.subplots()
    _draw(sheet, drawn, HEADINGS[3:], len(names), fontsize=6.5)
    sheet.set_yticks(range(len(names)), list(names))
    sheet.tick_params(labelsize=8)
    return _with_legend(picture)
