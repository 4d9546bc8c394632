"""A run from event to event with someone else's integrator, mode by mode, and its energy audit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ...kernel import codes
from ...kernel.links import angular_momentum, kinetic_energy
from ..trajectory import Array, Case, Trajectory, median_time
from .equations import LINK2, OUTPUT, data_of, equations, in_array, start_of

# events a run may have: bounds a run that goes nowhere
EVENTS_ALLOWED = 100_000


class Segment(NamedTuple):
    """One contact mode's motion: its end, the guard that fell (or None), samples, right-hand sides."""

    time: float
    state: Array
    guard: int | None
    samples: Array
    evaluations: int


# integrates (data, time, state, output times not before time, the last of them the end)
Integrator = Callable[[Any, float, Array, Array], Segment]


def chosen_mode(data: Any, state: Array) -> float:
    """Contact mode of the complementarity problem at constant input speed and load."""
    mode: float = equations().select_mode(state, in_array(data))
    return mode


def leave(data: Any, state: Array, guard: int) -> None:
    """Put the state exactly on the guard that fell and set the contact mode that follows.

    A torque that falls through zero opens its freewheel. A speed that does is set to zero, and the
    complementarity problem says what follows.
    """
    mode = data.mode
    if mode == codes.HELD_DRIVING:
        data.mode = codes.DRIVING
    elif (mode, guard) in ((codes.HELD, LINK2), (codes.DRIVING, OUTPUT)):
        data.mode = codes.FREE
    else:
        if mode == codes.HELD:
            state[2] = 0.0
        elif guard == LINK2:
            state[1] = 0.0
            if mode == codes.DRIVING:
                state[2] = 0.0
        else:
            state[2] = state[1]
        data.mode = chosen_mode(data, state)


class Audit:
    """Energy of a run at constant input speed, from the ends of its segments alone.

    While link 2 is held the input works into the kinetic energy only; else M1 - Tc is the rate of
    the angular momentum P of links 1, 2 and the imbalances, and Tc - load that of the shaft's.
    """

    def __init__(self) -> None:
        self.residual = 0.0

    def add(self, data: Any, begin: tuple[float, Array], end: tuple[float, Array]) -> None:
        """Count one segment from (time, state) to (time, state)."""
        d, omega1, load = data.d, data.omega1, data.load
        (t0, y0), (t1, y1) = begin, end
        stored = _energy(d, omega1, y1) - _energy(d, omega1, y0)
        time = t1 - t0
        mode = data.mode
        if mode in (codes.HELD, codes.HELD_DRIVING):
            work = _energy(d, omega1, y1, shaft=0.0) - _energy(d, omega1, y0, shaft=0.0)
        else:
            work = omega1 * (_momentum(d, omega1, y1) - _momentum(d, omega1, y0))
        if mode == codes.DRIVING:
            work += omega1 * (d.J3 * (y1[2] - y0[2]) + load * time)
            turned = omega1 * time - (y1[0] - y0[0]) / d.k
        else:
            turned = 0.5 * (y0[2] + y1[2]) * time
        self.residual += work - load * turned - stored


def _energy(d: Any, omega1: float, y: Array, shaft: float | None = None) -> float:
    """Kinetic energy, J."""
    energy: float = kinetic_energy(d, y[0], omega1, y[1], y[2] if shaft is None else shaft)  # type: ignore[no-untyped-call]
    return energy


def _momentum(d: Any, omega1: float, y: Array) -> float:
    momentum: float = angular_momentum(d, y[0], omega1, y[1])  # type: ignore[no-untyped-call]
    return momentum


class Motion(NamedTuple):
    """Samples of the state at the output times, times of the switches, right-hand sides."""

    samples: Array
    switches: Array
    evaluations: int


def run(case: Case, data: Any, times: Array, integrate: Integrator, audit: Audit | None = None) -> Motion:
    """One run through the output times; the first of them is the beginning.

    Raises:
        RuntimeError: the integrator gives up, or events without end.
    """
    time, state, evaluations = float(times[0]), start_of(case), 0
    data.mode = chosen_mode(data, state)
    samples, switches = [state[None, :].copy()], list[float]()
    times = times[1:]
    while len(switches) < EVENTS_ALLOWED:
        found = integrate(data, time, state, times)
        evaluations += found.evaluations
        samples.append(found.samples)
        times = times[len(found.samples) :]
        if audit is not None:
            audit.add(data, (time, state), (found.time, found.state))
        time, state = found.time, found.state.copy()
        if found.guard is None:
            return Motion(np.concatenate(samples), np.array(switches), evaluations)
        switches.append(time)
        leave(data, state, found.guard)
    raise RuntimeError(f"more than {EVENTS_ALLOWED} events")


def measure(case: Case, make_integrator: Callable[[], Integrator]) -> Trajectory:
    """Run once with all samples, then, timed, without any: what an integrator costs is its own steps."""
    data, audit = data_of(case), Audit()
    motion = run(case, data, case.times, make_integrator(), audit)
    ends = case.times[[0, -1]]
    integrate = make_integrator()
    wall_time = median_time(lambda: run(case, data, ends, integrate))
    q, omega2, omega3 = motion.samples.T
    return Trajectory(
        time=case.times,
        drive_angle=q,
        omega2=omega2,
        omega_out=omega3,
        switches=motion.switches,
        evaluations=motion.evaluations,
        energy_residual=audit.residual,
        wall_time=wall_time,
        number_of_switches=len(motion.switches),
    )
