"""Similarity criteria of the driven system, from physical quantities and back."""

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
        nu: criterion of frequency similarity, nu^2 = c T^2 / J4, the frequency of the undamped
            oscillation in rad per unit of kappa; over 0 and up to 1e9.
        Pi: damping criterion, 2 Pi = f T / J4; from 0 up to 1e9. The oscillation is aperiodic from
            Pi = nu on.

    Raises:
        ValueError: a criterion is not finite or out of its range.
    """

    nu: float
    Pi: float

    def __post_init__(self) -> None:
        above(self.nu, "nu", largest=LARGEST_CRITERION)
        above(self.Pi, "Pi", zero=True, largest=LARGEST_CRITERION)

    @classmethod
    def from_physical(cls, c: float, J4: float, f: float, T: float) -> Criteria:
        """Criteria of a driven mass on an elastic shaft, equation (3).

        Args:
            c: torsional stiffness of the shaft, N m/rad. J4: driven moment of inertia, kg m^2.
            f: viscous friction of the driven mass against the frame, N m s/rad.
            T: time in which kappa grows by one, s; phases I and III last T/2 each.

        Raises:
            ValueError: c, J4 or T is not above 0, or f is below 0.
        """
        nu = above(T, "T") * math.sqrt(above(c, "c") / above(J4, "J4"))
        return cls(nu=nu, Pi=0.5 * above(f, "f", zero=True) * T / J4)

    def to_physical(self, J4: float, T: float) -> tuple[float, float]:
        """Stiffness and friction (c, f), N m/rad and N m s/rad, that have these criteria.

        Raises:
            ValueError: J4 or T is not above 0.
        """
        return above(J4, "J4") * (self.nu / above(T, "T")) ** 2, 2.0 * self.Pi * J4 / T


def dwell(phi_p: float, phi_engage: float) -> float:
    """Length kappa2 of the phase of steady motion, kappa2 = phi_p / (2 phi_engage).

    Args:
        phi_p: angle turned at steady speed, rad. phi_engage: angle turned while the wheels come into
            and out of engagement, phases I and III together, rad; a = 1 stands for it.

    Raises:
        ValueError: phi_p is below 0 or phi_engage not above 0.
    """
    return above(phi_p, "phi_p", zero=True) / (2.0 * above(phi_engage, "phi_engage"))


def balancing_torque(inertia: float, acceleration: float) -> float:
    """Torque of the balancer, N m, equation (2): M = I d^2 psi / dt^2 (printed d psi / dt^2).

    inertia: reduced one that is balanced, kg m^2, beta J4 in (3); acceleration: of the driving link, rad/s^2.
    """
    return inertia * acceleration
