"""Conclusion 2: when is a kinematic quantity symmetric about some instant of its period?

With q = omega16 t the angles are A = q + gamma and B = s q + epsilon. About q = (n pi - epsilon)/s, where
B is a multiple of pi, the radial place of D is even and the tangential one odd. So only
A there, gamma - epsilon/s + n pi/s, decides: epsilon and gamma count through gamma - epsilon/s alone,
and not at all in the moduli of the stop mode, for which no direction across OQ is special.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import exact
from .cases import period
from .geometry import Geometry
from .motion import Motion

Array = NDArray[np.float64]

SAMPLES = 2000
_BEST = 4
_ROUNDS = 8


@dataclass(frozen=True)
class Mirror:
    """The instant about which a function is best mirrored.

    Attributes:
        instant: s. asymmetry: the largest |f(instant + u) - sign f(instant - u)| over the range of f,
            the smallest that any instant gives: 0 is symmetric; 0 also for a constant.
    """

    instant: float
    asymmetry: float


def best_mirror(
    function: Callable[[Array], Array], period: float, sign: float = 1.0, samples: int = SAMPLES
) -> Mirror:
    """How far a periodic function is from being mirrored about an instant.

    Args:
        function: of times, s, shape (n,), to values, shape (n,).
        period: of the function, s.
        sign: 1 for mirrored, -1 for mirrored with the opposite sign (a function of mean 0).
        samples: of the search for the instant.
    """
    dt = period / samples
    index = np.arange(samples)
    f = function((dt * index).astype(np.float64))
    span = float(np.ptp(f))
    if span <= 1e-12 * float(np.abs(f).max()):
        return Mirror(0.0, 0.0)
    errors = np.array([np.abs(f - sign * f[(m - index) % samples]).max() for m in range(samples)])
    u = np.linspace(0.0, 0.5 * period, samples // 8)

    def error(instants: Array) -> Array:
        """Largest difference about each instant."""
        times = instants[:, None] + np.concatenate([u, -u])
        values = function(times.ravel()).reshape(times.shape)
        result: Array = np.abs(values[:, : len(u)] - sign * values[:, len(u) :]).max(axis=1)
        return result

    least, instant = min(_refined(error, 0.5 * m * dt, dt) for m in np.argsort(errors)[:_BEST])
    return Mirror(instant, least / span)


def _refined(error: Callable[[Array], Array], instant: float, width: float) -> tuple[float, float]:
    """Least error near an instant and where it is, on finer and finer grids."""
    grid = np.linspace(-1.0, 1.0, 11)
    for _ in range(_ROUNDS):
        instants = instant + width * grid
        errors = error(instants)
        best = int(np.argmin(errors))
        instant = float(instants[best])
        width *= 0.2
    return float(errors[best]), instant


def speed(geometry: Geometry, motion: Motion) -> Callable[[Array], Array]:
    """|V| as a function of times, m/s."""
    return lambda t: exact.modulus(exact.velocity(exact.configuration(geometry, motion, t)))


def acceleration_modulus(geometry: Geometry, motion: Motion) -> Callable[[Array], Array]:
    """|a| as a function of times, m/s^2."""
    return lambda t: exact.modulus(exact.acceleration(exact.configuration(geometry, motion, t)))


def of_speed(geometry: Geometry, motion: Motion) -> float:
    """Asymmetry of |V| over the period of the motion in link 1."""
    return best_mirror(speed(geometry, motion), period(geometry, motion)).asymmetry


def of_acceleration(geometry: Geometry, motion: Motion) -> float:
    """Asymmetry of |a| over the period of the motion in link 1."""
    return best_mirror(acceleration_modulus(geometry, motion), period(geometry, motion)).asymmetry


def of_components(geometry: Geometry, motion: Motion) -> float:
    """Largest asymmetry of V_x, V_y, V_z over that period, mirrored with either sign."""

    def component(axis: int) -> Callable[[Array], Array]:
        return lambda t: exact.velocity(exact.configuration(geometry, motion, t))[:, axis]

    span = period(geometry, motion)
    return max(
        min(best_mirror(component(axis), span, sign).asymmetry for sign in (1.0, -1.0)) for axis in range(3)
    )
