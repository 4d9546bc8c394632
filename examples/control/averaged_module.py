"""Averaged module as a continuous-time system of python-control, its operating points and linear responses.

The system uses the torque map and the functions of the kernel:

    J3 omega_out' = omega1^2 F(omega_out / |omega1|) - load_torque

The system is valid at speed ratios below 1. At lock-up (omega_out = omega1) the FMU locks both shafts
together, but here the torque drops to zero above ratio 1, so a solver would chatter.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import control as ct
import numpy as np
from frequency_response import INPUTS, LOAD, PULSES, SPEED, SPEED_DRIVE_REQUIRED, SineBench, SmallSignal
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from inertia_module import Module
from inertia_module.common.errors import must_be, unknown
from inertia_module.fmi.instance import as_names
from inertia_module.interface.variables import BY_NAME
from inertia_module.kernel import codes

# --- the system ---

INPUT_RATE = "omega1_rate"
OUTPUTS = (
    *("omega_out", "omega2", "input_torque", "mesh_torque", "output_torque", "housing_torque"),
    *("torque_ripple", "torque_peak"),
)


class TransientInertia(NamedTuple):
    """Transient inertias: the mean output torque increases by input omega1' - output omega_out'.

    Attributes:
        input: Inertia for the acceleration of link 1, kg.m2.
        output: Inertia for the acceleration of the output shaft, kg.m2.
    """

    input: float
    output: float


QUASI_STEADY = TransientInertia(0.0, 0.0)
# output of the averaged system by the step mean of the FMU
MEANS = {"input_torque_mean": "input_torque", "output_torque_mean": "output_torque"}
# change of the output speed for the derivative of the energy, over omega1
DIFFERENCE = 1e-4


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
        parameters: Parameters of the module by name, as in Module.set; fidelity is always averaged.
        inputs: omega1, rad/s; load_torque, N.m; optionally omega1_rate, rad/s2, the acceleration of link 1,
            which contributes to the torques. It is 0 without this input.
        outputs: Names among omega_out, omega2, rad/s; input_torque, mesh_torque, output_torque,
            housing_torque, torque_ripple (RMS), torque_peak, N.m.
        transient: Inertias that add to the mean torque below lock-up; 0 as in fidelity averaged.
        name: Name of the system.
        kernel: Kernel, as in Module.

    Returns:
        control.NonlinearIOSystem with the state omega_out, rad/s.

    Raises:
        ParameterError: The parameters are invalid, or a freewheel is missing, so that there is no mean
            torque.
        ValueError: An input or output is unknown, omega1 or load_torque is missing, or drive is torque.
    """
    if BY_NAME["drive"].number((parameters or {}).get("drive", codes.DRIVE_SPEED)) != codes.DRIVE_SPEED:
        raise ValueError(f"{SPEED_DRIVE_REQUIRED}. The averaged system has the input omega1.")
    inputs, outputs = as_names(inputs), as_names(outputs)
    all_inputs = (*INPUTS, INPUT_RATE)
    for kind, names, allowed in (("input", inputs, all_inputs), ("output", outputs, OUTPUTS)):
        for variable in names:
            if variable not in allowed:
                raise ValueError(unknown(kind, variable, allowed))
    if not set(INPUTS) <= set(inputs):
        allowed_inputs = f"{' and '.join(INPUTS)}, and optionally {INPUT_RATE}"
        raise ValueError(must_be("inputs", allowed_inputs, ", ".join(inputs)))
    module = Module(kernel).start(**{**(parameters or {}), "fidelity": float(codes.AVERAGED)})
    columns = [list(inputs).index(variable) if variable in inputs else -1 for variable in all_inputs]
    state, inertia = module.state, module["output_inertia"]

    def set_state(omega_out: float, u: Any) -> tuple[float, float]:
        """Set the state and calculate the outputs; return the output torque, N.m, and omega_out', rad/s2."""
        omega1, load, rate = (float(u[column]) if column >= 0 else 0.0 for column in columns)
        state.omega1, state.alpha1 = omega1, rate
        # The shaft cannot rotate backward. A negative speed is an error of the solver and means standstill.
        state.omega3, state.load_torque = max(omega_out, 0.0), load
        module.call(codes.OUTPUTS, 0.0)
        torque, acceleration = module["output_torque"], module["output_acceleration"]
        slips = 0.0 < state.omega3 < abs(omega1) or acceleration > 0.0
        if slips and transient != QUASI_STEADY:
            resistance = load + module["output_friction"] * state.omega3
            accelerating = torque - resistance + transient.input * rate
            acceleration = accelerating / (inertia + transient.output)
            torque = resistance + inertia * acceleration
        return torque, acceleration

    def stored_torque(extra_acceleration: float) -> float:
        """Return the input torque, N.m, that stores energy while the output accelerates by more, rad/s2."""
        if extra_acceleration == 0.0:
            return 0.0
        energies = []
        middle, change = state.omega3, DIFFERENCE * abs(state.omega1)
        for speed in (middle - change, middle + change):
            state.omega3 = speed
            module.call(codes.OUTPUTS, 0.0)
            energies.append(module["energy_stored"])
        state.omega3 = middle
        slope: float = (energies[1] - energies[0]) / (2.0 * change) - inertia * middle
        return slope * extra_acceleration / float(state.omega1)

    def output(_: float, x: Any, u: Any, __: Any) -> Any:
        omega_out = float(x[0])
        torque, acceleration = set_state(omega_out, u)
        values = {name: module[name] for name in OUTPUTS if name not in ("omega_out", "omega2")}
        values |= {"omega_out": omega_out, "omega2": state.omega2, "output_torque": torque}
        # contributions of the accelerations
        extra_torque = torque - module["output_torque"]
        extra_acceleration = acceleration - module["output_acceleration"]
        mesh_part = extra_torque * omega_out / state.omega1 if extra_torque != 0.0 else 0.0
        values["input_torque"] += mesh_part + stored_torque(extra_acceleration)
        values["mesh_torque"] += mesh_part
        values["housing_torque"] += extra_torque - mesh_part
        return np.array([values[variable] for variable in outputs])

    return ct.nlsys(
        lambda _, x, u, __: np.array([set_state(float(x[0]), u)[-1]]),
        output,
        inputs=list(inputs),
        outputs=list(outputs),
        states=["omega_out"],
        name=name,
        dt=0,
    )


# --- operating points and linear responses ---


class OperatingPoint(NamedTuple):
    """Output speed at which mean torque and load are in equilibrium.

    Attributes:
        omega_out: Output speed, rad/s.
        is_stable: True if a small change of the output speed decays.
    """

    omega_out: float
    is_stable: bool

    def __str__(self) -> str:
        return f"{self.omega_out:.6g} rad/s ({'stable' if self.is_stable else 'unstable'})"


# grid of speed ratios for the search of operating points
RATIOS = np.linspace(1e-3, 1.0 - 1e-6, 500)


def operating_points(system: Any, omega1: float, load_torque: float) -> list[OperatingPoint]:
    """Find all output speeds below lock-up at which the mean torque of an averaged_system balances a load.

    Brent's method refines each sign change of the acceleration on a grid of speed ratios. An operating point
    is stable if the acceleration decreases with the speed (Lyapunov's indirect method).

    Args:
        system: System of averaged_system.
        omega1: Speed of link 1, rad/s, above 0.
        load_torque: Load torque, N.m.

    Returns:
        Operating points in order of speed; empty if there are none.
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
    """Return the minimum and maximum load, N.m, with an operating point of an averaged_system below lock-up.

    Args:
        system: System of averaged_system.
        omega1: Speed of link 1, rad/s, above 0.
    """
    loads = []
    for speed in omega1 * RATIOS:
        # The acceleration is linear in the load.
        unloaded, loaded = (_acceleration(system, omega1, load, speed) for load in (0.0, 1.0))
        loads.append(unloaded / (unloaded - loaded))
    return min(loads), max(loads)


def operating_point(system: Any, omega1: float, load_torque: float, guess: float | None = None) -> float:
    """Find the stable output speed, rad/s, at which an averaged_system balances a load.

    Args:
        system: System of averaged_system.
        omega1: Speed of link 1, rad/s, above 0.
        load_torque: Load torque, N.m.
        guess: Output speed, rad/s, to select the closest operating point, stable or not; None for the only
            stable one.

    Raises:
        ValueError: There is no operating point below lock-up, or there is no guess and not exactly one stable
            operating point.
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
    """Compute the frequency response of the linearised averaged module.

    Torques include the contribution of the acceleration omega1'.

    Args:
        parameters: Parameters of the module, SI, by name.
        omega1: Speed of link 1 at the operating point, rad/s.
        load_torque: Load torque at the operating point, N.m.
        excited: Input with the sine, "omega1" or "load_torque".
        frequencies: Frequencies, Hz, shape (n,).
        outputs: Names among omega_out, input_torque_mean, output_torque_mean.
        guess: Output speed near the operating point, rad/s, as in operating_point.
        transient: Transient inertias, as in averaged_system.

    Raises:
        ValueError: There is no operating point below lock-up, or excited is no input.
    """
    if excited not in INPUTS:
        raise ValueError(must_be("excited", " or ".join(INPUTS), repr(excited)))
    names = as_names(outputs)
    own_outputs = [MEANS.get(name, name) for name in names]
    system = averaged_system(
        parameters, inputs=(*INPUTS, INPUT_RATE), outputs=own_outputs, transient=transient
    )
    state = [operating_point(system, omega1, load_torque, guess)]
    inputs = [omega1, load_torque, 0.0]
    linear = ct.linearize(system, state, inputs)
    values_hz = np.atleast_1d(np.asarray(frequencies, dtype=float))
    values = linear(2j * math.pi * values_hz, squeeze=False)
    response = values[:, INPUTS.index(excited), :]
    if excited == SPEED:
        response = response + 2j * math.pi * values_hz * values[:, len(INPUTS), :]
    mean = np.asarray(system.output(0.0, state, inputs), dtype=float)
    return SmallSignal(values_hz, np.asarray(response, dtype=complex), names, mean)


# --- contribution of accelerations to the mean output torque ---


def transient_inertia(
    parameters: Mapping[str, float], omega1: float, omega_out: float, kernel: str = "auto"
) -> TransientInertia:
    """Measure the two transient inertias of the mean output torque at an operating point.

    The map of fidelity averaged is valid at steady speeds. To first order in the accelerations the mean
    torque is

        T = omega1^2 F(sigma) + m1(sigma) omega1' - m3(sigma) omega_out'

    with two inertias that depend only on the speed ratio sigma. The rigid module in memory runs with an
    output inertia so large that its speed is prescribed, once with a sine on omega1 and once with a sine on
    omega_out. The component of the torque in quadrature yields m1 and m3.

    Args:
        parameters: Parameters of the module, SI, by name.
        omega1: Speed of link 1, rad/s.
        omega_out: Output speed, rad/s, above 0 and below omega1.
        kernel: Kernel, as in Module.

    Raises:
        ParameterError: The parameters are invalid.
        ValueError: A speed is out of range, or there are no torque pulses at these speeds.
    """
    if not 0.0 < omega_out < omega1:
        raise ValueError(must_be("omega_out", f"above 0 and below omega1 = {omega1:g} rad/s", omega_out))
    averaged = averaged_system(parameters, outputs=("output_torque",), kernel=kernel)
    point = {SPEED: omega1, LOAD: float(averaged.output(0.0, [omega_out], [omega1, 0.0])[0])}
    # output inertia, kg.m2, that no torque accelerates noticeably
    large_inertia = 1e4
    prescribed = {"fidelity": float(codes.RIGID), "output_inertia": large_inertia, "tolerance": 1e-8}
    gains = []
    for excited in (SPEED, LOAD):
        module = Module(kernel).start(**{**parameters, **prescribed, "omega_out_start": omega_out}, **point)
        d = module.derived
        cycle = 2.0 * math.pi / (d.harmonic * d.k * omega1)
        bench = SineBench(module, point, ("omega_out", PULSES), cycle / 8.0)
        rate = bench.settle(80.0 * cycle)
        if rate == 0.0:
            raise ValueError(f"no pulses at omega_out = {omega_out:g} rad/s and omega1 = {omega1:g} rad/s")
        frequency, speed_amplitude = 0.05 * rate, 0.005 * omega1
        angular_frequency = 2.0 * math.pi * frequency
        amplitude = (
            speed_amplitude if excited == SPEED else speed_amplitude * angular_frequency * large_inertia
        )
        # The record is long enough to separate beats of the pulses from the sine.
        settling, record = 40.0 / rate, 600.0 / rate
        response, _ = bench.response(excited, amplitude, frequency, settling, record)
        # torque per acceleration of the oscillating speed
        gain = response[1] if excited == SPEED else response[1] / response[0]
        gains.append(float(gain.imag / angular_frequency))
    return TransientInertia(gains[0], -gains[1])
