"""The wheel mechanism: wheel 1 with the imbalance, rolled around the held wheel 2 by carrier 3."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from ..checks import above


@dataclass(frozen=True)
class Mechanism:
    """Dimensions and masses; the horizontal plane keeps gravity out.

    Attributes:
        R0: radius of the held wheel 2 (R in the paper), m. r: radius of wheel 1, m.
        arm: distance l of the imbalance from the axis O1 of wheel 1, m; l = r in the paper's example.
        m: mass of the imbalance, kg.
        J_carrier: moment of inertia of the carrier about O, the mass of wheel 1 on it included, kg m^2.
        J_wheel: moment of inertia of wheel 1 about its own axis O1, the imbalance not included, kg m^2.

    Raises:
        ValueError: a number is not finite, R0, r, arm or m is not above 0, or an inertia is below 0.
    """

    R0: float
    r: float
    arm: float
    m: float
    J_carrier: float = 0.0
    J_wheel: float = 0.0

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            above(value, name, zero=name.startswith("J_"))

    @property
    def b(self) -> float:
        """Modulus of the epicycloid b = r/R0; the carrier turns b times as fast as wheel 1 turns on it."""
        return self.r / self.R0

    @property
    def centre_distance(self) -> float:
        """Distance D = O O1 = R0 (1 + b), m."""
        return self.R0 + self.r

    @property
    def constant_inertia(self) -> float:
        """Sum of the constant moments of inertia about O, equation (19), kg m^2."""
        return self.J_carrier + self.J_wheel


# what the differences and figures are given for: l = r as in the paper, b = 1/3 (three cycles a turn)
EXAMPLE = Mechanism(R0=0.06, r=0.02, arm=0.02, m=1.0, J_carrier=2e-3, J_wheel=5e-5)
# of wheel 1 relative to the carrier, rad/s
EXAMPLE_SPEED = 100.0


def with_modulus(b: float, arm: float = 1.0) -> Mechanism:
    """The example with another wheel 1, r = b R0, and the imbalance at arm times r."""
    r = b * EXAMPLE.R0
    return Mechanism(EXAMPLE.R0, r, arm * r, EXAMPLE.m, EXAMPLE.J_carrier, EXAMPLE.J_wheel)
