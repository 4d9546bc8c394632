"""Conclusion 3: does D swing to and fro about an axis, or turn about it?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .complete import kinematics
from .geometry import Geometry
from .motion import Motion
from .projections import continuous

Array = NDArray[np.float64]

SAMPLES = 40_001


@dataclass(frozen=True)
class Swing:
    """The angle of D about one axis over a span of time, in the sense of beta_P, beta_F or beta_H.

    Attributes:
        turns: whole turns gained: 0 is a swing to and fro. amplitude: half the range of the angle, rad.
        reversals: how often the angle changes its sense.
    """

    turns: int
    amplitude: float
    reversals: int


def swings(geometry: Geometry, motion: Motion, span: float) -> dict[str, Swing]:
    """The swing about Ox, Oy and Oz of the fixed frame.

    Args:
        geometry: of the mechanism.
        motion: speeds of its links.
        span: a period of the motion in the fixed frame, s.

    Returns:
        by "Ox" (beta_P), "Oy" (beta_F), "Oz" (beta_H).
    """
    # not from 0: a pole of the cones stands on an axis there
    t = span * (np.arange(SAMPLES) / (SAMPLES - 1) + 0.5 / SAMPLES)
    beta = continuous(kinematics(geometry, motion, t).angles)
    return {axis: _swing(beta[:, column]) for axis, column in (("Ox", 1), ("Oy", 2), ("Oz", 0))}


def _swing(beta: Array) -> Swing:
    change = np.diff(beta)
    return Swing(
        turns=round(float(beta[-1] - beta[0]) / (2.0 * np.pi)),
        amplitude=0.5 * float(np.ptp(beta)),
        reversals=int(np.count_nonzero(change[1:] * change[:-1] < 0.0)),
    )
