"""SciPy's stiff integrators with a viscous clutch for each freewheel."""

from __future__ import annotations

from ..trajectory import Array, Case, Trajectory
from .clutches import clutch_data, measure_clutches
from .equations import equations, start_of
from .extras import library

STEPS_ALLOWED = 10_000_000


def simulate(case: Case, method: str, stiffness: float, tolerance: float) -> Trajectory:
    """Run a case with a method of solve_ivp, or with LSODA by odeint, its loop in compiled code.

    Args:
        case: with both freewheels. method: "odeint", or as solve_ivp names it.
        stiffness: of the clutches, N.m.s/rad. tolerance: relative and absolute.

    Raises:
        Unavailable: a library is missing or the case is not for it.
        RuntimeError: the integrator gives up.
    """
    data, start, rates, scipy = (
        clutch_data(case, stiffness),
        start_of(case),
        equations().new_clutch_rates,
        library("scipy.integrate"),
    )
    tolerances = {"rtol": tolerance, "atol": tolerance}

    def lsoda(times: Array) -> tuple[Array, int]:
        states, found = scipy.odeint(
            rates, start, times, (data,), tfirst=True, full_output=True, mxstep=STEPS_ALLOWED, **tolerances
        )
        if found["message"] != "Integration successful.":
            raise RuntimeError(f"LSODA gave up: {found['message']}")
        return states, int(found["nfe"][-1])

    def by_solve_ivp(times: Array) -> tuple[Array, int]:
        found = scipy.solve_ivp(
            rates, times[[0, -1]], start, method, t_eval=times, args=(data,), **tolerances
        )
        if not found.success:
            raise RuntimeError(f"{method} gave up: {found.message}")
        return found.y.T, found.nfev

    return measure_clutches(case, lsoda if method == "odeint" else by_solve_ivp)
