"""Frequency responses of an FMU, measured as on a test bench.

A plant runs at constant inputs until its transient has decayed. Then a small sine is added to one input.
After the transient a sine of this frequency is fitted to the outputs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia_module import Fmu, Module
from inertia_module.common.errors import must_be
from inertia_module.fmi.instance import as_names, run
from inertia_module.kernel.codes import DRIVE_SPEED

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SPEED, LOAD = INPUTS = ("omega1", "load_torque")
PULSES = "output_torque_mean"
# message for an FMU with drive = torque
SPEED_DRIVE_REQUIRED = must_be("drive", "0 (speed)", "1 (torque)")


def fit_sine(time: Array, values: Array, frequency: float) -> tuple[Complex, Array]:
    """Fit Im(z exp(2 pi i f t)) plus mean and drift to columns over whole periods, with a Hann window.

    The pulse frequency is no multiple of the frequency f of the sine. With N periods the window separates
    frequencies that differ by more than 2 f / N. Leakage decreases with the cube of the distance.

    Args:
        time: Times, s, shape (n,).
        values: Columns, shape (n, columns).
        frequency: Frequency, Hz.

    Returns:
        Amplitudes z, shape (columns,), and means, shape (columns,).
    """
    window = 0.5 - 0.5 * np.cos(2.0 * math.pi * (np.arange(time.size) + 0.5) / time.size)
    angle = 2.0 * math.pi * frequency * time
    drift = (time - time.mean()) / float(np.ptp(time))
    basis = np.stack([np.sin(angle), np.cos(angle), np.ones(time.size), drift], axis=1)
    root = np.sqrt(window)[:, None]
    sine, cosine, mean, _ = np.linalg.lstsq(basis * root, values * root, rcond=None)[0]
    return sine + 1j * cosine, mean


@dataclass(frozen=True, eq=False)
class SineBench:
    """Plant at an operating point.

    Attributes:
        plant: An initialised FMU or module.
        point: Inputs of the operating point by name.
        outputs: Names of the measured outputs.
        step: Communication step, s.
    """

    plant: Fmu | Module
    point: Mapping[str, float]
    outputs: tuple[str, ...]
    step: float

    def response(
        self, excited: str, amplitude: float, frequency: float, settling: float, record: float
    ) -> tuple[Complex, Array]:
        """Measure the response to a sine on an input.

        Args:
            excited: Name of the input.
            amplitude: Amplitude of the sine, in the unit of the input.
            frequency: Frequency, Hz.
            settling: Time before the record, s.
            record: Minimum duration of the record, s; it has at least 10 periods.

        Returns:
            Output over input, shape (outputs,), and means of the outputs, shape (outputs,).
        """
        plant, step = self.plant, self.step
        before = math.ceil(settling / step)
        periods = max(10, math.ceil(record * frequency))
        last = before + round(periods / (frequency * step))
        # omega1 is linear between samples. The load is constant in a step, at the value in its middle.
        # Neither is delayed; the amplitude of omega1 decreases by sinc(f h)^2, the amplitude of the load by
        # sinc(f h).
        is_linear = excited == SPEED
        cycles = frequency * step * (np.arange(last + 1) + (0.0 if is_linear else 0.5))
        values = (self.point[excited] + amplitude * np.sin(2.0 * math.pi * cycles)).tolist()
        rows = np.empty((last, len(self.outputs)))
        for n in range(last):
            plant.set(**{excited: values[n]})
            if is_linear:
                plant.set_rates(**{excited: (values[n + 1] - values[n]) / step})
            plant.advance(step)
            rows[n] = plant.read(self.outputs)
        ends: Array = np.arange(before + 1, last + 1, dtype=np.float64) * step
        sinc = float(np.sinc(frequency * step))
        effective = amplitude * (sinc**2 if is_linear else sinc)
        sines, means = fit_sine(ends, rows[before:], frequency)
        # A step mean belongs to the middle of its step.
        mean_factor = sinc * np.exp(-1j * math.pi * frequency * step)
        return sines / [
            effective * (mean_factor if name.endswith("_mean") else 1.0) for name in self.outputs
        ], means

    def settle(self, time: float) -> float:
        """Run at constant inputs and return the torque pulses per second in the last half of the time.

        Args:
            time: Duration, s.

        Returns:
            Frequency of the pulses, Hz; 0 with fewer than two pulses.
        """
        count = math.ceil(time / self.step)
        rows = np.empty((count + 1, 1))
        run(self.plant, np.full(count, self.step), {}, (PULSES,), rows)
        torque = rows[1:, 0]
        has_torque = torque[count // 2 :] > 1e-9 * max(float(np.abs(torque).max()), 1e-300)
        starts = np.flatnonzero(~has_torque[:-1] & has_torque[1:])
        return float((starts.size - 1) / ((starts[-1] - starts[0]) * self.step)) if starts.size > 1 else 0.0


@dataclass(frozen=True, eq=False)
class SmallSignal:
    """Frequency response from one input to several outputs.

    Attributes:
        frequency: Frequencies, Hz, shape (n,).
        response: Output over input, complex, shape (outputs, n).
        outputs: Names of the rows.
        mean: Means of the outputs at the operating point, shape (outputs,).
        pulse_rate: Torque pulses on the output shaft per second, Hz (0 if not measured).
    """

    frequency: Array
    response: Complex
    outputs: tuple[str, ...]
    mean: Array
    pulse_rate: float = 0.0

    def deviation_from(self, other: SmallSignal) -> tuple[Array, Array]:
        """Return relative deviation of the gain and deviation of the phase, degrees, shape (outputs, n) each.

        Args:
            other: Response at the same frequencies, with the same outputs.
        """
        ratio = self.response / other.response
        return np.abs(ratio) - 1.0, np.degrees(np.angle(ratio))


def measured_response(
    path: Path | str,
    parameters: Mapping[str, float | bool | str],
    *,
    omega1: float,
    load_torque: float,
    excited: str,
    amplitude: float,
    frequencies: ArrayLike,
    outputs: str | Sequence[str] = ("omega_out", "output_torque_mean"),
    step: float,
    settling: float,
    record: float = 20.0,
    tolerance: float | None = 1e-7,
) -> SmallSignal:
    """Measure the frequency response of an FMU around an operating point, by a small sine on one input.

    Args:
        path: Path of the FMU file.
        parameters: Parameters by name; omega_out_start near the operating point shortens settling.
        omega1: Speed of link 1 at the operating point, rad/s.
        load_torque: Load torque at the operating point, N.m.
        excited: Input with the sine, "omega1" or "load_torque".
        amplitude: Amplitude of the sine, in the unit of this input.
        frequencies: Frequencies, Hz, shape (n,).
        outputs: Variables of the FMU; torques as step means.
        step: Communication step, s; about 20 steps per pulse.
        settling: Time for each transient, s.
        record: Minimum duration of the record, s; it has at least 10 periods. A long record separates beats
            of the pulses from the sine.
        tolerance: Relative tolerance of the FMU; None for its default.

    Raises:
        ValueError: excited is no input, a number is not positive, a frequency is above 1 / (4 step), or the
            FMU is torque-driven.
        FmuError: The FMU rejects a value or a step.
    """
    if excited not in INPUTS:
        raise ValueError(must_be("excited", " or ".join(INPUTS), repr(excited)))
    for name, value in (("amplitude", amplitude), ("step", step), ("settling", settling), ("record", record)):
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(must_be(name, "a positive number", value))
    values_hz = np.atleast_1d(np.asarray(frequencies, dtype=float))
    for frequency in values_hz:
        if not 0.0 < frequency <= 0.25 / step:
            allowed = f"above 0 and at most {0.25 / step:g} Hz, a quarter of the sampling rate"
            raise ValueError(must_be("frequency", allowed, frequency))
    point = {SPEED: omega1, LOAD: load_torque}
    with Fmu(path, parameters, point, tolerance) as fmu:
        if fmu["drive"] != DRIVE_SPEED:
            raise ValueError(f"{SPEED_DRIVE_REQUIRED}. The measurement prescribes omega1.")
        bench = SineBench(fmu, point, as_names(outputs), step)
        rate = bench.settle(settling)
        steady_state = fmu.get_state()
        responses = []
        for frequency in values_hz:
            fmu.set_state(steady_state)
            responses.append(bench.response(excited, amplitude, float(frequency), settling, record))
    response = np.array([row for row, _ in responses]).T
    mean = np.mean([row for _, row in responses], axis=0)
    return SmallSignal(values_hz, response, bench.outputs, mean, rate)
