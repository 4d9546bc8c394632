"""Tools that the benchmarks share: runs in turns, the scene, and a table of measured figures, docs/verification/performance.csv."""

import csv
from pathlib import Path

from inertia_module.fmi.results import write_rows

DOCS = Path(__file__).parents[1] / "docs" / "verification"
TABLE = DOCS / "performance.csv"
HEADINGS = ("part", "case", "quantity", "value", "unit")
R1 = {"omega1": 100.0, "load_torque": 10.0}


def in_turns(ways, rounds):
    """Results of calls, by name, made one after the other in each round: a list by name."""
    found = [{name: call() for name, call in ways.items()} for _ in range(rounds)]
    return {name: [results[name] for results in found] for name in ways}


def keep_parts(parts):
    """Write measured parts into the table, in place of what it had of them.

    Args:
        parts: by name, each a list of (case, quantity, value, unit).
    """
    kept = []
    if TABLE.exists():
        kept = [row for row in csv.reader(TABLE.read_text().splitlines()[1:]) if row[0] not in parts]
    measured = [
        [part, case, quantity, f"{value:.6g}", unit]
        for part, figures in parts.items()
        for case, quantity, value, unit in figures
    ]
    write_rows(TABLE, HEADINGS, [*kept, *measured])
