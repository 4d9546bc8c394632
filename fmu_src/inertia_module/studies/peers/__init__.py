"""Other ways to integrate the module, measured beside it: one curve each in the plots.

What would be unfair to them is avoided: their right-hand sides are compiled, compilation is not
counted, nor is sampling, and each has the settings that were found to serve it best.
"""

from __future__ import annotations

from ..trajectory import Peer
from . import cvode, mujoco_model, scipy_clutches, scipy_events

STIFFNESSES = (1e2, 1e3, 1e4, 1e5, 1e6)  # of the clutches, N.m.s/rad


def _tolerances(*values: float) -> dict[str, float]:
    return {f"rtol {value:.0e}": value for value in values}


def _clutches(method: str, name: str, stiffness: float, *tolerances: float) -> Peer:
    return Peer(
        f"{name}, clutch {stiffness:.0e}",
        _tolerances(*tolerances),
        lambda case, tolerance: scipy_clutches.simulate(case, method, stiffness, tolerance),
    )


def _cvode_clutches(stiffness: float) -> Peer:
    return Peer(
        f"CVODE BDF, clutch {stiffness:.0e}",
        _tolerances(1e-6, 1e-8, 1e-10),
        lambda case, tolerance: cvode.simulate_clutches(case, stiffness, tolerance),
    )


def _events(method: str, *tolerances: float) -> Peer:
    return Peer(
        f"SciPy {method}, events",
        _tolerances(*tolerances),
        lambda case, tolerance: scipy_events.simulate(case, method, tolerance),
    )


def _cvode_events(method: str) -> Peer:
    return Peer(
        f"CVODE {method}, root finding",
        _tolerances(1e-4, 1e-6, 1e-8, 1e-9, 1e-10),
        lambda case, tolerance: cvode.simulate_events(case, method, tolerance),
    )


def _mujoco(integrator: str) -> Peer:
    return Peer(
        f"MuJoCo {integrator}",
        {f"step {step:.0e}": step for step in (1e-3, 1e-4, 1e-5)},
        lambda case, step: mujoco_model.simulate(case, integrator, step),
    )


PEERS: tuple[Peer, ...] = (
    *(
        _clutches("odeint", "SciPy LSODA", stiffness, 1e-5, 1e-6, 1e-7, 3e-8, 1e-8, 1e-9)
        for stiffness in STIFFNESSES
    ),
    _clutches("odeint", "SciPy LSODA", 3e6, 3e-8, 1e-8, 5e-9, 1e-9),
    *(_clutches("Radau", "SciPy Radau", stiffness, 1e-4, 1e-5) for stiffness in (1e3, 1e4)),
    _events("DOP853", 1e-4, 1e-8, 1e-10),
    _events("RK45", 1e-3, 1e-6, 1e-8),
    _events("LSODA", 1e-6, 1e-8, 1e-10),
    *(_cvode_clutches(stiffness) for stiffness in (1e3, 1e4, 1e5)),
    *(_cvode_events(method) for method in ("Adams", "BDF")),
    *(_mujoco(integrator) for integrator in ("Euler", "RK4")),
)
