"""A plant at constant inputs with a small sine on one of them, and the sine of its outputs.

- **Input.** The load torque is held over a step at its value at the middle of the step; omega1 goes linearly
  from sample to sample (by input derivatives: a native FMU is needed). Neither lags; the loss of amplitude,
  sinc(f h) or its square, is divided out.
- **Output.** A step mean belongs to the middle of its step and is fitted there; its sinc(f h) is divided out
  as well.
- **Fit.** Least squares of mean, drift, sine and cosine, weighted by a Hann window over a whole number of
  periods. The pulses are no multiple of the sine, but a record of N periods separates frequencies that
  differ by more than 2/N of it, and beyond that leakage falls with the cube of the distance. The step has to
  be so short that pulses do not alias: some 20 steps to a pulse.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..harness.fmu import Fmu
from ..memory import Module

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

LEAST_PERIODS = 10
SPEED, LOAD = "omega1", "load_torque"
PULSES = "output_torque_mean"


def fit_sine(time: Array, values: Array, frequency: float) -> tuple[complex, float]:
    """Complex amplitude z of Im(z exp(2 pi i f t)) in values, and their mean, under a Hann window.

    Args:
        time, values: shape (n,). frequency: Hz; the times cover a whole number of its periods.
    """
    window = 0.5 - 0.5 * np.cos(2.0 * math.pi * (np.arange(time.size) + 0.5) / time.size)
    angle = 2.0 * math.pi * frequency * time
    drift = (time - time.mean()) / float(np.ptp(time))
    basis = np.stack([np.sin(angle), np.cos(angle), np.ones(time.size), drift], axis=1)
    root = np.sqrt(window)
    found = np.linalg.lstsq(basis * root[:, None], values * root, rcond=None)[0]
    return complex(found[0], found[1]), float(found[2])


@dataclass(frozen=True)
class SineBench:
    """A plant at an operating point, and how it is excited and read.

    Attributes:
        plant: started. point: omega1, rad/s, and load_torque, N.m. outputs: names that are read.
        step: communication step, s.
    """

    plant: Fmu | Module
    point: Mapping[str, float]
    outputs: tuple[str, ...]
    step: float

    def run(self, excited: str, amplitude: float, frequency: float, first: int, count: int) -> Array:
        """Outputs at the ends of count steps, shape (count, outputs), under the sine from step first on."""
        plant, step = self.plant, self.step
        ramped = excited == SPEED
        turns = frequency * step * (np.arange(first, first + count + 1) + (0.0 if ramped else 0.5))
        values = (self.point[excited] + amplitude * np.sin(2.0 * math.pi * turns)).tolist()
        rows = np.empty((count, len(self.outputs)))
        for n in range(count):
            plant.set(**{excited: values[n]})
            if ramped:
                plant.set_rates(**{excited: (values[n + 1] - values[n]) / step})
            plant.advance(step)
            rows[n] = plant.read(self.outputs)
        return rows

    def response(
        self, excited: str, amplitude: float, frequency: float, settling: float, record: float
    ) -> tuple[Complex, Array]:
        """Outputs over the input at one frequency, and their means, shape (outputs,) each.

        Args:
            excited: name of the input. amplitude: in its units. frequency: Hz.
            settling: time given to the transient, s. record: least time of the record, s.
        """
        before = math.ceil(settling / self.step)
        self.run(excited, amplitude, frequency, 0, before)
        periods = max(LEAST_PERIODS, math.ceil(record * frequency))
        count = round(periods / (frequency * self.step))
        rows = self.run(excited, amplitude, frequency, before, count)
        ends: Array = np.arange(before + 1, before + count + 1, dtype=np.float64) * self.step
        sinc = float(np.sinc(frequency * self.step))
        held = amplitude * (sinc**2 if excited == SPEED else sinc)
        found, means = np.empty(len(self.outputs), dtype=complex), np.empty(len(self.outputs))
        for n, name in enumerate(self.outputs):
            is_mean = name.endswith("_mean")
            time: Array = ends - 0.5 * self.step if is_mean else ends
            sine, means[n] = fit_sine(time, rows[:, n], frequency)
            found[n] = sine / (held * sinc if is_mean else held)
        return found, means

    def settle(self, time: float) -> float:
        """Run at constant inputs for a time, s; torque pulses per second in its last half (0: not two)."""
        count = math.ceil(time / self.step)
        torque = np.empty(count)
        for n in range(count):
            self.plant.advance(self.step)
            torque[n] = self.plant.read((PULSES,))[0]
        driven = torque[count // 2 :] > 1e-9 * max(float(np.abs(torque).max()), 1e-300)
        starts = np.flatnonzero(~driven[:-1] & driven[1:])
        return float((starts.size - 1) / ((starts[-1] - starts[0]) * self.step)) if starts.size > 1 else 0.0
