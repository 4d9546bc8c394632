"""The independent reference: the motion of a module from event to event (cases.py), integrated by SciPy.

The case at an instant satisfies the complementarity conditions of the freewheels,
0 <= omega2 _|_ Th + drag >= 0 and 0 <= omega3 - omega2 _|_ Tc + drag >= 0. Its slip starts in the assumed
direction, and its torques have the assumed signs. After overrunning, a freewheel is free until it
has rotated backward by the engagement angle. A rigid freewheel then locks with an impact.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from . import cases
from .cases import A1, A2, A3, A4, M1, M2, TC, TH, Forces, Machine, Mode, Q, relative_speed
from .geometry import Array, UnavailableError

TOLERANCE = 1e-13
# round-off of speeds, relative to the speed of link 1
ROUNDING = 1e-14
# maximum phase of the highest harmonic in a step, rad, and intervals of a step in the event search
MAX_PHASE, SEARCH_INTERVALS = 0.5, 8
# accuracy of a minimum between two samples, relative to their distance
MINIMUM_RTOL = 1e-6
# phase of the highest harmonic after which a case must still hold, rad
TRIAL_PHASE = 1e-2
# violation of the conditions of a case that counts as round-off, relative to torques and accelerations
CASE_RTOL = 1e-9


def _zero_crossing(
    value: Callable[[float], float], times: Array, samples: Array
) -> tuple[float, float] | None:
    """Return the first interval in which a function falls through zero, or None.

    The minimum between two samples is located if the neighbouring samples allow a minimum below zero.

    Args:
        value: function of time.
        times: times of the samples, s.
        samples: values at these times.
    """
    for n, (here, after) in enumerate(itertools.pairwise(samples)):
        left, right = float(times[n]), float(times[n + 1])
        if here > 0.0 >= after:
            return left, right
        before, beyond = samples[max(n - 1, 0)], samples[n + 2 : n + 3]
        falls, rises = n == 0 or 2.0 * here < before, not beyond.size or 2.0 * after < beyond[0]
        if min(here, after) > 0.0 and falls and rises:
            options = {"xatol": MINIMUM_RTOL * (right - left)}
            minimum = minimize_scalar(value, bounds=(left, right), method="bounded", options=options)
            if minimum.fun <= 0.0:
                return left, float(minimum.x)
    return None


class Reference:
    """Motion of a speed-driven or torque-driven module.

    Args:
        parameters: parameters that differ from the defaults, by name; any fidelity except elastic is rigid.
        omega1: input speed, rad/s; of a torque-driven module only the initial speed.
        load_torque: load torque on the output shaft, N.m.
        drive_torque: torque on link 1 of a torque-driven module, N.m.
        max_evaluations: limit of the evaluations of the derivatives.

    Attributes:
        machine: equations of motion.
        evaluations: number of evaluations of the derivatives.
        time: time, s.
        state: state by the indices of cases.py; without elasticity hub and driven mass have the same speed.
        mode: present case.
        switches: times at which freewheels locked or unlocked, s.

    Raises:
        UnavailableError: a freewheel rotates backward at the start, or a missing freewheel has a stiffness.
        ArithmeticError: no case is consistent.
    """

    def __init__(
        self,
        parameters: Mapping[str, float],
        omega1: float,
        load_torque: float,
        drive_torque: float = 0.0,
        max_evaluations: float = math.inf,
    ) -> None:
        self.machine = Machine(parameters)
        p, self._wheels = self.machine.p, self.machine.wheels
        self.time, self.switches = 0.0, list[float]()
        self.evaluations, self._max_evaluations = 0, max_evaluations
        self.state = np.zeros(cases.FIRST_INTEGRAL + len(cases.INTEGRALS))
        self.state[Q] = p["drive_angle_start"]
        self.state[cases.OMEGA1 : cases.OMEGA4 + 1] = omega1, p["omega2_start"], *[p["omega_out_start"]] * 2
        # without freewheels link 2 is free from the housing and fixed to the output shaft
        closed = cases.OPEN if self._wheels[cases.OUTPUT].is_present else cases.CLOSED
        self.mode: Mode = (cases.OPEN, closed, 1, 1, *[1] * int(p["satellites"]))
        if any(
            wheel.is_present and relative_speed(self.state, n) < 0.0 for n, wheel in enumerate(self._wheels)
        ):
            raise UnavailableError("reference: a start with omega2 >= 0 and omega3 >= omega2 is needed")
        for n, wheel in enumerate(self._wheels):
            self.state[cases.REMAINING + n] = wheel.angle * (relative_speed(self.state, n) > 0.0)
        self.set_torques(drive_torque, load_torque)

    def _speed_scale(self) -> float:
        """Return the scale of the speeds, rad/s."""
        return 1.0 + abs(float(self.state[cases.OMEGA1])) + abs(float(self.state[cases.OMEGA2]))

    def _indicators(self, y: Array, mode: Mode, forces: Forces) -> Array:
        """Return the event indicators of a case for each of its indices; infinite without an event.

        An event occurs if an indicator falls below zero. It is the speed of an open freewheel or of a
        slip, the remaining torque of a locked freewheel or of sticking links, and the torque of a sign.

        Args:
            y: state or states.
            mode: case.
            forces: solution of the case.
        """
        machine, x = self.machine, forces.x
        indicators = np.full((len(mode), *x.shape[1:]), math.inf)
        rounding = ROUNDING * (1.0 + np.abs(y[cases.OMEGA1]))
        for n, torque in ((cases.HOUSING, TH), (cases.OUTPUT, TC)):
            if self._wheels[n].is_present:
                indicators[n] = (
                    relative_speed(y, n) + rounding
                    if mode[n] == cases.OPEN
                    else x[torque] + self._wheels[n].drag
                )
                if mode[n] == cases.BACKWARD:
                    indicators[n] = np.minimum(y[cases.REMAINING + n], rounding - relative_speed(y, n))
                elif mode[n] == cases.HELD_BY_DRAG:
                    indicators[n] = np.minimum(indicators[n], -x[torque])
        if machine.has_dry_friction and mode[cases.SLIP] == 0:
            friction = forces.journal + forces.satellites + machine.mesh * np.abs(x[M2]) / machine.k
            indicators[cases.SLIP] = friction - np.abs(x[M2] / machine.k - forces.free)
        elif machine.has_dry_friction:
            indicators[cases.SLIP] = mode[cases.SLIP] * relative_speed(y, cases.SLIP) + rounding
            if machine.mesh:
                indicators[cases.MESH] = mode[cases.SLIP] * mode[cases.MESH] * x[M2]
            if machine.teeth:
                indicators[cases.TEETH :] = (np.array(mode[cases.TEETH :]) * forces.teeth.T).T
        # an indicator that is zero at first does not fall below zero
        return indicators + float(np.finfo(float).tiny)

    def _cases(self) -> Iterator[Mode]:
        """Yield all cases that the speeds allow."""
        y, places = self.state, list[tuple[int, ...]]()
        for n, wheel in enumerate(self._wheels):
            speed = relative_speed(y, n)
            # a relaxed spring at rest may open
            is_loaded = wheel.stiffness > 0.0 and (y[cases.WIND_UP + n] != 0.0 or speed != 0.0)
            if not wheel.is_present or (is_loaded and self.mode[n] == cases.CLOSED):
                places.append((self.mode[n],))
            elif speed > 0.0:
                places.append((cases.OPEN,))
            elif y[cases.REMAINING + n] > 0.0:
                at_rest = cases.HELD_BY_DRAG, cases.OPEN, cases.BACKWARD
                places.append((cases.BACKWARD,) if speed < 0.0 else at_rest[wheel.drag == 0.0 :])
            else:
                # a relaxed spring transmits no torque, so its locked case is always consistent and comes last
                places.append(
                    (cases.OPEN, cases.CLOSED) if wheel.stiffness > 0.0 else (cases.CLOSED, cases.OPEN)
                )
        slip = relative_speed(y, cases.SLIP)
        places.append(
            (0, 1, -1) if slip == 0.0 and self.machine.has_dry_friction else (1 if slip >= 0.0 else -1,)
        )
        places.append((1, -1) if self.machine.mesh else (1,))
        places += [(1, -1) if self.machine.teeth else (1,)] * (len(self.mode) - cases.TEETH)
        for case in itertools.product(*places):
            # signs have no influence on sticking links
            if case[cases.SLIP] != 0 or min(case[cases.MESH :]) == 1:
                yield case

    def _inconsistency(self, mode: Mode) -> float:
        """Return the maximum violation of the conditions of a case, relative to torques and accelerations.

        Args:
            mode: case.
        """
        try:
            forces = self.machine.forces(self.state, mode)
        except np.linalg.LinAlgError:
            return math.inf
        x, indicators = forces.x, self._indicators(self.state, mode, forces)
        if mode[cases.SLIP] == 0 and abs(x[A1] - x[A2]) > CASE_RTOL * abs(x[A1]):
            return math.inf
        speeds = np.abs(self.state[cases.OMEGA1 : cases.OMEGA4 + 1])
        rate = self.machine.k * relative_speed(self.state, cases.SLIP)
        torques = np.abs(x[M1:]).sum() + self.machine.work.max_inertia * (speeds[0] ** 2 + rate**2)
        scales = np.full(len(mode), 1e-9 + torques)
        directions = {cases.OPEN: 1, cases.BACKWARD: -1}
        for place, direction, acceleration in (
            (cases.HOUSING, directions.get(mode[cases.HOUSING], 0), x[A2]),
            (cases.OUTPUT, directions.get(mode[cases.OUTPUT], 0), x[A3] - x[A2]),
            (cases.SLIP, mode[cases.SLIP], x[A1] - x[A2]),
        ):
            if direction and indicators[place] < math.inf:
                # from rest it must accelerate in its direction
                indicators[place] = (
                    direction * acceleration if relative_speed(self.state, place) == 0.0 else 0.0
                )
                scales[place] = 1e-9 + np.abs(x[: A4 + 1]).sum() + speeds.max() ** 2
        return float(max(0.0, *(-indicators / scales)))

    def _continues(self, mode: Mode) -> bool:
        """Return True if a case still holds after a short time.

        Args:
            mode: case that holds now.
        """
        machine, y = self.machine, self.state
        rates, fastest = machine.rates(y, mode), self._speed_scale()
        growth = np.abs(rates[cases.OMEGA1 : cases.OMEGA4 + 1]).max() / fastest
        duration = TRIAL_PHASE / (machine.max_order * machine.k * fastest + machine.frequency + growth)
        middle = y + 0.5 * duration * rates
        later = y + duration * machine.rates(middle, mode)
        return bool(self._indicators(later, mode, machine.forces(later, mode)).min() >= 0.0)

    def _select_case(self, event: int | None = None) -> None:
        """Select the case that holds now and continues to hold.

        Args:
            event: index of the case at which an event occurred; a case that changes it is preferred.
        """
        before, allowed = self.mode, list(self._cases())
        errors = {case: self._inconsistency(case) for case in allowed}
        best = min(allowed, key=lambda case: max(errors[case], CASE_RTOL))
        consistent = [case for case in allowed if errors[case] <= CASE_RTOL]
        if len(consistent) > 1:
            best = min(
                consistent,
                key=lambda case: (
                    not self._continues(case),
                    event is not None and case[event] == before[event],
                ),
            )
        if not errors[best] < 1e3 * CASE_RTOL:
            raise ArithmeticError(f"no case holds at {self.time:g} s: {errors}")
        self.mode = best
        locked = [
            [state in (cases.CLOSED, cases.HELD_BY_DRAG) for state in mode[: cases.SLIP]]
            for mode in (before, self.mode)
        ]
        if locked[0] != locked[1] and self.time > 0.0:
            self.switches.append(self.time)

    def _equalise_speeds(self, mode: Mode) -> None:
        """Make the speeds exactly equal that are equal in a case.

        Args:
            mode: case.
        """
        y = self.state
        if self.machine.is_joined(mode, cases.HOUSING):
            y[cases.OMEGA2] = 0.0
            if mode[cases.SLIP] == 0:
                y[cases.OMEGA1] = 0.0
        elif mode[cases.SLIP] == 0:
            y[cases.OMEGA2] = y[cases.OMEGA1]
        if self.machine.is_joined(mode, cases.OUTPUT):
            y[cases.OMEGA3] = y[cases.OMEGA2]
        if not self.machine.elastic:
            y[cases.OMEGA4] = y[cases.OMEGA3]
        for n, wheel in enumerate(self._wheels):
            # a freewheel that continues to overrun has its full engagement angle
            y[cases.REMAINING + n] = min(y[cases.REMAINING + n], wheel.angle)

    def _switch(self, place: int) -> None:
        """Handle an event: a freewheel locks or unlocks, a slip ends, or a sign changes.

        Args:
            place: index of the case at which the event occurred.
        """
        y, before = self.state, self.mode
        spring, remaining = (
            (self._wheels[place].stiffness, y[cases.REMAINING + place]) if place < cases.SLIP else (0.0, 0.0)
        )
        if place < cases.SLIP and before[place] == cases.BACKWARD and remaining < -relative_speed(y, place):
            y[cases.REMAINING + place] = 0.0
            self.mode = (*before[:place], cases.CLOSED, *before[place + 1 :])
            if spring == 0.0:
                self._engage()
        elif remaining > 0.0:
            self._equalise_speeds((*before[:place], cases.HELD_BY_DRAG, *before[place + 1 :]))
        elif spring > 0.0:
            # a spring that unlocks loses its energy; a spring that locks is relaxed
            y[cases.FIRST_INTEGRAL + cases.INTEGRALS.index("freewheel")] += (
                0.5 * spring * y[cases.WIND_UP + place] ** 2
            )
            y[cases.WIND_UP + place] = 0.0
            if before[place] == cases.CLOSED:
                self.mode = (*before[:place], cases.OPEN, *before[place + 1 :])
            else:
                y[cases.OMEGA2 + place] = 0.0 if place == cases.HOUSING else y[cases.OMEGA2]
                self._equalise_speeds(before)
        elif place <= cases.SLIP:
            changed = 1 - before[place] if place < cases.SLIP else 0
            self._equalise_speeds((*before[:place], changed, *before[place + 1 :]))
        self._select_case(place)

    def _rates(self, _: float, y: Array) -> Array:
        """Return the derivatives of the state in the present case.

        Args:
            _: time, s.
            y: state.
        """
        self.evaluations += 1
        rates = self.machine.rates(y, self.mode)
        # otherwise SciPy would reduce the step without end
        if not np.isfinite(rates).all():
            raise ArithmeticError("the motion leaves the range of doubles")
        if self.evaluations > self._max_evaluations:
            raise ArithmeticError(f"the motion takes more than {self._max_evaluations:g} evaluations")
        return rates

    def _solver(self, time: float, state: Array, end: float) -> DOP853:
        """Return an integrator of the present case.

        Args:
            time: start time, s.
            state: state at the start.
            end: end time, s.
        """
        machine, speed = self.machine, self._speed_scale()
        max_step = MAX_PHASE / (machine.max_order * machine.k * speed + machine.frequency)
        return DOP853(
            self._rates,
            time,
            state,
            end,
            rtol=TOLERANCE,
            atol=TOLERANCE * speed,
            max_step=max_step,
            # the error estimate of SciPy's first step can be small by chance because it changes its sign
            first_step=min(0.1 * max_step, end - time) or None,
        )

    def _events(self, path: Callable[[float | Array], Array], times: Array) -> Iterator[tuple[float, int]]:
        """Yield the times of the events in a step, s, and their indices of the case.

        Args:
            path: dense output of the step.
            times: times of the samples, s.
        """

        def indicators(t: float | Array) -> Array:
            y = path(t)
            return self._indicators(y, self.mode, self.machine.forces(y, self.mode))

        for place, samples in enumerate(indicators(times)):

            def value(t: float, place: int = place) -> float:
                return float(indicators(t)[place])

            interval = _zero_crossing(value, times, samples)
            # the round-off of one state differs from the round-off of several states
            if interval and value(interval[0]) > 0.0:
                end = brentq(value, *interval, xtol=1e-16) if value(interval[1]) <= 0.0 else interval[1]
                yield float(end), place

    def advance(self, time: float) -> None:
        """Integrate to a time.

        Args:
            time: end time, s.

        Raises:
            ArithmeticError: the integrator fails, no case is consistent, or evaluations reach their limit.
        """
        while self.time < time:
            solver, event, start = self._solver(self.time, self.state, time), None, (self.time, self.state)
            while solver.status == "running":
                if event is None:
                    start = solver.t, solver.y
                message = solver.step()
                if solver.status == "failed":
                    raise ArithmeticError(f"DOP853 failed at {solver.t:g} s: {message}")
                if event is None:
                    times = np.linspace(solver.t_old, solver.t, SEARCH_INTERVALS + 1)
                    if events := list(self._events(solver.dense_output(), times)):
                        # the dense output is less accurate than the end of a step, so the step is repeated
                        end, event = min(events)
                        solver = self._solver(*start, end)
            self.time, self.state = solver.t, solver.y
            self._equalise_speeds(self.mode)
            if event is not None:
                self._switch(event)

    def set_torques(self, drive_torque: float, load_torque: float) -> None:
        """Set the torques from now on.

        Args:
            drive_torque: torque on link 1 of a torque-driven module, N.m.
            load_torque: load torque on the output shaft, N.m.
        """
        self.machine.torque, self.machine.load = drive_torque, load_torque
        self._select_case()

    def set_speed(self, omega1: float, slope: float = 0.0) -> None:
        """Set speed and acceleration of link 1 from now on.

        A jump has no friction. The complementarity conditions of the freewheels hold for the impulses and the
        speeds after the jump.

        Args:
            omega1: speed, rad/s.
            slope: acceleration, rad/s^2.

        Raises:
            UnavailableError: a jump with a compliant freewheel.
        """
        machine, y = self.machine, self.state
        machine.slope = slope
        if omega1 != y[cases.OMEGA1]:
            if any(wheel.stiffness for wheel in self._wheels):
                raise UnavailableError("reference: no jumps with compliant freewheels")
            before = self.energy()
            self._apply_impact(omega1 - y[cases.OMEGA1])
            y[cases.OMEGA1] = omega1
            y[cases.FIRST_INTEGRAL] += self.energy() - before
        self._select_case()

    def _apply_impact(self, change: float) -> Array:
        """Change the speeds by an impact and return its unknowns (Machine.impact).

        Args:
            change: jump of omega1, rad/s; 0 for an engagement.
        """
        machine, y, impacts = self.machine, self.state, dict[Mode, Array]()
        # a rigid freewheel without remaining engagement angle takes an impulse
        takes_impulse = [
            wheel.stiffness == 0.0 and y[cases.REMAINING + n] <= 0.0 for n, wheel in enumerate(self._wheels)
        ]
        choices = [
            (cases.CLOSED, cases.OPEN)[1 - takes_impulse[n] :]
            if self._wheels[n].is_present
            else (self.mode[n],)
            for n in (cases.HOUSING, cases.OUTPUT)
        ]
        for contacts in itertools.product(*choices):
            mode = (*contacts, *[1] * (len(self.mode) - cases.SLIP))
            impacts[mode] = machine.impact(y, mode, change)

        def violation(mode: Mode) -> float:
            impulses, after = impacts[mode], y[cases.OMEGA1 : cases.OMEGA4 + 1] + impacts[mode][: A4 + 1]
            slips = after[A2], after[A3] - after[A2]
            pairs = ((impulses[TH], slips[cases.HOUSING]), (impulses[TC], slips[cases.OUTPUT]))
            signs = [
                pairs[n][mode[n] == cases.OPEN]
                for n in (cases.HOUSING, cases.OUTPUT)
                if self._wheels[n].is_present and takes_impulse[n]
            ]
            return -min(signs, default=0.0)

        mode = min(impacts, key=violation)
        y[cases.OMEGA1 : cases.OMEGA4 + 1] += impacts[mode][: A4 + 1]
        self._equalise_speeds(mode)
        return impacts[mode]

    def _engage(self) -> None:
        """Lock a freewheel by an impact; the missing energy is a loss of the freewheel."""
        y, before, speeds = self.state, self.energy(), self.state[cases.OMEGA1 : cases.OMEGA4 + 1].copy()
        impact = self._apply_impact(0.0)
        work = impact[M1] * y[cases.OMEGA1]
        # the balancer does work on the driven mass
        balanced_inertia = (
            self.machine.p["balancer"] * self.machine.p["driven_inertia"] * self.machine.elastic
        )
        shaft = -balanced_inertia * impact[A3] * (speeds[A4] + 0.5 * impact[A4])
        y[cases.FIRST_INTEGRAL] += work
        y[cases.FIRST_INTEGRAL + cases.INTEGRALS.index("shaft")] += shaft
        y[cases.FIRST_INTEGRAL + cases.INTEGRALS.index("freewheel")] += before + work - shaft - self.energy()
        y[cases.FIRST_INTEGRAL + cases.INTEGRALS.index("M1") :] += impact[M1 : TH + 1]

    @property
    def omega_out(self) -> float:
        """Speed of the output shaft (of the driven mass if elastic), rad/s."""
        return float(self.state[cases.OMEGA4])

    def energy(self) -> float:
        """Return the stored energy, J."""
        return self.machine.energy(self.state)

    def integrals(self) -> dict[str, float]:
        """Return works and losses, J, and impulses of the torques, N.m.s, since the start, by name."""
        return dict(zip(cases.INTEGRALS, map(float, self.state[cases.FIRST_INTEGRAL :]), strict=True))

    def torques(self) -> Array:
        """Return M1, M2, Tc and Th, N.m."""
        torques: Array = self.machine.forces(self.state, self.mode).x[M1 : TH + 1]
        return torques
