"""Figures of docs/stability.md: the committed verdicts, counted, and the bounds in the code."""

from collections import Counter
from pathlib import Path

from inertia_module.kernel import limits
from inertia_module.studies.stability import bounds, case, trial
from inertia_module.studies.stability.study import counts
from inertia_module.studies.stability.table import read_rows
from inertia_module.studies.stability.verdict import BROKEN, EXACT, OUTCOMES, REFUSED

TABLE = Path(__file__).parent / "stability.csv"


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
    return {
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
