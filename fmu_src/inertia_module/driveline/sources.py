"""Discrete-time systems (Sampled), and signals over time: constants and tables."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import must_be

__all__ = ["Sampled", "Table", "source"]


class Table:
    """Piecewise linear quantity, constant before the first and after the last point.

    Two equal points are a step; at the step the second value holds.

    Args:
        points: Points in ascending order: times, s, or distances, m; shape (n,), n >= 1.
        values: Values at the points, shape (n,).

    Raises:
        ValueError: The points decrease, the shapes differ, or a number is not finite.
    """

    def __init__(self, points: ArrayLike, values: ArrayLike) -> None:
        self.points = np.asarray(points, dtype=np.float64)
        self.values = np.asarray(values, dtype=np.float64)
        if self.points.ndim != 1 or self.points.shape != self.values.shape or self.points.size == 0:
            sizes = f"{self.points.size} points and {self.values.size} values"
            raise ValueError(f"a table must have one value for each point, and at least one (got {sizes})")
        for number in (*self.points, *self.values):
            if not np.isfinite(number):
                raise ValueError(must_be("numbers of a table", "finite", number))
        backward = np.flatnonzero(np.diff(self.points) < 0.0)
        if backward.size:
            before, after = self.points[backward[0] : backward[0] + 2]
            allowed = "increasing, or equal for a step"
            raise ValueError(must_be("points of a table", allowed, f"{after:g} after {before:g}"))
        self.lists: tuple[list[float], list[float]] = self.points.tolist(), self.values.tolist()

    def __call__(self, points: float | NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values at points, any shape."""
        return np.asarray(np.interp(points, self.points, self.values))


Signal = float | Table


def evaluate(signal: Signal, point: float) -> float:
    """Return the value of a constant or table at a point.

    Args:
        signal: Constant or table.
        point: Time, s, or distance, m.
    """
    return between(*signal.lists, point) if isinstance(signal, Table) else signal


def between(points: Sequence[float], values: Sequence[float], point: float) -> float:
    """Interpolate linearly at one point, constant beyond the ends; ten times faster than numpy.interp.

    Args:
        points: Points in ascending order, length n.
        values: Values at the points, length n.
        point: The point.
    """
    n = bisect_right(points, point)
    if n == 0 or n == len(points):
        return values[max(n - 1, 0)]
    slope = (values[n] - values[n - 1]) / (points[n] - points[n - 1])
    return slope * (point - points[n - 1]) + values[n - 1]


class Sampled:
    """Discrete-time system: one part of the environment of an FMU, or the whole environment.

    Args:
        name: Name of the system.
        step: Step, s.
        inputs: Names of the inputs.
        outputs: Names of the outputs.
        law: Function of time, s, states and inputs that returns outputs and next states.
        states: Names of the states.

    Attributes:
        name: Name, as in python-control.
        dt: Step, s, as in python-control.
        nstates: Number of states, as in python-control.
        input_labels: Names of the inputs, as in python-control.
        output_labels: Names of the outputs, as in python-control.
        state_labels: Names of the states, as in python-control.
        law: Function of time, s, states and inputs that returns outputs and next states.
    """

    def __init__(
        self,
        name: str,
        step: float,
        inputs: Sequence[str],
        outputs: Sequence[str],
        law: Callable[[float, Any, Any], tuple[Sequence[float], Sequence[float]]],
        states: Sequence[str] = (),
    ) -> None:
        self.name, self.dt, self.law = name, step, law
        self.input_labels, self.output_labels = list(inputs), list(outputs)
        self.state_labels, self.nstates = list(states), len(states)

    def output(self, time: float, x: Any, u: Any) -> Sequence[float]:
        """Return the outputs.

        Args:
            time: Time, s.
            x: States.
            u: Inputs.
        """
        return self.law(time, x, u)[0]

    def dynamics(self, time: float, x: Any, u: Any) -> Sequence[float]:
        """Return the states after a step.

        Args:
            time: Time of the inputs, s.
            x: States.
            u: Inputs.
        """
        return self.law(time, x, u)[1]

    def to_control(self) -> Any:
        """Return the system as a discrete-time control.NonlinearIOSystem."""
        import control as ct  # the import takes as long as a run

        return ct.nlsys(
            (lambda time, x, u, _: self.dynamics(time, x, u)) if self.nstates else None,
            lambda time, x, u, _: self.output(time, x, u),
            inputs=self.input_labels,
            outputs=self.output_labels,
            states=self.state_labels or None,
            dt=self.dt,
            name=self.name,
        )


class Sources(Sampled):
    """Signals over time as a system without inputs.

    Args:
        signals: Constants, or tables over time, s, by name.
        step: Communication step, s.
    """

    def __init__(self, signals: Mapping[str, Signal], step: float) -> None:
        self.signals = dict(signals)
        values = self.signals.values()
        super().__init__(
            "_".join([*signals, "source"]),
            step,
            (),
            list(signals),
            lambda time, *_: ([evaluate(signal, time) for signal in values], ()),
        )

    def table(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the signals at times.

        Args:
            times: Times, s, shape (n,).

        Returns:
            Values, shape (n, signals).
        """
        signals = self.signals.values()
        return np.column_stack(
            [
                signal(times) if isinstance(signal, Table) else np.full(times.size, signal)
                for signal in signals
            ]
        )


def source(name: str, signal: Signal, step: float) -> Sources:
    """Make a system whose only output is a signal over time.

    Args:
        name: Name of the output.
        signal: Constant, or table over time, s.
        step: Communication step, s.
    """
    return Sources({name: signal}, step)
