"""Angles that turn steadily, right to rounding however long they have turned.

The product omega t of two doubles has lost 1e-8 rad after 1e8 rad. Here turns per second are a ratio of
whole numbers, rounded to two doubles; their product with t is split exactly (Dekker 1971), and whole
turns are taken off it without rounding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TWO_PI = 2.0 * math.pi
# 1 / (2 pi) to 2**-320
ONE_RADIAN = Fraction(
    0x28BE60DB9391054A7F09D5F47D4D377036D8A5664F10E4107F9458EAF7AEF1586DC91B8E909374B8, 2**320
)  # turns
_SPLITTER = 2.0**27 + 1.0
# with more turns than that the doubles of t are further than a rounding of an angle apart
MOST_TURNS = 2.0**52


@dataclass(frozen=True)
class Times:
    """Times with their leading and trailing halves, so that products with them can be split exactly.

    Attributes:
        t: times, s, shape (n,). high, low: t = high + low, each of 26 bits.
    """

    t: Array
    high: Array
    low: Array

    @classmethod
    def of(cls, t: Array) -> Times:
        """Split times t, s, shape (n,)."""
        spread = t * _SPLITTER
        high = spread - (spread - t)
        return cls(t, high, t - high)


@dataclass(frozen=True)
class Turning:
    """An angle turning steadily from an offset.

    Attributes:
        high, low: turns per second, in two doubles. start: turns at the time 0, within half a turn.
    """

    high: float
    low: float
    start: float

    @classmethod
    def at(cls, rate: Fraction, offset: float = 0.0) -> Turning:
        """From the exact rate, rad/s, and the offset, rad."""
        turns = rate * ONE_RADIAN
        start = Fraction(offset) * ONE_RADIAN
        high = float(turns)
        return cls(high, float(turns - Fraction(high)), float(start - round(start)))

    @property
    def longest_time(self) -> float:
        """Times further from 0 than this, s, are refused (infinite at rest)."""
        return MOST_TURNS / abs(self.high) if self.high != 0.0 else math.inf

    def angle(self, times: Times) -> Array:
        """The angle within a turn or so of 0, rad, shape (n,): error below 2e-15 rad."""
        if self.high == 0.0:
            return np.full_like(times.t, TWO_PI * self.start)
        spread = self.high * _SPLITTER
        high = spread - (spread - self.high)
        low = self.high - high
        turns = self.high * times.t
        error = high * times.high
        error -= turns
        error += high * times.low
        error += low * times.high
        error += low * times.low
        error += self.low * times.t
        turns -= np.rint(turns)
        error += self.start
        turns += error
        turns *= TWO_PI
        return turns
