"""Drives an FMU with fmpy: a whole run from a table of inputs to a table of results."""

from __future__ import annotations

import contextlib
import math
import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .instance import DriveError, Fmu, Plant
from .results import TIME, Result, TableError

__all__ = ["DriveError", "Fmu", "Plant", "Progress", "Result", "TableError", "drive", "progress_bar"]

Progress = Callable[[float], None]
# a run that takes longer than this, s, shows a bar
PATIENCE = 2.0
# steps between two reports of progress
REPORT_STEPS = 50


@contextlib.contextmanager
def progress_bar(title: str, total: float = 1.0) -> Iterator[Progress]:
    """A progress bar that appears once a run has taken more than PATIENCE seconds.

    Yields:
        A function to call with how much of total is done.
    """
    from rich.progress import Progress as Bar

    started = clock.monotonic()
    bar = Bar(transient=True)
    task = bar.add_task(title, total=total)
    shown = False

    def report(done: float) -> None:
        nonlocal shown
        if not shown and clock.monotonic() - started > PATIENCE:
            bar.start()
            shown = True
        bar.update(task, completed=done)

    try:
        yield report
    finally:
        if shown:
            bar.stop()


def input_table(inputs: Result | Mapping[str, ArrayLike] | Path | str) -> Result:
    """Inputs as a table: a Result, columns by name (scalars are constant), or a CSV file.

    Raises:
        TableError: it is no table with a column time.
    """
    if isinstance(inputs, Result):
        return inputs
    if isinstance(inputs, str | Path):
        return Result.from_csv(inputs)
    columns = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in inputs.items()}
    columns.setdefault(TIME, np.zeros(1))
    n = columns[TIME].size
    return Result.from_columns(
        {name: np.full(n, values[0]) if values.size == 1 else values for name, values in columns.items()}
    )


def drive(
    path: Path | str,
    inputs: Result | Mapping[str, ArrayLike] | Path | str,
    stop_time: float,
    step: float,
    outputs: Sequence[str] = ("omega2", "omega_out"),
    parameters: Mapping[str, float | bool | str] | None = None,
    tolerance: float | None = None,
    progress: Progress | None = None,
) -> Result:
    """Drive an FMU with given inputs and record outputs at every communication point.

    Args:
        path: the .fmu file.
        inputs: arrays by name (with time), a Result or a CSV file; between its rows inputs are
            interpolated linearly, before the first and after the last they are constant.
        stop_time: s. step: communication step, s; the last one is cut to end at stop_time.
        outputs: names of variables to record. parameters, tolerance: see Fmu.
        progress: told how much of the run is done (0 to 1); by default a bar on runs over two seconds.

    Returns:
        Table of time, the inputs and the outputs, shape (steps + 1,) each.

    Raises:
        DriveError: the FMU refused something. TableError: the inputs are no table.
        ValueError: stop_time or step is not positive.
    """
    for name, value in (("stop_time", stop_time), ("step", step)):
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} = {value} is refused: allowed is a positive number of seconds")
    table = input_table(inputs)
    names = [name for name in table if name != TIME]
    times = communication_points(stop_time, step)
    given = {name: np.interp(times, table.time, table[name]) for name in names}
    rows = np.empty((times.size, len(outputs)))
    start = {name: float(values[0]) for name, values in given.items()}
    with contextlib.ExitStack() as stack:
        fmu = stack.enter_context(Fmu(path, parameters, start, tolerance, stop_time=stop_time))
        report = progress or stack.enter_context(progress_bar(f"driving {fmu.path.name}"))
        rows[0] = fmu.read(outputs)
        for n in range(times.size - 1):
            fmu.set(**{name: float(values[n]) for name, values in given.items()})
            fmu.advance(float(times[n + 1] - times[n]))
            rows[n + 1] = fmu.read(outputs)
            if n % REPORT_STEPS == 0:
                report((n + 1) / (times.size - 1))
        units = fmu.units
    columns = {TIME: times, **given, **{name: rows[:, i] for i, name in enumerate(outputs)}}
    return Result.from_columns(columns, {name: units[name] for name in columns if name in units})


def communication_points(stop_time: float, step: float) -> NDArray[np.float64]:
    """Times 0, step, 2 step, ... and stop_time, s (a last sliver below 1e-9 of a step is dropped)."""
    count = math.ceil(stop_time / step - 1e-9)
    times = np.arange(count + 1, dtype=np.float64) * step
    times[-1] = stop_time
    return times
