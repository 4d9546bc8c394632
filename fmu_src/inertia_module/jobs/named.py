"""Figures of a mechanism by name: of steady pulses at a speed and a speed ratio, and of its size."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache, cached_property
from typing import Any, NamedTuple

from ..common.errors import Refused
from ..harness.chart import torque_converter_chart
from ..harness.steady import SteadyMachine, SteadyPulses
from ..memory import Module


class Mechanism:
    """A mechanism whose steady pulses are found once for each speed and ratio.

    Args:
        parameters: of the module by name, those that differ from the defaults.

    Raises:
        Refused: the parameters cannot be.
    """

    def __init__(self, parameters: Mapping[str, float | str]) -> None:
        self.parameters = parameters
        self.module = Module("plain")
        self.module.check(**parameters)

    def check_room(self) -> None:
        """Refuse what can be computed but not built.

        Raises:
            Refused: the module warns that there is no room for its parts, or that they are no bodies.
        """
        if found := self.module.warnings():
            raise Refused("; ".join(found))

    @property
    def envelope_diameter(self) -> float:
        """Diameter about the central axis that imbalances and pitch circles of the satellites need, m."""
        # the rim of a satellite is where an imbalance on its pitch circle would be
        rim = Module("plain")
        rim.check(**{**self.parameters, "a": 1.0, "b": 1.0, "eccentricity": self.module["satellite_radius"]})
        return 2.0 * max(_farthest(self.module.derived), _farthest(rim.derived))

    @property
    def total_imbalance_mass(self) -> float:
        """Mass of the imbalances of all satellites of all modules, kg."""
        return math.prod(self.module[name] for name in ("modules", "satellites", "imbalance_mass"))

    @cached_property
    def machine(self) -> SteadyMachine:
        """The mechanism with its output shaft held."""
        return SteadyMachine(self.parameters)

    @cached_property
    def pulses(self) -> Callable[[float, float], SteadyPulses]:
        """Function from a speed, rad/s, and a ratio to steady pulses; refuses a missing freewheel."""
        return cache(self.machine.at)

    def greatest_input_torque(self, speed: float) -> float:
        """Largest mean input torque over the speed ratios, N.m."""
        chart = torque_converter_chart(self.parameters, omega1=speed)
        return float(chart.input_torque.max()) * speed**2


def _farthest(d: Any) -> float:
    """Largest distance of an imbalance from the central axis, m, at any drive angle.

    Planar: R0 + r + l. Bevel: with R, T and z of the layout (Karetin 2020, equation 2) R^2 + T^2 + z^2 is
    linear in cos B, hence largest where that is 1 or -1.

    Args:
        d: derived constants of the kernel.
    """
    if d.planar != 0.0:
        return float(d.axial + d.radial)
    swing = abs(d.radial * d.radial_cos + d.axial * d.axial_cos)
    return math.sqrt(d.radial**2 + d.axial**2 + d.arm**2 + 2.0 * swing)


class Named(NamedTuple):
    """A figure.

    Attributes:
        unit: of its values. asks: what it is to be given, of speed (rad/s) and ratio (1).
        value: of a mechanism at a speed and a ratio.
    """

    unit: str
    asks: tuple[str, ...]
    value: Callable[[Mechanism, float, float], float]


_BOTH = ("speed", "ratio")
NAMED = {
    "stall_torque": Named("N.m", ("speed",), lambda m, w, i: m.pulses(w, 0.0).output_torque),
    "steady_torque": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).output_torque),
    "steady_input_torque": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).input_torque),
    "greatest_input_torque": Named("N.m", ("speed",), lambda m, w, i: m.greatest_input_torque(w)),
    "steady_efficiency": Named("1", _BOTH, lambda m, w, i: m.pulses(w, i).efficiency),
    "torque_ripple": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).ripple),
    "torque_peak": Named("N.m", _BOTH, lambda m, w, i: m.pulses(w, i).peak),
    "bearing_force": Named("N", _BOTH, lambda m, w, i: m.pulses(w, i).bearing_force),
    "mount_force": Named("N", _BOTH, lambda m, w, i: m.machine.mount(w, i).force),
    "mount_moment": Named("N.m", _BOTH, lambda m, w, i: m.machine.mount(w, i).moment),
    "envelope_diameter": Named("m", (), lambda m, w, i: m.envelope_diameter),
    "total_imbalance_mass": Named("kg", (), lambda m, w, i: m.total_imbalance_mass),
}
