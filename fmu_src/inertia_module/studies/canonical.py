"""The second reference: canonical momenta, inertia from positions alone, collocation of order 16.

Nothing of the kernel is used. The reduced inertia comes from rotation matrices as a Fourier series; the
motion from Hamilton's equations in (q, p2), p2 = dT/domega2, so that no acceleration is ever formed:

    p2 = (J2 + J) omega2 - k (B omega1 + G q')
    p2' = -k (I' omega1^2 / 2 + B' omega1 q' + G' q'^2 / 2) - load

J and load being those of the output shaft while it is driven, else 0. All in extended precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .collocation import Collocation, Extended
from .fourier_inertia import REAL, Inertia
from .trajectory import Case, Trajectory, Unavailable

# a step turns the highest harmonic by at most this, rad: sixteenth order leaves less than rounding
STEP_ANGLE = 2.0
_LOCATING = 80

HELD, FREE, DRIVING, REST = range(4)


@dataclass
class State:
    """Where the motion is: time, drive angle, speeds and contact mode."""

    time: Extended
    q: Extended
    omega2: Extended
    omega3: Extended
    mode: int


Guard = Callable[[Extended, Extended], Extended]


class Canonical:
    """The rigid module with both freewheels, at constant omega1 > 0 and load >= 0.

    Raises:
        Unavailable: another case.
    """

    def __init__(self, case: Case) -> None:
        both = case.parameter("housing_freewheel") and case.parameter("output_freewheel")
        if not (both and case.omega1 > 0.0 and case.load_torque >= 0.0):
            raise Unavailable("canonical momenta: allowed are both freewheels, omega1 > 0 and load >= 0")
        self.case = case
        self.inertia = Inertia(case)
        self.collocation = Collocation()
        p = case.parameter
        ratio = ("sun_radius", "satellite_radius") if self.inertia.planar else ("z2", "z16")
        self.k = REAL(p(ratio[0])) / REAL(p(ratio[1]))
        self.j2, self.j3 = REAL(p("link2_inertia")), REAL(p("output_inertia"))
        self.omega1, self.load = REAL(case.omega1), REAL(case.load_torque)
        self.switches: list[Extended] = []

    # --- one mode ---

    def _shaft(self, mode: int) -> tuple[Extended, Extended]:
        """(inertia of link 2 and what it drives, torque against it)."""
        return (self.j2 + self.j3, self.load) if mode == DRIVING else (self.j2, REAL(0))

    def _momentum(self, mode: int, q: Extended, omega2: Extended) -> Extended:
        (_, b, g), _ = self.inertia(np.atleast_1d(q))
        carried, _ = self._shaft(mode)
        return carried * omega2 - self.k * (b * self.omega1 + g * self.k * (self.omega1 - omega2))

    def _speed(self, mode: int, q: Extended, momentum: Extended) -> Extended:
        (_, b, g), _ = self.inertia(q)
        return self._speed_of(mode, b, g, momentum)

    def _speed_of(self, mode: int, b: Extended, g: Extended, momentum: Extended) -> Extended:
        carried, _ = self._shaft(mode)
        return (momentum + self.k * self.omega1 * (b + self.k * g)) / (carried + self.k**2 * g)

    def _push(self, mode: int, slopes: Extended, omega2: Extended) -> Extended:
        """dT/dtheta2 less the load, the rate of p2, from slopes (I', B', G')."""
        i1, b1, g1 = slopes
        rate = self.k * (self.omega1 - omega2)
        torque = 0.5 * i1 * self.omega1**2 + b1 * self.omega1 * rate + 0.5 * g1 * rate**2
        return -self.k * torque - self._shaft(mode)[1]

    def _rates(self, mode: int) -> Callable[[Extended], Extended]:
        def rates(y: Extended) -> Extended:
            (_, b, g), slopes = self.inertia(y[0])
            omega2 = self._speed_of(mode, b, g, y[1])
            return np.array([self.k * (self.omega1 - omega2), self._push(mode, slopes, omega2)])

        return rates

    def _held_push(self, q: Extended) -> Extended:
        """What pushes link 2 forwards while it rests: -Th, from p2' = push + Th with p2(q) known."""
        _, slopes = self.inertia(q)
        _, b1, g1 = slopes
        rate = self.k * self.omega1
        return self._push(HELD, slopes, np.zeros_like(q)) + self.k * self.omega1 * (b1 + self.k * g1) * rate

    def _output_torque(self, q: Extended, momentum: Extended) -> Extended:
        """Tc while driving: load + J3 omega2', omega2' from the rates of p2 and of the inertia."""
        (_, b, g), slopes = self.inertia(q)
        _, b1, g1 = slopes
        omega2 = self._speed_of(DRIVING, b, g, momentum)
        rate = self.k * (self.omega1 - omega2)
        carried, _ = self._shaft(DRIVING)
        change = self.k * rate * (self.omega1 * (b1 + self.k * g1) - self.k * g1 * omega2)
        alpha = (self._push(DRIVING, slopes, omega2) + change) / (carried + self.k**2 * g)
        return self.load + self.j3 * alpha

    # --- from event to event ---

    def _guards(self, state: State) -> list[tuple[Guard, int]]:
        """Functions of (time passed, [q, p2]) that end the mode by falling through zero; what follows."""
        if state.mode == FREE:

            def slip(t: Extended, y: Extended) -> Extended:
                return state.omega3 - self.load / self.j3 * t - self._speed(FREE, y[0], y[1])

            return [(lambda _, y: self._speed(FREE, y[0], y[1]), HELD), (slip, DRIVING)]
        if state.mode == DRIVING:
            return [
                (lambda _, y: self._output_torque(y[0], y[1]), FREE),
                (lambda _, y: self._speed(DRIVING, y[0], y[1]), REST),
            ]
        if state.mode == HELD:
            return [
                (lambda _, y: -self._held_push(y[0]), FREE),
                (lambda t, _: state.omega3 - self.load / self.j3 * t, REST),
            ]
        return [(lambda _, y: self.load - self._held_push(y[0]), DRIVING)]

    def _flow(self, state: State, h: Extended) -> tuple[Extended, Extended, Extended]:
        """([q, p2] after h, [q, p2] at the points looked at, their times): the mode's own motion."""
        times = np.append(h * self.collocation.nodes, h)
        start = np.array([state.q, self._momentum(state.mode, state.q, state.omega2)[0]])
        if state.mode in (HELD, REST):
            angles = state.q + self.k * self.omega1 * times
            path = np.array([angles, np.zeros_like(angles)])
            return path[:, -1], path, times
        end, stages = self.collocation.step(self._rates(state.mode), start, h)
        return end, np.concatenate([stages, end[:, None]], axis=1), times

    def _first_event(self, state: State, h: Extended) -> tuple[Extended, int] | None:
        """Time passed and next mode of the first guard that falls through zero within h, or None."""
        _, path, times = self._flow(state, h)
        found = None
        for guard, follows in self._guards(state):
            values = np.append(guard(np.zeros(1, REAL), self._start(state)), guard(times, path))
            # armed once it is positive: the guard that began the mode starts at zero
            falls = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
            if falls.size:
                bracket = np.append(REAL(0), times)[falls[0] : falls[0] + 2]
                time = self._locate(state, guard, bracket[0], bracket[1])
                if found is None or time < found[0]:
                    found = time, follows
        return found

    def _start(self, state: State) -> Extended:
        return np.array([[state.q], self._momentum(state.mode, state.q, state.omega2)])

    def _locate(self, state: State, guard: Guard, low: Extended, high: Extended) -> Extended:
        """Root of a guard between two times by the Illinois method, a whole step of its own to each try."""

        def value(t: Extended) -> Extended:
            end, _, _ = self._flow(state, t)
            return guard(np.array([t]), end[:, None])[0]

        above = value(low) if low > 0 else guard(np.zeros(1, REAL), self._start(state))[0]
        below, side, last, middle = value(high), 0, low, high
        for _ in range(_LOCATING):
            middle = (low * below - high * above) / (below - above)
            if not low < middle < high:
                middle = (low + high) / 2
            if abs(middle - last) <= 4 * np.finfo(REAL).eps * (state.time + high):
                break
            last, found = middle, value(middle)
            if found > 0:
                low, above = middle, found
                below = below / 2 if side > 0 else below
                side = 1
            else:
                high, below = middle, found
                above = above / 2 if side < 0 else above
                side = -1
        return middle

    def _moved(self, state: State, h: Extended, follows: int | None) -> State:
        """The state after h; at an event with the equality that it stands for, exactly."""
        end, _, _ = self._flow(state, h)
        mode = state.mode
        omega2 = REAL(0) if mode in (HELD, REST) else self._speed(mode, end[:1], end[1:])[0]
        if mode == DRIVING:
            omega3 = omega2
        else:
            omega3 = REAL(0) if mode == REST else state.omega3 - self.load / self.j3 * h
        if follows is not None:
            mode = follows
            if mode == HELD:
                omega2 = REAL(0)
            elif mode == REST:
                omega2 = omega3 = REAL(0)
            elif mode == DRIVING:
                omega2 = omega3
        return State(state.time + h, end[0], omega2, omega3, mode)

    def _to(self, state: State, time: Extended) -> State:
        while state.time < time:
            longest = STEP_ANGLE / (self.inertia.highest * self.k * (self.omega1 + abs(state.omega2)))
            h = min(REAL(longest), time - state.time)
            event = self._first_event(state, h)
            if event is None:
                whole = h == time - state.time
                state = self._moved(state, h, None)
                if whole:
                    state.time = time
            else:
                state = self._moved(state, *event)
                self.switches.append(state.time)
        return state

    def run(self) -> Trajectory:
        """The case from a start at rest, to rounding.

        Raises:
            Unavailable: a start that is not at rest.
        """
        if self.case.parameter("omega2_start") or self.case.parameter("omega_out_start"):
            raise Unavailable("canonical momenta: allowed is a start at rest")
        q = REAL(self.case.parameter("drive_angle_start"))
        pushed = self._held_push(np.array([q]))[0] > self.load
        state = State(REAL(0), q, REAL(0), REAL(0), DRIVING if pushed else REST)
        rows = []
        for time in self.case.times.astype(REAL):
            state = self._to(state, time)
            rows.append((state.q, state.omega2, state.omega3))
        q_, omega2, omega3 = np.array(rows, dtype=float).T
        return Trajectory(
            self.case.times,
            q_,
            omega2,
            omega3,
            np.array(self.switches, dtype=float),
            self.collocation.evaluations,
            None,
            math.nan,
        )
