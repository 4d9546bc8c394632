"""Time that the kernel itself takes for a run, without the Python around its calls."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence

from ..kernel import codes
from ..memory.instances import Module

# a call that the kernel refuses at once costs what every call costs around it
_REFUSED_STEP = -1.0
# what cannot be told from nothing, s a call
_RESOLUTION = 1e-8


def kernel_time(
    module: Module,
    begin: bytes,
    inputs: Sequence[tuple[float, float, float]],
    communication_step: float,
    repeats: int = 31,
    patience: float = 0.5,
) -> float:
    """Time of the kernel for a run that is known to succeed, s: median of repeats of the same run.

    Each repeat begins at the same state and is followed by as many empty calls, whose time is taken off.

    Args:
        module: that ran it. begin: its state before (Module.save). communication_step: s.
        inputs: (omega1, load_torque, drive_torque) of each step. repeats: at most.
        patience: no further one after it, s.
    """

    def calls(size: float) -> float:
        module.restore(begin)
        held, call = module.inputs, module.call
        start = time.perf_counter()
        for held.omega1, held.load_torque, held.drive_torque in inputs:
            call(codes.STEP, size)
        return time.perf_counter() - start

    runs: list[float] = []
    empty: list[float] = []
    begun = time.perf_counter()
    while len(runs) < repeats and (not runs or time.perf_counter() - begun < patience):
        runs.append(calls(communication_step))
        empty.append(calls(_REFUSED_STEP))
    return max(statistics.median(runs) - statistics.median(empty), _RESOLUTION * len(inputs))
