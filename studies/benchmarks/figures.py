"""Tools that the benchmarks share: clocks, the scene, and a table of measured figures, docs/performance.csv."""

import csv
import statistics
import time
from pathlib import Path

from inertia_module.harness.results import write_rows

DOCS = Path(__file__).parents[2] / "docs"
TABLE = DOCS / "performance.csv"
HEADINGS = ("part", "case", "quantity", "value", "unit")
R1 = {"omega1": 100.0, "load_torque": 10.0}
PLANAR = {
    **{"layout": 1, "sun_radius": 0.05, "satellite_radius": 0.03, "eccentricity": 0.02},
    **{"imbalance_mass": 0.8, "satellites": 3, "link2_inertia": 0.003, "output_inertia": 0.4},
}


def median_time(action, repeats=7):
    """Median wall time of some calls, s."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


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
