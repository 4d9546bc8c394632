"""Run times: medians of repeated calls, and the time that the kernel takes for the steps of a run."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from ..driveline.closed_loop import PLANT_INPUTS
from ..model import Module


def timed(run: Callable[[], Any]) -> float:
    """Return the wall time of a call, s.

    Args:
        run: Function to call.
    """
    begin = time.perf_counter()
    run()
    return time.perf_counter() - begin


def median_of(measure: Callable[[], float], repeats: int = 11) -> float:
    """Return the median of repeated measurements.

    Measurements end after 0.5 s; at least one is made.

    Args:
        measure: Function that returns one measurement.
        repeats: Maximum number of measurements.
    """
    measurements: list[float] = []
    start = time.perf_counter()
    while len(measurements) < repeats and (not measurements or time.perf_counter() - start < 0.5):
        measurements.append(measure())
    return statistics.median(measurements)


def median_time(run: Callable[[], Any], repeats: int = 11) -> float:
    """Return the median wall time of a call, s, as median_of.

    Args:
        run: Function to call.
        repeats: Maximum number of calls.
    """
    return median_of(lambda: timed(run), repeats)


def kernel_time(
    module: Module,
    begin: bytes,
    inputs: Sequence[Sequence[float]],
    communication_step: float,
    repeats: int = 31,
) -> float:
    """Measure the kernel time of a successful run, s: time with all steps minus time without steps.

    Args:
        module: Module of the run.
        begin: State before the run, from Module.save.
        inputs: Values of PLANT_INPUTS in each step, shape (steps, 3).
        communication_step: Communication step, s.
        repeats: Maximum number of measurements.
    """
    values, lengths = np.array(inputs, dtype=float), np.full(len(inputs), communication_step)
    rows = np.empty((len(inputs) + 1, 0))

    def steps(number: int) -> float:
        module.restore(begin)
        arguments = lengths[:number], PLANT_INPUTS, values[:number], (), rows[: number + 1]
        return timed(partial(module.take_steps, *arguments))

    duration = median_of(lambda: steps(len(inputs)) - steps(0), repeats)
    # minimum measurable time: 10 ns per step
    return max(duration, 1e-8 * len(inputs))
