"""The two mechanisms whose extremes are tried, and the critical values they have."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

from ...kernel.links import held_torque
from ...module import Module
from .case import Segment
from .trial import imbalance_energy

# rad that link 1 turns in a trial, where nothing else is said
TRAVEL = 100.0


@dataclass(frozen=True)
class Mechanism:
    """A layout at ordinary values.

    Attributes:
        layout: bevel or planar. parameters: over the defaults. omega1: rad/s. load: N m.
    """

    layout: str
    parameters: tuple[tuple[str, float], ...]
    omega1: float
    load: float

    def with_values(self, **values: float) -> dict[str, float]:
        """Its parameters with these over them."""
        return dict(self.parameters) | values

    def turning(self, **changes: float) -> tuple[Segment, ...]:
        """Its ordinary inputs for TRAVEL rad of link 1, with these changes."""
        ordinary = {"duration": TRAVEL / self.omega1, "omega1": self.omega1, "load": self.load}
        return (Segment(**(ordinary | changes)),)  # type: ignore[arg-type]

    def __hash__(self) -> int:
        return hash(self.layout)


BEVEL = Mechanism("bevel", (("kinematic_ratio", 0.5),), 100.0, 10.0)
PLANAR = Mechanism(
    "planar",
    (
        ("layout", 1),
        ("eccentricity", 0.02),
        ("imbalance_mass", 0.8),
        ("satellites", 3),
        ("link2_inertia", 0.003),
        ("output_inertia", 0.4),
        ("kinematic_ratio", 0.5),
    ),
    120.0,
    8.0,
)
MECHANISMS = (BEVEL, PLANAR)


@functools.cache
def imbalance_inertia(mechanism: Mechanism) -> float:
    """Largest inertia of the imbalances behind link 2, k^2 G, kg m^2."""
    return 2.0 * imbalance_energy(Module("plain").start(**mechanism.with_values()).derived, 1.0)


@functools.cache
def pulse_rate(mechanism: Mechanism) -> float:
    """Rate of the highest harmonic with link 2 held at the ordinary speed, rad/s."""
    d = Module("plain").start(**mechanism.with_values()).derived
    return float(d.harmonic * d.k) * mechanism.omega1


@functools.cache
def stall_torque(mechanism: Mechanism) -> float:
    """Largest torque on link 2 while it is held at the ordinary speed, N m: a load above it is never moved.

    Looked for on a grid, then by golden sections (Kiefer 1953).
    """
    d = Module("plain").start(**mechanism.with_values()).derived

    def torque(q: float) -> float:
        return float(held_torque(d, q, mechanism.omega1, 0.0)[0])  # type: ignore[no-untyped-call]

    count = 200 * int(d.period_turns)
    grid = [d.period * n / count for n in range(count)]
    low = max(grid, key=torque) - grid[1]
    high = low + 2.0 * grid[1]
    share = 0.5 * (math.sqrt(5.0) - 1.0)
    while high - low > 1e-9:
        left, right = high - share * (high - low), low + share * (high - low)
        low, high = (left, high) if torque(left) < torque(right) else (low, right)
    return torque(0.5 * (low + high))


@functools.cache
def grazing_speed(mechanism: Mechanism) -> float:
    """Speed of the unloaded output shaft that link 2 only just reaches in TRAVEL rad, rad/s (bisection)."""

    def engages(speed: float) -> bool:
        module = Module().start(
            **mechanism.with_values(omega_out_start=speed, tolerance=1e-13), omega1=mechanism.omega1
        )
        module.advance(TRAVEL / mechanism.omega1)
        return module["output_torque_mean"] != 0.0

    low, high = 0.0, 100.0 * mechanism.omega1
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        low, high = (middle, high) if engages(middle) else (low, middle)
