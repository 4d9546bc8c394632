"""Metrics of a mechanism that require no run of a scene: of its steady state and of its size.

STEADY_METRICS lists them by name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ..analysis.converter_chart import RATIOS, compute_chart
from ..analysis.steady_state import SteadyMachine
from ..model import Module


class SteadyMechanism(SteadyMachine):
    """Mechanism that computes steady means, samples and charts once per speed, rad/s, and ratio.

    Args:
        parameters: Parameters of the module, SI, by name.
    """

    def __init__(self, parameters: Mapping[str, float | str]) -> None:
        super().__init__(parameters)
        self.means = cache(self.at)
        self.sampled = cache(self.samples)
        self.chart = cache(lambda speed: compute_chart(parameters, speed))

    @property
    def envelope_diameter(self) -> float:
        """Return the diameter about the central axis of all unbalanced masses and pitch circles, m."""
        # A point of the rim of a satellite moves like an unbalanced mass on its pitch circle.
        rim = Module("plain")
        rim.check(**{**self._values, "a": 1.0, "b": 1.0, "eccentricity": self.module["satellite_radius"]})
        return 2.0 * max(_maximum_radius(self.module.derived), _maximum_radius(rim.derived))

    def minimum_torque(self, speed: float) -> float:
        """Return the minimum mean output torque over all speed ratios, N.m; 0 without lock-up.

        Args:
            speed: Speed of link 1, rad/s.
        """
        numbers = self.chart(speed).summary(speed)
        return numbers["least_torque"] if numbers["lock_up_torque"] > 0.0 else 0.0

    def engagement_frequency(self, speed: float, ratio: float) -> float:
        """Return the maximum engagement frequency of both freewheels, Hz.

        Args:
            speed: Speed of link 1, rad/s.
            ratio: Speed ratio.
        """
        means = self.means(speed, ratio)
        return max(means.housing_engagements, means.output_engagements) * speed / math.tau

    def maximum(self, names: tuple[str, ...], speed: float, ratio: float) -> float:
        """Return the maximum magnitude of a vector of outputs in the steady state.

        Args:
            names: Names of the components.
            speed: Speed of link 1, rad/s.
            ratio: Speed ratio.
        """
        return float(np.linalg.norm(self.sampled(names, speed, ratio), axis=1).max())


def _maximum_radius(d: Any) -> float:
    """Return the maximum distance of an unbalanced mass from the central axis, m.

    Planar: R0 + r + l. Bevel: with R, T and z of the layout (Karetin 2020, equation 2), R^2 + T^2 + z^2 is
    linear in cos B, so the maximum is at cos B = 1 or -1.

    Args:
        d: Derived constants of the kernel.
    """
    if d.planar != 0.0:
        return float(d.axial + d.radial)
    swing = abs(d.radial * d.radial_cos + d.axial * d.axial_cos)
    return math.sqrt(d.radial**2 + d.axial**2 + d.arm**2 + 2.0 * swing)


class SteadyMetric(NamedTuple):
    """Metric of a mechanism.

    Attributes:
        unit: Unit.
        needs: Required keys of a demand: "speed", "ratio", both or none.
        value: Function of mechanism, speed, rad/s, and speed ratio.
    """

    unit: str
    needs: tuple[str, ...]
    value: Callable[[SteadyMechanism, float, float], float]


_BOTH = ("speed", "ratio")
_SPEED = ("speed",)
# speed ratios from stall to lock-up
_ALL = RATIOS[::4]
_FORCE, _MOMENT = (tuple(f"shaking_{load}_{axis}" for axis in "xyz") for load in ("force", "moment"))
_INPUT = ("input_torque",)
STEADY_METRICS = {
    "stall_torque": SteadyMetric("N.m", _SPEED, lambda m, w, i: m.means(w, 0.0).output_torque),
    "steady_torque": SteadyMetric("N.m", _BOTH, lambda m, w, i: m.means(w, i).output_torque),
    "least_torque": SteadyMetric("N.m", _SPEED, lambda m, w, i: m.minimum_torque(w)),
    "lock_up_torque": SteadyMetric("N.m", _SPEED, lambda m, w, i: m.chart(w).summary(w)["lock_up_torque"]),
    "end_ratio": SteadyMetric("1", _SPEED, lambda m, w, i: m.chart(w).end_ratio),
    "steady_input_torque": SteadyMetric("N.m", _BOTH, lambda m, w, i: m.means(w, i).input_torque),
    "greatest_input_torque": SteadyMetric(
        "N.m", _SPEED, lambda m, w, i: m.chart(w).input_torque.max() * w**2
    ),
    "input_torque_ripple": SteadyMetric("N.m", _BOTH, lambda m, w, i: m.sampled(_INPUT, w, i).std()),
    "input_torque_peak": SteadyMetric("N.m", _BOTH, lambda m, w, i: m.maximum(_INPUT, w, i)),
    "steady_efficiency": SteadyMetric("1", _BOTH, lambda m, w, i: m.means(w, i).efficiency),
    "torque_ripple": SteadyMetric("N.m", _BOTH, lambda m, w, i: m.means(w, i).ripple),
    "torque_peak": SteadyMetric("N.m", _BOTH, lambda m, w, i: m.means(w, i).peak),
    "engagement_frequency": SteadyMetric("Hz", _BOTH, lambda m, w, i: m.engagement_frequency(w, i)),
    "housing_torque_peak": SteadyMetric("N.m", _BOTH, lambda m, w, i: m.means(w, i).housing_peak),
    "housing_slip_peak": SteadyMetric("rad/s", _BOTH, lambda m, w, i: m.means(w, i).housing_slip),
    "output_slip_peak": SteadyMetric("rad/s", _BOTH, lambda m, w, i: m.means(w, i).output_slip),
    "bearing_force": SteadyMetric("N", _BOTH, lambda m, w, i: m.means(w, i).bearing_force),
    "bearing_force_peak": SteadyMetric(
        "N", _SPEED, lambda m, w, i: max(m.means(w, r).bearing_force for r in _ALL)
    ),
    # speed of the satellites with link 2 at rest
    "satellite_speed": SteadyMetric(
        "rad/s", _SPEED, lambda m, w, i: m.module.derived.k * m.module.derived.s * w
    ),
    "mount_force": SteadyMetric("N", _BOTH, lambda m, w, i: m.maximum(_FORCE, w, i)),
    "mount_moment": SteadyMetric("N.m", _BOTH, lambda m, w, i: m.maximum(_MOMENT, w, i)),
    "envelope_diameter": SteadyMetric("m", (), lambda m, w, i: m.envelope_diameter),
    "total_imbalance_mass": SteadyMetric(
        "kg", (), lambda m, w, i: math.prod(m.module.read(("modules", "satellites", "imbalance_mass")))
    ),
}
