"""How the links turn: Karetin, equation (1), and his two modes."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia_module.common.errors import must_be
from inertia_module.contract.variables import BY_NAME

from .geometry import Geometry

# 1 / (2 pi) to 2**-320
ONE_RADIAN = Fraction(
    0x28BE60DB9391054A7F09D5F47D4D377036D8A5664F10E4107F9458EAF7AEF1586DC91B8E909374B8, 2**320
)  # turns
# with more turns than that the doubles of t are further than a rounding of an angle apart
MOST_TURNS = 2.0**52


@dataclass(frozen=True)
class Motion:
    """Steady speeds of the links.

    Attributes:
        omega1: of link 1, rad/s. omega2: of link 2, rad/s.
        carrier: speed about Ox of the frame that carries the axis OQ, rad/s. In the mechanism that is
            link 1. The paper's stop mode has OQ at rest on Oz: its motion is the one seen from link 1.

    Raises:
        ValueError: a speed that is not finite or too large, with name, value and what is allowed.
    """

    omega1: float
    omega2: float
    carrier: float

    def __post_init__(self) -> None:
        for name, value in zip(("omega1", "omega2", "carrier"), astuple(self), strict=True):
            if not BY_NAME["omega1"].accepts(float(value)):
                raise ValueError(must_be(name, BY_NAME["omega1"].allowed, value))


def stop_mode(omega1: float) -> Motion:
    """The paper's stop mode: i = infinity, omega2 = 0, OQ at rest on Oz; omega1 against link 2, rad/s."""
    return Motion(omega1, 0.0, 0.0)


def dynamic_mode(omega1: float, transmission: float) -> Motion:
    """The dynamic mode: link 1 turns with omega1 and carries OQ.

    Args:
        omega1: speed of link 1, rad/s.
        transmission: i = omega1/omega2, math.inf with link 2 held.

    Raises:
        ValueError: transmission is 0 or no number.
    """
    if transmission == 0.0 or math.isnan(transmission):
        raise ValueError(must_be("transmission", "any number but 0, infinity included", transmission))
    return Motion(omega1, omega1 / transmission, omega1)


def exact_rates(g: Geometry, motion: Motion) -> tuple[Fraction, Fraction]:
    """Speeds of the drive in link 1 and of the satellite on the drive, rad/s: equation (1)."""
    drive = Fraction(g.z2) / Fraction(g.z16) * (Fraction(motion.omega1) - Fraction(motion.omega2))
    return drive, Fraction(g.z17) / Fraction(g.z6) * drive


def transmission_ratios(g: Geometry, motion: Motion) -> tuple[float, float, float]:
    """Equation (1): (omega2, omega16, omega6), rad/s, the last two correctly rounded."""
    drive, satellite = exact_rates(g, motion)
    return motion.omega2, float(drive), float(satellite)


def angle_turned(rate: Fraction, offset: float, times: Any) -> NDArray[np.float64]:
    """The angle offset + rate t within half a turn, rad, right to rounding however long it has turned.

    The product of two doubles has lost 1e-8 rad after 1e8 rad. Here rate and time are split into parts of
    24 bits, whose products are exact, and whole turns are taken off each.

    Args:
        rate: rad/s. offset: rad. times: s, shape (n,).

    Raises:
        ValueError: times not finite, or so long that doubles no longer resolve the angle.
    """
    turns, start = rate * ONE_RADIAN, Fraction(offset) * ONE_RADIAN
    longest = MOST_TURNS / abs(float(turns)) if turns else math.inf
    wrong = times[~(np.abs(times) <= longest) | ~np.isfinite(times)]
    if wrong.size:
        raise ValueError(f"t must be from {-longest:.16g} to {longest:.16g} s, is {wrong[0]:.16g}")
    angle, lost = np.full(times.shape, float(start - round(start))), np.zeros(times.shape)
    for _ in range(4):
        part = float(np.float32(float(turns)))
        turns -= Fraction(part)
        rest = times
        for _ in range(3):
            leading = rest.astype(np.float32).astype(np.float64)
            rest = rest - leading
            product = part * leading
            product -= np.rint(product)
            # what the sum rounds off (Knuth's two-sum) counts where the angle comes near 0
            total = angle + product
            added = total - angle
            lost += (angle - (total - added)) + (product - added)
            angle = total - np.rint(total)
    return 2.0 * math.pi * (angle + lost)
