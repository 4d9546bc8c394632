"""Free oscillation of the driven mass, with the paper's constants C1 and C2 put right."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from inertia_module.loops.stepping import TWO_PI, phase_starts

from .criteria import Criteria
from .exact import forcing, response, twist_at_starts

# phase IV has no end: it is watched for this many units of kappa
WATCHED = 2.0


def constants(criteria: Criteria, kappa2: float, beta: float = 1.0) -> list[tuple[float, float]]:
    """C1 and C2 of phases I to IV: a = exp(-Pi kappa)(C1 sin nu1 kappa + C2 cos nu1 kappa) + R.

    The motion itself needs none of them (see exact): as nu1 goes to zero C1 has no limit.

    Raises:
        ValueError: Pi >= nu, or resonance (Pi = 0 and nu = 2 pi), where R does not exist.
    """
    nu, Pi = criteria.nu, criteria.Pi
    stiffness = complex(nu * nu - TWO_PI**2, 2.0 * TWO_PI * Pi)
    if nu <= Pi or stiffness == 0.0:
        raise ValueError(f"nu must be above Pi, and not 2 pi with Pi = 0, is {nu} with Pi = {Pi}")
    nu1 = np.sqrt((nu - Pi) * (nu + Pi))
    pairs = []
    for phase, (twist, rate) in enumerate(twist_at_starts(criteria, kappa2, beta)):
        steady, wave = forcing(criteria, beta, phase)
        answer = wave / stiffness
        C2 = twist - steady / (nu * nu) - answer.real
        pairs.append((float((rate - (TWO_PI * 1j * answer).real + Pi * C2) / nu1), float(C2)))
    return pairs


class FreeOscillation(NamedTuple):
    """What of a'' swings freely in phase II or IV, where a'' of the driving wheel is zero; without unit.

    Attributes:
        amplitude: at the beginning of the phase, of the envelope A exp(-Pi kappa), or, where nothing
            oscillates (Pi >= nu), of a'' itself.
        peak: largest |a''| in the phase.
    """

    amplitude: float
    peak: float


def free_oscillation(criteria: Criteria, kappa2: float, beta: float = 1.0, phase: int = 1) -> FreeOscillation:
    """The free oscillation in phase II (1) or IV (3).

    Raises:
        ValueError: another phase, phase II without length, or resonance without friction.
    """
    length = {1: kappa2, 3: WATCHED}.get(phase, 0.0)
    if length <= 0.0:
        raise ValueError(f"phase must be 1 (with kappa2 above 0) or 3, is {phase} with kappa2 = {kappa2}")
    kappa = phase_starts(kappa2)[phase] + np.linspace(0.0, length, 20001)
    swing = np.abs(response(kappa, criteria, kappa2, beta).acceleration)
    amplitude = swing[0]
    if criteria.Pi < criteria.nu:
        # differentiating exp(lambda kappa) twice multiplies its amplitude by |lambda|^2 = nu^2
        amplitude = criteria.nu**2 * np.hypot(*constants(criteria, kappa2, beta)[phase])
    return FreeOscillation(float(amplitude), float(swing.max()))
