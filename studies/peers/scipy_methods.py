"""SciPy: solve_ivp with its own event location, started anew at each event, or methods with clutches."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import odeint, solve_ivp

from ..reference.geometry import Array
from ..reference.trajectory import Case, Trajectory
from .equations import LINK2, OUTPUT, equations, in_array, largest_step
from .run import Integrator, Segment, measure

# phase of the fastest harmonic in a step, rad: at 1 two short pulses of R1 are missed
PHASE = 0.5
STEPS_ALLOWED = 10_000_000


def _falling(which: int) -> Any:
    guard = equations().guard

    def event(t: float, y: Array, data: Any) -> float:
        value: float = guard(t, y, data, which)
        return value

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1.0  # type: ignore[attr-defined]
    return event


def _solve_ivp(method: str, tolerance: float, **options: Any) -> Integrator:
    rates = equations().new_rates

    def integrate(data: Any, time: float, state: Array, times: Array) -> Segment:
        sampled = len(times) > 1
        found = solve_ivp(
            rates,
            (time, times[-1]),
            state,
            method=method,
            t_eval=times if sampled else None,
            args=(in_array(data),),
            rtol=tolerance,
            atol=tolerance,
            **options,
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


def _odeint(tolerance: float) -> Integrator:
    """LSODA with its loop in compiled code, which knows no events."""
    rates = equations().new_rates
    options = {"rtol": tolerance, "atol": tolerance, "mxstep": STEPS_ALLOWED}

    def integrate(data: Any, time: float, state: Array, times: Array) -> Segment:
        states, found = odeint(
            rates, state, [time, *times], (in_array(data),), tfirst=True, full_output=True, **options
        )
        if found["message"] != "Integration successful.":
            raise RuntimeError(f"LSODA gave up: {found['message']}")
        return Segment(times[-1], states[-1], None, states[1:], int(found["nfe"][-1]))

    return integrate


def simulate(case: Case, method: str, tolerance: float, stiffness: float | None = None) -> Trajectory:
    """Run a case with a method of SciPy.

    Args:
        case: of the rigid module. method: as solve_ivp names it, or, with clutches, "odeint".
        tolerance: relative and absolute. stiffness: of the clutches, N.m.s/rad, or None: exact events.

    Raises:
        Unavailable: the case is not for it. NotInstalled: numba is not.
        RuntimeError: the integrator gives up.
    """
    if method == "odeint":
        integrate = _odeint(tolerance)
    elif stiffness is not None:
        integrate = _solve_ivp(method, tolerance)
    else:
        events = [_falling(LINK2), _falling(OUTPUT)]
        integrate = _solve_ivp(method, tolerance, events=events, max_step=largest_step(case, PHASE))
    return measure(case, integrate, stiffness)
