"""Motion of the driven mass, equation (3), in closed form: every damping, dwell and balancer.

The equation is solved for the twist e = a - a_k of the shaft. What drives it is small where the shaft is
stiff, so that nothing is lost when nu is large, and with the balancer and without friction it is zero:

    e'' + 2 Pi e' + nu^2 e = -2 Pi a_k' - (1 - beta) a_k''
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .criteria import Criteria
from .law import HALF, TWO_PI, law_of_motion, phase_of, phase_starts
from .modes import Modes

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Response:
    """Motion of the driven mass as the paper's invariants; arrays of the shape of kappa.

    Attributes:
        angle: a, in units of phi_engage. velocity: a'. acceleration: a'', the invariant the paper plots.
        twist: e = a - a_k of the shaft.
    """

    angle: Array
    velocity: Array
    acceleration: Array
    twist: Array

    def in_units(self, phi_engage: float, T: float) -> tuple[Array, Array, Array]:
        """Angle, speed and acceleration of the driven mass, rad, rad/s and rad/s^2.

        Args:
            phi_engage: angle that a = 1 stands for, rad. T: time in which kappa grows by one, s.
        """
        scale = phi_engage
        return scale * self.angle, scale / T * self.velocity, scale / (T * T) * self.acceleration


def forcing(criteria: Criteria, beta: float, phase: int) -> tuple[float, complex]:
    """What drives the twist in a phase: steady + Re(wave exp(2 pi i kappa)), kappa from its beginning.

    Args:
        criteria: nu and Pi. beta: gain of the balancer. phase: 0 to 3.

    Returns:
        (steady, wave).
    """
    steady = (-2.0, -4.0, -2.0, 0.0)[phase] * criteria.Pi
    wave = complex(2.0 * criteria.Pi, TWO_PI * (1.0 - beta))
    return steady, (wave, 0j, -wave, 0j)[phase]


def twist_in_phase(
    criteria: Criteria, beta: float, phase: int, start: tuple[float, float], kappa: ArrayLike
) -> tuple[Array, Array, Array]:
    """Twist and its two derivatives within a phase.

    Args:
        criteria: nu and Pi. beta: gain of the balancer. phase: 0 to 3.
        start: twist (e, e') at the beginning of the phase. kappa: from its beginning, shape (n,).

    Returns:
        (e, e', e''), each of shape (n,), without unit.
    """
    modes = Modes(criteria, kappa)
    steady, wave = forcing(criteria, beta, phase)
    parts = (modes.free(*start), modes.forced(steady, 0j), modes.forced(wave, complex(0.0, TWO_PI)))
    return (
        sum((part.value for part in parts), np.zeros_like(modes.kappa)),
        sum((part.rate for part in parts), np.zeros_like(modes.kappa)),
        sum((part.rate2 for part in parts), np.zeros_like(modes.kappa)),
    )


def twist_at_starts(criteria: Criteria, kappa2: float, beta: float = 1.0) -> list[tuple[float, float]]:
    """Twist (e, e') with which phases I to IV begin; the constants C1, C2 of the paper stand for these.

    Args:
        criteria: nu and Pi. kappa2: length of phase II. beta: gain of the balancer, 0 for none.

    Returns:
        Four pairs, without unit. The first is rest.
    """
    starts = [(0.0, 0.0)]
    for phase, length in enumerate((HALF, kappa2, HALF)):
        twist, rate, _ = twist_in_phase(criteria, beta, phase, starts[-1], length)
        starts.append((float(twist), float(rate)))
    return starts


def response(kappa: ArrayLike, criteria: Criteria, kappa2: float, beta: float = 1.0) -> Response:
    """Motion of the driven mass from rest, equation (3).

    Args:
        kappa: relative time t/T, any shape (n,); before 0 everything rests.
        criteria: nu and Pi; under-, critically and overdamped alike, resonance nu = 2 pi included.
        kappa2: length of phase II, any from 0 on.
        beta: gain of the balancer: 1 the paper's, 0 without it, or any other number.

    Returns:
        Response with arrays of shape (n,), without unit. Angle, velocity and acceleration are
        continuous from phase to phase.

    Raises:
        ValueError: kappa2 is below 0, or kappa, kappa2 or beta is not finite.
    """
    time = np.asarray(kappa, dtype=np.float64)
    if not np.isfinite(time).all() or not np.isfinite(beta):
        raise ValueError(f"kappa and beta = {beta} are refused: allowed are finite numbers")
    begins = phase_starts(kappa2)
    initial = twist_at_starts(criteria, kappa2, beta)
    number = phase_of(time, kappa2)
    twist = np.zeros_like(time)
    rate, rate2 = np.zeros_like(time), np.zeros_like(time)
    for phase in range(4):
        chosen = (number == phase) & (time >= 0.0)
        local = time[chosen] - begins[phase]
        twist[chosen], rate[chosen], rate2[chosen] = twist_in_phase(
            criteria, beta, phase, initial[phase], local
        )
    angle, velocity, acceleration = law_of_motion(time, kappa2)
    return Response(angle + twist, velocity + rate, acceleration + rate2, twist)
