"""Parts that the benchmarks share: alternating runs, the reference scene, and the table of the results."""

import csv
from pathlib import Path

from inertia_module.fmi.results import write_rows

DOCS = Path(__file__).parents[1] / "docs" / "verification"
TABLE = DOCS / "performance.csv"
HEADINGS = ("part", "case", "quantity", "value", "unit")
R1 = {"omega1": 100.0, "load_torque": 10.0}


def alternating_results(calls, rounds):
    """Make each call once per round, so that slow phases of the machine affect all calls alike.

    Args:
        calls: Functions without arguments, by name.
        rounds: Number of rounds.

    Returns:
        List of the results of each call, by name.
    """
    all_results = [{name: call() for name, call in calls.items()} for _ in range(rounds)]
    return {name: [results[name] for results in all_results] for name in calls}


def update_table(parts):
    """Replace parts of the table docs/verification/performance.csv.

    Args:
        parts: Lists of (case, quantity, value, unit) by the name of the part.
    """
    other_rows = []
    if TABLE.exists():
        other_rows = [row for row in csv.reader(TABLE.read_text().splitlines()[1:]) if row[0] not in parts]
    measured = [
        [part, case, quantity, f"{value:.6g}", unit]
        for part, rows in parts.items()
        for case, quantity, value, unit in rows
    ]
    write_rows(TABLE, HEADINGS, [*other_rows, *measured])
