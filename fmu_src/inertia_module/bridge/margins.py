"""Stability margins of a loop around an FMU: predicted from its linearisation, and measured on the FMU.

Around the FMU stands a linear surrounding (controller, actuator, sensor). It works on deviations from an
operating point, so one control.StateSpace says it all; the FMU is the full nonlinear plant. The loop is made
worse where the plant is measured: the gain margin is the factor, the delay margin the delay, at which the
motion after a kick no longer dies away. The phase margin is the delay margin times the crossover frequency.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import control as ct
import numpy as np
from numpy.typing import NDArray
from scipy.signal import detrend

from ..harness.fmu import Fmu, Plant

Array = NDArray[np.float64]

# frequencies at which a loop is looked at, and the lowest, as a share of the Nyquist frequency
_POINTS = 4000
_LOWEST = 1e-4
# relative width at which the search for a margin stops
_SHARE = 0.02
# periods of the expected crossover that a run lasts
_PERIODS = 10.0
# swings that the pulses leave, times this, count as settled
_RIPPLE = 2.0


@dataclass(frozen=True)
class Margins:
    """Margins of a loop: gain (factor), delay, s, and the crossover frequency, rad/s."""

    gain: float
    delay: float
    crossover: float

    @property
    def phase(self) -> float:
        """Phase margin, degrees."""
        return math.degrees(self.delay * self.crossover)


def predicted_margins(loop: Any) -> Margins:
    """Compute the margins of a linear discrete-time loop (1 x 1, of negative feedback) by control.margin."""
    step = float(loop.dt)
    frequency = np.geomspace(_LOWEST, 0.999, _POINTS) * math.pi / step
    response = loop(np.exp(1j * frequency * step))
    gain, phase, _, crossover = ct.margin(ct.frd(response, frequency))
    return Margins(float(gain), math.radians(phase) / float(crossover), float(crossover))


def run_linear_loop(
    plant: Plant,
    surrounding: Any,
    point: Mapping[str, float],
    kick: Sequence[float],
    steps: int,
    *,
    factor: float = 1.0,
    delay: int = 0,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> Array:
    """Step a plant inside a linear discrete-time surrounding of deviations.

    Args:
        plant: started at the operating point.
        surrounding: control.StateSpace in discrete time; inputs are named as outputs of the plant and
            outputs as inputs of it; what it gives depends on its state only (D = 0).
        point: values at the operating point of all these names.
        kick: state of the surrounding at the start, shape (states,).
        steps: number of steps of the surrounding's dt.
        factor: by which deviations reach the surrounding.
        delay: steps by which they come late.
        limits: of what it gives to the plant; the run ends where it leaves them.

    Returns:
        Deviations of what is measured, shape (steps + 1, inputs of the surrounding), or fewer rows.

    Raises:
        ValueError: the surrounding has direct feedthrough, or a signal has no value in point.
    """
    if np.any(surrounding.D):
        raise ValueError("a surrounding must have D = 0, has direct feedthrough")
    measured, fed = list(surrounding.input_labels), list(surrounding.output_labels)
    missing = [name for name in (*measured, *fed) if name not in point]
    if missing:
        raise ValueError(f"point must have {', '.join([*measured, *fed])}, is without {', '.join(missing)}")
    a, b, c = (np.asarray(matrix) for matrix in (surrounding.A, surrounding.B, surrounding.C))
    around, offset = np.array([point[name] for name in measured]), np.array([point[name] for name in fed])
    low, high = limits
    state = np.array(kick, dtype=float)
    rows = np.empty((steps + 1, len(measured)))
    under_way = deque([np.zeros(len(measured))] * delay)
    for n in range(steps + 1):
        rows[n] = np.array(plant.read(measured)) - around
        values = (offset + c @ state).tolist()
        if n == steps or not all(low <= value <= high for value in values):
            return rows[: n + 1]
        plant.set(**dict(zip(fed, values, strict=True)))
        plant.advance(float(surrounding.dt))
        under_way.append(factor * rows[n])
        state = a @ state + b @ under_way.popleft()
    return rows


def swings(deviation: Array) -> tuple[float, float]:
    """Compute the RMS of the second and of the last quarter of a record, each about its mean and drift.

    Args:
        deviation: shape (n,), n at least 16.
    """
    quarter = deviation.size // 4
    early, late = deviation[quarter : 2 * quarter], deviation[3 * quarter : 4 * quarter]
    return float(np.std(detrend(early))), float(np.std(detrend(late)))


def measured_margins(
    fmu: Fmu,
    surrounding: Any,
    point: Mapping[str, float],
    kick: Sequence[float],
    expected: Margins,
    *,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> Margins:
    """Measure the margins of the loop around an FMU: it is made worse until a kick grows on, by bisection.

    A loop counts as settled if its first measured signal swings less at the end than early on, or no more
    than twice what the pulses leave in the loop as it is; as unstable also if it leaves the limits.

    Args:
        fmu: started at the operating point; it is left there.
        surrounding: around it, of deviations; see run_linear_loop.
        point: values at the operating point of all signals between both.
        kick: state of the surrounding at the start.
        limits: of what the surrounding gives to the FMU.
        expected: by predicted_margins; looked for from half to twice of them, to 2 %.

    Returns:
        The margins found, with the crossover expected.

    Raises:
        ValueError: a margin is not within half and twice of the expected one.
    """
    step = float(surrounding.dt)
    steps = round(_PERIODS * 2.0 * math.pi / expected.crossover / step)
    begin = fmu.get_state()

    def swing(**worse: Any) -> tuple[float, float]:
        fmu.set_state(begin)
        rows = run_linear_loop(fmu, surrounding, point, kick, steps, limits=limits, **worse)
        return swings(rows[:, 0]) if len(rows) > steps else (0.0, math.inf)

    ripple = _RIPPLE * swing()[1]

    def settles(**worse: Any) -> bool:
        early, late = swing(**worse)
        return late < max(early, ripple)

    try:
        gain = stability_limit(
            lambda factor: settles(factor=factor), 0.5 * expected.gain, 2.0 * expected.gain, _SHARE
        )
        late = expected.delay / step
        late = stability_limit(lambda n: settles(delay=round(n)), 0.5 * late, 2.0 * late, _SHARE)
    finally:
        fmu.set_state(begin)
        fmu.free_state(begin)
    return Margins(gain, late * step, expected.crossover)


def stability_limit(is_stable: Callable[[float], bool], low: float, high: float, share: float) -> float:
    """Find the value between low (stable) and high (not) where stability ends, by bisection in the logarithm.

    Args:
        is_stable: of a value. low, high: positive. share: relative width at which to stop.

    Raises:
        ValueError: low is not stable, or high is.
    """
    for value, wanted in ((low, True), (high, False)):
        if is_stable(value) != wanted:
            raise ValueError(
                f"limits must be a stable and an unstable one, are {low:g} and {high:g}: {value:g} is not"
                f" {'stable' if wanted else 'unstable'}"
            )
    while high > low * (1.0 + share):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return math.sqrt(low * high)
