"""The two mechanisms whose extremes are tried, and the critical values they have."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from inertia_module.kernel.links import held_torque
from inertia_module.memory import Module

from .case import Extreme, Segment

# rad that link 1 turns in a trial, where nothing else is said
TRAVEL = 100.0


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A layout at ordinary values.

    Attributes:
        layout: bevel or planar. parameters: over the defaults. omega1: rad/s. load: N.m.
    """

    layout: str
    parameters: dict[str, float]
    omega1: float
    load: float

    def extreme(
        self,
        value: str,
        parameters: Mapping[str, float] | None = None,
        *segments: Segment,
        omega1: float | None = None,
        load: float | None = None,
        duration: float | None = None,
        **more: Any,
    ) -> Extreme:
        """An extreme of it: the given segments or, without any, TRAVEL rad of link 1 at ordinary inputs.

        Args:
            value: how it is called. parameters: over its own. segments: inputs over time.
            omega1, load, duration: other than ordinary, rad/s, N.m and s. more: see Extreme.
        """
        whole = Segment(
            TRAVEL / self.omega1 if duration is None else duration,
            self.omega1 if omega1 is None else omega1,
            self.load if load is None else load,
        )
        return Extreme(value, {**self.parameters, **(parameters or {})}, segments or (whole,), **more)

    @functools.cached_property
    def derived(self) -> Any:
        """The kernel's constants."""
        return Module("plain").start(**self.parameters).derived


_PLANAR = {
    **{"layout": 1, "eccentricity": 0.02, "imbalance_mass": 0.8, "satellites": 3},
    **{"link2_inertia": 0.003, "output_inertia": 0.4, "kinematic_ratio": 0.5},
}
BEVEL = Mechanism("bevel", {"kinematic_ratio": 0.5}, 100.0, 10.0)
PLANAR = Mechanism("planar", _PLANAR, 120.0, 8.0)
MECHANISMS = (BEVEL, PLANAR)


def imbalance_inertia(derived: Any) -> float:
    """Largest inertia of the imbalances behind link 2, k^2 G, kg m^2."""
    far = derived.pole_offset + 2.0 * derived.pole_arm
    return float(derived.mass * derived.k**2 * (far * far + derived.spin))


@functools.cache
def largest_held_torque(mechanism: Mechanism) -> float:
    """Largest torque on link 2 while it is held at the ordinary speed, N.m: a load above it is never moved.

    Looked for on a grid over a period, then on ever finer ones around the best.
    """
    d = mechanism.derived

    def torque(q: float) -> float:
        return float(held_torque(d, q, mechanism.omega1, 0.0)[0])  # type: ignore[no-untyped-call]

    count = 200 * int(d.period_turns)
    best, half = 0.5 * d.period, 0.5 * d.period
    while half > 1e-9:
        best = max((best + half * (2 * n / count - 1) for n in range(count + 1)), key=torque)
        half *= 2.0 / count
    return torque(best)


@functools.cache
def grazing_speed(mechanism: Mechanism) -> float:
    """Speed of the unloaded output shaft that link 2 only just reaches in TRAVEL rad, rad/s (bisection)."""

    def engages(speed: float) -> bool:
        values = mechanism.parameters | {"omega_out_start": speed, "tolerance": 1e-13}
        module = Module().start(**values, omega1=mechanism.omega1, load_torque=0.0)
        module.advance(TRAVEL / mechanism.omega1)
        return module["output_torque_mean"] != 0.0

    low, high = 0.0, 100.0 * mechanism.omega1
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        low, high = (middle, high) if engages(middle) else (low, middle)
