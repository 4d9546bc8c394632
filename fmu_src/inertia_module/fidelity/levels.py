"""Levels of fidelity: what each models, the settings at which it is measured, the rows of measurements.

The cheapest level that meets an accuracy is chosen from measured rows, with its reasons.
"""

from __future__ import annotations

import csv
import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..common.terminal import Progress
from ..contract.variables import ENUMERATIONS, VARIABLES
from ..harness import results
from ..kernel.codes import AVERAGED, ELASTIC, EVENT, RIGID, TIMESTEPPING

FIDELITIES = {number: name for name, number, _ in ENUMERATIONS["Fidelity"]}
METHODS = {number: name for name, number, _ in ENUMERATIONS["Method"]}

# outputs that a fidelity does not model, and why; everything else it has
NOT_MODELLED: Mapping[int, Mapping[str, str]] = {
    fidelity: {
        variable.name: need.reason
        for variable in VARIABLES
        for need in variable.needs
        if fidelity in need.lacking
    }
    for fidelity in FIDELITIES
}


@dataclass(frozen=True)
class Level:
    """Level of fidelity at one setting.

    Attributes:
        fidelity, method: numbers as in the table of variables. setting: as it is printed.
        parameters: that make the setting, such as tolerance.
    """

    fidelity: int
    method: int
    setting: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Fidelity and, where there is a choice of one, method, such as "rigid, event"."""
        return self.row(0.0).level

    @property
    def values(self) -> dict[str, float]:
        """Parameters of the module for this level."""
        return {"fidelity": float(self.fidelity), "method": float(self.method), **self.parameters}

    def row(self, step: float) -> Row:
        """Make the row of the level in communication steps, s, before anything is measured."""
        method = METHODS[self.method] if self.fidelity in (RIGID, ELASTIC) else ""
        return Row(FIDELITIES[self.fidelity], method, self.setting, step)


def event(fidelity: int, tolerance: float) -> Level:
    """Make a level from event to event, at a tolerance."""
    return Level(fidelity, EVENT, f"tolerance {tolerance:.0e}", {"tolerance": tolerance})


def timestepping(fidelity: int, step: float) -> Level:
    """Make a level in fixed steps, s."""
    return Level(fidelity, TIMESTEPPING, f"step {1e3 * step:g} ms", {"max_step": step})


TOLERANCES = tuple(10.0**-n for n in range(3, 12))
STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
_FEW_TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
_FEW_STEPS = (1e-2, 1e-3, 1e-4)


def all_levels(elastic: bool, few: bool = False) -> Iterator[Level]:
    """Yield the levels to measure, from coarse to fine, without prescribed motion.

    Args:
        elastic: there are parameters of an elastic output.
        few: fewer tolerances and steps, for long scenes.
    """
    yield Level(AVERAGED, EVENT, "map")
    for fidelity in (RIGID, ELASTIC) if elastic else (RIGID,):
        for step in _FEW_STEPS if few else STEPS:
            yield timestepping(fidelity, step)
        for tolerance in _FEW_TOLERANCES if few else TOLERANCES:
            yield event(fidelity, tolerance)


# --- measurements ---

_HEADS = ("fidelity", "method", "setting", "communication_step [s]")
_COSTS = {
    "wall_time_per_second [s]": "wall_time",
    "rhs_evaluations": "evaluations",
    "contact_switches": "switches",
}
# fidelity of a row of another integrator
PEER = "peer"
# what a run may end with: refusals, missing libraries, integrators that give up
FAILURES = (ValueError, RuntimeError, ArithmeticError, MemoryError)


@dataclass(frozen=True)
class Row:
    """Measurements of one run.

    Attributes:
        fidelity: its name, or "peer". method: of integration. setting: such as "tolerance 1e-06".
        communication_step: s. errors: by name, NaN where nothing is known.
        wall_time: s per simulated second, of the integration alone. evaluations: of the right-hand side.
        switches: counted, NaN where they are not. failure: why there is nothing measured, else "".
    """

    fidelity: str
    method: str
    setting: str
    communication_step: float
    errors: Mapping[str, float] = field(default_factory=dict)
    wall_time: float = math.nan
    evaluations: float = math.nan
    switches: float = math.nan
    failure: str = ""

    @property
    def level(self) -> str:
        """Fidelity and method, such as "rigid, event"."""
        return f"{self.fidelity}, {self.method}" if self.method else self.fidelity

    @property
    def label(self) -> str:
        """Fidelity, method and setting."""
        return f"{self.level}, {self.setting}" if self.setting else self.level

    def worst(self, wanted: Sequence[str]) -> float:
        """Largest error of the wanted ones; infinite where one is not known."""
        errors = [self.errors.get(name, math.nan) for name in wanted]
        unknown = self.failure or any(map(math.isnan, errors))
        return math.inf if unknown else max(errors, default=math.inf)

    def as_dict(self) -> dict[str, Any]:
        """Give the row for machines: what is not known is None."""

        def known(value: float) -> float | None:
            return value if math.isfinite(value) else None

        heads = ("fidelity", "method", "setting", "communication_step")
        head = {name: getattr(self, name) for name in heads}
        costs = {name.partition(" ")[0]: known(getattr(self, cost)) for name, cost in _COSTS.items()}
        errors = {name: known(value) for name, value in self.errors.items()}
        return {**head, "errors": errors, **costs, "failure": self.failure}


# what is to be run, nothing of it measured, and what measures it: gives fields of Row by name
Attempt = tuple[Row, Callable[[Progress], dict[str, Any]]]


def attempt_all(
    attempts: Sequence[Attempt], progress: Progress | None = None, begin: float = 0.0
) -> list[Row]:
    """Make all runs; what fails is a row with the reason.

    Args:
        attempts: the runs; each is given a function to tell how much of it is done (0 to 1).
        progress: told how much is done. begin: share that was done before.
    """
    tell = progress or (lambda done: None)
    share = (1.0 - begin) / max(len(attempts), 1)
    rows = []
    for number, (head, run) in enumerate(attempts):
        start = begin + number * share
        try:
            found = run(lambda done, start=start: tell(start + done * share))  # type: ignore[misc]
        except FAILURES as error:
            found = {"failure": " ".join(str(error).split()) or type(error).__name__}
        rows.append(dataclasses.replace(head, **found))
        tell(start + share)
    return rows


def write_rows(path: Path, rows: Sequence[Row]) -> Path:
    """Write all rows as CSV, failures too; whole or not at all."""
    names = list(dict.fromkeys(name for row in rows for name in row.errors))
    lines = []
    for row in rows:
        numbers = [row.errors.get(name, math.nan) for name in names]
        numbers += [getattr(row, name) for name in _COSTS.values()]
        cells = ["" if math.isnan(value) else float(value) for value in numbers]
        lines.append([row.fidelity, row.method, row.setting, row.communication_step, *cells, row.failure])
    headings = [*_HEADS, *(f"error {name}" for name in names), *_COSTS, "failure"]
    return results.write_rows(path, headings, lines)


def read_rows(path: Path) -> list[Row]:
    """Read rows that write_rows has written.

    Raises:
        OSError: there is no such file. ValueError: it is another table.
    """
    table = csv.DictReader(path.read_text().splitlines())
    if tuple(table.fieldnames or ())[: len(_HEADS)] != _HEADS:
        raise ValueError(f"{path} must begin with the headings {', '.join(_HEADS)}")
    rows = []
    for line in table:
        fidelity, method, setting, step, failure = (line.pop(name) for name in (*_HEADS, "failure"))
        numbers = {name: float(text) if text else math.nan for name, text in line.items()}
        costs = {cost: numbers.pop(name) for name, cost in _COSTS.items()}
        errors = {name.removeprefix("error "): value for name, value in numbers.items()}
        rows.append(Row(fidelity, method, setting, float(step), errors, failure=failure, **costs))
    return rows


def failure_lines(rows: Sequence[Row]) -> list[str]:
    """Say in a line for each kind of run that failed why it did."""
    labels: dict[str, dict[str, None]] = {}
    for row in rows:
        if row.failure:
            labels.setdefault(row.failure, {})[row.label] = None
    return [f"failed: {'; '.join(found)}: {reason}" for reason, found in labels.items()]


# --- the cheapest that meets an accuracy ---

_NUMBER = {name: number for number, name in FIDELITIES.items()}
# where there is no higher fidelity, the next level is one that is so much more accurate
_FINER = 0.1
# the largest error of a level shown where none is asked for
USUAL_ERROR = 0.01
# columns that any table fits in
_WIDE = 10_000


class NoneMeets(ValueError):
    """No measured level meets the accuracy: how far the best of them gets, and why others do not count."""


@dataclass(frozen=True)
class Choice:
    """Chosen level and the reasons.

    Attributes:
        row: the cheapest that meets the error. wanted: outputs it was asked of. error: asked for.
        following: the next level that meets it too, or None. passed: cheaper levels and why not.
    """

    row: Row
    wanted: tuple[str, ...]
    error: float
    following: Row | None
    passed: Mapping[str, str]

    @property
    def ratio(self) -> float | None:
        """Wall time of the next level over that of the chosen one."""
        return None if self.following is None else self.following.wall_time / self.row.wall_time

    def lines(self) -> list[str]:
        """Say what was chosen, why, and what the next level would cost."""

        def cost(row: Row) -> str:
            return f"{1e3 * row.wall_time:.3g} ms per simulated second in the kernel"

        worst = max(self.wanted, key=lambda name: self.row.errors[name])
        met = f"error {self.row.worst(self.wanted):.2g} ({worst}) where {self.error:g} was asked for"
        lines = [f"chosen: {self.row.label}: {met}, {cost(self.row)}"]
        lines += [f"not enough: {label}: {reason}" for label, reason in self.passed.items()]
        if self.following is None:
            return [*lines, "next level: none of those measured"]
        reached = f"error {self.following.worst(self.wanted):.2g}, {cost(self.following)}"
        return [*lines, f"next level: {self.following.label}: {reached}, {self.ratio:.3g} times as long"]

    def as_dict(self) -> dict[str, Any]:
        """Give the choice for machines."""

        def brief(row: Row) -> dict[str, Any]:
            known = {name: getattr(row, name) for name in ("fidelity", "method", "setting")}
            errors = {name: row.errors[name] for name in self.wanted}
            cost = {"wall_time_per_second": row.wall_time}
            return {**known, "error": row.worst(self.wanted), **cost, "errors": errors}

        following = None if self.following is None else brief(self.following) | {"cost": self.ratio}
        asked = {"error": self.error, "wanted": list(self.wanted)}
        return {"asked": asked, "chosen": brief(self.row), "passed": dict(self.passed), "next": following}


def why_not(row: Row, error: float, wanted: Sequence[str]) -> str:
    """Say why a row does not meet an error, "" where it does."""
    if row.failure:
        return row.failure
    lacking = NOT_MODELLED.get(_NUMBER.get(row.fidelity, -1), {})
    for name in wanted:
        if name in lacking:
            return f"it {lacking[name]} ({name})"
    unknown = [name for name in wanted if math.isnan(row.errors.get(name, math.nan))]
    if unknown:
        return f"nothing is known of {', '.join(unknown)}"
    worst = max(wanted, key=lambda name: row.errors[name])
    return "" if row.errors[worst] <= error else f"error {row.errors[worst]:.2g} ({worst})"


def cheapest(rows: Sequence[Row]) -> Row | None:
    """Pick the cheapest by wall time; of settings of one level by right-hand sides, which do not jitter."""
    best: dict[tuple[str, float], Row] = {}
    for row in sorted(rows, key=lambda row: row.evaluations):
        best.setdefault((row.level, row.communication_step), row)
    return min(best.values(), key=lambda row: row.wall_time, default=None)


def recommend(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> Choice:
    """Recommend the cheapest level of the module that meets an error in all wanted outputs.

    The next is the cheapest of a higher fidelity that meets it too, else the cheapest that is much finer.

    Args:
        rows: measured; those of peers are left out. error: largest allowed. wanted: names in Row.errors.

    Raises:
        NoneMeets: none of them does.
    """
    ours = sorted((row for row in rows if row.fidelity in _NUMBER), key=lambda row: row.worst(wanted))
    meeting = [row for row in ours if not why_not(row, error, wanted)]
    chosen = cheapest(meeting)
    if chosen is None:
        best = (
            f"the best is {ours[0].label}: {why_not(ours[0], error, wanted)}" if ours else "none was measured"
        )
        raise NoneMeets(f"error = {error:g} in {', '.join(wanted)} is met by no level of fidelity; {best}")
    higher = [row for row in meeting if _NUMBER[row.fidelity] > _NUMBER[chosen.fidelity]]
    much = _FINER * min(error, chosen.worst(wanted))
    finer = [row for row in meeting if row.worst(wanted) <= much and row.wall_time > chosen.wall_time]
    # one line a level: its best that is cheaper or, where nothing is known, any
    passed: dict[str, tuple[str, str]] = {}
    for row in ours:
        reason = why_not(row, error, wanted)
        if reason and not row.wall_time > chosen.wall_time:
            passed.setdefault(row.level, (row.label, reason))
    following = cheapest(higher) or cheapest(finer)
    return Choice(chosen, tuple(wanted), error, following, dict(passed.values()))


# --- on a terminal ---


def at_levels(rows: Sequence[Row], error: float, wanted: Sequence[str]) -> list[Row]:
    """Pick a row for each fidelity and method: its cheapest that meets the error, else its most accurate.

    The cheapest is found as in recommend, so the recommended row is one of these.
    """
    levels: dict[str, list[Row]] = {}
    for row in rows:
        levels.setdefault(row.level, []).append(row)
    return [
        cheapest([row for row in level if not why_not(row, error, wanted)])
        or min(level, key=lambda row: row.worst(wanted))
        for level in levels.values()
    ]


def _table(rows: Sequence[Row], wanted: Sequence[str], largest: bool) -> Any:
    """Lay out a column for each wanted output, or one for the largest error and one for where it is."""
    from rich import box
    from rich.table import Table

    def text(number: float, form: str) -> str:
        return "-" if math.isnan(number) else format(number, form)

    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for heading in ("level of fidelity", "setting"):
        table.add_column(heading, no_wrap=True)
    for heading in ("error",) if largest else wanted:
        table.add_column(heading.replace("_", " "), justify="right")
    table.add_column("ms per s", justify="right")
    if largest:
        table.add_column("largest error in", no_wrap=True)
    for row in rows:
        known = {name: row.errors.get(name, math.nan) for name in wanted}
        # an output that nothing is known of counts as the worst
        worst = [max(known, key=lambda name: (math.isnan(known[name]), known[name]))] if largest else []
        errors = [text(known[name], ".1e") for name in worst or wanted]
        level = row.method if row.fidelity == PEER else row.level
        table.add_row(level, row.setting, *errors, text(1e3 * row.wall_time, ".3g"), *worst)
    return table


def print_levels(title: str, rows: Sequence[Row], wanted: Sequence[str], error: float | None = None) -> None:
    """Print a line for each level of fidelity: its errors in the wanted outputs, and its cost.

    Where the terminal is too narrow for all of these outputs, the one with the largest error is named.

    Args:
        title: of the table. rows: measured, in one communication step. wanted: names in Row.errors.
        error: largest allowed; by default USUAL_ERROR.
    """
    from ..common.terminal import terminal

    console = terminal()
    allowed = USUAL_ERROR if error is None else error
    levels = at_levels(rows, allowed, wanted)
    console.print(title, style="bold")
    console.print(
        f"Each level at its cheapest setting with errors up to {allowed:g}, else at its most accurate;"
        f" communication step {rows[0].communication_step:g} s; ms of the kernel per simulated second"
    )
    table = _table(levels, wanted, largest=False)
    if console.measure(table, options=console.options.update(width=_WIDE)).minimum > console.width:
        table = _table(levels, wanted, largest=True)
    console.print(table)
