"""Small-signal frequency response: of an FMU, measured, and of the linearised averaged module.

Measured as on a test bed: the FMU runs at constant inputs until it has settled, then a small sine is added to
one input, and after the transient the sine of that frequency in the outputs is fitted (see sine_bench).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import control as ct
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import must_be
from ..harness.fmu import Fmu, as_names
from ..kernel.codes import DRIVE_SPEED
from .averaged_system import INPUT_RATE, INPUTS, QUASI_STEADY, TransientInertia, averaged_system
from .sine_bench import SineBench

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

# outputs of the averaged system, by those of the FMU over a communication step
MEANS = {"input_torque_mean": "input_torque", "output_torque_mean": "output_torque"}


@dataclass(frozen=True)
class SmallSignal:
    """Frequency response from one input to some outputs.

    Attributes:
        frequency: Hz, shape (n,). response: output over input, shape (outputs, n).
        outputs: names of the rows. mean: of the outputs at the operating point, shape (outputs,).
        pulse_rate: torque pulses on the output shaft per second (0 where it was not counted).
    """

    frequency: Array
    response: Complex
    outputs: tuple[str, ...]
    mean: Array
    pulse_rate: float = 0.0

    def deviation_from(self, other: SmallSignal) -> tuple[Array, Array]:
        """Relative deviation of the gain, and deviation of the phase in degrees, shape (outputs, n) each."""
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
    """Frequency response of an FMU around an operating point, by a small sine on one input.

    Args:
        path: the .fmu file. parameters: by name; omega_out_start near the operating point saves settling.
        omega1: operating point, rad/s.
        load_torque: the same, N.m.
        excited: "omega1" or "load_torque". amplitude: of the sine, in units of this input.
        frequencies: Hz, shape (n,).
        outputs: variables of the FMU; torques as step means.
        step: communication step, s: some 20 to a pulse. settling: time given to every transient, s.
        record: time of the record, s, if 10 periods are not longer: separates beats of pulses from the sine.
        tolerance: relative, of the FMU.

    Returns:
        The measured response.

    Raises:
        ValueError: excited is no input, a number is not positive, a frequency is above 1 / (4 step), or the
            FMU is driven by torque.
        FmuError: the FMU refuses something.
    """
    _check_excited(excited)
    for name, value in (("amplitude", amplitude), ("step", step), ("settling", settling), ("record", record)):
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(must_be(name, "a positive number", value))
    wanted = np.atleast_1d(np.asarray(frequencies, dtype=float))
    for frequency in wanted:
        if not 0.0 < frequency <= 0.25 / step:
            most = f"above 0 and at most {0.25 / step:g} Hz, a quarter of the sampling rate"
            raise ValueError(must_be("frequency", most, frequency))
    point = {"omega1": omega1, "load_torque": load_torque}
    with Fmu(path, parameters, point, tolerance) as fmu:
        if fmu["drive"] != DRIVE_SPEED:
            raise ValueError("drive must be 0 (speed), is 1 (torque): omega1 is made to swing")
        bench = SineBench(fmu, point, as_names(outputs), step)
        rate = bench.settle(settling)
        settled = fmu.get_state()
        found = []
        for frequency in wanted:
            fmu.set_state(settled)
            found.append(bench.response(excited, amplitude, float(frequency), settling, record))
    response = np.array([row for row, _ in found]).T
    mean = np.mean([row for _, row in found], axis=0)
    return SmallSignal(wanted, response, bench.outputs, mean, rate)


def operating_point(system: Any, omega1: float, load_torque: float, guess: float | None = None) -> float:
    """Output speed, rad/s, at which an averaged_system carries a load; by control.find_operating_point.

    Args:
        system: of averaged_system. omega1, load_torque: rad/s and N.m.
        guess: where to look first, rad/s: where there are two balances, which one.

    Raises:
        ValueError: there is none below lock-up.
    """
    first = 0.5 * omega1 if guess is None else guess
    given = np.zeros(system.ninputs)
    for name, value in ((INPUTS[0], omega1), (INPUTS[1], load_torque)):
        given[system.find_input(name)] = value
    point = ct.find_operating_point(system, [first], given)
    if point.states is None or not 0.0 < point.states[0] < omega1:
        raise ValueError(
            f"with omega1 = {omega1:g} rad/s load_torque must be carried below lock-up, is {load_torque:g}"
            f" N.m: no operating point was found from omega_out = {first:g} rad/s"
        )
    return float(point.states[0])


def averaged_response(
    parameters: Mapping[str, float],
    *,
    omega1: float,
    load_torque: float,
    excited: str,
    frequencies: ArrayLike,
    outputs: str | Sequence[str] = ("omega_out", "output_torque_mean"),
    guess: float | None = None,
    transient: TransientInertia = QUASI_STEADY,
) -> SmallSignal:
    """Frequency response of the linearised averaged module; torques include their part in omega1'.

    Args:
        parameters: of the module, as numbers. omega1, load_torque: operating point, rad/s and N.m.
        excited: "omega1" or "load_torque". frequencies: Hz, shape (n,).
        outputs: omega_out, input_torque_mean, output_torque_mean.
        guess: see operating_point. transient: see averaged_system.

    Returns:
        The response, with the means of the operating point.

    Raises:
        ValueError: there is no operating point below lock-up, or excited is no input.
    """
    _check_excited(excited)
    names = as_names(outputs)
    own = [MEANS.get(name, name) for name in names]
    system = averaged_system(parameters, inputs=(*INPUTS, INPUT_RATE), outputs=own, transient=transient)
    state = [operating_point(system, omega1, load_torque, guess)]
    given = [omega1, load_torque, 0.0]
    linear = ct.linearize(system, state, given)
    wanted = np.atleast_1d(np.asarray(frequencies, dtype=float))
    values = linear(2j * math.pi * wanted, squeeze=False)
    response = values[:, INPUTS.index(excited), :]
    if excited == INPUTS[0]:
        response = response + 2j * math.pi * wanted * values[:, len(INPUTS), :]
    mean = np.asarray(system.output(0.0, state, given), dtype=float)
    return SmallSignal(wanted, np.asarray(response, dtype=complex), names, mean)


def _check_excited(excited: str) -> None:
    if excited not in INPUTS:
        raise ValueError(must_be("excited", " or ".join(INPUTS), repr(excited)))
