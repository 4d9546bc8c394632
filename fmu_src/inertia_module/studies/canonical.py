"""The reference of couplings: canonical momenta, inertia from positions alone, collocation of order 16.

Nothing of the kernel is used. The reduced inertia comes from rotation matrices as a Fourier series (I, B, G);
the motion from Hamilton's equations in (q, p1, p2), p = dT/domega, with the kinetic energy 1/2 w' M(q) w of
w = (omega1, omega2), so that the momenta need no acceleration:

    M11 = J1 + I + 2 k B + k^2 G    M12 = -k (B + k G)    M22 = J2 + k^2 G (+ J3 while the shaft is driven)
    p1' = M1 + k dT/dq              p2' = -k dT/dq (- load while the shaft is driven)

Of omega1 and its torque M1 one is given: with drive = speed omega1 is constant and p1 is not needed, with
drive = torque M1 is, from one push to the next. All in extended precision.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..kernel.codes import DRIVE_SPEED
from .collocation import Collocation, Extended
from .fourier_inertia import REAL, Inertia
from .trajectory import Case, Unavailable

# a step turns the highest harmonic by at most this, rad: sixteenth order leaves less than rounding
STEP_ANGLE = 2.0
_LOCATING = 80

HELD, FREE, DRIVING, REST = range(4)
# rows of the path: drive angle, angle of link 1, momenta
Q, THETA1, P1, P2 = range(4)


@dataclass
class State:
    """Where the motion is: time, angles of drive and link 1, speeds and contact mode."""

    time: Extended
    q: Extended
    theta1: Extended
    omega1: Extended
    omega2: Extended
    omega3: Extended
    mode: int


Guard = Callable[[Extended, Extended], Extended]


class Canonical:
    """The rigid module with both freewheels, at constant omega1 > 0 or by torque, and load >= 0.

    Attributes:
        torque: M1 where it is given, N.m; may be set by push. state: of the motion, at the start at rest.
        switches: times at which the contact mode changed, s.

    Raises:
        Unavailable: another case.
    """

    def __init__(self, case: Case) -> None:
        p = case.parameter
        both = p("housing_freewheel") and p("output_freewheel")
        if not (both and case.omega1 > 0.0 and case.load_torque >= 0.0):
            raise Unavailable("canonical momenta: both freewheels, omega1 > 0 and load >= 0 are needed")
        if p("omega2_start") or p("omega_out_start"):
            raise Unavailable("canonical momenta: a start at rest is needed")
        self.case = case
        self.by_speed = p("drive") == DRIVE_SPEED
        self.inertia = Inertia(case)
        self.collocation = Collocation()
        ratio = ("sun_radius", "satellite_radius") if self.inertia.planar else ("z2", "z16")
        self.k = REAL(p(ratio[0])) / REAL(p(ratio[1]))
        inertias = ("input_inertia", "link2_inertia", "output_inertia")
        self.j1, self.j2, self.j3 = (REAL(p(name)) for name in inertias)
        self.load, self.torque = REAL(case.load_torque), REAL(0)
        self.switches: list[Extended] = []
        zero = REAL(0)
        self.state = State(zero, REAL(p("drive_angle_start")), zero, REAL(case.omega1), zero, zero, REST)
        self._let_go()

    # --- one mode ---

    def _matrix(self, ibg: Extended, own1: Extended, own2: Extended) -> tuple[Extended, Extended, Extended]:
        """(M11, M12, M22) of I, B, G, or of their slopes without own inertias."""
        i, b, g = ibg
        k = self.k
        return own1 + i + 2 * k * b + k * k * g, -k * (b + k * g), own2 + k * k * g

    def _masses(self, mode: int, ibg: Extended) -> tuple[Extended, Extended, Extended]:
        return self._matrix(ibg, self.j1, self.j2 + (self.j3 if mode == DRIVING else 0))

    def _speeds(self, mode: int, ibg: Extended, y: Extended) -> tuple[Extended, Extended]:
        """(omega1, omega2) from the momenta."""
        m11, m12, m22 = self._masses(mode, ibg)
        if mode in (HELD, REST):
            omega1 = np.full_like(y[Q], self.state.omega1) if self.by_speed else y[P1] / m11
            return omega1, np.zeros_like(y[Q])
        if self.by_speed:
            return np.full_like(y[Q], self.state.omega1), (y[P2] - m12 * self.state.omega1) / m22
        determinant = m11 * m22 - m12 * m12
        return (m22 * y[P1] - m12 * y[P2]) / determinant, (m11 * y[P2] - m12 * y[P1]) / determinant

    def _forces(
        self, mode: int, slopes: Extended, omega1: Extended, omega2: Extended
    ) -> tuple[Extended, Extended]:
        """Rates of p1 and p2, without what the freewheel of the housing adds; slopes: (I', B', G')."""
        d11, d12, d22 = self._matrix(slopes, REAL(0), REAL(0))
        push = self.k * (d11 * omega1**2 / 2 + d12 * omega1 * omega2 + d22 * omega2**2 / 2)
        return self.torque + push, -push - (self.load if mode in (DRIVING, REST) else 0)

    def _rates(self, mode: int) -> Callable[[Extended], Extended]:
        def rates(y: Extended) -> Extended:
            ibg, slopes = self.inertia(y[Q])
            omega1, omega2 = self._speeds(mode, ibg, y)
            force1, force2 = self._forces(mode, slopes, omega1, omega2)
            return np.array([self.k * (omega1 - omega2), omega1, force1, force2])

        return rates

    def _contact(self, mode: int, y: Extended) -> Extended:
        """Torque in the freewheel that the mode keeps closed: Tc while driving, else Th."""
        ibg, slopes = self.inertia(y[Q])
        omega1, omega2 = self._speeds(mode, ibg, y)
        m11, m12, m22 = self._masses(mode, ibg)
        d11, d12, d22 = self._matrix(slopes, REAL(0), REAL(0))
        force1, force2 = self._forces(mode, slopes, omega1, omega2)
        # M alpha = force - M' q' omega
        rate = self.k * (omega1 - omega2)
        force1 = force1 - rate * (d11 * omega1 + d12 * omega2)
        force2 = force2 - rate * (d12 * omega1 + d22 * omega2)
        if mode == DRIVING:
            determinant = m11 * m22 - m12 * m12
            alpha2 = force2 / m22 if self.by_speed else (m11 * force2 - m12 * force1) / determinant
            return self.load + self.j3 * alpha2
        return (0 if self.by_speed else m12 * force1 / m11) - force2

    # --- from event to event ---

    def _guards(self) -> list[tuple[Guard, int]]:
        """Functions of (time passed, path) that end the mode by falling through zero; what follows."""
        mode, omega3 = self.state.mode, self.state.omega3

        def contact(_: Extended, y: Extended) -> Extended:
            return self._contact(mode, y)

        def omega2(_: Extended, y: Extended) -> Extended:
            return self._speeds(mode, self.inertia(y[Q])[0], y)[1]

        def coasting(t: Extended, _: Extended) -> Extended:
            return omega3 - self.load / self.j3 * t

        def slip(t: Extended, y: Extended) -> Extended:
            return coasting(t, y) - omega2(t, y)

        ends: dict[int, list[tuple[Guard, int]]] = {
            HELD: [(contact, FREE), (coasting, REST)],
            FREE: [(omega2, HELD), (slip, DRIVING)],
            DRIVING: [(contact, FREE), (omega2, REST)],
            REST: [(contact, DRIVING)],
        }
        return ends[mode]

    def _start(self) -> Extended:
        """Path at the beginning of a step, shape (4, 1)."""
        x = self.state
        ibg, _ = self.inertia(np.array([x.q]))
        m11, m12, m22 = self._masses(x.mode, ibg)
        p1, p2 = m11 * x.omega1 + m12 * x.omega2, m12 * x.omega1 + m22 * x.omega2
        return np.array([[x.q], [x.theta1], p1, p2])

    def _flow(self, h: Extended) -> tuple[Extended, Extended]:
        """(path at the points looked at, their times): the mode's own motion; the last one after h."""
        end, stages = self.collocation.step(self._rates(self.state.mode), self._start()[:, 0], h)
        times = np.append(h * self.collocation.nodes, h)
        return np.concatenate([stages, end[:, None]], axis=1), times

    def _first_event(self, h: Extended) -> tuple[Extended, int] | None:
        """Time passed and next mode of the first guard that falls through zero within h, or None."""
        path, times = self._flow(h)
        found = None
        for guard, follows in self._guards():
            values = np.append(guard(np.zeros(1, REAL), self._start()), guard(times, path))
            # armed once it is positive: the guard that began the mode starts at zero
            falls = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
            if falls.size:
                bracket = np.append(REAL(0), times)[falls[0] : falls[0] + 2]
                time = self._locate(guard, bracket[0], bracket[1])
                if found is None or time < found[0]:
                    found = time, follows
        return found

    def _locate(self, guard: Guard, low: Extended, high: Extended) -> Extended:
        """Root of a guard between two times by the Illinois method, a whole step of its own to each try."""

        def value(t: Extended) -> Extended:
            path = self._start() if t == 0 else self._flow(t)[0][:, -1:]
            return guard(np.array([t]), path)[0]

        above, below, side, last, middle = value(low), value(high), 0, low, high
        for _ in range(_LOCATING):
            middle = (low * below - high * above) / (below - above)
            if not low < middle < high:
                middle = (low + high) / 2
            if abs(middle - last) <= 4 * np.finfo(REAL).eps * (self.state.time + high):
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

    def _move(self, h: Extended) -> None:
        """Go on by h within the mode."""
        x = self.state
        end = self._flow(h)[0][:, -1:]
        omega1, omega2 = self._speeds(x.mode, self.inertia(end[Q])[0], end)
        omega3 = omega2[0] if x.mode == DRIVING else REAL(0)
        if x.mode in (HELD, FREE):
            omega3 = x.omega3 - self.load / self.j3 * h
        self.state = State(x.time + h, end[Q, 0], end[THETA1, 0], omega1[0], omega2[0], omega3, x.mode)

    def _switch(self, mode: int) -> None:
        """Enter a mode with the equality that it stands for, exactly."""
        x = self.state
        omega2 = REAL(0) if mode in (HELD, REST) else x.omega2
        omega3 = omega2 if mode in (DRIVING, REST) else x.omega3
        self.state = dataclasses.replace(x, omega2=omega2, omega3=omega3, mode=mode)

    def _let_go(self) -> None:
        """Open the freewheel that would have to pull."""
        follows = {HELD: FREE, DRIVING: FREE, REST: DRIVING}.get(self.state.mode)
        if follows is not None and self._contact(self.state.mode, self._start())[0] < 0:
            self._switch(follows)

    def push(self, torque: float) -> None:
        """Give link 1 another torque, N.m, from now on."""
        self.torque = REAL(torque)
        self._let_go()

    def advance(self, time: Extended, angle: float = STEP_ANGLE) -> None:
        """Go on to a time, s.

        Args:
            time: s. angle: that the highest harmonic may turn in a step, rad.
        """
        while self.state.time < time:
            x = self.state
            speed = max(abs(x.omega1) + abs(x.omega2), REAL(1))
            h = min(REAL(angle) / (self.inertia.highest * self.k * speed), time - x.time)
            event = self._first_event(h)
            if event is None:
                whole = h == time - x.time
                self._move(h)
                if whole:
                    self.state.time = time
            else:
                self._move(event[0])
                self._switch(event[1])
                self.switches.append(self.state.time)
