"""Equations (1) to (24) as the page has them, errors kept: for comparison only, use exact for numbers.

The paper writes R for R0 and uses phi and alpha for one angle, that of wheel 1 on the carrier: (1) and (2)
with phi, the rest with alpha. omega is its rate. Every function takes what its equation takes, so that it
can be judged alone; ``printed`` feeds each with the printed results before it.

Angles in rad, lengths in m, speeds in rad/s and m/s, forces in N, moments in N m, powers in W, inertias in
kg m^2, energies in J; numbers or arrays of shape (n,).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from . import exact
from .mechanism import Mechanism

# a number or an array of shape (n,)
Value = Any


def _arcsin(sine: Value) -> Value:
    # rounding alone can carry a sine past one: |D sin alpha| <= rho always
    return np.arcsin(np.clip(sine, -1.0, 1.0))


def epicycloid(m: Mechanism, phi: Value) -> tuple[Value, Value]:
    """Equation (1): X, Y of the imbalance."""
    return exact.epicycloid(m, phi)


def rho(m: Mechanism, phi: Value) -> Value:
    """Equation (2): distance of the imbalance from O."""
    D = m.centre_distance
    # rounding alone can make the square negative
    return np.sqrt(np.maximum(D**2 + m.arm**2 - 2.0 * D * m.arm * np.cos(phi), 0.0))


def phi_of_note(m: Mechanism, alpha: Value) -> Value:
    """The note under (2), phi = b alpha; it contradicts (1), (2) and (8) and is used nowhere here."""
    return m.b * alpha


def relative_force(m: Mechanism, omega: Value) -> Value:
    """Equation (3): force of inertia F1 from the turning about O1."""
    return exact.relative_force(m, omega)


def carrier_force(m: Mechanism, omega: Value, rho: Value) -> Value:
    """Equation (4): force of inertia F2 from the turning about O."""
    return m.m * rho * m.b**2 * omega**2


def coriolis_force(m: Mechanism, omega: Value, V: Value) -> Value:
    """Equation (5): Coriolis force Fk with the speed V of the imbalance."""
    return 2.0 * m.m * V * m.b * omega


def resultant_speed(V1: Value, V2: Value, beta: Value) -> Value:
    """Equation (6): resultant of two speeds that make the angle pi - beta."""
    return np.sqrt(V1**2 + V2**2 - 2.0 * V1 * V2 * np.cos(beta))


def speed(m: Mechanism, omega: Value, rho: Value, beta1: Value) -> Value:
    """Equation (7): speed V of the imbalance."""
    reach = rho * m.b
    return omega * np.sqrt(m.arm**2 + reach**2 + 2.0 * m.arm * reach * np.cos(beta1))


def beta1(m: Mechanism, alpha: Value, rho: Value) -> Value:
    """Equation (8): angle at the imbalance by arcsin, never beyond pi/2.

    Raises:
        ValueError: rho = 0 somewhere: l = R0 + r, and the imbalance at O.
    """
    if not np.all(rho > 0.0):
        raise ValueError(f"arm must not be R0 + r, is {m.arm}: (8) divides by rho, which is 0 then")
    return _arcsin(m.centre_distance * np.sin(alpha) / rho)


def wheel_moment_of_forces(F2: Value, n2: Value, Fk: Value, k1: Value) -> Value:
    """Equation (9): moment M1 about O1 from forces and arms."""
    return F2 * n2 + Fk * k1


def carrier_moment_of_forces(F1: Value, n1: Value, F2: Value, n2: Value, Fk: Value, k2: Value) -> Value:
    """Equation (10): moment M about O from forces and arms."""
    return -F1 * n1 - F2 * n2 - Fk * k2


def n1(m: Mechanism, alpha: Value) -> Value:
    """Equation (11): arm of F1 about O."""
    return m.centre_distance * np.sin(alpha)


def n2(m: Mechanism, alpha: Value, rho: Value) -> Value:
    """Equation (12): arm of F2 about O1, in (10) about O as well."""
    return m.centre_distance * m.arm * np.sin(alpha) / rho


def delta(m: Mechanism, alpha: Value, rho: Value, beta1: Value) -> Value:
    """The angle of (13), between V and V2 by arcsin."""
    return _arcsin(m.arm * m.centre_distance * np.sin(alpha) / (rho * speed(m, 1.0, rho, beta1)))


def k1(m: Mechanism, beta1: Value, delta: Value) -> Value:
    """Equation (13): arm of the Coriolis force about O1."""
    return m.arm * np.sin(beta1 - delta)


def k2(m: Mechanism, alpha: Value, beta1: Value, delta: Value) -> Value:
    """Equation (14): arm of the Coriolis force about O."""
    return m.centre_distance * np.sin(alpha + beta1 - delta)


def wheel_moment(m: Mechanism, alpha: Value, omega: Value, rho: Value, beta1: Value, delta: Value) -> Value:
    """Equation (15): moment M1 about O1 on wheel 1."""
    bracket = m.b * m.centre_distance * np.sin(alpha)
    bracket = bracket + 2.0 * speed(m, 1.0, rho, beta1) * np.sin(beta1 - delta)
    return m.m * m.b * m.arm * omega**2 * bracket


def carrier_moment(m: Mechanism, alpha: Value, omega: Value, rho: Value, beta1: Value, delta: Value) -> Value:
    """Equation (16): moment M about O on the carrier."""
    bracket = m.arm * (1.0 + m.b**2) * np.sin(alpha)
    bracket = bracket + 2.0 * m.b * speed(m, 1.0, rho, beta1) * np.sin(alpha + beta1 - delta)
    return -m.m * m.centre_distance * omega**2 * bracket


def wheel_power(omega: Value, M1: Value) -> Value:
    """Equation (17): power N1 on wheel 1."""
    return M1 * omega


def carrier_power(m: Mechanism, omega: Value, M: Value) -> Value:
    """Equation (18): power N on the carrier."""
    return M * m.b * omega


def moment_of_inertia(m: Mechanism, rho: Value) -> Value:
    """Equation (19): moment of inertia J about O."""
    return m.constant_inertia + m.m * rho**2


def inertia_limits(m: Mechanism) -> tuple[float, float]:
    """Equation (20): J_max and J_min."""
    D = m.centre_distance
    return m.constant_inertia + m.m * (D + m.arm) ** 2, m.constant_inertia + m.m * (D - m.arm) ** 2


def omega_max(m: Mechanism, omega_min: float) -> float:
    """Equation (21): highest from lowest speed by conservation of angular momentum."""
    largest, smallest = inertia_limits(m)
    return omega_min * largest / smallest


def energy_farthest(m: Mechanism, omega_min: float) -> float:
    """Equation (22): kinetic energy T1 at the largest rho."""
    return 0.5 * inertia_limits(m)[0] * omega_min**2


def energy_nearest(m: Mechanism, omega_max: float) -> float:
    """Equation (23): kinetic energy T2 at the smallest rho."""
    return 0.5 * inertia_limits(m)[1] * omega_max**2


def energy_nearest_of_farthest(m: Mechanism, T1: float) -> float:
    """Equation (24): T2 from T1."""
    largest, smallest = inertia_limits(m)
    return T1 * largest / smallest


class Printed(NamedTuple):
    """What the page makes of an angle and a speed, each equation fed with the printed ones before it."""

    rho: Value
    beta1: Value
    V: Value
    F1: Value
    F2: Value
    Fk: Value
    delta: Value
    n1: Value
    n2: Value
    k1: Value
    k2: Value
    M1: Value
    M: Value
    N1: Value
    N: Value


def printed(m: Mechanism, alpha: Value, omega: Value) -> Printed:
    """Equations (2) to (18) in a row.

    Raises:
        ValueError: see beta1.
    """
    distance = rho(m, alpha)
    angle = beta1(m, alpha, distance)
    V = speed(m, omega, distance, angle)
    turned = delta(m, alpha, distance, angle)
    M1 = wheel_moment(m, alpha, omega, distance, angle, turned)
    M = carrier_moment(m, alpha, omega, distance, angle, turned)
    return Printed(
        rho=distance,
        beta1=angle,
        V=V,
        F1=relative_force(m, omega),
        F2=carrier_force(m, omega, distance),
        Fk=coriolis_force(m, omega, V),
        delta=turned,
        n1=n1(m, alpha),
        n2=n2(m, alpha, distance),
        k1=k1(m, angle, turned),
        k2=k2(m, alpha, angle, turned),
        M1=M1,
        M=M,
        N1=wheel_power(omega, M1),
        N=carrier_power(m, omega, M),
    )
