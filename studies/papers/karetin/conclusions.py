"""Karetin's conclusions 2 and 3: about which instants a quantity is symmetric, about which axes D swings.

With q = omega16 t the angles are A = q + gamma and B = s q + epsilon. About q = (n pi - epsilon)/s, where
B is a multiple of pi, the radial place of D is even and the tangential one odd. So only
A there, gamma - epsilon/s + n pi/s, decides: epsilon and gamma count through gamma - epsilon/s alone,
and not at all in the moduli of the stop mode, for which no direction across OQ is special.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .cases import period
from .exact import exact
from .geometry import Geometry
from .motion import Motion

Array = NDArray[np.float64]
Function = Callable[[Array], Array]


class Mirror(NamedTuple):
    """The instant about which a function is best mirrored.

    Attributes:
        instant: s. asymmetry: the largest |f(instant + u) - sign f(instant - u)| over the range of f,
            the smallest that any instant gives: 0 is symmetric; 0 also for a constant.
    """

    instant: float
    asymmetry: float


def best_mirror(function: Function, period: float, sign: float = 1.0, samples: int = 2000) -> Mirror:
    """How far a periodic function is from being mirrored about an instant.

    Args:
        function: of times, s, shape (n,), to values, shape (n,). period: of the function, s.
        sign: 1 for mirrored, -1 for mirrored with the opposite sign (a function of mean 0).
        samples: of the search for the instant.
    """
    dt, index = period / samples, np.arange(samples)
    f = function(np.asarray(dt * index, dtype=np.float64))
    span = float(np.ptp(f))
    if span <= 1e-12 * float(np.abs(f).max()):
        return Mirror(0.0, 0.0)
    u = np.linspace(0.0, 0.5 * period, samples // 8)

    def refined(instant: float) -> tuple[float, float]:
        """Least difference near an instant and where it is, on finer and finer grids."""
        for finer in range(8):
            instants = instant + dt * 0.2**finer * np.linspace(-1.0, 1.0, 11)
            times = instants[:, None] + np.concatenate([u, -u])
            values = function(times.ravel()).reshape(times.shape)
            errors = np.abs(values[:, : len(u)] - sign * values[:, len(u) :]).max(axis=1)
            instant = float(instants[np.argmin(errors)])
        return float(errors.min()), instant

    coarse = [np.abs(f - sign * f[(m - index) % samples]).max() for m in range(samples)]
    error, instant = min(refined(0.5 * m * dt) for m in np.argsort(coarse)[:4])
    return Mirror(instant, error / span)


def quantity(name: str, geometry: Geometry, motion: Motion) -> Function:
    """One of the exact quantities as a function of times."""
    return lambda t: getattr(exact(geometry, motion, t), name)  # type: ignore[no-any-return]


def asymmetry(name: str, geometry: Geometry, motion: Motion) -> float:
    """Asymmetry of one of the moduli over the period of the motion in link 1."""
    return best_mirror(quantity(name, geometry, motion), period(geometry, motion)).asymmetry


def asymmetry_of_components(geometry: Geometry, motion: Motion) -> float:
    """Largest asymmetry of V_x, V_y, V_z over that period, mirrored with either sign."""
    span, velocity = period(geometry, motion), quantity("velocity", geometry, motion)
    components = (lambda t, axis=axis: velocity(t)[axis] for axis in range(3))
    return max(min(best_mirror(v, span, sign).asymmetry for sign in (1.0, -1.0)) for v in components)


class Swing(NamedTuple):
    """The angle of D about one axis over a span of time, in the sense of beta_P, beta_F or beta_H.

    Attributes:
        turns: whole turns gained: 0 is a swing to and fro. amplitude: half the range of the angle, rad.
    """

    turns: int
    amplitude: float


def swings(geometry: Geometry, motion: Motion) -> dict[str, Swing]:
    """The swing over a period about "Ox" (beta_P), "Oy" (beta_F) and "Oz" (beta_H) of the fixed frame."""
    # not from 0: a pole of the cones stands on an axis there
    t = period(geometry, motion) * (np.arange(40_001) + 0.5) / 40_000
    beta = np.unwrap(exact(geometry, motion, t).angles)
    turns, amplitudes = np.rint((beta[:, -1] - beta[:, 0]) / (2.0 * np.pi)), 0.5 * np.ptp(beta, axis=1)
    return {axis: Swing(int(turns[n]), float(amplitudes[n])) for n, axis in enumerate(("Oz", "Ox", "Oy"))}
