"""Stability margins measured on an FMU: a linear surrounding is closed around it, and the loop made worse.

The surrounding (controller, actuator, sensor) works on deviations from an operating point, so one
control.StateSpace says it all; the FMU is the full nonlinear plant. The gain margin is the factor, the delay
margin the delay, at which what a kick has started no longer dies away.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..instance import Plant

Array = NDArray[np.float64]


def run_linear_loop(
    plant: Plant,
    surrounding: Any,
    point: Mapping[str, float],
    kick: Sequence[float],
    steps: int,
    limits: tuple[float, float] = (0.0, math.inf),
) -> Array:
    """Step a plant inside a linear discrete-time surrounding of deviations.

    Args:
        plant: started at the operating point.
        surrounding: control.StateSpace in discrete time; inputs are named as outputs of the plant and
            outputs as inputs of it; what it gives depends on its state only (D = 0).
        point: values at the operating point of all these names.
        kick: state of the surrounding at the start, shape (states,).
        steps: number of steps of the surrounding's dt.
        limits: of what it gives to the plant; the run ends where it leaves them.

    Returns:
        Deviations of what is measured, shape (steps + 1, inputs of the surrounding), or fewer rows.

    Raises:
        ValueError: the surrounding has direct feedthrough, or a signal without a value in point.
    """
    if np.any(surrounding.D):
        raise ValueError("a surrounding with direct feedthrough is refused: allowed is one with D = 0")
    measured, given = list(surrounding.input_labels), list(surrounding.output_labels)
    missing = [name for name in (*measured, *given) if name not in point]
    if missing:
        raise ValueError(
            f"point without {', '.join(missing)} is refused: needed are {', '.join([*measured, *given])}"
        )
    a, b, c = (np.asarray(matrix) for matrix in (surrounding.A, surrounding.B, surrounding.C))
    around, offset = np.array([point[name] for name in measured]), np.array([point[name] for name in given])
    state = np.array(kick, dtype=float)
    rows = np.empty((steps + 1, len(measured)))
    low, high = limits
    for n in range(steps + 1):
        rows[n] = np.array(plant.read(measured)) - around
        values = (offset + c @ state).tolist()
        if n == steps or not all(low <= value <= high for value in values):
            return rows[: n + 1]
        plant.set(**dict(zip(given, values, strict=True)))
        plant.advance(float(surrounding.dt))
        state = a @ state + b @ rows[n]
    return rows


def swings(deviation: Array) -> tuple[float, float]:
    """RMS of the second and of the last quarter of a record, each about its mean and drift.

    Args:
        deviation: shape (n,), n at least 16.
    """
    quarter = deviation.size // 4
    time = np.arange(quarter, dtype=float)

    def swing(part: Array) -> float:
        left = part - np.polyval(np.polyfit(time, part, 1), time)
        return float(np.sqrt(np.mean(left**2)))

    return swing(deviation[quarter : 2 * quarter]), swing(deviation[3 * quarter : 4 * quarter])


def stability_limit(is_stable: Callable[[float], bool], low: float, high: float, share: float) -> float:
    """Value between low (stable) and high (not) at which stability ends, by bisection in the logarithm.

    Args:
        is_stable: of a value. low, high: positive. share: relative width at which to stop.

    Raises:
        ValueError: low is not stable, or high is.
    """
    for value, wanted in ((low, True), (high, False)):
        if is_stable(value) != wanted:
            word = "stable" if wanted else "unstable"
            raise ValueError(f"limits {low:g} to {high:g} are refused: {value:g} is not {word}; allowed are"
                             " a stable and an unstable one")  # fmt: skip
    while high > low * (1.0 + share):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return math.sqrt(low * high)
