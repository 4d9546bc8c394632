"""What a case is, and what any integrator gives for it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from inertia_module.contract.variables import default_parameters

from .geometry import Array


class Unavailable(RuntimeError):
    """A method cannot take the case: why, in one line."""


@dataclass(frozen=True)
class Case:
    """An open-loop case: constant input speed and load, from the start values of the parameters.

    Attributes:
        parameters: of the module by name, those that differ from the defaults (scene R1).
        omega1: rad/s. load_torque: N.m. stop_time: s. points: number of equal sampling intervals.
    """

    parameters: Mapping[str, float] = field(default_factory=dict)
    omega1: float = 100.0
    load_torque: float = 10.0
    stop_time: float = 1.0
    points: int = 1000

    @property
    def times(self) -> Array:
        """Sampling times from 0 to stop_time, s, shape (points + 1,)."""
        return np.linspace(0.0, self.stop_time, self.points + 1)

    @property
    def all_parameters(self) -> dict[str, Any]:
        """Values of all parameters of the module in this case."""
        return {**default_parameters(), **self.parameters}

    def parameter(self, name: str) -> float:
        """Value of a parameter in this case."""
        return float(self.all_parameters[name])


@dataclass(frozen=True)
class Trajectory:
    """What an integrator gives at the sampling times of a case; arrays of shape (points + 1,).

    Attributes:
        time: s. drive_angle: q, unwrapped, rad (NaN where there is no phase).
        omega2, omega_out: speeds of link 2 and of the output shaft, rad/s.
        switches: times of the switches of the freewheels, s, shape (n,), or None if they are not located.
        evaluations: of the right-hand side. energy_residual: of its own energy audit, J, or None.
        wall_time: of the integration alone, s: median of repeats (see median_time).
        impulse: of the output torque Tc from the start, N.m.s, or None if it follows from omega_out
            as output_inertia (omega_out - start) + load_torque time.
        energy_in: work of the input torque, J, or None.
        number_of_switches: where they are counted, else NaN.
        acceleration: of the imbalance, m/s^2, or None if it follows from drive_angle and the speeds.
        modes: contact modes, or None where nobody asks for them.
    """

    time: Array
    drive_angle: Array
    omega2: Array
    omega_out: Array
    switches: Array | None
    evaluations: int
    energy_residual: float | None
    wall_time: float
    impulse: Array | None = None
    energy_in: float | None = None
    number_of_switches: float = math.nan
    acceleration: Array | None = None
    modes: Array | None = None


@dataclass(frozen=True)
class Peer:
    """Another way to integrate a case, with the settings it is to be tried at.

    Attributes:
        name: one curve of the plots, such as "LSODA, clutch 1e4".
        settings: what integrate takes, by its label, such as "rtol 1e-8"; from coarse to fine.
        integrate: of (case, setting) the trajectory. May raise ValueError, RuntimeError (Unavailable,
            NotInstalled) or ArithmeticError: it is then listed as a failure.
    """

    name: str
    settings: Mapping[str, Any]
    integrate: Callable[[Case, Any], Trajectory]
