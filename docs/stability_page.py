"""Figures of docs/stability.md: the committed verdicts, counted, and the bounds in the code."""

import csv
from collections import Counter
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from inertia_module.kernel import limits
from inertia_module.studies.stability import (
    bounds,
    case,
    loss_axes,
    random_checks,
    random_motions,
    random_study,
    trial,
)
from inertia_module.studies.stability.study import counts
from inertia_module.studies.stability.table import read_rows
from inertia_module.studies.stability.verdict import BROKEN, EXACT, OUTCOMES, REFUSED

TABLE = Path(__file__).parent / "stability.csv"
RANDOM = Path(__file__).parent / "random.csv"
RANDOM_LOSSES = Path(__file__).parent / "random_losses.csv"
# columns of the table of random motions: all runs, and of them those beyond the bound asked for
COUNTS = "runs", "explained", "sensitive", "failed"


def exceptions(rows):
    """A line for each level and verdict that is not exact, with the axes it is on; one for each refusal."""
    axes, refusals = {}, Counter()
    for row in rows:
        for level, cell in row.cells.items():
            if cell.outcome == REFUSED:
                refusals[cell.reason.partition(" with ")[0]] += 1
            elif cell.outcome != EXACT:
                axes.setdefault((level, cell.outcome), Counter())[row.axis] += 1
    for (level, outcome), count in sorted(axes.items()):
        found = ", ".join(f"{axis} {number}" for axis, number in count.most_common())
        yield f"- {level}, {outcome}: {found}."
    for reason, number in refusals.most_common():
        yield f"- {number} refused: {reason}."


def levels_with(rows):
    """A line for each axis of losses: whether a level takes it, refuses it, or has no such part."""
    names = [level.name for level in case.LEVELS]
    yield f"| | {' | '.join(names)} |\n|---|{'---|' * len(names)}"
    for axis in (axis.__name__.replace("_", " ") for axis in loss_axes.LOSS_AXES):
        outcomes = {name: set() for name in names}
        for row in rows:
            if row.axis == axis:
                for name, cell in row.cells.items():
                    outcomes[name].add(cell.outcome)
        told = ("refused" if found == {REFUSED} else "yes" if found else "" for found in outcomes.values())
        yield f"| {axis} | {' | '.join(told)} |"


def share(row):
    """How much of its bound the worst value has, -1 where there is none."""
    return float(row["worst"]) / max(float(row["bound"]), 1e-300) if row["worst"] else -1.0


def random_rows(rows):
    """A line for each invariant of the random motions: counts over all levels, and the worst of them."""
    for name, group in groupby(sorted(rows, key=itemgetter("invariant")), itemgetter("invariant")):
        found = list(group)
        worst = max(found, key=share)
        counts = (str(sum(int(row[head]) for row in found)) for head in COUNTS)
        cells = (name, *counts, worst["worst"], worst["bound"], worst["level"], worst["number"])
        yield f"| {' | '.join(cells if worst['worst'] else (*cells[:5], '', '', '', ''))} |"


def random_counts(rows, reference=random_checks.REFERENCE):
    """What the random motions count to: tried, refused, and those within the error of the reference."""

    def count(head, *invariants, levels=None):
        chosen = (
            row for row in rows if row["invariant"] in invariants and (not levels or row["level"] in levels)
        )
        return sum(int(row[head]) for row in chosen)

    compared = count("runs", reference)
    beyond = {head: count(head, reference) for head in COUNTS[1:]}
    levels = {row["level"] for row in rows if row["invariant"] == reference}
    counters = random_study.SHORT, random_study.TAKEN
    return {
        "random": count("runs", random_study.TAKEN),
        "random_refused": count("failed", random_study.TAKEN),
        "random_failed": count("failed", *{row["invariant"] for row in rows}.difference(counters)),
        "compared": compared,
        "by_events": count("runs", random_study.TAKEN, levels=levels),
        "within": 1.0 - sum(beyond.values()) / compared,
        "beyond": ", ".join(f"{head}: {number}" for head, number in beyond.items()),
    }


def values():
    """What the template has places for."""
    rows = read_rows(TABLE)
    counted = counts(rows)
    broken = any(count[BROKEN] for count, _ in counted.values())
    shown = [name for name in OUTCOMES if name != BROKEN or broken]
    table = [
        f"| level of fidelity | {' | '.join(shown)} | largest error |",
        f"|---|{'---|' * len(shown)}---|",
        *(
            f"| {level} | {' | '.join(str(count[name]) for name in shown)} | {largest} |"
            for level, (count, largest) in counted.items()
        ),
    ]
    drawn, lossy = (list(csv.DictReader(path.read_text().splitlines())) for path in (RANDOM, RANDOM_LOSSES))
    return {
        **random_counts(drawn),
        "random_rows": "\n".join(random_rows(drawn)),
        "losses_rows": "\n".join(random_rows(lossy)),
        **{
            f"losses_{name}": count
            for name, count in random_counts(lossy, random_checks.VIRTUAL_WORK).items()
        },
        "losses_work": random_checks.MOST_WITH_LOSSES,
        "levels_with": "\n".join(levels_with(rows)),
        "reference_tolerance": random_checks.REFERENCE_TOLERANCE,
        "reference_error": random_checks.REFERENCE_ERROR,
        "reference_work": random_checks.MOST_EVALUATIONS,
        "long": random_checks.LONGEST,
        "friction": random_motions.FRICTION_SHARE,
        "explained": random_checks.EXPLAINED,
        "swinging": random_checks.SWINGING,
        "random_split": random_checks.SPLIT,
        "extremes": len({(row.axis, row.value) for row in rows}),
        "axes": len({row.axis for row in rows}),
        "cases": sum(len(row.cells) for row in rows),
        "table": "\n".join(table),
        "reasons": "\n".join(exceptions(rows)),
        "tighter": trial.TIGHTER,
        "tightest": trial.TIGHTEST,
        "fixed_phase": trial.FIXED_PHASE,
        "timestepping": case.TIMESTEPPING_ACCURACY,
        "averaged": case.AVERAGED_ACCURACY,
        "energy": bounds.ENERGY_TOLERANCES,
        "rounding": bounds.ROUNDING,
        "result": bounds.RESULT_ACCURACIES,
        "largest": bounds.LARGEST_ERROR,
        "breach": bounds.BREACH,
        "step_work": bounds.STEP_WORK,
        "phase_work": bounds.PHASE_WORK,
        "order": bounds.WORK_ORDER,
        "fixed_work": bounds.FIXED_STEP_WORK,
        "most": limits.MAX_EVALUATIONS,
    }
