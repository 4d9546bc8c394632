"""The second reference: Lagrange's equations of the rigid module, by SciPy from event to event.

Nothing of the kernel is used. The kinetic energy is 1/2 w' M(q) w of w = (omega1, omega2, omega3), with
q' = k (omega1 - omega2), I, B, G of geometry.py and M' = dM/dq:

    M11 = J1 + I + 2 k B + k^2 G    M12 = -k (B + k G)    M22 = J2 + k^2 G    M33 = J3    M13 = M23 = 0
    M alpha + M' q' w - 1/2 (w' M' w) (k, -k, 0) = (M1, Th - Tc, Tc - load)

Of M1 and omega1 = constant one is given. 0 <= omega2 _|_ Th >= 0 and 0 <= omega3 - omega2 _|_ Tc >= 0: a
closed freewheel opens where its torque falls through zero, an open one closes where its speed does.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..contract.variables import default_parameters
from ..kernel.codes import DRIVE_TORQUE
from .extras import library
from .geometry import Inertia, ratio
from .trajectory import Array, Unavailable

TOLERANCE = 1e-13
# rad of the highest harmonic in a step: the search for events sees the signs at its ends only
PHASE = 0.5
# a speed below this part of that of link 1 is zero
ROUNDING = 1e-14
# freewheels, and the places of the state
HOUSING, OUTPUT = range(2)
Q, THETA1, OMEGA1, OMEGA2, OMEGA3 = range(5)


class Lagrange:
    """The motion of a rigid module with any of its freewheels, its speed or its torque given.

    Args:
        parameters: by name, those that differ from the defaults.
        omega1: constant, or at the start where the drive gives a torque, rad/s. load_torque: N.m.

    Attributes:
        time: s. state: drive angle and angle of link 1, unwrapped, rad; omega1, omega2, omega3, rad/s.
        switches: times at which a freewheel opened or closed, s. evaluations: of the equations.

    Raises:
        Unavailable: SciPy is not installed, or a freewheel turns backwards at the start.
    """

    def __init__(self, parameters: Mapping[str, float], omega1: float, load_torque: float) -> None:
        p: dict[str, Any] = {**default_parameters(), **parameters}
        self._solve = library("scipy.integrate").solve_ivp
        self._inertia, self.k = Inertia(p), ratio(p)
        self._own = np.diag([p["input_inertia"], p["link2_inertia"], p["output_inertia"]])
        self._by_torque = p["drive"] == DRIVE_TORQUE
        there = p["housing_freewheel"], p["output_freewheel"]
        self._freewheels = [wheel for wheel in (HOUSING, OUTPUT) if there[wheel]]
        self.torque, self.load = 0.0, load_torque
        self.time, self.switches, self.evaluations = 0.0, list[float](), 0
        start = p["drive_angle_start"], 0.0, omega1, p["omega2_start"], p["omega_out_start"]
        self.state = np.array(start, dtype=float)
        if OUTPUT not in self._freewheels:
            self.state[OMEGA3] = self.state[OMEGA2]
        speeds = {wheel: self._speed(wheel, self.state) for wheel in self._freewheels}
        if min(speeds.values(), default=0.0) < 0.0:
            raise Unavailable("Lagrange's equations: a start with omega2 >= 0 and omega3 >= omega2 is needed")
        # housing and output: a housing freewheel left out is open for ever, that of the output closed
        self._closed = [speeds.get(HOUSING, 1.0) == 0.0, speeds.get(OUTPUT, 0.0) == 0.0]
        self._let_go()

    @staticmethod
    def _speed(wheel: int, y: Array) -> float:
        """Speed at which a freewheel turns, rad/s."""
        return float(y[OMEGA2] if wheel == HOUSING else y[OMEGA3] - y[OMEGA2])

    def _matrix(self, i: float, b: float, g: float) -> Array:
        """M of I, B, G or M' of their derivatives, without the links' own inertias, shape (3, 3)."""
        k = self.k
        both = -k * (b + k * g)
        return np.array([[i + k * (2.0 * b + k * g), both, 0.0], [both, k * k * g, 0.0], [0.0, 0.0, 0.0]])

    def _motion(self, y: Array) -> tuple[float, Array, tuple[float, float]]:
        """q', the accelerations (3,), rad/s^2, and the torques (Th, Tc) in the freewheels, N.m."""
        self.evaluations += 1
        k, w = self.k, y[OMEGA1:]
        ibg, slopes = self._inertia(y[Q])
        mass, slope = self._matrix(*ibg) + self._own, self._matrix(*slopes)
        rate = k * (w[0] - w[1])
        push = slope @ w
        forces = np.array([self.torque, 0.0, -self.load])
        forces += 0.5 * (w @ push) * np.array([k, -k, 0.0]) - rate * push
        housing, output = self._closed
        moving = [(1.0, 0.0, 0.0)] if self._by_torque else []
        moving += [] if housing else [(0.0, 1.0, float(output))]
        moving += [] if output else [(0.0, 0.0, 1.0)]
        free = np.array(moving).reshape(-1, 3)
        alpha = np.linalg.solve(free @ mass @ free.T, free @ forces) @ free
        missing = mass @ alpha - forces
        return rate, alpha, (float(missing[1] + missing[2]), float(missing[2]))

    def _rates(self, time: float, y: Array) -> Array:
        rate, alpha, _ = self._motion(y)
        return np.array([rate, y[OMEGA1], *alpha])

    def _guard(self, wheel: int) -> Callable[[float, Array], float]:
        """What ends the contact mode by falling through zero: torque or speed of a freewheel."""
        closed = self._closed[wheel]

        def guard(time: float, y: Array) -> float:
            # raised by next to nothing, so that what is zero at first or throughout does not fall
            if closed:
                return self._motion(y)[2][wheel] + sys.float_info.min
            return self._speed(wheel, y) + ROUNDING * (1.0 + abs(float(y[OMEGA1])))

        guard.terminal, guard.direction = True, -1.0  # type: ignore[attr-defined]
        return guard

    def _let_go(self) -> None:
        """Open the freewheels that would have to pull, the hardest pulled first."""
        closed = [wheel for wheel in self._freewheels if self._closed[wheel]]
        torques = self._motion(self.state)[2]
        if closed and min(torques[wheel] for wheel in closed) < 0.0:
            self._closed[min(closed, key=lambda wheel: torques[wheel])] = False
            self._let_go()

    def _switch(self, wheel: int) -> None:
        """Open or close a freewheel, with the equality that this stands for exactly."""
        self._closed[wheel] = not self._closed[wheel]
        if self._closed[HOUSING]:
            self.state[OMEGA2] = 0.0
        if self._closed[OUTPUT]:
            self.state[OMEGA3] = self.state[OMEGA2]
        self.switches.append(self.time)
        self._let_go()

    def energy(self) -> float:
        """Kinetic energy, J."""
        w = self.state[OMEGA1:]
        return float(0.5 * w @ (self._matrix(*self._inertia(self.state[Q])[0]) + self._own) @ w)

    def give(self, drive_torque: float, load_torque: float) -> None:
        """Set the torques on link 1 (where the drive gives one) and on the output shaft, N.m, from now on."""
        self.torque, self.load = drive_torque, load_torque
        self._let_go()

    def advance(self, time: float) -> None:
        """Go on to a time, s.

        Raises:
            ArithmeticError: the integrator gives up.
        """
        while self.time < time:
            speed = 1.0 + abs(self.state[OMEGA1]) + abs(self.state[OMEGA2])
            found = self._solve(
                self._rates,
                (self.time, time),
                self.state,
                "DOP853",
                events=[self._guard(wheel) for wheel in self._freewheels] or None,
                rtol=TOLERANCE,
                atol=TOLERANCE * speed,
                max_step=PHASE / (max(self._inertia.highest, 1.0) * self.k * speed),
            )
            if found.status < 0:
                raise ArithmeticError(f"DOP853 gave up at {found.t[-1]:g} s: {found.message}")
            self.time, self.state = float(found.t[-1]), found.y[:, -1].copy()
            for wheel, times in zip(self._freewheels, found.t_events or (), strict=False):
                if times.size:
                    self._switch(wheel)
                    break
