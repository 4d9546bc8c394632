"""SciPy's solve_ivp in each contact mode, its own event location, started anew at each event."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..trajectory import Array, Case, Trajectory
from .contact_run import Integrator, Segment, measure
from .equations import LINK2, OUTPUT, equations, in_array, largest_step
from .extras import library

# phase of the fastest harmonic in a step, rad: at 1 two short pulses of R1 are missed
PHASE = 0.5


def _falling(which: int) -> Any:
    guard = equations().guard

    def event(t: float, y: Array, data: Any) -> float:
        value: float = guard(t, y, data, which)
        return value

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1.0  # type: ignore[attr-defined]
    return event


def _integrator(method: str, tolerance: float, step: float) -> Integrator:
    solve, rates = library("scipy.integrate").solve_ivp, equations().new_contact_rates
    events = [_falling(LINK2), _falling(OUTPUT)]

    def integrate(data: Any, time: float, state: Array, times: Array) -> Segment:
        sampled = len(times) > 1
        found = solve(
            rates,
            (time, times[-1]),
            state,
            method=method,
            t_eval=times if sampled else None,
            events=events,
            args=(in_array(data),),
            rtol=tolerance,
            atol=tolerance,
            max_step=step,
        )
        if found.status < 0:
            raise RuntimeError(f"{method} gave up: {found.message}")
        states = np.transpose(found.y).reshape(-1, 3)  # an empty list where no sampling time was reached
        if found.status == 0:
            return Segment(times[-1], states[-1], None, states if sampled else states[-1:], found.nfev)
        guard = LINK2 if len(found.t_events[LINK2]) else OUTPUT
        event = found.t_events[guard][0], found.y_events[guard][0], guard
        return Segment(*event, states if sampled else states[:0], found.nfev)

    return integrate


def simulate(case: Case, method: str, tolerance: float) -> Trajectory:
    """Run a case with a method of solve_ivp and exact events.

    Args:
        case: of the rigid module. method: as solve_ivp names it. tolerance: relative and absolute.

    Raises:
        Unavailable: a library is missing or the case is not for it.
        RuntimeError: the integrator gives up.
    """
    return measure(case, lambda: _integrator(method, tolerance, largest_step(case, PHASE)))
