"""Elastic coupling between the output shaft and a load, and its exact step (zero-order hold)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class Coupling(NamedTuple):
    """Elastic coupling between the output shaft and the load.

    The load follows a shaft of given speed exactly; its torque on the shaft is held over a step, so
    the two together are right to first order in the step.

    Attributes:
        stiffness: N.m/rad. damping: N.m.s/rad.
    """

    stiffness: float
    damping: float

    def torque(self, twist: float, speed_difference: float) -> float:
        """Its torque on both sides, N.m."""
        return self.stiffness * twist + self.damping * speed_difference


def sample(a: list[list[float]], b: list[list[float]], step: float) -> tuple[Any, Any]:
    """Exact step of x' = a x + b u with u held: (A, B) of x+ = A x + B u."""
    import control as ct

    size = len(a)
    continuous = ct.ss(a, b, np.eye(size), np.zeros((size, len(b[0]))))
    sampled = ct.sample_system(continuous, step, method="zoh")
    return sampled.A, sampled.B


def sample_coupled(
    inertia: float, coupling: Coupling, friction: float, step: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Exact step of twist, speed and angle of an inertia behind a coupling.

    Returns:
        (A, B) for the state (twist, speed, angle) and the input (speed of the shaft, torque against).
    """
    stiffness, damping = coupling
    a = [
        [0.0, -1.0, 0.0],
        [stiffness / inertia, -(damping + friction) / inertia, 0.0],
        [0.0, 1.0, 0.0],
    ]
    b = [[1.0, 0.0], [damping / inertia, -1.0 / inertia], [0.0, 0.0]]
    return sample(a, b, step)


def check_coupling(coupling: Coupling, inertia: float, shaft_inertia: float, step: float) -> None:
    """Refuse a step too long for an elastic coupling: its torque is held while the shaft moves.

    The shaft, with the torque held over a step, and the load behind it, in the order of ClosedLoop: no
    swing of the two may grow, and the damping may not turn the shaft round within a step.

    Args:
        coupling: between both. inertia: of the load, kg.m2.
        shaft_inertia: of the output shaft, kg.m2. step: communication step, s.

    Raises:
        ValueError: the step is too long.
    """
    a, b = sample_coupled(inertia, coupling, 0.0, step)
    # state (twist, speed of the load, speed of the shaft): first the shaft, then the load
    shaft = np.eye(3)
    stiffness, damping = coupling
    shaft[2] -= step / shaft_inertia * np.array([stiffness, -damping, damping])
    behind = np.eye(3)
    behind[:2, :2] = a[:2, :2]
    behind[:2, 2] = b[:2, 0]
    growth = np.abs(np.linalg.eigvals(behind @ shaft)).max()
    if growth > 1.0 + 1e-6 or step * damping > shaft_inertia:
        raise ValueError(
            f"with stiffness = {stiffness:g} N.m/rad, damping = {damping:g} N.m.s/rad and a shaft of"
            f" {shaft_inertia:g} kg.m2 the step must be shorter, is {step:g} s; a softer coupling or more"
            " inertia on the shaft helps too"
        )
