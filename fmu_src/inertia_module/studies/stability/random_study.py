"""Runs the random motions of a seed, shrinks those that fail, counts, prints and writes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from ...common.terminal import terminal
from ...harness import results
from ...memory.instances import Module
from .random_checks import NO_TELLING, REFERENCE, Finding, Make, examine
from .random_motions import Motion, draw_motion, rounded
from .verdict import Figure

HEADINGS = (
    "level of fidelity",
    "what has to hold",
    "runs",
    "cannot tell",
    "failed",
    "worst",
    "bound",
    "number",
)
# motions tried to make one that fails smaller
TRIES = 300
_NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?(e[-+]?\d+)?")


@dataclass(frozen=True)
class Outcome:
    """One motion of a campaign.

    Attributes:
        number: in the campaign. level: of fidelity. finding: what it showed.
        reproducer: the smallest motion found that fails or is refused in the same way, or None.
    """

    number: int
    level: str
    finding: Finding
    reproducer: dict[str, Any] | None = None


def sentence(message: str) -> str:
    """A refusal without its numbers."""
    return _NUMBER.sub("#", message)


def cause(finding: Finding) -> str:
    """The first thing that fails, or the refusal without its numbers; "" of what is sound."""
    return finding.failed[0] if finding.failed else sentence(finding.refused)


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
                    yield Motion(p, (*segments[:n], replace(part, **{name: tried}), *segments[n + 1 :]))


def shrunk(motion: Motion, wanted: str, make: Make = Module) -> Motion:
    """A smaller motion with the same cause of failure or refusal."""
    tries, found = 0, True
    while found:
        found = False
        for tried in smaller(motion):
            if tried == motion or tries >= TRIES:
                continue
            tries += 1
            finding = examine(tried, make, wanted != REFERENCE)
            if wanted in (*finding.failed, sentence(finding.refused)):
                motion, found = tried, True
                break
    return motion


def try_number(seed: int, number: int, make: Make = Module) -> Outcome:
    """Draw a motion, examine it and, where it fails or is refused, make it smaller."""
    motion = draw_motion(seed, number)
    finding = examine(motion, make)
    wanted = cause(finding)
    reproducer = shrunk(motion, wanted, make).as_dict() if wanted else None
    return Outcome(number, motion.level.name, finding, reproducer)


def run_random(number: int, seed: int, report: Callable[[float], None] = lambda done: None) -> list[Outcome]:
    """The outcomes of so many random motions, on all processors; the same for the same seed.

    Args:
        number: of motions. seed: of all of them. report: called with the share that is done.
    """
    from concurrent.futures import ProcessPoolExecutor

    Module().load_kernel()  # compiled once, before there are many who would
    outcomes = []
    with ProcessPoolExecutor() as pool:
        for outcome in pool.map(partial(try_number, seed), range(number), chunksize=4):
            outcomes.append(outcome)
            report(len(outcomes) / number)
    return outcomes


def rows_of(outcomes: Sequence[Outcome]) -> list[tuple[Any, ...]]:
    """A row of HEADINGS for each level and what has to hold there, and one of what is refused."""
    rows: list[tuple[Any, ...]] = []
    for level in sorted({outcome.level for outcome in outcomes}):
        here = [outcome for outcome in outcomes if outcome.level == level]
        for name in dict.fromkeys(name for outcome in here for name in outcome.finding.figures):
            found = [(one.finding.figures[name], one.number) for one in here if name in one.finding.figures]
            rows.append((level, name, *_counted(found)))
        refused = [outcome.number for outcome in here if outcome.finding.refused]
        rows.append((level, "refused", len(here), 0, len(refused), "", "", refused[0] if refused else ""))
    return rows


def _counted(found: Sequence[tuple[Figure, int]]) -> tuple[Any, ...]:
    """Runs, those that cannot tell, failures; the worst of its bound, the bound and the number of the motion."""
    told = [(figure, number) for figure, number in found if figure.bound < NO_TELLING]
    failed = sum(not figure.holds for figure, _ in told)
    worst, number = max(told, key=lambda one: one[0].value / max(one[0].bound, 1e-300), default=(None, ""))
    values = (f"{worst.value:.0e}", f"{worst.bound:.0e}") if worst else ("", "")
    return (len(found), len(found) - len(told), failed, *values, number)


def failures(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Those in which something did not hold."""
    return [outcome for outcome in outcomes if outcome.finding.failed]


def write_rows(path: Path, outcomes: Sequence[Outcome]) -> Path:
    """Write the rows as CSV, whole or not at all."""
    return results.write_rows(path, HEADINGS, rows_of(outcomes))


def print_outcomes(outcomes: Sequence[Outcome]) -> None:
    """Print the rows, each refusal with how often it came, each failure with what reproduces it."""
    from rich import box
    from rich.table import Table

    console = terminal()
    table = Table(*HEADINGS, box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for row in rows_of(outcomes):
        table.add_row(*map(str, row))
    console.print(table)
    for kind, count in Counter(sentence(one.finding.refused) for one in outcomes).items():
        if kind:
            first = next(one for one in outcomes if sentence(one.finding.refused) == kind)
            console.print(
                f"\n{count} refused: {kind}\nnumber {first.number}: {first.reproducer}", soft_wrap=True
            )
    for one in failures(outcomes):
        figure = one.finding.figures[one.finding.failed[0]]
        console.print(
            f"\nnumber {one.number} failed: {one.finding.failed[0]} {figure.value:.1e}, bound {figure.bound:.1e}\n"
            f"{one.reproducer}",
            soft_wrap=True,
        )
