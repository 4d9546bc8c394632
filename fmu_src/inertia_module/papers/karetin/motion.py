"""How the links turn: Karetin, equation (1), and his two modes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from ...common.errors import must_be
from ...contract.variables import BY_NAME
from .geometry import Geometry


def _checked_speed(name: str, value: float) -> float:
    limit = BY_NAME["omega1"]
    if not limit.accepts(float(value)):
        raise ValueError(must_be(name, limit.allowed, value))
    return float(value)


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
        for name in ("omega1", "omega2", "carrier"):
            object.__setattr__(self, name, _checked_speed(name, getattr(self, name)))

    def drive_rate(self, geometry: Geometry) -> Fraction:
        """Exact omega16 = k (omega1 - omega2), rad/s: equation (1)."""
        return geometry.drive_ratio * (Fraction(self.omega1) - Fraction(self.omega2))


def stop_mode(omega1: float) -> Motion:
    """The paper's stop mode: i = infinity, omega2 = 0, and OQ at rest on Oz.

    Args:
        omega1: speed of link 1 against link 2, rad/s.
    """
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


def transmission_ratios(geometry: Geometry, motion: Motion) -> tuple[float, float, float]:
    """Speeds of link 2, of the drive in link 1 and of the satellite on the drive: equation (1).

    Returns:
        (omega2, omega16, omega6), rad/s, the last two correctly rounded.
    """
    drive = motion.drive_rate(geometry)
    return motion.omega2, float(drive), float(geometry.satellite_ratio * drive)
