"""Systems in discrete time by their laws; signals given over time: constants and tables, without input."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import must_be

__all__ = ["Sampled", "Table", "source"]


class Table:
    """A quantity at points, linear in between, constant before the first and after the last point.

    Two equal points are a step: from there on the later value holds.

    Args:
        points: at least one, not falling: time, s, or distance, m.
        values: as many.

    Raises:
        ValueError: the points fall, or points and values differ in number.
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
        """Values at points, or the value at one."""
        return np.asarray(np.interp(points, self.points, self.values))


Signal = float | Table


def evaluate(signal: Signal, point: float) -> float:
    """Value of a constant or a table at a point (time, s, or distance, m)."""
    return between(*signal.lists, point) if isinstance(signal, Table) else signal


def between(points: Sequence[float], values: Sequence[float], point: float) -> float:
    """Value at one point, linear in between, end values held: as numpy.interp, ten times faster."""
    n = bisect_right(points, point)
    if n == 0 or n == len(points):
        return values[max(n - 1, 0)]
    slope = (values[n] - values[n - 1]) / (points[n] - points[n - 1])
    return slope * (point - points[n - 1]) + values[n - 1]


class Sampled:
    """A system in discrete time by its law: a part of the surroundings of an FMU, or all of them.

    Args:
        name: of it. step: s. inputs, outputs, states: their names.
        law: gives outputs and next states for a time, s, the states and the inputs.

    Attributes:
        name, dt, nstates, input_labels, output_labels: as of a system of python-control.
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
        """The outputs at a time, s, for states and inputs."""
        return self.law(time, x, u)[0]

    def dynamics(self, time: float, x: Any, u: Any) -> Sequence[float]:
        """The states a step after a time, s, for states and inputs."""
        return self.law(time, x, u)[1]

    def to_control(self) -> Any:
        """Convert it to a discrete-time control.NonlinearIOSystem."""
        import control as ct  # takes as long as a run

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
    """Signals over time: a system without inputs.

    Args:
        signals: by name: constant, or table over time, s. step: communication step, s.
    """

    def __init__(self, signals: Mapping[str, Signal], step: float) -> None:
        self.signals = dict(signals)
        given = self.signals.values()
        super().__init__(
            "_".join([*signals, "source"]),
            step,
            (),
            list(signals),
            lambda time, *_: ([evaluate(signal, time) for signal in given], ()),
        )

    def table(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """The signals at times, s, shape (times, signals)."""
        given = self.signals.values()
        return np.column_stack(
            [one(times) if isinstance(one, Table) else np.full(times.size, one) for one in given]
        )


def source(name: str, signal: Signal, step: float) -> Sources:
    """One signal over time, to connect.

    Args:
        name: of its output. signal: constant, or table over time, s.
        step: communication step, s.
    """
    return Sources({name: signal}, step)
