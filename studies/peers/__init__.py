"""Other ways to integrate the module, measured beside it: one curve each in the plots.

What would be unfair to them is avoided: their right-hand sides are compiled, compilation is not
counted, nor is sampling, and each has the settings that were found to serve it best.
"""

from __future__ import annotations

from collections.abc import Callable

from ..reference.trajectory import Case, Peer, Trajectory
from . import cvode, mujoco_model, scipy_methods

STIFFNESSES = (1e2, 1e3, 1e4, 1e5, 1e6)  # of the clutches, N.m.s/rad
LSODA_TOLERANCES = (1e-5, 1e-6, 1e-7, 3e-8, 1e-8, 1e-9)
CVODE_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-9, 1e-10)


def _peer(
    simulate: Callable[..., Trajectory],
    name: str,
    method: str,
    tolerances: tuple[float, ...],
    stiffness: float | None = None,
) -> Peer:
    def integrate(case: Case, tolerance: float) -> Trajectory:
        return simulate(case, method, tolerance, stiffness)

    ending = "" if stiffness is None else f", clutch {stiffness:.0e}"
    return Peer(name + ending, {f"rtol {value:.0e}": value for value in tolerances}, integrate)


def _mujoco(integrator: str) -> Peer:
    return Peer(
        f"MuJoCo {integrator}",
        {f"step {step:.0e}": step for step in (1e-3, 1e-4, 1e-5)},
        lambda case, step: mujoco_model.simulate(case, integrator, step),
    )


_SCIPY, _CVODE = scipy_methods.simulate, cvode.simulate
PEERS: tuple[Peer, ...] = (
    *(_peer(_SCIPY, "SciPy LSODA", "odeint", LSODA_TOLERANCES, stiffness) for stiffness in STIFFNESSES),
    _peer(_SCIPY, "SciPy LSODA", "odeint", (3e-8, 1e-8, 5e-9, 1e-9), 3e6),
    *(_peer(_SCIPY, "SciPy Radau", "Radau", (1e-4, 1e-5), stiffness) for stiffness in (1e3, 1e4)),
    _peer(_SCIPY, "SciPy DOP853, events", "DOP853", (1e-4, 1e-8, 1e-10)),
    _peer(_SCIPY, "SciPy RK45, events", "RK45", (1e-3, 1e-6, 1e-8)),
    _peer(_SCIPY, "SciPy LSODA, events", "LSODA", (1e-6, 1e-8, 1e-10)),
    *(_peer(_CVODE, "CVODE BDF", "BDF", (1e-6, 1e-8, 1e-10), stiffness) for stiffness in (1e3, 1e4, 1e5)),
    *(_peer(_CVODE, f"CVODE {way}, root finding", way, CVODE_TOLERANCES) for way in ("Adams", "BDF")),
    *(_mujoco(integrator) for integrator in ("Euler", "RK4")),
)
