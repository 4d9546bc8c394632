"""Similarity criteria of the driven system."""

from __future__ import annotations

import math
from dataclasses import dataclass

# beyond it the phase of the oscillation nu kappa keeps too few digits to mean anything
LARGEST_CRITERION = 1e9


def above(value: float, name: str, zero: bool = False, largest: float = math.inf) -> float:
    """The value, if it is finite, above 0 (or 0, where that is allowed) and not too large.

    Raises:
        ValueError: otherwise; names the value and the allowed range.
    """
    if not (math.isfinite(value) and 0.0 <= value <= largest) or (value == 0.0 and not zero):
        upper = f" and at most {largest:g}" if math.isfinite(largest) else ""
        raise ValueError(f"{name} must be finite, {'at least' if zero else 'above'} 0{upper}, is {value}")
    return float(value)


@dataclass(frozen=True)
class Criteria:
    """The two criteria of equation (3), made with the time T of an acceleration and a deceleration.

    Attributes:
        nu: criterion of frequency similarity, nu^2 = c T^2 / J4, with the stiffness c of the shaft and the
            driven inertia J4: the frequency of the undamped oscillation in rad per unit of kappa; over 0
            and up to 1e9.
        Pi: damping criterion, 2 Pi = f T / J4, with the viscous friction f of the driven mass; from 0 up to
            1e9. The oscillation is aperiodic from Pi = nu on.

    Raises:
        ValueError: a criterion is not finite or out of its range.
    """

    nu: float
    Pi: float

    def __post_init__(self) -> None:
        above(self.nu, "nu", largest=LARGEST_CRITERION)
        above(self.Pi, "Pi", zero=True, largest=LARGEST_CRITERION)
