"""Times of a table beside the times of the run that the table is for.

Before its first row and after its last row a table is constant. That is right for a ramp and wrong for a log
whose times are dates, have an offset, or are in another unit.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .csv_table import TableError
from .errors import must_be

# rows from which on a table is a record and no drawing by hand
RECORD_ROWS = 20
# share of the run in which a record may be constant
MAX_HELD_SHARE = 0.5
# share of the changes of a table that a run must use at least
MIN_USED_SHARE = 0.01
# s: later times are dates (1973 in seconds since 1970)
DATES = 1e8

Array = NDArray[np.float64]


def likely_cause(first: float) -> str:
    """Return the remedy for times outside a run; first: time of the first row, s."""
    unit = "name their unit, such as ms, if they are not in s"
    if first > DATES:
        return f"they look like seconds since 1970; subtract the first time from all, or {unit}"
    shift = f"subtract {first:.12g} s from all times, or " if first > 0.0 else ""
    return f"{shift}{unit}"


def time_warnings(name: str, times: Array, columns: Iterable[Array], stop_time: float) -> list[str]:
    """Return warnings of times that are probably not meant as times of the run.

    Args:
        name: of the table, for messages.
        times: s, shape (rows,), not falling.
        columns: values of the table, shape (rows,) each.
        stop_time: end of the run, which begins at 0, s.

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
    # a shorter run of a table whose changes come later is meant so
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
