"""Averaged module as a system; small-signal response of it and of an FMU.

The averaged module is a continuous system of python-control, on the map the kernel itself has found and by
its own functions:

    J3 omega_out' = omega1^2 F(omega_out / |omega1|) - load_torque

At lock-up (omega_out = omega1) the FMU holds the two together; here the torque drops to zero above ratio 1,
and a solver would chatter there: it is for ratios below.

A response is measured as on a test bed: a plant runs at constant inputs until it has settled, then a small
sine is added to one input, and after the transient the sine of that frequency in the outputs is fitted.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import control as ct
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from ..common.equality import ByContent
from ..common.errors import must_be, unknown
from ..contract.variables import BY_NAME
from ..harness.fmu import Fmu, as_names, run
from ..kernel import codes
from ..kernel.averaged import rates as average_rates
from ..kernel.averaged import run as average
from ..memory import Module

# --- the averaged system ---

INPUTS = ("omega1", "load_torque")
INPUT_RATE = "omega1_rate"
# message: the drive of the FMU is a torque
BY_SPEED = must_be("drive", "0 (speed)", "1 (torque)")
OUTPUTS = (
    *("omega_out", "omega2", "input_torque", "mesh_torque", "output_torque", "housing_torque"),
    *("torque_ripple", "torque_peak"),
)


class TransientInertia(NamedTuple):
    """Inertias, kg m2, at a speed ratio: input omega1' - output omega_out' adds to the mean output torque."""

    input: float
    output: float


QUASI_STEADY = TransientInertia(0.0, 0.0)


def averaged_system(
    parameters: Mapping[str, float | str] | None = None,
    *,
    inputs: str | Sequence[str] = INPUTS,
    outputs: str | Sequence[str] = ("omega_out", "input_torque", "output_torque"),
    transient: TransientInertia = QUASI_STEADY,
    name: str = "averaged",
    kernel: str = "auto",
) -> Any:
    """Make a continuous-time NonlinearIOSystem of the averaged module.

    Args:
        parameters: of the module by name, as in Module.set; fidelity is averaged whatever they say.
        inputs: omega1, rad/s, load_torque, N.m, and if wanted omega1_rate, rad/s2: at constant inputs no
            torque has a part in omega1'.
        outputs: of omega_out, omega2, rad/s, input_torque, mesh_torque, output_torque, housing_torque,
            torque_ripple (RMS), torque_peak, N.m.
        transient: what accelerations add to the mean torque while it is driven; nothing in fidelity averaged.
        name: of the system. kernel: as in Module.

    Returns:
        control.NonlinearIOSystem with the state omega_out, rad/s.

    Raises:
        Refused: the parameters cannot be, or there is no mean torque (a freewheel is missing).
        ValueError: an unknown input or output, omega1 or load_torque missing, or drive = torque.
    """
    if BY_NAME["drive"].number((parameters or {}).get("drive", codes.DRIVE_SPEED)) != codes.DRIVE_SPEED:
        raise ValueError(f"{BY_SPEED}. The averaged system has the input omega1.")
    inputs, outputs = as_names(inputs), as_names(outputs)
    known = (*INPUTS, INPUT_RATE)
    for kind, names, allowed in (("input", inputs, known), ("output", outputs, OUTPUTS)):
        for wanted in names:
            if wanted not in allowed:
                raise ValueError(unknown(kind, wanted, allowed))
    if not set(INPUTS) <= set(inputs):
        allowed_inputs = f"{' and '.join(INPUTS)}, and optionally {INPUT_RATE}"
        raise ValueError(must_be("inputs", allowed_inputs, ", ".join(inputs)))
    module = Module(kernel).start(**{**(parameters or {}), "fidelity": float(codes.AVERAGED)})
    d = module.derived
    places = [list(inputs).index(wanted) if wanted in inputs else -1 for wanted in known]

    def motion(omega_out: float, u: Any) -> tuple[Any, Any, float, float]:
        """State, side of the map, mean output torque, N.m, omega_out', rad/s2."""
        omega1, load, rate = (float(u[place]) if place >= 0 else 0.0 for place in places)
        x = type(module.state)()
        x.omega1, x.alpha1 = omega1, rate
        # the shaft does not turn backwards: what a solver leaves below 0 is rest
        x.omega3, x.load_torque = max(omega_out, 0.0), load
        side = average_rates.side_at(d, omega1, rate)  # type: ignore[no-untyped-call]
        leg = average.choose_leg(d, side, x, omega1)  # type: ignore[no-untyped-call]
        average_rates.write_mean_rates(d, side, x, leg, omega1, x.omega3, d.mean)  # type: ignore[no-untyped-call]
        torque, acceleration = d.mean.output, d.mean.omega3
        if leg == average_rates.SLIPPING and transient != QUASI_STEADY:
            carried = load + d.b3 * x.omega3
            driving = torque - carried + transient.input * rate
            acceleration = driving / (d.J3 + transient.output)
            torque = carried + d.J3 * acceleration
        return x, side, torque, acceleration

    def output(_: float, state: Any, u: Any, __: Any) -> Any:
        omega_out, y = float(state[0]), type(module.outputs)()
        x, side, torque, acceleration = motion(omega_out, u)
        average.end_step(d, x)  # type: ignore[no-untyped-call]
        average.write_averaged(d, x, y)  # type: ignore[no-untyped-call]
        values = {name: getattr(y, name) for name in OUTPUTS}
        # what accelerations add
        more, faster = torque - y.output_torque, acceleration - y.output_acceleration
        passed = more * omega_out / x.omega1 if more != 0.0 else 0.0
        s = average_rates.ratio(x.omega3, abs(x.omega1))  # type: ignore[no-untyped-call]
        _, slope = average_rates.look_up_input(side, x, s)  # type: ignore[no-untyped-call]
        stored = math.copysign(0.5 * slope * faster, x.omega1)
        values |= {"omega_out": omega_out, "omega2": x.omega2, "output_torque": torque}
        values |= {"input_torque": y.input_torque + passed + stored, "mesh_torque": y.mesh_torque + passed}
        values["housing_torque"] = y.housing_torque + more - passed
        return np.array([values[wanted] for wanted in outputs])

    return ct.nlsys(
        lambda _, state, u, __: np.array([motion(float(state[0]), u)[-1]]),
        output,
        inputs=list(inputs),
        outputs=list(outputs),
        states=["omega_out"],
        name=name,
        dt=0,
    )


Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SPEED, LOAD = INPUTS
PULSES = "output_torque_mean"
# outputs of the averaged system, by those of the FMU over a communication step
MEANS = {"input_torque_mean": "input_torque", "output_torque_mean": "output_torque"}


# --- a sine on an input of a plant ---


def fit_sine(time: Array, values: Array, frequency: float) -> tuple[Complex, Array]:
    """Fit z of Im(z exp(2 pi i f t)) in columns over whole periods, and their means, under a Hann window.

    Pulses are no multiple of the sine, but of N periods the window separates what is more than 2/N of the
    frequency apart, and leakage beyond falls with the cube of the distance.
    """
    window = 0.5 - 0.5 * np.cos(2.0 * math.pi * (np.arange(time.size) + 0.5) / time.size)
    angle = 2.0 * math.pi * frequency * time
    drift = (time - time.mean()) / float(np.ptp(time))
    basis = np.stack([np.sin(angle), np.cos(angle), np.ones(time.size), drift], axis=1)
    root = np.sqrt(window)[:, None]
    sine, cosine, mean, _ = np.linalg.lstsq(basis * root, values * root, rcond=None)[0]
    return sine + 1j * cosine, mean


@dataclass(frozen=True, eq=False)
class SineBench(ByContent):
    """Plant, started, at an operating point, the outputs that are read, and the communication step, s."""

    plant: Fmu | Module
    point: Mapping[str, float]
    outputs: tuple[str, ...]
    step: float

    def response(
        self, excited: str, amplitude: float, frequency: float, settling: float, record: float
    ) -> tuple[Complex, Array]:
        """Measure outputs over the input at a frequency, Hz, and their means; settling, record: times, s."""
        plant, step = self.plant, self.step
        before = math.ceil(settling / step)
        periods = max(10, math.ceil(record * frequency))
        last = before + round(periods / (frequency * step))
        # omega1 goes linearly from sample to sample, the load is held at its value at the middle of a step:
        # neither lags; both lose amplitude by powers of sinc(f h)
        ramped = excited == SPEED
        turns = frequency * step * (np.arange(last + 1) + (0.0 if ramped else 0.5))
        values = (self.point[excited] + amplitude * np.sin(2.0 * math.pi * turns)).tolist()
        rows = np.empty((last, len(self.outputs)))
        for n in range(last):
            plant.set(**{excited: values[n]})
            if ramped:
                plant.set_rates(**{excited: (values[n + 1] - values[n]) / step})
            plant.advance(step)
            rows[n] = plant.read(self.outputs)
        ends: Array = np.arange(before + 1, last + 1, dtype=np.float64) * step
        sinc = float(np.sinc(frequency * step))
        held = amplitude * (sinc**2 if ramped else sinc)
        sines, means = fit_sine(ends, rows[before:], frequency)
        # a mean is that of the middle of its step
        of_mean = sinc * np.exp(-1j * math.pi * frequency * step)
        return sines / [held * (of_mean if name.endswith("_mean") else 1.0) for name in self.outputs], means

    def settle(self, time: float) -> float:
        """Run at constant inputs for a time, s; torque pulses per second in its last half (0: not two)."""
        count = math.ceil(time / self.step)
        rows = np.empty((count + 1, 1))
        run(self.plant, np.full(count, self.step), {}, (PULSES,), rows)
        torque = rows[1:, 0]
        driven = torque[count // 2 :] > 1e-9 * max(float(np.abs(torque).max()), 1e-300)
        starts = np.flatnonzero(~driven[:-1] & driven[1:])
        return float((starts.size - 1) / ((starts[-1] - starts[0]) * self.step)) if starts.size > 1 else 0.0


# --- frequency responses ---


@dataclass(frozen=True, eq=False)
class SmallSignal(ByContent):
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
    """Measure the frequency response of an FMU around an operating point, by a small sine on one input.

    Args:
        path: the .fmu file. parameters: by name; omega_out_start near the operating point saves settling.
        omega1: of the operating point, rad/s. load_torque: likewise, N.m. frequencies: Hz, shape (n,).
        excited: "omega1" or "load_torque". amplitude: of the sine, in units of this input.
        outputs: variables of the FMU; torques as step means.
        step: communication step, s: some 20 to a pulse. settling: time given to every transient, s.
        record: time of the record, s, if 10 periods are not longer: separates beats of pulses from the sine.
        tolerance: relative, of the FMU.

    Raises:
        ValueError: excited is no input, a number is not positive, a frequency is above 1 / (4 step), or the
            FMU is driven by torque.
        FmuError: the FMU refuses something.
    """
    if excited not in INPUTS:
        raise ValueError(must_be("excited", " or ".join(INPUTS), repr(excited)))
    for name, value in (("amplitude", amplitude), ("step", step), ("settling", settling), ("record", record)):
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(must_be(name, "a positive number", value))
    wanted = np.atleast_1d(np.asarray(frequencies, dtype=float))
    for frequency in wanted:
        if not 0.0 < frequency <= 0.25 / step:
            most = f"above 0 and at most {0.25 / step:g} Hz, a quarter of the sampling rate"
            raise ValueError(must_be("frequency", most, frequency))
    point = {SPEED: omega1, LOAD: load_torque}
    with Fmu(path, parameters, point, tolerance) as fmu:
        if fmu["drive"] != codes.DRIVE_SPEED:
            raise ValueError(f"{BY_SPEED}. The measurement prescribes omega1.")
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


class OperatingPoint(NamedTuple):
    """Balance of mean torque and load.

    Attributes:
        omega_out: output speed, rad/s.
        is_stable: True if a small change of the output speed decays.
    """

    omega_out: float
    is_stable: bool

    def __str__(self) -> str:
        return f"{self.omega_out:.6g} rad/s ({'stable' if self.is_stable else 'unstable'})"


# speed ratios at which balances are looked for
RATIOS = np.linspace(1e-3, 1.0 - 1e-6, 500)


def operating_points(system: Any, omega1: float, load_torque: float) -> list[OperatingPoint]:
    """Find all output speeds below lock-up at which an averaged_system carries a load.

    Sign changes of the acceleration over the speed ratio, refined by Brent's method. A balance is stable if
    the acceleration falls with the speed (Lyapunov's indirect method).

    Args:
        system: of averaged_system.
        omega1: rad/s, above 0.
        load_torque: N.m.

    Returns:
        Balances by rising speed; without any, an empty list.
    """

    def acceleration(omega_out: float) -> float:
        return _acceleration(system, omega1, load_torque, omega_out)

    speeds = omega1 * RATIOS
    values = np.array([acceleration(speed) for speed in speeds])
    signs = np.sign(values)
    return [
        OperatingPoint(
            float(brentq(acceleration, *speeds[n : n + 2], xtol=1e-12 * omega1)), bool(signs[n] > 0.0)
        )
        for n in np.flatnonzero(signs[:-1] * signs[1:] < 0.0)
    ]


def _acceleration(system: Any, omega1: float, load_torque: float, omega_out: float) -> float:
    """Return the acceleration of the output shaft, rad/s2, at constant inputs, rad/s and N.m."""
    values = {SPEED: omega1, LOAD: load_torque}
    inputs = [values.get(name, 0.0) for name in system.input_labels]
    return float(system.dynamics(0.0, [omega_out], inputs)[0])


def carried_range(system: Any, omega1: float) -> tuple[float, float]:
    """Return the smallest and the largest load, N.m, that an averaged_system carries below lock-up.

    Args:
        system: of averaged_system.
        omega1: rad/s, above 0.
    """
    loads = []
    for speed in omega1 * RATIOS:
        # the acceleration is linear in the load
        without, loaded = (_acceleration(system, omega1, load, speed) for load in (0.0, 1.0))
        loads.append(without / (without - loaded))
    return min(loads), max(loads)


def operating_point(system: Any, omega1: float, load_torque: float, guess: float | None = None) -> float:
    """Find the stable output speed, rad/s, at which an averaged_system carries a load.

    Args:
        system: of averaged_system.
        omega1: rad/s, above 0.
        load_torque: N.m.
        guess: rad/s; the balance next to it is returned, stable or not.

    Raises:
        ValueError: there is no balance below lock-up, or without a guess not exactly one that is stable.
    """
    points = operating_points(system, omega1, load_torque)
    if not points:
        low, high = carried_range(system, omega1)
        allowed = f"between {low:.4g} and {high:.4g} N.m at omega1 = {omega1:g} rad/s"
        raise ValueError(
            f"{must_be('load_torque', allowed, load_torque)}: otherwise no speed below lock-up is steady"
        )
    if guess is not None:
        return min(points, key=lambda point: abs(point.omega_out - guess)).omega_out
    stable = [point for point in points if point.is_stable]
    if len(stable) != 1:
        raise ValueError(
            must_be("guess", f"close to one of the operating points: {', '.join(map(str, points))}", "None")
        )
    return stable[0].omega_out


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
    """Compute the response of the linearised averaged module, with the means of the operating point.

    Torques include their part in omega1'.

    Args:
        parameters: of the module, as numbers. omega1, load_torque: operating point, rad/s and N.m.
        excited: "omega1" or "load_torque". frequencies: Hz, shape (n,).
        outputs: omega_out, input_torque_mean, output_torque_mean.
        guess: see operating_point. transient: see averaged_system.

    Raises:
        ValueError: there is no operating point below lock-up, or excited is no input.
    """
    if excited not in INPUTS:
        raise ValueError(must_be("excited", " or ".join(INPUTS), repr(excited)))
    names = as_names(outputs)
    own = [MEANS.get(name, name) for name in names]
    system = averaged_system(parameters, inputs=(*INPUTS, INPUT_RATE), outputs=own, transient=transient)
    state = [operating_point(system, omega1, load_torque, guess)]
    inputs = [omega1, load_torque, 0.0]
    linear = ct.linearize(system, state, inputs)
    wanted = np.atleast_1d(np.asarray(frequencies, dtype=float))
    values = linear(2j * math.pi * wanted, squeeze=False)
    response = values[:, INPUTS.index(excited), :]
    if excited == SPEED:
        response = response + 2j * math.pi * wanted * values[:, len(INPUTS), :]
    mean = np.asarray(system.output(0.0, state, inputs), dtype=float)
    return SmallSignal(wanted, np.asarray(response, dtype=complex), names, mean)


# --- how the mean output torque answers to accelerations ---


def transient_inertia(
    parameters: Mapping[str, float], omega1: float, omega_out: float, kernel: str = "auto"
) -> TransientInertia:
    """Find the two inertias of the mean output torque at an operating point, kg m2.

    The map of fidelity averaged holds for steady speeds; to first order in the accelerations the mean torque
    is

        T = omega1^2 F(sigma) + m1(sigma) omega1' - m3(sigma) omega_out'

    with two inertias that depend on the speed ratio alone. The rigid module in memory is run with an output
    so heavy that its speed is prescribed, once with a sine on omega1 and once with a sine of omega_out; the
    part of the torque in quadrature gives m1 and m3.

    Args:
        parameters: of the module, as numbers. omega1, omega_out: rad/s, 0 < omega_out < omega1.
        kernel: as in Module.

    Raises:
        Refused: the parameters cannot be. ValueError: speeds out of range, or no pulses there.
    """
    if not 0.0 < omega_out < omega1:
        raise ValueError(must_be("omega_out", f"above 0 and below omega1 = {omega1:g} rad/s", omega_out))
    averaged = averaged_system(parameters, outputs=("output_torque",), kernel=kernel)
    point = {SPEED: omega1, LOAD: float(averaged.output(0.0, [omega_out], [omega1, 0.0])[0])}
    # that no torque moves, kg m^2
    heavy = 1e7
    prescribed = {"fidelity": float(codes.RIGID), "output_inertia": heavy, "tolerance": 1e-8}
    gains = []
    for excited in (SPEED, LOAD):
        module = Module(kernel).start(**{**parameters, **prescribed, "omega_out_start": omega_out}, **point)
        d = module.derived
        cycle = 2.0 * math.pi / (d.harmonic * d.k * omega1)
        bench = SineBench(module, point, ("omega_out", PULSES), cycle / 8.0)
        rate = bench.settle(80.0 * cycle)
        if rate == 0.0:
            raise ValueError(f"no pulses at omega_out = {omega_out:g} rad/s and omega1 = {omega1:g} rad/s")
        frequency, swing = 0.05 * rate, 0.005 * omega1
        turn = 2.0 * math.pi * frequency
        amplitude = swing if excited == SPEED else swing * turn * heavy
        # beats of the pulses have to be separated from the sine
        settling, record = 40.0 / rate, 600.0 / rate
        found, _ = bench.response(excited, amplitude, frequency, settling, record)
        # torque per acceleration of the speed that swings
        gain = found[1] if excited == SPEED else found[1] / found[0]
        gains.append(float(gain.imag / turn))
    return TransientInertia(gains[0], -gains[1])
