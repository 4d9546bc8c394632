"""Similarity criteria of the driven system, from physical quantities and back."""

from __future__ import annotations

import math
from dataclasses import dataclass

# beyond it the phase of the oscillation nu kappa keeps too few digits to mean anything
LARGEST_CRITERION = 1e9


def require(value: float, name: str, lowest: float, open_end: bool = False) -> float:
    """The value, if it is finite and not below the lowest one allowed.

    Raises:
        ValueError: otherwise; names the value and the allowed range.
    """
    number = float(value)
    if not math.isfinite(number) or number < lowest or (open_end and number == lowest):
        sign = ">" if open_end else ">="
        raise ValueError(f"{name} = {number} is refused: allowed is a finite number {sign} {lowest:g}")
    return number


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
        require(self.nu, "nu", 0.0, open_end=True)
        require(self.Pi, "Pi", 0.0)
        if max(self.nu, self.Pi) > LARGEST_CRITERION:
            raise ValueError(
                f"nu = {self.nu}, Pi = {self.Pi} is refused: allowed is up to {LARGEST_CRITERION:g}"
            )

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
        require(c, "c", 0.0, open_end=True)
        require(J4, "J4", 0.0, open_end=True)
        require(f, "f", 0.0)
        require(T, "T", 0.0, open_end=True)
        return cls(nu=T * math.sqrt(c / J4), Pi=0.5 * f * T / J4)

    def to_physical(self, J4: float, T: float) -> tuple[float, float]:
        """Stiffness and friction that have these criteria.

        Args:
            J4: driven moment of inertia, kg m^2. T: time in which kappa grows by one, s.

        Returns:
            (c, f): N m/rad and N m s/rad.

        Raises:
            ValueError: J4 or T is not above 0.
        """
        require(J4, "J4", 0.0, open_end=True)
        require(T, "T", 0.0, open_end=True)
        return J4 * (self.nu / T) ** 2, 2.0 * self.Pi * J4 / T


def dwell(phi_p: float, phi_engage: float) -> float:
    """Length kappa2 of the phase of steady motion, kappa2 = phi_p / (2 phi_engage).

    Args:
        phi_p: angle turned at steady speed, rad. phi_engage: angle turned while the wheels come into
            and out of engagement, phases I and III together, rad; a = 1 stands for it.

    Raises:
        ValueError: phi_p is below 0 or phi_engage not above 0.
    """
    return require(phi_p, "phi_p", 0.0) / (2.0 * require(phi_engage, "phi_engage", 0.0, open_end=True))


def balancing_torque(inertia: float, acceleration: float) -> float:
    """Torque of the balancer, equation (2): M = I d^2 psi / dt^2 (printed d psi / dt^2).

    Args:
        inertia: reduced moment of inertia that is balanced, kg m^2; beta J4 in equation (3).
        acceleration: of the driving link, rad/s^2.

    Returns:
        N m.
    """
    return inertia * acceleration
