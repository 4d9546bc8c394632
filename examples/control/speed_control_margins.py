"""Stability margins of speed_control.py: computed for a linear loop, and measured with an FMU in the loop."""

import math
from collections import deque
from dataclasses import dataclass

import control as ct
import numpy as np
from scipy.signal import detrend

SEARCH_RANGE = np.array([0.5, 2.0])  # measured over expected margin
RELATIVE_WIDTH = 0.02  # at the end of the bisection


@dataclass(frozen=True)
class Margins:
    """Stability margins of a loop.

    Attributes:
        gain: Gain margin (factor).
        delay: Delay margin, s.
        crossover: Crossover frequency, rad/s.
    """

    gain: float
    delay: float
    crossover: float

    @property
    def phase(self):
        """Return the phase margin, degrees."""
        return math.degrees(self.delay * self.crossover)


def predicted_margins(loop):
    """Compute the margins of a linear discrete-time loop (1 x 1, negative feedback) with control.margin."""
    step = float(loop.dt)
    frequency = np.geomspace(1e-4, 0.999, 4000) * math.pi / step
    response = loop(np.exp(1j * frequency * step))
    gain, phase, _, crossover = ct.margin(ct.frd(response, frequency))
    return Margins(float(gain), math.radians(phase) / float(crossover), float(crossover))


def measured_margins(fmu, surrounding, point, kick, expected, limits):
    """Measure the margins of a loop with an FMU, by bisection.

    The measured signals are multiplied (gain margin) or delayed (delay margin) until an initial disturbance
    no longer decays. The loop is stable if the oscillation of the first measured signal is smaller at the end
    of a run than near its start, or at most twice the oscillation caused by the torque pulses. It is unstable
    if an input of the FMU leaves its limits.

    Args:
        fmu: FMU at the operating point, which is restored at the end.
        surrounding: Discrete-time control.StateSpace of all deviations around the FMU, without direct
            feedthrough (D = 0). Its inputs are outputs of the FMU, its outputs are inputs of the FMU.
        point: Values of these signals at the operating point, by name.
        kick: Initial state of the surrounding, shape (states,).
        expected: Margins by predicted_margins; the search covers half to twice these values.
        limits: Minimum and maximum of the inputs of the FMU.
    """
    measured, fed = list(surrounding.input_labels), list(surrounding.output_labels)
    a, b, c = (np.asarray(matrix) for matrix in (surrounding.A, surrounding.B, surrounding.C))
    steady_outputs = np.array([point[name] for name in measured])
    steady_inputs = np.array([point[name] for name in fed])
    step = float(surrounding.dt)
    # a run lasts ten periods of the crossover
    steps = round(20.0 * math.pi / expected.crossover / step)
    start = fmu.get_state()

    def early_and_late_rms(factor=1.0, delay=0):
        """Return the RMS of the first measured signal in the second and last quarter of a run, without drift.

        Args:
            factor: Factor on the measured signals.
            delay: Delay of the measured signals, steps.
        """
        fmu.set_state(start)
        state, first = np.array(kick, dtype=float), np.empty(steps + 1)
        delayed = deque([np.zeros(len(measured))] * delay)
        for n in range(steps + 1):
            deviation = np.array(fmu.read(measured)) - steady_outputs
            first[n] = deviation[0]
            if n == steps:
                break
            values = (steady_inputs + c @ state).tolist()
            if not all(limits[0] <= value <= limits[1] for value in values):
                return 0.0, math.inf
            fmu.set(**dict(zip(fed, values, strict=True)))
            fmu.advance(step)
            delayed.append(factor * deviation)
            state = a @ state + b @ delayed.popleft()
        quarter = first.size // 4
        early, late = (first[n * quarter : (n + 1) * quarter] for n in (1, 3))
        return float(np.std(detrend(early))), float(np.std(detrend(late)))

    max_ripple = 2.0 * early_and_late_rms()[1]

    def settles(factor=1.0, delay=0.0):
        early, late = early_and_late_rms(factor, round(delay))
        return late < max(early, max_ripple)

    try:
        gain = stability_limit(settles, *(expected.gain * SEARCH_RANGE))
        late = stability_limit(lambda delay: settles(delay=delay), *(expected.delay / step * SEARCH_RANGE))
    finally:
        fmu.set_state(start)
    return Margins(gain, late * step, expected.crossover)


def stability_limit(is_stable, low, high):
    """Find the value at which stability ends, by bisection of the logarithm.

    Args:
        is_stable: Function that returns True if the loop is stable at a value.
        low: Value at which the loop is stable.
        high: Value at which the loop is unstable.
    """
    for value, expected, text in ((low, True, "stable"), (high, False, "unstable")):
        if is_stable(value) != expected:
            raise ValueError(f"the loop must be {text} at {value:g} (limits: {low:g} and {high:g})")
    while high > low * (1.0 + RELATIVE_WIDTH):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return math.sqrt(low * high)
