"""The independent reference: Lagrange's equations, rigid or elastic, by SciPy from event to event.

Nothing of the kernel is used. Links 1 and 2 have the energy 1/2 w' M(q) w of w = (omega1, omega2), with
q' = k (omega1 - omega2), I, B, G of geometry.py and M' = dM/dq; J3 and J4 turn behind the output freewheel:

    M11 = J1 + I + 2 k B + k^2 G    M12 = -k (B + k G)    M22 = J2 + k^2 G
    M alpha + M' q' w - 1/2 (w' M' w) (k, -k) = (M1 - b1 omega1 - k bq q', Th - Tc - b2 omega2 + k bq q')
    J3 alpha3 = Tc - T - b3 omega3
    J4 (alpha4 - beta alpha3) = T - f omega4 - load    T = c twist + d (omega3 - omega4)

A rigid output has no J4 and T = load. Of M1 and omega1 one is given. 0 <= omega2 _|_ Th >= 0 and
0 <= omega3 - omega2 _|_ Tc >= 0: a closed freewheel opens where its torque falls through zero, an open one
closes where its speed does.
"""

from __future__ import annotations

import functools
import itertools
import math
import sys
from collections.abc import Callable, Mapping

import numpy as np

from inertia_module.contract.variables import default_parameters
from inertia_module.kernel.codes import DRIVE_TORQUE, ELASTIC

from .arcs import PHASE, Arc, follow
from .geometry import Inertia, ratio, shaft_frequency
from .trajectory import Array, Unavailable

TOLERANCE = 1e-13
# a speed below this part of that of link 1 is zero
ROUNDING = 1e-14
# freewheels, and the places of the state; behind them, elastic, omega4: the speed of the output is the last
HOUSING, OUTPUT = range(2)
Q, THETA1, TWIST, OMEGA1, OMEGA2, OMEGA3 = range(6)
OMEGA_OUT = -1


@functools.cache
def _free(count: int, by_torque: bool, held: bool, joined: bool) -> Array:
    """What moves of so many links: each row the speeds of all where one of them has speed 1."""
    moving = np.eye(count)
    moving[1, 2] = joined
    free: Array = moving[[by_torque, not held, not joined, True][:count]]
    return free


class Lagrange:
    """The motion of a module with any of its freewheels, its speed or its torque given.

    Args:
        parameters: by name, those that differ from the defaults; fidelity elastic or, any other, rigid.
        omega1: until another is given, or at the start where the drive gives a torque, rad/s.
        load_torque, drive_torque: on the output shaft and, where the drive gives one, on link 1, N.m.
        most: evaluations of the equations that it may take.

    Attributes:
        time: s. state: drive angle and angle of link 1, unwrapped, twist of the shaft, rad; speeds, rad/s.
        switches: times at which a freewheel opened or closed, s. evaluations: of the equations.

    Raises:
        Unavailable: a freewheel turns backwards at the start.
        ArithmeticError: the motion leaves the range of doubles, or takes more evaluations.
    """

    def __init__(
        self,
        parameters: Mapping[str, float],
        omega1: float,
        load_torque: float,
        drive_torque: float = 0.0,
        most: float = math.inf,
    ) -> None:
        self.p = p = {**default_parameters(), **parameters}
        self._inertia, self.k = Inertia(p), ratio(p)
        self._elastic, self._by_torque = p["fidelity"] == ELASTIC, p["drive"] == DRIVE_TORQUE
        names = ("input_inertia", "link2_inertia", "output_inertia", "driven_inertia")
        self._own = np.diag([p[name] for name in names[: 3 + self._elastic]])
        if self._elastic:
            self._own[3, 2] = -p["balancer"] * p["driven_inertia"]
        # what I, B, G, each 1, are of M
        self._parts = np.zeros((3, *self._own.shape))
        self._parts[:, :2, :2] = [
            [[1.0, 0.0], [0.0, 0.0]],
            [[2.0 * self.k, -self.k], [-self.k, 0.0]],
            [[self.k**2, -(self.k**2)], [-(self.k**2), self.k**2]],
        ]
        there = p["housing_freewheel"], p["output_freewheel"]
        self._freewheels = [wheel for wheel in (HOUSING, OUTPUT) if there[wheel]]
        self.time, self.switches, self.evaluations, self._most = 0.0, list[float](), 0, most
        speeds = omega1, p["omega2_start"], *[p["omega_out_start"]] * (1 + self._elastic)
        self.state = np.array([p["drive_angle_start"], 0.0, 0.0, *speeds], dtype=float)
        if any(self._speed(wheel, self.state) < 0.0 for wheel in self._freewheels):
            raise Unavailable("Lagrange's equations: a start with omega2 >= 0 and omega3 >= omega2 is needed")
        # of those left out, that of the housing stays open, that of the output closed
        self._closed, self._slope = [False, not there[OUTPUT]], 0.0
        self.give(drive_torque, load_torque)

    @staticmethod
    def _speed(wheel: int, y: Array) -> float:
        """Speed at which a freewheel turns, rad/s."""
        return float(y[OMEGA2] if wheel == HOUSING else y[OMEGA3] - y[OMEGA2])

    def _matrix(self, ibg: Array) -> Array:
        """M of I, B, G or M' of their derivatives, without own inertias, for all speeds."""
        matrix: Array = (ibg @ self._parts.reshape(3, -1)).reshape(self._own.shape)
        return matrix

    def _outer(self, y: Array) -> list[float]:
        """Torques on all links but those in the freewheels, N.m."""
        p, (omega1, omega2, hub, *driven) = self.p, y[OMEGA1:]
        turning = self.k * self.k * p["drive_friction"] * (omega1 - omega2)
        link1 = self.torque - p["input_friction"] * omega1 - turning
        link2, output = turning - p["link2_friction"] * omega2, -p["output_friction"] * hub
        if not self._elastic:
            return [link1, link2, output - self.load]
        shaft = p["shaft_stiffness"] * y[TWIST] + p["shaft_damping"] * (hub - driven[0])
        return [link1, link2, output - shaft, shaft - p["driven_friction"] * driven[0] - self.load]

    def _moved(self, mass: Array, forces: Array, given: float, closed: list[bool]) -> Array:
        """Accelerations that forces make with these freewheels closed, that of link 1 given unless free.

        In the same way they are the speeds that momenta make.
        """
        free, first = _free(len(mass), self._by_torque, *closed), np.eye(1, len(mass))[0] * given
        moved: Array = first + np.linalg.solve(free @ mass @ free.T, free @ (forces - mass @ first)) @ free
        return moved

    def _motion(self, y: Array) -> tuple[Array, tuple[float, float]]:
        """The accelerations of all links, rad/s^2, and the torques (Th, Tc) in the freewheels, N.m."""
        self.evaluations += 1
        ibg, slopes = self._inertia(y[Q])
        mass, slope = self._matrix(ibg) + self._own, self._matrix(slopes)
        w = y[OMEGA1:]
        push, forces = slope @ w, np.array(self._outer(y))
        forces -= self.k * (w[0] - w[1]) * push
        forces[:2] += 0.5 * self.k * (w @ push) * np.array([1.0, -1.0])
        alpha = self._moved(mass, forces, self._slope, self._closed)
        # SciPy would go on looking for a shorter step
        if not np.isfinite(alpha).all():
            raise ArithmeticError("the motion leaves the range of doubles")
        if self.evaluations > self._most:
            raise ArithmeticError(f"the motion takes more than {self._most:g} evaluations")
        missing = mass @ alpha - forces
        return alpha, (float(missing[1] + missing[2]), float(missing[2]))

    def _rates(self, time: float, y: Array) -> Array:
        twisting = y[OMEGA3] - y[OMEGA_OUT]
        return np.array([self.k * (y[OMEGA1] - y[OMEGA2]), y[OMEGA1], twisting, *self._motion(y)[0]])

    def _guard(self, wheel: int) -> Callable[[Array], float]:
        """What ends the contact mode by falling through zero: torque or speed of a freewheel."""
        if self._closed[wheel]:
            # raised by the smallest double: what is zero at first or throughout does not fall
            return lambda y: self._motion(y)[1][wheel] + sys.float_info.min
        return lambda y: self._speed(wheel, y) + ROUNDING * (1.0 + abs(float(y[OMEGA1])))

    def _let_go(self) -> None:
        """Open the freewheels that would have to pull, the hardest pulled first."""
        closed = [wheel for wheel in self._freewheels if self._closed[wheel]]
        torques = self._motion(self.state)[1]
        if closed and min(torques[wheel] for wheel in closed) < 0.0:
            self._closed[min(closed, key=lambda wheel: torques[wheel])] = False
            self._let_go()

    def _switch(self, wheel: int) -> None:
        """Open or close a freewheel, with the equality of speeds that this means exactly."""
        self._closed[wheel] = not self._closed[wheel]
        if self._closed[HOUSING]:
            self.state[OMEGA2] = 0.0
        if self._closed[OUTPUT]:
            self.state[OMEGA3] = self.state[OMEGA2]
        self.switches.append(self.time)
        self._let_go()

    @property
    def omega_out(self) -> float:
        """Speed of the output shaft, that of the driven mass if elastic, rad/s."""
        return float(self.state[OMEGA_OUT])

    def energy(self) -> float:
        """Kinetic energy of links 1 and 2 and of what turns behind them, and that of the twisted shaft, J."""
        w, twist = self.state[OMEGA1:], self.state[TWIST]
        mass = self._matrix(self._inertia(self.state[Q])[0]) + np.diag(np.diag(self._own))
        return float(0.5 * (w @ mass @ w + self.p["shaft_stiffness"] * twist * twist))

    def give(self, drive_torque: float, load_torque: float) -> None:
        """Set the torques on link 1 (where the drive gives one) and on the output shaft, N.m, from now on."""
        self.torque, self.load = drive_torque, load_torque
        for wheel in self._freewheels:
            self._closed[wheel] = self._closed[wheel] or self._speed(wheel, self.state) == 0.0
        self._let_go()

    def turn(self, omega1: float, slope: float = 0.0) -> None:
        """Give the speed of link 1, rad/s, from now on with a slope, rad/s^2.

        Where it jumps the freewheels' conditions hold for impulses and the speeds after it (Moreau).
        """
        self._slope = slope
        if omega1 != self.state[OMEGA1]:
            mass = self._matrix(self._inertia(self.state[Q])[0]) + self._own
            momenta = mass @ self.state[OMEGA1:]

            def breach(closed: list[bool]) -> float:
                w = self._moved(mass, momenta, omega1, closed)
                missing = mass @ w - momenta
                impulses, slips = (missing[1] + missing[2], missing[2]), (w[1], w[2] - w[1])
                return max((-(impulses if closed[n] else slips)[n] for n in self._freewheels), default=0.0)

            there = [n in self._freewheels for n in (HOUSING, OUTPUT)]
            choices = [(True, False) if there[n] else (n == OUTPUT,) for n in (HOUSING, OUTPUT)]
            self._closed = min(map(list, itertools.product(*choices)), key=breach)
            self.state[OMEGA1:] = self._moved(mass, momenta, omega1, self._closed)
        self.give(self.torque, self.load)

    def advance(self, time: float) -> None:
        """Go on to a time, s.

        Raises:
            ArithmeticError: the integrator gives up, or the motion leaves the range of doubles.
        """
        shaft = shaft_frequency(self.p.__getitem__) if self._elastic else 0.0
        while self.time < time:
            speed = 1.0 + abs(self.state[OMEGA1]) + abs(self.state[OMEGA2])
            longest = PHASE / (max(self._inertia.highest, 1.0) * self.k * speed + shaft)
            guards = [self._guard(wheel) for wheel in self._freewheels]

            def values(y: Array, guards: list[Callable[[Array], float]] = guards) -> Array:
                return np.array([guard(y) for guard in guards])

            arc = Arc(self._rates, values, longest, TOLERANCE, TOLERANCE * speed)
            self.time, self.state, first = follow(arc, self.time, self.state, time)
            if first is not None:
                self._switch(self._freewheels[first])
