"""Figures by name: of steady pulses at a speed and a speed ratio, of the size, of the summary of a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, cached_property
from typing import NamedTuple

from ..contract.variable import LARGEST_SPEED
from ..harness.chart import torque_converter_chart
from ..harness.steady import SteadyMachine, SteadyPulses
from ..scene.summary import Quantity
from .size import envelope_diameter, total_imbalance_mass


class Mechanism:
    """A mechanism whose steady pulses are found once for each speed and ratio.

    Args:
        parameters: of the module by name, those that differ from the defaults.

    Raises:
        Refused: the parameters cannot be.
    """

    def __init__(self, parameters: Mapping[str, float]) -> None:
        self.parameters = parameters

    @cached_property
    def machine(self) -> SteadyMachine:
        """The mechanism with its output shaft held."""
        return SteadyMachine(self.parameters)

    @cached_property
    def pulses(self) -> Callable[[float, float], SteadyPulses]:
        """Gives steady pulses at a speed, rad/s, and a ratio."""
        return cache(self.machine.at)

    def greatest_input_torque(self, speed: float) -> float:
        """Largest mean input torque over the speed ratios, N.m."""
        chart = torque_converter_chart(self.parameters, omega1=speed)
        return float(chart.input_torque.max()) * speed**2


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
    "envelope_diameter": Named("m", (), lambda m, w, i: envelope_diameter(m.parameters)),
    "total_imbalance_mass": Named("kg", (), lambda m, w, i: total_imbalance_mass(m.parameters)),
}
# of what a figure may be given: unit and range
CONDITIONS = {"speed": ("rad/s", LARGEST_SPEED), "ratio": ("1", 0.99)}

# speed and ratio of each figure
Wanted = Mapping[str, tuple[float, float]]


def named_figures(parameters: Mapping[str, float], wanted: Wanted) -> dict[str, Quantity]:
    """Figures of a mechanism by name.

    Args:
        parameters: of the module by name. wanted: names of NAMED, each with speed (rad/s) and ratio.

    Raises:
        Refused: the parameters cannot be, or a freewheel is missing.
    """
    mechanism = Mechanism(parameters)
    return {
        name: Quantity(NAMED[name].value(mechanism, *at), NAMED[name].unit) for name, at in wanted.items()
    }
