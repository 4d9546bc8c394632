"""Stelmashchuk's law of motion of a stepping drive: rising sinusoidally, steady, falling, at rest.

kappa: relative time t/T, a number or of any shape, as the results; kappa2: length of phase II. Angles are
in units of phi_engage, the angle turned in phases I and III together.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia_module.scene.shaft import stepping_speed

Array = NDArray[np.float64]

TWO_PI = 2.0 * np.pi
# kappa_1 and kappa_3 of the paper: the lengths of phases I and III
HALF = 0.5
PHASES = ("I", "II", "III", "IV")


def phase_starts(kappa2: float) -> Array:
    """Starts of phases I to IV, in kappa, shape (4,).

    Raises:
        ValueError: kappa2 is below 0 or not finite.
    """
    if not (math.isfinite(kappa2) and kappa2 >= 0.0):
        raise ValueError(f"kappa2 must be finite, at least 0, is {kappa2}")
    return np.array([0.0, HALF, HALF + kappa2, HALF + kappa2 + HALF])


def phase_of(kappa: ArrayLike, kappa2: float) -> NDArray[np.intp]:
    """Number of the phase, 0 to 3, at each kappa (a boundary counts to the later phase)."""
    return np.searchsorted(phase_starts(kappa2)[1:], np.asarray(kappa, dtype=np.float64), side="right")


def law_of_motion(kappa: ArrayLike, kappa2: float) -> tuple[Array, Array, Array]:
    """Angle of the driving wheel and its derivatives in kappa, (a_k, a_k', a_k''), as invariants.

    Phase I: a = kappa - sin(2 pi kappa) / (2 pi); II: 0.5 + 2 kappa; III: mirrors I; IV: rest, kappa
    counted from the beginning of the phase. Before kappa = 0 the wheel rests as well. a_k'' is the
    sinusoid S_k the paper compares with, 2 pi at its peaks.

    Raises:
        ValueError: kappa2 is below 0 or not finite.
    """
    time, starts, phase = np.asarray(kappa, dtype=np.float64), phase_starts(kappa2), phase_of(kappa, kappa2)
    # each phase adds what it has run through, so that no phase has to be picked
    up = np.clip(time, 0.0, starts[1])
    steady = np.clip(time - starts[1], 0.0, kappa2)
    down = np.clip(time - starts[2], 0.0, HALF)
    angle = up - np.sin(TWO_PI * up) / TWO_PI + 2.0 * steady + down + np.sin(TWO_PI * down) / TWO_PI
    wave = (phase == 0) * np.sin(TWO_PI * up) - (phase == 2) * np.sin(TWO_PI * down)
    return angle, stepping_speed(time, kappa2), TWO_PI * wave
