"""Comparison of the times of an input table with the times of its run.

A table is constant before its first row and after its last row. This is correct for a ramp. It is wrong for a
log whose times are dates, have an offset, or are in another unit.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .csv_table import TableError
from .errors import must_be

# minimum number of rows of a recorded table; a shorter table is written by hand
RECORD_ROWS = 20
# maximum share of the run in which a recorded table may be constant
MAX_HELD_SHARE = 0.5
# minimum share of the changes of a table that a run must use
MIN_USED_SHARE = 0.01
# times above this, s, are dates: the year 1973 in seconds since 1970
MIN_DATE = 1e8

Array = NDArray[np.float64]


def likely_cause(first: float) -> str:
    """Return the remedy for times outside a run.

    Args:
        first: time of the first row, s.
    """
    unit = "name their unit, such as ms, if they are not in s"
    if first > MIN_DATE:
        return f"they look like seconds since 1970; subtract the first time from all, or {unit}"
    shift = f"subtract {first:.12g} s from all times, or " if first > 0.0 else ""
    return f"{shift}{unit}"


def time_warnings(name: str, times: Array, columns: Iterable[Array], stop_time: float) -> list[str]:
    """Return warnings about a table whose times probably have an offset or another unit.

    Args:
        name: name of the table, for messages.
        times: times of the rows, s, shape (rows,), not decreasing.
        columns: values of the table, shape (rows,) each.
        stop_time: end of the run, s; the run begins at 0.

    Raises:
        TableError: no time is within the run.
    """
    first, last = float(times[0]), float(times[-1])
    if times.size == 1:
        return []
    ranges = f"0 to {stop_time:.12g} s"
    own = f"{first:.12g} to {last:.12g} s"
    if first > stop_time or last < 0.0:
        demand = must_be(f"times of {name}", f"within the run, {ranges}", own)
        raise TableError(f"{demand}: {likely_cause(first)}")
    steps = np.flatnonzero(np.any([np.diff(values) != 0.0 for values in columns] or [[False]], axis=0))
    if not steps.size:
        return []
    begin, end = float(times[steps[0]]), float(times[steps[-1] + 1])
    used = min(end, stop_time) - max(begin, 0.0)
    # a run that ends before the changes of the table is intended: it gets no warning
    if used < MIN_USED_SHARE * (end - begin) and stop_time < MIN_USED_SHARE * end:
        return [
            f"{name} changes from {begin:.12g} to {end:.12g} s, but the run, {ranges}, uses less than"
            f" {100.0 * MIN_USED_SHARE:g} % of this range: {likely_cause(first)}"
        ]
    held = (max(first, 0.0) + max(stop_time - last, 0.0)) / stop_time
    if times.size >= RECORD_ROWS and held > MAX_HELD_SHARE:
        return [
            f"{name} has times {own}, and is constant in {100.0 * held:.3g} % of the run, {ranges}:"
            f" {likely_cause(first)}"
        ]
    return []
