"""Smooth arcs of a motion, by SciPy: from one event to the next."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from .trajectory import Array

# rad of the highest harmonic in a step, and parts of it at whose ends the search for events looks
PHASE, LOOKED_AT = 0.5, 8
# closeness to the bottom of a dip between two looks, of their distance
DIP = 1e-6
Interval = tuple[float, float]


@dataclass(frozen=True)
class Arc:
    """What is followed while no guard ends it.

    Attributes:
        rates: of (time, state). guards: of a state, all of them: the first to fall through zero ends the arc.
        longest: step, s. relative, absolute: tolerances of the state.
    """

    rates: Callable[[float, Array], Array]
    guards: Callable[[Array], Array]
    longest: float
    relative: float
    absolute: float


def follow(arc: Arc, begin: float, state: Array, end: float) -> tuple[float, Array, int | None]:
    """Follow an arc up to a time or to its end: (time, state, number of the guard that ended it).

    Raises:
        ArithmeticError: the integrator gives up.
    """
    solver = _solver(arc, begin, state, end)
    while solver.status == "running":
        before = solver.t, solver.y
        _step(solver)
        path = solver.dense_output()
        events = _events(path, arc.guards, np.linspace(solver.t_old, solver.t, LOOKED_AT + 1))
        if events:
            # the inside of a step is less accurate than its end
            time, first = min(events)
            solver = _solver(arc, *before, time)
            while solver.status == "running":
                _step(solver)
            return time, solver.y, first
    return end, solver.y, None


def _solver(arc: Arc, begin: float, state: Array, end: float) -> DOP853:
    return DOP853(
        arc.rates,
        begin,
        state,
        end,
        rtol=arc.relative,
        atol=arc.absolute,
        max_step=arc.longest,
        # the error estimate changes its sign: a step far too long, SciPy's first, may pass by chance
        first_step=min(0.1 * arc.longest, end - begin) or None,
    )


def _step(solver: DOP853) -> None:
    message = solver.step()
    if solver.status == "failed":
        raise ArithmeticError(f"DOP853 gave up at {solver.t:g} s: {message}")


def _falls(value: Callable[[float], float], times: Array, looked: Array) -> list[Interval]:
    """Intervals from a time at which value is positive to one at which it is not.

    It is looked at at these times; between two of them only where their neighbours let a dip below zero be.
    """
    falls = []
    for n, (here, after) in enumerate(itertools.pairwise(looked)):
        left, right = (float(time) for time in times[n : n + 2])
        if here > 0.0 >= after:
            falls.append((left, right))
        before, beyond = looked[max(n - 1, 0)], looked[n + 2 : n + 3]
        sinks, rises = n == 0 or 2.0 * here < before, not beyond.size or 2.0 * after < beyond[0]
        if min(here, after) > 0.0 and sinks and rises:
            closeness = {"xatol": DIP * (right - left)}
            lowest = minimize_scalar(value, bounds=(left, right), method="bounded", options=closeness)
            if lowest.fun <= 0.0:
                falls.append((left, float(lowest.x)))
    return falls


def _events(
    path: Callable[[float | Array], Array], guards: Callable[[Array], Array], times: Array
) -> list[tuple[float, int]]:
    """Times at which guards fall through zero on the path of a step, and their numbers."""
    found = []
    for guard, looked in enumerate(np.array([guards(y) for y in path(times).T]).T):

        def value(t: float, guard: int = guard) -> float:
            return float(guards(path(t))[guard])

        for fall in _falls(value, times, looked)[:1]:
            found.append((float(brentq(value, *fall, xtol=1e-16)), guard))
    return found
