"""Signals over time, as constants and tables, and systems whose outputs are signals."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import must_be

if TYPE_CHECKING:
    from .discrete_system import DiscreteSystem

__all__ = ["Sources", "Table", "source"]


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
    return interpolate(*signal.lists, point) if isinstance(signal, Table) else signal


def interpolate(points: Sequence[float], values: Sequence[float], point: float) -> float:
    """Interpolate linearly at one point, constant beyond the ends; ten times as fast as numpy.interp.

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


class Sources:
    """Signals over time by name, which do not depend on the FMU: a whole environment, or one of its systems.

    This class does not import python-control, so a scene without a closed loop starts quickly.

    Args:
        signals: Constants, or tables over time, s, by name.
        step: Communication step, s.

    Attributes:
        signals: Constants, or tables over time, s, by name.
        dt: Step, s, as in python-control.
        nstates: 0, as in python-control.
        input_labels: Empty list, as in python-control.
        output_labels: Names of the signals, as in python-control.
        name: Name, as in python-control.
    """

    nstates = 0

    def __init__(self, signals: Mapping[str, Signal], step: float) -> None:
        self.signals, self.dt, self.name = dict(signals), step, "_".join([*signals, "source"])
        self.input_labels: list[str] = []
        self.output_labels = list(signals)

    def law(self, time: float, _: Sequence[float], __: Sequence[float]) -> tuple[list[float], tuple[()]]:
        """Return the signals at a time, and no states.

        Args:
            time: Time, s.
            _: States: none.
            __: Inputs: none.
        """
        return [evaluate(signal, time) for signal in self.signals.values()], ()

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

    def system(self) -> DiscreteSystem:
        """Return the signals as a system of python-control without inputs and states."""
        from .discrete_system import DiscreteSystem

        return DiscreteSystem(self.name, self.dt, (), self.output_labels, self.law)


def source(name: str, signal: Signal, step: float) -> DiscreteSystem:
    """Make a system of python-control whose only output is a signal over time.

    Args:
        name: Name of the output.
        signal: Constant, or table over time, s.
        step: Communication step, s.
    """
    return Sources({name: signal}, step).system()
