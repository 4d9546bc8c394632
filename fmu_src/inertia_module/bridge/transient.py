"""How the mean output torque answers to accelerations: found from the rigid module at one operating point.

The map of fidelity averaged holds for steady speeds. Where they change, the pulses come in between: to first
order in the accelerations, and because nothing but speeds and inertias enters, the mean torque is

    T = omega1^2 F(sigma) + m1(sigma) omega1' - m3(sigma) omega_out'

with two inertias that depend on the speed ratio alone. The rigid module in memory is run with an output so
heavy that its speed is prescribed, once with a sine on omega1 and once with a sine of omega_out, at a
twentieth of the pulse rate; the part of the torque in quadrature gives m1 and m3.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..kernel import codes
from ..memory import Module
from .averaged_system import TransientInertia, averaged_system
from .sine_bench import LOAD, PULSES, SPEED, SineBench

# inertia that no torque moves, kg m^2
_HEAVY = 1e7
# sine: share of the pulse rate, and of omega1
_SHARE_OF_RATE = 0.05
_SHARE_OF_SPEED = 0.005
_STEPS_PER_CYCLE = 8.0
# pulses that settle and that are recorded: beats of the pulses have to be separated from the sine
_SETTLING_PULSES = 40.0
_RECORDED_PULSES = 600.0


def transient_inertia(
    parameters: Mapping[str, float], omega1: float, omega_out: float, kernel: str = "auto"
) -> TransientInertia:
    """The two inertias of the mean output torque at an operating point, kg m2.

    Args:
        parameters: of the module, as numbers. omega1, omega_out: rad/s, 0 < omega_out < omega1.
        kernel: as in Module.

    Raises:
        Refused: the parameters cannot be. ValueError: speeds out of range, or no pulses there.
    """
    if not 0.0 < omega_out < omega1:
        raise ValueError(
            f"omega_out must be above 0 and below omega1 = {omega1:g} rad/s, is {omega_out:g} rad/s"
        )
    averaged = averaged_system(parameters, outputs=("output_torque",), kernel=kernel)
    torque = float(averaged.output(0.0, [omega_out], [omega1, 0.0])[0])
    speed = _sine(parameters, omega1, omega_out, torque, SPEED, kernel)
    output = _sine(parameters, omega1, omega_out, torque, LOAD, kernel)
    return TransientInertia(speed, -output)


def _sine(
    parameters: Mapping[str, float], omega1: float, omega_out: float, load: float, excited: str, kernel: str
) -> float:
    """Torque per acceleration of the speed that is made to swing, kg m2."""
    start = {
        "fidelity": float(codes.RIGID),
        "output_inertia": _HEAVY,
        "omega_out_start": omega_out,
        "tolerance": 1e-8,
    }
    module = Module(kernel).start(**{**parameters, **start}, omega1=omega1, load_torque=load)
    d = module.derived
    step = 2.0 * math.pi / (_STEPS_PER_CYCLE * d.harmonic * d.k * omega1)
    point = {SPEED: omega1, LOAD: load}
    bench = SineBench(module, point, ("omega_out", PULSES), step)
    rate = bench.settle(2.0 * _SETTLING_PULSES * _STEPS_PER_CYCLE * step)
    if rate == 0.0:
        raise ValueError(
            f"no pulses come through at omega_out = {omega_out:g} rad/s and omega1 = {omega1:g} rad/s"
        )
    frequency = _SHARE_OF_RATE * rate
    swing = _SHARE_OF_SPEED * omega1
    turn = 2.0 * math.pi * frequency
    amplitude = swing if excited == SPEED else swing * turn * _HEAVY
    found, _ = bench.response(excited, amplitude, frequency, _SETTLING_PULSES / rate, _RECORDED_PULSES / rate)
    gain = found[1] if excited == SPEED else found[1] / found[0]
    return float(gain.imag / turn)
