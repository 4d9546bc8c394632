"""CVODE of SUNDIALS (scikit-sundae): with root finding in each contact mode, or with clutches.

Source: Hindmarsh et al., SUNDIALS, ACM TOMS 31 (2005); the root finding is CVODE's own.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia_module.common.extras import library

from ..reference.geometry import Array
from ..reference.trajectory import Case, Trajectory
from .equations import equations, in_array, largest_step
from .run import Integrator, Segment, measure

STEPS_ALLOWED = 10_000_000
ROOT_FOUND = 2  # CV_ROOT_RETURN
# phase of the fastest harmonic in a step, rad
PHASE = 1.0


def _integrator(method: str, tolerance: float, step: float) -> Integrator:
    compiled = equations()
    shared: Any = None

    def rates(t: float, y: Array, values: Array) -> None:
        compiled.rates(t, y, values, shared)

    def guards(t: float, y: Array, values: Array) -> None:
        compiled.guards(t, y, values, shared)

    guards.terminal = [True, True]  # type: ignore[attr-defined]
    guards.direction = [-1, -1]  # type: ignore[attr-defined]
    solver = library("sksundae.cvode", "peers", "scikit-sundae").CVODE(
        rates,
        method=method,
        eventsfn=guards,
        num_events=2,
        rtol=tolerance,
        atol=tolerance,
        max_step=step if np.isfinite(step) else 0.0,
        max_num_steps=STEPS_ALLOWED,
    )

    def integrate(data: Any, time: float, state: Array, times: Array) -> Segment:
        nonlocal shared
        shared = in_array(data)
        solver.init_step(time, state)
        # the wrapper keeps and copies all events it has ever met
        for kept in (guards._i, guards._t, guards._y):  # type: ignore[attr-defined]
            kept.clear()
        samples: list[Array] = []
        for until in times:
            found = solver.step(until)
            if found.status == ROOT_FOUND:
                guard = int(np.flatnonzero(found.i_events[-1])[0])
                taken = np.array(samples) if samples else np.empty((0, 3))
                return Segment(float(found.t), found.y, guard, taken, found.nfev)
            if found.status < 0:
                raise RuntimeError(f"CVODE gave up at {found.t} s: {found.message}")
            samples.append(found.y)
        return Segment(float(times[-1]), samples[-1], None, np.array(samples), found.nfev)

    return integrate


def simulate(case: Case, method: str, tolerance: float, stiffness: float | None = None) -> Trajectory:
    """Run a case with CVODE, started anew where a root function falls through zero.

    Args:
        case: of the rigid module. method: "Adams" or "BDF". tolerance: relative and absolute.
        stiffness: of a clutch for each freewheel, N.m.s/rad, which has no events, or None.

    Raises:
        Unavailable: the case is not for it. NotInstalled: a library is not.
        RuntimeError: CVODE gives up.
    """
    step = largest_step(case, PHASE) if stiffness is None else np.inf
    return measure(case, _integrator(method, tolerance, step), stiffness)
