"""Similarity criteria of the driven system."""

from __future__ import annotations

from dataclasses import dataclass

from ..checks import above

# beyond it the phase of the oscillation nu kappa keeps too few digits to mean anything
LARGEST_CRITERION = 1e9


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
