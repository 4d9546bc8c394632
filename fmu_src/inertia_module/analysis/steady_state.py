"""Steady state of a mechanism at constant speeds of link 1 and output shaft.

The means are over whole periods of the pinion shaft and include all losses. The rigid module runs at a
constant speed ratio, because a large inertia holds the speed of its output shaft.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError, must_be
from ..interface.variables import BY_NAME
from ..kernel.inertia import reduced_inertia
from ..model import Module

Array = NDArray[np.float64]

# inertia of the output shaft relative to the mechanism: its speed changes by about 1e-7 omega1 in a period
HOLD_INERTIA_FACTOR = 1e8
# revolutions of the pinion shaft in a mean: whole periods, or the maximum if the period is longer
MIN_TURNS, MAX_TURNS = 10, 100
# speed ratio instead of 0: the output freewheel overruns between pulses
MIN_RATIO = 1e-9
# revolutions of link 1 until link 2 reaches its final speed, if the shaft overruns link 1
SETTLING_TURNS = 200
# number of pinion-shaft angles at which the lock-up torque is evaluated
ANGLES = 3000
# samples in the duration of one revolution of the pinion shaft while link 2 is at rest
SAMPLES = 60


class SteadyMeans(NamedTuple):
    """Means and maxima over whole periods of the pinion shaft.

    Attributes:
        output_torque: mean torque on the load, N m; negative if the load must drive the shaft.
        input_torque: mean of M1, N m.
        efficiency: output power relative to input power; 0 without output power.
        link2_ratio: mean speed of link 2 relative to link 1, magnitudes.
        ripple: RMS of the output freewheel torque about its mean, N m.
        peak: maximum output freewheel torque, N m.
        bearing_force: maximum force on the bearing of a satellite, N.
        loss: mean power loss, W.
        housing_engagements: engagements of the housing freewheel per revolution of link 1.
        output_engagements: engagements of the output freewheel per revolution of link 1.
        housing_peak: maximum housing freewheel torque, N m.
        housing_slip: maximum overrunning speed of the housing freewheel, rad/s.
        output_slip: maximum overrunning speed of the output freewheel, rad/s.
    """

    output_torque: float
    input_torque: float
    efficiency: float
    link2_ratio: float
    ripple: float
    peak: float
    bearing_force: float
    loss: float
    housing_engagements: float
    output_engagements: float
    housing_peak: float
    housing_slip: float
    output_slip: float


class SteadyMachine:
    """A mechanism with a constant speed of its output shaft.

    Args:
        parameters: parameters of the module by name that differ from the defaults, as in Module.set.

    Attributes:
        module: the mechanism, started.
        ideal: True without losses, gravity, engagement angles and wind-up. Then torques are proportional to
            omega1^2.

    Raises:
        ParameterError: the parameters are invalid; raised by the methods if a freewheel is missing.
    """

    def __init__(self, parameters: Mapping[str, float | str]) -> None:
        modes = {"fidelity": "rigid", "drive": "speed", "method": "event", "input_hold": "zero_order"}
        zeros = dict.fromkeys(("max_step", "omega2_start", "omega_out_start", "drive_angle_start"), 0.0)
        self._values: dict[str, float | str] = {**parameters, **modes, **zeros}
        self.module = module = Module().start(**self._values_at(1.0, 0.0))
        self._derived = d = module.derived
        self.ideal = d.viscous == 0.0 and d.losses == 0.0
        period = int(d.period_turns)
        self._turns = min(period * math.ceil(MIN_TURNS / period), MAX_TURNS)
        inertia = HOLD_INERTIA_FACTOR * (2.0 * module["energy_stored"] + module["link2_inertia"])
        self._values["output_inertia"] = min(inertia, BY_NAME["output_inertia"].ends[1])

    def _values_at(self, omega1: float, ratio: float) -> dict[str, float | str]:
        """Return the values of the module at an input speed, rad/s, and a speed ratio."""
        return {
            **self._values,
            "omega1": omega1,
            "omega2_start": 0.0,
            "omega_out_start": ratio * abs(omega1),
            "load_torque": 0.0,
        }

    def check_freewheels(self) -> None:
        """Reject a mechanism without one of the freewheels: it has no mean torque.

        Raises:
            ParameterError: a freewheel is missing.
        """
        housing, output = (self.module[f"{name}_freewheel"] for name in ("housing", "output"))
        if housing * output == 0.0:
            both = f"{housing:g} and {output:g}"
            demand = must_be("each of housing_freewheel and output_freewheel", "1", both)
            raise ParameterError(f"{demand}: without both freewheels there is no mean torque")

    def at(self, omega1: float, ratio: float) -> SteadyMeans:
        """Compute the means and maxima of the steady motion.

        Args:
            omega1: speed of link 1, rad/s, not 0.
            ratio: speed ratio of the output shaft and link 1, 0 to 1.
        """
        module = self._steady(omega1, ratio)
        time, loss, work = module.state.length, module["energy_lost"], module["energy_in"]
        turns = abs(omega1) * time / math.tau  # of link 1
        return SteadyMeans(
            module["output_torque_mean"] - module["output_friction"] * module["omega_out"],
            math.copysign(1.0, omega1) * module["input_torque_mean"],
            min(max(1.0 - loss / work, 0.0), 1.0) if work > 0.0 else 0.0,
            abs(1.0 - self._turns / (self._derived.k * turns)),
            module["torque_ripple"],
            module["torque_peak"],
            module["satellite_force_peak"],
            loss / time,
            module["housing_engagements"] / turns,
            module["output_engagements"] / turns,
            *module.read(("housing_torque_peak", "housing_slip_peak", "output_slip_peak")),
        )

    def samples(self, names: Sequence[str], omega1: float, ratio: float) -> Array:
        """Sample outputs in steady motion over the same revolutions as the means.

        The interval is 1 / SAMPLES of a revolution of the pinion shaft while link 2 is at rest.

        Args:
            names: names of outputs.
            omega1: speed of link 1, rad/s, not 0.
            ratio: speed ratio of the output shaft and link 1, 0 to 1.

        Returns:
            Samples, shape (samples, names).
        """
        module, rows = self._steady(omega1, ratio), []
        turn, start = math.tau / (self._derived.k * abs(omega1)), _drive_angle(module)
        while abs(_drive_angle(module) - start) < self._turns * math.tau:
            module.advance(turn / SAMPLES)
            rows.append(module.read(names))
        return np.array(rows)

    def _steady(self, omega1: float, ratio: float) -> Module:
        """Return the module in its periodic orbit at an input speed, rad/s, and a speed ratio."""
        self.check_freewheels()
        return Module().start_steady(self._turns * math.tau, **self._values_at(omega1, max(ratio, MIN_RATIO)))

    def coasting(self, omega1: float, ratio: float) -> tuple[float, float]:
        """Compute the mean friction torques on the load and on link 1, N m, if the shaft overruns link 1.

        Args:
            omega1: speed of link 1, rad/s, not 0.
            ratio: speed ratio of the output shaft and link 1, above 1.
        """
        module = Module().start(**self._values_at(omega1, ratio))
        module.advance(SETTLING_TURNS * math.tau / abs(omega1))
        module.advance(MAX_TURNS * math.tau / abs(omega1))
        output = module["output_torque_mean"] - module["output_friction"] * module["omega_out"]
        return output, math.copysign(1.0, omega1) * module["input_torque_mean"]

    def lock_up_torque(self, omega1: float) -> float:
        """Compute the maximum load torque in lock-up, N m, without stiction.

        In lock-up the pinion shaft is at rest relative to link 1. The torque is the maximum torque of the
        unbalanced masses, - k I' omega1^2 / 2, minus the viscous friction of link 2 and output shaft.

        Args:
            omega1: speed of link 1, rad/s.
        """
        d, angles = self._derived, (n / ANGLES * self._turns * math.tau for n in range(ANGLES))
        slope: float = min(reduced_inertia(d, q)[1] for q in angles)
        torque: float = -0.5 * d.k * slope * omega1**2 - (d.b2 + d.b3) * abs(omega1)
        return max(torque, 0.0)


def _drive_angle(module: Module) -> float:
    return module["drive_angle"] + math.tau * module["drive_turns"]
