"""Equations (1) to (24) as the page has them, errors kept: for comparison only, use exact for numbers.

The paper writes R for R0 and uses phi and alpha for one angle, that of wheel 1 on the carrier: (1) and (2)
with phi, the rest with alpha. omega is its rate.
"""

# symbols of the page
# ruff: noqa: N802

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from .mechanism import Mechanism

# a number or an array of shape (n,)
Value = Any


def _arcsin(sine: Value) -> Value:
    # rounding alone can carry a sine past one: |D sin alpha| <= rho always
    return np.arcsin(np.clip(sine, -1.0, 1.0))


class Printed:
    """What the page makes of an angle and a speed: each equation is fed with the printed ones before it.

    Args:
        m: dimensions. alpha: rad, a number or of shape (n,), as the results. omega: rad/s; for (21) to
            (24) the lowest speed.
        given: quantities by name that stand in place of the printed ones, to judge an equation alone.

    Results in m, rad, N, N m, W, m/s, kg m^2 and J.
    """

    def __init__(self, m: Mechanism, alpha: Value, omega: Value, **given: Value) -> None:
        self.m, self.alpha, self.omega = m, alpha, omega
        self.D, self.sine = m.centre_distance, np.sin(alpha)
        # a cached property looks here first
        self.__dict__.update(given)

    @cached_property
    def epicycloid(self) -> tuple[Value, Value]:
        """Equation (1): X, Y of the imbalance."""
        carrier, wheel = self.m.b * self.alpha, (1.0 + self.m.b) * self.alpha
        x = self.D * np.cos(carrier) - self.m.arm * np.cos(wheel)
        return x, self.D * np.sin(carrier) - self.m.arm * np.sin(wheel)

    @cached_property
    def rho(self) -> Value:
        """Equation (2): distance of the imbalance from O."""
        square = self.D**2 + self.m.arm**2 - 2.0 * self.D * self.m.arm * np.cos(self.alpha)
        # rounding alone can make the square negative
        return np.sqrt(np.maximum(square, 0.0))

    @cached_property
    def rho_of_note(self) -> Value:
        """Equation (2) with the note under it, phi = b alpha, which is used nowhere else here."""
        return Printed(self.m, self.m.b * self.alpha, self.omega).rho

    @cached_property
    def F1(self) -> Value:
        """Equation (3): force of inertia from the turning about O1."""
        return self.m.m * self.m.arm * self.omega**2

    @cached_property
    def F2(self) -> Value:
        """Equation (4): force of inertia from the turning about O."""
        return self.m.m * self.rho * self.m.b**2 * self.omega**2

    @cached_property
    def Fk(self) -> Value:
        """Equation (5): Coriolis force with the speed V of the imbalance."""
        return 2.0 * self.m.m * self.V * self.m.b * self.omega

    @cached_property
    def resultant(self) -> Value:
        """Equation (6): resultant of the speeds V1 and V2, at the angle pi - beta."""
        one, two = self.m.arm * self.omega, self.rho * self.m.b * self.omega
        return np.sqrt(one**2 + two**2 - 2.0 * one * two * np.cos(np.pi - self.beta1))

    @cached_property
    def root(self) -> Value:
        """The root of (7), V / omega."""
        arm, reach = self.m.arm, self.rho * self.m.b
        return np.sqrt(arm**2 + reach**2 + 2.0 * arm * reach * np.cos(self.beta1))

    @cached_property
    def V(self) -> Value:
        """Equation (7): speed of the imbalance."""
        return self.omega * self.root

    @cached_property
    def beta1(self) -> Value:
        """Equation (8): angle at the imbalance by arcsin, never beyond pi/2.

        Raises:
            ValueError: rho = 0 somewhere: l = R0 + r, and the imbalance at O.
        """
        if not np.all(self.rho > 0.0):
            raise ValueError(f"arm must not be R0 + r, is {self.m.arm}: (8) divides by rho, which is 0 then")
        return _arcsin(self.D * self.sine / self.rho)

    @cached_property
    def M1_of_forces(self) -> Value:
        """Equation (9): moment about O1 from forces and arms."""
        return self.F2 * self.n2 + self.Fk * self.k1

    @cached_property
    def M_of_forces(self) -> Value:
        """Equation (10): moment about O from forces and arms."""
        return -self.F1 * self.n1 - self.F2 * self.n2 - self.Fk * self.k2

    @cached_property
    def n1(self) -> Value:
        """Equation (11): arm of F1 about O."""
        return self.D * self.sine

    @cached_property
    def n2(self) -> Value:
        """Equation (12): arm of F2 about O1, in (10) about O as well."""
        return self.D * self.m.arm * self.sine / self.rho

    @cached_property
    def delta(self) -> Value:
        """The angle of (13), between V and V2 by arcsin."""
        return _arcsin(self.m.arm * self.D * self.sine / (self.rho * self.root))

    @cached_property
    def k1(self) -> Value:
        """Equation (13): arm of the Coriolis force about O1."""
        return self.m.arm * np.sin(self.beta1 - self.delta)

    @cached_property
    def k2(self) -> Value:
        """Equation (14): arm of the Coriolis force about O."""
        return self.D * np.sin(self.alpha + self.beta1 - self.delta)

    @cached_property
    def M1(self) -> Value:
        """Equation (15): moment about O1 on wheel 1."""
        bracket = self.m.b * self.D * self.sine + 2.0 * self.root * np.sin(self.beta1 - self.delta)
        return self.m.m * self.m.b * self.m.arm * self.omega**2 * bracket

    @cached_property
    def M(self) -> Value:
        """Equation (16): moment about O on the carrier."""
        turned = np.sin(self.alpha + self.beta1 - self.delta)
        bracket = self.m.arm * (1.0 + self.m.b**2) * self.sine + 2.0 * self.m.b * self.root * turned
        return -self.m.m * self.D * self.omega**2 * bracket

    @cached_property
    def N1(self) -> Value:
        """Equation (17): power on wheel 1."""
        return self.M1 * self.omega

    @cached_property
    def N(self) -> Value:
        """Equation (18): power on the carrier."""
        return self.M * self.m.b * self.omega

    @cached_property
    def J(self) -> Value:
        """Equation (19): moment of inertia about O."""
        return self.m.constant_inertia + self.m.m * self.rho**2

    @cached_property
    def J_limits(self) -> Any:
        """Equation (20): J_max and J_min, shape (2,)."""
        return self.m.constant_inertia + self.m.m * (self.D + self.m.arm * np.array([1.0, -1.0])) ** 2

    @cached_property
    def omega_max(self) -> Value:
        """Equation (21): highest from lowest speed by conservation of angular momentum."""
        return self.omega * self.J_limits[0] / self.J_limits[1]

    @cached_property
    def T1(self) -> Value:
        """Equation (22): kinetic energy at the largest rho."""
        return 0.5 * self.J_limits[0] * self.omega**2

    @cached_property
    def T2(self) -> Value:
        """Equation (23): kinetic energy at the smallest rho."""
        return 0.5 * self.J_limits[1] * self.omega_max**2

    @cached_property
    def T2_of_T1(self) -> Value:
        """Equation (24): T2 from T1."""
        return self.T1 * self.J_limits[0] / self.J_limits[1]
