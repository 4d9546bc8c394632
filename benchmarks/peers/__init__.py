"""Other integrators (peers) of the equations of the module, one curve each in the diagrams.

For a fair comparison their right-hand sides are compiled, run times exclude compilation and sampling, and
each integrator has its best settings.
"""

from __future__ import annotations

from functools import partial

from ..trade_off import Peer
from . import integrators, mujoco_model

# name, method, tolerances, stiffnesses of the viscous clutches, N·m·s/rad (none: event location)
_INTEGRATORS: tuple[tuple[str, str, tuple[float, ...], tuple[float, ...]], ...] = (
    ("SciPy LSODA", "odeint", (1e-5, 1e-6, 1e-7, 3e-8, 1e-8, 1e-9), (1e2, 1e3, 1e4, 1e5, 1e6)),
    ("SciPy LSODA", "odeint", (3e-8, 1e-8, 5e-9, 1e-9), (3e6,)),
    ("SciPy Radau", "Radau", (1e-4, 1e-5), (1e3, 1e4)),
    ("SciPy DOP853, events", "DOP853", (1e-4, 1e-8, 1e-10), ()),
    ("SciPy RK45, events", "RK45", (1e-3, 1e-6, 1e-8), ()),
    ("SciPy LSODA, events", "LSODA", (1e-6, 1e-8, 1e-10), ()),
    ("CVODE BDF", "BDF", (1e-6, 1e-8, 1e-10), (1e3, 1e4, 1e5)),
    ("CVODE Adams, root finding", "Adams", (1e-4, 1e-6, 1e-8, 1e-9, 1e-10), ()),
    ("CVODE BDF, root finding", "BDF", (1e-4, 1e-6, 1e-8, 1e-9, 1e-10), ()),
)


PEERS: list[Peer] = [
    (
        name if stiffness is None else f"{name}, clutch {stiffness:.0e}",
        f"rtol {tolerance:.0e}",
        partial(integrators.simulate, tolerance=tolerance, method=method, stiffness=stiffness),
    )
    for name, method, tolerances, stiffnesses in _INTEGRATORS
    for stiffness in stiffnesses or (None,)
    for tolerance in tolerances
]
PEERS += [
    (f"MuJoCo {name}", f"step {step:.0e}", partial(mujoco_model.simulate, timestep=step, integrator=name))
    for name in ("Euler", "RK4")
    for step in (1e-3, 1e-4, 1e-5)
]
