"""The exact forms, for a steady omega but where told, in SI units and in the shape of alpha.

Places and forces are complex numbers in the frame that turns with the carrier, O to O1 its real axis. The
imbalance S is at O1 - l exp(i alpha), so nearest to O at alpha = 0. Inertia forces, with e from O1 to S:

    F1 = m l omega^2 e,  F2 = m b^2 omega^2 OS,  Fk = 2 m b omega (l omega) e,  sum = -m a

Fk takes the speed l omega relative to the carrier, and as the carrier turns in the same sense it lies
along e, in line with F1. Moments are positive in the sense of omega.

With wheel 2 held one angle describes the mechanism: its energy is J_red(alpha) theta'^2 / 2, theta = b alpha
the angle of the carrier. The held wheel takes torque, so angular momentum about O is not conserved; left
alone, the mechanism keeps its energy.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..forms import Forms, Formulas
from .mechanism import Mechanism


def inputs(m: Mechanism, alpha: Any, omega: Any) -> dict[str, Any]:
    """What both tables of formulas take, by the symbols of the paper; links: their constant inertia."""
    known = {"m": m.m, "D": m.centre_distance, "l": m.arm, "b": m.b, "links": m.constant_inertia}
    return known | {"mechanism": m, "alpha": alpha, "omega": omega}


def exact(m: Mechanism, alpha: Any, omega: Any = 1.0, omega_rate: Any = 0.0) -> Forms:
    """The exact forms at angles of wheel 1 on the carrier, rad, its speed and acceleration, rad/s, rad/s^2.

    Args:
        m: dimensions. alpha, omega, omega_rate: numbers or of shape (n,).
    """
    return Forms(EXACT, **inputs(m, alpha, omega), omega_rate=omega_rate)


def distance_above_0(e: Any) -> Any:
    """The distance rho of the imbalance from O, m, as a divisor.

    Raises:
        ValueError: it is 0 somewhere.
    """
    if not np.all(e.rho > 0.0):
        raise ValueError(f"arm must not be R0 + r where the imbalance passes through O, is {e.l}")
    return e.rho


def reduced_inertia(m: Mechanism, alpha: Any) -> Any:
    """J_carrier + J_wheel ((1 + b)/b)^2 + m |dS/dtheta|^2, reduced to the carrier, kg m^2: for (19)."""
    ratio, turns = m.arm / m.r, m.centre_distance / m.r
    swing = (1.0 - ratio) ** 2 + 4.0 * ratio * np.sin(0.5 * np.asarray(alpha)) ** 2
    return m.J_carrier + m.J_wheel * turns**2 + m.m * m.centre_distance**2 * swing


def reduced_inertia_limits(m: Mechanism) -> tuple[float, float]:
    """Largest (alpha = pi) and smallest (alpha = 0) reduced inertia, kg m^2, for (20)."""
    return float(reduced_inertia(m, np.pi)), float(reduced_inertia(m, 0.0))


def speed_ratio(m: Mechanism) -> float:
    """omega_max / omega_min of the free, undriven mechanism, sqrt(J_red,max / J_red,min): corrects (21).

    Raises:
        ValueError: J_red,min = 0 (l = r and links without inertia), where the speed has no bound.
    """
    largest, smallest = reduced_inertia_limits(m)
    if smallest == 0.0:
        raise ValueError("arm must not be r without inertia of the links: the speed at the cusp has no bound")
    return float(np.sqrt(largest / smallest))


def _turned(e: Any) -> tuple[Any, Any]:
    place = e.place * np.exp(1j * e.b * e.alpha)
    return place.real, place.imag


def _moment(place: Any, force: Any) -> Any:
    return (np.conj(place) * force).imag


def _angular_momentum(e: Any) -> Any:
    m = e.mechanism
    return (
        m.J_carrier * e.b * e.omega + m.J_wheel * (1.0 + e.b) * e.omega + e.m * _moment(e.place, e.velocity)
    )


EXACT: Formulas = {
    # O1 to the imbalance, O to it, its velocity, and the inertia force -m a
    "spoke": lambda e: -e.l * np.exp(1j * np.asarray(e.alpha)),
    "place": lambda e: e.D + e.spoke,
    "velocity": lambda e: 1j * e.omega * (e.b * e.D + (1.0 + e.b) * e.spoke),
    "force": lambda e: e.m * e.omega**2 * (e.b**2 * e.D + (1.0 + e.b) ** 2 * e.spoke),
    # (1) in the fixed frame, (2)
    "epicycloid": _turned,
    "rho": lambda e: np.abs(e.place),
    "rho_of_note": lambda e: e.rho,
    # (3), on the circle about O1; (4); (5) put right, the same at every angle
    "F1": lambda e: e.m * e.omega**2 * np.abs(e.spoke),
    "F2": lambda e: e.m * e.rho * (e.b * e.omega) ** 2,
    "Fk": lambda e: 2.0 * e.m * e.b * e.omega * (e.l * e.omega),
    # (6), (7)
    "resultant": lambda e: e.V,
    "V": lambda e: np.abs(e.velocity),
    "root": lambda e: e.V / e.omega,
    # (8), from O1 S to O S, and the angle of (13), from V to b omega OS, put right: -pi to pi
    "beta1": lambda e: np.angle(e.place / e.spoke),
    "delta": lambda e: np.angle(1j * e.place * np.conj(e.velocity)),
    # (9), (10) and the arms of (11) to (14): the Coriolis force is in line with F1
    "M1_of_forces": lambda e: e.M1,
    "M_of_forces": lambda e: e.M,
    "n1": lambda e: -_moment(e.D, e.spoke) / e.l,
    "n2": lambda e: _moment(e.spoke, e.place) / distance_above_0(e),
    "k1": lambda e: 0.0 * e.alpha,
    "k2": lambda e: e.n1,
    # (15), on wheel 1 about O1, m b^2 omega^2 l D sin alpha: F1 and Fk pass through O1
    "M1": lambda e: _moment(e.spoke, e.force),
    # (16), about O, -m D (1 + 2 b) l omega^2 sin alpha: what drive and held wheel have to balance
    "M": lambda e: _moment(e.place, e.force),
    # (17), (18): together all the inertia forces do, at constant speed minus the power of the drive
    "N1": lambda e: e.M1 * e.omega,
    "N": lambda e: e.M * e.b * e.omega,
    # (19), (20)
    "J": lambda e: e.links + e.m * e.rho**2,
    "J_limits": lambda e: exact(e.mechanism, np.array([np.pi, 0.0])).J,
    # (21) to (24), omega the lowest speed and, in the energies, that of the carrier
    "omega_max": lambda e: e.omega * speed_ratio(e.mechanism),
    "T1": lambda e: 0.5 * reduced_inertia_limits(e.mechanism)[0] * e.omega**2,
    "T2": lambda e: 0.5 * reduced_inertia_limits(e.mechanism)[1] * e.omega_max**2,
    "T2_of_T1": lambda e: e.T1,
    # of all links
    "reduced_inertia": lambda e: reduced_inertia(e.mechanism, e.alpha),
    "kinetic_energy": lambda e: 0.5 * e.reduced_inertia * (e.b * e.omega) ** 2,
    "angular_momentum": _angular_momentum,
    # at the carrier by Lagrange, J_red theta'' + J_red' theta'^2 / 2; steadily -(M + M1/b), and its power
    "drive_torque": lambda e: (
        e.reduced_inertia * e.b * e.omega_rate
        + e.m * e.D**2 * e.l / e.mechanism.r * e.b * np.sin(e.alpha) * e.omega**2
    ),
    "drive_power": lambda e: e.drive_torque * e.b * e.omega,
    # of wheel 1 on the carrier in free motion, omega being that at alpha = pi
    "free_speed": lambda e: e.omega_max * np.sqrt(reduced_inertia_limits(e.mechanism)[1] / e.reduced_inertia),
}
