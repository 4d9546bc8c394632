"""CVODE of SUNDIALS (scikit-sundae): with root finding in each contact mode, and with clutches.

Source: Hindmarsh et al., SUNDIALS, ACM TOMS 31 (2005); the root finding is CVODE's own.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..trajectory import Array, Case, Trajectory
from .clutches import clutch_data, measure_clutches
from .contact_run import Integrator, Segment, measure
from .equations import equations, in_array, largest_step, start_of
from .extras import library

STEPS_ALLOWED = 10_000_000
ROOT_FOUND = 2  # CV_ROOT_RETURN


# phase of the fastest harmonic in a step, rad
PHASE = 1.0


def _integrator(method: str, tolerance: float, step: float) -> Integrator:
    compiled = equations()
    shared: Any = None

    def rates(t: float, y: Array, values: Array) -> None:
        compiled.contact_rates(t, y, values, shared)

    def guards(t: float, y: Array, values: Array) -> None:
        compiled.contact_guards(t, y, values, shared)

    guards.terminal = [True, True]  # type: ignore[attr-defined]
    guards.direction = [-1, -1]  # type: ignore[attr-defined]
    solver = library("sksundae.cvode", "scikit-sundae").CVODE(
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


def simulate_events(case: Case, method: str, tolerance: float) -> Trajectory:
    """Run a case with CVODE in each contact mode, started anew where a root function falls through zero.

    Args:
        case: of the rigid module. method: "Adams" or "BDF". tolerance: relative and absolute.

    Raises:
        Unavailable: a library is missing or the case is not for it.
        RuntimeError: CVODE gives up.
    """
    return measure(case, lambda: _integrator(method, tolerance, largest_step(case, PHASE)))


def simulate_clutches(case: Case, stiffness: float, tolerance: float) -> Trajectory:
    """Run a case with CVODE's BDF and a viscous clutch for each freewheel.

    Args:
        case: with both freewheels. stiffness: of the clutches, N.m.s/rad.
        tolerance: relative and absolute.

    Raises:
        Unavailable: a library is missing or the case is not for it.
        RuntimeError: CVODE gives up.
    """
    data, compiled = clutch_data(case, stiffness), equations().clutch_rates

    def rates(t: float, y: Array, values: Array) -> None:
        compiled(t, y, values, data)

    solver = library("sksundae.cvode", "scikit-sundae").CVODE(
        rates, method="BDF", rtol=tolerance, atol=tolerance, max_num_steps=STEPS_ALLOWED
    )

    def solve(times: Array) -> tuple[Array, int]:
        # three times or more: the solver then gives back these and not its own
        found = solver.solve(np.array([times[0], 0.5 * times[1], *times[1:]]), start_of(case))
        if not found.success:
            raise RuntimeError(f"CVODE gave up: {found.message}")
        return np.delete(found.y, 1, axis=0), found.nfev

    return measure_clutches(case, solve)
