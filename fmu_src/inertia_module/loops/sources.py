"""Signals given over time: constants and tables, as surroundings without input; other surroundings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Table", "source"]


class Table:
    """A quantity given at points, linear in between; beyond the ends the end values are held.

    Args:
        points: at least one, strictly increasing: time, s, or distance, m.
        values: as many.

    Raises:
        ValueError: the points do not increase, or points and values differ in number.
    """

    def __init__(self, points: ArrayLike, values: ArrayLike) -> None:
        self.points = np.asarray(points, dtype=np.float64)
        self.values = np.asarray(values, dtype=np.float64)
        if self.points.ndim != 1 or self.points.shape != self.values.shape or self.points.size == 0:
            raise ValueError(
                "a table must have one value a point, and at least one, has"
                f" {self.points.size} points and {self.values.size} values"
            )
        for number in (*self.points, *self.values):
            if not np.isfinite(number):
                raise ValueError(f"numbers of a table must be finite, one is {number}")
        backward = np.flatnonzero(np.diff(self.points) <= 0.0)
        if backward.size:
            before, after = self.points[backward[0] : backward[0] + 2]
            raise ValueError(f"points of a table must increase, {after:g} comes after {before:g}")

    def __call__(self, points: float | NDArray[np.float64]) -> NDArray[np.float64]:
        """Values at points, or the value at one."""
        return np.asarray(np.interp(points, self.points, self.values))


Signal = float | Table


def evaluate(signal: Signal, point: float) -> float:
    """Value of a constant or a table at a point (time, s, or distance, m)."""
    return float(signal(point)) if isinstance(signal, Table) else signal


def sampled(
    name: str,
    step: float,
    inputs: Sequence[str],
    outputs: Sequence[str],
    law: Callable[[float, Any, Any], tuple[Any, Any]],
    states: Sequence[str] = (),
) -> Any:
    """A system in discrete time: a control.NonlinearIOSystem.

    Args:
        name: of it. step: s. inputs, outputs, states: their names.
        law: gives outputs and next states for a time, s, the states and the inputs.
    """
    import control as ct  # takes as long as a run without a loop

    return ct.nlsys(
        (lambda time, x, u, _: law(time, x, u)[1]) if states else None,
        lambda time, x, u, _: law(time, x, u)[0],
        inputs=list(inputs),
        outputs=list(outputs),
        states=list(states) or None,
        dt=step,
        name=name,
    )


class Sources:
    """Signals over time: they are all the surroundings of the FMU, or connect joins them to systems.

    A scene without a loop therefore runs without python-control.

    Args:
        signals: by name: constant, or table over time, s. step: communication step, s.

    Attributes:
        name, dt, nstates, input_labels, output_labels: as of a system of python-control.
    """

    nstates = 0

    def __init__(self, signals: Mapping[str, Signal], step: float) -> None:
        self.signals, self.dt = dict(signals), step
        self.input_labels: list[str] = []
        self.output_labels = list(self.signals)
        self.name = "_".join([*self.signals, "source"])

    def output(self, time: float, *_: Any) -> NDArray[np.float64]:
        """The signals at a time, s."""
        return np.array([evaluate(signal, time) for signal in self.signals.values()])

    def table(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """The signals at times, s, shape (times, signals)."""
        found = np.empty((times.size, len(self.signals)))
        for place, signal in enumerate(self.signals.values()):
            found[:, place] = signal(times) if isinstance(signal, Table) else signal
        return found

    def to_control(self) -> Any:
        """Convert it to a static discrete-time control.NonlinearIOSystem."""
        return sampled(self.name, self.dt, [], self.output_labels, lambda time, *_: (self.output(time), ()))


def source(name: str, signal: Signal, step: float) -> Sources:
    """One signal over time, to connect.

    Args:
        name: of its output. signal: constant, or table over time, s.
        step: communication step, s.
    """
    return Sources({name: signal}, step)
