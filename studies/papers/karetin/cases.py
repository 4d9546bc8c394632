"""The mechanisms and motions on which equations and claims are judged: the paper gives no numbers."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from ..forms import Forms
from .exact import exact
from .geometry import Geometry
from .motion import Motion, dynamic_mode, stop_mode, transmission_ratios

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
    """Time after which drive and satellite stand in link 1 as before, s; the drive must turn."""
    return 2.0 * math.pi * float(geometry.turns_in_period) / abs(transmission_ratios(geometry, motion)[1])


@cache
def over_period(geometry: Geometry = GENERAL, motion: Motion = STOP) -> Forms:
    """The exact forms at SAMPLES times over a period, between the instants at which something may vanish."""
    return exact(geometry, motion, (np.arange(SAMPLES) + 0.5) / SAMPLES * period(geometry, motion))
