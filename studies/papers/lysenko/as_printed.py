"""Equations (1) to (24) as the page has them, errors kept: for comparison only, use exact for numbers.

The paper writes R for R0 and uses phi and alpha for one angle, that of wheel 1 on the carrier: (1) and (2)
with phi, the rest with alpha. omega is its rate; for (21) to (24) the lowest one. Results in SI units, in
the shape of alpha.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..forms import Forms, Formulas
from .exact import distance_above_0, inputs
from .mechanism import Mechanism


def printed(m: Mechanism, alpha: Any, omega: Any, **given: Any) -> Forms:
    """What the page makes of dimensions, angle (rad) and speed (rad/s), its equations in a row.

    Args:
        m: dimensions. alpha, omega: numbers or of shape (n,). given: quantities in place of the printed.
    """
    return Forms(PRINTED, **inputs(m, alpha, omega) | given)


def _arcsin(sine: Any) -> Any:
    # rounding alone can carry a sine past one: |D sin alpha| <= rho always
    return np.arcsin(np.clip(sine, -1.0, 1.0))


def _epicycloid(e: Any) -> Any:
    carrier, wheel = e.b * e.alpha, (1.0 + e.b) * e.alpha
    return e.D * np.cos(carrier) - e.l * np.cos(wheel), e.D * np.sin(carrier) - e.l * np.sin(wheel)


def _distance(e: Any, phi: Any) -> Any:
    # rounding alone can make the square negative
    return np.sqrt(np.maximum(e.D**2 + e.l**2 - 2.0 * e.D * e.l * np.cos(phi), 0.0))


def _resultant(e: Any) -> Any:
    one, two = e.l * e.omega, e.rho * e.b * e.omega
    return np.sqrt(one**2 + two**2 - 2.0 * one * two * np.cos(np.pi - e.beta1))


def _carrier_moment(e: Any) -> Any:
    turned = np.sin(e.alpha + e.beta1 - e.delta)
    bracket = e.l * (1.0 + e.b**2) * np.sin(e.alpha) + 2.0 * e.b * e.root * turned
    return -e.m * e.D * e.omega**2 * bracket


PRINTED: Formulas = {
    # (1), (2), and (2) with the note under it, which is used nowhere else
    "epicycloid": _epicycloid,
    "rho": lambda e: _distance(e, e.alpha),
    "rho_of_note": lambda e: _distance(e, e.b * e.alpha),
    # (3) to (5): forces of inertia
    "F1": lambda e: e.m * e.l * e.omega**2,
    "F2": lambda e: e.m * e.rho * e.b**2 * e.omega**2,
    "Fk": lambda e: 2.0 * e.m * e.V * e.b * e.omega,
    # (6), (7): speed; the root of (7) is V / omega
    "resultant": _resultant,
    "root": lambda e: np.sqrt(e.l**2 + (e.rho * e.b) ** 2 + 2.0 * e.l * e.rho * e.b * np.cos(e.beta1)),
    "V": lambda e: e.omega * e.root,
    # (8): never beyond pi/2
    "beta1": lambda e: _arcsin(e.D * np.sin(e.alpha) / distance_above_0(e)),
    # (9), (10): moments of the forces by their arms (11) to (14); in (13) an angle as well
    "M1_of_forces": lambda e: e.F2 * e.n2 + e.Fk * e.k1,
    "M_of_forces": lambda e: -e.F1 * e.n1 - e.F2 * e.n2 - e.Fk * e.k2,
    "n1": lambda e: e.D * np.sin(e.alpha),
    "n2": lambda e: e.D * e.l * np.sin(e.alpha) / distance_above_0(e),
    "k1": lambda e: e.l * np.sin(e.beta1 - e.delta),
    "delta": lambda e: _arcsin(e.l * e.D * np.sin(e.alpha) / (e.rho * e.root)),
    "k2": lambda e: e.D * np.sin(e.alpha + e.beta1 - e.delta),
    # (15) to (18): moments and powers
    "M1": lambda e: (
        e.m
        * e.b
        * e.l
        * e.omega**2
        * (e.b * e.D * np.sin(e.alpha) + 2.0 * e.root * np.sin(e.beta1 - e.delta))
    ),
    "M": _carrier_moment,
    "N1": lambda e: e.M1 * e.omega,
    "N": lambda e: e.M * e.b * e.omega,
    # (19) to (24): inertias, speeds and energies farthest from O and nearest to it
    "J": lambda e: e.links + e.m * e.rho**2,
    "J_limits": lambda e: e.links + e.m * (e.D + e.l * np.array([1.0, -1.0])) ** 2,
    "omega_max": lambda e: e.omega * e.J_limits[0] / e.J_limits[1],
    "T1": lambda e: 0.5 * e.J_limits[0] * e.omega**2,
    "T2": lambda e: 0.5 * e.J_limits[1] * e.omega_max**2,
    "T2_of_T1": lambda e: e.T1 * e.J_limits[0] / e.J_limits[1],
}
