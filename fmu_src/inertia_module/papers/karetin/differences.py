"""Worst difference over a period of each printed equation (1)-(18) from the exact, fed with exact values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import as_printed, exact
from .cases import DYNAMIC, GENERAL, STOP, Case, over_period
from .motion import transmission_ratios
from .series import Series

Array = NDArray[np.float64]

G = GENERAL


def worst(printed: Sequence[Any] | Array, right: Sequence[Any] | Array) -> float:
    """Largest length of the difference over the times, relative to the largest length of the exact.

    Args:
        printed, right: components, each a number or of shape (n,).
    """
    pairs = zip(printed, right, strict=True)
    difference = np.sqrt(sum(np.square(np.asarray(p) - e) for p, e in pairs))
    largest = np.sqrt(sum(np.square(np.asarray(e)) for e in right)).max()
    return float(np.max(difference) / largest)


def shown(difference: float) -> str:
    """A relative difference in words: rounding differs from machine to machine and is not spelt out."""
    return "rounding" if difference < 1e-12 else f"{difference:.1g}"


def _stop() -> Case:
    return over_period(GENERAL, STOP)


def _series(case: Case) -> tuple[Series, Series, Series]:
    """Exact position as series: with them the printed rates are those of exact arguments."""
    k = case.k
    x, y, z = (Series([k.position[:, n], k.velocity[:, n], 0.5 * k.acceleration[:, n]]) for n in range(3))
    return x, y, z


def _factors() -> as_printed.Factors:
    return as_printed.factors(G.wheel_radius, G.phi, G.psi, G.chi, G.a, G.b, G.c)


def _mu(case: Case) -> Any:
    A = exact.centre_of_satellite(case.at)
    return as_printed.coefficient_mu(case.at.omega6, exact.modulus(A), A[:, 2], G.OQ)


def ratios() -> float:
    """Of (1)."""
    printed = as_printed.transmission_ratios(100.0, 2.0, G.z2, G.z16, G.z17, G.z6)
    return worst(printed, transmission_ratios(G, DYNAMIC))


def position() -> float:
    """Of (2)."""
    case = _stop()
    _, omega16, omega6 = transmission_ratios(G, STOP)
    t = case.t
    printed = as_printed.position(_factors(), omega16 * t, omega6 * t, G.epsilon, G.gamma)
    return worst(printed, case.k.position.T)


def radius() -> float:
    """Of (3)."""
    k = _stop().k
    return worst([as_printed.radius(*k.position.T)], [k.radius])


def projections() -> float:
    """Of (4)."""
    k = _stop().k
    return worst(as_printed.projections(*k.position.T), k.projections.T)


def angles() -> float:
    """Of (5)."""
    k = _stop().k
    x, y, _ = k.position.T
    _, OP, OF = k.projections.T
    return worst(as_printed.angles(x, y, OP, OF), k.angles.T)


def angular_velocities() -> float:
    """Of (6) with the angles (5)."""
    case = _stop()
    x, y, z = _series(case)
    _, OP, OF = as_printed.projections(x, y, z)
    rates = as_printed.angular_velocities(*as_printed.angles(x, y, OP, OF))
    return worst([rate.value for rate in rates], case.k.angular_velocities.T)


def sum_in_link1() -> float:
    """Of (7) and (17)."""
    k = _stop().k
    printed = as_printed.sum_of_velocities(tuple(k.about_satellite.T), tuple(k.about_drive.T))
    return worst(printed, k.velocity.T)


def arm_of_imbalance() -> float:
    """Of (8)."""
    case = _stop()
    A = exact.centre_of_satellite(case.at)
    printed = as_printed.arm_of_imbalance(tuple(case.k.position.T), tuple(A.T))
    return worst(printed, exact.arm_of_imbalance(case.at).T)


def spin_of_satellite() -> float:
    """Of (9) with the coefficient (10)."""
    case = _stop()
    printed = as_printed.spin_of_satellite(_mu(case), tuple(exact.centre_of_satellite(case.at).T))
    return worst(printed, exact.spin_of_satellite(case.at).T)


def coefficient_mu() -> float:
    """Of (10)."""
    case = _stop()
    return worst([_mu(case)], [case.at.omega6 / G.QA])


def velocity_about_satellite() -> float:
    """Of (11)."""
    case = _stop()
    A, AD = exact.centre_of_satellite(case.at), exact.arm_of_imbalance(case.at)
    printed = as_printed.velocity_about_satellite(_mu(case), tuple(AD.T), tuple(A.T), G.OQ)
    return worst(printed, case.k.about_satellite.T)


def speed_about_satellite() -> float:
    """Of (12)."""
    k = _stop().k
    return worst([as_printed.modulus(tuple(k.about_satellite.T))], [k.speed_about_satellite])


def spin_of_drive() -> float:
    """Of (13)."""
    case = _stop()
    lam = as_printed.coefficient_lambda(case.k.angular_velocities[:, 0], G.OQ)
    return worst(as_printed.spin_of_drive(lam, G.OQ), (0.0, 0.0, case.at.omega16))


def coefficient_lambda() -> float:
    """Of (14)."""
    case = _stop()
    printed = as_printed.coefficient_lambda(case.k.angular_velocities[:, 0], G.OQ)
    return worst([printed], [case.at.omega16 / G.OQ])


def velocity_about_drive() -> float:
    """Of (15), with the exact coefficient omega16/OQ."""
    case = _stop()
    lam = np.full_like(case.t, case.at.omega16 / G.OQ)
    printed = as_printed.velocity_about_drive(lam, tuple(case.k.position.T), G.OQ)
    return worst(printed, case.k.about_drive.T)


def speed_about_drive() -> float:
    """Of (16)."""
    k = _stop().k
    return worst([as_printed.modulus_about_drive(tuple(k.about_drive.T))], [k.speed_about_drive])


def speed_in_link1() -> float:
    """Of (18)."""
    k = _stop().k
    return worst([as_printed.modulus(tuple(k.velocity_in_link1.T))], [k.speed])
