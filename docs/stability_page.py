"""Values for docs/verification/stability.md: counts of the committed tables, and the bounds in the code."""

import statistics
from pathlib import Path

from verification.stability import extremes, random_motions, verdicts
from verification.stability.verdicts import BROKEN, EXACT, REJECTED, SENSITIVE, VERDICTS

HERE = Path(__file__).parent / "verification"


def extreme_rows():
    """Return the rows of the extremes."""
    return verdicts.read_rows(HERE / "stability.csv")


def machine_rows():
    """Return the rows of the random machines."""
    return random_motions.read_rows(HERE / "random.csv")


def table(rows, machines):
    """Return the lines of the table: a line for each axis of extremes and each level of random machines."""
    axes = verdicts.counts(rows)
    levels = [row for row in random_motions.counts(machines) if row[1]]
    columns = [n for n, name in enumerate(VERDICTS, 2) if any(row[n] for row in axes + levels)]
    headings = ["drawn", "range", "cases", *(VERDICTS[n - 2] for n in columns), "median", "maximum"]
    lines = [f"| {' | '.join(headings)} |", "|---" * len(headings) + "|"]
    for row in axes:
        cells = row[0], extremes.TABLE["drawn"][row[0]], *(row[n] for n in (1, *columns)), "", row[-1]
        lines.append(f"| {' | '.join(map(str, cells))} |")
    for row in levels:
        cells = f"random, {row[0]}", "as described above", *(row[n] for n in (1, *columns)), *row[-2:]
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return lines


def values():
    """Return the values of the template's placeholders."""
    rows, machines = extreme_rows(), machine_rows()
    errors = [float(row.error) for row in machines if row.error]
    outcomes = [row.verdict for row in machines]
    within = sum(error <= random_motions.REFERENCE_ERROR for error in errors)
    assert not any(cell.outcome == BROKEN for row in rows for cell in row.cells.values())
    return {
        "table": "\n".join(table(rows, machines)),
        "extremes": len({(row.axis, row.value) for row in rows}),
        "axes": len({row.axis for row in rows}),
        "cases": sum(len(row.cells) for row in rows),
        "machines": len(machines),
        "judged": len(errors),
        "within": within / len(errors),
        "median": statistics.median(errors),
        "maximum": max(errors),
        "sensitive": outcomes.count(SENSITIVE),
        "failed": sum(outcome not in (EXACT, SENSITIVE, REJECTED) for outcome in outcomes),
        "rejected": outcomes.count(REJECTED),
        "self_locking": sum("self-locking" in row.reason for row in machines),
        "reference_tolerance": random_motions.REFERENCE_TOLERANCE,
        "reference_error": random_motions.REFERENCE_ERROR,
        "friction": random_motions.FRICTION_SHARE,
        "loss": random_motions.LOSS_SHARE,
        "angle": random_motions.ANGLE_SHARE,
        "split": random_motions.SPLIT,
        "averaged": extremes.AVERAGED_ACCURACY,
        "energy": verdicts.ENERGY_TOLERANCES,
        "rounding": verdicts.ROUNDING,
        "result": verdicts.RESULT_FACTOR,
        "largest": verdicts.LARGEST_ERROR,
        "breach": verdicts.BREACH,
        "step_work": verdicts.STEP_WORK,
        "phase_work": verdicts.PHASE_WORK,
        "order": verdicts.METHOD_ORDER,
    }
