"""The added-mass limit: how a coupling answers a change of speed, from theory.

Let the module be the interface inertia Phi, r = Phi/J_E, u_n the change of the engine's speed over step n and
m_n that of the module's, the jump at the beginning of the step included. The step mean holds all impulses, so
h T_n = Phi m_n: **the step cancels out**, and what passes is an exchange of momentum,

    (1 + rho) u_n = (rho - r) m_(n-1)  for an engine that knows the torque of the step before
    (1 + rho) u_n = (rho - r) m_n      for an engine that steps after the module

with rho the interface inertia the engine reckons with, over J_E (0 without that correction). With what the
module is given of the speed,

    held, engine first          m_n = u_n            ramp, engine first     m_n = u_n
    held, beside or before      m_n = u_(n-1)        ramp, extrapolated     m_n = 2 u_(n-1) - u_(n-2)
    average                     m_n = (u_n + u_(n-1))/2

each scheme has a characteristic polynomial. Its largest root is the growth of a disturbance in a step of any
length: shorter steps do not help. Instantaneous torque of a held speed does not contain the jump at all:
nothing is amplified, and the engine never feels the inertia of the module. With a ramp the instantaneous
torque is Phi times the rate given.
"""

from __future__ import annotations

import math

import numpy as np

from .schemes import AVERAGE, ENGINE_FIRST, HELD, IMPLICIT, INSTANTANEOUS, MODULE_FIRST, Scheme

_GREATEST_RATIO = 1e6
_BISECTIONS = 60


def _module_change(scheme: Scheme) -> tuple[float, ...]:
    """Coefficients of u_n, u_(n-1), u_(n-2) in m_n, or in the change whose torque is felt at an instant."""
    if scheme.order == ENGINE_FIRST:
        return (0.5, 0.5) if scheme.speed == AVERAGE else (1.0,)
    if scheme.torque == INSTANTANEOUS:
        # at the end of a ramp; after the module, the mean of the torques at both ends
        return (0.0, 0.5, 0.5) if scheme.order == MODULE_FIRST else (0.0, 1.0)
    return (0.0, 1.0) if scheme.speed == HELD else (0.0, 2.0, -1.0)


def characteristic(scheme: Scheme, ratio: float, assumed: float = 0.0) -> tuple[float, ...]:
    """Coefficients of the characteristic polynomial, highest power first.

    Args:
        scheme: of coupling. ratio: Phi/J_E. assumed: rho, the interface inertia reckoned with over J_E.
    """
    if scheme.correction == IMPLICIT or (scheme.torque == INSTANTANEOUS and scheme.speed == HELD):
        return (1.0, 0.0)
    change = _module_change(scheme)
    late = 0 if scheme.order == MODULE_FIRST else 1
    terms = [0.0] * late + [(ratio - assumed) * factor for factor in change]
    terms[0] += 1.0 + assumed
    return tuple(terms)


def amplification(scheme: Scheme, ratio: float, assumed: float = 0.0) -> float:
    """Growth of a disturbance of the speed in one communication step (arguments of characteristic)."""
    roots = np.roots(characteristic(scheme, ratio, assumed))
    return float(np.abs(roots).max()) if roots.size else 0.0


def inertia_limit(scheme: Scheme, share: float = 0.0) -> float:
    """Greatest Phi/J_E that is stable; infinite where there is none.

    Args:
        scheme: of coupling. share: of Phi that the engine reckons with (correction inertia).
    """
    if amplification(scheme, _GREATEST_RATIO, share * _GREATEST_RATIO) < 1.0 + 1e-9:
        return math.inf
    low, high = 0.0, _GREATEST_RATIO
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if amplification(scheme, middle, share * middle) < 1.0:
            low = middle
        else:
            high = middle
    return low
