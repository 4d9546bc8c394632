"""Runs the random motions of a seed, shrinks those that fail, counts, prints and writes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

from inertia_module.common.terminal import terminal
from inertia_module.harness import results
from inertia_module.memory import Module

from .random_checks import REFERENCE, SENSITIVE, VIRTUAL_WORK, Finding, Make, examine
from .random_motions import Motion, draw_motion, rounded
from .random_outcomes import Outcome, as_line, outcomes_file, read_outcomes
from .verdict import Figure

HEADINGS = ("level", "invariant", "runs", "explained", "sensitive", "failed", "worst", "bound", "number")
# rows that count: motions that take too long to be run again in other ways, and those refused
SHORT, TAKEN = "not long", "not refused"
# motions tried to make one that fails smaller; one that is given up, takes long or is compared counts more
TRIES, SLOW = 300, 15
_NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?(e[-+]?\d+)?")


def kind(message: str) -> str:
    """A refusal without its numbers."""
    return _NUMBER.sub("#", message)


def cause(finding: Finding) -> str:
    """The first thing that fails, or the refusal without its numbers; "" of what is sound."""
    return finding.failed[0] if finding.failed else kind(finding.refused)


def smaller(motion: Motion) -> Iterator[Motion]:
    """Motions with less in them: fewer segments, parameters at their defaults, rounder numbers."""
    p, segments = motion.parameters, motion.segments
    for n in range(len(segments)) if len(segments) > 1 else ():
        yield Motion(p, segments[:n] + segments[n + 1 :])
    for name in p:
        yield Motion({other: value for other, value in p.items() if other != name}, segments)
    for digits in (1, 2, 3):
        for name in p:
            yield Motion(p | {name: rounded(p[name], digits)}, segments)
        for n, part in enumerate(segments):
            for name in ("slope", "drive", "load", "omega1", "duration"):
                value = rounded(getattr(part, name), digits)
                for tried in (value,) if name == "duration" else (0.0, value):
                    changes: dict[str, Any] = {name: tried}
                    yield Motion(p, (*segments[:n], replace(part, **changes), *segments[n + 1 :]))


def shrunk(motion: Motion, wanted: str, make: Make = Module) -> Motion:
    """A smaller motion with the same cause of failure or refusal."""
    compared = wanted in (REFERENCE, VIRTUAL_WORK)
    left, found = TRIES, True
    while found:
        found = False
        for tried in smaller(motion):
            if tried == motion or left <= 0:
                continue
            finding = examine(tried, make, not compared)
            slow = compared or finding.long or "abandoned" in finding.refused
            left -= SLOW if slow else 1
            if wanted in (*finding.failed, kind(finding.refused)):
                motion, found = tried, True
                break
    return motion


def try_number(seed: int, number: int, make: Make = Module, losses: bool = False) -> Outcome:
    """Draw a motion, examine it and, where it fails or is refused, make it smaller."""
    motion = draw_motion(seed, number, losses)
    finding = examine(motion, make)
    wanted = cause(finding)
    reproducer = shrunk(motion, wanted, make).as_dict() if wanted else None
    return Outcome(number, motion.level.name, finding, reproducer)


def run_random(
    number: int,
    seed: int,
    folder: Path,
    report: Callable[[float], None] = lambda done: None,
    losses: bool = False,
) -> list[Outcome]:
    """The outcomes of so many random motions, on all processors; the same for the same seed.

    Each is kept in the folder (see outcomes_file): a run that was stopped goes on behind the last one.

    Args:
        number: of motions. seed: of all of them. folder: to keep them. report: called with the share done.
        losses: whether to draw losses by load, drag and gravity besides.
    """
    from concurrent.futures import ProcessPoolExecutor

    Module().load_kernel()  # compiled once, before there are many who would
    path = outcomes_file(folder, seed, losses)
    outcomes = read_outcomes(path)
    results.write_text(path, "".join(map(as_line, outcomes)))
    report(len(outcomes) / number)
    with ProcessPoolExecutor() as pool, path.open("a") as file:
        left = range(len(outcomes), number)
        for outcome in pool.map(partial(try_number, seed, losses=losses), left, chunksize=4):
            file.write(as_line(outcome))
            file.flush()
            outcomes.append(outcome)
            report(len(outcomes) / number)
    return outcomes[:number]


def rows_of(outcomes: Sequence[Outcome]) -> list[tuple[Any, ...]]:
    """A row of HEADINGS for each level and invariant; the last of a level count what was long, or refused."""
    rows: list[tuple[Any, ...]] = []
    for level in sorted({outcome.level for outcome in outcomes}):
        here = [outcome for outcome in outcomes if outcome.level == level]
        for name in dict.fromkeys(name for one in here for name in one.finding.figures):
            figures = [(one.finding.figures[name], one.number) for one in here if name in one.finding.figures]
            rows.append((level, name, *_counted(figures)))
        long = [one.number for one in here if one.finding.long]
        refused = [one.number for one in here if one.finding.refused]
        for name, numbers in ((SHORT, long), (TAKEN, refused)):
            rows.append((level, name, len(here), 0, 0, len(numbers), "", "", numbers[0] if numbers else ""))
    return rows


def _counted(figures: Sequence[tuple[Figure, int]]) -> tuple[Any, ...]:
    """Runs, those explained, sensitive, failed; the value next to its bound, or furthest over, where."""
    told = [(figure, number) for figure, number in figures if figure.bound < SENSITIVE]
    explained = sum(figure.explained for figure, _ in told)
    counts = len(figures), explained, len(figures) - len(told), sum(not figure.holds for figure, _ in told)
    if not told:
        return (*counts, "", "", "")
    worst, number = max(told, key=lambda one: one[0].value / max(one[0].bound, 1e-300))
    return (*counts, f"{worst.value:.0e}", f"{worst.bound:.0e}", number)


def findings(outcomes: Iterable[Outcome]) -> list[dict[str, Any]]:
    """Each way to fail or to be refused: how often, the first motion and what reproduces it."""
    kinds: dict[tuple[str, str], list[Outcome]] = {}
    for one in outcomes:
        if one.reproducer:
            kinds.setdefault((one.level, cause(one.finding)), []).append(one)
    return [
        {"level": level, "what": what, "count": len(all_of_it), **all_of_it[0].told}
        for (level, what), all_of_it in kinds.items()
    ]


def write_rows(path: Path, outcomes: Sequence[Outcome]) -> Path:
    """Write the rows as CSV, whole or not at all."""
    return results.write_rows(path, HEADINGS, rows_of(outcomes))


def print_outcomes(outcomes: Sequence[Outcome]) -> None:
    """Print the rows level by level, and each way to fail or to be refused with what reproduces it."""
    from rich import box
    from rich.table import Table

    console = terminal()
    for level, rows in groupby(rows_of(outcomes), itemgetter(0)):
        table = Table(*HEADINGS[1:], title=level, box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
        for row in rows:
            table.add_row(*map(str, row[1:]))
        console.print(table)
    for found in findings(outcomes):
        text = "\n{count} of {level}: {what}\nnumber {number}: {sentence}\n{reproducer}".format(**found)
        console.print(text, soft_wrap=True)
