"""The mechanisms and motions on which equations and claims are judged: the paper gives no numbers."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from .exact import Kinematics
from .geometry import Geometry
from .motion import Motion, dynamic_mode, stop_mode

# the scene R1: pole of the cones, no offsets
STANDARD = Geometry()
# s is whole, as the paper has it, for whom one turn of the drive is one period: its figures are drawn so
PAPER = Geometry(z17=40, z6=20)
# nothing vanishes or cancels, and D changes sides of every plane: the equations are judged on this one
GENERAL = Geometry(shaft_angle=math.radians(80.0), a=0.9, b=1.1, c=0.7, epsilon=0.4, gamma=0.3)

STOP = stop_mode(100.0)
# the link 1 closes with drive and satellite after ten turns of the drive, twenty of its own
DYNAMIC = dynamic_mode(100.0, 2.0)

SAMPLES = 20_000


def period(geometry: Geometry, motion: Motion) -> float:
    """Time after which drive and satellite stand in link 1 as before, s.

    Raises:
        ValueError: the drive is at rest.
    """
    rate = abs(float(motion.drive_rate(geometry)))
    if rate == 0.0:
        raise ValueError("omega1 - omega2 must not be 0 for the drive to turn")
    return 2.0 * math.pi * geometry.turns_in_period / rate


@cache
def over_period(geometry: Geometry = GENERAL, motion: Motion = STOP) -> Kinematics:
    """The exact set at SAMPLES times over one period, between the instants at which something may vanish."""
    return Kinematics(geometry, motion, (np.arange(SAMPLES) + 0.5) / SAMPLES * period(geometry, motion))
