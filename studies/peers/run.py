"""A run with someone else's integrator, from event to event or with clutches, and its energy audit."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from inertia_module.fidelity.timing import median_time
from inertia_module.kernel import codes
from inertia_module.kernel.contact import TORQUE_ROUNDING, select_mode
from inertia_module.kernel.links import angular_momentum, kinetic_energy

from ..reference.geometry import Array
from ..reference.trajectory import Case, Trajectory
from .equations import CLUTCHES, LINK2, OUTPUT, data_of, start_of

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
    """Contact mode of the complementarity problem at constant input speed and load, or CLUTCHES."""
    if data.stiffness > 0.0:
        return CLUTCHES
    q, omega2, omega3 = state
    zero = TORQUE_ROUNDING
    mode: float = select_mode(data.d, q, data.omega1, omega2, omega3, 0.0, data.load, 0.0, zero)  # type: ignore[no-untyped-call]
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


def unbalanced(data: Any, begin: tuple[float, Array], end: tuple[float, Array]) -> float:
    """Energy that a segment from (time, state) to (time, state) leaves open, J: input - output - stored.

    While link 2 is held the input works into the kinetic energy only; else M1 - Tc is the rate of
    the angular momentum P of links 1, 2 and the imbalances, and Tc - load that of the shaft's.
    """
    d, omega1, load = data.d, data.omega1, data.load
    (t0, y0), (t1, y1) = begin, end
    time = t1 - t0

    def energy(y: Array, omega3: float) -> float:
        return float(kinetic_energy(d, y[0], omega1, y[1], omega3))  # type: ignore[no-untyped-call]

    def momentum(y: Array) -> float:
        return float(angular_momentum(d, y[0], omega1, y[1]))  # type: ignore[no-untyped-call]

    if data.mode in (codes.HELD, codes.HELD_DRIVING):
        work = energy(y1, 0.0) - energy(y0, 0.0)
    else:
        work = omega1 * (momentum(y1) - momentum(y0))
    if data.mode == codes.DRIVING:
        work += omega1 * (d.J3 * (y1[2] - y0[2]) + load * time)
        turned = omega1 * time - (y1[0] - y0[0]) / d.k
    else:
        turned = 0.5 * (y0[2] + y1[2]) * time
    return float(work - load * turned - energy(y1, y1[2]) + energy(y0, y0[2]))


class Motion(NamedTuple):
    """Samples at the output times, times of the switches, right-hand sides, energy left open, J."""

    samples: Array
    switches: Array
    evaluations: int
    residual: float


def run(case: Case, data: Any, times: Array, integrate: Integrator) -> Motion:
    """One run through the output times; the first of them is the beginning.

    Raises:
        RuntimeError: the integrator gives up, or events without end.
    """
    time, state, evaluations, residual = float(times[0]), start_of(case), 0, 0.0
    data.mode = chosen_mode(data, state)
    samples, switches = [state[None, :].copy()], list[float]()
    times = times[1:]
    while len(switches) < EVENTS_ALLOWED:
        found = integrate(data, time, state, times)
        evaluations += found.evaluations
        samples.append(found.samples)
        times = times[len(found.samples) :]
        residual += unbalanced(data, (time, state), (found.time, found.state))
        time, state = found.time, found.state.copy()
        if found.guard is None:
            return Motion(np.concatenate(samples), np.array(switches), evaluations, residual)
        switches.append(time)
        leave(data, state, found.guard)
    raise RuntimeError(f"more than {EVENTS_ALLOWED} events")


def measure(case: Case, integrate: Integrator, stiffness: float | None) -> Trajectory:
    """Run once with all samples, then, timed, to the end alone: what an integrator costs is its own steps.

    Args:
        case: what is run. integrate: goes through one mode. stiffness: of clutches, or None (see data_of).
    """
    data = data_of(case, stiffness)
    motion = run(case, data, case.times, integrate)
    q, omega2, omega3 = motion.samples.T
    by_events = stiffness is None
    return Trajectory(
        time=case.times,
        drive_angle=q,
        omega2=omega2,
        omega_out=omega3,
        switches=motion.switches if by_events else None,
        evaluations=motion.evaluations,
        energy_residual=motion.residual if by_events else None,
        wall_time=median_time(lambda: run(case, data, case.times[[0, -1]], integrate)),
        number_of_switches=len(motion.switches) if by_events else math.nan,
    )
