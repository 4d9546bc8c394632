"""Each freewheel made a viscous clutch: one stiff system without events, for any stiff integrator."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from ..trajectory import Array, Case, Trajectory, Unavailable, median_time
from .equations import data_of, in_array

SLOW = 5.0  # s: a run that takes longer is not repeated for the clock


def clutch_data(case: Case, stiffness: float) -> Any:
    """What the equations need, in an array, with the stiffness of the clutches, N.m.s/rad.

    Raises:
        Unavailable: the case is not for it.
    """
    data = data_of(case)
    if data.d.housing == 0.0 or data.d.output == 0.0:
        raise Unavailable("viscous clutches stand for both freewheels: the case leaves one out")
    data.stiffness = stiffness
    return in_array(data)


def measure_clutches(case: Case, solve: Callable[[Array], tuple[Array, int]]) -> Trajectory:
    """Run once with all samples, then, timed, to the end alone.

    Args:
        case: what is run.
        solve: of the output times, shape (n,), the first the beginning: the states there, shape
            (n, 3), and the number of right-hand sides.
    """
    solve(case.times[[0, 1]])  # numba compiles at the first call
    begun = time.perf_counter()
    states, evaluations = solve(case.times)
    wall_time = time.perf_counter() - begun
    ends = case.times[[0, -1]]
    if wall_time < SLOW:
        wall_time = median_time(lambda: solve(ends))
    q, omega2, omega3 = states.T
    return Trajectory(
        time=case.times,
        drive_angle=q,
        omega2=omega2,
        omega_out=omega3,
        switches=None,
        evaluations=evaluations,
        energy_residual=None,
        wall_time=wall_time,
    )
