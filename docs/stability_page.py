"""Values for docs/stability.md: counts of the committed verdicts, and the bounds in the code."""

from collections import Counter
from pathlib import Path

from inertia_module.kernel.engine import MAX_EVALUATIONS
from verification.stability import extremes, verdicts
from verification.stability.motion import LEVELS
from verification.stability.verdicts import BROKEN, OUTCOMES, REJECTED, counts, read_rows

TABLE = Path(__file__).parent / "stability.csv"


def by_axis(rows):
    """Yield a line for each axis: number of extremes, and the cases of each level that are not exact."""
    for axis in dict.fromkeys(row.axis for row in rows):
        extremes_of_axis = [row for row in rows if row.axis == axis]
        cells = []
        for level in LEVELS:
            names = (row.cells[level.name].outcome for row in extremes_of_axis if level.name in row.cells)
            count = Counter(names)
            exceptions = ", ".join(f"{count[name]} {name}" for name in OUTCOMES[1:] if count[name])
            cells.append(exceptions if count else "-")
        yield f"| {axis} | {len(extremes_of_axis)} | {' | '.join(cells)} |"


def rejections(rows):
    """Yield a line for each reason of a rejection, the most frequent first."""
    cells = (cell for row in rows for cell in row.cells.values() if cell.outcome == REJECTED)
    for reason, number in Counter(cell.reason.partition(" with ")[0] for cell in cells).most_common():
        yield f"- {number} cases: *{reason}*"


def values():
    """Return the values of the template's placeholders."""
    rows = read_rows(TABLE)
    by_level = counts(rows)
    has_broken = any(count[BROKEN] for count, _ in by_level.values())
    columns = [name for name in OUTCOMES if name != BROKEN or has_broken]
    table = [
        f"| fidelity level | {' | '.join(columns)} | maximum error |",
        f"|---|{'---|' * len(columns)}---|",
        *(
            f"| {level} | {' | '.join(str(count[name]) for name in columns)} | {largest} |"
            for level, (count, largest) in by_level.items()
        ),
    ]
    return {
        "extremes": len({(row.axis, row.value) for row in rows}),
        "axes": len({row.axis for row in rows}),
        "cases": sum(len(row.cells) for row in rows),
        "table": "\n".join(table),
        "levels": " | ".join(level.name for level in LEVELS),
        "by_axis": "\n".join(by_axis(rows)),
        "rejections": "\n".join(rejections(rows)),
        "tighter": verdicts.TIGHTER,
        "tightest": verdicts.TIGHTEST,
        "averaged": extremes.AVERAGED_ACCURACY,
        "energy": verdicts.ENERGY_TOLERANCES,
        "rounding": verdicts.ROUNDING,
        "result": verdicts.RESULT_ACCURACIES,
        "largest": verdicts.LARGEST_ERROR,
        "breach": verdicts.BREACH,
        "step_work": verdicts.STEP_WORK,
        "phase_work": verdicts.PHASE_WORK,
        "order": verdicts.WORK_ORDER,
        "most": MAX_EVALUATIONS,
    }
