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

from ..harness.fmu import Fmu

Array = NDArray[np.float64]

# frequencies at which a loop is looked at, and the lowest, as a share of the Nyquist frequency
_POINTS = 4000
_LOWEST = 1e-4
# margins are looked for within these shares of the expected one, to this relative width
_WITHIN, _SHARE = np.array([0.5, 2.0]), 0.02
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
        surrounding: around it, of deviations: control.StateSpace in discrete time, inputs named as outputs of
            the FMU and outputs as inputs of it, without direct feedthrough (D = 0).
        point: values at the operating point of all signals between both.
        kick: state of the surrounding at the start, shape (states,).
        limits: of what the surrounding gives to the FMU.
        expected: by predicted_margins; looked for from half to twice of them, to 2 %.

    Returns:
        The margins found, with the crossover expected.

    Raises:
        ValueError: a margin is not within half and twice of the expected one, the surrounding has direct
            feedthrough, or a signal has no value in point.
    """
    if np.any(surrounding.D):
        raise ValueError("a surrounding must have D = 0, has direct feedthrough")
    measured, fed = list(surrounding.input_labels), list(surrounding.output_labels)
    missing = [name for name in (*measured, *fed) if name not in point]
    if missing:
        raise ValueError(f"point must have {', '.join([*measured, *fed])}, is without {', '.join(missing)}")
    a, b, c = (np.asarray(matrix) for matrix in (surrounding.A, surrounding.B, surrounding.C))
    around, offset = np.array([point[name] for name in measured]), np.array([point[name] for name in fed])
    step = float(surrounding.dt)
    steps = round(_PERIODS * 2.0 * math.pi / expected.crossover / step)
    begin = fmu.get_state()

    def swings(factor: float = 1.0, delay: int = 0) -> tuple[float, float]:
        """RMS of the second and the last quarter of a run, each about its mean and drift.

        What is measured reaches the surrounding times the factor, late by delay steps. Infinite where what
        the surrounding gives leaves the limits.
        """
        fmu.set_state(begin)
        state, first = np.array(kick, dtype=float), np.empty(steps + 1)
        under_way = deque([np.zeros(len(measured))] * delay)
        for n in range(steps + 1):
            deviation = np.array(fmu.read(measured)) - around
            first[n] = deviation[0]
            if n == steps:
                break
            values = (offset + c @ state).tolist()
            if not all(limits[0] <= value <= limits[1] for value in values):
                return 0.0, math.inf
            fmu.set(**dict(zip(fed, values, strict=True)))
            fmu.advance(step)
            under_way.append(factor * deviation)
            state = a @ state + b @ under_way.popleft()
        quarter = first.size // 4
        early, late = (first[n * quarter : (n + 1) * quarter] for n in (1, 3))
        return float(np.std(detrend(early))), float(np.std(detrend(late)))

    ripple = _RIPPLE * swings()[1]

    def settles(factor: float = 1.0, delay: float = 0.0) -> bool:
        early, late = swings(factor, round(delay))
        return late < max(early, ripple)

    try:
        gain = _stability_limit(settles, *(expected.gain * _WITHIN))
        late = _stability_limit(lambda delay: settles(delay=delay), *(expected.delay / step * _WITHIN))
    finally:
        fmu.set_state(begin)
        fmu.free_state(begin)
    return Margins(gain, late * step, expected.crossover)


def _stability_limit(is_stable: Callable[[float], bool], low: float, high: float) -> float:
    """Value between low (stable) and high (not) where stability ends, by bisection in the logarithm."""
    for value, wanted in ((low, True), (high, False)):
        if is_stable(value) != wanted:
            raise ValueError(
                f"limits must be a stable and an unstable one, are {low:g} and {high:g}: {value:g} is not"
                f" {'stable' if wanted else 'unstable'}"
            )
    while high > low * (1.0 + _SHARE):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return math.sqrt(low * high)
