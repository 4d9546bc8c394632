"""The independent reference: the motion of a module from case to case (see cases.py), by SciPy.

Of all cases that the speeds allow the one that holds is taken: freewheels with 0 <= omega2 _|_ Th + drag >= 0
and 0 <= omega3 - omega2 _|_ Tc + drag >= 0, a slip that begins its own way, signs that come out as assumed.
A freewheel that has overrun is bound to nothing until its play is used up, a rigid one has an impact then.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from . import cases
from .cases import A1, A2, A3, A4, M1, M2, TC, TH, Forces, Machine, Mode, Q, speed_of
from .geometry import Array, UnavailableError

TOLERANCE = 1e-13
# a speed below this part of that of link 1 is zero
ROUNDING = 1e-14
# rad of the highest harmonic in a step, and parts of it at whose ends the search for events looks
PHASE, LOOKED_AT = 0.5, 8
# closeness to the bottom of a dip between two looks, of their distance
DIP = 1e-6
# rad of the highest harmonic by which one looks ahead
AHEAD = 1e-2
# what a case may miss of torques and accelerations and hold all the same
MISSED = 1e-9


def _fall(value: Callable[[float], float], times: Array, looked: Array) -> tuple[float, float] | None:
    """First interval from a time at which value is positive to one at which it is not.

    It is looked at at these times; between two of them only where their neighbours let a dip below zero be.
    """
    for n, (here, after) in enumerate(itertools.pairwise(looked)):
        left, right = float(times[n]), float(times[n + 1])
        if here > 0.0 >= after:
            return left, right
        before, beyond = looked[max(n - 1, 0)], looked[n + 2 : n + 3]
        sinks, rises = n == 0 or 2.0 * here < before, not beyond.size or 2.0 * after < beyond[0]
        if min(here, after) > 0.0 and sinks and rises:
            closeness = {"xatol": DIP * (right - left)}
            lowest = minimize_scalar(value, bounds=(left, right), method="bounded", options=closeness)
            if lowest.fun <= 0.0:
                return left, float(lowest.x)
    return None


class Reference:
    """The motion of a module, its speed or its torque given.

    Args:
        parameters: by name, those that differ from the defaults; fidelity elastic or, any other, rigid.
        omega1: until another is given, or at the start where the drive gives a torque, rad/s.
        load_torque, drive_torque: on the output shaft and, where the drive gives one, on link 1, N.m.
        most: evaluations of the rates that it may take.

    Attributes:
        machine: its equations. evaluations: of the rates so far.
        time: s. state: see its places in cases.py; speeds of hub and driven mass are the same if rigid.
        mode: the case that holds. switches: times at which freewheels opened or closed, s.

    Raises:
        UnavailableError: a freewheel turns backwards at the start, or is a spring where there is none.
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
        self.time, self.switches = 0.0, list[float]()
        self.evaluations, self._most = 0, most
        self.state = np.zeros(cases.SUMS + len(cases.INTEGRALS))
        self.state[Q] = p["drive_angle_start"]
        self.state[cases.OMEGA1 : cases.OMEGA4 + 1] = omega1, p["omega2_start"], *[p["omega_out_start"]] * 2
        # what is not there: open to the housing, closed to the output
        closed = cases.OPEN if self._wheels[cases.OUTPUT].there else cases.CLOSED
        self.mode: Mode = (cases.OPEN, closed, 1, 1, *[1] * int(p["satellites"]))
        if any(wheel.there and speed_of(self.state, n) < 0.0 for n, wheel in enumerate(self._wheels)):
            raise UnavailableError("reference: a start with omega2 >= 0 and omega3 >= omega2 is needed")
        for n, wheel in enumerate(self._wheels):
            self.state[cases.PLAY + n] = wheel.angle * (speed_of(self.state, n) > 0.0)
        self.give(drive_torque, load_torque)

    def _fastest(self) -> float:
        return 1.0 + abs(float(self.state[cases.OMEGA1])) + abs(float(self.state[cases.OMEGA2]))

    def _guards(self, y: Array, mode: Mode, found: Forces) -> Array:
        """Guards of a case, which must not fall below zero, for each of its places (infinite: none).

        Of an open freewheel and of a slip the speed, of what is closed what is left of the torque it holds,
        of a sign what has it.
        """
        machine, x = self.machine, found.x
        guards = np.full((len(mode), *x.shape[1:]), math.inf)
        least = ROUNDING * (1.0 + np.abs(y[cases.OMEGA1]))
        for n, torque in ((cases.HOUSING, TH), (cases.OUTPUT, TC)):
            if self._wheels[n].there:
                guards[n] = (
                    speed_of(y, n) + least if mode[n] == cases.OPEN else x[torque] + self._wheels[n].drag
                )
                if mode[n] == cases.BACK:
                    guards[n] = np.minimum(y[cases.PLAY + n], least - speed_of(y, n))
                elif mode[n] == cases.DRAGGED:
                    guards[n] = np.minimum(guards[n], -x[torque])
        if machine.rubs and mode[cases.SLIP] == 0:
            holding = found.journal + found.satellites + machine.mesh * np.abs(x[M2]) / machine.k
            guards[cases.SLIP] = holding - np.abs(x[M2] / machine.k - found.free)
        elif machine.rubs:
            guards[cases.SLIP] = mode[cases.SLIP] * speed_of(y, cases.SLIP) + least
            if machine.mesh:
                guards[cases.MESH] = mode[cases.SLIP] * mode[cases.MESH] * x[M2]
            if machine.teeth:
                guards[cases.TEETH :] = (np.array(mode[cases.TEETH :]) * found.teeth.T).T
        # what is zero at first or throughout does not fall
        return guards + float(np.finfo(float).tiny)

    def _cases(self) -> Iterator[Mode]:
        """All cases that the speeds allow."""
        y, places = self.state, list[tuple[int, ...]]()
        for n, wheel in enumerate(self._wheels):
            speed = speed_of(y, n)
            # a relaxed spring that does not turn yet is bound to nothing
            bound = wheel.stiffness > 0.0 and (y[cases.WOUND + n] != 0.0 or speed != 0.0)
            if not wheel.there or (bound and self.mode[n] == cases.CLOSED):
                places.append((self.mode[n],))
            elif speed > 0.0:
                places.append((cases.OPEN,))
            elif y[cases.PLAY + n] > 0.0:
                held = cases.DRAGGED, cases.OPEN, cases.BACK
                places.append((cases.BACK,) if speed < 0.0 else held[wheel.drag == 0.0 :])
            else:
                # a spring that is not wound up passes nothing yet: it would hold in any case
                places.append(
                    (cases.OPEN, cases.CLOSED) if wheel.stiffness > 0.0 else (cases.CLOSED, cases.OPEN)
                )
        slip = speed_of(y, cases.SLIP)
        places.append((0, 1, -1) if slip == 0.0 and self.machine.rubs else (1 if slip >= 0.0 else -1,))
        places.append((1, -1) if self.machine.mesh else (1,))
        places += [(1, -1) if self.machine.teeth else (1,)] * (len(self.mode) - cases.TEETH)
        for case in itertools.product(*places):
            # where it sticks signs are of no concern
            if case[cases.SLIP] != 0 or min(case[cases.MESH :]) == 1:
                yield case

    def _breach(self, mode: Mode) -> float:
        """Measure by how much a case does not hold, as a part of the torques and accelerations there are."""
        try:
            found = self.machine.forces(self.state, mode)
        except np.linalg.LinAlgError:
            return math.inf
        x, guards = found.x, self._guards(self.state, mode, found)
        if mode[cases.SLIP] == 0 and abs(x[A1] - x[A2]) > MISSED * abs(x[A1]):
            return math.inf
        speeds = np.abs(self.state[cases.OMEGA1 : cases.OMEGA4 + 1])
        rate = self.machine.k * speed_of(self.state, cases.SLIP)
        torques = np.abs(x[M1:]).sum() + self.machine.work.largest * (speeds[0] ** 2 + rate**2)
        scales = np.full(len(mode), 1e-9 + torques)
        ways = {cases.OPEN: 1, cases.BACK: -1}
        for place, way, gained in (
            (cases.HOUSING, ways.get(mode[cases.HOUSING], 0), x[A2]),
            (cases.OUTPUT, ways.get(mode[cases.OUTPUT], 0), x[A3] - x[A2]),
            (cases.SLIP, mode[cases.SLIP], x[A1] - x[A2]),
        ):
            if way and guards[place] < math.inf:
                # where it does not turn yet it has to begin to
                guards[place] = way * gained if speed_of(self.state, place) == 0.0 else 0.0
                scales[place] = 1e-9 + np.abs(x[: A4 + 1]).sum() + speeds.max() ** 2
        return float(max(0.0, *(-guards / scales)))

    def _goes_on(self, mode: Mode) -> bool:
        """Check that a case that holds also does a moment later: of several that hold now that is the one."""
        machine, y = self.machine, self.state
        rates, fastest = machine.rates(y, mode), self._fastest()
        growth = np.abs(rates[cases.OMEGA1 : cases.OMEGA4 + 1]).max() / fastest
        moment = AHEAD / (machine.highest * machine.k * fastest + machine.frequency + growth)
        middle = y + 0.5 * moment * rates
        later = y + moment * machine.rates(middle, mode)
        return bool(self._guards(later, mode, machine.forces(later, mode)).min() >= 0.0)

    def _choose(self, ended: int | None = None) -> None:
        """Take the case that holds; one whose place that has ended is as it was only if there is no other."""
        was, allowed = self.mode, list(self._cases())
        breaches = {case: self._breach(case) for case in allowed}
        best = min(allowed, key=lambda case: max(breaches[case], MISSED))
        holding = [case for case in allowed if breaches[case] <= MISSED]
        if len(holding) > 1:
            best = min(
                holding,
                key=lambda case: (not self._goes_on(case), ended is not None and case[ended] == was[ended]),
            )
        if not breaches[best] < 1e3 * MISSED:
            raise ArithmeticError(f"no case holds at {self.time:g} s: {breaches}")
        self.mode = best
        carrying = [
            [one in (cases.CLOSED, cases.DRAGGED) for one in mode[: cases.SLIP]] for mode in (was, self.mode)
        ]
        if carrying[0] != carrying[1] and self.time > 0.0:
            self.switches.append(self.time)

    def _settle(self, mode: Mode) -> None:
        """Make speeds exactly equal that are equal in a case."""
        y = self.state
        if self.machine.joined(mode, cases.HOUSING):
            y[cases.OMEGA2] = 0.0
            if mode[cases.SLIP] == 0:
                y[cases.OMEGA1] = 0.0
        elif mode[cases.SLIP] == 0:
            y[cases.OMEGA2] = y[cases.OMEGA1]
        if self.machine.joined(mode, cases.OUTPUT):
            y[cases.OMEGA3] = y[cases.OMEGA2]
        if not self.machine.elastic:
            y[cases.OMEGA4] = y[cases.OMEGA3]
        for n, wheel in enumerate(self._wheels):
            # what overruns further has its whole play
            y[cases.PLAY + n] = min(y[cases.PLAY + n], wheel.angle)

    def _switch(self, place: int) -> None:
        """Follow a guard that fell: a contact, a slip that comes to rest, or only a sign."""
        y, was = self.state, self.mode
        spring, played = (
            (self._wheels[place].stiffness, y[cases.PLAY + place]) if place < cases.SLIP else (0.0, 0.0)
        )
        if place < cases.SLIP and was[place] == cases.BACK and played < -speed_of(y, place):
            y[cases.PLAY + place] = 0.0
            self.mode = (*was[:place], cases.CLOSED, *was[place + 1 :])
            if spring == 0.0:
                self._engage()
        elif played > 0.0:
            self._settle((*was[:place], cases.DRAGGED, *was[place + 1 :]))
        elif spring > 0.0:
            # what it holds when it lets go is lost; it engages with nothing
            y[cases.SUMS + cases.INTEGRALS.index("freewheel")] += 0.5 * spring * y[cases.WOUND + place] ** 2
            y[cases.WOUND + place] = 0.0
            if was[place] == cases.CLOSED:
                self.mode = (*was[:place], cases.OPEN, *was[place + 1 :])
            else:
                y[cases.OMEGA2 + place] = 0.0 if place == cases.HOUSING else y[cases.OMEGA2]
                self._settle(was)
        elif place <= cases.SLIP:
            changed = 1 - was[place] if place < cases.SLIP else 0
            self._settle((*was[:place], changed, *was[place + 1 :]))
        self._choose(place)

    def _rates(self, _: float, y: Array) -> Array:
        self.evaluations += 1
        rates = self.machine.rates(y, self.mode)
        # SciPy would go on looking for a shorter step
        if not np.isfinite(rates).all():
            raise ArithmeticError("the motion leaves the range of doubles")
        if self.evaluations > self._most:
            raise ArithmeticError(f"the motion takes more than {self._most:g} evaluations")
        return rates

    def _solver(self, time: float, state: Array, end: float) -> DOP853:
        machine, speed = self.machine, self._fastest()
        longest = PHASE / (machine.highest * machine.k * speed + machine.frequency)
        return DOP853(
            self._rates,
            time,
            state,
            end,
            rtol=TOLERANCE,
            atol=TOLERANCE * speed,
            max_step=longest,
            # the error estimate changes its sign: a step far too long, SciPy's first, may pass by chance
            first_step=min(0.1 * longest, end - time) or None,
        )

    def _ends(self, path: Callable[[float | Array], Array], times: Array) -> Iterator[tuple[float, int]]:
        """Times at which guards fall through zero on the path of a step, and their numbers."""

        def guards(t: float | Array) -> Array:
            y = path(t)
            return self._guards(y, self.mode, self.machine.forces(y, self.mode))

        for place, looked in enumerate(guards(times)):

            def value(t: float, place: int = place) -> float:
                return float(guards(t)[place])

            fall = _fall(value, times, looked)
            # of several states at once it rounds otherwise than of one
            if fall and value(fall[0]) > 0.0:
                end = brentq(value, *fall, xtol=1e-16) if value(fall[1]) <= 0.0 else fall[1]
                yield float(end), place

    def advance(self, time: float) -> None:
        """Go on to a time, s.

        Raises:
            ArithmeticError: the integrator gives up, no case holds, or it takes too many evaluations.
        """
        while self.time < time:
            solver, ended, begin = self._solver(self.time, self.state, time), None, (self.time, self.state)
            while solver.status == "running":
                if ended is None:
                    begin = solver.t, solver.y
                message = solver.step()
                if solver.status == "failed":
                    raise ArithmeticError(f"DOP853 gave up at {solver.t:g} s: {message}")
                if ended is None:
                    looked = np.linspace(solver.t_old, solver.t, LOOKED_AT + 1)
                    if ends := list(self._ends(solver.dense_output(), looked)):
                        # the inside of a step is less accurate than its end
                        end, ended = min(ends)
                        solver = self._solver(*begin, end)
            self.time, self.state = solver.t, solver.y
            self._settle(self.mode)
            if ended is not None:
                self._switch(ended)

    def give(self, drive_torque: float, load_torque: float) -> None:
        """Set the torques on link 1 (where the drive gives one) and on the output shaft, N.m, from now on."""
        self.machine.torque, self.machine.load = drive_torque, load_torque
        self._choose()

    def turn(self, omega1: float, slope: float = 0.0) -> None:
        """Give the speed of link 1, rad/s, from now on with a slope, rad/s^2.

        A jump knows no friction; the freewheels' conditions hold for impulses and the speeds after it.

        Raises:
            UnavailableError: a jump with a freewheel that is a spring.
        """
        machine, y = self.machine, self.state
        machine.slope = slope
        if omega1 != y[cases.OMEGA1]:
            if any(wheel.stiffness for wheel in self._wheels):
                raise UnavailableError("reference: no jumps with freewheels that are springs")
            before = self.energy()
            self._hit(omega1 - y[cases.OMEGA1])
            y[cases.OMEGA1] = omega1
            y[cases.SUMS] += self.energy() - before
        self._choose()

    def _hit(self, change: float) -> Array:
        """Speeds after a jump of omega1, rad/s, or an engagement; returns the unknowns, see impact."""
        machine, y, hits = self.machine, self.state, dict[Mode, Array]()
        # what takes an impulse: no spring, no play left
        takes = [wheel.stiffness == 0.0 and y[cases.PLAY + n] <= 0.0 for n, wheel in enumerate(self._wheels)]
        choices = [
            (cases.CLOSED, cases.OPEN)[1 - takes[n] :] if self._wheels[n].there else (self.mode[n],)
            for n in (cases.HOUSING, cases.OUTPUT)
        ]
        for contacts in itertools.product(*choices):
            mode = (*contacts, *[1] * (len(self.mode) - cases.SLIP))
            hits[mode] = machine.impact(y, mode, change)

        def breach(mode: Mode) -> float:
            impulses, after = hits[mode], y[cases.OMEGA1 : cases.OMEGA4 + 1] + hits[mode][: A4 + 1]
            slips = after[A2], after[A3] - after[A2]
            ways = ((impulses[TH], slips[cases.HOUSING]), (impulses[TC], slips[cases.OUTPUT]))
            signs = [
                ways[n][mode[n] == cases.OPEN]
                for n in (cases.HOUSING, cases.OUTPUT)
                if self._wheels[n].there and takes[n]
            ]
            return -min(signs, default=0.0)

        mode = min(hits, key=breach)
        y[cases.OMEGA1 : cases.OMEGA4 + 1] += hits[mode][: A4 + 1]
        self._settle(mode)
        return hits[mode]

    def _engage(self) -> None:
        """Engage what has no play left, by an impact: what of the energy goes nowhere else is lost."""
        y, before, speeds = self.state, self.energy(), self.state[cases.OMEGA1 : cases.OMEGA4 + 1].copy()
        found = self._hit(0.0)
        work = found[M1] * y[cases.OMEGA1]
        # (a balancer at the shaft gives energy)
        given = self.machine.p["balancer"] * self.machine.p["driven_inertia"] * self.machine.elastic
        shaft = -given * found[A3] * (speeds[A4] + 0.5 * found[A4])
        y[cases.SUMS] += work
        y[cases.SUMS + cases.INTEGRALS.index("shaft")] += shaft
        y[cases.SUMS + cases.INTEGRALS.index("freewheel")] += before + work - shaft - self.energy()
        y[cases.SUMS + cases.INTEGRALS.index("M1") :] += found[M1 : TH + 1]

    @property
    def omega_out(self) -> float:
        """Speed of the output shaft, that of the driven mass if elastic, rad/s."""
        return float(self.state[cases.OMEGA4])

    def energy(self) -> float:
        """Stored energy: kinetic energy, weights, shaft and freewheels that are wound up, J."""
        return self.machine.energy(self.state)

    def integrals(self) -> dict[str, float]:
        """Works and losses, J, and impulses of the torques, N.m.s, since the start (see INTEGRALS)."""
        return dict(zip(cases.INTEGRALS, map(float, self.state[cases.SUMS :]), strict=True))

    def torques(self) -> Array:
        """(M1, M2, Tc, Th) now, N.m."""
        found: Array = self.machine.forces(self.state, self.mode).x[M1 : TH + 1]
        return found
