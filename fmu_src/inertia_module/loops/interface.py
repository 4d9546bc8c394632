"""Interface inertia, which the input shaft feels when its speed changes suddenly: the interface inertia.

With link 2 held, omega1 turns everything: Phi = J1 + I + 2 k B + k^2 G. Where link 2 is free to follow, or
drives the shaft, less of it answers a jump: Phi - k^2 (B + k G)^2 / (J + k^2 G), with J = J2 or J2 + J3. So
Phi is the most an engine can meet.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..kernel.links import inertia_at_input
from ..memory import Module

# points for each turn of the drive in a period of the motion
_POINTS_A_TURN = 180


class InterfaceInertia(NamedTuple):
    """Phi over the angle of the drive, kg.m2: the least, mean and greatest; midway between the extremes."""

    least: float
    mean: float
    greatest: float

    @property
    def middle(self) -> float:
        """Midway between the least and the greatest."""
        return 0.5 * (self.least + self.greatest)


def interface_inertia(parameters: Mapping[str, float]) -> InterfaceInertia:
    """The interface inertia of a module.

    Args:
        parameters: those that differ from the defaults.

    Raises:
        Refused: the module refuses the parameters.
    """
    module = Module("plain")
    module.check(**{**parameters, "fidelity": 2.0})
    turns = int(module.derived.period_turns)
    angles = np.linspace(0.0, 2.0 * math.pi * turns, _POINTS_A_TURN * turns, endpoint=False)
    values = [float(inertia_at_input(module.derived, float(q))) for q in angles]  # type: ignore[no-untyped-call]
    return InterfaceInertia(min(values), sum(values) / len(values), max(values))
