"""Signals given over time: constants and tables, as systems without input."""

from __future__ import annotations

from typing import Any

import control as ct
import numpy as np
from numpy.typing import ArrayLike


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

    def __call__(self, point: float) -> float:
        """Value at a point."""
        return float(np.interp(point, self.points, self.values))


Signal = float | Table


def evaluate(signal: Signal, point: float) -> float:
    """Value of a constant or a table at a point (time, s, or distance, m)."""
    return signal(point) if isinstance(signal, Table) else signal


def source(name: str, signal: Signal, step: float) -> Any:
    """A system without input that gives a signal over time.

    Args:
        name: of its output. signal: constant, or table over time, s.
        step: communication step, s.

    Returns:
        A static discrete-time control.NonlinearIOSystem.
    """

    def output(time: float, *_: Any) -> list[float]:
        return [evaluate(signal, time)]

    return ct.nlsys(None, output, inputs=0, outputs=[name], dt=step, name=f"{name}_source")
