"""Figures of docs/stability.md: the committed verdicts, counted, and the bounds in the code."""

from collections import Counter
from pathlib import Path

from inertia_module.kernel.engine import MAX_EVALUATIONS
from studies.stability import extremes, verdicts
from studies.stability.motion import LEVELS
from studies.stability.verdicts import BROKEN, OUTCOMES, REFUSED, counts, read_rows

TABLE = Path(__file__).parent / "stability.csv"


def by_axis(rows):
    """A line for each axis: its extremes, and at each level how many are not exact; empty: all are."""
    for axis in dict.fromkeys(row.axis for row in rows):
        here = [row for row in rows if row.axis == axis]
        cells = []
        for level in LEVELS:
            found = Counter(row.cells[level.name].outcome for row in here if level.name in row.cells)
            told = ", ".join(f"{found[name]} {name}" for name in OUTCOMES[1:] if found[name])
            cells.append(told if found else "-")
        yield f"| {axis} | {len(here)} | {' | '.join(cells)} |"


def refusals(rows):
    """A line for each reason to refuse, the most frequent first."""
    cells = (cell for row in rows for cell in row.cells.values() if cell.outcome == REFUSED)
    for reason, number in Counter(cell.reason.partition(" with ")[0] for cell in cells).most_common():
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
        "levels": " | ".join(level.name for level in LEVELS),
        "by_axis": "\n".join(by_axis(rows)),
        "refusals": "\n".join(refusals(rows)),
        "tighter": verdicts.TIGHTER,
        "tightest": verdicts.TIGHTEST,
        "fixed_phase": verdicts.FIXED_PHASE,
        "timestepping": extremes.TIMESTEPPING_ACCURACY,
        "averaged": extremes.AVERAGED_ACCURACY,
        "energy": verdicts.ENERGY_TOLERANCES,
        "rounding": verdicts.ROUNDING,
        "result": verdicts.RESULT_ACCURACIES,
        "largest": verdicts.LARGEST_ERROR,
        "breach": verdicts.BREACH,
        "step_work": verdicts.STEP_WORK,
        "phase_work": verdicts.PHASE_WORK,
        "order": verdicts.WORK_ORDER,
        "fixed_work": verdicts.FIXED_STEP_WORK,
        "most": MAX_EVALUATIONS,
    }
