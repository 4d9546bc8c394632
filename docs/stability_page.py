"""Figures of docs/stability.md: the committed verdicts, counted, and the bounds in the code."""

import csv
from collections import Counter
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from inertia_module.kernel import limits
from inertia_module.studies.stability import bounds, case, random_checks, trial
from inertia_module.studies.stability.study import counts
from inertia_module.studies.stability.table import read_rows
from inertia_module.studies.stability.verdict import BROKEN, EXACT, OUTCOMES, REFUSED

TABLE = Path(__file__).parent / "stability.csv"
RANDOM = Path(__file__).parent / "random.csv"


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


def share(row):
    """How much of its bound the worst value has, -1 where there is none."""
    return float(row["worst"]) / max(float(row["bound"]), 1e-300) if row["worst"] else -1.0


def random_rows(rows):
    """A line for each invariant of the random motions: counts over all levels, and the worst of them."""
    for name, group in groupby(sorted(rows, key=itemgetter("invariant")), itemgetter("invariant")):
        found = list(group)
        worst = max(found, key=share)
        counts = (str(sum(int(row[head]) for row in found)) for head in ("runs", "sensitive", "failed"))
        cells = (name, *counts, worst["worst"], worst["bound"], worst["level"], worst["number"])
        yield f"| {' | '.join(cells if worst['worst'] else (*cells[:4], '', '', '', ''))} |"


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
    drawn = list(csv.DictReader(RANDOM.read_text().splitlines()))
    tried = [row for row in drawn if row["invariant"] == "not refused"]
    return {
        "random": sum(int(row["runs"]) for row in tried),
        "random_refused": sum(int(row["failed"]) for row in tried),
        "random_rows": "\n".join(random_rows(drawn)),
        "reference_tolerance": random_checks.REFERENCE_TOLERANCE,
        "reference_error": random_checks.REFERENCE_ERROR,
        "explained": random_checks.EXPLAINED,
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
