"""Wall time of a run: the median of repeats, and of the kernel alone without the Python around its calls."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

from ..kernel import codes
from ..memory import Module

# a call that the kernel refuses at once costs what every call costs around it
_REFUSED_STEP = -1.0
# no further call once so much time has passed, s
_PATIENCE = 0.5
# shortest time that can be measured, s a call
_RESOLUTION = 1e-8


def median_time(run: Callable[[], Any], repeats: int = 11) -> float:
    """Median wall time of some calls, s.

    Args:
        run: what is timed. repeats: at most so many calls; fewer (at least one) of what is slow.
    """
    times: list[float] = []
    begun = time.perf_counter()
    while len(times) < repeats and (not times or time.perf_counter() - begun < _PATIENCE):
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def kernel_time(
    module: Module,
    begin: bytes,
    inputs: Sequence[tuple[float, float, float]],
    communication_step: float,
    repeats: int = 31,
) -> float:
    """Time of the kernel for a run that is known to succeed, s: that of all calls less that of empty ones.

    Args:
        module: that ran it. begin: its state before (Module.save). communication_step: s.
        inputs: (omega1, load_torque, drive_torque) of each step. repeats: at most.
    """

    def calls(size: float) -> None:
        module.restore(begin)
        held, call = module.inputs, module.call
        for held.omega1, held.load_torque, held.drive_torque in inputs:
            call(codes.STEP, size)

    spent = median_time(lambda: calls(communication_step), repeats)
    empty = median_time(lambda: calls(_REFUSED_STEP), repeats)
    return max(spent - empty, _RESOLUTION * len(inputs))
