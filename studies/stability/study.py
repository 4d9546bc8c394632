"""Runs the cases of the map, one after the other, and prints a line for each axis and level of fidelity."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from inertia_module.common.errors import did_you_mean
from inertia_module.common.terminal import terminal
from inertia_module.harness.simulate import Progress

from .axes import AXES, cases
from .case import LEVELS, Case
from .table import Row, reasons
from .trial import try_case
from .verdict import OUTCOMES, Verdict, judge


def chosen_cases(only: str | None = None, quick: bool = False) -> list[Case]:
    """Cases of all axes, or of one.

    Args:
        only: name of an axis. quick: leave out those that take long.

    Raises:
        ValueError: there is none of this name.
    """
    if only is not None and only not in AXES:
        raise ValueError(f"axis must be one of the map, is {only} {did_you_mean(only, AXES)}")
    return [case for axis in ([only] if only else AXES) for case in cases(axis, quick)]


def run_study(chosen: Sequence[Case], report: Progress = lambda done: None) -> list[Verdict]:
    """Verdicts on these cases, in their order; report is told how much is done (0 to 1)."""
    verdicts = []
    for number, case in enumerate(chosen, 1):
        verdicts.append(judge(try_case(case)))
        report(number / len(chosen))
    return verdicts


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
