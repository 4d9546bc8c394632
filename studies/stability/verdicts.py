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
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Picture
from matplotlib.patches import Patch

from inertia_module.common.colours import BLUE, GREEN, ORANGE, VERMILION
from inertia_module.common.errors import did_you_mean
from inertia_module.common.terminal import terminal
from inertia_module.contract.variables import LARGEST_STEP
from inertia_module.harness import results
from inertia_module.harness.results import TableError
from inertia_module.harness.simulate import Progress
from inertia_module.kernel.codes import ELASTIC, EVENT, KINEMATIC, TIMESTEPPING
from inertia_module.memory import Module

from ..reference.geometry import shaft_frequency, swing_frequency
from .extremes import MECHANISMS, Case, axes
from .motion import LEVELS, Figure, Figures, Make, Motion, Run, Segment, distance, relative, run

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
        precise = motion.parameters | {"method": EVENT, "max_step": 0.0}
        return Trial(case, long, short, *_precise(make, tuple(precise.items()), motion.segments))
    except Exception as error:  # whatever else it is, it is a finding
        return Trial(case, Run(broken=f"{type(error).__name__}: {error}"))


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
class Cell:
    """Verdict at one level: outcome, power of ten of the largest relative error (or None), and a reason."""

    outcome: str
    power: int | None = None
    reason: str = ""

    def __str__(self) -> str:
        size = "" if self.power is None else f"1e{self.power:+03d}"
        return SEPARATOR.join(part for part in (self.outcome, size, self.reason) if part)


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
    result = result_bound(case.accuracy, trial.sensitivity)
    runs = {"": long, ", short steps": short}
    figures = {}
    for suffix, found in runs.items():
        residual = relative(found.residual, found.energy)
        figures[f"energy residual{suffix}"] = Figure(residual, energy_bound(case.accuracy))
    figures["long against short steps"] = Figure(distance(long, short), result)
    for name, part, scale in (
        ("speed against a freewheel", "reversal", "speed"),
        ("torque against a freewheel", "pull", "torque"),
        ("lost energy regained", "regained", "energy"),
    ):
        worst = max(relative(getattr(run, part), getattr(run, scale)) for run in runs.values())
        figures[name] = Figure(worst, BREACH)
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
    verdicts = []
    for number, case in enumerate(chosen, 1):
        verdicts.append(judge(try_case(case)))
        report(number / len(chosen))
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
    cells = (
        [row.axis, row.value, row.layout, *(row.cells.get(level.name, "") for level in LEVELS)]
        for row in rows
    )
    return results.write_rows(path, HEADINGS, cells)


def read_rows(path: Path) -> list[Row]:
    """Rows that write_rows has written.

    Raises:
        TableError: other headings, or a cell that is no verdict.
    """
    headings, *lines = csv.reader(path.read_text().splitlines())
    if tuple(headings) != HEADINGS:
        raise TableError(f"{path} must have the headings {', '.join(HEADINGS)}")
    rows = []
    for number, (axis, value, layout, *texts) in enumerate(lines, 2):
        cells = {}
        for level, text in zip(LEVELS, texts, strict=True):
            outcome, *rest = text.split(SEPARATOR)
            if text and outcome not in OUTCOMES:
                raise TableError(
                    f"line {number}: a verdict must be one of {', '.join(OUTCOMES)}, is {text!r}"
                )
            power = int(rest.pop(0)[2:]) if rest and rest[0].startswith("1e") else None
            if text:
                cells[level.name] = Cell(outcome, power, SEPARATOR.join(rest))
        rows.append(Row(axis, value, layout, cells))
    return rows


def write_cases(path: Path, verdicts: Sequence[Verdict]) -> Path:
    """Write a row for each case with every figure and its bound, as CSV, whole or not at all."""
    names = list(dict.fromkeys(name for verdict in verdicts for name in verdict.figures))
    rows, heads = [], [*HEADINGS[:3], "level", "verdict", "reason"]
    for record in (verdict.as_record() for verdict in verdicts):
        figures = record.pop("figures")
        parts = (figures.get(name, {}).get(part, "") for name in names for part in ("value", "bound"))
        rows.append([*record.values(), *parts])
    return results.write_rows(
        path, [*heads, *(head for name in names for head in (name, f"{name}, bound"))], rows
    )


def counts(rows: Sequence[Row]) -> dict[str, tuple[Counter[str], str]]:
    """For each level with a verdict: how many there are of each, and the largest error as a power of ten."""
    found = {}
    for level in LEVELS:
        cells = [row.cells[level.name] for row in rows if level.name in row.cells]
        powers = [cell.power for cell in cells if cell.power is not None]
        if cells:
            largest = f"1e{max(powers):+03d}" if powers else "-"
            found[level.name] = Counter(cell.outcome for cell in cells), largest
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
    from rich.table import Table

    console = terminal()
    for axis in dict.fromkeys(row.axis for row in rows):
        here = [row for row in rows if row.axis == axis]
        counted = counts(here)
        outcomes = [name for name in OUTCOMES if any(count[name] for count, _ in counted.values())]
        table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
        table.add_column("level of fidelity", no_wrap=True)
        for name in outcomes:
            table.add_column(name, justify="right", no_wrap=True)
        table.add_column("error up to", justify="right")
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
    names = list(dict.fromkeys(row.axis for row in rows))
    picture = Picture(figsize=(8.5, 1.0 + 0.24 * len(names)), dpi=120, layout="constrained")
    drawn = []
    for axis in names:
        counted = counts([row for row in rows if row.axis == axis])
        drawn.append(
            {level: (count, f"{count[EXACT]} of {count.total()}") for level, (count, _) in counted.items()}
        )
    sheet = picture.subplots()
    _draw(sheet, drawn, [level.name for level in LEVELS], len(names), fontsize=6.5)
    sheet.set_yticks(range(len(names)), names)
    sheet.tick_params(labelsize=8)
    return _with_legend(picture)
