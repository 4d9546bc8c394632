"""Free and forced motion of y'' + 2 Pi y' + nu^2 y in every damping regime, without cancellation.

The textbook forms divide by nu1 = sqrt(nu^2 - Pi^2), by nu^2 and by nu0^2 + (4 pi Pi)^2: they fail or
lose digits at critical damping, for slow systems and at resonance. All of them are divided differences
of exp(lambda kappa) over the characteristic numbers and the number of the forcing, and those stay finite
when points meet. Motion from rest under the forcing exp(mu kappa) is the second divided difference over
(slow, fast, mu), the impulse response the first over (slow, fast).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .criteria import Criteria

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

# below this half distance the product form is used, above it the plain difference: neither cancels
NEAR = 0.5


def characteristic_numbers(criteria: Criteria) -> tuple[complex, complex]:
    """Roots (slow, fast) of lambda^2 + 2 Pi lambda + nu^2: conjugate, equal or both real."""
    nu, Pi = criteria.nu, criteria.Pi
    root = np.sqrt(abs(nu - Pi)) * np.sqrt(nu + Pi)
    if nu > Pi:
        return complex(-Pi, root), complex(-Pi, -root)
    fast = -(Pi + root)
    # the slow root by Vieta: -Pi + root would cancel at strong damping
    return complex(nu * (nu / fast)), complex(fast)


def first_difference(one: complex, two: complex, kappa: ArrayLike) -> Complex:
    """(exp(one kappa) - exp(two kappa)) / (one - two), kappa exp(one kappa) where they meet.

    Args:
        one, two: exponents per unit of kappa, real parts not above 0. kappa: any shape (n,), not below 0.

    Returns:
        Shape (n,), complex.
    """
    time = np.asarray(kappa, dtype=np.float64)
    half = 0.5 * (one - two) * time
    near = np.abs(half) < NEAR
    argument = np.where(near & (half != 0.0), half, 1.0)
    ratio = np.where(half == 0.0, 1.0, np.sinh(argument) / argument)
    product = time * np.exp(0.5 * (one + two) * time) * ratio
    distance = one - two if one != two else 1.0
    result: Complex = np.where(near, product, (np.exp(one * time) - np.exp(two * time)) / distance)
    return result


def second_difference(points: tuple[complex, complex, complex], kappa: ArrayLike) -> Complex:
    """Second divided difference of exp(lambda kappa): one over the distance of the points farthest apart.

    Args:
        points: exponents per unit of kappa, not all equal, real parts not above 0.
        kappa: any shape (n,), not below 0.

    Returns:
        Shape (n,), complex.
    """
    orders = ((0, 1, 2), (0, 2, 1), (1, 0, 2))
    ends = max(orders, key=lambda order: abs(points[order[0]] - points[order[2]]))
    left, middle, right = (points[place] for place in ends)
    return (first_difference(left, middle, kappa) - first_difference(middle, right, kappa)) / (left - right)


@dataclass(frozen=True)
class Motion:
    """A motion and its first two derivatives in kappa, each of the shape of kappa."""

    value: Array
    rate: Array
    rate2: Array


class Modes:
    """The propagator of one system over given times.

    Args:
        criteria: nu and Pi. kappa: relative times from the beginning of a phase, any shape (n,), >= 0.
    """

    def __init__(self, criteria: Criteria, kappa: ArrayLike) -> None:
        self.kappa = np.asarray(kappa, dtype=np.float64)
        self.slow, self.fast = characteristic_numbers(criteria)
        self.nu = criteria.nu
        fading = np.exp(self.fast * self.kappa)
        impulse = first_difference(self.slow, self.fast, self.kappa)
        rate = fading + self.slow * impulse
        # complex terms of a conjugate pair add up to real numbers
        self._step = (fading - self.fast * impulse).real
        self._impulse, self._rate = impulse.real, rate.real
        self._rate2 = (self.slow * rate + self.fast * fading).real

    def free(self, value: float, rate: float) -> Motion:
        """Free motion from these initial values."""
        nu2 = self.nu * self.nu
        return Motion(
            value * self._step + rate * self._impulse,
            rate * self._rate - value * nu2 * self._impulse,
            rate * self._rate2 - value * nu2 * self._rate,
        )

    def forced(self, amplitude: complex, exponent: complex) -> Motion:
        """Motion from rest under the forcing Re(amplitude exp(exponent kappa)).

        Differentiated through the forcing, y' = mu y + g with g the impulse response: exact, and no
        stiff number multiplies a difference.
        """
        response = second_difference((self.slow, self.fast, exponent), self.kappa)
        rate = exponent * response + self._impulse
        return Motion(
            (amplitude * response).real,
            (amplitude * rate).real,
            (amplitude * (exponent * rate + self._rate)).real,
        )
