"""Geometry of Karetin's standard layout: teeth, shaft angle and a, b, c give the lengths of figure 1."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields

from ...contract.variables import BY_NAME, refused_parameters


def _derived() -> float:
    return field(init=False, repr=False, compare=False)  # type: ignore[no-any-return]


@dataclass(frozen=True)
class Geometry:
    """One inertia module in the standard layout.

    Names, ranges and defaults (scene R1) are those of the parameters of the FMU.

    Attributes:
        z2, z16, z17, z6: teeth. shaft_angle: angle Sigma = phi + psi between the axes QA and OQ, rad, the
            paper's chi as well. wheel_radius: pitch radius O_r Pi of wheel 17, m.
        a, b, c: AD, QA and OQ over their lengths in the pitch cones (KPi, QK, O_r Q).
        epsilon, gamma: offsets of the imbalance about QA and OQ at the time 0, rad.
        s: turns of the satellite 6 on the drive per turn of the drive 16, z17/z6.
        k: turns of the drive in link 1 per turn of link 1 against link 2, z2/z16.
        phi, psi: half angles of the pitch cones of the satellite and of wheel 17, rad.
        L: length of the generatrix Q Pi, U1 of equation (2), m.
        AD, QA, OQ: arm of the imbalance, offset of its plane on the satellite's axis, place of Q, m.
            QA is negative where phi > pi/2 (internal satellite), OQ where psi > pi/2.
        across, height: of A from OQ and above the plane z = 0, m: QA sin(Sigma), OQ - QA cos(Sigma).
        turns_in_period: turns of the drive after which drive and satellite are as they were.

    Raises:
        ValueError: a value out of its range, with name, value and what is allowed.
    """

    z2: int = 20
    z16: int = 20
    z17: int = 34
    z6: int = 20
    shaft_angle: float = math.pi / 2
    wheel_radius: float = 0.08
    a: float = 1.0
    b: float = 1.0
    c: float = 1.0
    epsilon: float = 0.0
    gamma: float = 0.0
    s: float = _derived()
    k: float = _derived()
    phi: float = _derived()
    psi: float = _derived()
    L: float = _derived()
    AD: float = _derived()
    QA: float = _derived()
    OQ: float = _derived()
    across: float = _derived()
    height: float = _derived()
    turns_in_period: int = _derived()  # type: ignore[assignment]

    def __post_init__(self) -> None:
        names = [parameter.name for parameter in fields(self) if parameter.init]
        for message in refused_parameters(vars(self), [BY_NAME[name] for name in names]):
            raise ValueError(message)
        vars(self).update(self._lengths_and_angles())

    def _lengths_and_angles(self) -> dict[str, float]:
        """Derived values by name, exact to rounding also where a cone is flat or a needle."""
        s, sine = self.z17 / self.z6, math.sin(self.shaft_angle)
        # s + cos and 1 + s cos without the cancellation near Sigma = pi, where both can vanish
        half = 2.0 * math.cos(0.5 * self.shaft_angle) ** 2
        along_satellite = (self.z17 - self.z6) / self.z6 + half
        along_drive = (self.z6 - self.z17) / self.z6 + s * half
        # rolling without slip: s = sin psi / sin phi, so the cones follow from s and Sigma
        scale = self.wheel_radius / (s * sine)
        return {
            "s": s,
            "k": self.z2 / self.z16,
            "phi": math.atan2(sine, along_satellite),
            "psi": math.atan2(s * sine, along_drive),
            "L": scale * math.hypot(s * sine, along_drive),
            "AD": self.a * self.wheel_radius / s,
            "QA": self.b * scale * along_satellite,
            "OQ": self.c * scale * along_drive,
            "across": self.b * self.wheel_radius * along_satellite / s,
            # with b = c the huge OQ and QA cos(Sigma) of a small Sigma cancel: written out
            "height": (self.c - self.b) * scale * along_drive + self.b * self.wheel_radius * sine / s,
            "turns_in_period": self.z6 // math.gcd(int(self.z17), int(self.z6)),
        }
