"""Margins of stability of speed_control.py: of a linear loop, and measured on the loop around an FMU."""

import math
from collections import deque
from dataclasses import dataclass

import control as ct
import numpy as np
from scipy.signal import detrend

# margins are looked for within these shares of the expected one, to this relative width
WITHIN, SHARE = np.array([0.5, 2.0]), 0.02


@dataclass(frozen=True)
class Margins:
    """Margins of a loop: gain (factor), delay, s, and the crossover frequency, rad/s."""

    gain: float
    delay: float
    crossover: float

    @property
    def phase(self):
        """Phase margin, degrees."""
        return math.degrees(self.delay * self.crossover)


def predicted_margins(loop):
    """Compute the margins of a linear discrete-time loop (1 x 1, of negative feedback) by control.margin."""
    step = float(loop.dt)
    frequency = np.geomspace(1e-4, 0.999, 4000) * math.pi / step
    response = loop(np.exp(1j * frequency * step))
    gain, phase, _, crossover = ct.margin(ct.frd(response, frequency))
    return Margins(float(gain), math.radians(phase) / float(crossover), float(crossover))


def measured_margins(fmu, surrounding, point, kick, expected, limits):
    """Measure the margins of the loop around an FMU: it is made worse until a kick grows on, by bisection.

    What is measured is multiplied (gain margin) or delayed (delay margin). A loop counts as settled if its
    first measured signal swings less at the end than early on, or no more than twice what the pulses leave in
    the loop as it is; as unstable also if it leaves the limits.

    fmu: started at the operating point; it is left there.
    surrounding: around it, of deviations: control.StateSpace in discrete time, inputs named as outputs of
        the FMU and outputs as inputs of it, without direct feedthrough (D = 0).
    point: values at the operating point of all signals between both.
    kick: state of the surrounding at the start, shape (states,).
    expected: by predicted_margins; looked for from half to twice of them.
    limits: of what the surrounding gives to the FMU.
    """
    measured, fed = list(surrounding.input_labels), list(surrounding.output_labels)
    a, b, c = (np.asarray(matrix) for matrix in (surrounding.A, surrounding.B, surrounding.C))
    around, offset = np.array([point[name] for name in measured]), np.array([point[name] for name in fed])
    step = float(surrounding.dt)
    # a run lasts ten periods of the crossover
    steps = round(20.0 * math.pi / expected.crossover / step)
    begin = fmu.get_state()

    def swings(factor=1.0, delay=0):
        """RMS of the second and the last quarter of a run, each about its mean and drift.

        What is measured reaches the surrounding times the factor, late by delay steps.
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

    ripple = 2.0 * swings()[1]

    def settles(factor=1.0, delay=0.0):
        early, late = swings(factor, round(delay))
        return late < max(early, ripple)

    try:
        gain = stability_limit(settles, *(expected.gain * WITHIN))
        late = stability_limit(lambda delay: settles(delay=delay), *(expected.delay / step * WITHIN))
    finally:
        fmu.set_state(begin)
    return Margins(gain, late * step, expected.crossover)


def stability_limit(is_stable, low, high):
    """Value between low (stable) and high (not) where stability ends, by bisection in the logarithm."""
    for value, wanted in ((low, True), (high, False)):
        if is_stable(value) != wanted:
            raise ValueError(
                f"limits must be a stable and an unstable one, are {low:g} and {high:g}: {value:g} is not"
                f" {'stable' if wanted else 'unstable'}"
            )
    while high > low * (1.0 + SHARE):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return math.sqrt(low * high)
