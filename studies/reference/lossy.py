"""The independent reference of the machine with losses: from case to case (see cases.py), by SciPy.

Of all cases that the speeds allow the one that holds is taken: freewheels with 0 <= omega2 _|_ Th + drag >= 0
and 0 <= omega3 - omega2 _|_ Tc + drag >= 0, a slip that begins its own way, signs that come out as assumed.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping

import numpy as np

from .arcs import PHASE, Arc, follow
from .cases import (
    A1,
    A2,
    A3,
    A4,
    CAUSES,
    CLOSED,
    HOUSING,
    INTEGRALS,
    M1,
    M2,
    MESH,
    OMEGA1,
    OMEGA2,
    OMEGA3,
    OMEGA4,
    OPEN,
    OUTPUT,
    SLIP,
    SUMS,
    TC,
    TEETH,
    TH,
    WOUND,
    Machine,
    Mode,
    Q,
    speed_of,
)
from .lagrange import ROUNDING, TOLERANCE, Lagrange
from .trajectory import Array, Unavailable

# rad of the highest harmonic by which one looks ahead
AHEAD = 1e-2
# what a case may miss of torques and accelerations and hold all the same
MISSED = 1e-9


class Lossy:
    """The motion of a module with losses, its speed or its torque given.

    Args:
        parameters: by name, those that differ from the defaults; fidelity elastic or, any other, rigid.
        omega1, load_torque, drive_torque: as of Lagrange, rad/s and N.m.
        most: evaluations of the equations that it may take.

    Attributes:
        time: s. state: see its places in cases.py; speeds of hub and driven mass are the same if rigid.
        mode: the case that holds. switches: times at which freewheels opened or closed, s.

    Raises:
        Unavailable: a freewheel turns backwards at the start, or is a spring where there is none.
        ArithmeticError: no case holds.
    """

    def __init__(
        self,
        parameters: Mapping[str, float],
        omega1: float,
        load_torque: float,
        drive_torque: float = 0.0,
        most: float = math.inf,
    ) -> None:
        self.machine = Machine(parameters)
        p, self._wheels = self.machine.p, self.machine.wheels
        self.time, self.switches, self._left = 0.0, list[float](), most
        self.state = np.zeros(SUMS + len(INTEGRALS))
        self.state[Q] = p["drive_angle_start"]
        self.state[OMEGA1 : OMEGA4 + 1] = omega1, p["omega2_start"], *[p["omega_out_start"]] * 2
        # what is not there: open to the housing, closed to the output
        closed = OPEN if self._wheels[OUTPUT].there else CLOSED
        self.mode: Mode = (OPEN, closed, 1, 1, *[1] * int(p["satellites"]))
        if any(wheel.there and speed_of(self.state, n) < 0.0 for n, wheel in enumerate(self._wheels)):
            raise Unavailable("losses: a start with omega2 >= 0 and omega3 >= omega2 is needed")
        self._start = self.energy()
        self.give(drive_torque, load_torque)

    def _fastest(self) -> float:
        return 1.0 + abs(float(self.state[OMEGA1])) + abs(float(self.state[OMEGA2]))

    def _guards(self, y: Array, mode: Mode) -> Array:
        """What must not fall below zero in a case, for each of its places (infinite: nothing).

        Of an open freewheel and of a slip the speed, of what is closed what is left of the torque it holds,
        of a sign what has it.
        """
        machine, found = self.machine, self.machine.forces(y, mode)
        x, guards = found.x, np.full(len(mode), math.inf)
        least = ROUNDING * (1.0 + abs(y[OMEGA1]))
        for n, torque in ((HOUSING, TH), (OUTPUT, TC)):
            if self._wheels[n].there:
                guards[n] = speed_of(y, n) + least if mode[n] == OPEN else x[torque] + self._wheels[n].drag
        if machine.rubs and mode[SLIP] == 0:
            holding = found.journal + found.satellites + machine.mesh * abs(x[M2]) / machine.k
            guards[SLIP] = holding - abs(x[M2] / machine.k - found.free)
        elif machine.rubs:
            guards[SLIP] = mode[SLIP] * speed_of(y, SLIP) + least
            if machine.mesh:
                guards[MESH] = mode[SLIP] * mode[MESH] * x[M2]
            if machine.teeth:
                guards[TEETH:] = np.array(mode[TEETH:]) * found.teeth
        # what is zero at first or throughout does not fall
        return guards + float(np.finfo(float).tiny)

    def _cases(self) -> Iterator[Mode]:
        """All cases that the speeds allow."""
        y, places = self.state, list[tuple[int, ...]]()
        for n, wheel in enumerate(self._wheels):
            if not wheel.there or (wheel.stiffness > 0.0 and self.mode[n] == CLOSED):
                places.append((self.mode[n],))
            elif speed_of(y, n) != 0.0:
                places.append((OPEN,))
            else:
                # a spring that is not wound up passes nothing yet: it would hold in any case
                places.append((OPEN, CLOSED) if wheel.stiffness > 0.0 else (CLOSED, OPEN))
        slip = speed_of(y, SLIP)
        places.append((0, 1, -1) if slip == 0.0 and self.machine.rubs else (1 if slip >= 0.0 else -1,))
        places.append((1, -1) if self.machine.mesh else (1,))
        places += [(1, -1) if self.machine.teeth else (1,)] * (len(self.mode) - TEETH)
        for case in itertools.product(*places):
            # where it sticks signs are of no concern
            if case[SLIP] != 0 or min(case[MESH:]) == 1:
                yield case

    def _breach(self, mode: Mode) -> float:
        """By how much a case does not hold, as a part of the torques and accelerations there are."""
        try:
            found, guards = self.machine.forces(self.state, mode), self._guards(self.state, mode)
        except np.linalg.LinAlgError:
            return math.inf
        x = found.x
        if mode[SLIP] == 0 and abs(x[A1] - x[A2]) > MISSED * abs(x[A1]):
            return math.inf
        scales = np.full(len(mode), 1e-9 + found.size)
        fastest = float(np.abs(self.state[OMEGA1 : OMEGA4 + 1]).max())
        for place, way, gained in (
            (HOUSING, mode[HOUSING] == OPEN, x[A2]),
            (OUTPUT, mode[OUTPUT] == OPEN, x[A3] - x[A2]),
            (SLIP, mode[SLIP] != 0, mode[SLIP] * (x[A1] - x[A2])),
        ):
            if way and guards[place] < math.inf:
                # where it does not turn yet it has to begin to
                guards[place] = gained if speed_of(self.state, place) == 0.0 else 0.0
                scales[place] = 1e-9 + np.abs(x[: A4 + 1]).sum() + fastest**2
        return float(max(0.0, *(-guards / scales)))

    def _goes_on(self, mode: Mode) -> bool:
        """Whether a case that holds also does a moment later: of several that hold now that is the one."""
        machine, y = self.machine, self.state
        moment = AHEAD / (machine.highest * machine.k * self._fastest() + machine.frequency)
        middle = y + 0.5 * moment * machine.rates(y, mode)
        return bool(self._guards(y + moment * machine.rates(middle, mode), mode).min() >= 0.0)

    def _choose(self, ended: int | None = None) -> None:
        """Take the case that holds; one whose place that has ended is as it was only if there is no other."""
        was, cases = self.mode, list(self._cases())
        breaches = [self._breach(case) for case in cases]

        def rank(n: int) -> tuple[bool, bool, bool, float]:
            missed = breaches[n] > MISSED
            as_it_was = ended is not None and cases[n][ended] == was[ended]
            return missed, missed or not self._goes_on(cases[n]), as_it_was, breaches[n] if missed else 0.0

        best = min(range(len(cases)), key=rank)
        if not breaches[best] < 1e3 * MISSED:
            raise ArithmeticError(
                f"no case holds at {self.time:g} s: {dict(zip(cases, breaches, strict=True))}"
            )
        self.mode = cases[best]
        if self.mode[:SLIP] != was[:SLIP] and self.time > 0.0:
            self.switches.append(self.time)

    def _settle(self, mode: Mode) -> None:
        """Make speeds exactly equal that are equal in a case."""
        y, rigid = self.state, [wheel.stiffness == 0.0 for wheel in self._wheels]
        if mode[HOUSING] == CLOSED and rigid[HOUSING]:
            y[OMEGA2] = 0.0
            if mode[SLIP] == 0:
                y[OMEGA1] = 0.0
        elif mode[SLIP] == 0:
            y[OMEGA2] = y[OMEGA1]
        if mode[OUTPUT] == CLOSED and rigid[OUTPUT]:
            y[OMEGA3] = y[OMEGA2]
        if not self.machine.elastic:
            y[OMEGA4] = y[OMEGA3]

    def _switch(self, place: int) -> None:
        """What a guard ends the case by: a contact, a slip that comes to rest, or only a sign."""
        y, was = self.state, self.mode
        spring = self._wheels[place].stiffness if place < SLIP else 0.0
        if spring > 0.0:
            # what it holds when it lets go is lost; it engages with nothing
            y[SUMS + INTEGRALS.index("freewheel")] += 0.5 * spring * y[WOUND + place] ** 2
            y[WOUND + place] = 0.0
            if was[place] == CLOSED:
                self.mode = (*was[:place], OPEN, *was[place + 1 :])
            else:
                y[OMEGA2 + place] = 0.0 if place == HOUSING else y[OMEGA2]
        elif place <= SLIP:
            changed = 1 - was[place] if place < SLIP else 0
            self._settle((*was[:place], changed, *was[place + 1 :]))
        self._choose(place)

    def advance(self, time: float) -> None:
        """Go on to a time, s.

        Raises:
            ArithmeticError: the integrator gives up, no case holds, or it takes too many evaluations.
        """
        machine = self.machine
        while self.time < time:
            mode, speed = self.mode, self._fastest()
            longest = PHASE / (machine.highest * machine.k * speed + machine.frequency)

            def rates(_: float, y: Array, mode: Mode = mode) -> Array:
                self._left -= 1
                if self._left < 0:
                    raise ArithmeticError("the motion takes more evaluations than allowed")
                return machine.rates(y, mode)

            def guards(y: Array, mode: Mode = mode) -> Array:
                return self._guards(y, mode)

            arc = Arc(rates, guards, longest, TOLERANCE, TOLERANCE * speed)
            self.time, self.state, ended = follow(arc, self.time, self.state, time)
            self._settle(mode)
            if ended is not None:
                self._switch(ended)

    def give(self, drive_torque: float, load_torque: float) -> None:
        """Set the torques on link 1 (where the drive gives one) and on the output shaft, N.m, from now on."""
        self.machine.torque, self.machine.load = drive_torque, load_torque
        self._choose()

    def turn(self, omega1: float, slope: float = 0.0) -> None:
        """Give the speed of link 1, rad/s, from now on with a slope, rad/s^2. A jump knows no friction.

        Raises:
            Unavailable: a jump with a freewheel that is a spring.
        """
        machine, y = self.machine, self.state
        machine.slope = slope
        if omega1 != y[OMEGA1]:
            if any(wheel.stiffness for wheel in self._wheels):
                raise Unavailable("losses: no jumps with freewheels that are springs")
            before, speeds = self.energy(), OMEGA4 + machine.elastic
            ideal = Lagrange(machine.p, float(y[OMEGA1]), machine.load, machine.torque)
            ideal.state[:] = y[:speeds]
            ideal.turn(omega1)
            y[:speeds] = ideal.state
            if not machine.elastic:
                y[OMEGA4] = y[OMEGA3]
            y[SUMS] += self.energy() - before
        self._choose()

    @property
    def omega_out(self) -> float:
        """Speed of the output shaft, that of the driven mass if elastic, rad/s."""
        return float(self.state[OMEGA4])

    def energy(self) -> float:
        """What is stored: kinetic energy, weights, shaft and freewheels that are wound up, J."""
        return self.machine.energy(self.state)

    def integrals(self) -> dict[str, float]:
        """Works and losses, J, and impulses of the torques, N.m.s, since the start (see INTEGRALS)."""
        return dict(zip(INTEGRALS, map(float, self.state[SUMS:]), strict=True))

    def residual(self) -> float:
        """Work in, less work out, losses and what more is stored: the error of the integration, J."""
        found = self.integrals()
        lost = math.fsum(found[cause] for cause in CAUSES)
        return found["energy_in"] - found["energy_out"] - lost - (self.energy() - self._start)

    def torques(self) -> Array:
        """(M1, M2, Tc, Th) now, N.m."""
        return self.machine.forces(self.state, self.mode).x[M1 : TH + 1]
